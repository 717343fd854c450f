//! The state of all agents at one time, and its flow by the classical method of Runge and Kutta.

use std::cell::RefCell;

use hyc::model::ir::{AgentType, Instance, ModeId, Model, Trigger, TypeId};

use super::evaluate::Scope;
use super::modes::{after, beginning};

/// All agents at one time.
#[derive(Clone)]
pub struct World {
    /// s.
    pub time: f64,
    /// The states of all agents, one after the other; behind those of each agent, what is left of its hazards.
    pub states: Vec<f64>,
    /// What else there is to know of the agents.
    pub agents: Vec<Agent>,
    /// What is added to the rate of state k, times k + 1: asks how robust a model is.
    pub nudge: f64,
    /// A margin as small as this is on the boundary: models whose events depend on it are not robust and do not count.
    pub near: f64,
}

/// What stays as it is while an agent flows.
#[derive(Clone)]
pub struct Agent {
    /// Its type.
    pub ty: TypeId,
    /// Whether it has not been destroyed.
    pub lives: bool,
    /// The modes that it is in, outer ones before inner ones.
    pub active: Vec<ModeId>,
    /// By mode, when it was entered last, s.
    pub entered: Vec<f64>,
    /// By mode, the submode that was active last.
    pub last: Vec<Option<ModeId>>,
    /// Its first state in [`World::states`].
    pub first: usize,
    /// Values of its parameters.
    pub params: Vec<f64>,
    /// Values of its discrete variables.
    pub discretes: Vec<f64>,
    /// Where its links lead.
    pub links: Vec<Option<usize>>,
}

impl Agent {
    /// Notes that it enters modes now, on top of those that it is in.
    pub fn enter(&mut self, ty: &AgentType, time: f64, entered: &[ModeId]) {
        self.active = after(ty, &self.active, &[], entered);
        for mode in entered {
            self.entered[mode.index()] = time;
            if let Some(parent) = ty.modes[*mode].parent {
                self.last[parent.index()] = Some(*mode);
            }
        }
    }
}

impl World {
    /// The agents of `system { }` before their entry actions.
    pub fn new(model: &Model, nudge: f64, near: f64) -> Self {
        let mut world = Self { time: 0.0, states: Vec::new(), agents: Vec::new(), nudge, near };
        for agent in model.population.agents.iter() {
            world.add(model, agent);
        }
        world
    }

    /// Adds an agent before its entry actions, and returns its number.
    pub fn add(&mut self, model: &Model, start: &Instance) -> usize {
        let ty = &model.types[start.ty];
        let mut agent = Agent {
            ty: start.ty,
            lives: true,
            active: Vec::new(),
            entered: vec![self.time; ty.modes.len()],
            last: vec![None; ty.modes.len()],
            first: self.states.len(),
            params: start.params.clone(),
            discretes: start.discretes.clone(),
            links: start.links.clone(),
        };
        agent.enter(ty, self.time, &beginning(ty, start.mode));
        self.agents.push(agent);
        self.states.extend(&start.states);
        self.states.extend(ty.rates().map(|_| 1.0));
        self.agents.len() - 1
    }

    /// The rates of all states, and which way the branches in them went.
    pub fn rates(&self, model: &Model) -> (Vec<f64>, Vec<bool>) {
        let mut rates: Vec<f64> = (1..=self.states.len()).map(|k| self.nudge * k as f64).collect();
        let branches = RefCell::new(Vec::new());
        for (k, agent) in self.agents.iter().enumerate().filter(|(_, agent)| agent.lives) {
            for mode in &agent.active {
                for (state, rate, _) in &model.types[agent.ty].modes[*mode].flow {
                    let mut scope = Scope::new(model, self, [k, k], false);
                    scope.branches = Some(&branches);
                    rates[agent.first + state] += scope.number(*rate);
                }
            }
            let ty = &model.types[agent.ty];
            for (hazard, transition) in ty.rates().enumerate() {
                let Trigger::Rate { rate, guard, .. } = transition.trigger else { continue };
                let mut scope = Scope::new(model, self, [k, k], false);
                let open = guard.is_none_or(|guard| scope.truth(guard));
                branches.borrow_mut().push(open);
                if open && agent.active.contains(&transition.source) {
                    scope.branches = Some(&branches);
                    rates[agent.first + ty.states.len() + hazard] -= scope.number(rate);
                }
            }
        }
        (rates, branches.into_inner())
    }

    /// The world one step of Runge and Kutta later, at a time given by the caller.
    pub fn flow(&self, model: &Model, time: f64) -> World {
        self.flow_with_branches(model, time).0
    }

    /// The same, and whether all branches went the same way all along.
    pub fn flow_with_branches(&self, model: &Model, time: f64) -> (World, bool) {
        let h = time - self.time;
        let mut stage = self.clone();
        let (k1, branches) = self.rates(model);
        let mut same = true;
        let mut ahead = |share: f64, rates: &[f64]| {
            stage.time = self.time + share * h;
            for ((x, start), rate) in stage.states.iter_mut().zip(&self.states).zip(rates) {
                *x = start + share * h * rate;
            }
            let (rates, there) = stage.rates(model);
            same &= there == branches;
            rates
        };
        let k2 = ahead(0.5, &k1);
        let k3 = ahead(0.5, &k2);
        let k4 = ahead(1.0, &k3);
        stage.time = time;
        for (i, x) in stage.states.iter_mut().enumerate() {
            *x = self.states[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        let same = same && stage.rates(model).1 == branches;
        (stage, same)
    }
}
