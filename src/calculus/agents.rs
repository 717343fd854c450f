//! Agent types and interactions, part by part: modes, claims, transitions, lets.

use crate::base::{FileId, Span};
use crate::calculus::actions;
use crate::calculus::aggregate;
use crate::calculus::condition::{Cond, Sense, Written};
use crate::calculus::draft::Draft;
use crate::calculus::error::Error;
use crate::calculus::flow;
use crate::calculus::frame::{Scope, Value};
use crate::calculus::graph::Node;
use crate::calculus::guard;
use crate::calculus::nonnegative::is_never_negative;
use crate::calculus::symmetry;
use crate::calculus::system::{
    ActionList, AgentSystem, ClaimKind, ClaimSystem, Column, Condition, FunctionId, Guard, InteractionSystem,
    LetSystem, LetValue, ModeSystem, PairTransition, Relation, Sender, TransitionSystem, Trigger,
};
use crate::model::ir::{
    self, Action, Claim, Destination, ExprId, Inside, Interaction, Let, Mode, ModeId, Transition, Type,
    TypeId,
};

/// The names and places of all modes, which listings need before there are equations; then the configurations of regions.
pub fn mode_tree(draft: &mut Draft) {
    for (id, ty) in draft.model.types.iter_enumerated() {
        let mut modes: Vec<ModeSystem> = ty.modes.iter().map(node).collect();
        let leaves = ty.leaves();
        let first = if ty.has_regions() { modes.len() } else { 0 };
        let mut stride = 1;
        for leaves in leaves.iter().rev() {
            for (rank, leaf) in leaves.iter().enumerate() {
                modes[leaf.index()].offset = if ty.has_regions() { rank * stride } else { leaf.index() };
            }
            stride *= leaves.len();
        }
        for number in 0..ty.n_configurations() {
            let chosen = ir::AgentType::configuration(&leaves, number);
            let at = first + chosen.iter().map(|leaf| modes[leaf.index()].offset).sum::<usize>();
            if at == modes.len() {
                modes.push(configuration(ty.path(&chosen)));
            }
            modes[at].active = ty.active(&chosen).into_iter().map(ModeId::index).collect();
        }
        let system = &mut draft.types[id.index()];
        system.modes = modes;
        system.regions = ty.regions().into_iter().map(ModeId::index).collect();
    }
}

fn node(declared: &Mode) -> ModeSystem {
    ModeSystem {
        name: declared.name.clone(),
        parent: declared.parent.map(ModeId::index),
        depth: declared.depth,
        initial: declared.initial.map(ModeId::index),
        ..configuration(declared.path.clone())
    }
}

/// A node of which only the path is known.
fn configuration(path: String) -> ModeSystem {
    ModeSystem {
        name: path.clone(),
        path,
        parent: None,
        depth: 0,
        initial: None,
        offset: 0,
        history: None,
        active: Vec::new(),
        flow: None,
        claims: Vec::new(),
        entry: ActionList::default(),
        exit: ActionList::default(),
        transitions: Vec::new(),
    }
}

/// Columns for the modes to whose history something leads.
pub fn histories(draft: &mut Draft) {
    for (id, ty) in draft.model.types.iter_enumerated() {
        let own = ty.transitions.iter().filter_map(|transition| transition.target);
        let mut targets: Vec<Destination> = own.collect();
        for interaction in draft.model.interactions.iter() {
            for transition in &interaction.transitions {
                destinations(&transition.actions, &mut |participant, target| {
                    if interaction.types[participant] == id {
                        targets.push(target);
                    }
                });
            }
        }
        let system = &mut draft.types[id.index()];
        for target in targets.into_iter().filter(|target| target.inside == Inside::History) {
            let mode = &mut system.modes[target.mode.index()];
            if mode.history.is_none() {
                mode.history = Some(system.layout.history(system.layout.n_histories));
                system.layout.n_histories += 1;
            }
        }
    }
}

/// Calls `visit` with every change of mode in some actions.
fn destinations(list: &[Action], visit: &mut dyn FnMut(usize, Destination)) {
    for action in list {
        match action {
            Action::Goto { participant, target, .. } => visit(*participant, *target),
            Action::If { then, otherwise, .. } => {
                destinations(then, visit);
                destinations(otherwise, visit);
            }
            Action::Assign { .. } | Action::Draw { .. } | Action::Emit { .. } | Action::Stop { .. } => {}
            Action::Create(_) | Action::Destroy { .. } => {}
        }
    }
}

/// Flows of all configurations; then every type has as many locks as the one that needs most.
pub fn flows(draft: &mut Draft) {
    for id in draft.model.types.indices() {
        for mode in 0..draft.types[id.index()].modes.len() {
            let system = &draft.types[id.index()];
            let active = system.modes[mode].active.clone();
            if active.is_empty() {
                continue;
            }
            let path = &system.modes[mode].path;
            let name = if path.is_empty() { system.name.clone() } else { format!("{}.{path}", system.name) };
            let flow = flow::flow(draft, id, &active, &name);
            let flow = draft.keep(flow);
            let system = &mut draft.types[id.index()];
            system.layout.n_locks =
                system.layout.n_locks.max(flow.as_ref().map_or(0, |flow| flow.kinks.len()));
            system.modes[mode].flow = flow;
        }
    }
}

fn mode_name(ty: &ir::AgentType, mode: &Mode) -> String {
    if mode.path.is_empty() { ty.name.clone() } else { format!("{}.{}", ty.name, mode.path) }
}

/// Invariants, asserts, entry and exit actions.
pub fn modes(draft: &mut Draft) {
    for (id, ty) in draft.model.types.iter_enumerated() {
        for (mode, declared) in ty.modes.iter_enumerated() {
            let name = mode_name(ty, declared);
            let mut claims = Vec::new();
            let invariants = declared.invariants.iter().map(|claim| (ClaimKind::Invariant, claim));
            let is_watcher = draft.model.watch.as_ref().is_some_and(|watch| watch.ty == id);
            let asserted = if is_watcher { ClaimKind::Property } else { ClaimKind::Assert };
            let asserts = declared.asserts.iter().map(|claim| (asserted, claim));
            for (kind, claim) in invariants.chain(asserts) {
                let lowered = self::claim(draft, id, kind, claim, &name);
                claims.extend(draft.keep(lowered));
            }
            let entry = own_actions(draft, id, &declared.entry, &format!("{name} entry"));
            let exit = own_actions(draft, id, &declared.exit, &format!("{name} exit"));
            let system = &mut draft.types[id.index()].modes[mode.index()];
            (system.claims, system.entry, system.exit) = (claims, entry, exit);
        }
    }
}

fn claim(
    draft: &mut Draft,
    ty: TypeId,
    kind: ClaimKind,
    claim: &Claim,
    name: &str,
) -> Result<ClaimSystem, Error> {
    let mut scope = Scope::of_self(ty);
    let word = match kind {
        ClaimKind::Invariant => "invariant",
        ClaimKind::Assert => "assert",
        ClaimKind::Rate => "rate",
        ClaimKind::Property => "property",
    };
    let name = format!("{name} {word}");
    let violation = match kind {
        ClaimKind::Property => guard::margins(draft, &mut scope, claim.condition, &name)?,
        ClaimKind::Invariant | ClaimKind::Assert | ClaimKind::Rate => {
            let violation = guard::guard(draft, &mut scope, claim.condition, Sense::Negative, &name)?;
            without_the_impossible(draft, violation)
        }
    };
    let (frame, message) = (scope.into_frame(), claim.message.clone());
    Ok(ClaimSystem { kind, frame, violation, message, span: claim.span })
}

/// The violation of a claim that something is not negative: it cannot be, if what is compared is a square, or the like. An
/// algorithm that finds zeros within a tolerance need not look for it.
fn without_the_impossible(draft: &Draft, violation: Guard) -> Guard {
    let is_impossible = |condition: &Condition| {
        let Condition::Atom(number) = condition else { return false };
        let atom = &violation.atoms[*number];
        atom.relation == Relation::Negative
            && is_never_negative(&draft.graph, draft.functions[atom.value].outputs[0])
    };
    let impossible = match &violation.condition {
        Condition::And(all) => all.iter().any(is_impossible),
        one => is_impossible(one),
    };
    if !impossible {
        return violation;
    }
    Guard { condition: Condition::Constant(false), atoms: Vec::new(), n_rising: 0 }
}

/// Entry or exit actions, which have a frame of their own.
fn own_actions(draft: &mut Draft, ty: TypeId, steps: &[Action], name: &str) -> ActionList {
    let mut scope = Scope::of_self(ty);
    let list = actions::actions(draft, &mut scope, steps, name);
    let list = draft.keep(list).unwrap_or_default();
    ActionList { frame: scope.into_frame(), ..list }
}

/// Transitions of agents.
pub fn transitions(draft: &mut Draft) {
    for (id, ty) in draft.model.types.iter_enumerated() {
        draft.types[id.index()].transitions.reserve_exact(ty.transitions.len());
        for declared in &ty.transitions {
            let scope = Scope::of_self(id);
            let depth = ty.modes[declared.source].depth;
            let lowered = transition(draft, scope, declared, depth);
            let Some(lowered) = draft.keep(lowered) else { continue };
            if let ir::Trigger::Rate { claim, .. } = declared.trigger {
                let claim = not_negative(draft, id, claim, declared);
                let claim = draft.keep(claim).filter(|claim| !is_settled(&claim.violation));
                draft.types[id.index()].modes[declared.source.index()].claims.extend(claim);
            }
            let system = &mut draft.types[id.index()];
            system.modes[declared.source.index()].transitions.push(system.transitions.len());
            system.transitions.push(lowered);
        }
    }
}

/// The claim that the hazard of a transition is not negative.
fn not_negative(
    draft: &mut Draft,
    ty: TypeId,
    claim: ExprId,
    declared: &Transition,
) -> Result<ClaimSystem, Error> {
    let mut scope = Scope::of_self(ty);
    let name = format!("{} not negative", declared.label);
    let violation = guard::guard(draft, &mut scope, claim, Sense::Negative, &name)?;
    let violation = without_the_impossible(draft, violation);
    let (frame, span) = (scope.into_frame(), declared.span);
    Ok(ClaimSystem { kind: ClaimKind::Rate, frame, violation, message: Some(declared.label.clone()), span })
}

/// Whether a claim is always true.
fn is_settled(violation: &Guard) -> bool {
    matches!(violation.condition, Condition::Constant(false))
}

/// Interactions and whether they are symmetric.
pub fn interactions(draft: &mut Draft) -> Vec<InteractionSystem> {
    let model = draft.model;
    model.interactions.iter().map(|declared| interaction(draft, declared)).collect()
}

fn interaction(draft: &mut Draft, declared: &Interaction) -> InteractionSystem {
    let [a, b] = &declared.participants;
    let mut transitions = Vec::with_capacity(declared.transitions.len());
    for step in &declared.transitions {
        let scope = Scope::new(vec![(a.clone(), declared.types[0]), (b.clone(), declared.types[1])]);
        let lowered = transition(draft, scope, step, 0);
        let Some(transition) = draft.keep(lowered) else { continue };
        let symmetric = declared.types[0] == declared.types[1] && symmetry::symmetric(draft, &transition);
        transitions.push(PairTransition { transition, symmetric, near: Vec::new() });
    }
    InteractionSystem { name: declared.name.clone(), types: declared.types.map(TypeId::index), transitions }
}

fn transition(
    draft: &mut Draft,
    mut scope: Scope,
    declared: &Transition,
    depth: usize,
) -> Result<TransitionSystem, Error> {
    let label = &declared.label;
    let trigger = trigger(draft, &mut scope, &declared.trigger, (label, declared.span))?;
    let priority = match declared.priority {
        Some(expr) => Some(number(draft, &mut scope, expr, &format!("{label} priority"))?),
        None => None,
    };
    let mut actions = actions::actions(draft, &mut scope, &declared.actions, label)?;
    let witnesses =
        declared.witnesses.iter().filter_map(|binder| scope.witnesses.get(binder).copied()).collect();
    let frame = scope.into_frame();
    actions.frame = frame.clone();
    Ok(TransitionSystem {
        label: label.clone(),
        source: declared.source.index(),
        depth,
        declaration: 0,
        priority,
        trigger,
        target: declared.target,
        actions,
        frame,
        witnesses,
        span: declared.span,
    })
}

fn trigger(
    draft: &mut Draft,
    scope: &mut Scope,
    trigger: &ir::Trigger,
    (label, span): (&str, Span),
) -> Result<Trigger, Error> {
    let name = format!("{label} guard");
    let guard = |draft: &mut Draft, scope: &mut Scope, guard: ExprId| {
        guard::guard(draft, scope, guard, Sense::Positive, &name)
    };
    Ok(match trigger {
        &ir::Trigger::When(condition) => Trigger::When(guard(draft, scope, condition)?),
        ir::Trigger::Rate { rate, guard: condition, flows, .. } => {
            let ty = scope.frame.slots[0].ty();
            let hazard = draft.types[ty].hazards.iter().position(|known| known == label);
            let Some(hazard) = hazard else {
                // No agent has a state for the hazard of a pair.
                return Ok(Trigger::Chance {
                    rate: number(draft, scope, *rate, &format!("{label} rate"))?,
                    flows: *flows,
                    guard: condition.map(|condition| guard(draft, scope, condition)).transpose()?,
                });
            };
            Trigger::Rate {
                hazard,
                stream: draft.stream(ty, label),
                due: due(draft, scope, hazard, label, span),
                guard: condition.map(|condition| guard(draft, scope, condition)).transpose()?,
            }
        }
        ir::Trigger::On { events, from, guard: condition } => Trigger::On {
            events: events.iter().map(|&(ty, event)| (ty.index(), event)).collect(),
            from: from.map_or(Ok(Sender::Others), |from| sender(draft, scope, from))?,
            guard: condition.map(|condition| guard(draft, scope, condition)).transpose()?,
        },
        &ir::Trigger::After(delay, condition) => Trigger::After {
            delay: number(draft, scope, delay, &format!("{label} delay"))?,
            guard: condition.map(|condition| guard(draft, scope, condition)).transpose()?,
        },
        &ir::Trigger::Every(period, condition) => Trigger::Every {
            period: number(draft, scope, period, &format!("{label} period"))?,
            guard: condition.map(|condition| guard(draft, scope, condition)).transpose()?,
        },
    })
}

/// That nothing is left of a hazard.
fn due(draft: &mut Draft, scope: &Scope, hazard: usize, label: &str, span: Span) -> Guard {
    let column = draft.layout(scope.frame.slots[0].ty()).hazard(hazard) as u32;
    let left = draft.graph.intern(Node::State { slot: 0, column });
    let cond = Cond::Atom(Relation::NonPositive, left, Written { span, sides: None });
    guard::finish(draft, &scope.frame, cond, &format!("{label} due"))
}

/// Whom an `on` hears: the agent that an expression names, which has a slot.
fn sender(draft: &mut Draft, scope: &mut Scope, from: ExprId) -> Result<Sender, Error> {
    let span = draft.model.exprs[from].span;
    let agent = match aggregate::value(draft, scope, Scope::TOP, from)? {
        Value::Agent(agent) => agent,
        Value::Number(_) | Value::Delayed(..) => unreachable!("the model is typed"),
    };
    let slot = scope.slot(draft.model, agent, span)?;
    Ok(Sender::Slot(slot.expect("the model lets no message come from `none`")))
}

fn number(draft: &mut Draft, scope: &mut Scope, expr: ExprId, name: &str) -> Result<FunctionId, Error> {
    let node = aggregate::number(draft, scope, Scope::TOP, expr)?;
    Ok(draft.function(|| name.to_owned(), vec![node]))
}

/// Numbers all transitions in the order in which they stand in the source, file by file.
pub fn number_declarations(
    files: &[FileId],
    types: &mut [AgentSystem],
    interactions: &mut [InteractionSystem],
) {
    let own = types.iter_mut().flat_map(|ty| &mut ty.transitions);
    let pairs = interactions.iter_mut().flat_map(|i| &mut i.transitions).map(|pair| &mut pair.transition);
    let mut all: Vec<&mut TransitionSystem> = own.chain(pairs).collect();
    let rank = |file: FileId| files.iter().position(|&other| other == file);
    all.sort_by_key(|transition| (rank(transition.span.file), transition.span.start));
    for (number, transition) in all.into_iter().enumerate() {
        transition.declaration = number;
    }
}

/// Lets, for recording.
pub fn lets(draft: &mut Draft) {
    for (id, ty) in draft.model.types.iter_enumerated() {
        let mut lets = Vec::with_capacity(ty.lets.len());
        let mut scope = Scope::of_self(id);
        for declared in &ty.lets {
            let lowered = recorded(draft, &mut scope, declared, &format!("{}.{}", ty.name, declared.name));
            lets.extend(draft.keep(lowered));
            // What one let has become serves the next, unless it reads other agents: those are its own.
            if scope.frame.slots.len() > 1 {
                scope = Scope::of_self(id);
            }
        }
        draft.types[id.index()].lets = lets;
    }
}

fn recorded(draft: &mut Draft, scope: &mut Scope, declared: &Let, name: &str) -> Result<LetSystem, Error> {
    let boolean = draft.model.exprs[declared.value].ty == Type::Bool;
    let value = if boolean {
        LetValue::Condition(guard::guard(draft, scope, declared.value, Sense::Positive, name)?)
    } else {
        LetValue::Number(number(draft, scope, declared.value, name)?)
    };
    let column = Column { name: declared.name.clone(), scale: declared.scale, boolean };
    Ok(LetSystem { column, mode: declared.mode.index(), frame: scope.frame.clone(), value })
}
