//! A slow and obvious simulator of the language's core, written from docs/LANGUAGE.md and from nothing of the engine.
//!
//! One global clock goes forward in small equal steps. After each step every guard of every agent and pair is evaluated;
//! if one may fire, or a branch in a flow went another way, the step is bisected to the earliest such time.

use hyc::math::Op;
use hyc::math::draw::{Distribution, Key};
use hyc::model::ir::{
    Action, Create, ExprId, ExprKind, Given, Instance as Start, InteractionId, ModeId, Model, Transition,
    Trigger, TypeId, VarRef,
};

use super::boundary::Boundary;
use super::evaluate::Scope;
use super::modes::{self, Change, after};
use super::point;
use super::post::{Message, Post};
use super::world::World;

/// A row of the event log.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// s.
    pub time: f64,
    /// The transition.
    pub label: String,
    /// The agent.
    pub agent: usize,
    /// The other one of a pair.
    pub other: Option<usize>,
    /// From which mode into which.
    pub modes: Option<(String, String)>,
}

/// What a run did.
pub struct History {
    /// Its log.
    pub rows: Vec<Row>,
    /// Up to when it is worth comparing, s: its end, or where it does too much, or nothing that is robust.
    pub until: f64,
    /// Everything at the end.
    pub world: World,
}

/// More branches of flows than such a model has: the flows on both sides push back.
const MANY_BRANCHES: usize = 300;
/// So many branches in so short a time, s: the flow slides along where it branches, which has no solution by rule 15.
const SLIDING: (usize, f64) = (10, 0.01);
/// More events than a model worth comparing has in a run, and in an instant.
const MANY: usize = 400;
const MANY_IN_AN_INSTANT: usize = 40;

/// Whose transition it is.
#[derive(Clone, Copy, PartialEq)]
enum Owner {
    Type(TypeId),
    Interaction(InteractionId),
}

/// A transition of an agent or of a pair, with its flag (rule 2).
struct Instance {
    owner: Owner,
    transition: usize,
    agents: [usize; 2],
    armed: bool,
    boundary: Boundary,
    /// `every`: the number of the next time. `after`: unused.
    k: u32,
    /// At a time of its `every` that has not been used yet.
    pulse: bool,
    /// How often its mode has been entered.
    entries: usize,
    /// How often its hazard has been drawn.
    draws: u64,
}

/// The simulator at work.
pub struct Reference<'a> {
    model: &'a Model,
    world: World,
    instances: Vec<Instance>,
    rows: Vec<Row>,
    post: Post,
    /// Whether the pairs of each interaction are ordered.
    ordered: Vec<bool>,
    /// When a branch in a flow went another way, s.
    branchings: Vec<f64>,
    end: f64,
}

/// A transition that is taken, and what it does.
struct Taken {
    instance: usize,
    moves: Vec<Change>,
    done: Done,
}

/// What a list of actions does.
#[derive(Default)]
struct Done {
    /// The values that it assigns.
    writes: Vec<(usize, VarRef, f64)>,
    /// All variables that it might write.
    all: Vec<(usize, VarRef)>,
    /// The messages that it sends, each with its delay, s.
    sent: Vec<(Message, f64)>,
    /// The agents that it creates.
    created: Vec<Start>,
    /// The agents that it destroys.
    destroyed: Vec<usize>,
}

/// How a model is run.
#[derive(Clone, Copy)]
pub struct Pace {
    /// The length of steps, s.
    pub step: f64,
    /// How closely the time of what happens is enclosed, in parts of the time, at least of 1 s.
    pub tolerance: f64,
    /// How far rates are beside the truth; see [`World::nudge`].
    pub nudge: f64,
    /// See [`World::near`].
    pub near: f64,
    /// Whether to give up where a guard hangs on a single point.
    pub wary: bool,
}

/// Runs a model as far as it is worth comparing. `ordered` says of an interaction whether its pairs are ordered.
pub fn run(model: &Model, pace: Pace, ordered: impl Fn(&str) -> bool) -> History {
    let mut reference = Reference::new(model, pace, ordered);
    let mut goes_on = reference.begin();
    let mut until = 0.0;
    while goes_on.is_some() && reference.world.time < reference.end {
        until = reference.world.time;
        goes_on = reference.advance(pace);
    }
    if goes_on.is_some() {
        until = reference.end;
    }
    until = reference.slides().map_or(until, |since| until.min(since));
    History { rows: reference.rows, until, world: reference.world }
}

impl<'a> Reference<'a> {
    fn new(model: &'a Model, pace: Pace, ordered: impl Fn(&str) -> bool) -> Self {
        let ordered = model.interactions.iter().map(|interaction| ordered(&interaction.name)).collect();
        let end = model.run.until.expect("the generator writes an end");
        let mut reference = Self {
            model,
            world: World::new(model, pace.nudge, pace.near),
            instances: Vec::new(),
            rows: Vec::new(),
            post: Post::default(),
            ordered,
            branchings: Vec::new(),
            end,
        };
        for agent in 0..reference.world.agents.len() {
            reference.admit(agent);
        }
        reference
    }

    /// Adds the transitions of an agent, and of the pairs that it is in with agents before it.
    fn admit(&mut self, agent: usize) {
        let instance = |owner, transition, agents| Instance {
            owner,
            transition,
            agents,
            armed: true,
            boundary: Boundary::default(),
            k: 1,
            pulse: false,
            entries: 0,
            draws: 0,
        };
        let types = |agents: [usize; 2]| agents.map(|agent| self.world.agents[agent].ty);
        for (id, interaction) in self.model.interactions.iter_enumerated() {
            for transition in 0..interaction.transitions.len() {
                for other in (0..agent).filter(|other| self.world.agents[*other].lives) {
                    let mut pairs = vec![[other, agent]];
                    pairs.extend(self.ordered[id.index()].then_some([agent, other]));
                    for pair in pairs.into_iter().filter(|pair| types(*pair) == interaction.types) {
                        self.instances.push(instance(Owner::Interaction(id), transition, pair));
                    }
                }
            }
        }
        let ty = self.world.agents[agent].ty;
        for transition in 0..self.model.types[ty].transitions.len() {
            self.instances.push(instance(Owner::Type(ty), transition, [agent, agent]));
        }
        self.post.inboxes.resize_with(agent + 1, Default::default);
    }

    fn transition(&self, instance: usize) -> &'a Transition {
        let instance = &self.instances[instance];
        match instance.owner {
            Owner::Type(ty) => &self.model.types[ty].transitions[instance.transition],
            Owner::Interaction(id) => &self.model.interactions[id].transitions[instance.transition],
        }
    }

    fn is_pair(&self, instance: usize) -> bool {
        matches!(self.instances[instance].owner, Owner::Interaction(_))
    }

    /// Whether the agent is in the mode that the transition belongs to.
    fn is_active(&self, instance: usize) -> bool {
        let [first, second] = self.instances[instance].agents.map(|agent| &self.world.agents[agent]);
        let is_there = self.is_pair(instance) || first.active.contains(&self.transition(instance).source);
        first.lives && second.lives && is_there
    }

    fn scope<'s>(&'s self, world: &'s World, instance: usize) -> Scope<'s> {
        Scope::new(self.model, world, self.instances[instance].agents, self.is_pair(instance))
    }

    /// When the present mode of the transition was entered.
    fn entered(&self, instance: usize) -> f64 {
        let source = self.transition(instance).source;
        self.world.agents[self.instances[instance].agents[0]].entered[source.index()]
    }

    /// The next time that a transition is scheduled for.
    fn due(&self, instance: usize) -> Option<f64> {
        let (delay, times) = match self.transition(instance).trigger {
            Trigger::When(_) | Trigger::On { .. } | Trigger::Rate { .. } => return None,
            Trigger::After(delay, _) => (delay, 1.0),
            Trigger::Every(period, _) => (period, f64::from(self.instances[instance].k)),
        };
        let delay = self.scope(&self.world, instance).number(delay);
        let due = self.entered(instance) + times * delay;
        Some(if (due - self.end).abs() <= 4.0 * f64::EPSILON * self.end { self.end } else { due })
    }

    /// Where what is left of the hazard of a transition stands among the states.
    fn hazard(&self, world: &World, instance: usize) -> usize {
        let agent = &world.agents[self.instances[instance].agents[0]];
        let ty = &self.model.types[agent.ty];
        let number = self.instances[instance].transition;
        let before = ty.transitions[..number].iter();
        let before = before.filter(|transition| matches!(transition.trigger, Trigger::Rate { .. })).count();
        agent.first + ty.states.len() + before
    }

    /// Draws what is left of the hazard of a transition anew, if it has one.
    fn draw(&mut self, instance: usize) {
        let transition = self.transition(instance);
        if let Trigger::Rate { .. } = transition.trigger {
            let place = self.hazard(&self.world, instance);
            self.instances[instance].draws += 1;
            let agent = self.model.population.agent_name(self.instances[instance].agents[0]);
            let draw = self.instances[instance].draws;
            let key = Key { seed: self.model.run.seed, agent: &agent, variable: &transition.label, draw };
            self.world.states[place] = Distribution::Exponential.draw(&[1.0], key);
        }
    }

    /// The condition of a transition in a world of these modes.
    fn holds(&self, world: &World, instance: usize) -> bool {
        let (guard, ripe) = match self.transition(instance).trigger {
            Trigger::When(guard) => (Some(guard), true),
            Trigger::After(_, guard) => (guard, self.due(instance).is_some_and(|due| world.time >= due)),
            Trigger::Every(_, guard) => (guard, self.instances[instance].pulse),
            Trigger::Rate { .. } => return world.states[self.hazard(world, instance)] <= 0.0,
            Trigger::On { .. } => return false,
        };
        let Some(guard) = guard else { return ripe };
        let mut scope = self.scope(world, instance);
        let decided = self.instances[instance].boundary.decided(&mut scope, world);
        scope.decided = &decided;
        ripe && scope.truth(guard)
    }

    /// Whether a transition may fire.
    fn enabled(&self, world: &World, instance: usize) -> bool {
        let armed = match self.transition(instance).trigger {
            Trigger::Every(..) => self.instances[instance].pulse,
            Trigger::When(_) | Trigger::After(..) | Trigger::Rate { .. } => self.instances[instance].armed,
            Trigger::On { .. } => return false,
        };
        armed && self.is_active(instance) && self.holds(world, instance)
    }

    fn any_enabled(&self, world: &World) -> bool {
        (0..self.instances.len()).any(|instance| self.enabled(world, instance))
    }

    /// Rule 6.
    fn begin(&mut self) -> Option<()> {
        let agents: Vec<usize> = (0..self.world.agents.len()).collect();
        self.run_entries(&self.beginnings(&agents));
        for instance in 0..self.instances.len() {
            if self.is_active(instance) {
                self.draw(instance);
            }
            self.instances[instance].boundary = self.settle(instance).fresh();
        }
        self.arm();
        self.instant()
    }

    /// All modes of agents that begin.
    fn beginnings(&self, agents: &[usize]) -> Vec<(usize, Vec<ModeId>)> {
        agents.iter().map(|agent| (*agent, self.world.agents[*agent].active.clone())).collect()
    }

    /// Entry actions, level by level from the outermost mode that is entered: those of one level read nothing of each other.
    /// Returns what they create and destroy.
    fn run_entries(&mut self, entries: &[(usize, Vec<ModeId>)]) -> Done {
        let mut all = Done::default();
        let depth =
            |agent: usize, mode: ModeId| self.model.types[self.world.agents[agent].ty].modes[mode].depth;
        let levels: Vec<Vec<usize>> = entries
            .iter()
            .map(|(agent, entered)| {
                let outermost = entered.iter().map(|mode| depth(*agent, *mode)).min().unwrap_or(0);
                entered.iter().map(|mode| depth(*agent, *mode) - outermost).collect()
            })
            .collect();
        let deepest = levels.iter().flatten().max().copied().unwrap_or(0);
        for level in 0..=deepest {
            let mut done = Done::default();
            for ((agent, entered), levels) in entries.iter().zip(&levels) {
                for (mode, _) in entered.iter().zip(levels).filter(|(_, of)| **of == level) {
                    let entry = &self.model.types[self.world.agents[*agent].ty].modes[*mode].entry;
                    let mut own = Scope::new(self.model, &self.world, [*agent, *agent], false);
                    collect(entry, &mut own, &mut done);
                }
            }
            self.write(&done.writes);
            self.send(done.sent);
            all.created.extend(done.created);
            all.destroyed.extend(done.destroyed);
        }
        all
    }

    /// Agents come to be at the end of a micro-step, and those destroyed leave.
    fn turn_over(&mut self, created: &[Start], destroyed: &[usize]) {
        let born: Vec<usize> = created.iter().map(|start| self.world.add(self.model, start)).collect();
        let known = self.instances.len();
        born.iter().for_each(|agent| self.admit(*agent));
        self.run_entries(&self.beginnings(&born));
        for instance in known..self.instances.len() {
            self.instances[instance].boundary = self.settle(instance).fresh();
        }
        for agent in destroyed {
            self.world.agents[*agent].lives = false;
        }
    }

    fn write(&mut self, writes: &[(usize, VarRef, f64)]) {
        for (agent, variable, value) in writes {
            let agent = &mut self.world.agents[*agent];
            match variable {
                VarRef::State(k) => self.world.states[agent.first + k] = *value,
                VarRef::Discrete(k) => agent.discretes[*k] = *value,
                VarRef::Param(_) | VarRef::Link(_) | VarRef::Let(_) => panic!("nobody writes this"),
            }
        }
    }

    fn send(&mut self, sent: Vec<(Message, f64)>) {
        for (message, delay) in sent {
            let time = self.world.time + delay;
            let is_end = (time - self.end).abs() <= 4.0 * f64::EPSILON * self.end;
            let time = if is_end { self.end } else { time };
            if delay > 0.0 { self.post.later.push((time, message)) } else { self.post.sent.push(message) }
        }
    }

    /// Whether a transition is an `on` for a message from whoever sent it.
    fn hears(&self, instance: usize, message: &Message) -> bool {
        let Trigger::On { events, from, .. } = &self.transition(instance).trigger else { return false };
        let own = self.instances[instance].agents[0];
        let mut scope = self.scope(&self.world, instance);
        let is_listened_to = match from {
            None => own != message.sender,
            Some(from) if matches!(self.model.exprs[*from].kind, ExprKind::SelfAgent) => {
                own == message.sender
            }
            Some(from) => own != message.sender && scope.named(*from) == message.sender,
        };
        is_listened_to && events.contains(&message.event)
    }

    /// Messages come to whom they are for, in the order of their senders.
    fn deliver(&mut self) {
        let mut sent = std::mem::take(&mut self.post.sent);
        sent.sort_by_key(|message| message.sender);
        for message in sent {
            for agent in 0..self.world.agents.len() {
                let own = |instance: &usize| {
                    !self.is_pair(*instance) && self.instances[*instance].agents[0] == agent
                };
                let is_for =
                    (0..self.instances.len()).filter(own).any(|instance| self.hears(instance, &message));
                if is_for {
                    self.post.inboxes[agent].waiting.push(message.clone());
                }
            }
        }
    }

    /// The transitions that the messages at their turns enable; those that enable none are missed.
    fn turns(&mut self) -> Vec<usize> {
        let mut enabled = Vec::new();
        for agent in 0..self.world.agents.len() {
            while let Some(message) = self.post.inboxes[agent].waiting.first().cloned() {
                let before = self.post.inboxes[agent].clone();
                let found: Vec<(usize, usize)> = (0..self.instances.len())
                    .filter(|instance| {
                        !self.is_pair(*instance)
                            && self.instances[*instance].agents[0] == agent
                            && self.is_active(*instance)
                            && self.hears(*instance, &message)
                            && self.answers(*instance, &message)
                    })
                    .map(|instance| (instance, self.instances[instance].entries))
                    .filter(|found| !before.heard || before.enabled.contains(found))
                    .collect();
                let inbox = &mut self.post.inboxes[agent];
                if !found.is_empty() {
                    enabled.extend(found.iter().map(|(instance, _)| *instance));
                    inbox.enabled = found;
                    break;
                }
                let heard = inbox.heard;
                inbox.next();
                if !heard {
                    break;
                }
            }
        }
        enabled
    }

    /// Whether the condition of an `on` holds.
    fn answers(&self, instance: usize, message: &Message) -> bool {
        let Trigger::On { guard: Some(guard), .. } = self.transition(instance).trigger else { return true };
        let mut scope = self.scope(&self.world, instance);
        scope.received = message.values.clone();
        scope.truth(guard)
    }

    /// Flags of guards that are false are set.
    fn arm(&mut self) {
        for instance in 0..self.instances.len() {
            if self.is_active(instance)
                && !self.instances[instance].armed
                && !self.holds(&self.world, instance)
            {
                self.instances[instance].armed = true;
            }
        }
    }

    /// Flows to the end of the step or to the earliest thing that happens in it, and executes that.
    fn advance(&mut self, pace: Pace) -> Option<()> {
        let active = (0..self.instances.len()).filter(|instance| self.is_active(*instance));
        let due = active.filter_map(|instance| self.due(instance)).filter(|due| *due > self.world.time);
        let due = due.chain(self.post.next_time());
        let stop = due.fold(self.end.min(self.world.time + pace.step), f64::min);
        let (mut after, mut straight) = self.world.flow_with_branches(self.model, stop);
        let mut before = self.world.time;
        if !straight || self.any_enabled(&after) {
            while after.time - before > pace.tolerance * after.time.max(1.0) {
                let (middle, same) = self.world.flow_with_branches(self.model, 0.5 * (before + after.time));
                if middle.time <= before || middle.time >= after.time {
                    break;
                }
                if !same || self.any_enabled(&middle) {
                    (after, straight) = (middle, same);
                } else {
                    before = middle.time;
                }
            }
        }
        if !straight {
            // A step that ends beyond the branch has seen rates of both sides.
            after = self.world.flow(self.model, before).flow(self.model, after.time);
            self.branchings.push(after.time);
        }
        if self.branchings.len() > MANY_BRANCHES
            || self.slides().is_some()
            || pace.wary && (self.hangs_on_a_point(after.time) || self.is_false_for_a_point(before, &after))
        {
            return None;
        }
        self.world = after;
        for instance in 0..self.instances.len() {
            let every = matches!(self.transition(instance).trigger, Trigger::Every(..));
            if every
                && self.is_active(instance)
                && self.due(instance).is_some_and(|due| due <= self.world.time)
            {
                self.instances[instance].pulse = true;
            }
            let scope =
                Scope::new(self.model, &self.world, self.instances[instance].agents, self.is_pair(instance));
            let boundary = std::mem::take(&mut self.instances[instance].boundary);
            self.instances[instance].boundary = boundary.later(scope, &self.world);
        }
        self.post.come(self.world.time);
        self.arm();
        self.instant()
    }

    /// Whether a guard that is disarmed becomes false where something else fires, which may make it true again at once.
    fn is_false_for_a_point(&self, before: f64, after: &World) -> bool {
        let just_before = self.world.flow(self.model, before);
        let ends = |instance: usize| {
            let is_disarmed = self.is_active(instance) && !self.instances[instance].armed;
            is_disarmed && self.holds(&just_before, instance) && !self.holds(after, instance)
        };
        self.any_enabled(after) && (0..self.instances.len()).any(ends)
    }

    /// Since when a flow slides along where it branches, s.
    fn slides(&self) -> Option<f64> {
        let (many, short) = SLIDING;
        let mut runs = self.branchings.windows(many);
        runs.find(|run| run[many - 1] - run[0] < short).map(|run| run[0])
    }

    /// Whether a guard hangs on a single point between the present time and this one.
    fn hangs_on_a_point(&self, end: f64) -> bool {
        (0..self.instances.len()).filter(|instance| self.is_active(*instance)).any(|instance| {
            let condition = match self.transition(instance).trigger {
                Trigger::When(guard) | Trigger::After(_, Some(guard)) => guard,
                Trigger::After(_, None) | Trigger::Every(..) | Trigger::On { .. } | Trigger::Rate { .. } => {
                    return false;
                }
            };
            let (agents, pair) = (self.instances[instance].agents, self.is_pair(instance));
            point::Guard { model: self.model, agents, pair, condition }.hangs_on_a_point(&self.world, end)
        })
    }

    /// Rule 4: micro-steps until nothing is enabled.
    fn instant(&mut self) -> Option<()> {
        let before = self.rows.len();
        let late: Vec<usize> = (0..self.instances.len())
            .filter(|k| self.instances[*k].pulse && !self.enabled(&self.world, *k))
            .collect();
        loop {
            self.deliver();
            let heard = self.turns();
            let taken = self.choose(&heard);
            if taken.is_empty() {
                if self.post.is_empty() {
                    break;
                }
                continue;
            }
            // Whether that time is still going on when what unrelated agents did has made the guard true, is open.
            if taken.iter().any(|taken| late.contains(&taken.instance)) {
                return None;
            }
            self.execute(taken);
            let too_much = self.rows.len() > MANY || self.rows.len() - before > MANY_IN_AN_INSTANT;
            if too_much || self.is_degenerate() {
                return None;
            }
        }
        for instance in &mut self.instances {
            if std::mem::take(&mut instance.pulse) {
                instance.k += 1;
            }
        }
        Some(())
    }

    /// Whether events pile up, or some comparison is on its boundary for another reason than rule 3 knows.
    fn is_degenerate(&self) -> bool {
        let last = &self.rows[self.rows.len() - 1];
        let like = |row: &&Row| (&row.label, row.agent, row.other) == (&last.label, last.agent, last.other);
        let recent = |row: &&Row| row.time > last.time - 1e-3;
        let piled_up = self.rows.iter().rev().take_while(recent).filter(like).count() > 4;
        let stays = |instance: usize| match self.transition(instance).trigger {
            Trigger::When(guard) | Trigger::After(_, Some(guard)) | Trigger::Every(_, Some(guard)) => {
                let scope = self.scope(&self.world, instance);
                self.is_active(instance) && self.instances[instance].boundary.is_left_open(scope, guard)
            }
            Trigger::After(_, None) | Trigger::Every(_, None) | Trigger::On { .. } | Trigger::Rate { .. } => {
                false
            }
        };
        piled_up || (0..self.instances.len()).any(stays)
    }

    /// The transitions of the next micro-step with what they do, greedily in their order.
    /// Those of `heard` are enabled by messages.
    fn choose(&self, heard: &[usize]) -> Vec<Taken> {
        let mut enabled: Vec<usize> =
            (0..self.instances.len()).filter(|instance| self.enabled(&self.world, *instance)).collect();
        enabled.extend(heard);
        enabled.sort_unstable();
        let rank = |instance: &usize| {
            let transition = self.transition(*instance);
            let mut scope = self.scope(&self.world, *instance);
            scope.received = self.received(*instance);
            let priority = transition.priority.map_or(0.0, |priority| scope.number(priority));
            // interactions stand beside what an agent does in every mode
            let depth = if self.is_pair(*instance) {
                0
            } else {
                let ty = self.world.agents[self.instances[*instance].agents[0]].ty;
                self.model.types[ty].modes[transition.source].depth
            };
            (-priority, depth, transition.span.start, self.instances[*instance].agents)
        };
        enabled.sort_by(|a, b| rank(a).partial_cmp(&rank(b)).expect("priorities are numbers"));
        let (mut chosen, mut written, mut busy) = (Vec::new(), Vec::new(), Vec::new());
        for instance in enabled {
            let taken = self.effect(instance);
            let regions = self.regions(&taken);
            let free = regions.iter().all(|region| !busy.contains(region));
            if free && taken.done.all.iter().all(|write| !written.contains(write)) {
                written.extend(taken.done.all.clone());
                busy.extend(regions);
                chosen.push(taken);
            }
        }
        chosen
    }

    /// The regions that a transition takes: its own, those of participants whose modes it changes, those of whom it destroys.
    fn regions(&self, taken: &Taken) -> Vec<(usize, ModeId)> {
        let all = |agent: usize| {
            let regions = modes::regions(&self.model.types[self.world.agents[agent].ty]);
            regions.into_iter().map(move |region| (agent, region))
        };
        let mut regions: Vec<(usize, ModeId)> = taken.done.destroyed.iter().copied().flat_map(all).collect();
        if self.is_pair(taken.instance) {
            regions.extend(taken.moves.iter().flat_map(|change| all(change.agent)));
        } else {
            let own = self.instances[taken.instance].agents[0];
            let ty = &self.model.types[self.world.agents[own].ty];
            match modes::region_of(ty, self.transition(taken.instance).source) {
                Some(region) => regions.push((own, region)),
                None => regions.extend(all(own)),
            }
        }
        regions
    }

    /// What the message at its turn carries.
    fn received(&self, instance: usize) -> Vec<f64> {
        let waiting = &self.post.inboxes[self.instances[instance].agents[0]].waiting;
        waiting.first().map_or(Vec::new(), |message| message.values.clone())
    }

    /// What a transition does, read on the present state.
    fn effect(&self, instance: usize) -> Taken {
        let transition = self.transition(instance);
        let agents = self.instances[instance].agents;
        let move_of = |agent: usize, target| {
            let there = &self.world.agents[agent];
            modes::change(&self.model.types[there.ty], (agent, there), transition.source, target)
        };
        let mut moves: Vec<Change> =
            transition.target.iter().map(|target| move_of(agents[0], *target)).collect();
        let mut done = Done::default();
        let mut scope = self.scope(&self.world, instance);
        scope.received = self.received(instance);
        let decided = self.instances[instance].boundary.decided(&mut scope, &self.world);
        scope.decided = &decided;
        if let Trigger::When(guard)
        | Trigger::After(_, Some(guard))
        | Trigger::Every(_, Some(guard))
        | Trigger::On { guard: Some(guard), .. }
        | Trigger::Rate { guard: Some(guard), .. } = transition.trigger
        {
            self.bind_witnesses(guard, transition, &mut scope);
        }
        scope.decided = &[];
        for action in &transition.actions {
            if let Action::Goto { participant, target, .. } = action {
                moves.push(move_of(agents[*participant], *target));
            }
        }
        for change in &moves {
            let modes = &self.model.types[self.world.agents[change.agent].ty].modes;
            let mut own = Scope::new(self.model, &self.world, [change.agent, change.agent], false);
            change.left.iter().for_each(|mode| collect(&modes[*mode].exit, &mut own, &mut done));
            let mut entry = Done::default();
            change.entered.iter().for_each(|mode| collect(&modes[*mode].entry, &mut own, &mut entry));
            done.all.extend(entry.all);
        }
        collect(&transition.actions, &mut scope, &mut done);
        Taken { instance, moves, done }
    }

    /// Binds the agents that the actions may name: the lowest for which the quantifier holds (rule 2).
    fn bind_witnesses(&self, guard: ExprId, transition: &Transition, scope: &mut Scope<'_>) {
        match &self.model.exprs[guard].kind {
            ExprKind::Apply(Op::And, operands) => {
                operands.iter().for_each(|operand| self.bind_witnesses(*operand, transition, scope));
            }
            ExprKind::Quantifier { binder, set, other, filter, body, .. }
                if transition.witnesses.contains(binder) =>
            {
                let outside = std::mem::take(&mut scope.bound);
                let found = scope.witness(*binder, *set, *other, *filter, *body, true);
                scope.bound = outside;
                scope.bound.extend(found.map(|agent| (*binder, agent)));
            }
            _ => {}
        }
    }

    /// One micro-step.
    fn execute(&mut self, taken: Vec<Taken>) {
        for taken in &taken {
            self.log(taken);
        }
        for taken in &taken {
            self.write(&taken.done.writes);
            self.send(taken.done.sent.clone());
            if let Trigger::On { .. } = self.transition(taken.instance).trigger {
                let agent = self.instances[taken.instance].agents[0];
                let inbox = &mut self.post.inboxes[agent];
                inbox.heard = true;
                inbox.enabled.retain(|(instance, _)| *instance != taken.instance);
            }
            self.instances[taken.instance].armed = false;
            if std::mem::take(&mut self.instances[taken.instance].pulse) {
                self.instances[taken.instance].k += 1;
            }
        }
        let moves: Vec<&Change> = taken.iter().flat_map(|taken| &taken.moves).collect();
        for change in &moves {
            let agent = &mut self.world.agents[change.agent];
            let ty = &self.model.types[agent.ty];
            agent.active = after(ty, &agent.active, &change.left, &[]);
            agent.enter(ty, self.world.time, &change.entered);
        }
        let entries: Vec<(usize, Vec<ModeId>)> =
            moves.iter().map(|change| (change.agent, change.entered.clone())).collect();
        let entry = self.run_entries(&entries);
        let of_all = taken.iter().map(|taken| &taken.done).chain([&entry]);
        let (created, destroyed): (Vec<Vec<Start>>, Vec<Vec<usize>>) =
            of_all.map(|done| (done.created.clone(), done.destroyed.clone())).unzip();
        self.turn_over(&created.concat(), &destroyed.concat());
        for instance in 0..self.instances.len() {
            let fired = taken.iter().any(|taken| taken.instance == instance);
            let own = self.instances[instance].agents[0];
            let source = self.transition(instance).source;
            let enters = |change: &&Change| change.agent == own && change.entered.contains(&source);
            let entered = !self.is_pair(instance) && moves.iter().copied().any(|change| enters(&change));
            if entered {
                let instance = &mut self.instances[instance];
                (instance.armed, instance.k, instance.pulse) = (true, 1, false);
                instance.entries += 1;
            }
            if entered || fired && self.is_active(instance) {
                self.draw(instance);
            }
            if fired || entered {
                self.instances[instance].boundary = self.settle(instance);
            } else {
                let agents = self.instances[instance].agents;
                let scope = Scope::new(self.model, &self.world, agents, self.is_pair(instance));
                let boundary = std::mem::take(&mut self.instances[instance].boundary);
                self.instances[instance].boundary = boundary.while_near(scope);
            }
        }
        self.arm();
    }

    /// What rule 3 says of the comparisons of a guard that has fired or been armed on their boundary.
    fn settle(&self, instance: usize) -> Boundary {
        let guard = match self.transition(instance).trigger {
            Trigger::When(guard) | Trigger::After(_, Some(guard)) => guard,
            Trigger::After(_, None) | Trigger::Every(..) | Trigger::On { .. } | Trigger::Rate { .. } => {
                return Boundary::default();
            }
        };
        Boundary::settle(self.scope(&self.world, instance), &self.world, guard)
    }

    fn log(&mut self, taken: &Taken) {
        let agents = self.instances[taken.instance].agents;
        let pair = self.is_pair(taken.instance);
        let heard = matches!(self.transition(taken.instance).trigger, Trigger::On { .. });
        let sender = self.post.inboxes[agents[0]].waiting.first().map(|message| message.sender);
        let sender = sender.filter(|_| heard);
        let row = |agent, other, modes| Row {
            time: self.world.time,
            label: self.transition(taken.instance).label.clone(),
            agent,
            other,
            modes,
        };
        let mut rows = Vec::new();
        for Change { agent, names, .. } in &taken.moves {
            let other = if *agent == agents[0] { agents[1] } else { agents[0] };
            rows.push(row(*agent, if pair { Some(other) } else { sender }, Some(names.clone())));
        }
        if rows.is_empty() {
            rows.push(row(agents[0], if pair { Some(agents[1]) } else { sender }, None));
        }
        self.rows.extend(rows);
    }
}

/// Adds what a list of actions does.
fn collect(actions: &[Action], scope: &mut Scope<'_>, done: &mut Done) {
    for action in actions {
        match action {
            Action::Assign { agent, variable, value, .. } => {
                let agent = scope.named(*agent);
                done.writes.retain(|write| (write.0, write.1) != (agent, *variable));
                done.writes.push((agent, *variable, scope.number(*value)));
                done.all.push((agent, *variable));
            }
            Action::Emit { agent, event, values, delay, .. } => {
                let sender = scope.named(*agent);
                let values = values.iter().map(|value| scope.number(*value)).collect();
                let event = (scope.world.agents[sender].ty, *event);
                let delay = delay.map_or(0.0, |delay| scope.number(delay));
                done.sent.push((Message { sender, event, values }, delay));
            }
            Action::If { condition, then, otherwise } => {
                let holds = scope.truth(*condition);
                for (branch, goes) in [(then, holds), (otherwise, !holds)] {
                    let mut inside = Done::default();
                    collect(branch, scope, &mut inside);
                    done.all.extend(inside.all);
                    if goes {
                        done.writes.extend(inside.writes);
                        done.sent.extend(inside.sent);
                        done.created.extend(inside.created);
                        done.destroyed.extend(inside.destroyed);
                    }
                }
            }
            Action::Goto { .. } => {}
            Action::Create(create) => done.created.push(start(create, scope)),
            Action::Destroy { agent, .. } => {
                let agent = scope.named(*agent);
                let ty = &scope.model.types[scope.world.agents[agent].ty];
                done.destroyed.push(agent);
                // Who destroys an agent writes all of it.
                done.all.extend((0..ty.states.len()).map(|k| (agent, VarRef::State(k))));
                done.all.extend((0..ty.discretes.len()).map(|k| (agent, VarRef::Discrete(k))));
            }
            Action::Stop { .. } | Action::Draw { .. } => panic!("the generator writes none of these"),
        }
    }
}

/// What an agent that is created starts with.
fn start(create: &Create, scope: &mut Scope<'_>) -> Start {
    let initials = &scope.model.types[create.ty].initials;
    let mut values = |given: &[Option<Given>], declared: &[Option<Given>]| -> Vec<f64> {
        let chosen = given.iter().zip(declared).map(|(given, declared)| given.or(*declared));
        chosen
            .map(|given| match given {
                Some(Given::Value(value)) => scope.number(value),
                Some(Given::Draw(_)) | None => panic!("the generator writes values"),
            })
            .collect()
    };
    Start {
        ty: create.ty,
        mode: create.mode,
        params: values(&create.params, &initials.params),
        states: values(&create.states, &initials.states),
        discretes: values(&create.discretes, &initials.discretes),
        links: create.links.iter().map(|link| link.and_then(|link| scope.agent(link))).collect(),
    }
}
