//! Actions that draw a number at random, and those that send a message.
//!
//! A draw is a function of the seed, the agent's path, the name of the stream and how many numbers of it have been drawn, and of
//! nothing else (`math::draw`).

use crate::base::Span;
use crate::codegen::program::{ActionStep, Distribution, FunctionId};
use crate::math::draw::Key;
use crate::runtime::act::{Effect, Rows, Write};
use crate::runtime::engine::Engine;
use crate::runtime::failure::{Failure, Reason};
use crate::runtime::mail::Message;
use crate::runtime::solve::scheduled;
use crate::runtime::truth;

impl Engine<'_, '_> {
    /// Computes an action that draws or sends; nothing for any other.
    pub fn run_send(
        &mut self,
        step: &ActionStep,
        rows: Rows<'_>,
        effect: &mut Effect,
    ) -> Result<(), Failure> {
        match step {
            ActionStep::Draw { slot, target, distribution, parameters, stream, span } => {
                let agent = rows.slots[*slot];
                let value = self.drawn((agent, *stream), *distribution, parameters, rows, *span)?;
                let write = Write { agent, target: *target, value, span: *span };
                if !value.is_finite() {
                    return Err(self.action_not_finite(&write, None).into());
                }
                effect.writes.push(write);
            }
            ActionStep::Emit { slot, event, values, delay, span } => {
                let sender = rows.slots[*slot];
                let who = self.agents.who(sender);
                let mut message = Message { sender, who, event: *event, values: Default::default() };
                for &value in values {
                    message.values.push(self.carried(&message, value, rows, *span)?);
                }
                let delay = delay.map_or(Ok(0.0), |delay| self.delay(sender, delay, rows, *span))?;
                effect.sent.push((message, delay));
            }
            ActionStep::Assign { .. }
            | ActionStep::If { .. }
            | ActionStep::Goto { .. }
            | ActionStep::Stop { .. }
            | ActionStep::Create(_)
            | ActionStep::Destroy { .. } => {}
        }
        Ok(())
    }

    fn number(&mut self, function: FunctionId, rows: Rows<'_>) -> f64 {
        truth::value(&self.agents, &mut self.present, function, rows.frame, rows.slots, rows.own)
    }

    /// The next number of a stream of an agent.
    pub fn draw(
        &mut self,
        (agent, stream): (usize, usize),
        distribution: Distribution,
        parameters: &[f64],
    ) -> f64 {
        let name = self.agents.draw_path(agent);
        let row = &mut self.agents.agents[agent];
        row.draws[stream] += 1;
        let variable = &self.program.types[row.ty].streams[stream];
        let key = Key { seed: self.program.run.seed, agent: &name, variable, draw: row.draws[stream] };
        distribution.draw(parameters, key)
    }

    fn drawn(
        &mut self,
        (agent, stream): (usize, usize),
        distribution: Distribution,
        parameters: &[FunctionId],
        rows: Rows<'_>,
        span: Span,
    ) -> Result<f64, Failure> {
        let values: Vec<f64> = parameters.iter().map(|&function| self.number(function, rows)).collect();
        if let Some((wrong, needs)) = distribution.problem(&values) {
            let blame = self.blame(parameters[wrong], rows.frame, rows.slots, rows.own);
            let parameter = format!("{} of `{}`", distribution.parameters()[wrong], distribution.name());
            let (place, value) = (self.place(agent), values[wrong]);
            return Err(Reason::BadDraw { place, parameter, needs, value, blame, span }.into());
        }
        Ok(self.draw((agent, stream), distribution, &values))
    }

    /// The next value that a message carries.
    fn carried(
        &mut self,
        message: &Message,
        function: FunctionId,
        rows: Rows<'_>,
        span: Span,
    ) -> Result<f64, Failure> {
        let value = self.number(function, rows);
        if value.is_finite() {
            return Ok(value);
        }
        let event = &self.program.types[message.who.ty].events[message.event];
        let variable = format!("{}.{}", event.name, event.params[message.values.len()]);
        let blame = self.blame(function, rows.frame, rows.slots, rows.own);
        let place = self.place(message.sender);
        Err(Reason::ActionNotFinite { place, variable, value, blame, span }.into())
    }

    fn delay(
        &mut self,
        sender: usize,
        function: FunctionId,
        rows: Rows<'_>,
        span: Span,
    ) -> Result<f64, Failure> {
        let value = self.number(function, rows);
        if (0.0..f64::INFINITY).contains(&value) {
            return Ok(value);
        }
        let blame = self.blame(function, rows.frame, rows.slots, rows.own);
        let place = self.place(sender);
        Err(Reason::BadDelay { place, value, blame, span }.into())
    }

    /// Sends messages, each after a delay, s; a time within 4 ulp of the end is the end (rule 11).
    pub fn send(&mut self, messages: &[(Message, f64)]) {
        let now = self.present.time;
        for (message, delay) in messages {
            let time = scheduled(now + delay, self.time_end);
            if time > now {
                self.mail.send_later(message.clone(), time);
            } else {
                self.mail.send(message.clone());
            }
        }
    }
}
