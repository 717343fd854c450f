//! `count`, `sum`, `min` and `max`: an aggregate becomes a leaf of its own slot, with a filter and a term.
//!
//! Numbers are lowered by a loop that cannot lower conditions; where it meets an aggregate it stops, the aggregate is
//! lowered here, and the loop begins again with what it had.

use crate::calculus::atom;
use crate::calculus::build::{self, Halt};
use crate::calculus::condition::{self, Cond, Lowering, Sense};
use crate::calculus::derive;
use crate::calculus::draft::Draft;
use crate::calculus::error::Error;
use crate::calculus::frame::{AgentRef, EnvId, Folded, Scope, Value};
use crate::calculus::graph::{Node, NodeId};
use crate::calculus::guard;
use crate::calculus::jumps;
use crate::calculus::system::{Fold, Range, Slot, Term};
use crate::model::ir::{ExprId, ExprKind, FunctionId, TypeId};

/// Lowers a number or a boolean without `exists` and `forall`.
pub fn number(draft: &mut Draft, scope: &mut Scope, env: EnvId, expr: ExprId) -> Result<NodeId, Error> {
    match value(draft, scope, env, expr)? {
        Value::Number(node) => Ok(node),
        Value::Agent(_) | Value::Delayed(..) => unreachable!("the model is typed"),
    }
}

/// Lowers any expression without `exists` and `forall`.
pub fn value(draft: &mut Draft, scope: &mut Scope, env: EnvId, expr: ExprId) -> Result<Value, Error> {
    with_aggregates(draft, scope, |draft, scope| build::value(draft, scope, env, expr))
}

/// Lowers something; whenever it needs an aggregate, that one is lowered, and it begins again.
fn with_aggregates<T>(
    draft: &mut Draft,
    scope: &mut Scope,
    lower: impl Fn(&mut Draft, &mut Scope) -> Result<T, Halt>,
) -> Result<T, Error> {
    loop {
        match lower(draft, scope) {
            Ok(value) => return Ok(value),
            Err(Halt::Failed(error)) => return Err(error),
            Err(Halt::Aggregate(env, expr)) => {
                let node = aggregate(draft, scope, env, expr)?;
                scope.memo.insert((env, expr), Value::Number(node));
            }
        }
    }
}

impl Lowering<'_, '_> {
    /// A number.
    pub fn number(&mut self, env: EnvId, expr: ExprId) -> Result<NodeId, Error> {
        number(self.draft, self.scope, env, expr)
    }

    /// An agent.
    pub fn agent(&mut self, env: EnvId, expr: ExprId) -> Result<AgentRef, Error> {
        match value(self.draft, self.scope, env, expr)? {
            Value::Agent(agent) => Ok(agent),
            Value::Number(_) | Value::Delayed(..) => unreachable!("the model is typed"),
        }
    }

    /// The body of a function and the environment of a call of it.
    pub fn open_call(
        &mut self,
        env: EnvId,
        function: FunctionId,
        arguments: &[ExprId],
    ) -> Result<(EnvId, ExprId), Error> {
        with_aggregates(self.draft, self.scope, |draft, scope| {
            build::open_call(draft, scope, env, function, arguments)
        })
    }
}

/// The leaf of an aggregate.
fn aggregate(draft: &mut Draft, scope: &mut Scope, env: EnvId, expr: ExprId) -> Result<NodeId, Error> {
    let model = draft.model;
    let span = model.exprs[expr].span;
    let ExprKind::Aggregate { kind, binder, set, other, filter, term } = &model.exprs[expr].kind else {
        unreachable!("called for aggregates only")
    };
    let name = &model.binders[*binder].name;
    let bound = scope.bind(name.clone(), *set, *other, span)?;
    let inner = scope.bound_env(env, *binder, bound);
    let filter_cond = match filter {
        Some(filter) => condition::lower_in(draft, scope, inner, *filter, Sense::Positive)?,
        None => Cond::Constant(true),
    };
    let term = term.map(|term| number(draft, scope, inner, term)).transpose()?;
    let term = term.map(|term| jumps::as_choices(&mut draft.graph, term));
    let range = Range { slot: bound, ty: set.index(), other: *other };
    let (reads, around) = surroundings(draft, scope, range, &filter_cond, term);
    let number = scope.frame.folds.len();
    let other_word = if *other { "other " } else { "" };
    let label = format!("{}[{name} in {other_word}{}]", kind.name(), model.types[*set].name);
    let is_taken = |label: &str| scope.frame.slots.iter().any(|slot| slot.name() == label);
    let label = if is_taken(&label) { format!("{label}#{}", number + 1) } else { label };
    let moves = term.is_some_and(|term| draft.graph.moves(term));
    let owner = &model.types[TypeId::new(scope.frame.slots[0].ty())].name;
    let owner = format!("{owner} {label}");
    let filter_guard = guard::finish(draft, &scope.frame, filter_cond, &format!("{owner} where"));
    let slot = scope.add(Slot::Fold { number, ty: range.ty, name: label }, span)?;
    let folded = term.map(|term| self::term(draft, scope, term, &owner));
    scope.frame.folds.push(Fold {
        kind: *kind,
        slot,
        range,
        filter: filter_guard,
        term: folded,
        moves,
        reads,
        around,
        near: Vec::new(),
    });
    scope.folded.push(Folded { inner, filter: *filter, term });
    let slot = slot as u32;
    let leaf = if moves { Node::State { slot, column: 0 } } else { Node::Aux { slot, column: 0 } };
    Ok(draft.graph.intern(leaf))
}

fn term(draft: &mut Draft, scope: &Scope, term: NodeId, owner: &str) -> Term {
    let [first, second] = derive::rates(&mut draft.graph, term);
    let reach = draft.graph.reach(&[term]);
    Term {
        smooth: atom::is_smooth(&draft.graph, &scope.frame, &reach),
        value: draft.function(|| format!("{owner} term"), vec![term]),
        rates: draft.function(|| format!("{owner} term rates"), vec![term, first, second]),
    }
}

/// The slots that an aggregate reads from outside, and what binds those that are bound.
fn surroundings(
    draft: &Draft,
    scope: &Scope,
    range: Range,
    filter: &Cond,
    term: Option<NodeId>,
) -> (Vec<usize>, Vec<Range>) {
    let mut nodes: Vec<NodeId> = term.into_iter().collect();
    let mut within = vec![range.slot];
    collect(filter, &mut nodes, &mut within);
    let root = |mut slot: usize| {
        while let Slot::Link { from, .. } = scope.frame.slots[slot] {
            slot = from;
        }
        slot
    };
    let (mut reads, _) = atom::slots_read(&draft.graph, &scope.frame, &draft.graph.reach(&nodes));
    reads.retain(|&slot| !within.contains(&root(slot)));
    let mut roots: Vec<usize> = reads.iter().map(|&slot| root(slot)).collect();
    roots.sort_unstable();
    roots.dedup();
    let around = roots.iter().filter_map(|slot| scope.bound.get(slot).copied()).collect();
    (reads, around)
}

/// The nodes of a condition, and the slots that it binds.
fn collect(condition: &Cond, nodes: &mut Vec<NodeId>, within: &mut Vec<usize>) {
    match condition {
        Cond::Constant(_) => {}
        Cond::Discrete(node) | Cond::Atom(_, node, _) => nodes.push(*node),
        Cond::And(terms) | Cond::Or(terms) => terms.iter().for_each(|term| collect(term, nodes, within)),
        Cond::Quantified(_, range, body) => {
            within.push(range.slot);
            collect(body, nodes, within);
        }
        Cond::Rising(inner) => collect(inner, nodes, within),
    }
}
