//! Rule 9: messages come to their receivers, have their turns one after another, and make `on` transitions fire.
//!
//! A message is for every agent with an `on` for it, in whatever mode, that listens to its sender when it arrives. It has its turn
//! until something fires by it, or nothing is enabled by it: then it is missed. What it enabled beside what has fired by it
//! fires too, one micro-step after the other, if it still can; nothing else does, whatever mode is entered.

use std::collections::BTreeSet;
use std::rc::Rc;

use smallvec::SmallVec;

use crate::codegen::program::{Sender, Trigger};
use crate::runtime::asked::Question;
use crate::runtime::engine::Engine;
use crate::runtime::guards::Origin;
use crate::runtime::instant::{By, Candidate};
use crate::runtime::mail::Message;
use crate::runtime::population::Slots;

impl Engine<'_, '_> {
    /// Brings what has been sent to its receivers.
    pub fn deliver(&mut self) {
        for message in self.mail.collect() {
            let receivers = self.receivers(&message);
            let message = Rc::new(message);
            for agent in receivers {
                self.mail.inboxes.entry(agent).or_default().messages.push_back(Rc::clone(&message));
            }
        }
    }

    /// The instances that a message may make fire, in whatever mode their agents are.
    pub fn listening(&self, message: &Message) -> Vec<u32> {
        let agents = self.receivers(message);
        let of_agents = agents.into_iter().flat_map(|agent| self.guards.hearing[agent].iter().copied());
        of_agents.filter(|&instance| self.hears(instance, message)).collect()
    }

    /// The agents that a message is for, rising.
    fn receivers(&self, message: &Message) -> BTreeSet<usize> {
        let mut receivers = BTreeSet::new();
        for definition in &self.guards.definitions {
            let Some(Trigger::On { events, from, .. }) = definition.trigger() else { continue };
            if !events.contains(&(message.who.ty, message.event)) {
                continue;
            }
            match from {
                Sender::Others => receivers.extend(&self.agents.of_type[definition.ty]),
                // Whoever reaches the sender by links, or is it.
                Sender::Slot(_) => {
                    receivers.extend(self.sender(message).into_iter().flat_map(|of| self.agents.readers(of)));
                }
            }
        }
        let hears =
            |agent: &usize| self.guards.hearing[*agent].iter().any(|&instance| self.hears(instance, message));
        receivers.retain(hears);
        receivers
    }

    /// Whether an instance is an `on` for a message from its sender.
    fn hears(&self, instance: u32, message: &Message) -> bool {
        let definition = self.guards.definition(instance);
        let Some(Trigger::On { events, from, .. }) = definition.trigger() else { return false };
        let own = self.guards.instances[instance as usize].roots[0] as usize;
        let sender = self.sender(message);
        let is_listened_to = match *from {
            Sender::Others => sender != Some(own),
            Sender::Slot(0) => sender == Some(own),
            Sender::Slot(slot) => {
                sender != Some(own) && sender == Some(self.guards.slots(&self.agents, instance)[slot])
            }
        };
        is_listened_to && events.contains(&(message.who.ty, message.event))
    }

    /// The place of who has sent a message, if it lives.
    fn sender(&self, message: &Message) -> Option<usize> {
        (self.agents.number(message.sender) == message.who.number).then_some(message.sender)
    }

    /// What the messages at their turns make fire in the next micro-step.
    pub fn turns(&mut self) -> Vec<Candidate> {
        let mut candidates = Vec::new();
        let agents: Vec<usize> = self.mail.inboxes.keys().copied().collect();
        for agent in agents {
            while let Some(inbox) = self.mail.inboxes.get(&agent)
                && let Some(message) = inbox.messages.front().cloned()
            {
                let before = inbox.heard.then(|| inbox.enabled.clone());
                let heard = before.is_some();
                let mut enabled = self.enabled_by(&message, agent);
                if let Some(before) = before {
                    enabled.retain(|instance| before.contains(instance));
                }
                let Some(inbox) = self.mail.inboxes.get_mut(&agent) else { break };
                if !enabled.is_empty() {
                    let hearing =
                        enabled.iter().map(|&(instance, _)| Candidate { instance, by: By::Message });
                    candidates.extend(hearing);
                    inbox.enabled = enabled;
                    break;
                }
                inbox.end_turn();
                if !heard {
                    // It has been missed: this was its turn.
                    break;
                }
            }
        }
        self.mail.inboxes.retain(|_, inbox| !inbox.messages.is_empty());
        candidates
    }

    /// The `on` transitions of an agent that a message enables; what it carries is in the agent's columns from here on.
    fn enabled_by(&mut self, message: &Message, agent: usize) -> SmallVec<[(u32, u32); 2]> {
        let layout = self.agents.layout(agent);
        let row = &mut self.agents.agents[agent];
        for (k, &value) in message.values.iter().enumerate() {
            row.aux[layout.received(k)] = value;
        }
        let mut enabled = self.guards.hearing[agent].clone();
        enabled.retain(|&instance| {
            self.guards.instances[instance as usize].active
                && self.hears(instance, message)
                && self.answer(instance).is_some()
        });
        let arming = |instance: u32| self.guards.instances[instance as usize].arming;
        enabled.into_iter().map(|instance| (instance, arming(instance))).collect()
    }

    /// The slots of an `on` or of a `rate`, those of its witnesses filled, if its condition holds now.
    pub fn answer(&mut self, instance: u32) -> Option<Slots> {
        let definition = self.guards.definition(instance);
        let transition = definition.origin.transition()?;
        let slots = self.guards.slots(&self.agents, instance);
        let (Trigger::On { guard: Some(guard), .. } | Trigger::Rate { guard: Some(guard), .. }) =
            &transition.trigger
        else {
            return Some(slots);
        };
        let own = self.guards.roots(instance);
        let question = Question { guard, frame: &transition.frame, own: &own, followed: self.gate(instance) };
        self.ask(&question, slots, &transition.witnesses)
    }

    /// The instance that follows the guard of a `rate`.
    fn gate(&self, instance: u32) -> Option<u32> {
        let state = &self.guards.instances[instance as usize];
        let gate = state.definition as usize + 1;
        let is_gate = matches!(self.guards.definitions.get(gate)?.origin, Origin::Gate(_));
        is_gate.then(|| self.guards.instance_of(gate, state.roots[0] as usize)).flatten()
    }

    /// Notes that an `on` has fired by the message at its turn.
    pub fn note_heard(&mut self, instance: u32) {
        let agent = self.guards.instances[instance as usize].roots[0] as usize;
        if let Some(inbox) = self.mail.inboxes.get_mut(&agent) {
            inbox.heard = true;
            inbox.enabled.retain(|(other, _)| *other != instance);
        }
    }
}
