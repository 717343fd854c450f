//! Which of two methods an integration steps by: the explicit one, or the stiff one where that pays.
//!
//! Looked at now and then, after an accepted step of length h: h rho, with rho the spectral radius of the Jacobian. While
//! h rho < 1 the explicit step follows the fastest part of the flow, and nothing is stiff. From there on either the solution
//! moves as fast as that, or an explicit method wastes steps: its stability bounds them (beyond h rho of about 3), or the
//! fast part, which the solution does not show, spoils their accuracy. Numbers of the flow alone do not tell these apart (an
//! oscillation has the same h rho as a stiff decay), so the stiff method is asked: it tries a step that is longer by as much
//! as its steps cost more. If that step is good enough, the look speaks for it. The way back asks less: once h rho is below
//! 1 again, the explicit method can take the steps that the stiff one takes.
//!
//! Some looks in a row must speak for a change. The bounds lie apart, so that no flow has the methods change all the time:
//! a stiff step that pays has h rho well above 1. Nothing else is asked: the same steps lead to the same choice.

use crate::runtime::solve::jacobian::Jacobian;

/// Which method takes the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Regime {
    /// The explicit one.
    #[default]
    Explicit,
    /// The one for stiff flows.
    Stiff,
}

/// What a look at a step says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vote {
    /// The method is the right one, as far as can be seen.
    Stay,
    /// The other would be better.
    Change,
}

/// What one integration remembers of its looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Switch {
    /// Which method takes the next step.
    pub regime: Regime,
    /// Accepted steps since the last look.
    since: u32,
    /// Looks in a row that spoke for the other method.
    votes: u32,
}

/// h rho up to which an explicit step follows the fastest part of a flow.
const FOLLOWS: f64 = 1.0;
/// So many accepted explicit steps pass from one look to the next, as long as none speaks for the stiff method.
const PATIENCE: u32 = 32;
/// The same for stiff steps, which are few and have a Jacobian.
const PATIENCE_STIFF: u32 = 4;
/// So many looks in a row lead to the stiff method.
const ENOUGH: u32 = 4;
/// And so many away from it: what fades within microseconds after each event is no reason.
const ENOUGH_STIFF: u32 = 32;

impl Switch {
    /// One that begins with this method.
    pub fn to(regime: Regime) -> Self {
        Self { regime, ..Self::default() }
    }

    /// Counts an accepted step; whether it is to be looked at.
    pub fn is_due(&mut self) -> bool {
        self.since += 1;
        let patience = match self.regime {
            Regime::Explicit => PATIENCE,
            Regime::Stiff => PATIENCE_STIFF,
        };
        self.votes > 0 || self.since >= patience
    }

    /// Has the next accepted explicit step looked at: many have been taken elsewhere, and nobody has looked.
    pub fn ask(&mut self) {
        if self.regime == Regime::Explicit {
            self.since = PATIENCE;
        }
    }

    /// Whether the next accepted step is to be looked at.
    pub fn is_asked(&self) -> bool {
        self.votes > 0 || self.since >= PATIENCE
    }

    /// Takes notice of a look.
    pub fn count(&mut self, vote: Vote) {
        self.since = 0;
        self.votes = match vote {
            Vote::Stay => 0,
            Vote::Change => self.votes + 1,
        };
        let enough = match self.regime {
            Regime::Explicit => ENOUGH,
            Regime::Stiff => ENOUGH_STIFF,
        };
        if self.votes == enough {
            *self = Self::to(match self.regime {
                Regime::Explicit => Regime::Stiff,
                Regime::Stiff => Regime::Explicit,
            });
        }
    }
}

/// Whether an explicit step of length `h` follows the fastest part of the flow; false if the Jacobian is not finite.
pub fn follows(h: f64, jacobian: &Jacobian) -> bool {
    h * jacobian.norm() < FOLLOWS || h * jacobian.spectral_radius() < FOLLOWS
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The regimes after steps with these votes, and how many of them were looked at.
    fn after(switch: &mut Switch, votes: impl IntoIterator<Item = Vote>) -> (Vec<Regime>, usize) {
        let mut looks = 0;
        let regimes = votes.into_iter().map(|vote| {
            if switch.is_due() {
                looks += 1;
                switch.count(vote);
            }
            switch.regime
        });
        (regimes.collect(), looks)
    }

    #[test]
    fn a_stiff_flow_is_noticed_after_a_bounded_number_of_steps() {
        let mut switch = Switch::default();
        let (regimes, looks) = after(&mut switch, [Vote::Change; 40]);
        let n = regimes.iter().filter(|regime| **regime == Regime::Explicit).count() as u32;
        assert_eq!((n, switch.regime), (PATIENCE + ENOUGH - 2, Regime::Stiff));
        assert!(looks < 10, "{looks}");
    }

    #[test]
    fn and_so_is_one_that_is_not_stiff_any_more() {
        let mut switch = Switch::to(Regime::Stiff);
        let (regimes, _) = after(&mut switch, [Vote::Change; 40]);
        let n = regimes.iter().filter(|regime| **regime == Regime::Stiff).count() as u32;
        assert_eq!((n, switch.regime), (PATIENCE_STIFF + ENOUGH_STIFF - 2, Regime::Explicit));
    }

    #[test]
    fn what_is_not_stiff_is_hardly_looked_at() {
        let mut switch = Switch::default();
        let (regimes, looks) = after(&mut switch, [Vote::Stay; 3200]);
        assert!(regimes.iter().all(|regime| *regime == Regime::Explicit));
        assert_eq!(looks, 100);
    }

    #[test]
    fn a_look_that_is_contradicted_is_forgotten() {
        for regime in [Regime::Explicit, Regime::Stiff] {
            let mut switch = Switch::to(regime);
            let votes = (0..1000).map(|k| if k % 4 == 3 { Vote::Stay } else { Vote::Change });
            after(&mut switch, votes);
            assert_eq!(switch.regime, regime);
        }
    }

    #[test]
    fn an_oscillator_is_followed_by_its_frequency_not_by_its_norm() {
        let mut jacobian = Jacobian::default();
        jacobian.reset(2);
        jacobian.push(0, 1, 1.0);
        jacobian.push(1, 0, -100.0);
        assert!(follows(0.08, &jacobian));
        assert!(!follows(0.12, &jacobian));
        jacobian.push(1, 1, f64::NAN);
        assert!(!follows(1e-9, &jacobian));
    }
}
