//! Algorithm `sasim-2004`: Algorithms 3 and 4 of Esposito & Kumar (2004), the traditional simulation with one clock.
//!
//! All agents are one group: one step for all, its error the largest of all, at an event all begin afresh. The guards are
//! Gear & Osterby's extra states (8)-(10), integrated with the system; they are not in its error test.

use crate::runtime::clocks::{Clocks, Turn};
use crate::runtime::failure::Failure;
use crate::runtime::groups::Group;
use crate::runtime::observe::End;
use crate::runtime::solve::extra_state::ExtraStates;

impl Clocks<'_, '_> {
    /// Algorithm 3, SAsim.
    pub fn sasim(&mut self) -> Result<End, Failure> {
        self.extra = Some(ExtraStates::default());
        self.begin()?;
        loop {
            let all = match self.between_steps()? {
                Turn::End(end) => return Ok(end),
                Turn::Again => continue,
                Turn::Step(all) => all,
            };
            let h_g = self.sa_step_select();
            self.step(all, h_g)?;
            self.step_extra(all);
        }
    }

    /// Algorithm 4, SAstepSelect: h_g of all. (27) takes the bounds and h_err.
    fn sa_step_select(&mut self) -> f64 {
        let Some(extra) = &self.extra else { return f64::INFINITY };
        let mut h_g = f64::INFINITY;
        for (index, g) in std::mem::take(&mut self.surveyed) {
            h_g = h_g.min(self.select.sa(g, extra.predictor(index)));
            self.watch.count_polynomial();
        }
        h_g
    }

    /// Begins the extra states afresh, where the algorithm has them: they are the guards.
    pub fn restart_extra(&mut self, time: f64) {
        let Some(mut extra) = self.extra.take() else { return };
        let (rates, second) = self.rates_now();
        extra.restart(time, &self.guards_now(), &rates, &second);
        self.extra = Some(extra);
    }

    /// Integrates the extra states over the step that the system has taken (9).
    fn step_extra(&mut self, all: usize) {
        let Some(mut extra) = self.extra.take() else { return };
        let Group { clock, integration, .. } = &self.engine.groups.groups[all];
        let (time, begins_afresh) = (*clock, integration.past().len() == 1);
        let (rates, second) = self.rates_now();
        if begins_afresh {
            // A kink of the flow has ended the step.
            extra.restart(time, &self.guards_now(), &rates, &second);
        } else if extra.is_started() {
            extra.step(time, &rates);
        } else {
            extra.start(time, &self.guards_now(), &rates, &second);
        }
        self.extra = Some(extra);
    }

    /// g of every guard; zero where it is not active.
    fn guards_now(&mut self) -> Vec<f64> {
        let all = 0..self.watch.guards.len();
        all.map(|index| if self.is_active(index) { self.watch.value(&self.engine, index) } else { 0.0 })
            .collect()
    }

    /// dg/dx . f of every guard and its rate; zero where it is not active.
    fn rates_now(&mut self) -> (Vec<f64>, Vec<f64>) {
        let all = 0..self.watch.guards.len();
        let rates = all.map(|index| match self.is_active(index) {
            true => self.watch.rates(&self.engine, index).into(),
            false => (0.0, 0.0),
        });
        rates.unzip()
    }

    fn is_active(&self, index: usize) -> bool {
        self.engine.guards.instances[self.watch.guards[index].instance as usize].active
    }
}
