//! Which members of an outermost `forall` or `exists` may come to decide a property, and from when on.
//!
//! The margin of `forall c in C: ...` is the least of those of its members. A member that is certain to stay above the least
//! margin so far up to some time need not be looked at before, unless something that it reads is written.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The members of one quantifier, by place.
#[derive(Clone, Debug, Default)]
pub struct Lookout {
    /// Whether all have been entered who live at t = 0.
    pub has_begun: bool,
    /// When a member has to be looked at again: the bits of a time that is not negative, place, version.
    due: BinaryHeap<Reverse<(u64, u32, u32)>>,
    /// By place: entries of other versions are void.
    versions: Vec<u32>,
    /// Those whose margins an event may have changed since the last instant was watched.
    doubted: Vec<u32>,
}

impl Lookout {
    /// A member has to be looked at at once: it is new, or something that it reads was written.
    pub fn doubt(&mut self, member: usize) {
        self.doubted.push(member as u32);
        self.look_again(member, 0.0);
    }

    /// A member has to be looked at again from `time` on, s, and not before.
    pub fn look_again(&mut self, member: usize, time: f64) {
        if self.versions.len() <= member {
            self.versions.resize(member + 1, 0);
        }
        self.versions[member] += 1;
        self.due.push(Reverse((time.to_bits(), member as u32, self.versions[member])));
    }

    /// Takes a member out that has to be looked at before `time`, s.
    pub fn next_before(&mut self, time: f64) -> Option<usize> {
        while let Some(&Reverse((due, member, version))) = self.due.peek() {
            if self.versions[member as usize] == version && due >= time.to_bits() {
                return None;
            }
            self.due.pop();
            if self.versions[member as usize] == version {
                return Some(member as usize);
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
