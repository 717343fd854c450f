//! Births and deaths (rule 10): agents are made and removed at the end of a micro-step, those to be made first.
//!
//! What an agent is given is read where its creator acts, with everything else that the micro-step reads. It comes to be
//! when all has been written: numbers follow the order of the transitions that fired and of their actions. Its entry
//! actions may create and destroy in their turn. What a place, a seat or a guard instance has been used for is used again
//! from the next instant on; numbers are not.

use std::sync::Arc;

use rustc_hash::FxHashSet;

use crate::base::Span;
use crate::codegen::kernel::AgentView;
use crate::codegen::program::{Birth, Frame, Initials, Layout, SetSystem, Source, VarRef};
use crate::math::draw::Key;
use crate::runtime::act::Written;
use crate::runtime::ahead::Ahead;
use crate::runtime::engine::Engine;
use crate::runtime::failure::Failure;
use crate::runtime::fate::Fate;
use crate::runtime::guards::Origin;
use crate::runtime::population::{ABSENT, Agent, Slots};
use crate::runtime::route::{begin_histories, first};
use crate::runtime::solve::segment::Segment;
use crate::runtime::truth;

/// An agent that is to be made.
#[derive(Clone, Debug)]
pub struct Conceived {
    /// How.
    birth: Arc<Birth>,
    /// By whom.
    creator: usize,
    /// What its random numbers belong to.
    word: u64,
    /// What it is given.
    given: Vec<(VarRef, f64)>,
    /// Link by number, and whom it leads to.
    links: Vec<(usize, usize)>,
}

/// An agent that is to be removed.
#[derive(Clone, Copy, Debug)]
pub struct Doomed {
    /// Who.
    pub agent: usize,
    /// The action.
    pub span: Span,
}

/// The variables of an agent that is being made.
struct Row {
    states: Vec<f64>,
    aux: Vec<f64>,
}

impl Engine<'_, '_> {
    /// Reads what an agent is given, on the rows of the present instant.
    pub fn conceive(
        &mut self,
        birth: &Arc<Birth>,
        frame: &Frame,
        slots: &Slots,
        own: &[usize],
    ) -> Result<Conceived, Failure> {
        let creator = slots[0];
        let count = self.agents.agents[creator].created;
        self.agents.agents[creator].created += 1;
        let path = self.agents.draw_path(creator);
        let seed = self.program.run.seed;
        let word = Key { seed, agent: &path, variable: "create", draw: 0 }.word(count);
        let mut given = Vec::with_capacity(birth.given.len());
        for (variable, source) in &birth.given {
            let mut values = Vec::with_capacity(2);
            for &function in source.functions() {
                let value = truth::value(&self.agents, &mut self.present, function, frame, slots, own);
                if !value.is_finite() && matches!(source, Source::Number(_)) {
                    let blame = self.blame(function, frame, slots, own);
                    self.check_start(birth, creator, *variable, value, blame)?;
                }
                values.push(value);
            }
            given.push((*variable, self.started(birth, creator, (*variable, source), &values, word)?));
        }
        let links = birth.links.iter().map(|&(link, slot)| (link, slot.map_or(ABSENT, |slot| slots[slot])));
        Ok(Conceived { birth: birth.clone(), creator, word, given, links: links.collect() })
    }

    /// What a variable starts with: the number that has been worked out, or one drawn with these parameters.
    fn started(
        &mut self,
        birth: &Birth,
        creator: usize,
        (variable, source): (VarRef, &Source),
        values: &[f64],
        word: u64,
    ) -> Result<f64, Failure> {
        let Source::Draw { distribution, span, .. } = source else { return Ok(values[0]) };
        if let Some((wrong, needs)) = distribution.problem(values) {
            let parameter = format!("{} of `{}`", distribution.parameters()[wrong], distribution.name());
            let place = self.place(creator);
            return Err(Fate::BadDraw { place, parameter, needs, value: values[wrong], span: *span }.into());
        }
        let (agent, name) = (format!("#{word:016x}"), self.variable(birth.ty, variable).to_string());
        let key = Key { seed: self.program.run.seed, agent: &agent, variable: &name, draw: 0 };
        let value = distribution.draw(values, key);
        self.check_start(birth, creator, variable, value, None)?;
        Ok(value)
    }

    fn variable(&self, ty: usize, variable: VarRef) -> &str {
        let system = &self.program.types[ty];
        match variable {
            VarRef::State(k) => &system.states[k].name,
            VarRef::Discrete(k) => &system.discretes[k].name,
            VarRef::Param(k) => &system.params[k].name,
            VarRef::Link(k) => &system.links[k].name,
            VarRef::Let(k) => &system.lets[k].column.name,
        }
    }

    /// A parameter may be infinite, nothing may be undefined.
    fn check_start(
        &mut self,
        birth: &Birth,
        creator: usize,
        variable: VarRef,
        value: f64,
        blame: Option<crate::codegen::trace::Blame>,
    ) -> Result<(), Failure> {
        if value.is_finite() || matches!(variable, VarRef::Param(_)) && !value.is_nan() {
            return Ok(());
        }
        let ty = &self.program.types[birth.ty].name;
        let variable = format!("{ty}#{}.{}", self.agents.n_numbers, self.variable(birth.ty, variable));
        let place = self.place(creator);
        Err(Fate::StartNotFinite { place, variable, value, blame, span: birth.span }.into())
    }

    /// Makes and removes agents as a micro-step, and the entry actions of those made, want it.
    pub fn turn_over(&mut self, written: &mut Written) -> Result<(), Failure> {
        let mut generations = 0;
        while !written.conceived.is_empty() && !self.interrupted() {
            let conceived = std::mem::take(&mut written.conceived);
            // Who is born has others made on entry, and these too.
            generations += 1;
            if generations > self.limits.generations_max {
                let (limit, span) = (self.limits.generations_max, conceived[0].birth.span);
                let place = self.place(written.born.last().copied().unwrap_or(conceived[0].creator));
                return Err(Fate::Generations { place, limit, span }.into());
            }
            let mut born = Vec::with_capacity(conceived.len());
            for conceived in &conceived {
                born.push(self.bear(conceived)?);
            }
            self.present.forget();
            self.place_anew(written.before.keys().chain(&written.born).chain(&born).copied());
            for (&agent, conceived) in born.iter().zip(&conceived) {
                self.join_sets(agent, conceived.birth.span, written)?;
            }
            self.set_links(&born);
            let entries: Vec<(usize, &[usize])> =
                born.iter().map(|&agent| (agent, self.agents.mode(agent).active.as_slice())).collect();
            written.born.extend(&born);
            self.run_entries(&entries, written)?;
        }
        for &agent in &written.born {
            // There was nothing before.
            written.before.remove(&agent);
            written.restarted.insert(agent);
        }
        self.bury(written)
    }

    /// Leads the links by which flows read sets: those of the others to who has been born, those of the newborn to all members.
    fn join_sets(&mut self, newborn: usize, span: Span, written: &mut Written) -> Result<(), Failure> {
        let program = self.program;
        for (ty, system) in program.types.iter().enumerate() {
            for set in &system.sets {
                if self.agents.agents[newborn].ty == ty {
                    for member in self.agents.of_type[set.ty].clone() {
                        if self.belongs(member, set) {
                            self.join([newborn, member], set, span, written)?;
                        }
                    }
                }
                if self.belongs(newborn, set) {
                    for owner in self.agents.of_type[ty].clone() {
                        self.join([owner, newborn], set, span, written)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Whether an agent is of a set.
    fn belongs(&self, agent: usize, set: &SetSystem) -> bool {
        let Agent { ty, aux, .. } = &self.agents.agents[agent];
        let is_named = |param| aux[self.program.types[*ty].layout.param(param)] == 1.0;
        *ty == set.ty && set.belongs.is_none_or(is_named)
    }

    /// Leads the first free link of a set of an agent to a member, if none leads there.
    fn join(
        &mut self,
        [owner, member]: [usize; 2],
        set: &SetSystem,
        span: Span,
        written: &mut Written,
    ) -> Result<(), Failure> {
        let linked = |link: &usize| self.agents.linked(owner, *link);
        if set.links.clone().any(|link| linked(&link) == member) {
            return Ok(());
        }
        let Some(link) = set.links.clone().find(|link| linked(link) == ABSENT) else {
            let (place, members) = (self.place(owner), self.program.types[set.ty].name.clone());
            return Err(Fate::SetFull { place, members, limit: set.links.len() - set.count, span }.into());
        };
        self.relink(owner, link, member, written);
        Ok(())
    }

    /// Makes an agent, with its guards, which are not armed yet; returns its place.
    fn bear(&mut self, conceived: &Conceived) -> Result<usize, Failure> {
        let Conceived { birth, creator, word, .. } = conceived;
        let (ty, limit) = (birth.ty, self.limits.agents_max);
        if self.agents.n_occupied() >= limit {
            return Err(Fate::TooMany { place: self.place(*creator), limit, span: birth.span }.into());
        }
        for (link, declared) in self.program.types[ty].links.iter().enumerate() {
            let is_given = conceived.links.iter().any(|&(given, target)| given == link && target != ABSENT);
            if declared.required && !is_given {
                let name = &self.program.types[ty].name;
                let parameter = format!("{name}#{}.{}", self.agents.n_numbers, declared.name);
                let place = self.place(*creator);
                return Err(Fate::RequiredNone { place, parameter, span: birth.span }.into());
            }
        }
        let Row { states, aux } = self.row(conceived)?;
        self.make_seat(ty)?;
        let segment = Segment::at(self.present.time, &states);
        let (number, seat, word, created, mode, group) =
            (0, 0, Some(*word), 0, first(&self.program.types[ty], birth.mode), 0);
        let n_states = states.len();
        let (ahead, draws) = (Ahead::default(), vec![0; self.program.types[ty].streams.len()]);
        let place = self.agents.admit(Agent {
            number,
            ty,
            seat,
            word,
            created,
            mode,
            group,
            states,
            aux,
            draws,
            segment,
            ahead,
        });
        for &(link, target) in &conceived.links {
            self.agents.link(place, link, target);
        }
        self.make_rows(place, n_states);
        let time = self.present.time;
        for group in self.groups.divide(&mut self.agents, &[place], time, &|_| None) {
            self.queue_clock(group);
        }
        self.guards.reseat(&self.agents, place);
        self.make_guards(place)?;
        Ok(place)
    }

    /// The variables that an agent starts with: what it is given, then what is declared, each after those that it reads.
    fn row(&mut self, conceived: &Conceived) -> Result<Row, Failure> {
        let Conceived { birth, creator, word, given, .. } = conceived;
        let program = self.program;
        let system = &program.types[birth.ty];
        let layout = &system.layout;
        let mut row = Row { states: vec![0.0; layout.n_states], aux: vec![0.0; layout.n_aux()] };
        // What is left of hazards is drawn when their transitions are armed.
        (0..layout.n_hazards).for_each(|hazard| row.states[layout.hazard(hazard)] = 1.0);
        row.aux[Layout::MODE] = first(system, birth.mode) as f64;
        row.aux[Layout::ENTRY] = self.present.time;
        (0..layout.n_links).for_each(|link| row.aux[layout.link(link)] = -1.0);
        begin_histories(system, first(system, birth.mode), &mut row.aux);
        given.iter().for_each(|&(variable, value)| row.set(layout, variable, value));
        let Initials { values, .. } = &system.initials;
        for (variable, source) in values {
            if given.iter().any(|(known, _)| known == variable) {
                continue;
            }
            let numbers: Vec<f64> = source
                .functions()
                .iter()
                .map(|&function| {
                    let mut out = [0.0];
                    program.kernel(function).eval(&[row.view()], self.present.time, &mut out);
                    out[0]
                })
                .collect();
            let value = self.started(birth, *creator, (*variable, source), &numbers, *word)?;
            self.check_start(birth, *creator, *variable, value, None)?;
            row.set(layout, *variable, value);
        }
        Ok(row)
    }

    /// Sees to it that a type has a free seat.
    fn make_seat(&mut self, ty: usize) -> Result<(), Failure> {
        if self.agents.has_seat(ty) {
            return Ok(());
        }
        let before = self.agents.seats[ty].len();
        self.agents.add_seats(ty);
        self.mind_guards((self.guards.instances.len() + self.guards.size(&self.agents)) as u128)?;
        self.guards.make_room(&self.agents, ty, before, &mut self.queues);
        Ok(())
    }

    /// Everything that is kept for each place.
    fn make_rows(&mut self, place: usize, n_states: usize) {
        self.present.admit(place);
        self.approach.note(place, self.present.time, || vec![0.0; n_states]);
        self.notes.iter_mut().for_each(|notes| notes.aside.admit(place));
        self.reaches.admit(place, n_states);
        self.stepper.forget(place);
        self.repetitions.forget_agent(place);
        self.guards.admit(place);
        self.recorder.admit(self.agents.who(place), place);
        if self.agents.cold.is_used() {
            self.agents.cold.admit(place);
            if self.agents.cold.may_ever_be(self.agents.agents[place].ty) {
                self.hot.push(place);
            }
        }
    }

    /// The guard instances of an agent that has been made, but for those of pairs that are listed when they are near.
    fn make_guards(&mut self, place: usize) -> Result<(), Failure> {
        let ty = self.agents.agents[place].ty;
        for number in 0..self.guards.definitions.len() {
            let definition = &self.guards.definitions[number];
            if !definition.near.is_empty() {
                continue;
            }
            let first = definition.ty;
            let Origin::Pair(pair) = definition.origin else {
                if first == ty {
                    self.make_guard(number, [place as u32, u32::MAX])?;
                }
                continue;
            };
            let second = definition.frame.slots[1].ty();
            // It has the greatest number.
            let others = |of: usize| self.agents.of_type[of].iter().filter(|&&other| other != place).copied();
            let mut pairs: Vec<[u32; 2]> = Vec::new();
            if second == ty {
                pairs.extend(others(first).map(|other| [other as u32, place as u32]));
            }
            if first == ty && !pair.symmetric {
                pairs.extend(others(second).map(|other| [place as u32, other as u32]));
            }
            for roots in pairs {
                self.make_guard(number, roots)?;
            }
        }
        Ok(())
    }

    fn make_guard(&mut self, number: usize, roots: [u32; 2]) -> Result<u32, Failure> {
        let more = 1 + self.guards.definitions[number].n_atoms;
        if !self.guards.has_free(number) {
            self.mind_guards((self.guards.instances.len() + self.guards.atoms.len() + more) as u128)?;
        }
        let instance = self.guards.list(&self.agents, number, roots);
        self.repetitions.forget(instance);
        Ok(instance)
    }

    /// Removes those who are to be removed. Links to them become none; a parameter cannot.
    fn bury(&mut self, written: &mut Written) -> Result<(), Failure> {
        let doomed = std::mem::take(&mut written.doomed);
        let dying: FxHashSet<usize> = doomed.iter().map(|doomed| doomed.agent).collect();
        if doomed.is_empty() {
            return Ok(());
        }
        let mut done = Ok(());
        for doomed in doomed {
            if self.agents.is_alive(doomed.agent) {
                done = self.unlink(doomed, &dying, written);
                if done.is_err() {
                    break;
                }
                self.remove(doomed.agent, written);
            }
        }
        self.strike_out(&dying, written);
        done
    }

    /// Takes the dead among these out of the lists of many; once for all of them.
    fn strike_out(&mut self, dying: &FxHashSet<usize>, written: &mut Written) {
        let mut dead = dying.clone();
        dead.retain(|&agent| !self.agents.is_alive(agent));
        self.agents.close_ranks();
        self.guards.thin();
        self.recorder.dismiss(&dead);
        self.hot.retain(|agent| !dead.contains(agent));
        written.before.retain(|agent, _| !dead.contains(agent));
        written.restarted.retain(|agent| !dead.contains(agent));
        written.relinked.retain(|agent| !dead.contains(agent));
        written.born.retain(|agent| !dead.contains(agent));
    }

    /// Takes the links to an agent from those who live on.
    fn unlink(
        &mut self,
        doomed: Doomed,
        dying: &FxHashSet<usize>,
        written: &mut Written,
    ) -> Result<(), Failure> {
        let mut holders: Vec<usize> = self.agents.linked_from(doomed.agent).to_vec();
        holders.sort_unstable_by_key(|&holder| self.agents.number(holder));
        holders.dedup();
        for holder in holders {
            if dying.contains(&holder) {
                continue;
            }
            let links = &self.program.types[self.agents.agents[holder].ty].links;
            for (link, declared) in links.iter().enumerate() {
                if self.agents.linked(holder, link) != doomed.agent {
                    continue;
                }
                if declared.required {
                    let place = self.place(doomed.agent);
                    let (holder, parameter) = (self.agents.name(holder), declared.name.clone());
                    return Err(Fate::Held { place, holder, parameter, span: doomed.span }.into());
                }
                self.relink(holder, link, ABSENT, written);
            }
        }
        Ok(())
    }

    /// Leads a link of an agent somewhere else.
    pub fn relink(&mut self, agent: usize, link: usize, target: usize, written: &mut Written) {
        self.remember(agent, written);
        let column = self.agents.layout(agent).link(link);
        self.restart_readers(agent, column, written);
        self.agents.link(agent, link, target);
        written.relinked.push(agent);
        self.present.forget();
    }

    /// The instant is over: nothing refers to those who died in it, nor to their guards.
    pub fn end_lives(&mut self) {
        self.guards.free_retired();
        self.agents.free_retired();
    }

    /// Takes an agent out of everything but what [`Engine::strike_out`] sees to.
    fn remove(&mut self, agent: usize, written: &mut Written) {
        self.restart(agent, written);
        self.note_counts(agent);
        let ty = self.agents.agents[agent].ty;
        let number = self.agents.agents[agent].group;
        let group = &mut self.groups.groups[number];
        group.members.retain(|&member| member != agent);
        written.relinked.extend(&group.members);
        if group.members.is_empty() {
            self.groups.dissolve(number);
        }
        self.guards.retire_all(agent);
        self.mail.forget(agent);
        self.neighbours.forget(&self.agents, agent);
        written.bereft.extend(self.guards.dismiss_everywhere(&self.agents, agent));
        self.agents.dismiss(agent);
        self.guards.reseat(&self.agents, agent);
        if self.agents.cold.is_used() {
            self.agents.cold.dismiss(agent);
        }
        if !written.died.contains(&ty) {
            written.died.push(ty);
        }
    }
}

impl Row {
    fn set(&mut self, layout: &Layout, variable: VarRef, value: f64) {
        match variable {
            VarRef::State(k) => self.states[k] = value,
            VarRef::Discrete(k) => self.aux[layout.discrete(k)] = value,
            VarRef::Param(k) => self.aux[layout.param(k)] = value,
            VarRef::Link(_) | VarRef::Let(_) => {}
        }
    }

    fn view(&self) -> AgentView<'_> {
        AgentView { states: &self.states, rates: &[], accelerations: &[], aux: &self.aux }
    }
}
