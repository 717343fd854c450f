//! Expressions as readable mathematics, with the names of the source.
//!
//! What is large, or shared and not small, is named `@1`, `@2`, ... and explained in `where` lines, so that a graph is
//! never written out as the tree that it stands for.

use rustc_hash::FxHashMap;

use crate::calculus::graph::{Graph, Node, NodeId};
use crate::calculus::system::{AgentSystem, Frame, Layout, Relation, Slot};
use crate::math::Op;

/// A node larger than this gets a name.
const LARGE: usize = 60;
/// A shared node larger than this gets a name.
const SHARED: usize = 10;

/// Binding strengths, weakest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Strength {
    Choice,
    Or,
    And,
    Not,
    Comparison,
    Sum,
    Negation,
    Product,
    Power,
    Operand,
}

/// How leaves are called.
#[derive(Clone, Copy, Debug)]
pub struct Names<'a> {
    /// The agent types.
    pub types: &'a [AgentSystem],
    /// The agents.
    pub frame: &'a Frame,
}

impl Names<'_> {
    /// `x` of self, `o.x` of another.
    fn of(&self, slot: u32, name: &str) -> String {
        match &self.frame.slots[slot as usize] {
            Slot::Root { name: owner, .. } if slot == 0 && owner == "self" => name.to_owned(),
            owner => format!("{}.{name}", owner.name()),
        }
    }

    fn agent(&self, slot: u32) -> &AgentSystem {
        &self.types[self.frame.slots[slot as usize].ty()]
    }

    fn state(&self, slot: u32, column: u32, primes: &str) -> String {
        if let Slot::Fold { name, .. } = &self.frame.slots[slot as usize] {
            return format!("{name}{primes}");
        }
        self.of(slot, &format!("{}{primes}", self.agent(slot).state_name(column as usize)))
    }

    fn aux(&self, slot: u32, column: u32) -> String {
        if let Slot::Fold { name, .. } = &self.frame.slots[slot as usize] {
            return name.clone();
        }
        let (agent, column) = (self.agent(slot), column as usize);
        let layout = &agent.layout;
        match column {
            Layout::NUMBER => self.frame.slots[slot as usize].name().to_owned(),
            Layout::MODE => self.of(slot, "mode"),
            Layout::ENTRY => self.of(slot, "entry"),
            _ if column < layout.discrete(0) => self.of(slot, &agent.params[column - layout.param(0)].name),
            _ if column < layout.link(0) => self.of(slot, &agent.discretes[column - layout.discrete(0)].name),
            _ if column < layout.received(0) => self.of(slot, &agent.links[column - layout.link(0)].name),
            _ if column < layout.gate(0) => format!("received{}", column - layout.received(0) + 1),
            _ if column < layout.history(0) => self.of(slot, &format!("gate{}", column - layout.gate(0) + 1)),
            _ if column < layout.lock(0) => self.of(slot, &format!("history{}", column - layout.history(0))),
            _ => self.of(slot, &format!("lock{}", column - layout.lock(0))),
        }
    }

    fn leaf(&self, node: Node) -> String {
        match node {
            Node::Constant(bits) => constant(f64::from_bits(bits)),
            Node::Time => "time".to_owned(),
            Node::State { slot, column } => self.state(slot, column, ""),
            Node::Rate { slot, column } => self.state(slot, column, "'"),
            Node::Acceleration { slot, column } => self.state(slot, column, "''"),
            Node::Aux { slot, column } => self.aux(slot, column),
            Node::Unary(..) | Node::Binary(..) | Node::Select(..) => unreachable!("no leaf"),
        }
    }
}

/// A number as the language writes it.
pub fn constant(x: f64) -> String {
    if x == std::f64::consts::PI {
        return "pi".to_owned();
    }
    let text = format!("{x:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// Expressions that are printed together and share names for their parts.
pub struct Sheet<'a> {
    graph: &'a Graph,
    names: Names<'a>,
    named: FxHashMap<NodeId, usize>,
    order: Vec<NodeId>,
}

impl<'a> Sheet<'a> {
    /// A sheet on which these expressions are going to be printed.
    pub fn new(graph: &'a Graph, names: Names<'a>, roots: &[NodeId]) -> Self {
        let reach = graph.reach(roots);
        let mut uses: FxHashMap<NodeId, usize> = FxHashMap::default();
        for &id in &reach {
            for operand in graph.node(id).operands() {
                *uses.entry(operand).or_insert(0) += 1;
            }
        }
        let mut sheet = Self { graph, names, named: FxHashMap::default(), order: Vec::new() };
        let mut sizes: FxHashMap<NodeId, usize> = FxHashMap::default();
        for id in reach {
            let size = 1 + graph.node(id).operands().map(|operand| sizes[&operand]).sum::<usize>();
            let shared = uses.get(&id).copied().unwrap_or(0) > 1;
            let needs_name = size > LARGE || (shared && size > SHARED);
            if needs_name {
                sheet.order.push(id);
                sheet.named.insert(id, sheet.order.len());
            }
            sizes.insert(id, if needs_name { 1 } else { size });
        }
        sheet
    }

    /// The text of an expression; a name where it has one.
    pub fn text(&self, id: NodeId) -> String {
        self.operand(id, Strength::Choice)
    }

    /// The name of a state.
    pub fn state(&self, slot: usize, column: usize) -> String {
        self.names.state(slot as u32, column as u32, "")
    }

    /// The name of an auxiliary column.
    pub fn aux(&self, slot: usize, column: usize) -> String {
        self.names.aux(slot as u32, column as u32)
    }

    /// The text of an expression even where it has a name.
    pub fn definition(&self, id: NodeId) -> String {
        self.write(id).0
    }

    /// `@1 = ...`, for all names.
    pub fn explanations(&self) -> impl Iterator<Item = String> {
        self.order.iter().enumerate().map(|(k, &id)| format!("@{} = {}", k + 1, self.definition(id)))
    }

    /// `g <= 0` as a comparison of the two sides of a difference.
    pub fn comparison(&self, relation: Relation, g: NodeId) -> String {
        let (sign, mirrored) = match relation {
            Relation::NonPositive => ("<=", ">="),
            Relation::Negative => ("<", ">"),
            Relation::Crossing => return format!("crossing({})", self.definition(g)),
        };
        let side = |id| self.operand(id, Strength::Sum);
        match self.graph.node(g) {
            Node::Binary(Op::Sub, a, b) if self.graph.constant(a).is_some() => {
                format!("{} {mirrored} {}", side(b), side(a))
            }
            Node::Binary(Op::Sub, a, b) => format!("{} {sign} {}", side(a), side(b)),
            Node::Unary(Op::Neg, a) => format!("{} {mirrored} 0", side(a)),
            Node::Binary(Op::Add, a, b) => match (self.graph.constant(a), self.graph.constant(b)) {
                (Some(c), None) => format!("{} {sign} {}", side(b), constant(-c)),
                (None, Some(c)) => format!("{} {sign} {}", side(a), constant(-c)),
                (Some(_), Some(_)) | (None, None) => format!("{} {sign} 0", self.whole(g)),
            },
            _ => format!("{} {sign} 0", self.whole(g)),
        }
    }

    /// A side of a comparison, even where it has a name.
    fn whole(&self, id: NodeId) -> String {
        let (text, strength) = self.write(id);
        if strength < Strength::Sum { format!("({text})") } else { text }
    }

    fn operand(&self, id: NodeId, least: Strength) -> String {
        if let Some(k) = self.named.get(&id) {
            return format!("@{k}");
        }
        let (text, strength) = self.write(id);
        if strength < least { format!("({text})") } else { text }
    }

    /// Recursion goes no deeper than the size at which a node gets a name.
    fn write(&self, id: NodeId) -> (String, Strength) {
        match self.graph.node(id) {
            Node::Unary(Op::Neg, a) => {
                (format!("-{}", self.operand(a, Strength::Product)), Strength::Negation)
            }
            Node::Unary(Op::Not, a) => (format!("not {}", self.operand(a, Strength::Not)), Strength::Not),
            Node::Unary(op, a) => (format!("{}({})", op.name(), self.text(a)), Strength::Operand),
            Node::Binary(op, a, b) => self.write_binary(op, a, b),
            Node::Select(c, a, b) => {
                let (c, a, b) = (self.text(c), self.text(a), self.text(b));
                (format!("if {c} then {a} else {b}"), Strength::Choice)
            }
            Node::Constant(bits) => {
                let x = f64::from_bits(bits);
                (constant(x), if x.is_sign_negative() { Strength::Negation } else { Strength::Operand })
            }
            leaf @ (Node::Time | Node::State { .. } | Node::Rate { .. }) => {
                (self.names.leaf(leaf), Strength::Operand)
            }
            leaf @ (Node::Acceleration { .. } | Node::Aux { .. }) => {
                (self.names.leaf(leaf), Strength::Operand)
            }
        }
    }

    fn write_binary(&self, op: Op, a: NodeId, b: NodeId) -> (String, Strength) {
        use Strength::{And, Comparison, Negation, Operand, Or, Power, Product, Sum};
        let is_constant = |id| self.graph.constant(id).is_some();
        let (a, b) = match op {
            Op::Mul if is_constant(b) => (b, a),
            Op::Add | Op::Eq | Op::Ne if is_constant(a) => (b, a),
            _ => (a, b),
        };
        let (sign, own, left, right) = match op {
            Op::Add => (" + ", Sum, Sum, self.associated(op, b, Product)),
            Op::Sub => (" - ", Sum, Sum, Product),
            Op::Mul => ("*", Product, Product, self.associated(op, b, Power)),
            Op::Div => ("/", Product, Product, Power),
            Op::Powi | Op::Pow => ("^", Power, Operand, Negation),
            Op::Lt => (" < ", Comparison, Sum, Sum),
            Op::Le => (" <= ", Comparison, Sum, Sum),
            Op::Eq => (" == ", Comparison, Sum, Sum),
            Op::Ne => (" != ", Comparison, Sum, Sum),
            Op::And => (" and ", And, And, And),
            Op::Or => (" or ", Or, Or, Or),
            _ => return (format!("{}({}, {})", op.name(), self.text(a), self.text(b)), Operand),
        };
        if let Some(text) = self.about_agents(op, a, b) {
            return (text, Comparison);
        }
        if op == Op::Mul && [a, b].iter().any(|&id| self.graph.constant(id).is_some_and(|k| k < 0.0)) {
            let (k, rest) = if is_constant(a) { (a, b) } else { (b, a) };
            let k = self.graph.constant(k).map_or(String::new(), constant);
            return (format!("{k}*{}", self.operand(rest, Product)), Negation);
        }
        if matches!(op, Op::Pow | Op::Powi) {
            let exponent = if is_constant(b) { Negation } else { Operand };
            return (format!("{}^{}", self.operand(a, Operand), self.operand(b, exponent)), Power);
        }
        (format!("{}{sign}{}", self.operand(a, left), self.operand(b, right)), own)
    }

    /// The least strength of a right operand: `a + (b + c)` and `a*(b*c)` need no brackets to be read.
    fn associated(&self, op: Op, right: NodeId, otherwise: Strength) -> Strength {
        match self.graph.node(right) {
            Node::Binary(inner, ..) if inner == op => Strength::Choice,
            _ => otherwise,
        }
    }

    /// `o is Drive` for a test of the mode column, `lead` for "the link is not none".
    fn about_agents(&self, op: Op, a: NodeId, b: NodeId) -> Option<String> {
        let column = |id| match self.graph.node(id) {
            Node::Aux { slot, column } => Some((slot, column as usize)),
            _ => None,
        };
        match op {
            Op::Le if self.graph.is_zero(a) => {
                let (slot, at) = column(b)?;
                let layout = &self.names.agent(slot).layout;
                (layout.link(0)..layout.received(0)).contains(&at).then(|| self.names.aux(slot, at as u32))
            }
            Op::Eq => {
                let (slot, k) = match (column(a), column(b)) {
                    (Some((slot, Layout::MODE)), _) => (slot, self.graph.constant(b)?),
                    (_, Some((slot, Layout::MODE))) => (slot, self.graph.constant(a)?),
                    _ => return None,
                };
                let mode = self.names.agent(slot).modes.get(k as usize).map(|mode| mode.path.clone());
                let mode = mode.filter(|path| !path.is_empty()).unwrap_or_else(|| format!("mode {k}"));
                Some(format!("{} is {mode}", self.names.frame.slots[slot as usize].name()))
            }
            _ => None,
        }
    }
}

/// The comparison `g relation 0` on one line, with `...` for what is too large.
pub fn short_comparison(graph: &Graph, names: Names, relation: Relation, g: NodeId) -> String {
    without_names(Sheet::new(graph, names, &[g]).comparison(relation, g))
}

/// An expression on one line, with `...` for what is too large in it.
pub fn short(graph: &Graph, names: Names, id: NodeId) -> String {
    without_names(Sheet::new(graph, names, &[id]).definition(id))
}

/// The same as a side of a comparison.
pub fn short_side(graph: &Graph, names: Names, id: NodeId) -> String {
    let (text, strength) = Sheet::new(graph, names, &[id]).write(id);
    without_names(if strength < Strength::Sum { format!("({text})") } else { text })
}

fn without_names(mut text: String) -> String {
    while let Some(at) = text.find('@') {
        let end = text[at + 1..].find(|c: char| !c.is_ascii_digit()).map_or(text.len(), |k| at + 1 + k);
        text.replace_range(at..end, "...");
    }
    text
}
