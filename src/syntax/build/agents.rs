//! Agents: variables, links, events, regions, modes, flows and transitions.

use super::Builder;
use crate::syntax::ast::*;
use crate::syntax::error::SyntaxError;
use crate::syntax::grammar::{Parts, Piece, Rule};

impl Builder<'_> {
    pub(super) fn agent(&mut self, piece: Piece<'_>) -> Agent {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_agent);
        let name = self.name(parts.expect(Rule::name));
        let formals = parts.next_if(Rule::formals).map(|formals| self.formals(formals)).unwrap_or_default();
        let items = parts.rest().filter_map(|part| self.agent_item(part)).collect();
        Agent { name, formals, items, span }
    }

    /// What stands in an agent; none for its braces.
    fn agent_item(&mut self, piece: Piece<'_>) -> Option<AgentItem> {
        Some(match piece.as_rule() {
            Rule::variables => AgentItem::Variables(self.variables(piece)),
            Rule::link => AgentItem::Link(self.link(piece)),
            Rule::event => AgentItem::Event(self.event(piece)),
            Rule::region => AgentItem::Region(self.region(piece)),
            _ => AgentItem::Body(self.body_item(piece)?),
        })
    }

    fn variables(&mut self, piece: Piece<'_>) -> Variables {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let kind = if parts.next().as_rule() == Rule::kw_state {
            VariableKind::State
        } else {
            VariableKind::Discrete
        };
        let variables = parts.all(Rule::variable).map(|variable| self.variable(variable)).collect();
        Variables { kind, variables, span }
    }

    fn variable(&mut self, piece: Piece<'_>) -> Variable {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let name = self.name(parts.expect(Rule::name));
        let ty = self.type_annotation(&mut parts);
        let kind = if parts.peek() == Some(Rule::tilde) { GivenKind::Draw } else { GivenKind::Value };
        let given = parts.skip(Rule::tilde) || parts.skip(Rule::equals);
        let initial = given.then(|| Given { kind, value: self.expr(parts.expect(Rule::expr)) });
        Variable { name, ty, initial, span }
    }

    fn link(&mut self, piece: Piece<'_>) -> Link {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_link);
        let name = self.name(parts.expect(Rule::name));
        let target = parts.skip(Rule::colon).then(|| self.name(parts.expect(Rule::name)));
        Link { name, target, value: self.expr_after(&mut parts, Rule::equals), span }
    }

    fn event(&mut self, piece: Piece<'_>) -> Event {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_event);
        let name = self.name(parts.expect(Rule::name));
        let formals = parts.next_if(Rule::formals).map(|formals| self.formals(formals)).unwrap_or_default();
        Event { name, formals, span }
    }

    fn region(&mut self, piece: Piece<'_>) -> Region {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.expect(Rule::kw_region);
        let name = self.name(parts.expect(Rule::name));
        Region { name, items: self.body(parts), span }
    }

    fn body(&mut self, parts: Parts<'_>) -> Vec<BodyItem> {
        parts.rest().filter_map(|part| self.body_item(part)).collect()
    }

    /// What stands in a mode, a region or an agent; none for braces.
    fn body_item(&mut self, piece: Piece<'_>) -> Option<BodyItem> {
        Some(match piece.as_rule() {
            Rule::definition => BodyItem::Let(self.definition(piece)),
            Rule::flow => BodyItem::Flow(self.flow(piece)),
            Rule::invariant => BodyItem::Invariant(self.claim(piece)),
            Rule::assertion => BodyItem::Assert(self.claim(piece)),
            Rule::mode => BodyItem::Mode(self.mode(piece)),
            Rule::entry => BodyItem::Entry(self.hook(piece)),
            Rule::exit => BodyItem::Exit(self.hook(piece)),
            Rule::transition => BodyItem::Transition(self.transition(piece)),
            _ => return None,
        })
    }

    fn flow(&mut self, piece: Piece<'_>) -> Flow {
        let span = self.span(&piece);
        let equations =
            Parts::of(piece).all(Rule::equation).map(|equation| self.equation(equation)).collect();
        Flow { equations, span }
    }

    fn equation(&mut self, piece: Piece<'_>) -> FlowEquation {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let state = self.name(parts.expect(Rule::name));
        parts.expect(Rule::prime);
        parts.expect(Rule::equals);
        FlowEquation { state, rate: self.expr(parts.expect(Rule::expr)), span }
    }

    fn claim(&mut self, piece: Piece<'_>) -> Claim {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        parts.next();
        let condition = self.expr(parts.expect(Rule::expr));
        Claim { condition, message: parts.next_if(Rule::string).map(|message| self.text(message)), span }
    }

    fn mode(&mut self, piece: Piece<'_>) -> Mode {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let initial = parts.next_if(Rule::kw_initial).map(|word| self.span(&word));
        parts.expect(Rule::kw_mode);
        let name = self.name(parts.expect(Rule::name));
        if name.text == "history" {
            self.errors.push(SyntaxError::MisplacedHistory { span: name.span });
        }
        Mode { name, initial, items: self.body(parts), span }
    }

    /// `entry` or `exit` with its actions.
    fn hook(&mut self, piece: Piece<'_>) -> Actions {
        let mut parts = Parts::of(piece);
        parts.next();
        self.actions(parts.expect(Rule::actions))
    }

    pub(super) fn transition(&mut self, piece: Piece<'_>) -> Transition {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let label = parts.next_if(Rule::name).map(|name| self.name(name));
        parts.skip(Rule::colon);
        let trigger = self.trigger(parts.expect(Rule::trigger));
        let priority = self.expr_after(&mut parts, Rule::kw_priority);
        let target = parts.skip(Rule::arrow).then(|| self.target(parts.expect(Rule::target)));
        let actions = parts.next_if(Rule::actions).map(|actions| self.actions(actions));
        Transition { label, trigger, priority, target, actions, span }
    }

    fn trigger(&mut self, piece: Piece<'_>) -> Trigger {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let kind = match parts.peek() {
            Some(Rule::kw_when) => TriggerKind::When,
            _ => self.timed_or_heard(&mut parts),
        };
        Trigger { kind, guard: self.expr_after(&mut parts, Rule::kw_when), span }
    }

    fn timed_or_heard(&mut self, parts: &mut Parts<'_>) -> TriggerKind {
        let word = parts.next().as_rule();
        if word == Rule::kw_on {
            let event = self.name(parts.expect(Rule::name));
            let binders = parts.next_if(Rule::binders).map(Parts::of);
            let binders = binders
                .into_iter()
                .flat_map(|names| names.all(Rule::name))
                .map(|name| self.name(name))
                .collect();
            return TriggerKind::On { event, binders, sender: self.expr_after(parts, Rule::kw_from) };
        }
        let time = self.time(parts.expect(Rule::expr));
        match word {
            Rule::kw_after => TriggerKind::After(time),
            Rule::kw_every => TriggerKind::Every(time),
            _ => TriggerKind::Rate(time),
        }
    }
}
