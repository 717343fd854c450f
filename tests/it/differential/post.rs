//! Messages of the reference simulator (rule 9): who has to hear what, in order.

use hyc::model::ir::TypeId;

/// What was emitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// By whom.
    pub sender: usize,
    /// The type of the sender, and the number of its event.
    pub event: (TypeId, usize),
    /// What it carries.
    pub values: Vec<f64>,
}

/// What one agent has to hear.
#[derive(Clone, Debug, Default)]
pub struct Inbox {
    /// The first is at its turn or comes next.
    pub waiting: Vec<Message>,
    /// Something has fired by the first.
    pub heard: bool,
    /// What it enabled in the last micro-step, and has not fired; with how often its mode had been entered.
    pub enabled: Vec<(usize, usize)>,
}

impl Inbox {
    /// The first is over.
    pub fn next(&mut self) {
        self.waiting.remove(0);
        self.heard = false;
        self.enabled.clear();
    }
}

/// All messages.
#[derive(Clone, Debug, Default)]
pub struct Post {
    /// In this micro-step, in the order in which they were emitted.
    pub sent: Vec<Message>,
    /// With the times at which they come, s, in the order in which they were emitted.
    pub later: Vec<(f64, Message)>,
    /// By agent.
    pub inboxes: Vec<Inbox>,
}

impl Post {
    /// When the next message comes, s.
    pub fn next_time(&self) -> Option<f64> {
        self.later.iter().map(|(time, _)| *time).min_by(f64::total_cmp)
    }

    /// The messages that come now.
    pub fn come(&mut self, now: f64) {
        while let Some(first) = self.next_time().filter(|time| *time <= now) {
            let place = self.later.iter().position(|(time, _)| *time == first).expect("there is one");
            let message = self.later.remove(place).1;
            self.sent.push(message);
        }
    }

    /// Whether there is anything to hear in this instant.
    pub fn is_empty(&self) -> bool {
        self.sent.is_empty() && self.inboxes.iter().all(|inbox| inbox.waiting.is_empty())
    }
}
