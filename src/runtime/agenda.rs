//! What is due when, of very many: those due soon are in order, the others in none until their turn comes. A heap of all would be too
//! large for the caches of a processor.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// How many are put in order at once, at least; else this part of those that are in none.
const SOON_MIN: usize = 1024;
const SOON_PART: usize = 8;

/// A time at which something named by a number is due; void if the version is not that of the thing any more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Due {
    /// s.
    pub time: f64,
    /// An atom instance, a guard instance or a group.
    pub number: u32,
    /// See above.
    pub version: u32,
}

impl Eq for Due {}
impl PartialOrd for Due {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Due {
    /// The earliest is the greatest, then the one with the lowest number.
    fn cmp(&self, other: &Self) -> Ordering {
        other
            .time
            .total_cmp(&self.time)
            .then_with(|| other.number.cmp(&self.number))
            .then_with(|| other.version.cmp(&self.version))
    }
}

/// A root that waits for something later, to be one instant with it (rule 4).
#[derive(Clone, Copy, Debug)]
pub struct Waiting {
    /// When it is due, s.
    pub since: f64,
    /// Void if that of the atom is another one.
    pub version: u32,
}

/// Things that are due; those before `horizon` in order.
#[derive(Clone, Debug)]
pub struct Agenda {
    soon: BinaryHeap<Due>,
    later: Vec<Due>,
    /// s; what is due before it is in `soon`.
    horizon: f64,
    /// Nothing in `later` is due before, s.
    later_from: f64,
}

impl Default for Agenda {
    fn default() -> Self {
        Self {
            soon: BinaryHeap::new(),
            later: Vec::new(),
            horizon: f64::NEG_INFINITY,
            later_from: f64::INFINITY,
        }
    }
}

impl Agenda {
    /// Puts something down.
    #[inline]
    pub fn push(&mut self, due: Due) {
        debug_assert!(!due.time.is_nan());
        if due.time < self.horizon {
            self.soon.push(due);
        } else {
            self.later_from = self.later_from.min(due.time);
            self.later.push(due);
        }
    }

    /// Takes out what is due first, if that is before `until`, s.
    pub fn pop_before(&mut self, until: f64) -> Option<Due> {
        if self.soon.is_empty() && self.later_from < until {
            self.look_farther();
        }
        if self.soon.peek()?.time < until { self.soon.pop() } else { None }
    }

    /// Nothing is due before, s.
    pub fn from(&self) -> f64 {
        self.soon.peek().map_or(self.later_from, |due| due.time)
    }

    /// Takes out all that is due before `until`, which is the horizon from now on; in no order.
    pub fn take_before(&mut self, until: f64) -> Vec<Due> {
        self.later.extend(std::mem::take(&mut self.soon));
        let taken = self.later.extract_if(.., |due| due.time < until).collect();
        (self.horizon, self.later_from) = (until, first_time(&self.later));
        taken
    }

    /// Keeps only what is valid, if there are more than `n_max`.
    pub fn compact(&mut self, n_max: usize, is_valid: impl Fn(&Due) -> bool) {
        if self.soon.len() + self.later.len() > n_max {
            self.soon.retain(&is_valid);
            self.later.retain(&is_valid);
            self.later_from = first_time(&self.later);
        }
    }

    /// Things have new numbers: by old number, `moved`; `u32::MAX` of one that is no more.
    pub fn renumber(&mut self, moved: &[u32]) {
        renumber(&mut self.soon, moved);
        renumber_list(&mut self.later, moved);
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Puts the first of those that are in no order in order.
    fn look_farther(&mut self) {
        let Some(last) = self.later.len().checked_sub(1) else { return };
        let n_soon = (self.later.len() / SOON_PART).max(SOON_MIN);
        let by_time = |a: &Due, b: &Due| a.time.total_cmp(&b.time);
        let (_, last_soon, _) = self.later.select_nth_unstable_by(n_soon.min(last), by_time);
        let horizon = last_soon.time.next_up();
        self.horizon = horizon;
        self.soon = self.later.extract_if(.., |due| due.time < horizon).collect();
        self.later_from = first_time(&self.later);
    }
}

/// The time of the first of those in a list, s; infinite if there is none.
fn first_time(list: &[Due]) -> f64 {
    list.iter().map(|due| due.time).fold(f64::INFINITY, f64::min)
}

/// The same for a heap as [`Agenda::renumber`] for all.
pub fn renumber(heap: &mut BinaryHeap<Due>, moved: &[u32]) {
    let mut all = std::mem::take(heap).into_vec();
    renumber_list(&mut all, moved);
    *heap = all.into();
}

fn renumber_list(list: &mut Vec<Due>, moved: &[u32]) {
    list.iter_mut().for_each(|due| due.number = moved[due.number as usize]);
    list.retain(|due| due.number != u32::MAX);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers below 1, from a linear congruence.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    #[test]
    fn what_is_put_down_comes_out_as_from_a_heap() {
        let mut number = numbers();
        let (mut agenda, mut heap) = (Agenda::default(), BinaryHeap::new());
        let mut now = 0.0;
        for k in 0..60_000_u32 {
            // Many are due at the same time.
            let time = now + (number() * 4000.0).floor() / 100.0;
            let due = Due { time, number: k, version: 0 };
            agenda.push(due);
            heap.push(due);
            if k % 7 == 0 && k > 20_000 {
                for _ in 0..8 {
                    assert!(agenda.from() <= heap.peek().map_or(f64::INFINITY, |due: &Due| due.time));
                    let first = heap.pop();
                    assert_eq!(agenda.pop_before(f64::INFINITY), first);
                    now = first.map_or(now, |due| due.time);
                }
            }
            if k % 10_000 == 9_999 {
                let until = now + 3.0;
                assert_eq!(agenda.pop_before(now), None);
                let taken = agenda.take_before(until);
                assert!(taken.iter().all(|due| due.time < until));
                taken.into_iter().for_each(|due| agenda.push(due));
            }
        }
        while let Some(first) = heap.pop() {
            assert_eq!(agenda.pop_before(f64::INFINITY), Some(first));
        }
        assert_eq!(agenda.pop_before(f64::INFINITY), None);
    }
}
