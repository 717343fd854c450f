//! Actions: what transitions would write is computed on the rows before; then it is written.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::base::Span;
use crate::codegen::program::{
    ActionList, ActionStep, Destination, Entry, Frame, FunctionId, Layout, TransitionSystem,
};
use crate::codegen::trace::{Blame, Point};
use crate::runtime::advance::cut;
use crate::runtime::engine::{Engine, StopRequest};
use crate::runtime::failure::{Failure, Reason};
use crate::runtime::fold;
use crate::runtime::guards::Origin;
use crate::runtime::lives::{Conceived, Doomed};
use crate::runtime::mail::Message;
use crate::runtime::population::{ABSENT, Agents, Slots};
use crate::runtime::present::{Depth, Present};
use crate::runtime::route::{Move, reached, remember, route};
use crate::runtime::truth;

/// A value for a column of an agent.
#[derive(Clone, Copy, Debug)]
pub struct Write {
    /// Whose.
    pub agent: usize,
    /// Which column.
    pub target: Entry,
    /// Its value.
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
    /// Agents to be made.
    pub conceived: Vec<Conceived>,
    /// Agents to be removed.
    pub doomed: Vec<Doomed>,
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
    /// Those who read others by their flow in the mode that they have entered than by the one before.
    pub recoupled: Vec<usize>,
    /// Agents still to be made, and still to be removed.
    pub conceived: Vec<Conceived>,
    /// See `conceived`.
    pub doomed: Vec<Doomed>,
    /// Agents that have been made.
    pub born: Vec<usize>,
    /// Types of agents that have been removed.
    pub died: Vec<usize>,
    /// Guard instances that looked at an agent that has been removed, as one that was near.
    pub bereft: Vec<u32>,
    /// Agents whose links lead somewhere else, and those who have lost a member of their group.
    pub relinked: Vec<usize>,
}

impl Engine<'_, '_> {
    /// The effect of a transition of an instance, read from the rows of the present instant.
    pub fn effect(&mut self, instance: u32, slots: &Slots) -> Result<Effect, Failure> {
        let (transition, pair) = match self.guards.definition(instance).origin {
            Origin::Transition(transition) => (transition, false),
            Origin::Pair(pair) => (&pair.transition, true),
            Origin::Gate(_) | Origin::Claim(_) | Origin::Link(_) => return Ok(Effect::default()),
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
                    effect.conceived.append(&mut exit.conceived);
                    effect.doomed.append(&mut exit.doomed);
                    effect.moves.push(change);
                }
                ActionStep::Stop { reason, .. } => {
                    let agent = self.agents.who(slots[0]);
                    let request = StopRequest { reason: reason.clone(), agent, by: by.to_string() };
                    self.stop.get_or_insert(request);
                }
                ActionStep::Create(birth) => {
                    effect.conceived.push(self.conceive(birth, &list.frame, slots, own)?);
                }
                ActionStep::Destroy { slot, span } => {
                    if slots[*slot] != ABSENT {
                        effect.doomed.push(Doomed { agent: slots[*slot], span: *span });
                    }
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
            Entry::State(k) => system.state_name(k),
            Entry::Aux(column) => system.discretes[column - system.layout.discrete(0)].name.clone(),
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
    pub fn carry_out(&mut self, effects: Vec<Effect>) -> Result<Written, Failure> {
        let mut written = Written::default();
        let mut moves: Vec<Move> = Vec::new();
        for effect in effects {
            for write in &effect.writes {
                self.write(write, &mut written);
            }
            for change in &effect.moves {
                self.enter_mode(change, &mut written);
            }
            self.send(&effect.sent);
            moves.extend(effect.moves);
            written.conceived.extend(effect.conceived);
            written.doomed.extend(effect.doomed);
        }
        self.present.forget();
        let entries: Vec<(usize, &[usize])> =
            moves.iter().map(|change| (change.agent, change.entered.as_slice())).collect();
        self.run_entries(&entries, &mut written)?;
        written.moves = moves;
        self.turn_over(&mut written)?;
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
        let types = &self.program.types;
        let depths = |&(agent, entered): &(usize, &[usize])| {
            let modes = &types[self.agents.agents[agent].ty].modes;
            let depth = |mode: Option<&usize>| mode.map_or(0, |&mode| modes[mode].depth);
            depth(entered.first())..depth(entered.last()) + 1
        };
        let levels: Vec<std::ops::Range<usize>> = entries.iter().map(depths).collect();
        let n_levels = levels.iter().map(|depths| depths.len()).max().unwrap_or(0);
        for level in 0..n_levels {
            let mut effect = Effect::default();
            for (&(agent, entered), depths) in entries.iter().zip(&levels) {
                let modes = &types[self.agents.agents[agent].ty].modes;
                for node in
                    entered.iter().map(|&mode| &modes[mode]).filter(|node| node.depth == depths.start + level)
                {
                    let slots = self.agents.slots(&node.entry.frame, &[agent]);
                    self.run_list(&node.entry, &slots, &[agent], &node.path, &mut effect)?;
                }
            }
            for write in &effect.writes {
                self.write(write, written);
            }
            self.send(&effect.sent);
            written.conceived.append(&mut effect.conceived);
            written.doomed.append(&mut effect.doomed);
            self.present.forget();
        }
        Ok(())
    }

    fn write(&mut self, write: &Write, written: &mut Written) {
        self.remember(write.agent, written);
        self.agents.changes += 1;
        match write.target {
            Entry::State(k) => {
                self.restart(write.agent, written);
                self.approach.give(write.agent, k, self.present.time);
                self.agents.agents[write.agent].states[k] = write.value;
            }
            Entry::Aux(column) => {
                self.restart_readers(write.agent, column, written);
                self.agents.agents[write.agent].aux[column] = write.value;
            }
        }
    }

    fn enter_mode(&mut self, change: &Move, written: &mut Written) {
        self.remember(change.agent, written);
        self.agents.changes += 1;
        self.restart(change.agent, written);
        self.restart_readers(change.agent, Layout::MODE, written);
        let read_before = self.coupled(change.agent);
        let time = self.present.time;
        let agent = &mut self.agents.agents[change.agent];
        agent.mode = reached(&self.program.types[agent.ty], agent.mode, &change.left, &change.entered);
        agent.aux[Layout::MODE] = agent.mode as f64;
        agent.aux[Layout::ENTRY] = time;
        remember(&self.program.types[agent.ty], &change.entered, &mut agent.aux);
        if self.coupled(change.agent) != read_before {
            written.recoupled.push(change.agent);
        }
    }

    /// Whom the flow of an agent reads, rising.
    fn coupled(&self, agent: usize) -> Vec<usize> {
        let mut read = self.agents.couples(agent);
        read.sort_unstable();
        read
    }

    /// Keeps an agent's rows as they were before this micro-step.
    pub fn remember(&mut self, agent: usize, written: &mut Written) {
        if written.before.contains_key(&agent) {
            return;
        }
        self.catch_up_with(agent);
        self.present.make(&self.agents, &[agent], Depth::States);
        let aux = self.agents.agents[agent].aux.clone();
        written.before.insert(agent, (self.present.states(agent).to_vec(), aux));
    }

    /// Ends the past of an agent's group here: its segments are cut, its next step begins afresh. So it is with all groups
    /// whose flows read it.
    pub fn restart(&mut self, agent: usize, written: &mut Written) {
        let time = self.present.time;
        let mut waiting = vec![agent];
        while let Some(agent) = waiting.pop() {
            if written.restarted.contains(&agent) {
                continue;
            }
            self.thaw(agent);
            self.catch_up_with(agent);
            let number = self.agents.agents[agent].group;
            let group = &mut self.groups.groups[number];
            let (agents, present) = (&self.agents, &mut self.present);
            for &member in &group.members {
                self.approach.note(member, time, || rates_before(agents, present, member));
            }
            if group.clock > time && group.clock < f64::INFINITY {
                self.n_cuts += group.members.len() as u64;
            }
            cut(&mut self.agents, group, time);
            for &member in &group.members {
                written.restarted.insert(member);
                waiting.extend(self.agents.followers(member));
            }
            self.queue_clock(number);
        }
    }

    /// Restarts the agents whose flow reads an auxiliary column of `agent`.
    pub fn restart_readers(&mut self, agent: usize, column: usize, written: &mut Written) {
        for reader in self.agents.readers(agent) {
            let flow = self.agents.flow(reader);
            let slots = self.agents.slots(&flow.frame, &[reader]);
            let inputs = self.agents.flow_inputs(reader);
            if inputs.iter().any(|&(slot, input)| input == column && slots[slot] == agent) {
                self.restart(reader, written);
            }
        }
    }

    /// Divides the groups anew of agents that changed whom their flow reads, or their links, or have come to be (rule 13).
    pub fn regroup(&mut self, written: &mut Written) {
        let mut changed: Vec<usize> = written.recoupled.clone();
        changed.extend(written.born.iter().chain(&written.relinked));
        changed.retain(|&agent| self.agents.is_alive(agent));
        changed.sort_unstable();
        changed.dedup();
        let is_free = |&agent: &usize| {
            let group = &self.groups.groups[self.agents.agents[agent].group];
            group.members.len() == 1 && group.leaders.is_empty() && self.agents.couples(agent).is_empty()
        };
        if changed.iter().all(is_free) {
            return;
        }
        let members = self.groups.closed(&self.agents, changed);
        for &agent in &members {
            self.restart(agent, written);
            for leader in self.agents.couples(agent) {
                self.thaw(leader);
            }
        }
        let time = self.present.time;
        let mut steps: FxHashMap<usize, Option<f64>> = FxHashMap::default();
        for &agent in &members {
            steps.insert(agent, self.groups.groups[self.agents.agents[agent].group].integration.h);
        }
        for &agent in &members {
            let group = self.agents.agents[agent].group;
            if !self.groups.groups[group].members.is_empty() {
                self.groups.dissolve(group);
            }
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

/// What a firing takes for itself in a micro-step (rule 4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Claimed {
    /// A column of an agent, which it may write.
    Column(Entry),
    /// A region of an agent, by its number among those of its type.
    Region(usize),
}

/// What a firing takes: the columns that exit, transition and entry actions together may write, both branches of an `if`; the
/// region of its mode; all regions of an agent if it is of the agent itself, or an interaction that changes the agent's mode.
pub fn claims(engine: &Engine<'_, '_>, instance: u32, slots: &Slots) -> Vec<(usize, Claimed)> {
    let mut claims = Vec::new();
    let (transition, pair): (&TransitionSystem, bool) = match engine.guards.definition(instance).origin {
        Origin::Transition(transition) => (transition, false),
        Origin::Pair(pair) => (&pair.transition, true),
        Origin::Gate(_) | Origin::Claim(_) | Origin::Link(_) => return claims,
    };
    let system = |agent: usize| &engine.program.types[engine.agents.agents[agent].ty];
    let mut regions = |agent: usize, source: usize| {
        let (ty, own) = (system(agent), system(agent).region_of(source));
        let taken = (0..ty.regions.len()).filter(|&k| own.is_none_or(|own| own == ty.regions[k]));
        claims.extend(taken.map(|k| (agent, Claimed::Region(k))));
    };
    let mut moves = Vec::new();
    if pair {
        gotos(&transition.actions.steps, &mut |slot, target| {
            regions(slots[slot], 0);
            moves.push(engine.route(slots[slot], 0, target));
        });
    } else {
        regions(slots[0], transition.source);
        moves.extend(transition.target.map(|target| engine.route(slots[0], transition.source, target)));
    }
    dooms(&transition.actions.steps, &mut |slot| {
        if slots[slot] != ABSENT {
            regions(slots[slot], 0);
        }
    });
    // Whom a link does not lead to is not written.
    let own = transition.actions.writes.iter().filter(|&&(slot, _)| slots[slot] != ABSENT);
    claims.extend(own.map(|&(slot, target)| (slots[slot], Claimed::Column(target))));
    for change in moves {
        let modes = &system(change.agent).modes;
        let lists = change.left.iter().map(|&mode| &modes[mode].exit);
        for list in lists.chain(change.entered.iter().map(|&mode| &modes[mode].entry)) {
            claims.extend(list.writes.iter().map(|&(_, target)| (change.agent, Claimed::Column(target))));
        }
    }
    claims
}

/// Calls `visit` with the slot of every agent that some actions remove.
fn dooms(steps: &[ActionStep], visit: &mut dyn FnMut(usize)) {
    for step in steps {
        match step {
            ActionStep::Destroy { slot, .. } => visit(*slot),
            ActionStep::If { then, otherwise, .. } => {
                dooms(then, visit);
                dooms(otherwise, visit);
            }
            ActionStep::Assign { .. }
            | ActionStep::Draw { .. }
            | ActionStep::Emit { .. }
            | ActionStep::Goto { .. }
            | ActionStep::Stop { .. }
            | ActionStep::Create(_) => {}
        }
    }
}

/// The rates along which an agent that is not cold has come to the present instant; those of its flow if it has just begun a step.
fn rates_before(agents: &Agents<'_>, present: &mut Present, agent: usize) -> Vec<f64> {
    if agents.agents[agent].segment.start < present.time {
        let mut rates = vec![0.0; agents.agents[agent].states.len()];
        agents.rates_at(agent, present.time, &mut rates);
        return rates;
    }
    present.make(agents, &[agent], Depth::Rates);
    present.rates(agent).to_vec()
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
            | ActionStep::Stop { .. }
            | ActionStep::Create(_)
            | ActionStep::Destroy { .. } => {}
        }
    }
}
