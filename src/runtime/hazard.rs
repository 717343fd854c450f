//! Rule 11: what is left of the hazard of a `rate` transition, and the gate through which it is taken away.
//!
//! What is left begins with a number drawn from the exponential distribution of mean 1, and falls by the hazard while the gate
//! is open; the transition fires when nothing is left. The gate is open while the transition's guard is true: a guard of its
//! own, which changes the gate and nothing else.

use crate::codegen::program::{Distribution, Target, TransitionSystem, Trigger};
use crate::runtime::act::{Effect, Write, Written};
use crate::runtime::arm::Rule;
use crate::runtime::engine::Engine;
use crate::runtime::failure::Failure;
use crate::runtime::guards::Origin;
use crate::runtime::truth::Side;

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
        let target = Target::State(self.agents.layout(agent).hazard(hazard));
        effect.writes.push(Write { agent, target, value, span: transition.span });
    }

    /// Opens and closes the gates among some instances by the truths of their conditions just after the instant.
    pub fn set_gates(&mut self, instances: &[u32]) -> Result<(), Failure> {
        let mut written = Written::default();
        for &instance in instances {
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
}
