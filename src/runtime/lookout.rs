//! Which members of an outermost `forall` or `exists` may come to decide a property, and from when on.
//!
//! The margin of `forall c in C: ...` is the least of those of its members. A member that is certain to stay above the least
//! margin so far up to some time need not be looked at before, unless something that it reads is written.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The members of one quantifier, by place.
#[derive(Clone, Debug)]
pub struct Lookout {
    /// Their type.
    pub ty: usize,
    /// Whether all have been entered who live at t = 0.
    pub has_begun: bool,
    /// When a member has to be looked at again, and its place; times as the bits of numbers that are not negative.
    due: BinaryHeap<Reverse<(u64, u32)>>,
    /// The same by place: other entries are void.
    times: Vec<u64>,
    /// Those whose margins an event may have changed since the last instant was watched.
    doubted: Vec<u32>,
}

/// A member that is not due.
const NEVER: u64 = u64::MAX;

impl Lookout {
    /// Nobody of a type yet.
    pub fn new(ty: usize) -> Self {
        Self { ty, has_begun: false, due: BinaryHeap::new(), times: Vec::new(), doubted: Vec::new() }
    }

    /// A member has to be looked at at once: it is new, or something that it reads was written.
    pub fn doubt(&mut self, member: usize) {
        self.doubted.push(member as u32);
        self.look_again(member, 0.0);
    }

    /// A member has to be looked at again from `time` on, s, and not before.
    pub fn look_again(&mut self, member: usize, time: f64) {
        if self.times.len() <= member {
            self.times.resize(member + 1, NEVER);
        }
        // Nobody waits twice for the same: nothing is taken out before the window of a property, nor after it.
        if self.times[member] != time.to_bits() {
            self.times[member] = time.to_bits();
            self.due.push(Reverse((time.to_bits(), member as u32)));
        }
    }

    /// Takes a member out that has to be looked at before `time`, s.
    pub fn next_before(&mut self, time: f64) -> Option<usize> {
        while let Some(&Reverse((due, member))) = self.due.peek() {
            let member = member as usize;
            let is_valid = self.times[member] == due;
            if is_valid && due >= time.to_bits() {
                return None;
            }
            self.due.pop();
            if is_valid {
                self.times[member] = NEVER;
                return Some(member);
            }
        }
        None
    }

    /// Takes out those who have been doubted, rising.
    pub fn take_doubted(&mut self) -> Vec<usize> {
        let mut doubted = std::mem::take(&mut self.doubted);
        doubted.sort_unstable();
        doubted.dedup();
        doubted.into_iter().map(|member| member as usize).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Lookout;

    #[test]
    fn who_is_doubted_again_and_again_waits_once() {
        let mut lookout = Lookout::new(0);
        for _ in 0..1000 {
            lookout.doubt(3);
            assert_eq!(lookout.take_doubted(), [3]);
        }
        assert_eq!(lookout.due.len(), 1);
        assert_eq!(lookout.next_before(1.0), Some(3));
        assert_eq!(lookout.next_before(1.0), None);
    }

    #[test]
    fn members_are_due_at_their_last_times() {
        let mut lookout = Lookout::new(0);
        lookout.look_again(0, 2.0);
        lookout.look_again(1, 1.0);
        lookout.look_again(0, 3.0);
        lookout.doubt(2);
        assert_eq!([lookout.next_before(2.5), lookout.next_before(2.5)], [Some(2), Some(1)]);
        assert_eq!(lookout.next_before(2.5), None);
        assert_eq!(lookout.next_before(4.0), Some(0));
    }
}
