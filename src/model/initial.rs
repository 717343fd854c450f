//! Pass 5: defaults of parameters and initial values of variables, in an order in which each finds what it reads.

use rustc_hash::FxHashSet;

use super::context::{Context, Home, Scope};
use super::error::{NameError, ValueError};
use super::ir::{ExprId, ExprKind, Given, Initials, TypeId, VarRef};
use super::operands::for_each_operand;
use super::order::{find_circle, in_order_of_need};
use super::types::{Slot, Ty};
use crate::base::Span;
use crate::syntax::ast::{self, AgentItem, GivenKind, VariableKind};

/// Of all agent types.
pub(super) fn initial_values(context: &mut Context) {
    for number in 0..context.agents.len() {
        let ty = TypeId::new(number);
        context.model.types[ty].initials = context.initials(ty);
    }
}

/// What an expression may read while its agent is made.
#[derive(Clone, Copy)]
enum Allowed {
    /// The parameters before this one.
    ParamsBefore(usize),
    /// Parameters and variables.
    All,
}

impl<'a> Context<'a> {
    fn initials(&mut self, ty: TypeId) -> Initials {
        let item = self.agents[ty.index()].item;
        let mut initials = Initials::default();
        let mut numeric = 0;
        for formal in &item.formals {
            if matches!(self.globals.get(formal.ty.name.text.as_str()), Some(global) if global.is_agent()) {
                continue;
            }
            let slot = self.agents[ty.index()].params[numeric];
            let what = format!("the default of `{}`", formal.name.text);
            let default = formal.default.as_ref();
            let allowed = Allowed::ParamsBefore(numeric);
            initials.params.push(default.and_then(|value| self.initial(ty, value, slot, &what, allowed)));
            numeric += 1;
        }
        for part in &item.items {
            let AgentItem::Variables(line) = part else { continue };
            for variable in &line.variables {
                let (slots, found) = match line.kind {
                    VariableKind::State => (&self.agents[ty.index()].states, &mut initials.states),
                    VariableKind::Discrete => (&self.agents[ty.index()].discretes, &mut initials.discretes),
                };
                let slot = slots[found.len()];
                let value = self.initial_of(ty, variable, slot);
                found.push(value);
            }
        }
        self.order_initials(ty, &mut initials);
        initials
    }

    fn initial_of(&mut self, ty: TypeId, variable: &'a ast::Variable, slot: Slot) -> Option<Given> {
        let given = variable.initial.as_ref()?;
        let what = format!("the initial value of `{}`", variable.name.text);
        match given.kind {
            GivenKind::Value => self.initial(ty, &given.value, slot, &what, Allowed::All),
            GivenKind::Draw => {
                let draw = self.lower_draw(&mut Scope::of(Home::Initial(ty)), &given.value, slot)?;
                self.if_known(Given::Draw(draw), &what, Allowed::All)
            }
        }
    }

    fn initial(
        &mut self,
        ty: TypeId,
        expr: &'a ast::Expr,
        slot: Slot,
        what: &str,
        allowed: Allowed,
    ) -> Option<Given> {
        let value = self.lower_into(&mut Scope::of(Home::Initial(ty)), expr, slot, what);
        if value.ty == Ty::Wrong {
            return None;
        }
        self.if_known(Given::Value(value.id), what, allowed)
    }

    /// What is given; none, and a diagnostic, if it reads what is not known while the agent is made.
    fn if_known(&mut self, given: Given, what: &str, allowed: Allowed) -> Option<Given> {
        match self.reads(given, allowed) {
            Ok(_) => Some(given),
            Err((read, span)) => {
                self.report(ValueError::NotInitial { what: what.to_string(), read, span });
                None
            }
        }
    }

    /// The states and discretes that an initial value reads, or the first thing that it may not read.
    fn reads(&self, given: Given, allowed: Allowed) -> Result<Vec<VarRef>, (&'static str, Span)> {
        let mut reads = Vec::new();
        let mut seen = FxHashSet::default();
        let mut work = given.exprs();
        while let Some(id) = work.pop() {
            if !seen.insert(id) {
                continue;
            }
            let expr = &self.model.exprs[id];
            let own = |agent: &ExprId| matches!(self.model.exprs[*agent].kind, ExprKind::SelfAgent);
            let refused = match (&expr.kind, allowed) {
                (ExprKind::Number(_) | ExprKind::Local(_), _) => continue,
                (ExprKind::Apply(..), _) => {
                    for_each_operand(&expr.kind, |operand| work.push(operand));
                    continue;
                }
                (ExprKind::Call(function, args), _) => {
                    let body = self.model.functions[*function].body;
                    if !self.facts[body.index()].pure {
                        return Err(("time or other agents", expr.span));
                    }
                    work.extend(args);
                    continue;
                }
                (ExprKind::AgentParam(agent, _), Allowed::All) if own(agent) => continue,
                (ExprKind::AgentParam(agent, number), Allowed::ParamsBefore(limit)) if own(agent) => {
                    if *number < limit {
                        continue;
                    }
                    "itself or a parameter behind it"
                }
                (ExprKind::State(agent, number), Allowed::All) if own(agent) => {
                    reads.push(VarRef::State(*number));
                    continue;
                }
                (ExprKind::Discrete(agent, number), Allowed::All) if own(agent) => {
                    reads.push(VarRef::Discrete(*number));
                    continue;
                }
                (ExprKind::State(..) | ExprKind::Discrete(..), _) => "a state or a discrete variable",
                (ExprKind::Let(..), _) => "a `let` of the agent",
                (ExprKind::Time, _) => "the time",
                (ExprKind::Rate(..), _) => "a rate",
                _ => "links or other agents",
            };
            return Err((refused, expr.span));
        }
        Ok(reads)
    }

    fn order_initials(&mut self, ty: TypeId, initials: &mut Initials) {
        let n_states = initials.states.len();
        let node = |variable: &VarRef| match variable {
            VarRef::State(number) => Some(*number),
            VarRef::Discrete(number) => Some(n_states + number),
            VarRef::Param(_) | VarRef::Link(_) | VarRef::Let(_) => None,
        };
        let values = initials.states.iter().chain(&initials.discretes);
        let needs = values
            .map(|value| match value.map(|given| self.reads(given, Allowed::All)) {
                Some(Ok(reads)) => reads.iter().filter_map(node).collect(),
                Some(Err(_)) | None => Vec::new(),
            })
            .collect::<Vec<Vec<usize>>>();
        if let Some(circle) = find_circle(&needs) {
            let model = &self.model.types[ty];
            let variables = model.states.iter().chain(&model.discretes).collect::<Vec<_>>();
            let names = circle.iter().map(|&k| (variables[k].name.clone(), variables[k].span)).collect();
            self.report(NameError::Circle { names, what: "initial values need each other in a circle" });
        }
        let variable =
            |k: usize| if k < n_states { VarRef::State(k) } else { VarRef::Discrete(k - n_states) };
        initials.order = in_order_of_need(&needs).into_iter().map(variable).collect();
    }
}
