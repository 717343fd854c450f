//! Links that follow from an expression are kept up to date (rules 1, 4 and 7).
//!
//! A link is looked at when a comparison of its guard has changed: by the flow, or because something was written. Whom it is to
//! lead to follows from the truths of its comparisons just after the instant, never from numbers that are equal there: it goes
//! to who has become nearer, and stays where it is as long as nobody is. Links that change are written together, and are no
//! events; what reads them is woken as by any other write.

use smallvec::SmallVec;

use crate::codegen::program::{Condition, LinkUpdate, Whither};
use crate::runtime::act::Written;
use crate::runtime::arm::Rule;
use crate::runtime::engine::Engine;
use crate::runtime::failure::Failure;
use crate::runtime::guards::{Origin, allowed};
use crate::runtime::population::ABSENT;
use crate::runtime::truth;

impl<'p> Engine<'p, '_> {
    /// Leads the links of agents where their expressions say, by the numbers of the present instant: at t = 0 and at birth.
    /// One that reads another one comes after it.
    pub fn set_links(&mut self, agents: &[usize]) {
        let program = self.program;
        let n_links = program.types.iter().map(|ty| ty.links.len()).max().unwrap_or(0);
        for _ in 0..=n_links {
            let mut has_changed = false;
            for &agent in agents {
                for (link, declared) in program.types[self.agents.agents[agent].ty].links.iter().enumerate() {
                    if declared.updates.is_empty() {
                        continue;
                    }
                    let target = self.whom_by_numbers(agent, &declared.updates);
                    if target != self.agents.linked(agent, link) {
                        self.agents.link(agent, link, target);
                        self.guards.spare(&self.agents, agent, link);
                        self.present.forget();
                        has_changed = true;
                    }
                }
            }
            if !has_changed {
                return;
            }
        }
    }

    fn whom_by_numbers(&mut self, agent: usize, updates: &[LinkUpdate]) -> usize {
        for update in updates {
            let LinkUpdate { frame, case, target, .. } = update;
            let mut slots = self.agents.slots(frame, &[agent]);
            if !truth::test(&self.agents, &mut self.present, case, frame, &slots, &[agent]) {
                continue;
            }
            let Whither::Nearest { range, filter, key, .. } = target else {
                return if let Whither::Slot(slot) = target { slots[*slot] } else { ABSENT };
            };
            for tries in 0.. {
                let (among, beyond) = self.among(agent, update, tries);
                let mut best = (f64::INFINITY, ABSENT);
                for other in among {
                    if range.other && other == agent {
                        continue;
                    }
                    slots[range.slot] = other;
                    self.agents.follow_links(frame, &mut slots);
                    if truth::test(&self.agents, &mut self.present, filter, frame, &slots, &[agent]) {
                        let key =
                            truth::value(&self.agents, &mut self.present, *key, frame, &slots, &[agent]);
                        if key < best.0 || best.1 == ABSENT && !key.is_nan() {
                            best = (key, other);
                        }
                    }
                }
                if best.0 < beyond || beyond == f64::INFINITY {
                    return best.1;
                }
            }
        }
        ABSENT
    }

    /// Brings up to date, at the present instant, those links among some guard instances that do not lead where they should,
    /// and those that read them. Returns the instances that have been woken.
    pub fn refresh_links(&mut self, concerned: &[u32]) -> Result<Vec<u32>, Failure> {
        let mut all = Vec::new();
        let mut concerned = concerned.to_vec();
        loop {
            let changes = self.strayed(&concerned)?;
            if changes.is_empty() {
                all.sort_unstable();
                all.dedup();
                return Ok(all);
            }
            let mut written = Written::default();
            let mut own: Vec<u32> = Vec::new();
            for &(agent, link, target) in &changes {
                let instances = self.guards.of_link(agent, link);
                self.count_firing(instances[0])?;
                self.relink(agent, link, target, &mut written);
                own.extend(instances);
            }
            for &(agent, link, _) in &changes {
                for index in self.guards.spare(&self.agents, agent, link) {
                    self.settle(index, Rule::Rates, &Written::default());
                }
            }
            self.regroup(&mut written);
            self.set_locks(written.restarted.iter().copied());
            let woken = self.wake(&written)?;
            for instance in own {
                self.settle_fired(instance, &written);
            }
            all.extend(&woken);
            concerned = woken;
        }
    }

    /// The links among some guard instances that do not lead where they should, with whom they should lead to.
    fn strayed(&mut self, concerned: &[u32]) -> Result<Vec<(usize, usize, usize)>, Failure> {
        let mut links: Vec<(usize, usize, usize)> = Vec::new();
        for &instance in concerned {
            let state = &self.guards.instances[instance as usize];
            if let (true, Origin::Link(update)) = (state.active, self.guards.definition(instance).origin) {
                let agent = state.roots[0] as usize;
                links.push((self.agents.number(agent), agent, update.link));
            }
        }
        links.sort_unstable();
        links.dedup();
        let mut strayed = Vec::new();
        for (_, agent, link) in links {
            let target = self.whom(agent, link)?;
            if target != self.agents.linked(agent, link) {
                strayed.push((agent, link, target));
            }
        }
        Ok(strayed)
    }

    /// Whom a link is to lead to, by the truths of its comparisons: the first case that holds says it.
    fn whom(&mut self, agent: usize, link: usize) -> Result<usize, Failure> {
        for instance in self.guards.of_link(agent, link) {
            let Origin::Link(update) = self.guards.definition(instance).origin else { continue };
            let Condition::And(terms) = &update.stale.condition else { continue };
            let mut slots = self.guards.slots(&self.agents, instance);
            if !self.truths().part(instance, &terms[0], &mut slots) {
                continue;
            }
            return match &update.target {
                Whither::Nobody => Ok(ABSENT),
                Whither::Slot(slot) => Ok(slots[*slot]),
                Whither::Nearest { .. } => self.nearest(instance, update, &terms[1]),
            };
        }
        Ok(self.agents.linked(agent, link))
    }

    /// Who is nearest, for a condition of the shape that [`Whither::Nearest`] says.
    fn nearest(
        &mut self,
        instance: u32,
        update: &'p LinkUpdate,
        strays: &Condition,
    ) -> Result<usize, Failure> {
        let agent = self.guards.instances[instance as usize].roots[0] as usize;
        let current = self.agents.linked(agent, update.link);
        let (Whither::Nearest { key, .. }, Condition::Or(terms)) = (&update.target, strays) else {
            return Ok(current);
        };
        let [Condition::Exists(better), Condition::And(lost)] = &terms[..] else { return Ok(current) };
        let Condition::And(parts) = &*better.body else { return Ok(current) };
        let [filter, Condition::Or(nearer)] = &parts[..] else { return Ok(current) };
        let mut slots = self.guards.slots(&self.agents, instance);
        let stays = current != ABSENT && !self.truths().part(instance, &lost[1], &mut slots.clone());
        for tries in 0.. {
            let known = self.guards.candidates_at(instance, better.slot);
            let among: Vec<usize> = match known {
                Some(known) => known.iter().map(|candidate| candidate.agent as usize).collect(),
                None => self.agents.of_type[better.ty].clone(),
            };
            let mut candidates: SmallVec<[usize; 4]> = SmallVec::new();
            for other in among {
                if other == current || !allowed(better, &[agent], other) {
                    continue;
                }
                slots[better.slot] = other;
                self.agents.follow_links(&update.frame, &mut slots);
                let truths = self.truths();
                if truths.part(instance, filter, &mut slots)
                    && (!stays || truths.part(instance, &nearer[1], &mut slots))
                {
                    candidates.push(other);
                }
            }
            let mut best = (f64::INFINITY, if stays { current } else { ABSENT });
            let mut is_first = true;
            for other in candidates {
                slots[better.slot] = other;
                self.agents.follow_links(&update.frame, &mut slots);
                let key =
                    truth::value(&self.agents, &mut self.present, *key, &update.frame, &slots, &[agent]);
                if key < best.0 || is_first && !key.is_nan() {
                    (best, is_first) = ((key, other), false);
                }
            }
            let least = (!is_first).then_some(best.0);
            if stays || !self.look_farther(instance, least, tries)? {
                return Ok(best.1);
            }
        }
        Ok(current)
    }
}
