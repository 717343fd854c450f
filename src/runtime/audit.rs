//! What certified detection finds on the trajectories of a 2004 algorithm, and the algorithm does not.
//!
//! Beside the run, every guard is certified on the dense output of the very steps that the run takes, so that no chaos
//! comes between the two. A guard that becomes true there is an event if its transition would fire. It is *missed* if
//! it ends, or its agents are rewritten, before the algorithm sees it; it is *late* if the algorithm sees it more than
//! [`LATE`] afterwards.

use crate::runtime::atom_state::closed;
use crate::runtime::detect::{AtomCurve, CurveRows};
use crate::runtime::engine::Engine;
use crate::runtime::fold;
use crate::runtime::observe::Misses;
use crate::runtime::present::Depth;
use crate::runtime::solve::roots::{Known, Search, first_flip};
use crate::runtime::solve::ulp;
use crate::runtime::watch::Watch;

/// An event that is executed later than this after its time is late, s.
const LATE: f64 = 1e-3;

/// What is known of one comparison beside the run.
#[derive(Clone, Copy, Debug, Default)]
struct Shadow {
    truth: bool,
    /// Up to here, s.
    certified: f64,
    /// When it became true so that its transition would fire, and the algorithm has not seen it yet, s.
    passed: Option<f64>,
}

/// Certified detection beside a run.
pub struct Audit {
    shadows: Vec<Shadow>,
    curves: CurveRows,
    /// A kink wakes what sleeps; beside a run nobody tells.
    has_kinks: bool,
    /// So far.
    pub misses: Misses,
}

impl Audit {
    /// An audit of a run that has begun.
    pub fn new(engine: &Engine<'_, '_>) -> Self {
        let truths = engine.guards.atoms.iter().map(|state| state.truth);
        let shadows = truths.map(|truth| Shadow { truth, ..Shadow::default() }).collect();
        let modes = engine.program.types.iter().flat_map(|ty| &ty.modes);
        let has_kinks = modes.flat_map(|mode| &mode.flow).any(|flow| !flow.kinks.is_empty());
        Self { shadows, curves: CurveRows::new(&engine.agents), has_kinks, misses: Misses::default() }
    }

    /// Certifies a comparison up to `to`, which the last steps of all its agents cover.
    pub fn follow(&mut self, engine: &mut Engine<'_, '_>, watch: &Watch<'_>, index: usize, to: f64) {
        let (guard, folds) = (&watch.guards[index], watch.folds(index));
        let mut shadow = self.shadows[index];
        if guard.at_zero || !engine.guards.instances[guard.instance as usize].active {
            shadow.certified = to;
        }
        while shadow.certified < to {
            if let Some(until) = self.sleep(engine, watch, index, &shadow, to) {
                shadow.certified = until;
                break;
            }
            let known = Known {
                truth: shadow.truth,
                closed: closed(guard.atom.relation, shadow.truth),
                slack: 0.0,
                settled: true,
                grazed: false,
                joins: false,
                reach: 2.0 * ulp(to),
            };
            let mut curve =
                AtomCurve::new(&engine.agents, guard.atom, watch.slots(index), folds, &mut self.curves);
            let from = shadow.certified;
            match first_flip(&mut curve, from, to, known, engine.limits.pieces_max) {
                Search::None | Search::Along | Search::Undecided => shadow.certified = to,
                Search::Until(until) => shadow.certified = until,
                Search::Flip(flip) => {
                    shadow.certified = flip.time.max(from);
                    shadow.truth = !shadow.truth;
                    let is_news = shadow.truth && !engine.guards.atoms[index].truth;
                    if is_news && would_fire(engine, index) {
                        shadow.passed = Some(flip.time);
                    } else if shadow.passed.take().is_some() {
                        self.misses.missed += 1;
                    }
                    if flip.undecided {
                        // It touches zero and goes back: the search goes on from after the touch, not at it.
                        shadow.truth = !shadow.truth;
                        shadow.certified = (flip.time + 1e-9).min(to);
                        self.misses.missed += u64::from(shadow.passed.take().is_some());
                    }
                }
            }
        }
        self.shadows[index] = shadow;
    }

    /// How long a comparison cannot change, as `masim` finds it; what that costs is not the run's.
    fn sleep(
        &mut self,
        engine: &mut Engine<'_, '_>,
        watch: &Watch<'_>,
        index: usize,
        shadow: &Shadow,
        to: f64,
    ) -> Option<f64> {
        let (guard, folds) = (&watch.guards[index], watch.folds(index));
        let as_known = shadow.passed.is_none() && shadow.truth == engine.guards.atoms[index].truth;
        let kernel = engine.program.kernel(guard.atom.value);
        let reads_states = fold::depth(engine.program, kernel, folds) == Depth::States;
        if self.has_kinks || !as_known || !reads_states {
            return None;
        }
        let (ranges, operations) = (engine.enclosures.ranges, engine.enclosures.operations);
        std::mem::swap(&mut engine.curves, &mut self.curves);
        let until = engine.sleep(index, (guard.atom, watch.slots(index), folds), shadow.certified, to);
        std::mem::swap(&mut engine.curves, &mut self.curves);
        (engine.enclosures.ranges, engine.enclosures.operations) = (ranges, operations);
        until
    }

    /// The algorithm has seen a comparison at zero, or beyond, at `time`.
    pub fn seen(&mut self, index: usize, time: f64) {
        if let Some(passed) = self.shadows[index].passed.take() {
            let delay = time - passed;
            self.misses.latest = self.misses.latest.max(delay);
            self.misses.late += u64::from(delay > LATE);
        }
    }

    /// A comparison has been settled anew at `time`: what it had passed is past.
    pub fn settle(&mut self, engine: &Engine<'_, '_>, index: usize, time: f64) {
        let passed = self.shadows[index].passed.is_some();
        self.misses.missed += u64::from(passed);
        let truth = engine.guards.atoms[index].truth;
        self.shadows[index] = Shadow { truth, certified: time, passed: None };
    }

    /// The run is over.
    pub fn end(&mut self) {
        let passed = self.shadows.iter_mut().filter_map(|shadow| shadow.passed.take());
        self.misses.missed += passed.count() as u64;
    }
}

/// Whether a comparison, if it were true now, would make its transition fire.
fn would_fire(engine: &mut Engine<'_, '_>, index: usize) -> bool {
    let instance = engine.guards.atoms[index].instance;
    let touched = std::mem::replace(&mut engine.guards.atoms[index].touched, true);
    let fires = engine.enabled(instance);
    engine.guards.atoms[index].touched = touched;
    fires
}
