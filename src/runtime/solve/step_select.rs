//! The step selections of Esposito & Kumar (2004), section 4: Theorem 4.1, Algorithms 2 and 4.
//!
//! In the paper's words: agent i has the clock t^i and the step h^i; agents are labelled so that t^1 is the largest clock,
//! and tau^i = t^i - t^1 <= 0 (14). A guard g is to reach zero when all tau are zero (15). Its steps are
//!
//! ```text
//! h^i = (gamma - 1) tau^i + h^1                                                                      (17)
//! ```
//!
//! with h^1 the smallest positive real root of
//!
//! ```text
//! (1 - gamma) g_k + sum over i of h^i dg/dx^i sum over j of beta_j(h^i) f^i_{k-j+1} = 0              (18)
//! ```
//!
//! The sum is how much g changes when every agent goes along its predictor polynomial (11), moved by (17) so that it
//! is a polynomial of h^1. What comes in here is that guard already put together, `along`: g with every agent at t^i + h^i, a
//! polynomial of h^1. Then (18) reads `along(h^1) = gamma g_k`, which is what it says of a guard that is not linear as well.

use crate::runtime::solve::polynomial::{Cubic, smallest_root};

/// What the user of Algorithms 1 to 4 gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSelect {
    /// The share of g and of all tau that a step leaves over: 0 <= gamma < 1.
    pub gamma: f64,
    /// The least step, s.
    pub h_min: f64,
    /// The longest step, s.
    pub h_max: f64,
}

impl StepSelect {
    /// (17): the step of the agent that lags by `tau` <= 0, given that of the leader.
    pub fn step_of(&self, tau: f64, h1: f64) -> f64 {
        (self.gamma - 1.0) * tau + h1
    }

    /// How far along its predictor polynomial an agent is where h^1 = 0: the constant of (17).
    pub fn ahead(&self, tau: f64) -> f64 {
        self.step_of(tau, 0.0)
    }

    /// Algorithm 2, MAstepSelect, for one guard: h_g of the lagging agent, infinite if (18) has no root.
    ///
    /// `g` is g_k, every agent at its own clock; `along` is g with every agent at t^i + h^i; `tau` that of the lagging
    /// agent. Roots beyond the longest step are not looked for: they change nothing in (27).
    pub fn ma(&self, g: f64, along: &Cubic, tau: f64) -> f64 {
        let mut polynomial = *along;
        polynomial[0] -= self.gamma * g;
        smallest_root(&polynomial, self.h_max).map_or(f64::INFINITY, |h1| self.step_of(tau, h1))
    }

    /// Algorithm 4, SAstepSelect, for one guard: h_g, infinite if (28) has no root.
    ///
    /// `g` is Gear & Osterby's extra state (9), and `predictor` its predictor polynomial without the constant (11).
    pub fn sa(&self, g: f64, predictor: [f64; 3]) -> f64 {
        let [linear, square, cubic] = predictor;
        let polynomial = [(1.0 - self.gamma) * g, linear, square, cubic];
        smallest_root(&polynomial, self.h_max).unwrap_or(f64::INFINITY)
    }

    /// (27), but for h_err, which the step-size control takes the minimum with: max(h_min, min(h_max, h_g)).
    pub fn bounded(&self, h_g: f64) -> f64 {
        self.h_max.min(h_g).max(self.h_min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::solve::polynomial::{moved, value};

    const SELECT: StepSelect = StepSelect { gamma: 0.5, h_min: 1e-10, h_max: 1e6 };

    /// An agent with one state, and its predictor polynomial; in the theorem's world it is what the agent does.
    struct Agent {
        t: f64,
        x: f64,
        rates: [f64; 3],
        weight: f64,
    }

    impl Agent {
        fn polynomial(&self) -> Cubic {
            [self.x, self.rates[0], self.rates[1], self.rates[2]]
        }

        fn go(&mut self, h: f64) {
            let [f, d, dd] = self.rates;
            let (from, to) = (self.t, self.t + h);
            self.x = value(&self.polynomial(), h);
            self.rates = [f + 2.0 * d * h + 3.0 * dd * h * h, d + 3.0 * dd * h, dd];
            self.t = to.max(from);
        }
    }

    /// A linear guard: the sum of all weighted states, less a constant.
    fn g(agents: &[Agent]) -> f64 {
        agents.iter().map(|agent| agent.weight * agent.x).sum()
    }

    fn leader(agents: &[Agent]) -> f64 {
        agents.iter().map(|agent| agent.t).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The sum in (18), with g_k: weights times predictor polynomials, moved by (17).
    fn along(agents: &[Agent], select: &StepSelect) -> Cubic {
        let t1 = leader(agents);
        let mut along = [0.0; 4];
        for agent in agents {
            let c = moved(&agent.polynomial(), select.ahead(agent.t - t1));
            along.iter_mut().zip(c).for_each(|(sum, c)| *sum += agent.weight * c);
        }
        along
    }

    fn agent(t: f64, x: f64, rates: [f64; 3], weight: f64) -> Agent {
        Agent { t, x, rates, weight }
    }

    /// Theorem 4.1: when *all* agents take the steps of (17) with the root of (18), g and every tau fall by gamma. The
    /// guard is linear and the predictor exact, as its proof has it.
    #[test]
    fn a_step_of_all_agents_leaves_gamma_of_the_guard_and_of_every_tau() {
        for (gamma, n_steps) in [(0.0, 1), (0.1, 8), (0.5, 8), (0.9, 8)] {
            let select = StepSelect { gamma, ..SELECT };
            let mut agents = [
                agent(1.0, -3.0, [1.0, 0.05, 0.01], 1.0),
                agent(0.8, -2.0, [0.5, -0.02, 0.0], 2.0),
                agent(0.5, 1.0, [-0.7, 0.0, -0.003], -0.5),
            ];
            for _ in 0..n_steps {
                let (before, t1) = (g(&agents), leader(&agents));
                let taus: Vec<f64> = agents.iter().map(|agent| agent.t - t1).collect();
                let h1 = select.ma(before, &along(&agents, &select), 0.0);
                for (agent, &tau) in agents.iter_mut().zip(&taus) {
                    agent.go(select.step_of(tau, h1));
                }
                assert!((g(&agents) - gamma * before).abs() < 1e-12, "{gamma}: {} {before}", g(&agents));
                let t1 = leader(&agents);
                for (agent, tau) in agents.iter().zip(taus) {
                    assert!((agent.t - t1 - gamma * tau).abs() < 1e-12, "{gamma}: {} {tau}", agent.t - t1);
                }
            }
        }
    }

    /// Algorithm 1 moves only the agent that lags. With constant rates the law then holds for a round, not for a step: of two
    /// alike agents g falls, at gamma = 0.5 and from here, by 0.740, 0.676, 0.740, .. (elsewhere by other pairs), and by
    /// gamma over the two; tau falls by gamma a round as well.
    #[test]
    fn a_round_of_algorithm_1_leaves_gamma_of_the_guard() {
        for (gamma, slow) in [(0.5, 1.0), (0.5, 0.1), (0.1, 1.0), (0.1, 0.3), (0.9, 1.0), (0.9, 0.5)] {
            let select = StepSelect { gamma, ..SELECT };
            let mut agents =
                [agent(0.2, -3.0, [1.0, 0.0, 0.0], 1.0), agent(0.0, -2.0, [slow, 0.0, 0.0], 1.0)];
            let (mut falls, mut taus) = (Vec::new(), Vec::new());
            for _ in 0..8 {
                let (before, t1) = (g(&agents), leader(&agents));
                let lagging = usize::from(agents[1].t < agents[0].t);
                let tau = agents[lagging].t - t1;
                let h = select.ma(before, &along(&agents, &select), tau);
                agents[lagging].go(h);
                falls.push(g(&agents) / before);
                taus.push(tau);
            }
            for round in falls[1..].windows(2) {
                assert!((round[0] * round[1] - gamma).abs() < 1e-7, "{gamma}: {falls:?}");
            }
            for round in taus[1..].windows(3) {
                assert!((round[2] / round[0] - gamma).abs() < 1e-7, "{gamma}: {taus:?}");
            }
            assert!(falls.iter().all(|fall| (fall - gamma).abs() > 1e-3), "a step is no round: {falls:?}");
        }
    }

    #[test]
    fn the_single_agent_step_leaves_gamma_of_the_guard() {
        let (g, predictor) = (-2.0, [0.8, 0.1, -0.02]);
        let h = SELECT.sa(g, predictor);
        let next = value(&[g, predictor[0], predictor[1], predictor[2]], h);
        assert!((next - SELECT.gamma * g).abs() < 1e-12, "{next}");
        assert_eq!(SELECT.sa(-2.0, [-0.1, 0.0, 0.0]), f64::INFINITY, "a guard that goes away bounds no step");
    }

    #[test]
    fn a_step_keeps_to_its_bounds() {
        let select = StepSelect { gamma: 0.1, h_min: 1e-3, h_max: 0.5 };
        assert_eq!([1e-9, 0.2, f64::INFINITY].map(|h_g| select.bounded(h_g)), [1e-3, 0.2, 0.5]);
    }
}
