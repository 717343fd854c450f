//! Expressions of the product as text, with resolved names and as few parentheses as possible.
//!
//! An expression that several others share is written once, as `#number`, if it is long: `let`s of interactions can double
//! at every level.

use super::ir::{BinderId, ExprId, ExprKind, Model, Quantifier, TypeId};
use super::operands::for_each_operand;
use super::types::Ty;
use crate::math::Op;

/// Writes expressions of one model.
pub(super) struct Formulas<'m> {
    model: &'m Model,
    shared: Vec<bool>,
}

/// Whose names an expression uses.
#[derive(Clone, Copy, Default)]
pub(super) struct Names<'n> {
    /// Parameters of the function.
    pub locals: &'n [(String, super::ir::Type)],
    /// The interaction, with its participants.
    pub pair: Option<&'n super::ir::Interaction>,
}

/// How tightly an operator binds, from loose to tight.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Level {
    Open,
    Or,
    And,
    Not,
    Compare,
    Sum,
    Product,
    Sign,
    Power,
    Tight,
}

impl<'m> Formulas<'m> {
    /// Finds out which expressions are shared.
    pub fn new(model: &'m Model) -> Self {
        let mut uses = vec![0u32; model.exprs.len()];
        let mut sizes = vec![1u64; model.exprs.len()];
        for (id, expr) in model.exprs.iter_enumerated() {
            let mut size = 1u64;
            for_each_operand(&expr.kind, |operand| {
                uses[operand.index()] += 1;
                size = size.saturating_add(sizes[operand.index()]);
            });
            sizes[id.index()] = size;
        }
        Self { model, shared: uses.iter().zip(&sizes).map(|(&uses, &size)| uses > 1 && size > 24).collect() }
    }

    /// The shared expressions that are written once, with their texts.
    pub fn shared(&self, names: Names) -> Vec<(ExprId, String)> {
        let ids = self.model.exprs.indices().filter(|id| self.shared[id.index()]);
        ids.map(|id| (id, self.inside(id, names))).collect()
    }

    /// An expression.
    pub fn text(&self, id: ExprId, names: Names) -> String {
        let mut out = String::new();
        self.write(id, Level::Open, names, &mut out);
        out
    }

    fn inside(&self, id: ExprId, names: Names) -> String {
        let mut out = String::new();
        self.write_kind(id, names, &mut out);
        out
    }

    fn level(&self, id: ExprId) -> Level {
        match &self.model.exprs[id].kind {
            ExprKind::Number(value) if *value < 0.0 => Level::Sign,
            ExprKind::Quantifier { .. } | ExprKind::Aggregate { .. } | ExprKind::Apply(Op::Select, _) => {
                Level::Open
            }
            ExprKind::Same(..) | ExprKind::Is(..) => Level::Compare,
            ExprKind::Apply(op, _) => infix(*op).map_or(Level::Tight, |(level, _)| level),
            _ => Level::Tight,
        }
    }

    fn write(&self, id: ExprId, least: Level, names: Names, out: &mut String) {
        if self.shared[id.index()] {
            out.push_str(&format!("#{}", id.index()));
        } else if self.level(id) < least {
            out.push('(');
            self.write_kind(id, names, out);
            out.push(')');
        } else {
            self.write_kind(id, names, out);
        }
    }

    fn write_kind(&self, id: ExprId, names: Names, out: &mut String) {
        let expr = &self.model.exprs[id];
        let mut call = |name: &str, operands: &[ExprId]| {
            out.push_str(name);
            out.push('(');
            for (k, operand) in operands.iter().enumerate() {
                out.push_str(if k == 0 { "" } else { ", " });
                self.write(*operand, Level::Open, names, out);
            }
            out.push(')');
        };
        match &expr.kind {
            ExprKind::Number(value) if Ty::from(expr.ty) == Ty::Bool => {
                out.push_str(if *value == 0.0 { "false" } else { "true" });
            }
            ExprKind::Number(value) => out.push_str(&number_text(*value)),
            ExprKind::Time => out.push_str("time"),
            ExprKind::Local(number) => {
                out.push_str(names.locals.get(*number).map_or("index", |(name, _)| name))
            }
            ExprKind::Received(number) => out.push_str(&format!("received {}", number + 1)),
            ExprKind::SelfAgent => out.push_str("self"),
            ExprKind::Participant(number) => {
                out.push_str(names.pair.map_or("participant", |pair| pair.participants[*number].as_str()));
            }
            ExprKind::Bound(binder) => out.push_str(&self.model.binders[*binder].name),
            ExprKind::NoAgent => out.push_str("none"),
            ExprKind::Link(agent, _)
            | ExprKind::State(agent, _)
            | ExprKind::Rate(agent, _)
            | ExprKind::Discrete(agent, _)
            | ExprKind::AgentParam(agent, _)
            | ExprKind::Let(agent, _) => {
                self.write(*agent, Level::Tight, names, out);
                out.push('.');
                out.push_str(self.member(&expr.kind, *agent));
                out.push_str(if matches!(expr.kind, ExprKind::Rate(..)) { "'" } else { "" });
            }
            ExprKind::Apply(op, operands) => self.write_operator(id, *op, operands, names, out),
            ExprKind::Call(function, args) => call(&self.model.functions[*function].name, args),
            ExprKind::Present(agent) => call("present", &[*agent]),
            ExprKind::Rising(operand) => call("rising", &[*operand]),
            ExprKind::Crossing(operand) => call("crossing", &[*operand]),
            ExprKind::Same(left, right) => {
                self.write(*left, Level::Sum, names, out);
                out.push_str(" == ");
                self.write(*right, Level::Sum, names, out);
            }
            ExprKind::Is(agent, mode) => {
                self.write(*agent, Level::Sum, names, out);
                let ty = Ty::from(self.model.exprs[*agent].ty).agent_type();
                out.push_str(" is ");
                out.push_str(ty.map_or("", |ty| self.model.types[ty].modes[*mode].path.as_str()));
            }
            ExprKind::Quantifier { kind, binder, set, other, filter, body } => {
                let word = match kind {
                    Quantifier::Exists => "exists",
                    Quantifier::Forall => "forall",
                };
                out.push_str(&self.range_text(word, *binder, *set, *other));
                self.write_quantified(*filter, Some(*body), names, out);
            }
            ExprKind::Aggregate { kind, binder, set, other, filter, term } => {
                out.push_str(&self.range_text(kind.name(), *binder, *set, *other));
                self.write_quantified(*filter, *term, names, out);
            }
        }
    }

    /// `exists o in other Car`
    fn range_text(&self, word: &str, binder: BinderId, set: TypeId, other: bool) -> String {
        let (name, other) = (&self.model.binders[binder].name, if other { "other " } else { "" });
        format!("{word} {name} in {other}{}", self.model.types[set].name)
    }

    fn write_quantified(&self, filter: Option<ExprId>, body: Option<ExprId>, names: Names, out: &mut String) {
        if let Some(filter) = filter {
            out.push_str(" where ");
            self.write(filter, Level::Or, names, out);
        }
        if let Some(body) = body {
            out.push_str(": ");
            self.write(body, Level::Open, names, out);
        }
    }

    fn write_operator(&self, id: ExprId, op: Op, operands: &[ExprId], names: Names, out: &mut String) {
        match (op, operands) {
            (Op::Select, [condition, then, otherwise]) => {
                out.push_str("if ");
                self.write(*condition, Level::Or, names, out);
                out.push_str(" then ");
                self.write(*then, Level::Or, names, out);
                out.push_str(" else ");
                self.write(*otherwise, Level::Open, names, out);
            }
            (Op::Neg, [operand]) => {
                out.push('-');
                self.write(*operand, Level::Sign, names, out);
            }
            (Op::Not, [operand]) => {
                out.push_str("not ");
                self.write(*operand, Level::Not, names, out);
            }
            (Op::Powi | Op::Pow, [base, exponent]) => {
                self.write(*base, Level::Tight, names, out);
                out.push_str(if op == Op::Powi { "^" } else { "^^" });
                self.write(*exponent, Level::Sign, names, out);
            }
            _ => match infix(op) {
                Some((level, _)) => self.write_chain(id, level, names, out),
                None => {
                    out.push_str(op.name());
                    out.push('(');
                    for (k, operand) in operands.iter().enumerate() {
                        out.push_str(if k == 0 { "" } else { ", " });
                        self.write(*operand, Level::Open, names, out);
                    }
                    out.push(')');
                }
            },
        }
    }

    /// A chain of operators of one level, however long: down the left operands by a loop.
    fn write_chain(&self, id: ExprId, level: Level, names: Names, out: &mut String) {
        let mut rest = Vec::new();
        let mut first = id;
        while let ExprKind::Apply(op, operands) = &self.model.exprs[first].kind {
            let (Some((own, symbol)), [left, right]) = (infix(*op), &operands[..]) else { break };
            if own != level || (first != id && (self.shared[first.index()] || level == Level::Compare)) {
                break;
            }
            rest.push((symbol, *right));
            first = *left;
        }
        let tighter = match level {
            Level::Open | Level::Or => Level::And,
            Level::And => Level::Not,
            Level::Not | Level::Compare => Level::Sum,
            Level::Sum => Level::Product,
            Level::Product => Level::Sign,
            Level::Sign | Level::Power | Level::Tight => Level::Tight,
        };
        self.write(first, if level == Level::Compare { tighter } else { level }, names, out);
        for (symbol, operand) in rest.into_iter().rev() {
            out.push_str(symbol);
            self.write(operand, tighter, names, out);
        }
    }

    fn member(&self, kind: &ExprKind, agent: ExprId) -> &str {
        let Some(ty) = Ty::from(self.model.exprs[agent].ty).agent_type() else { return "?" };
        let ty = &self.model.types[ty];
        match kind {
            ExprKind::Link(_, number) => &ty.links[*number].name,
            ExprKind::State(_, number) | ExprKind::Rate(_, number) => &ty.states[*number].name,
            ExprKind::Discrete(_, number) => &ty.discretes[*number].name,
            ExprKind::AgentParam(_, number) => &ty.params[*number].name,
            ExprKind::Let(_, number) => &ty.lets[*number].name,
            _ => "?",
        }
    }
}

/// A number in the shortest form that reads back to the same value.
pub(super) fn number_text(value: f64) -> String {
    let scientific = format!("{value:?}");
    if scientific.contains('e') { scientific } else { value.to_string() }
}

/// Level and symbol of the operators that are written between or before their operands.
fn infix(op: Op) -> Option<(Level, &'static str)> {
    Some(match op {
        Op::Add => (Level::Sum, " + "),
        Op::Sub => (Level::Sum, " - "),
        Op::Mul => (Level::Product, "*"),
        Op::Div => (Level::Product, "/"),
        Op::Lt => (Level::Compare, " < "),
        Op::Le => (Level::Compare, " <= "),
        Op::Eq => (Level::Compare, " == "),
        Op::Ne => (Level::Compare, " != "),
        Op::And => (Level::And, " and "),
        Op::Or => (Level::Or, " or "),
        Op::Not => (Level::Not, "not "),
        Op::Neg => (Level::Sign, "-"),
        Op::Powi | Op::Pow => (Level::Power, "^"),
        Op::Select => (Level::Open, ""),
        Op::Sin
        | Op::Cos
        | Op::Tan
        | Op::Asin
        | Op::Acos
        | Op::Atan
        | Op::Atan2
        | Op::Sinh
        | Op::Cosh
        | Op::Tanh => {
            return None;
        }
        Op::Asinh
        | Op::Acosh
        | Op::Atanh
        | Op::Exp
        | Op::Log
        | Op::Log2
        | Op::Log10
        | Op::Sqrt
        | Op::Cbrt => return None,
        Op::Abs | Op::Sign | Op::Min | Op::Max | Op::Floor | Op::Ceil | Op::Round | Op::Trunc => return None,
        Op::Mod | Op::Hypot => return None,
    })
}
