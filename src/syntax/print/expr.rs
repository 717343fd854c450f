//! Where the lines of an expression may end: before its weakest operators first.

use super::writer::Writer;
use crate::syntax::ast::*;

impl Writer<'_> {
    /// Writes the words up to the end of an expression. Parentheses around it are its surroundings' to write.
    pub(super) fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Number { unit, .. } => unit.iter().for_each(|unit| self.unit(unit.span)),
            ExprKind::Text(_) | ExprKind::Name(_) => {}
            ExprKind::List(items) => self.exprs(items),
            ExprKind::Field(base, _) | ExprKind::Prime(base) | ExprKind::Is(base, _) => self.whole(base),
            ExprKind::Call { callee, args } => {
                self.whole(callee);
                self.close_parens();
                self.exprs(args);
            }
            ExprKind::Index(base, index) => {
                self.whole(base);
                self.close_parens();
                self.exprs(std::slice::from_ref(index));
            }
            ExprKind::Unary(_, operand) => self.whole(operand),
            ExprKind::Power(base, exponent) => {
                self.whole(base);
                self.whole(exponent);
            }
            ExprKind::Sum(chain) => self.chain(chain),
            ExprKind::Product(chain) => self.chain(chain),
            ExprKind::Compare(_, left, right) => self.operands(true, [&**left, &**right]),
            ExprKind::And(terms) | ExprKind::Or(terms) => self.operands(false, terms),
            ExprKind::If { .. } => self.conditional(expr),
            ExprKind::Quantifier(quantifier) => self.quantifier(quantifier),
        }
        self.up_to(expr.span.end);
    }

    /// Brackets with expressions in them.
    pub(super) fn exprs(&mut self, exprs: &[Expr]) {
        self.brackets(exprs, |w, expr| w.whole(expr));
    }

    /// An expression with the parentheses before it.
    pub(super) fn whole(&mut self, expr: &Expr) {
        self.up_to(expr.span.start);
        self.expr(expr);
    }

    fn chain<Op>(&mut self, chain: &Chain<Op>) {
        let rest = chain.rest.iter().map(|link| &link.operand);
        self.operands(true, std::iter::once(&*chain.first).chain(rest));
    }

    /// Operands with breaks before the operators between them.
    fn operands<'e>(&mut self, fill: bool, operands: impl IntoIterator<Item = &'e Expr>) {
        self.open(fill);
        for (k, operand) in operands.into_iter().enumerate() {
            if k > 0 {
                self.close_parens();
                self.may_continue();
            }
            self.deeper(|w| w.whole(operand));
        }
        self.close();
    }

    /// `if` ... `then` ... `else if` ... `else` ..., with breaks before `else`, and if need be before `then`.
    fn conditional(&mut self, mut expr: &Expr) {
        self.open(false);
        while let ExprKind::If { condition, then, otherwise } = &expr.kind {
            self.open(true);
            self.deeper(|w| {
                w.whole(condition);
                w.close_parens();
                w.may_continue();
                w.whole(then);
                w.close_parens();
            });
            self.close();
            self.may_continue();
            self.word();
            expr = otherwise;
            // In parentheses a conditional is an operand like any other.
            if self.peek() == "(" {
                break;
            }
        }
        self.deeper(|w| w.whole(expr));
        self.close();
    }

    fn quantifier(&mut self, quantifier: &Quantifier) {
        self.open(true);
        self.up_to(quantifier.set.span.end);
        self.deeper(|w| {
            if let Some(filter) = &quantifier.filter {
                w.may_continue();
                w.whole(filter);
                w.close_parens();
            }
            if let Some(body) = &quantifier.body {
                if w.peek() == ":" {
                    w.word();
                }
                w.may_continue();
                w.whole(body);
            }
        });
        self.close();
    }
}
