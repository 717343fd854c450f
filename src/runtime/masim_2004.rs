//! Algorithm `masim-2004`: Algorithms 1 and 2 of J. M. Esposito and V. Kumar, "An asynchronous integration and event
//! detection algorithm for simulating multi-agent hybrid systems", ACM TOMACS 14(4), 2004.
//!
//! The paper's agent is a group here (rule 13), its guard g a comparison. To the letter, but for what its text leaves open:
//! leader and tau belong to each guard, not to the run; the smallest h over the guards of an agent counts; at an event
//! those begin afresh whose derivatives have changed.

use crate::runtime::clocks::{Clocks, Turn};
use crate::runtime::failure::Failure;
use crate::runtime::observe::End;

impl Clocks<'_, '_> {
    /// Algorithm 1, MAsim.
    pub fn masim(&mut self) -> Result<End, Failure> {
        self.begin()?;
        loop {
            let lagging = match self.between_steps()? {
                Turn::End(end) => return Ok(end),
                Turn::Again => continue,
                Turn::Step(lagging) => lagging,
            };
            let h_g = self.ma_step_select(lagging);
            self.step(lagging, h_g)?;
        }
    }

    /// Algorithm 2, MAstepSelect: h_g of the agent that lags. (27) takes the bounds and h_err.
    fn ma_step_select(&mut self, lagging: usize) -> f64 {
        let t_lagging = self.engine.groups.groups[lagging].clock;
        let mut h_g = f64::INFINITY;
        for (index, g) in std::mem::take(&mut self.surveyed) {
            let tau = t_lagging - self.watch.leader(&self.engine, index);
            let along = self.watch.along(&self.engine, index, &self.select);
            h_g = h_g.min(self.select.ma(g, &along, tau));
        }
        h_g
    }
}
