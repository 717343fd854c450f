//! Messages under way: sent, due later, or waiting at their receivers for their turn (rule 9).

use std::cmp::Ordering;
use std::collections::{BTreeMap, BinaryHeap, VecDeque};
use std::rc::Rc;

use smallvec::SmallVec;

use crate::runtime::observe::Who;

/// What an `emit` has sent.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// The place of who has sent it.
    pub sender: usize,
    /// Who that is: somebody else may have the place by now.
    pub who: Who,
    /// The number of the event in the sender's type.
    pub event: usize,
    /// What it carries.
    pub values: SmallVec<[f64; 2]>,
}

/// A message that arrives at a time.
#[derive(Clone, Debug)]
struct Later {
    /// s.
    time: f64,
    /// How many were sent before it.
    number: u64,
    message: Message,
}

impl PartialEq for Later {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Later {}
impl PartialOrd for Later {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Later {
    /// The earliest is the greatest, then the one that was sent first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.time.total_cmp(&self.time).then_with(|| other.number.cmp(&self.number))
    }
}

/// What one agent has to hear, in order.
#[derive(Clone, Debug, Default)]
pub struct Inbox {
    /// The first is at its turn, or comes next.
    pub messages: VecDeque<Rc<Message>>,
    /// Something has fired by the first.
    pub heard: bool,
    /// The instances that the first enabled in the micro-step at hand, with their armings, but those that have fired by it.
    pub enabled: SmallVec<[(u32, u32); 2]>,
}

impl Inbox {
    /// Ends the turn of the first message.
    pub fn end_turn(&mut self) {
        self.messages.pop_front();
        self.heard = false;
        self.enabled.clear();
    }
}

/// All messages of a run that have not had their turn.
#[derive(Clone, Debug, Default)]
pub struct Mail {
    /// Seen from the next micro-step on, in the order in which they were sent.
    sent: Vec<Message>,
    later: BinaryHeap<Later>,
    n_later: u64,
    /// By receiver.
    pub inboxes: BTreeMap<usize, Inbox>,
}

impl Mail {
    /// Takes a message that is seen in the next micro-step.
    pub fn send(&mut self, message: Message) {
        self.sent.push(message);
    }

    /// Takes a message that is seen in the first micro-step at a time, s.
    pub fn send_later(&mut self, message: Message, time: f64) {
        self.later.push(Later { time, number: self.n_later, message });
        self.n_later += 1;
    }

    /// When the next message arrives that is under way, s.
    pub fn next_time(&self) -> f64 {
        self.later.peek().map_or(f64::INFINITY, |later| later.time)
    }

    /// The messages that arrive after `from` and up to `until`, with their times.
    pub fn arriving(&self, from: f64, until: f64) -> Vec<(f64, &Message)> {
        if self.next_time() > until {
            return Vec::new();
        }
        let arriving = self.later.iter().filter(|later| later.time > from && later.time <= until);
        arriving.map(|later| (later.time, &later.message)).collect()
    }

    /// Has the messages that arrive up to `time` seen in the next micro-step; returns them.
    pub fn arrive(&mut self, time: f64) -> Vec<Message> {
        let mut arrived = Vec::new();
        while self.next_time() <= time {
            arrived.extend(self.later.pop().map(|later| later.message));
        }
        self.sent.extend_from_slice(&arrived);
        arrived
    }

    /// Whether any message is to be seen in this instant.
    pub fn is_waiting(&self) -> bool {
        !self.sent.is_empty() || !self.inboxes.is_empty()
    }

    /// What has been sent since this was last asked, in the order of the senders.
    pub fn collect(&mut self) -> Vec<Message> {
        let mut sent = std::mem::take(&mut self.sent);
        sent.sort_by_key(|message| message.who.number);
        sent
    }

    /// An agent is no more: it has nothing to hear.
    pub fn forget(&mut self, agent: usize) {
        self.inboxes.remove(&agent);
    }

    /// The sender of the message that is at its turn at an agent.
    pub fn sender_at(&self, agent: usize) -> Option<Who> {
        self.inboxes.get(&agent).and_then(|inbox| inbox.messages.front()).map(|message| message.who)
    }
}
