//! Pass 3: what agents do in their modes: flows, claims, entry and exit; and what there is to record.

use rustc_hash::FxHashMap;

use super::actions::Written;
use super::context::{Context, Home, Meaning, Member, Progress, Scope};
use super::error::{ModeError, NameError};
use super::ir::{Action, AgentType, Claim, ModeId, TypeId, VarRef};
use super::suggest::closest;
use super::types::{Slot, Ty};
use crate::base::Span;
use crate::syntax::ast::{self, AgentItem, BodyItem};

/// Fills in every agent type.
pub(super) fn fill_agents(context: &mut Context) {
    for number in 0..context.agents.len() {
        let ty = TypeId::new(number);
        context.collect_declared(ty);
        context.fill_modes(ty);
        context.check_flows(ty);
        context.fill_transitions(ty);
        context.model.types[ty].shrink_to_fit();
    }
}

impl<'a> Context<'a> {
    fn collect_declared(&mut self, ty: TypeId) {
        let names = &self.agents[ty.index()];
        let mut members =
            names.members.iter().map(|(name, (member, span))| (*span, *name, *member)).collect::<Vec<_>>();
        members.sort_by_key(|(span, ..)| *span);
        let declared = members.into_iter().filter_map(|(_, name, member)| {
            let variable = match member {
                Member::Param(number) => VarRef::Param(number),
                Member::State(number) => VarRef::State(number),
                Member::Discrete(number) => VarRef::Discrete(number),
                Member::Link(number) => VarRef::Link(number),
                Member::Let(definition) => match self.definitions[definition].progress {
                    Progress::Done(Meaning::Let(number, _)) => VarRef::Let(number),
                    Progress::Waiting | Progress::Running | Progress::Done(_) => return None,
                },
                Member::Event(_) | Member::Twice => return None,
            };
            Some((name.to_string(), variable))
        });
        let declared = declared.collect();
        self.model.types[ty].declared = declared;
    }

    /// The parts of a mode's text, or of the agent's outside its modes.
    pub fn mode_items(&self, ty: TypeId, mode: ModeId) -> Vec<&'a BodyItem> {
        let names = &self.agents[ty.index()];
        match names.modes[mode.index()] {
            Some(items) => items.iter().collect(),
            None => {
                let body = |part: &'a AgentItem| match part {
                    AgentItem::Body(item) => Some(item),
                    AgentItem::Variables(_)
                    | AgentItem::Link(_)
                    | AgentItem::Event(_)
                    | AgentItem::Region(_) => None,
                };
                names.item.items.iter().filter_map(body).collect()
            }
        }
    }

    fn fill_modes(&mut self, ty: TypeId) {
        for number in 0..self.model.types[ty].modes.len() {
            let mode = ModeId::new(number);
            let (mut written_entry, mut written_exit) = (Written::default(), Written::default());
            let mut flowing = FxHashMap::default();
            for item in self.mode_items(ty, mode) {
                match item {
                    BodyItem::Flow(flow) => {
                        for equation in &flow.equations {
                            self.fill_equation(ty, mode, equation, &mut flowing);
                        }
                    }
                    BodyItem::Invariant(claim) => {
                        let claim = self.claim(ty, mode, claim);
                        self.model.types[ty].modes[mode].invariants.push(claim);
                    }
                    BodyItem::Assert(claim) => {
                        let claim = self.claim(ty, mode, claim);
                        self.model.types[ty].modes[mode].asserts.push(claim);
                    }
                    BodyItem::Entry(list) => {
                        let actions = self.mode_actions(ty, mode, list, &mut written_entry);
                        self.model.types[ty].modes[mode].entry.extend(actions);
                    }
                    BodyItem::Exit(list) => {
                        let actions = self.mode_actions(ty, mode, list, &mut written_exit);
                        self.model.types[ty].modes[mode].exit.extend(actions);
                    }
                    BodyItem::Let(_) | BodyItem::Mode(_) | BodyItem::Transition(_) => {}
                }
            }
        }
    }

    fn mode_actions(
        &mut self,
        ty: TypeId,
        mode: ModeId,
        list: &'a ast::Actions,
        written: &mut Written,
    ) -> Vec<Action> {
        self.actions(&mut Scope::of(Home::Agent(ty, mode)), list, written)
    }

    fn claim(&mut self, ty: TypeId, mode: ModeId, item: &'a ast::Claim) -> Claim {
        let condition = self.lower_condition(&mut Scope::of(Home::Agent(ty, mode)), &item.condition);
        let message = item.message.as_ref().map(|text| text.value.clone());
        Claim { condition: condition.id, message, span: item.span }
    }

    /// `flowing` holds the states that have an equation in this mode, with its place.
    fn fill_equation(
        &mut self,
        ty: TypeId,
        mode: ModeId,
        equation: &'a ast::FlowEquation,
        flowing: &mut FxHashMap<usize, Span>,
    ) {
        let name = &equation.state;
        let what = format!("the rate of `{}`", name.text);
        let mut scope = Scope::of(Home::Agent(ty, mode));
        let rate = self.lower_into(&mut scope, &equation.rate, Slot::plain(Ty::Real), &what);
        let Some(state) = self.flowing(ty, name) else { return };
        let slot = self.agents[ty.index()].states[state].per_time();
        self.expect(rate, slot, &what);
        if let Some(&first) = flowing.get(&state) {
            return self.report(ModeError::TwoFlows { state: name.text.clone(), span: equation.span, first });
        }
        flowing.insert(state, equation.span);
        self.model.types[ty].modes[mode].flow.push((state, rate.id, equation.span));
    }

    /// The number of the state of this name; none, and a diagnostic, if it is no state.
    fn flowing(&mut self, ty: TypeId, name: &ast::Name) -> Option<usize> {
        let names = &self.agents[ty.index()];
        let (what, help) = match names.members.get(name.text.as_str()).map(|(member, _)| *member) {
            Some(Member::State(number)) => return Some(number),
            Some(Member::Discrete(_)) => {
                ("a discrete variable", "declare it `state`, or set it by an action")
            }
            Some(Member::Param(_)) => {
                ("a parameter", "declare a `state` with another name, and start it there")
            }
            Some(Member::Let(_)) => {
                ("a `let`", "a `let` follows from other values; declare a `state` instead")
            }
            Some(Member::Link(_)) => ("a link", "only numbers flow"),
            Some(Member::Event(_)) => ("an event", "only numbers flow"),
            Some(Member::Twice) => return None,
            None => {
                let similar =
                    closest(&name.text, self.model.types[ty].states.iter().map(|state| state.name.as_str()));
                let (name, span) = (name.text.clone(), name.span);
                self.report(NameError::Unknown { what: "state", name, span, similar });
                return None;
            }
        };
        self.report(ModeError::NotAState { name: name.text.clone(), what, span: name.span, help });
        None
    }

    /// Every state has exactly one flow in every leaf mode, of all regions together: the leaf's own or that of a mode around it.
    fn check_flows(&mut self, ty: TypeId) {
        if self.agents[ty.index()].incomplete {
            return;
        }
        let mut missing: FxHashMap<usize, Vec<(String, Span)>> = FxHashMap::default();
        let mut twice: Vec<(usize, Span, Span)> = Vec::new();
        let model = &self.model.types[ty];
        let leaves = model.leaves();
        for number in 0..model.n_configurations() {
            let chosen = AgentType::configuration(&leaves, number);
            let mut flows: FxHashMap<usize, Span> = FxHashMap::default();
            for mode in model.active(&chosen).into_iter().rev() {
                for &(state, _, span) in &model.modes[mode].flow {
                    if let Some(inner) = flows.insert(state, span) {
                        twice.push((state, inner, span));
                    }
                }
            }
            for state in (0..model.states.len()).filter(|state| !flows.contains_key(state)) {
                let path = model.path(&chosen);
                missing.entry(state).or_default().push((path, model.modes[chosen[0]].span));
            }
        }
        twice.sort_unstable();
        twice.dedup();
        for (state, span, first) in twice {
            let state = self.model.types[ty].states[state].name.clone();
            self.report(ModeError::TwoFlows { state, span, first });
        }
        for state in 0..self.model.types[ty].states.len() {
            let Some(modes) = missing.remove(&state) else { continue };
            let variable = &self.model.types[ty].states[state];
            let names = &self.agents[ty.index()];
            let twice = matches!(names.members.get(variable.name.as_str()), Some((Member::Twice, _)));
            if twice || names.states[state].ty != Ty::Real {
                continue;
            }
            let (name, declared) = (variable.name.clone(), variable.span);
            let implicit = self.model.types[ty].modes.len() == 1;
            self.report(ModeError::NoFlow { state: name, declared, modes, implicit });
        }
    }
}
