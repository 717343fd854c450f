//! The outermost level: imports, parameters, functions, interactions, the system, properties and the run.

use super::Builder;
use crate::syntax::ast::*;
use crate::syntax::grammar::Rule;
use crate::syntax::pieces::{Parts, Piece, Unread};

/// What `record` is followed by.
enum RecordWord {
    /// A column; behind `every` the period.
    Expr(Expr),
    Every,
    File(Text),
}

impl Builder<'_> {
    pub(super) fn item(&mut self, piece: Piece<'_>) -> Result<Item, Unread> {
        match piece.rule() {
            Rule::import => self.import(piece).map(Item::Import),
            Rule::param => self.param(piece).map(|item| Item::Param(Box::new(item))),
            Rule::definition => self.definition(piece).map(|item| Item::Let(Box::new(item))),
            Rule::function => self.function(piece).map(|item| Item::Fn(Box::new(item))),
            Rule::agent => self.agent(piece).map(|item| Item::Agent(Box::new(item))),
            Rule::interaction => self.interaction(piece).map(|item| Item::Interaction(Box::new(item))),
            Rule::system => self.system(piece).map(Item::System),
            Rule::property => self.property(piece).map(|item| Item::Property(Box::new(item))),
            Rule::run => self.run(piece).map(Item::Run),
            _ => Err(Unread),
        }
    }

    fn import(&mut self, piece: Piece<'_>) -> Result<Import, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_import)?;
        Ok(Import { path: self.text(parts.expect(Rule::string)?), span })
    }

    fn param(&mut self, piece: Piece<'_>) -> Result<Param, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_param)?;
        let name = self.name(parts.expect(Rule::name)?);
        let ty = self.type_annotation(&mut parts)?;
        parts.expect(Rule::equals)?;
        Ok(Param { name, ty, value: self.expr(parts.expect(Rule::expr)?)?, span })
    }

    pub(super) fn definition(&mut self, piece: Piece<'_>) -> Result<Let, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_let)?;
        let name = self.name(parts.expect(Rule::name)?);
        let ty = self.type_annotation(&mut parts)?;
        parts.expect(Rule::equals)?;
        Ok(Let { name, ty, value: self.expr(parts.expect(Rule::expr)?)?, span })
    }

    fn function(&mut self, piece: Piece<'_>) -> Result<Fn, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_fn)?;
        let name = self.name(parts.expect(Rule::name)?);
        let formals = self.formals(parts.expect(Rule::formals)?)?;
        let ty = self.type_annotation(&mut parts)?;
        parts.expect(Rule::equals)?;
        Ok(Fn { name, formals, ty, body: self.expr(parts.expect(Rule::expr)?)?, span })
    }

    pub(super) fn formals(&mut self, piece: Piece<'_>) -> Result<Vec<Formal>, Unread> {
        self.list(Parts::of(piece).all(Rule::formal), Self::formal)
    }

    fn formal(&mut self, piece: Piece<'_>) -> Result<Formal, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let name = self.name(parts.expect(Rule::name)?);
        parts.expect(Rule::colon)?;
        let ty = self.type_name(parts.expect(Rule::type_name)?)?;
        Ok(Formal { name, ty, default: self.expr_after(&mut parts, Rule::equals)?.map(Box::new), span })
    }

    fn interaction(&mut self, piece: Piece<'_>) -> Result<Interaction, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_interaction)?;
        let name = self.name(parts.expect(Rule::name)?);
        let formals = self.formals(parts.expect(Rule::formals)?)?;
        let items = self.many_of(parts, |this, part| match part.rule() {
            Rule::definition => Ok(Some(InteractionItem::Let(Box::new(this.definition(part)?)))),
            Rule::transition => Ok(Some(InteractionItem::Transition(Box::new(this.transition(part)?)))),
            _ => Ok(None),
        })?;
        Ok(Interaction { name, formals, items, span })
    }

    fn system(&mut self, piece: Piece<'_>) -> Result<System, Unread> {
        let span = self.span(&piece);
        let instances = self.many_of(Parts::of(piece), |this, part| match part.rule() {
            Rule::instance => this.instance(part).map(Some),
            _ => Ok(None),
        })?;
        Ok(System { instances, span })
    }

    fn instance(&mut self, piece: Piece<'_>) -> Result<Instance, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let name = self.name(parts.expect(Rule::name)?);
        parts.expect(Rule::equals)?;
        Ok(Instance { name, constructor: self.constructor(parts.expect(Rule::constructor)?)?, span })
    }

    pub(super) fn constructor(&mut self, piece: Piece<'_>) -> Result<Constructor, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let agent = self.name(parts.expect(Rule::name)?);
        let count = parts.next_if(Rule::count)?.map(|count| self.count(count)).transpose()?;
        let args = parts.next_if(Rule::named_args)?.map(|args| self.named_args(args)).transpose()?;
        let start = match parts.has(Rule::kw_in)? {
            true => Some(Box::new(self.plain_target(parts.expect(Rule::target)?)?)),
            false => None,
        };
        let source = self.expr_after(&mut parts, Rule::kw_from)?.map(Box::new);
        Ok(Constructor { agent, count, args: args.unwrap_or_default(), start, source, span })
    }

    fn count(&mut self, piece: Piece<'_>) -> Result<Count, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::open_bracket)?;
        Ok(match parts.next_if(Rule::expr)? {
            Some(expr) => Count::Exactly(self.expr(expr)?),
            None => Count::AllRows(span),
        })
    }

    fn named_args(&mut self, piece: Piece<'_>) -> Result<Vec<NamedArg>, Unread> {
        self.list(Parts::of(piece).all(Rule::named_arg), Self::named_arg)
    }

    fn named_arg(&mut self, piece: Piece<'_>) -> Result<NamedArg, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let name = self.name(parts.expect(Rule::name)?);
        let kind = if parts.any()?.rule() == Rule::tilde { GivenKind::Draw } else { GivenKind::Value };
        Ok(NamedArg { name, given: Given { kind, value: self.expr(parts.expect(Rule::expr)?)? }, span })
    }

    fn property(&mut self, piece: Piece<'_>) -> Result<Property, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_property)?;
        let name = self.name(parts.expect(Rule::name)?);
        parts.expect(Rule::equals)?;
        Ok(Property { name, formula: self.formula(parts.expect(Rule::formula)?)?, span })
    }

    fn formula(&mut self, piece: Piece<'_>) -> Result<Formula, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let first = parts.any()?;
        let kind = match first.rule() {
            Rule::kw_always | Rule::kw_eventually => {
                let always = first.rule() == Rule::kw_always;
                let window = parts.next_if(Rule::window)?.map(|window| self.window(window)).transpose()?;
                let inner = Box::new(self.formula(parts.expect(Rule::formula)?)?);
                if always {
                    FormulaKind::Always(window, inner)
                } else {
                    FormulaKind::Eventually(window, inner)
                }
            }
            _ => {
                let condition = self.expr(first)?;
                if parts.has(Rule::kw_until)? {
                    let window =
                        parts.next_if(Rule::window)?.map(|window| self.window(window)).transpose()?;
                    FormulaKind::Until {
                        before: condition,
                        window,
                        goal: self.expr(parts.expect(Rule::expr)?)?,
                    }
                } else {
                    FormulaKind::Holds(condition)
                }
            }
        };
        Ok(Formula { kind, span })
    }

    fn window(&mut self, piece: Piece<'_>) -> Result<Window, Unread> {
        let span = self.span(&piece);
        let mut ends = Parts::of(piece).all(Rule::expr);
        let mut end = || self.expr(ends.next().ok_or(Unread)??);
        Ok(Window { from: end()?, to: end()?, span })
    }

    fn run(&mut self, piece: Piece<'_>) -> Result<Run, Unread> {
        let span = self.span(&piece);
        let settings = self.many_of(Parts::of(piece), |this, part| {
            let span = this.span(&part);
            Ok(this.setting(part)?.map(|kind| RunSetting { kind, span }))
        })?;
        Ok(Run { settings, span })
    }

    /// A line of `run`; none for its keyword and braces.
    fn setting(&mut self, piece: Piece<'_>) -> Result<Option<RunSettingKind>, Unread> {
        let rule = piece.rule();
        let mut parts = Parts::of(piece);
        Ok(Some(match rule {
            Rule::until => {
                parts.expect(Rule::kw_until)?;
                RunSettingKind::Until(self.time(parts.expect(Rule::expr)?)?)
            }
            Rule::stop_when => {
                parts.expect(Rule::kw_stop)?;
                parts.expect(Rule::kw_when)?;
                RunSettingKind::StopWhen(self.expr(parts.expect(Rule::expr)?)?)
            }
            Rule::record => self.record(parts)?,
            Rule::output => {
                let name = self.name(parts.expect(Rule::name)?);
                parts.expect(Rule::kw_to)?;
                RunSettingKind::Output { name, file: self.text(parts.expect(Rule::string)?) }
            }
            Rule::set => {
                let name = self.name(parts.expect(Rule::name)?);
                RunSettingKind::Set { name, value: self.time(parts.expect(Rule::expr)?)? }
            }
            _ => return Ok(None),
        }))
    }

    fn record(&mut self, parts: Parts<'_>) -> Result<RunSettingKind, Unread> {
        let words = self.many_of(parts, |this, part| {
            Ok(match part.rule() {
                Rule::expr => Some(RecordWord::Expr(this.expr(part)?)),
                Rule::kw_every => Some(RecordWord::Every),
                Rule::string => Some(RecordWord::File(this.text(part))),
                _ => None,
            })
        })?;
        let (mut columns, mut period, mut file, mut is_every) = (Vec::new(), None, None, false);
        for word in words {
            match word {
                RecordWord::Every => is_every = true,
                RecordWord::Expr(expr) if is_every => {
                    self.refuse_unit_index(&expr);
                    period = Some(expr);
                }
                RecordWord::Expr(expr) => columns.push(expr),
                RecordWord::File(text) => file = Some(text),
            }
        }
        columns.shrink_to_fit();
        Ok(RunSettingKind::Record { columns, period, file: file.ok_or(Unread)? })
    }

    /// An expression where a time, a rate or a setting stands.
    pub(super) fn time(&mut self, piece: Piece<'_>) -> Result<Expr, Unread> {
        let expr = self.expr(piece)?;
        self.refuse_unit_index(&expr);
        Ok(expr)
    }
}
