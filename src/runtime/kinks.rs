//! Kinks of flows (rule 15): when a step meets one, which lie at hand, and the locks that change there.

use crate::codegen::program::{Atom, Kink, KinkKind, Relation};
use crate::runtime::detect::{AtomCurve, CurveRows};
use crate::runtime::groups::KinkHit;
use crate::runtime::population::{ABSENT, Agents, Slots};
use crate::runtime::solve::roots::{Curve, Known, Search, first_flip};
use crate::runtime::solve::time_resolution;

/// Sets the locks that some kinks change.
pub fn turn(agents: &mut Agents<'_>, hits: &[KinkHit]) {
    for hit in hits {
        let lock = agents.flow(hit.agent).kinks[hit.kink].lock;
        agents.agents[hit.agent].aux[lock] = hit.lock;
    }
}

/// The kinks that an agent, whose segment ends at `clock`, reaches within the resolution of time after it, and when.
pub fn kinks_at_hand(
    agents: &Agents<'_>,
    agent: usize,
    clock: f64,
    curves: &mut CurveRows,
) -> Vec<(f64, KinkHit)> {
    let flow = agents.flow(agent);
    let slots = agents.slots(&flow.frame, &[agent]);
    let mut at_hand = Vec::new();
    for (number, kink) in flow.kinks.iter().enumerate() {
        let lock = agents.agents[agent].aux[kink.lock];
        let mut meets = |atom: &Atom, beyond: f64| {
            let [g, rate, _] = AtomCurve::new(agents, atom, &slots, &[], curves).jet(clock);
            let left = -g / rate;
            if left >= 0.0 && left <= time_resolution(clock) {
                let hit = KinkHit { agent, kink: number, before: lock, lock: beyond };
                at_hand.push(((clock + left).next_up(), hit));
            }
        };
        match &kink.kind {
            KinkKind::Branch(atom) => meets(atom, 1.0 - lock),
            KinkKind::Integer { below, above } => {
                meets(below, lock - 1.0);
                meets(above, lock + 1.0);
            }
        }
    }
    at_hand
}

/// When the new segment of an agent first meets a kink, and the value that its lock then takes.
pub fn kink_time(
    agents: &Agents<'_>,
    agent: usize,
    kink: &Kink,
    slots: &Slots,
    until: f64,
    curves: &mut CurveRows,
    pieces_max: u32,
) -> Option<(f64, f64)> {
    let lock = agents.agents[agent].aux[kink.lock];
    let start = agents.agents[agent].segment.start;
    let mut search = |atom: &Atom, truth: bool| {
        let closed = atom.relation == Relation::NonPositive;
        let reach = 2.0 * f64::EPSILON * until.abs();
        let known = Known { truth, closed, slack: 0.0, settled: false, grazed: false, joins: false, reach };
        let mut curve = AtomCurve::new(agents, atom, slots, &[], curves);
        // What is of nobody alone has no kink, however long the step.
        if atom.slots.iter().any(|&slot| slots[slot] == ABSENT) && curve.jet(start)[0].is_nan() {
            return None;
        }
        let mut from = start;
        loop {
            match first_flip(&mut curve, from, until, known, pieces_max) {
                Search::None | Search::Along | Search::Undecided => return None,
                Search::Flip(flip) => return Some(flip.time),
                Search::Until(reached) => from = reached,
            }
        }
    };
    match &kink.kind {
        KinkKind::Branch(atom) => search(atom, lock != 0.0).map(|time| (time, 1.0 - lock)),
        KinkKind::Integer { below, above } => {
            let down = search(below, false).map(|time| (time, lock - 1.0));
            let up = search(above, false).map(|time| (time, lock + 1.0));
            match (down, up) {
                (Some(down), Some(up)) => Some(if down.0 <= up.0 { down } else { up }),
                (down, up) => down.or(up),
            }
        }
    }
}
