//! Lowering of numbers: expressions of the model to nodes, with functions and lets put in.
//!
//! A loop with an explicit stack, because a sum of 100 000 terms is a chain of that depth. What an expression means in
//! an environment is remembered, so that what is shared in the model is shared in the graph.

use smallvec::SmallVec;

use crate::base::Span;
use crate::calculus::draft::Draft;
use crate::calculus::error::Error;
use crate::calculus::frame::{AgentRef, Env, EnvId, Scope, Value};
use crate::calculus::graph::{Node, NodeId};
use crate::calculus::system::{Layout, Slot};
use crate::math::Op;
use crate::model::ir::{Aggregate, ExprId, ExprKind, FunctionId, ModeId, Quantifier, Set, Type, TypeId};

/// Why an expression is not lowered.
#[derive(Debug)]
pub enum Halt {
    /// It cannot be.
    Failed(Error),
    /// This aggregate has to be known first.
    Aggregate(EnvId, ExprId),
}

impl From<Error> for Halt {
    fn from(error: Error) -> Self {
        Halt::Failed(error)
    }
}

/// What lowering an expression counts, in nodes looked at.
const LOWERING: u64 = 40;

/// Why an expression cannot be lowered at once.
enum Wait {
    /// Another one comes first.
    For(EnvId, ExprId),
    /// It has to wait for somebody else.
    Halted(Halt),
}

impl From<Error> for Wait {
    fn from(error: Error) -> Self {
        Wait::Halted(error.into())
    }
}

/// Lowers a number or a boolean without quantifiers.
pub fn number(draft: &mut Draft, scope: &mut Scope, env: EnvId, expr: ExprId) -> Result<NodeId, Halt> {
    match value(draft, scope, env, expr)? {
        Value::Number(node) => Ok(node),
        Value::Agent(_) | Value::Delayed(..) => unreachable!("the model is typed"),
    }
}

/// Lowers any expression without quantifiers.
pub fn value(draft: &mut Draft, scope: &mut Scope, env: EnvId, expr: ExprId) -> Result<Value, Halt> {
    // The model refuses circles of lets, functions and rates; one that it missed would end at the limit of work.
    let mut stack = vec![(env, expr)];
    while let Some(&(env, expr)) = stack.last() {
        if !scope.memo.contains_key(&(env, expr)) {
            draft.graph.spend(LOWERING);
            draft.check_work(draft.model.exprs[expr].span)?;
            match step(draft, scope, env, expr) {
                Ok(value) => {
                    if let Value::Number(node) = value {
                        scope.spans.entry(node).or_insert(draft.model.exprs[expr].span);
                    }
                    scope.memo.insert((env, expr), value);
                }
                Err(Wait::For(inner_env, inner)) => {
                    stack.push((inner_env, inner));
                    continue;
                }
                Err(Wait::Halted(halt)) => return Err(halt),
            }
        }
        stack.pop();
    }
    Ok(scope.memo[&(env, expr)])
}

/// Lowers one expression whose operands are known.
fn step(draft: &mut Draft, scope: &mut Scope, env: EnvId, id: ExprId) -> Result<Value, Wait> {
    let model = draft.model;
    let expr = &model.exprs[id];
    let span = expr.span;
    let node = match &expr.kind {
        ExprKind::Number(x) => draft.graph.number(*x),
        ExprKind::Time => draft.graph.intern(Node::Time),
        ExprKind::Local(k) => match scope.env_of(env).locals[*k] {
            Value::Delayed(outer, argument) => return need(scope, outer, argument),
            value @ (Value::Number(_) | Value::Agent(_)) => return Ok(value),
        },
        ExprKind::Received(k) => {
            let column = draft.layout(scope.frame.slots[0].ty()).received(*k);
            draft.graph.intern(aux(0, column))
        }
        ExprKind::SelfAgent => return Ok(Value::Agent(AgentRef::Slot(scope.env_of(env).this))),
        ExprKind::Participant(k) => return Ok(Value::Agent(AgentRef::Slot(*k))),
        ExprKind::Bound(binder) => {
            let inner =
                scope.env_of(env).bound.iter().rev().find(|(b, _)| b == binder).map(|&(_, slot)| slot);
            let slot = inner.or_else(|| scope.witnesses.get(binder).copied());
            return Ok(Value::Agent(AgentRef::Slot(slot.expect("the model resolves bound names"))));
        }
        ExprKind::NoAgent => return Ok(Value::Agent(AgentRef::Absent)),
        ExprKind::Link(agent, link) => {
            let agent = need_agent(scope, env, *agent)?;
            let slot = scope.slot(model, agent, span)?;
            let target = slot.map_or(AgentRef::Absent, |from| AgentRef::link(from, *link));
            return Ok(Value::Agent(target));
        }
        ExprKind::State(agent, k) => column(draft, scope, env, *agent, span, |_, slot| state(slot, *k))?,
        ExprKind::Rate(agent, k) => return rate(draft, scope, env, *agent, *k, span),
        ExprKind::Discrete(agent, k) => {
            column(draft, scope, env, *agent, span, |layout, slot| aux(slot, layout.discrete(*k)))?
        }
        ExprKind::AgentParam(agent, k) => {
            column(draft, scope, env, *agent, span, |layout, slot| aux(slot, layout.param(*k)))?
        }
        ExprKind::Let(agent, k) => match let_env(draft, scope, env, *agent, *k, span)? {
            Some((inner, body)) => return need(scope, inner, body),
            None => draft.graph.number(f64::NAN),
        },
        ExprKind::Apply(op, operands) => {
            let mut nodes: SmallVec<[NodeId; 3]> = SmallVec::new();
            for &operand in operands.iter() {
                nodes.push(need_number(scope, env, operand)?);
            }
            draft.graph.apply(*op, &nodes)
        }
        ExprKind::Call(function, arguments) => {
            let values = arguments
                .iter()
                .map(|&argument| match model.exprs[argument].ty {
                    Type::Bool => Ok(Value::Delayed(env, argument)),
                    Type::Real | Type::Int | Type::Agent(_) | Type::Link(_) => need(scope, env, argument),
                })
                .collect::<Result<Vec<_>, _>>()?;
            let inner = call_env(scope, env, values);
            return need(scope, inner, model.functions[*function].body);
        }
        ExprKind::Present(agent) => {
            let agent = need_agent(scope, env, *agent)?;
            present(draft, scope, agent)
        }
        ExprKind::Same(a, b) => {
            let agents = [need_agent(scope, env, *a)?, need_agent(scope, env, *b)?];
            let [a, b] = agents.map(|agent| agent_number(draft, scope, agent));
            draft.graph.binary(Op::Eq, a, b)
        }
        ExprKind::Is(agent, mode) => {
            let agent = need_agent(scope, env, *agent)?;
            match scope.slot(model, agent, span)? {
                Some(slot) => in_mode(draft, scope, slot, *mode),
                None => draft.graph.number(0.0),
            }
        }
        ExprKind::Quantifier { .. } | ExprKind::Aggregate { .. } if scope.equations.is_some() => {
            over_members(draft, scope, env, id)?
        }
        ExprKind::Quantifier { .. } => return Err(Error::QuantifierInNumber { span }.into()),
        ExprKind::Aggregate { .. } => return Err(Wait::Halted(Halt::Aggregate(env, id))),
        ExprKind::Rising(_) | ExprKind::Crossing(_) => {
            unreachable!("the model lets these stand in guards only")
        }
    };
    Ok(Value::Number(node))
}

/// A quantifier or an aggregate in a flow: the members of its set one after the other.
fn over_members(draft: &mut Draft, scope: &mut Scope, env: EnvId, id: ExprId) -> Result<NodeId, Wait> {
    let model = draft.model;
    let span = model.exprs[id].span;
    let (op, nothing, (binder, set, other, filter, body)) = match &model.exprs[id].kind {
        ExprKind::Quantifier { kind, binder, set, other, filter, body } => {
            let (op, nothing) = match kind {
                Quantifier::Exists => (Op::Or, 0.0),
                Quantifier::Forall => (Op::And, 1.0),
            };
            (op, nothing, (*binder, *set, *other, *filter, Some(*body)))
        }
        ExprKind::Aggregate { kind, binder, set, other, filter, term } => {
            let (op, nothing) = match kind {
                Aggregate::Count | Aggregate::Sum => (Op::Add, 0.0),
                Aggregate::Min => (Op::Min, f64::INFINITY),
                Aggregate::Max => (Op::Max, f64::NEG_INFINITY),
            };
            (op, nothing, (*binder, *set, *other, *filter, *term))
        }
        _ => unreachable!("called for these only"),
    };
    let owner = TypeId::new(scope.frame.slots[0].ty());
    let block = model.binders[binder].block;
    let links = model.types[owner].sets.iter().find(|found| found.ty == set && found.block == block);
    let nothing = draft.graph.number(nothing);
    let mut folded = nothing;
    for link in links.map_or(0..0, Set::links) {
        let member = AgentRef::link(0, link);
        let slot = scope.slot(model, member, span)?.expect("a link has a slot");
        let inner = scope.bound_env(env, binder, slot);
        let mut belongs = present(draft, scope, member);
        if other {
            let whose = AgentRef::Slot(scope.env_of(env).this);
            let [own, its] = [whose, member].map(|agent| agent_number(draft, scope, agent));
            let differs = draft.graph.binary(Op::Ne, own, its);
            belongs = draft.graph.binary(Op::And, belongs, differs);
        }
        if let Some(filter) = filter {
            let filter = need_number(scope, inner, filter)?;
            belongs = draft.graph.binary(Op::And, belongs, filter);
        }
        let value = match body {
            Some(body) => need_number(scope, inner, body)?,
            None => draft.graph.number(1.0),
        };
        let value = draft.graph.select(belongs, value, nothing);
        folded = draft.graph.binary(op, folded, value);
    }
    Ok(folded)
}

fn need(scope: &Scope, env: EnvId, expr: ExprId) -> Result<Value, Wait> {
    scope.memo.get(&(env, expr)).copied().ok_or(Wait::For(env, expr))
}

fn need_number(scope: &Scope, env: EnvId, expr: ExprId) -> Result<NodeId, Wait> {
    match need(scope, env, expr)? {
        Value::Number(node) => Ok(node),
        Value::Agent(_) | Value::Delayed(..) => unreachable!("the model is typed"),
    }
}

fn need_agent(scope: &Scope, env: EnvId, expr: ExprId) -> Result<AgentRef, Wait> {
    match need(scope, env, expr)? {
        Value::Agent(agent) => Ok(agent),
        Value::Number(_) | Value::Delayed(..) => unreachable!("the model is typed"),
    }
}

fn state(slot: usize, column: usize) -> Node {
    Node::State { slot: slot as u32, column: column as u32 }
}

fn aux(slot: usize, column: usize) -> Node {
    Node::Aux { slot: slot as u32, column: column as u32 }
}

/// A column of an agent; NaN of `none`. A boolean read through a link is true only if it is 1, not if it is NaN.
fn column(
    draft: &mut Draft,
    scope: &mut Scope,
    env: EnvId,
    agent: ExprId,
    span: Span,
    leaf: impl Fn(&Layout, usize) -> Node,
) -> Result<NodeId, Wait> {
    let agent = need_agent(scope, env, agent)?;
    let Some(slot) = scope.slot(draft.model, agent, span)? else { return Ok(draft.graph.number(f64::NAN)) };
    let ty = scope.frame.slots[slot].ty();
    let node = leaf(draft.layout(ty), slot);
    let id = draft.graph.intern(node);
    Ok(if matches!(scope.frame.slots[slot], Slot::Link { .. }) && is_boolean_column(draft, ty, node) {
        let one = draft.graph.number(1.0);
        draft.graph.binary(Op::Eq, id, one)
    } else {
        id
    })
}

fn is_boolean_column(draft: &Draft, ty: usize, node: Node) -> bool {
    let Node::Aux { column, .. } = node else { return false };
    let (ty, column) = (&draft.types[ty], column as usize);
    let params = ty.params.iter().enumerate().map(|(k, c)| (ty.layout.param(k), c));
    let discretes = ty.discretes.iter().enumerate().map(|(k, c)| (ty.layout.discrete(k), c));
    params.chain(discretes).any(|(at, c)| at == column && c.boolean)
}

/// `x'`: in a flow the equation of the mode that is active, elsewhere what the runtime says.
fn rate(
    draft: &mut Draft,
    scope: &mut Scope,
    env: EnvId,
    agent: ExprId,
    k: usize,
    span: Span,
) -> Result<Value, Wait> {
    let agent = need_agent(scope, env, agent)?;
    let Some(slot) = scope.slot(draft.model, agent, span)? else {
        return Ok(Value::Number(draft.graph.number(f64::NAN)));
    };
    match &scope.equations {
        Some(equations) if slot == 0 => need(scope, Scope::TOP, equations[k]),
        Some(_) => Ok(Value::Number(foreign_rate(draft, scope, slot, k)?)),
        None => Ok(Value::Number(draft.graph.intern(Node::Rate { slot: slot as u32, column: k as u32 }))),
    }
}

/// The rate of state `k` of another agent, in a flow: the equation of that of its modes which is active.
fn foreign_rate(draft: &mut Draft, scope: &mut Scope, slot: usize, k: usize) -> Result<NodeId, Wait> {
    let model = draft.model;
    let modes = &model.types[TypeId::new(scope.frame.slots[slot].ty())].modes;
    let inner = scope.env(Env { this: slot, ..Env::default() });
    let mut value = draft.graph.number(f64::NAN);
    for mode in modes.indices() {
        for &(_, rate, _) in modes[mode].flow.iter().filter(|(state, _, _)| *state == k) {
            let rate = need_number(scope, inner, rate)?;
            let is_active = in_mode(draft, scope, slot, mode);
            value = draft.graph.select(is_active, rate, value);
        }
    }
    Ok(value)
}

/// Environment and body of a let of an agent; none for one of `none`.
fn let_env(
    draft: &Draft,
    scope: &mut Scope,
    env: EnvId,
    agent: ExprId,
    k: usize,
    span: Span,
) -> Result<Option<(EnvId, ExprId)>, Wait> {
    let agent = need_agent(scope, env, agent)?;
    Ok(open_let(draft, scope, agent, k, span)?)
}

/// Environment and body of let `k` of an agent; none for one of `none`.
pub fn open_let(
    draft: &Draft,
    scope: &mut Scope,
    agent: AgentRef,
    k: usize,
    span: Span,
) -> Result<Option<(EnvId, ExprId)>, Error> {
    let Some(this) = scope.slot(draft.model, agent, span)? else { return Ok(None) };
    let ty = TypeId::new(scope.frame.slots[this].ty());
    // For self the let is text of the same place as the guard that names it.
    let inner = scope.env(Env { this, ..Env::default() });
    Ok(Some((inner, draft.model.types[ty].lets[k].value)))
}

/// The environment of a function's body.
fn call_env(scope: &mut Scope, env: EnvId, locals: Vec<Value>) -> EnvId {
    let this = scope.env_of(env).this;
    scope.env(Env { this, locals, bound: Vec::new() })
}

/// The body of a function and the environment of a call of it, for conditions.
pub fn open_call(
    draft: &mut Draft,
    scope: &mut Scope,
    env: EnvId,
    function: FunctionId,
    arguments: &[ExprId],
) -> Result<(EnvId, ExprId), Halt> {
    let model = draft.model;
    let mut values = Vec::with_capacity(arguments.len());
    for &argument in arguments {
        values.push(match model.exprs[argument].ty {
            Type::Bool => Value::Delayed(env, argument),
            Type::Real | Type::Int | Type::Agent(_) | Type::Link(_) => value(draft, scope, env, argument)?,
        });
    }
    Ok((call_env(scope, env, values), model.functions[function].body))
}

/// Whether an agent is there.
fn present(draft: &mut Draft, scope: &Scope, agent: AgentRef) -> NodeId {
    match agent {
        AgentRef::Absent => draft.graph.number(0.0),
        AgentRef::Slot(slot) => match scope.frame.slots[slot] {
            Slot::Root { .. } | Slot::Fold { .. } => draft.graph.number(1.0),
            Slot::Link { from, link, .. } => present(draft, scope, AgentRef::link(from, link)),
        },
        AgentRef::Link { .. } => {
            let zero = draft.graph.number(0.0);
            let number = agent_number(draft, scope, agent);
            draft.graph.binary(Op::Le, zero, number)
        }
    }
}

/// The number of an agent, -1 for none.
pub fn agent_number(draft: &mut Draft, scope: &Scope, agent: AgentRef) -> NodeId {
    match agent {
        AgentRef::Absent => draft.graph.number(-1.0),
        AgentRef::Slot(slot) => match scope.frame.slots[slot] {
            Slot::Root { .. } | Slot::Fold { .. } => draft.graph.intern(aux(slot, Layout::NUMBER)),
            Slot::Link { from, link, .. } => agent_number(draft, scope, AgentRef::link(from, link)),
        },
        AgentRef::Link { from, link } => {
            let (from, link) = (from as usize, link as usize);
            let column = draft.layout(scope.frame.slots[from].ty()).link(link);
            draft.graph.intern(aux(from, column))
        }
    }
}

/// Whether the agent in a slot is in a mode or inside it: whether its configuration is one of those in which the mode is active.
fn in_mode(draft: &mut Draft, scope: &Scope, slot: usize, mode: ModeId) -> NodeId {
    let modes = &draft.types[scope.frame.slots[slot].ty()].modes;
    let configurations = (0..modes.len()).filter(|&k| !modes[k].active.is_empty());
    // Runs of configurations that stand behind each other.
    let mut runs: Vec<[usize; 2]> = Vec::new();
    let mut goes_on = false;
    for k in configurations {
        let is_inside = modes[k].active.contains(&mode.index());
        match runs.last_mut() {
            Some(run) if is_inside && goes_on => run[1] = k,
            _ if is_inside => runs.push([k, k]),
            _ => {}
        }
        goes_on = is_inside;
    }
    let present = draft.graph.intern(aux(slot, Layout::MODE));
    let mut any = draft.graph.number(0.0);
    for [first, last] in runs {
        let [low, high] = [first, last].map(|k| draft.graph.number(k as f64));
        let here = if first == last {
            draft.graph.binary(Op::Eq, present, low)
        } else {
            let from = draft.graph.binary(Op::Le, low, present);
            let to = draft.graph.binary(Op::Le, present, high);
            draft.graph.binary(Op::And, from, to)
        };
        any = draft.graph.binary(Op::Or, any, here);
    }
    any
}
