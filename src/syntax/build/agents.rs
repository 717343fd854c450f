//! Agents: variables, links, events, regions, modes, flows and transitions.

use super::Builder;
use crate::syntax::ast::*;
use crate::syntax::error::SyntaxError;
use crate::syntax::grammar::Rule;
use crate::syntax::pieces::{Parts, Piece, Unread};

impl Builder<'_> {
    pub(super) fn agent(&mut self, piece: Piece<'_>) -> Result<Agent, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_agent)?;
        let name = self.name(parts.expect(Rule::name)?);
        let formals = parts.next_if(Rule::formals)?.map(|formals| self.formals(formals)).transpose()?;
        let items = self.many_of(parts, Self::agent_item)?;
        Ok(Agent { name, formals: formals.unwrap_or_default(), items, span })
    }

    /// What stands in an agent; none for its braces.
    fn agent_item(&mut self, piece: Piece<'_>) -> Result<Option<AgentItem>, Unread> {
        Ok(Some(match piece.rule() {
            Rule::variables => AgentItem::Variables(self.variables(piece)?),
            Rule::link => AgentItem::Link(Box::new(self.link(piece)?)),
            Rule::event => AgentItem::Event(Box::new(self.event(piece)?)),
            Rule::region => AgentItem::Region(Box::new(self.region(piece)?)),
            _ => return Ok(self.body_item(piece)?.map(AgentItem::Body)),
        }))
    }

    fn variables(&mut self, piece: Piece<'_>) -> Result<Variables, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let kind =
            if parts.any()?.rule() == Rule::kw_state { VariableKind::State } else { VariableKind::Discrete };
        let variables = self.list(parts.all(Rule::variable), Self::variable)?;
        Ok(Variables { kind, variables, span })
    }

    fn variable(&mut self, piece: Piece<'_>) -> Result<Variable, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let name = self.name(parts.expect(Rule::name)?);
        let ty = self.type_annotation(&mut parts)?;
        let kind = if parts.peek()? == Some(Rule::tilde) { GivenKind::Draw } else { GivenKind::Value };
        let given = parts.has(Rule::tilde)? || parts.has(Rule::equals)?;
        let initial = match given {
            true => Some(Given { kind, value: self.expr(parts.expect(Rule::expr)?)? }),
            false => None,
        };
        Ok(Variable { name, ty, initial, span })
    }

    fn link(&mut self, piece: Piece<'_>) -> Result<Link, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_link)?;
        let name = self.name(parts.expect(Rule::name)?);
        let target = match parts.has(Rule::colon)? {
            true => Some(self.name(parts.expect(Rule::name)?)),
            false => None,
        };
        Ok(Link { name, target, value: self.expr_after(&mut parts, Rule::equals)?, span })
    }

    fn event(&mut self, piece: Piece<'_>) -> Result<Event, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_event)?;
        let name = self.name(parts.expect(Rule::name)?);
        let formals = parts.next_if(Rule::formals)?.map(|formals| self.formals(formals)).transpose()?;
        Ok(Event { name, formals: formals.unwrap_or_default(), span })
    }

    fn region(&mut self, piece: Piece<'_>) -> Result<Region, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_region)?;
        let name = self.name(parts.expect(Rule::name)?);
        Ok(Region { name, items: self.many_of(parts, Self::body_item)?, span })
    }

    /// What stands in a mode, a region or an agent; none for braces.
    fn body_item(&mut self, piece: Piece<'_>) -> Result<Option<BodyItem>, Unread> {
        Ok(Some(match piece.rule() {
            Rule::definition => BodyItem::Let(Box::new(self.definition(piece)?)),
            Rule::flow => BodyItem::Flow(self.flow(piece)?),
            Rule::invariant => BodyItem::Invariant(Box::new(self.claim(piece)?)),
            Rule::assertion => BodyItem::Assert(Box::new(self.claim(piece)?)),
            Rule::mode => BodyItem::Mode(Box::new(self.mode(piece)?)),
            Rule::entry => BodyItem::Entry(self.hook(piece)?),
            Rule::exit => BodyItem::Exit(self.hook(piece)?),
            Rule::transition => BodyItem::Transition(Box::new(self.transition(piece)?)),
            _ => return Ok(None),
        }))
    }

    fn flow(&mut self, piece: Piece<'_>) -> Result<Flow, Unread> {
        let span = self.span(&piece);
        let equations = self.many_of(Parts::of(piece), |this, part| match part.rule() {
            Rule::equation => this.equation(part).map(Some),
            _ => Ok(None),
        })?;
        Ok(Flow { equations, span })
    }

    fn equation(&mut self, piece: Piece<'_>) -> Result<FlowEquation, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let state = self.name(parts.expect(Rule::name)?);
        parts.expect(Rule::prime)?;
        parts.expect(Rule::equals)?;
        Ok(FlowEquation { state, rate: self.expr(parts.expect(Rule::expr)?)?, span })
    }

    fn claim(&mut self, piece: Piece<'_>) -> Result<Claim, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.any()?;
        let condition = self.expr(parts.expect(Rule::expr)?)?;
        Ok(Claim { condition, message: parts.next_if(Rule::string)?.map(|message| self.text(message)), span })
    }

    fn mode(&mut self, piece: Piece<'_>) -> Result<Mode, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let initial = parts.next_if(Rule::kw_initial)?.map(|word| self.span(&word));
        parts.expect(Rule::kw_mode)?;
        let name = self.name(parts.expect(Rule::name)?);
        if name.text == "history" {
            self.errors.push(SyntaxError::MisplacedHistory { span: name.span });
        }
        Ok(Mode { name, initial, items: self.many_of(parts, Self::body_item)?, span })
    }

    /// `entry` or `exit` with its actions.
    fn hook(&mut self, piece: Piece<'_>) -> Result<Actions, Unread> {
        let mut parts = Parts::of(piece);
        parts.any()?;
        self.actions(parts.expect(Rule::actions)?)
    }

    pub(super) fn transition(&mut self, piece: Piece<'_>) -> Result<Transition, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let label = parts.next_if(Rule::name)?.map(|name| self.name(name));
        parts.has(Rule::colon)?;
        let trigger = self.trigger(parts.expect(Rule::trigger)?)?;
        let priority = self.expr_after(&mut parts, Rule::kw_priority)?.map(Box::new);
        let target = match parts.has(Rule::arrow)? {
            true => Some(self.target(parts.expect(Rule::target)?)?),
            false => None,
        };
        let actions = parts.next_if(Rule::actions)?.map(|actions| self.actions(actions)).transpose()?;
        Ok(Transition { label, trigger, priority, target, actions, span })
    }

    fn trigger(&mut self, piece: Piece<'_>) -> Result<Trigger, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let kind = match parts.peek()? {
            Some(Rule::kw_when) => TriggerKind::When,
            _ => self.timed_or_heard(&mut parts)?,
        };
        Ok(Trigger { kind, guard: self.expr_after(&mut parts, Rule::kw_when)?, span })
    }

    fn timed_or_heard(&mut self, parts: &mut Parts<'_>) -> Result<TriggerKind, Unread> {
        let word = parts.any()?.rule();
        if word == Rule::kw_on {
            let event = self.name(parts.expect(Rule::name)?);
            let binders = match parts.next_if(Rule::binders)? {
                Some(binders) => {
                    self.list(Parts::of(binders).all(Rule::name), |this, name| Ok(this.name(name)))?
                }
                None => Vec::new(),
            };
            let sender = self.expr_after(parts, Rule::kw_from)?.map(Box::new);
            return Ok(TriggerKind::On { event, binders, sender });
        }
        let time = self.time(parts.expect(Rule::expr)?)?;
        Ok(match word {
            Rule::kw_after => TriggerKind::After(time),
            Rule::kw_every => TriggerKind::Every(time),
            _ => TriggerKind::Rate(time),
        })
    }
}
