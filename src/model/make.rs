//! Makes the agents that have been planned.

use std::sync::Arc;

use super::context::Context;
use super::error::{LimitError, SystemError, ValueError};
use super::evaluate::Known;
use super::ir::{Block, ExprId, Given, Instance, Type, VarRef, Variable};
use super::limits;
use super::plan::{Plan, Reference, Source};
use crate::base::Diagnostic;
use crate::math::draw::Key;

impl<'a> Context<'a> {
    /// Makes all agents; stops a block at its first problem.
    pub fn make(&mut self, plans: &[Plan<'a>]) {
        let blocks = std::mem::take(&mut self.model.population.blocks);
        let total = blocks.iter().map(|block| block.count).sum();
        let mut agents = Vec::with_capacity(total);
        self.evaluator.grant(limits::STEPS_PER_AGENT_MAX.saturating_mul(total as u64));
        for (number, (block, plan)) in blocks.iter().zip(plans).enumerate() {
            let memberships = self.model.types[plan.ty].memberships.clone();
            let order = self.model.types[plan.ty].initials.order.clone();
            for index in 0..block.count {
                match self.instance(plan, &order, &blocks, block, index) {
                    Ok(mut agent) => {
                        for &(block, param) in &memberships {
                            agent.params[param] = f64::from(block == number);
                        }
                        agents.push(agent);
                    }
                    Err(problem) => {
                        self.report(*problem);
                        break;
                    }
                }
            }
        }
        self.model.population.blocks = blocks;
        self.model.population.agents = Arc::new(agents);
    }

    fn instance(
        &mut self,
        plan: &Plan<'a>,
        order: &[VarRef],
        blocks: &[Block],
        block: &Block,
        index: usize,
    ) -> Result<Instance, Box<Diagnostic>> {
        let mut agent = Instance {
            ty: plan.ty,
            mode: plan.mode,
            params: Vec::with_capacity(plan.params.len()),
            states: vec![0.0; plan.states.len()],
            discretes: vec![0.0; plan.discretes.len()],
            links: Vec::with_capacity(plan.links.len()),
        };
        for (number, source) in plan.params.iter().enumerate() {
            let value = self.value(plan, VarRef::Param(number), *source, &agent, block, index)?;
            let variable = &self.model.types[plan.ty].params[number];
            if value.is_nan() || (variable.ty == Type::Int && value.is_infinite()) {
                return Err(self.not_finite(plan, *source, variable, block, index, value));
            }
            agent.params.push(value);
        }
        for &variable in order {
            let source = match variable {
                VarRef::State(number) => plan.states[number],
                VarRef::Discrete(number) => plan.discretes[number],
                VarRef::Param(_) | VarRef::Link(_) | VarRef::Let(_) => continue,
            };
            let value = self.value(plan, variable, source, &agent, block, index)?;
            let ty = &self.model.types[plan.ty];
            let (place, declared) = match variable {
                VarRef::Discrete(number) => (&mut agent.discretes[number], &ty.discretes[number]),
                VarRef::State(number)
                | VarRef::Param(number)
                | VarRef::Link(number)
                | VarRef::Let(number) => (&mut agent.states[number], &ty.states[number]),
            };
            if !value.is_finite() {
                return Err(self.not_finite(plan, source, declared, block, index, value));
            }
            *place = value;
        }
        for (number, reference) in plan.links.iter().enumerate() {
            let target = match reference {
                Some(reference) => self.follow(reference, blocks, block, index)?,
                None => None,
            };
            let link = &self.model.types[plan.ty].links[number];
            if let (true, None) = (link.required, target) {
                let span = reference.as_ref().map_or(plan.item.span, Reference::span);
                let (name, instance) = (link.name.clone(), instance_name(block, index));
                return Err(Box::new(SystemError::RequiredNone { name, instance, span }.into()));
            }
            agent.links.push(target);
        }
        Ok(agent)
    }

    fn value(
        &mut self,
        plan: &Plan<'a>,
        variable: VarRef,
        source: Source,
        agent: &Instance,
        block: &Block,
        index: usize,
    ) -> Result<f64, Box<Diagnostic>> {
        let given = match source {
            Source::Column(column) => return Ok(plan.columns[column][index]),
            Source::Missing => return Ok(f64::NAN),
            Source::Argument(given) | Source::Declared(given) => given,
        };
        let known = Known {
            index: index as f64,
            params: &agent.params,
            states: &agent.states,
            discretes: &agent.discretes,
        };
        match given {
            Given::Value(id) => self.evaluate(id, &known),
            Given::Draw(draw) => {
                let agent = instance_name(block, index);
                let variable = self.model.types[plan.ty].variable_name(variable).to_string();
                let key = Key { seed: self.model.run.seed, agent: &agent, variable: &variable, draw: 0 };
                self.draw(&draw, &known, key)
            }
        }
    }

    /// The value of an expression, within the budget.
    pub fn evaluate(&mut self, id: ExprId, known: &Known) -> Result<f64, Box<Diagnostic>> {
        let value = self.evaluator.evaluate(&self.model, id, known);
        value.ok_or_else(|| Box::new(LimitError::Steps { span: self.model.exprs[id].span }.into()))
    }

    fn not_finite(
        &self,
        plan: &Plan<'a>,
        source: Source,
        variable: &Variable,
        block: &Block,
        index: usize,
        value: f64,
    ) -> Box<Diagnostic> {
        let span = match source {
            Source::Argument(given) | Source::Declared(given) => self.model.exprs[given.exprs()[0]].span,
            Source::Column(_) | Source::Missing => plan.item.span,
        };
        let what = format!("the initial value of `{}.{}`", instance_name(block, index), variable.name);
        Box::new(ValueError::NotFinite { what, value, span }.into())
    }

    /// The number of the agent that a reference leads to.
    fn follow(
        &mut self,
        reference: &Reference,
        blocks: &[Block],
        block: &Block,
        index: usize,
    ) -> Result<Option<usize>, Box<Diagnostic>> {
        let known = Known { index: index as f64, ..Known::default() };
        let mut reference = reference;
        loop {
            match reference {
                Reference::Nobody(_) => return Ok(None),
                Reference::If(condition, then, otherwise) => {
                    let holds = self.evaluate(*condition, &known)? != 0.0;
                    reference = if holds { then } else { otherwise };
                }
                Reference::Agent { block: target, index: None, .. } => {
                    return Ok(Some(blocks[*target].first));
                }
                Reference::Agent { block: target, index: Some(place), span } => {
                    let place = self.evaluate(*place, &known)?;
                    let target = &blocks[*target];
                    if place >= 0.0 && place < target.count as f64 {
                        return Ok(Some(target.first + place as usize));
                    }
                    let (array, count, instance) =
                        (target.name.clone(), target.count, instance_name(block, index));
                    let help = "for those at the end write `if index >= 1 then cars[index - 1] else none`"
                        .to_string();
                    let (index, span) = (place, *span);
                    let error = SystemError::OutOfRange { array, count, index, instance, help, span };
                    return Err(Box::new(error.into()));
                }
            }
        }
    }
}

/// `fast`, `cars[3]`.
pub(super) fn instance_name(block: &Block, index: usize) -> String {
    if block.array { format!("{}[{index}]", block.name) } else { block.name.clone() }
}
