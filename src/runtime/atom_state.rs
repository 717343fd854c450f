//! Atom instances: what is known of a comparison with its agents.

use crate::codegen::program::Relation;
use crate::math::Interval;

/// A comparison with its agents.
#[derive(Clone, Copy, Debug)]
pub struct AtomState {
    /// The instance it belongs to.
    pub instance: u32,
    /// If it is of a candidate of a quantifier: its number in the definition, and who that is.
    pub candidate: Option<(u32, u32)>,
    /// Its truth just after `certified`; for `crossing` whether g is on the negative side.
    pub truth: bool,
    /// Of a `crossing`: g has been zero since it was armed, so that the sign that it has next is no change (rule 2).
    pub sideless: bool,
    /// Changes its truth at this instant and is closed or a crossing, so that it is true in it.
    pub touched: bool,
    /// Whether `other` leaves out what it binds, or nobody has the seat: nobody reads its truth.
    pub left_out: bool,
    /// Whether its truth was given by a root at `certified`, or by its rates on its boundary there: it stays so in that instant (rules 3 and 4).
    pub rooted: bool,
    /// Up to here its truth does not change, s.
    pub certified: f64,
    /// When it changes next, s; infinite if that is not known.
    pub flip: f64,
    /// Whether it changes only by coming within rounding of zero: then it may change back at once.
    pub touch: bool,
    /// When it last did so, s.
    pub grazed: f64,
    /// If the flip, or the root that was the last one, is where g jumps: its truths there.
    pub leap: Option<Leap>,
    /// The last time before the flip at which the old truth holds, s.
    pub near: f64,
    /// See `Known::slack`.
    pub slack: f64,
    /// See `Known::settled`.
    pub settled: bool,
    /// Since when it is certified by rates that are bounded whatever the states of its agents are, s: an event before would
    /// have those who are bounded begin elsewhere. Infinite if it is certified by something else.
    pub far: f64,
    /// How far ahead to try to sleep, s; 0: as far as the run goes.
    pub stride: f64,
    /// How often not to try to sleep before the next try.
    pub skip: u16,
    /// What `skip` was set to last; it doubles while sleeping fails.
    pub backoff: u16,
    /// Entries of other versions in the queues are void.
    pub version: u32,
}

/// The truths of a comparison at a surface and just after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leap {
    /// At the very instant.
    pub at: bool,
    /// Just after it.
    pub after: bool,
}

impl AtomState {
    /// Whether its truth does not change as long as g is within these bounds.
    pub fn is_kept_by(&self, g: Interval) -> bool {
        if self.truth { g.hi < 0.0 } else { g.lo > 0.0 }
    }

    /// Of a seat that nobody has.
    pub fn unread(instance: u32) -> Self {
        Self { left_out: true, ..Self::new(instance) }
    }

    /// Of an instance that has not been active.
    pub fn new(instance: u32) -> Self {
        Self {
            instance,
            candidate: None,
            truth: false,
            sideless: true,
            touched: false,
            left_out: false,
            rooted: false,
            certified: 0.0,
            flip: f64::INFINITY,
            near: 0.0,
            touch: false,
            grazed: f64::NEG_INFINITY,
            leap: None,
            slack: 0.0,
            settled: false,
            far: f64::INFINITY,
            stride: 0.0,
            skip: 0,
            backoff: 0,
            version: 0,
        }
    }
}

/// Whether a relation is true where g is zero. A crossing stays as it is there.
pub fn closed(relation: Relation, truth: bool) -> bool {
    match relation {
        Relation::NonPositive => true,
        Relation::Negative => false,
        Relation::Crossing => truth,
    }
}
