//! Events: what `emit` sends, and what `on` hears.

use super::context::{Context, Home, Member, Scope, Value};
use super::error::{EventError, NameError, TypeError};
use super::ir::{Action, ExprId, ExprKind, TypeId};
use super::suggest::closest;
use super::types::{Slot, Ty};
use crate::base::Span;
use crate::syntax::ast;

/// What an `on` hears.
pub(super) struct Heard<'a> {
    /// The events, by type and number.
    pub events: Vec<(TypeId, usize)>,
    /// From whom.
    pub from: Option<ExprId>,
    /// The names of what the message carries.
    pub received: Vec<(&'a str, Slot)>,
}

impl<'a> Context<'a> {
    /// `emit e(v) after d`, in an interaction `emit a.e(v) after d`.
    pub fn emission(
        &mut self,
        scope: &mut Scope<'a>,
        place: &'a ast::Place,
        args: &'a [ast::Expr],
        delay: Option<&'a ast::Expr>,
        span: Span,
    ) -> Option<Action> {
        let found = self.sender(scope, place);
        let slots = found.map_or(Vec::new(), |(_, ty, event)| self.agents[ty.index()].events[event].clone());
        let name = &place.variable.text;
        let mut values = Vec::with_capacity(args.len());
        for (k, arg) in args.iter().enumerate() {
            let value = match (slots.get(k), found) {
                (Some(slot), Some((_, ty, event))) => {
                    let param = &self.model.types[ty].events[event].params[k].name;
                    let what = format!("`{param}` of event `{name}`");
                    self.lower_into(scope, arg, *slot, &what)
                }
                _ => self.lower(scope, arg),
            };
            values.push(value.id);
        }
        let delay =
            delay.map(|delay| self.duration(scope, delay, "a delay", "0 s or more", |delay| delay >= 0.0).id);
        let (agent, _, event) = found?;
        let needed = slots.len();
        if !self.check_count(name, needed, needed, args.len(), span) {
            return None;
        }
        Some(Action::Emit { agent: agent.id, event, values, delay, span })
    }

    /// Who emits: the agent, its type, the number of the event there.
    fn sender(&mut self, scope: &Scope<'a>, place: &'a ast::Place) -> Option<(Value, TypeId, usize)> {
        let name = &place.variable;
        match (scope.home, &place.owner) {
            (Home::Pair(number), Some(owner)) => {
                let (which, ty) = self.participant(number, owner)?;
                let agent = self.push(ExprKind::Participant(which), Ty::Agent(ty), owner.span);
                Some((agent, ty, self.event_of(ty, name)?))
            }
            (Home::Pair(number), None) => {
                let names = self.pairs[number].participants;
                let participants = names.map(|names| names.map(|(participant, _)| participant.to_string()));
                let (name, span) = (name.text.clone(), place.span);
                self.report(EventError::WhoEmits { name, span, participants });
                None
            }
            (Home::Agent(ty, _), owner) => {
                if let Some(owner) = owner
                    && owner.text != "self"
                {
                    let place_text = format!("{}.{}", owner.text, name.text);
                    self.report(EventError::EmitsForOther { place: place_text, span: place.span });
                    return None;
                }
                let event = self.event_of(ty, name)?;
                let agent = self.push(ExprKind::SelfAgent, Ty::Agent(ty), place.span);
                Some((agent, ty, event))
            }
            (Home::File | Home::Function | Home::Initial(_) | Home::Construction, _) => {
                unreachable!("actions stand in agents and interactions")
            }
        }
    }

    /// The number of an event of a type; none, and a diagnostic, if it has none of this name.
    fn event_of(&mut self, ty: TypeId, name: &ast::Name) -> Option<usize> {
        match self.agents[ty.index()].members.get(name.text.as_str()) {
            Some((Member::Event(number), _)) => return Some(*number),
            Some((Member::Twice, _)) => return None,
            Some(_) | None => {}
        }
        let events = self.model.types[ty].events.iter().map(|event| event.name.as_str());
        let similar = closest(&name.text, events);
        let owner = Some(self.model.types[ty].name.clone());
        self.report(EventError::Unknown { name: name.text.clone(), owner, span: name.span, similar });
        None
    }

    /// `on e(w) from sender`.
    pub fn hearing(
        &mut self,
        scope: &mut Scope<'a>,
        event: &'a ast::Name,
        binders: &'a [ast::Name],
        from: Option<&'a ast::Expr>,
    ) -> Heard<'a> {
        let sender = from.map(|from| {
            let agent = self.lower(scope, from);
            (from.span, self.as_link(scope, agent, from.span))
        });
        let events = match sender {
            None => self.events_of_any(event),
            Some((span, value)) => match value.ty.agent_type() {
                Some(ty) => self.event_of(ty, event).map(|number| (ty, number)).into_iter().collect(),
                None => {
                    if value.ty != Ty::Wrong {
                        let found = self.describe(value.ty);
                        self.report(TypeError::NotAnAgent { found, span });
                    }
                    Vec::new()
                }
            },
        };
        let received = self.received(event, binders, &events);
        Heard { events, from: sender.map(|(_, value)| value.id), received }
    }

    /// The events of this name of all types, which carry the same; none, and a diagnostic, if there are none.
    fn events_of_any(&mut self, name: &ast::Name) -> Vec<(TypeId, usize)> {
        let of_type = |number: usize| match self.agents[number].members.get(name.text.as_str()) {
            Some((Member::Event(event), _)) => Some((TypeId::new(number), *event)),
            Some(_) | None => None,
        };
        let found: Vec<(TypeId, usize)> = (0..self.agents.len()).filter_map(of_type).collect();
        let Some(&first) = found.first() else {
            let events = self.model.types.iter().flat_map(|ty| &ty.events);
            let similar = closest(&name.text, events.map(|event| event.name.as_str()));
            self.report(EventError::Unknown {
                name: name.text.clone(),
                owner: None,
                span: name.span,
                similar,
            });
            return found;
        };
        let carries = |(ty, event): (TypeId, usize)| {
            let slots = self.agents[ty.index()].events[event].iter();
            slots.map(|slot| (slot.ty, slot.unit.map(|unit| unit.dimension))).collect::<Vec<_>>()
        };
        if let Some(&other) = found.iter().find(|&&other| carries(other) != carries(first)) {
            let declared = [first, other].map(|(ty, event)| {
                let ty = &self.model.types[ty];
                (ty.name.clone(), ty.events[event].span)
            });
            self.report(EventError::Differ { name: name.text.clone(), span: name.span, declared });
            return vec![first];
        }
        found
    }

    /// The names that an `on` gives to what its message carries.
    fn received(
        &mut self,
        name: &ast::Name,
        binders: &'a [ast::Name],
        events: &[(TypeId, usize)],
    ) -> Vec<(&'a str, Slot)> {
        let mut received: Vec<(&'a str, Slot)> = Vec::new();
        for (k, binder) in binders.iter().enumerate() {
            if let Some(first) = binders[..k].iter().find(|other| other.text == binder.text) {
                let (name, span, first) = (binder.text.clone(), binder.span, first.span);
                self.report(NameError::Taken { name, span, first });
            }
            let slot = events.first().and_then(|&(ty, event)| self.agents[ty.index()].events[event].get(k));
            received.push((&binder.text, slot.copied().unwrap_or(Slot::plain(Ty::Wrong))));
        }
        if let Some(&(ty, event)) = events.first() {
            let declared = &self.model.types[ty].events[event];
            let (carried, found) = (declared.params.len(), binders.len());
            if let (Some(first), Some(last)) = (binders.first(), binders.last())
                && found != carried
            {
                let span = Span { end: last.span.end, ..first.span };
                let (name, declared) = (name.text.clone(), declared.span);
                self.report(EventError::Bound { name, found, carried, span, declared });
            }
        }
        received
    }
}
