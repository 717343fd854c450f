//! The outermost level: imports, parameters, functions, interactions, the system, properties and the run.

use super::Builder;
use crate::syntax::ast::*;
use crate::syntax::grammar::{Parts, Piece, Rule};

impl Builder<'_> {
    pub(super) fn item(&mut self, piece: Piece<'_>) -> Item {
        match piece.as_rule() {
            Rule::import => Item::Import(self.import(piece)),
            Rule::param => Item::Param(self.param(piece)),
            Rule::definition => Item::Let(self.definition(piece)),
            Rule::function => Item::Fn(self.function(piece)),
            Rule::agent => Item::Agent(self.agent(piece)),
            Rule::interaction => Item::Interaction(self.interaction(piece)),
            Rule::system => Item::System(self.system(piece)),
            Rule::property => Item::Property(self.property(piece)),
            Rule::run => Item::Run(self.run(piece)),
            rule => unreachable!("{rule:?} is no item of the grammar"),
        }
    }

    fn import(&mut self, piece: Piece<'_>) -> Import {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_import);
        Import { path: self.text(parts.expect(Rule::string)), span }
    }

    fn param(&mut self, piece: Piece<'_>) -> Param {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_param);
        let name = self.name(parts.expect(Rule::name));
        let ty = self.type_annotation(&mut parts);
        parts.expect(Rule::equals);
        Param { name, ty, value: self.expr(parts.expect(Rule::expr)), span }
    }

    pub(super) fn definition(&mut self, piece: Piece<'_>) -> Let {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_let);
        let name = self.name(parts.expect(Rule::name));
        let ty = self.type_annotation(&mut parts);
        parts.expect(Rule::equals);
        Let { name, ty, value: self.expr(parts.expect(Rule::expr)), span }
    }

    fn function(&mut self, piece: Piece<'_>) -> Fn {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_fn);
        let name = self.name(parts.expect(Rule::name));
        let formals = self.formals(parts.expect(Rule::formals));
        let ty = self.type_annotation(&mut parts);
        parts.expect(Rule::equals);
        Fn { name, formals, ty, body: self.expr(parts.expect(Rule::expr)), span }
    }

    pub(super) fn formals(&mut self, piece: Piece<'_>) -> Vec<Formal> {
        Parts::of(piece).all(Rule::formal).map(|formal| self.formal(formal)).collect()
    }

    fn formal(&mut self, piece: Piece<'_>) -> Formal {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let name = self.name(parts.expect(Rule::name));
        parts.expect(Rule::colon);
        let ty = self.type_name(parts.expect(Rule::type_name));
        Formal { name, ty, default: self.expr_after(&mut parts, Rule::equals), span }
    }

    fn interaction(&mut self, piece: Piece<'_>) -> Interaction {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_interaction);
        let name = self.name(parts.expect(Rule::name));
        let formals = self.formals(parts.expect(Rule::formals));
        let mut items = Vec::new();
        for part in parts.rest() {
            match part.as_rule() {
                Rule::definition => items.push(InteractionItem::Let(self.definition(part))),
                Rule::transition => items.push(InteractionItem::Transition(self.transition(part))),
                _ => {}
            }
        }
        Interaction { name, formals, items, span }
    }

    fn system(&mut self, piece: Piece<'_>) -> System {
        let span = self.span(&piece);
        let instances =
            Parts::of(piece).all(Rule::instance).map(|instance| self.instance(instance)).collect();
        System { instances, span }
    }

    fn instance(&mut self, piece: Piece<'_>) -> Instance {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let name = self.name(parts.expect(Rule::name));
        parts.expect(Rule::equals);
        Instance { name, constructor: self.constructor(parts.expect(Rule::constructor)), span }
    }

    pub(super) fn constructor(&mut self, piece: Piece<'_>) -> Constructor {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let agent = self.name(parts.expect(Rule::name));
        let count = parts.next_if(Rule::count).map(|count| self.count(count));
        let args = parts.next_if(Rule::named_args).map(|args| self.named_args(args)).unwrap_or_default();
        let start = parts.skip(Rule::kw_in).then(|| self.plain_target(parts.expect(Rule::target)));
        let source = self.expr_after(&mut parts, Rule::kw_from);
        Constructor { agent, count, args, start, source, span }
    }

    fn count(&mut self, piece: Piece<'_>) -> Count {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::open_bracket);
        match parts.next_if(Rule::expr) {
            Some(expr) => Count::Exactly(self.expr(expr)),
            None => Count::AllRows(span),
        }
    }

    fn named_args(&mut self, piece: Piece<'_>) -> Vec<NamedArg> {
        Parts::of(piece).all(Rule::named_arg).map(|arg| self.named_arg(arg)).collect()
    }

    fn named_arg(&mut self, piece: Piece<'_>) -> NamedArg {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let name = self.name(parts.expect(Rule::name));
        let kind = if parts.next().as_rule() == Rule::tilde { GivenKind::Draw } else { GivenKind::Value };
        NamedArg { name, given: Given { kind, value: self.expr(parts.expect(Rule::expr)) }, span }
    }

    fn property(&mut self, piece: Piece<'_>) -> Property {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_property);
        let name = self.name(parts.expect(Rule::name));
        parts.expect(Rule::equals);
        Property { name, formula: self.formula(parts.expect(Rule::formula)), span }
    }

    fn formula(&mut self, piece: Piece<'_>) -> Formula {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let first = parts.next();
        let kind = match first.as_rule() {
            Rule::kw_always | Rule::kw_eventually => {
                let always = first.as_rule() == Rule::kw_always;
                let window = parts.next_if(Rule::window).map(|window| self.window(window));
                let inner = Box::new(self.formula(parts.expect(Rule::formula)));
                if always {
                    FormulaKind::Always(window, inner)
                } else {
                    FormulaKind::Eventually(window, inner)
                }
            }
            _ => {
                let condition = self.expr(first);
                if parts.skip(Rule::kw_until) {
                    let window = parts.next_if(Rule::window).map(|window| self.window(window));
                    FormulaKind::Until {
                        before: condition,
                        window,
                        goal: self.expr(parts.expect(Rule::expr)),
                    }
                } else {
                    FormulaKind::Holds(condition)
                }
            }
        };
        Formula { kind, span }
    }

    fn window(&mut self, piece: Piece<'_>) -> Window {
        let span = self.span(&piece);
        let mut ends = Parts::of(piece).all(Rule::expr);
        let mut end = || self.expr(ends.next().expect("a window has two ends"));
        Window { from: end(), to: end(), span }
    }

    fn run(&mut self, piece: Piece<'_>) -> Run {
        let span = self.span(&piece);
        let mut settings = Vec::new();
        for part in Parts::of(piece).rest() {
            let span = self.span(&part);
            if let Some(kind) = self.setting(part) {
                settings.push(RunSetting { kind, span });
            }
        }
        Run { settings, span }
    }

    /// A line of `run`; none for its keyword and braces.
    fn setting(&mut self, piece: Piece<'_>) -> Option<RunSettingKind> {
        let rule = piece.as_rule();
        let mut parts = Parts::of(piece);
        Some(match rule {
            Rule::until => {
                parts.expect(Rule::kw_until);
                RunSettingKind::Until(self.time(parts.expect(Rule::expr)))
            }
            Rule::stop_when => {
                parts.expect(Rule::kw_stop);
                parts.expect(Rule::kw_when);
                RunSettingKind::StopWhen(self.expr(parts.expect(Rule::expr)))
            }
            Rule::record => self.record(parts),
            Rule::output => {
                let name = self.name(parts.expect(Rule::name));
                parts.expect(Rule::kw_to);
                RunSettingKind::Output { name, file: self.text(parts.expect(Rule::string)) }
            }
            Rule::set => {
                let name = self.name(parts.expect(Rule::name));
                RunSettingKind::Set { name, value: self.time(parts.expect(Rule::expr)) }
            }
            _ => return None,
        })
    }

    fn record(&mut self, mut parts: Parts<'_>) -> RunSettingKind {
        parts.expect(Rule::kw_record);
        let mut columns = vec![self.expr(parts.expect(Rule::expr))];
        while parts.skip(Rule::comma) {
            columns.push(self.expr(parts.expect(Rule::expr)));
        }
        let period = parts.skip(Rule::kw_every).then(|| self.time(parts.expect(Rule::expr)));
        parts.expect(Rule::kw_to);
        RunSettingKind::Record { columns, period, file: self.text(parts.expect(Rule::string)) }
    }

    /// An expression where a time, a rate or a setting stands.
    pub(super) fn time(&mut self, piece: Piece<'_>) -> Expr {
        let expr = self.expr(piece);
        self.refuse_unit_index(&expr);
        expr
    }
}
