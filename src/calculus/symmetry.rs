//! Symmetry (rule 5): whether a transition of an interaction stays the same when its two agents change places.
//!
//! Decided by comparing a normal form of the transition with that of its mirror image, and by nothing cleverer: lets and
//! functions are inlined already; operands of `+ * and or == != min max hypot` are a sorted list, nested ones opened;
//! the simplification has taken the sign from `u - v` under an even power, `abs` and `hypot`, but in an order that the
//! mirror may turn round, so these pairs are sorted too; actions are a set. A leaf is named by the path that leads to its
//! agent: a participant, or the depth of the quantifier that binds it, then links.

use rustc_hash::FxHashMap;

use crate::calculus::draft::Draft;
use crate::calculus::graph::{Graph, Node, NodeId};
use crate::calculus::system::{
    ActionStep, Birth, Condition, Entry, Frame, FunctionId, Guard, Quantified, Relation, Slot, Source,
    TransitionSystem, Trigger, VarRef,
};
use crate::math::Op;

/// Whether the transition is its own mirror image. Both participants must be of one type.
pub fn symmetric(draft: &Draft, transition: &TransitionSystem) -> bool {
    let mut forms = FxHashMap::default();
    let straight = Former::new(draft, transition, [0, 1], &mut forms).transition(transition);
    let mirrored = Former::new(draft, transition, [1, 0], &mut forms).transition(transition);
    straight == mirrored
}

/// The number of a normal form; equal forms have equal numbers.
type FormId = usize;

/// A normal form: what it is, and its parts.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Form {
    /// A constant, by its bits.
    Constant(u64),
    Time,
    /// A column of an agent: path, kind of the leaf, column.
    Leaf(Vec<usize>, u8, u32),
    /// An operator; operands sorted where their order does not matter.
    Apply(Op, Vec<FormId>),
    /// `u - v` without its sign.
    Distance([FormId; 2]),
    /// A part of a transition: its word, its numbers, its parts.
    Part(&'static str, Vec<usize>, Vec<FormId>),
    /// The reason of a `stop`.
    Text(Option<String>),
}

struct Former<'a> {
    graph: &'a Graph,
    functions: &'a crate::base::Arena<crate::calculus::system::Function>,
    frame: &'a Frame,
    places: [usize; 2],
    depths: FxHashMap<usize, usize>,
    depth: usize,
    memo: FxHashMap<NodeId, FormId>,
    forms: &'a mut FxHashMap<Form, FormId>,
}

impl<'a> Former<'a> {
    /// Names participants by `places`: the mirror image calls slot 0 the second one.
    fn new(
        draft: &'a Draft,
        transition: &'a TransitionSystem,
        places: [usize; 2],
        forms: &'a mut FxHashMap<Form, FormId>,
    ) -> Self {
        Self {
            graph: &draft.graph,
            functions: &draft.functions,
            frame: &transition.frame,
            places,
            depths: FxHashMap::default(),
            depth: 0,
            memo: FxHashMap::default(),
            forms,
        }
    }

    fn id(&mut self, form: Form) -> FormId {
        let next = self.forms.len();
        *self.forms.entry(form).or_insert(next)
    }

    fn part(&mut self, word: &'static str, numbers: Vec<usize>, parts: Vec<FormId>) -> FormId {
        self.id(Form::Part(word, numbers, parts))
    }

    fn transition(&mut self, transition: &TransitionSystem) -> FormId {
        let mut parts = match &transition.trigger {
            Trigger::When(guard) => vec![self.guard(guard)],
            Trigger::After { delay: time, guard }
            | Trigger::Every { period: time, guard }
            | Trigger::Chance { rate: time, guard, .. } => {
                let mut parts = vec![self.function(*time)];
                parts.extend(guard.as_ref().map(|guard| self.guard(guard)));
                parts
            }
            Trigger::On { .. } | Trigger::Rate { .. } => {
                unreachable!("the model refuses these in interactions")
            }
        };
        if let Some(priority) = transition.priority {
            let priority = self.function(priority);
            parts.push(self.part("priority", Vec::new(), vec![priority]));
        }
        let actions = self.steps(&transition.actions.steps);
        parts.push(actions);
        self.part("transition", Vec::new(), parts)
    }

    fn steps(&mut self, steps: &[ActionStep]) -> FormId {
        let mut set: Vec<FormId> = steps.iter().map(|step| self.step(step)).collect();
        set.sort_unstable();
        self.part("actions", Vec::new(), set)
    }

    fn step(&mut self, step: &ActionStep) -> FormId {
        match step {
            ActionStep::Assign { slot, target, value, .. } => {
                let value = self.function(*value);
                let column = column(target);
                self.part("assign", vec![self.places[*slot], column[0], column[1]], vec![value])
            }
            ActionStep::Draw { slot, target, distribution, parameters, .. } => {
                let column = column(target);
                let parts = parameters.iter().map(|&parameter| self.function(parameter)).collect();
                self.part(distribution.name(), vec![self.places[*slot], column[0], column[1]], parts)
            }
            ActionStep::Emit { slot, event, values, delay, .. } => {
                let parts = values.iter().chain(delay).map(|&value| self.function(value)).collect();
                let numbers = vec![self.places[*slot], *event, values.len()];
                self.part("emit", numbers, parts)
            }
            ActionStep::If { condition, then, otherwise } => {
                let parts = vec![self.guard(condition), self.steps(then), self.steps(otherwise)];
                self.part("if", Vec::new(), parts)
            }
            ActionStep::Goto { slot, target, .. } => self.part(
                "goto",
                vec![self.places[*slot], target.mode.index(), target.inside as usize],
                Vec::new(),
            ),
            ActionStep::Stop { reason, .. } => {
                let reason = self.id(Form::Text(reason.clone()));
                self.part("stop", Vec::new(), vec![reason])
            }
            ActionStep::Create(birth) => self.birth(birth),
            ActionStep::Destroy { slot, .. } => self.part("destroy", self.path(*slot as u32), Vec::new()),
        }
    }

    fn birth(&mut self, birth: &Birth) -> FormId {
        let mut parts = Vec::new();
        for (variable, source) in &birth.given {
            let values = source.functions().iter().map(|&function| self.function(function)).collect();
            let kind = match source {
                Source::Number(_) => 0,
                Source::Draw { distribution, .. } => 1 + *distribution as usize,
            };
            let (word, number) = match variable {
                VarRef::State(k) => ("state", k),
                VarRef::Discrete(k) => ("discrete", k),
                VarRef::Param(k) => ("param", k),
                VarRef::Link(k) => ("link", k),
                VarRef::Let(k) => ("let", k),
            };
            parts.push(self.part(word, vec![*number, kind], values));
        }
        for (link, slot) in &birth.links {
            let mut path = slot.map_or(Vec::new(), |slot| self.path(slot as u32));
            path.insert(0, *link);
            parts.push(self.part("link", path, Vec::new()));
        }
        self.part("create", vec![birth.ty, birth.mode], parts)
    }

    fn guard(&mut self, guard: &Guard) -> FormId {
        self.condition(guard, &guard.condition)
    }

    fn condition(&mut self, guard: &Guard, condition: &Condition) -> FormId {
        match condition {
            Condition::Constant(value) => self.part("constant", vec![usize::from(*value)], Vec::new()),
            Condition::Discrete(function) => self.function(*function),
            Condition::Atom(k) => {
                let atom = &guard.atoms[*k];
                let g = self.function(atom.value);
                let relation = match atom.relation {
                    Relation::NonPositive => 0,
                    Relation::Negative => 1,
                    Relation::Crossing => 2,
                };
                self.part("atom", vec![relation], vec![g])
            }
            Condition::And(terms) => self.list("and", guard, terms),
            Condition::Or(terms) => self.list("or", guard, terms),
            Condition::Exists(quantified) => self.quantified("exists", guard, quantified),
            Condition::Forall(quantified) => self.quantified("forall", guard, quantified),
            Condition::Rising(_, inner) => {
                let inner = self.condition(guard, inner);
                self.part("rising", Vec::new(), vec![inner])
            }
        }
    }

    fn list(&mut self, word: &'static str, guard: &Guard, terms: &[Condition]) -> FormId {
        let mut parts: Vec<FormId> = terms.iter().map(|term| self.condition(guard, term)).collect();
        parts.sort_unstable();
        self.part(word, Vec::new(), parts)
    }

    fn quantified(&mut self, word: &'static str, guard: &Guard, quantified: &Quantified) -> FormId {
        self.depths.insert(quantified.slot, self.depth);
        self.depth += 1;
        let body = self.condition(guard, &quantified.body);
        self.depth -= 1;
        self.part(word, vec![quantified.ty, usize::from(quantified.other)], vec![body])
    }

    fn function(&mut self, function: FunctionId) -> FormId {
        let root = self.functions[function].outputs[0];
        for id in self.graph.reach(&[root]) {
            if !self.memo.contains_key(&id) {
                let form = self.node(id);
                self.memo.insert(id, form);
            }
        }
        self.memo[&root]
    }

    /// An aggregate by what it folds, as a quantifier by its body.
    fn fold(&mut self, number: usize) -> FormId {
        let fold = &self.frame.folds[number];
        self.depths.insert(fold.range.slot, self.depth);
        self.depth += 1;
        let mut parts = vec![self.guard(&fold.filter)];
        parts.extend(fold.term.as_ref().map(|term| self.function(term.value)));
        self.depth -= 1;
        self.part(fold.kind.name(), vec![fold.range.ty, usize::from(fold.range.other)], parts)
    }

    fn node(&mut self, id: NodeId) -> FormId {
        let node = self.graph.node(id);
        if let Some(slot) = node.slot()
            && let Slot::Fold { number, .. } = self.frame.slots[slot]
        {
            let fold = self.fold(number);
            let order = match node {
                Node::Rate { .. } => 1,
                Node::Acceleration { .. } => 2,
                _ => 0,
            };
            return self.part("aggregate", vec![order], vec![fold]);
        }
        let form = match self.graph.node(id) {
            Node::Constant(bits) => Form::Constant(bits),
            Node::Time => Form::Time,
            Node::State { slot, column } => Form::Leaf(self.path(slot), 0, column),
            Node::Rate { slot, column } => Form::Leaf(self.path(slot), 1, column),
            Node::Acceleration { slot, column } => Form::Leaf(self.path(slot), 2, column),
            Node::Aux { slot, column } => Form::Leaf(self.path(slot), 3, column),
            Node::Unary(Op::Abs, a) => Form::Apply(Op::Abs, vec![self.without_sign(a)]),
            Node::Binary(Op::Powi, a, n) if self.is_even(n) => {
                Form::Apply(Op::Powi, vec![self.without_sign(a), self.memo[&n]])
            }
            Node::Unary(op, a) => Form::Apply(op, vec![self.memo[&a]]),
            Node::Binary(op, ..) if associative(op) => {
                let mut operands: Vec<FormId> = self.opened(op, id);
                operands.sort_unstable();
                Form::Apply(op, operands)
            }
            Node::Binary(op, a, b) => {
                let mut operands = vec![self.memo[&a], self.memo[&b]];
                if matches!(op, Op::Eq | Op::Ne) {
                    operands.sort_unstable();
                }
                Form::Apply(op, operands)
            }
            Node::Select(c, a, b) => {
                Form::Apply(Op::Select, vec![self.memo[&c], self.memo[&a], self.memo[&b]])
            }
        };
        self.id(form)
    }

    /// The operands of nested uses of one operator.
    fn opened(&mut self, op: Op, id: NodeId) -> Vec<FormId> {
        let (mut found, mut pending) = (Vec::new(), vec![id]);
        while let Some(id) = pending.pop() {
            match self.graph.node(id) {
                Node::Binary(inner, a, b) if inner == op => pending.extend([a, b]),
                _ if op == Op::Hypot => found.push(self.without_sign(id)),
                _ => found.push(self.memo[&id]),
            }
        }
        found
    }

    /// The form of a node whose sign does not matter.
    fn without_sign(&mut self, id: NodeId) -> FormId {
        match self.graph.node(id) {
            Node::Binary(Op::Sub, a, b) => {
                let mut sides = [self.memo[&a], self.memo[&b]];
                sides.sort_unstable();
                self.id(Form::Distance(sides))
            }
            _ => self.memo[&id],
        }
    }

    fn is_even(&self, n: NodeId) -> bool {
        self.graph.constant(n).is_some_and(|n| n % 2.0 == 0.0)
    }

    /// How the agent in a slot is reached.
    fn path(&self, slot: u32) -> Vec<usize> {
        let (mut slot, mut links) = (slot as usize, Vec::new());
        while let Slot::Link { from, link, .. } = self.frame.slots[slot] {
            links.push(link);
            slot = from;
        }
        let root = match slot {
            0 | 1 => self.places[slot],
            _ => 2 + self.depths.get(&slot).copied().unwrap_or(slot),
        };
        links.push(root);
        links.reverse();
        links
    }
}

/// Kind and number of a column.
fn column(target: &Entry) -> [usize; 2] {
    match target {
        Entry::State(k) => [0, *k],
        Entry::Aux(k) => [1, *k],
    }
}

fn associative(op: Op) -> bool {
    matches!(op, Op::Add | Op::Mul | Op::And | Op::Or | Op::Min | Op::Max | Op::Hypot)
}
