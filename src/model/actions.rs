//! Lists of actions: who may write what, and nothing twice.

use rustc_hash::FxHashMap;

use super::context::{Context, Home, Member, Scope, Value};
use super::error::{ActionError, NameError};
use super::ir::{Action, ExprKind, Given, TypeId, VarRef};
use super::limits;
use super::suggest::closest;
use super::types::{Slot, Ty};
use crate::base::Span;
use crate::syntax::ast::{self, ActionKind, GivenKind};

/// What a list has written so far, and where: a variable, or (without one) the mode, of a participant or of self (0).
#[derive(Clone, Default)]
pub(super) struct Written {
    places: FxHashMap<(usize, Option<VarRef>), Span>,
}

/// The variable that an assignment writes.
struct Place {
    agent: Value,
    /// 0 for self.
    participant: usize,
    variable: VarRef,
    slot: Slot,
}

impl<'a> Context<'a> {
    /// A list of actions, after `written`.
    pub fn actions(
        &mut self,
        scope: &mut Scope<'a>,
        list: &'a ast::Actions,
        written: &mut Written,
    ) -> Vec<Action> {
        let filled = list.actions.iter().filter_map(|action| self.action(scope, action, written));
        let mut actions: Vec<Action> = filled.collect();
        actions.shrink_to_fit();
        actions
    }

    fn action(
        &mut self,
        scope: &mut Scope<'a>,
        item: &'a ast::Action,
        written: &mut Written,
    ) -> Option<Action> {
        let span = item.span;
        match &item.kind {
            ActionKind::Assign { place, given } => self.assignment(scope, place, given, span, written),
            ActionKind::Create(constructor) => self.create(scope, constructor),
            ActionKind::Destroy(agent) => self.destroy(scope, agent, span),
            ActionKind::Emit { event, args, delay } => {
                self.emission(scope, event, args, delay.as_deref(), span)
            }
            ActionKind::ChangeMode { participant, target } => {
                self.mode_change(scope, participant, target, span, written)
            }
            ActionKind::Stop(reason) => {
                Some(Action::Stop { reason: reason.as_ref().map(|text| text.value.clone()), span })
            }
            ActionKind::If { branches, otherwise } => {
                self.branches(scope, branches, otherwise.as_ref(), written, span)
            }
        }
    }

    fn assignment(
        &mut self,
        scope: &mut Scope<'a>,
        place: &'a ast::Place,
        given: &'a ast::Given,
        span: Span,
        written: &mut Written,
    ) -> Option<Action> {
        let found = self.place(scope, place);
        let slot = found.as_ref().map_or(Slot::plain(Ty::Wrong), |found| found.slot);
        let new = match given.kind {
            GivenKind::Value => {
                let what = format!("the new value of `{}`", place.variable.text);
                Some(Given::Value(self.lower_into(scope, &given.value, slot, &what).id))
            }
            GivenKind::Draw => self.lower_draw(scope, &given.value, slot).map(Given::Draw),
        };
        let Place { agent, participant, variable, .. } = found?;
        self.mark_written(written, (participant, Some(variable)), &place.variable.text, place.span);
        let agent = agent.id;
        Some(match new? {
            Given::Value(value) => Action::Assign { agent, variable, value, span },
            Given::Draw(draw) => {
                let (distribution, parameters) = (draw.distribution, draw.parameters().to_vec());
                Action::Draw { agent, variable, distribution, parameters, span }
            }
        })
    }

    fn mark_written(&mut self, written: &mut Written, key: (usize, Option<VarRef>), name: &str, span: Span) {
        if let Some(first) = written.places.insert(key, span) {
            self.report(ActionError::WrittenTwice { name: name.to_string(), span, first });
        }
    }

    /// What an assignment writes; none, and a diagnostic, if it may not.
    fn place(&mut self, scope: &mut Scope<'a>, place: &'a ast::Place) -> Option<Place> {
        match scope.home {
            Home::Pair(number) => self.place_in_pair(number, place),
            Home::Agent(ty, _) => match &place.owner {
                Some(owner) if owner.text != "self" => {
                    let place_text = format!("{}.{}", owner.text, place.variable.text);
                    self.report(ActionError::WritesOther { place: place_text, span: place.span });
                    None
                }
                _ => {
                    let agent = self.push(ExprKind::SelfAgent, Ty::Agent(ty), place.span);
                    self.variable(agent, 0, ty, &place.variable, scope)
                }
            },
            Home::File | Home::Function | Home::Initial(_) | Home::Construction => None,
        }
    }

    fn place_in_pair(&mut self, number: usize, place: &'a ast::Place) -> Option<Place> {
        let Some(owner) = &place.owner else {
            let participants = self.pairs[number].participants;
            let participants = participants.map(|two| two.map(|(name, _)| name.to_string()));
            let (name, span) = (place.variable.text.clone(), place.span);
            self.report(ActionError::WhoseVariable { name, span, participants });
            return None;
        };
        let (which, ty) = self.participant(number, owner)?;
        let agent = self.push(ExprKind::Participant(which), Ty::Agent(ty), owner.span);
        self.variable(agent, which, ty, &place.variable, &Scope::of(Home::Pair(number)))
    }

    /// A participant by name; none, and a diagnostic, if it is none.
    pub fn participant(&mut self, number: usize, name: &ast::Name) -> Option<(usize, TypeId)> {
        let participants = self.pairs[number].participants?;
        let which = participants.iter().position(|(participant, _)| *participant == name.text);
        if which.is_none() {
            let similar = closest(&name.text, participants.iter().map(|(participant, _)| *participant));
            let (name, span) = (name.text.clone(), name.span);
            self.report(NameError::Unknown { what: "participant", name, span, similar });
        }
        which.map(|which| (which, participants[which].1))
    }

    fn variable(
        &mut self,
        agent: Value,
        participant: usize,
        ty: TypeId,
        name: &'a ast::Name,
        scope: &Scope<'a>,
    ) -> Option<Place> {
        let names = &self.agents[ty.index()];
        let (what, help) = match names.members.get(name.text.as_str()).map(|(member, _)| *member) {
            Some(Member::State(number)) => {
                let (variable, slot) = (VarRef::State(number), names.states[number]);
                return Some(Place { agent, participant, variable, slot });
            }
            Some(Member::Discrete(number)) => {
                let (variable, slot) = (VarRef::Discrete(number), names.discretes[number]);
                return Some(Place { agent, participant, variable, slot });
            }
            Some(Member::Param(_)) => {
                ("a parameter", "parameters are constant; declare a `discrete` that starts there")
            }
            Some(Member::Let(_)) => {
                ("a `let`", "it follows from other values; assign those, or declare a `discrete`")
            }
            Some(Member::Link(_)) => ("a link", "links are set where the agent is made, in `system`"),
            Some(Member::Event(_)) => ("an event", "events are sent by `emit`"),
            Some(Member::Twice) => return None,
            None if scope.bound.iter().any(|(bound, _)| *bound == name.text) => {
                ("another agent", "only an `interaction` may write the agents that take part in it")
            }
            None if self.globals.contains_key(name.text.as_str()) => {
                ("a name of the file", "only states and discrete variables of agents change")
            }
            None => {
                self.no_member(ty, name);
                return None;
            }
        };
        self.report(ActionError::NotAssignable { name: name.text.clone(), what, span: name.span, help });
        None
    }

    fn mode_change(
        &mut self,
        scope: &mut Scope<'a>,
        participant: &'a ast::Name,
        target: &'a ast::Target,
        span: Span,
        written: &mut Written,
    ) -> Option<Action> {
        let Home::Pair(number) = scope.home else {
            let help = format!(
                "an agent changes its own mode behind its guard: `when ... -> {}`",
                target.path[0].text
            );
            let why = "only an interaction changes the mode of an agent by an action";
            self.report(ActionError::ModeChange { span, why, help });
            return None;
        };
        let (which, ty) = self.participant(number, participant)?;
        let target = self.resolve_destination(ty, super::ir::ModeId::new(0), target)?;
        self.mark_written(written, (which, None), &format!("{} ->", participant.text), span);
        Some(Action::Goto { participant: which, target, span })
    }

    fn branches(
        &mut self,
        scope: &mut Scope<'a>,
        branches: &'a [ast::Branch],
        otherwise: Option<&'a ast::Actions>,
        written: &mut Written,
        span: Span,
    ) -> Option<Action> {
        if branches.len() > limits::BRANCHES_MAX {
            self.report(ActionError::TooManyBranches { span, most: limits::BRANCHES_MAX });
            return None;
        }
        let before = written.clone();
        let mut parts = Vec::with_capacity(branches.len());
        for branch in branches {
            let condition = self.lower_condition(scope, &branch.condition);
            let mut inside = before.clone();
            let then = self.actions(scope, &branch.actions, &mut inside);
            written.places.extend(inside.places);
            parts.push((condition.id, then));
        }
        let mut rest = Vec::new();
        if let Some(list) = otherwise {
            let mut inside = before;
            rest = self.actions(scope, list, &mut inside);
            written.places.extend(inside.places);
        }
        for (condition, then) in parts.into_iter().rev() {
            rest = vec![Action::If { condition, then, otherwise: rest }];
        }
        rest.pop()
    }
}
