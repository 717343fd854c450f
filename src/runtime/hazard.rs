//! Rule 11: what is left of the hazard of a `rate` transition, and the gate through which it is taken away.
//!
//! What is left begins with a number drawn from the exponential distribution of mean 1, and falls by the hazard while the gate
//! is open; the transition fires when nothing is left. The gate is open while the transition's guard is true: a guard of its
//! own, which changes the gate and nothing else.
//!
//! Of an interaction no agent has such a state. Where the hazard is constant between writes, a time is drawn, whenever the hazard
//! changes, by its guard or by what it reads; where it flows, `exposure` follows it.

use crate::codegen::program::{Distribution, Entry, TransitionSystem, Trigger};
use crate::math::draw::Key;
use crate::runtime::act::{Effect, Write, Written};
use crate::runtime::agenda::Due;
use crate::runtime::arm::Rule;
use crate::runtime::engine::Engine;
use crate::runtime::failure::{Failure, Reason};
use crate::runtime::guards::Origin;
use crate::runtime::population::Slots;
use crate::runtime::solve::scheduled;
use crate::runtime::truth::{self, Side};

impl Engine<'_, '_> {
    /// Draws what is left of the hazard of an instance that is being armed. Its agent has been restarted at this instant.
    pub fn draw_hazard(&mut self, instance: u32) {
        let Some(&Trigger::Rate { hazard, stream, .. }) = self.guards.definition(instance).trigger() else {
            return;
        };
        let agent = self.guards.instances[instance as usize].roots[0] as usize;
        let drawn = self.draw((agent, stream), Distribution::Exponential, &[1.0]);
        let state = self.agents.layout(agent).hazard(hazard);
        self.agents.agents[agent].states[state] = drawn;
        self.present.forget();
    }

    /// Draws anew what is left of the hazard of a transition that fires, unless it leaves its mode: then that is done when the mode
    /// is entered again.
    pub fn renew_hazard(&mut self, transition: &TransitionSystem, agent: usize, effect: &mut Effect) {
        let Trigger::Rate { hazard, stream, .. } = transition.trigger else { return };
        if effect.moves.iter().any(|change| change.left.contains(&transition.source)) {
            return;
        }
        let value = self.draw((agent, stream), Distribution::Exponential, &[1.0]);
        let target = Entry::State(self.agents.layout(agent).hazard(hazard));
        effect.writes.push(Write { agent, target, value, span: transition.span });
    }

    /// Whether an instance has a hazard that its guard takes away: a gate, or a chance.
    pub fn is_gated(&self, instance: u32) -> bool {
        let definition = self.guards.definition(instance);
        matches!(definition.origin, Origin::Gate(_))
            || matches!(definition.trigger(), Some(Trigger::Chance { .. }))
    }

    /// Opens and closes the gates among some instances by the truths of their conditions just after the instant.
    pub fn set_gates(&mut self, instances: &[u32]) -> Result<(), Failure> {
        let mut written = Written::default();
        for &instance in instances {
            if let Origin::Pair(pair) = self.guards.definition(instance).origin {
                self.set_chance(instance, &pair.transition)?;
                continue;
            }
            let Origin::Gate(transition) = self.guards.definition(instance).origin else { continue };
            let Trigger::Rate { hazard, .. } = transition.trigger else { continue };
            if !self.guards.instances[instance as usize].active {
                continue;
            }
            for index in self.guards.atoms_of(instance) {
                self.settle(index, Rule::Rates, &Written::default());
            }
            let gate = f64::from(u8::from(self.truths().holds(instance, Side::After)));
            let agent = self.guards.instances[instance as usize].roots[0] as usize;
            let column = self.agents.layout(agent).gate(hazard);
            if self.agents.agents[agent].aux[column] != gate {
                self.restart(agent, &mut written);
                self.agents.agents[agent].aux[column] = gate;
            }
        }
        if !written.restarted.is_empty() {
            self.present.forget();
            self.wake(&written)?;
        }
        Ok(())
    }

    /// Draws when a pair fires, if its hazard is another one than just before: its guard has become true or false, its rate has been
    /// written, or it has fired. (What is left of an exponential time is one again, so nothing has to be kept.)
    fn set_chance(&mut self, instance: u32, transition: &TransitionSystem) -> Result<(), Failure> {
        let Trigger::Chance { rate, flows, .. } = transition.trigger else { return Ok(()) };
        if !self.guards.instances[instance as usize].active {
            return Ok(());
        }
        for index in self.guards.atoms_of(instance) {
            self.settle(index, Rule::Rates, &Written::default());
        }
        let open = self.truths().holds(instance, Side::After);
        if flows {
            self.set_exposure(instance, transition, open);
            return Ok(());
        }
        let mut hazard = 0.0;
        if open {
            let (slots, own) = (self.guards.slots(&self.agents, instance), self.guards.roots(instance));
            let frame = &transition.frame;
            hazard = truth::value(&self.agents, &mut self.present, rate, frame, &slots, &own);
            if !(hazard >= 0.0 && hazard.is_finite()) {
                return Err(self.bad_hazard(transition, (&slots, &own), hazard));
            }
        }
        let time = self.present.time;
        let state = &mut self.guards.instances[instance as usize];
        if state.delay == hazard {
            return Ok(());
        }
        state.delay = hazard;
        state.arming += 1;
        if hazard > 0.0 {
            let version = state.arming;
            let due = scheduled(time + self.draw_for_pair(instance, transition, hazard), self.time_end);
            self.queues.schedules.push(Due { time: due, number: instance, version });
        }
        Ok(())
    }

    /// The next number of a pair's own stream, of the exponential distribution of this rate.
    pub fn draw_for_pair(&mut self, instance: u32, transition: &TransitionSystem, rate: f64) -> f64 {
        let state = &mut self.guards.instances[instance as usize];
        state.periods += 1;
        let draw = state.periods;
        let [first, second] = [0, 1].map(|which| self.guards.roots(instance)[which]);
        let variable = format!("{} {}", transition.label, self.agents.draw_path(second));
        let agent = self.agents.draw_path(first);
        let key = Key { seed: self.program.run.seed, agent: &agent, variable: &variable, draw };
        Distribution::Exponential.draw(&[rate], key)
    }

    /// What the hazard of a pair is at the present instant is none.
    pub fn bad_hazard(
        &mut self,
        transition: &TransitionSystem,
        (slots, own): (&Slots, &[usize]),
        hazard: f64,
    ) -> Failure {
        let Trigger::Chance { rate, .. } = transition.trigger else { unreachable!("of pairs only") };
        let blame = self.blame(rate, &transition.frame, slots, own);
        let (place, label) = (self.place(slots[0]), transition.label.clone());
        Reason::BadHazard { place, label, hazard, blame, span: transition.span }.into()
    }
}
