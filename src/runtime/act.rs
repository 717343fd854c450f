//! Actions: what transitions would write is computed on the rows before; then it is written.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::base::Span;
use crate::codegen::program::{
    ActionList, ActionStep, Destination, Frame, FunctionId, Layout, Target, TransitionSystem,
};
use crate::codegen::trace::{Blame, Point};
use crate::runtime::advance::cut;
use crate::runtime::engine::{Engine, StopRequest};
use crate::runtime::failure::{Failure, Reason};
use crate::runtime::fold;
use crate::runtime::guards::Origin;
use crate::runtime::mail::Message;
use crate::runtime::population::Slots;
use crate::runtime::present::Depth;
use crate::runtime::route::{Move, remember, route};
use crate::runtime::truth;

/// A value for a column of an agent.
#[derive(Clone, Copy, Debug)]
pub struct Write {
    /// Whose.
    pub agent: usize,
    /// Which column.
    pub target: Target,
    /// Its value; the number of a leaf for a mode.
    pub value: f64,
    /// The assignment.
    pub span: Span,
}

/// All that one firing does, computed before anything is written.
#[derive(Clone, Debug, Default)]
pub struct Effect {
    /// Writes of exit actions, then of the transition's own, in order.
    pub writes: Vec<Write>,
    /// Writes of the exit actions of agents that the transition's own actions send to another mode.
    exits: Vec<Write>,
    /// Changes of mode.
    pub moves: Vec<Move>,
    /// Messages, each with its delay, s.
    pub sent: Vec<(Message, f64)>,
}

/// What the functions of a list of actions are read on.
#[derive(Clone, Copy)]
pub struct Rows<'r> {
    /// The agents that the list reads.
    pub frame: &'r Frame,
    /// Who they are.
    pub slots: &'r Slots,
    /// Those that `other` leaves out.
    pub own: &'r [usize],
}

/// What has been written in a micro-step.
#[derive(Clone, Debug, Default)]
pub struct Written {
    /// Agents of which a column was written, with their states and columns before.
    pub before: FxHashMap<usize, (Vec<f64>, Vec<f64>)>,
    /// Agents whose future has changed: written ones and those in a group or on an input with them.
    pub restarted: FxHashSet<usize>,
    /// Changes of mode.
    pub moves: Vec<Move>,
}

impl Engine<'_, '_> {
    /// The effect of a transition of an instance, read from the rows of the present instant.
    pub fn effect(&mut self, instance: u32, slots: &Slots) -> Result<Effect, Failure> {
        let (transition, pair) = match self.guards.definition(instance).origin {
            Origin::Transition(transition) => (transition, false),
            Origin::Pair(pair) => (&pair.transition, true),
            Origin::Gate(_) | Origin::Claim(_) => return Ok(Effect::default()),
        };
        let mut effect = Effect::default();
        if let Some(target) = transition.target
            && !pair
        {
            let change = self.route(slots[0], transition.source, target);
            self.exit(&change, &mut effect)?;
            effect.moves.push(change);
        }
        self.renew_hazard(transition, slots[0], &mut effect);
        let own = self.guards.roots(instance);
        self.run_list(&transition.actions, slots, &own, &transition.label, &mut effect)?;
        if !effect.exits.is_empty() {
            // An interaction changes modes by actions: all exits stand before them (rule 4).
            let actions = std::mem::replace(&mut effect.writes, std::mem::take(&mut effect.exits));
            effect.writes.extend(actions);
        }
        Ok(effect)
    }

    /// The change of mode of an agent by a transition of mode `source`.
    fn route(&self, agent: usize, source: usize, target: Destination) -> Move {
        let row = &self.agents.agents[agent];
        route(&self.program.types[row.ty], (agent, &row.aux), row.mode, source, target)
    }

    fn exit(&mut self, change: &Move, effect: &mut Effect) -> Result<(), Failure> {
        let ty = self.agents.agents[change.agent].ty;
        for &mode in &change.left {
            let node = &self.program.types[ty].modes[mode];
            let slots = self.agents.slots(&node.exit.frame, &[change.agent]);
            self.run_list(&node.exit, &slots, &[change.agent], &node.path, effect)?;
        }
        Ok(())
    }

    fn run_list(
        &mut self,
        list: &ActionList,
        slots: &Slots,
        own: &[usize],
        by: &str,
        effect: &mut Effect,
    ) -> Result<(), Failure> {
        self.run_steps((list, &list.steps), slots, own, by, effect)
    }

    fn run_steps(
        &mut self,
        (list, steps): (&ActionList, &[ActionStep]),
        slots: &Slots,
        own: &[usize],
        by: &str,
        effect: &mut Effect,
    ) -> Result<(), Failure> {
        for step in steps {
            match step {
                ActionStep::Assign { slot, target, value, span } => {
                    let number =
                        truth::value(&self.agents, &mut self.present, *value, &list.frame, slots, own);
                    let write = Write { agent: slots[*slot], target: *target, value: number, span: *span };
                    if !number.is_finite() {
                        let blame = self.blame(*value, &list.frame, slots, own);
                        return Err(self.action_not_finite(&write, blame).into());
                    }
                    effect.writes.push(write);
                }
                ActionStep::Draw { .. } | ActionStep::Emit { .. } => {
                    self.run_send(step, Rows { frame: &list.frame, slots, own }, effect)?;
                }
                ActionStep::If { condition, then, otherwise } => {
                    let holds =
                        truth::test(&self.agents, &mut self.present, condition, &list.frame, slots, own);
                    let taken = if holds { then } else { otherwise };
                    self.run_steps((list, taken), slots, own, by, effect)?;
                }
                ActionStep::Goto { slot, target, .. } => {
                    let change = self.route(slots[*slot], 0, *target);
                    let mut exit = Effect::default();
                    self.exit(&change, &mut exit)?;
                    effect.exits.append(&mut exit.writes);
                    effect.sent.append(&mut exit.sent);
                    effect.moves.push(change);
                }
                ActionStep::Stop { reason, .. } => {
                    let request = StopRequest { reason: reason.clone(), agent: slots[0], by: by.to_string() };
                    self.stop.get_or_insert(request);
                }
            }
        }
        Ok(())
    }

    /// What makes the single output of a function not finite, on the rows of the present instant.
    pub fn blame(
        &mut self,
        function: FunctionId,
        frame: &Frame,
        slots: &Slots,
        own: &[usize],
    ) -> Option<Blame> {
        let kernel = self.program.kernel(function);
        let folds = truth::gather(&self.agents, &mut self.present, kernel, frame, slots, own);
        let leaves = truth::leaves(&self.agents, &mut self.present, kernel, slots, &folds);
        let row = |agent: usize| self.present.view(&self.agents, agent);
        let views = fold::views(slots, &leaves, &row);
        self.program.blame(function, 0, &Point { frame, slots: &views, time: self.present.time })
    }

    /// An action gives a variable a value that is not finite.
    pub fn action_not_finite(&mut self, write: &Write, blame: Option<Blame>) -> Reason {
        let system = &self.program.types[self.agents.agents[write.agent].ty];
        let variable = match write.target {
            Target::State(k) => system.state_name(k),
            Target::Aux(column) => system.discretes[column - system.layout.discrete(0)].name.clone(),
            Target::Mode => "mode".into(),
        };
        Reason::ActionNotFinite {
            place: self.place(write.agent),
            variable,
            value: write.value,
            blame,
            span: write.span,
        }
    }

    /// Writes the effects of a micro-step, then runs and writes the entry actions, outer modes first.
    pub fn carry_out(&mut self, effects: &[Effect]) -> Result<Written, Failure> {
        let mut written = Written::default();
        for effect in effects {
            for write in &effect.writes {
                self.write(write, &mut written);
            }
            for change in &effect.moves {
                self.enter_mode(change, &mut written);
            }
            self.send(&effect.sent);
        }
        self.present.forget();
        let moves: Vec<Move> = effects.iter().flat_map(|effect| effect.moves.iter().cloned()).collect();
        let entries: Vec<(usize, &[usize])> =
            moves.iter().map(|change| (change.agent, change.entered.as_slice())).collect();
        self.run_entries(&entries, &mut written)?;
        written.moves = moves;
        self.regroup(&mut written);
        self.set_locks(written.restarted.iter().copied());
        Ok(written)
    }

    /// Entry actions of the modes that agents enter, outer modes first; those of one depth read what the ones above wrote,
    /// and nothing of each other.
    pub fn run_entries(
        &mut self,
        entries: &[(usize, &[usize])],
        written: &mut Written,
    ) -> Result<(), Failure> {
        let depth = entries.iter().map(|(_, entered)| entered.len()).max().unwrap_or(0);
        for level in 0..depth {
            let mut effect = Effect::default();
            for &(agent, entered) in entries {
                let Some(&mode) = entered.get(level) else { continue };
                let node = &self.program.types[self.agents.agents[agent].ty].modes[mode];
                let slots = self.agents.slots(&node.entry.frame, &[agent]);
                self.run_list(&node.entry, &slots, &[agent], &node.path, &mut effect)?;
            }
            for write in &effect.writes {
                self.write(write, written);
            }
            self.send(&effect.sent);
            self.present.forget();
        }
        Ok(())
    }

    fn write(&mut self, write: &Write, written: &mut Written) {
        self.remember(write.agent, written);
        match write.target {
            Target::State(k) => {
                self.restart(write.agent, written);
                self.agents.agents[write.agent].states[k] = write.value;
            }
            Target::Aux(column) => {
                self.restart_readers(write.agent, column, written);
                self.agents.agents[write.agent].aux[column] = write.value;
            }
            Target::Mode => {}
        }
    }

    fn enter_mode(&mut self, change: &Move, written: &mut Written) {
        self.remember(change.agent, written);
        self.restart(change.agent, written);
        self.restart_readers(change.agent, Layout::MODE, written);
        let time = self.present.time;
        let agent = &mut self.agents.agents[change.agent];
        agent.mode = change.to;
        agent.aux[Layout::MODE] = change.to as f64;
        agent.aux[Layout::ENTRY] = time;
        remember(&self.program.types[agent.ty], &change.entered, &mut agent.aux);
    }

    /// Keeps an agent's rows as they were before this micro-step.
    fn remember(&mut self, agent: usize, written: &mut Written) {
        if written.before.contains_key(&agent) {
            return;
        }
        self.present.make(&self.agents, &[agent], Depth::States);
        let aux = self.agents.agents[agent].aux.clone();
        written.before.insert(agent, (self.present.states(agent).to_vec(), aux));
    }

    /// Ends the past of an agent's group here: its segments are cut, its next step begins afresh.
    pub fn restart(&mut self, agent: usize, written: &mut Written) {
        if written.restarted.contains(&agent) {
            return;
        }
        self.thaw(agent);
        let number = self.agents.agents[agent].group;
        let time = self.present.time;
        let group = &mut self.groups.groups[number];
        if group.clock > time && group.clock < f64::INFINITY {
            self.n_cuts += group.members.len() as u64;
        }
        cut(&mut self.agents, group, time);
        written.restarted.extend(group.members.iter().copied());
        self.queue_clock(number);
    }

    /// Restarts the agents whose flow reads an auxiliary column of `agent`.
    fn restart_readers(&mut self, agent: usize, column: usize, written: &mut Written) {
        for reader in self.agents.readers(agent) {
            let flow = self.agents.flow(reader);
            let slots = self.agents.slots(&flow.frame, &[reader]);
            let inputs = self.agents.flow_inputs(reader);
            if inputs.iter().any(|&(slot, input)| input == column && slots[slot] == agent) {
                self.restart(reader, written);
            }
        }
    }

    /// Divides the groups of agents that changed their mode anew (rule 13).
    fn regroup(&mut self, written: &mut Written) {
        if written.moves.is_empty() {
            return;
        }
        let mut concerned: Vec<usize> = Vec::new();
        for change in &written.moves {
            let mut with = vec![change.agent];
            with.extend(crate::runtime::groups::couples(&self.agents, change.agent));
            for agent in with {
                let group = self.agents.agents[agent].group;
                if !concerned.contains(&group) {
                    concerned.push(group);
                }
            }
        }
        let alone = |group: &usize| self.groups.groups[*group].members.len() == 1;
        if concerned.iter().all(alone) && concerned.len() == written.moves.len() {
            let coupled = written
                .moves
                .iter()
                .any(|change| !crate::runtime::groups::couples(&self.agents, change.agent).is_empty());
            if !coupled {
                return;
            }
        }
        let mut members: Vec<usize> = Vec::new();
        for &group in &concerned {
            members.extend_from_slice(&self.groups.groups[group].members);
        }
        for &agent in &members {
            self.restart(agent, written);
        }
        let time = self.present.time;
        let mut steps: FxHashMap<usize, Option<f64>> = FxHashMap::default();
        for &agent in &members {
            steps.insert(agent, self.groups.groups[self.agents.agents[agent].group].integration.h);
        }
        for &group in &concerned {
            self.groups.dissolve(group);
        }
        let made = self
            .groups
            .divide(&mut self.agents, &members, time, &|agent| steps.get(&agent).copied().flatten());
        for group in made {
            self.queue_clock(group);
        }
    }

    /// Sets the locks of the kinks of these agents' flows from their states.
    pub fn set_locks(&mut self, agents: impl IntoIterator<Item = usize>) {
        self.present.forget();
        for agent in agents {
            let flow = self.agents.flow(agent);
            for kink in &flow.kinks {
                let slots = self.agents.slots(&flow.frame, &[agent]);
                let kernel = self.program.kernel(kink.initial);
                let lock = truth::evaluate(&self.agents, &mut self.present, kernel, &slots, &[]);
                self.agents.agents[agent].aux[kink.lock] = lock;
            }
        }
        self.present.forget();
    }
}

/// The columns that a firing may write: exit, transition and entry actions together, both branches of an `if`; its mode
/// stands for the region (rule 4).
pub fn claims(engine: &Engine<'_, '_>, instance: u32, slots: &Slots) -> Vec<(usize, Target)> {
    let mut claims = Vec::new();
    let (transition, pair): (&TransitionSystem, bool) = match engine.guards.definition(instance).origin {
        Origin::Transition(transition) => (transition, false),
        Origin::Pair(pair) => (&pair.transition, true),
        Origin::Gate(_) | Origin::Claim(_) => return claims,
    };
    claims.extend(transition.actions.writes.iter().map(|&(slot, target)| (slots[slot], target)));
    let mut moves = Vec::new();
    if !pair {
        claims.push((slots[0], Target::Mode));
        moves.extend(transition.target.map(|target| engine.route(slots[0], transition.source, target)));
    } else {
        gotos(&transition.actions.steps, &mut |slot, target| {
            moves.push(engine.route(slots[slot], 0, target))
        });
    }
    for change in moves {
        claims.push((change.agent, Target::Mode));
        let modes = &engine.program.types[engine.agents.agents[change.agent].ty].modes;
        let lists = change.left.iter().map(|&mode| &modes[mode].exit);
        for list in lists.chain(change.entered.iter().map(|&mode| &modes[mode].entry)) {
            claims.extend(list.writes.iter().map(|&(_, target)| (change.agent, target)));
        }
    }
    claims
}

/// Calls `visit` with every change of mode in some actions.
fn gotos(steps: &[ActionStep], visit: &mut dyn FnMut(usize, Destination)) {
    for step in steps {
        match step {
            ActionStep::Goto { slot, target, .. } => visit(*slot, *target),
            ActionStep::If { then, otherwise, .. } => {
                gotos(then, visit);
                gotos(otherwise, visit);
            }
            ActionStep::Assign { .. }
            | ActionStep::Draw { .. }
            | ActionStep::Emit { .. }
            | ActionStep::Stop { .. } => {}
        }
    }
}
