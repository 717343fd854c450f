//! Systems of equations written by hand or at random, for the tests of code generation.

use hyc::base::{Arena, Span};
use hyc::calculus::graph::{Graph, Node, NodeId};
use hyc::calculus::system::*;
use hyc::math::Op;

/// A generator of pseudo-random numbers (xorshift).
pub struct Dice(pub u64);

impl Dice {
    /// A number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % n
    }

    /// One of these.
    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }

    /// A number in [-1, 1).
    pub fn real(&mut self) -> f64 {
        self.below(1 << 50) as f64 / (1u64 << 49) as f64 - 1.0
    }
}

/// Numbers at which operators are apt to differ.
pub const AWKWARD: &[f64] = &[
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    2.0,
    -2.5,
    3.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MIN_POSITIVE,
    5e-324,
    -1e-310,
    1e300,
    -1e300,
    f64::MAX,
    f64::EPSILON,
    1.0 + f64::EPSILON,
    std::f64::consts::PI,
    -std::f64::consts::FRAC_PI_2,
    0.49999999999999994,
    4503599627370497.5,
    1e22,
    -7.0,
    709.8,
    -745.2,
];

/// Exponents of `Powi`, some of them no integers.
const EXPONENTS: &[f64] =
    &[0.0, 1.0, -1.0, 2.0, -2.0, 3.0, 5.0, -7.0, 16.0, 31.0, 2.5, 1e10, -0.0, -2147483648.0];

/// Slots and columns of the agents that random functions read.
pub const N_SLOTS: usize = 3;
/// See [`N_SLOTS`].
pub const N_COLUMNS: usize = 4;

/// A random expression graph over all leaves and operators; every node is an output of one of two functions.
pub fn random_functions(dice: &mut Dice, n_nodes: usize) -> (Graph, Arena<Function>) {
    let mut graph = Graph::default();
    let mut nodes = leaves(&mut graph, dice);
    for _ in 0..n_nodes {
        let op = dice.pick(Op::ALL);
        let [a, b, c] = [dice.pick(&nodes), dice.pick(&nodes), dice.pick(&nodes)];
        let node = match op.arity() {
            1 => Node::Unary(op, a),
            2 if op == Op::Powi && dice.below(8) > 0 => {
                let exponent = graph.intern(Node::Constant(dice.pick(EXPONENTS).to_bits()));
                Node::Binary(op, a, exponent)
            }
            2 => Node::Binary(op, a, b),
            _ => Node::Select(a, b, c),
        };
        nodes.push(graph.intern(node));
    }
    let few = (0..3).map(|_| dice.pick(&nodes)).collect();
    let functions = [("all", nodes), ("few", few)];
    let functions = functions.map(|(name, outputs)| Function { name: name.to_owned(), outputs });
    (graph, functions.into_iter().collect())
}

fn leaves(graph: &mut Graph, dice: &mut Dice) -> Vec<NodeId> {
    let mut nodes = vec![graph.intern(Node::Time)];
    for _ in 0..6 {
        nodes.push(graph.intern(Node::Constant(dice.pick(AWKWARD).to_bits())));
    }
    for _ in 0..12 {
        let (slot, column) = (dice.below(N_SLOTS) as u32, dice.below(N_COLUMNS) as u32);
        let leaf = match dice.below(4) {
            0 => Node::State { slot, column },
            1 => Node::Rate { slot, column },
            2 => Node::Acceleration { slot, column },
            _ => Node::Aux { slot, column },
        };
        nodes.push(graph.intern(leaf));
    }
    nodes
}

/// A system without agents.
pub fn bare(graph: Graph, functions: Arena<Function>) -> System {
    let (types, interactions) = (Vec::new(), Vec::new());
    System { graph, functions, types, interactions, population: Population::default(), run: Run::default() }
}

/// A system of one agent type with one mode, whose rates are function 0.
pub fn with_flow(graph: Graph, rates: Vec<NodeId>) -> System {
    let n_states = rates.len();
    let mut functions = Arena::new();
    let rates = functions.push(Function { name: "A.Only flow".to_owned(), outputs: rates });
    let slots = vec![Slot::Root { ty: 0, name: "self".to_owned() }];
    let flow = Flow {
        frame: Frame { slots, ..Frame::default() },
        rates,
        accelerations: rates,
        jacobian: Vec::new(),
        jacobian_values: rates,
        kinks: Vec::new(),
        couples: Vec::new(),
        spans: vec![Span::default(); n_states],
    };
    let mode = ModeSystem {
        name: "Only".to_owned(),
        path: "Only".to_owned(),
        parent: None,
        depth: 0,
        initial: None,
        offset: 0,
        history: None,
        active: vec![0],
        flow: Some(flow),
        claims: Vec::new(),
        entry: ActionList::default(),
        exit: ActionList::default(),
        transitions: Vec::new(),
    };
    let column = |i| Column { name: format!("x{i}"), scale: hyc::math::Scale::ONE, boolean: false };
    let agent = AgentSystem {
        name: "A".to_owned(),
        layout: Layout { n_states, n_params: N_COLUMNS, ..Layout::default() },
        states: (0..n_states).map(column).collect(),
        params: (0..N_COLUMNS).map(column).collect(),
        discretes: Vec::new(),
        links: Vec::new(),
        sets: Vec::new(),
        hazards: Vec::new(),
        events: Vec::new(),
        streams: Vec::new(),
        lets: Vec::new(),
        declared: Vec::new(),
        initials: Default::default(),
        modes: vec![mode],
        regions: vec![0],
        transitions: Vec::new(),
    };
    let mut system = bare(graph, functions);
    system.types.push(agent);
    system
}

/// The bumper car: x' = v cos th, y' = v sin th, th' = A w sin(w t + p); v, A, w, p are auxiliary columns 3 to 6.
pub fn bumper() -> System {
    let mut graph = Graph::default();
    let mut aux = |column| graph.intern(Node::Aux { slot: 0, column });
    let [v, amplitude, frequency, phase] = [aux(3), aux(4), aux(5), aux(6)];
    let mut binary = |op, a, b| graph.intern(Node::Binary(op, a, b));
    let gain = binary(Op::Mul, amplitude, frequency);
    let time = graph.intern(Node::Time);
    let turned = graph.intern(Node::Binary(Op::Mul, frequency, time));
    let angle = graph.intern(Node::Binary(Op::Add, turned, phase));
    let heading = graph.intern(Node::State { slot: 0, column: 2 });
    let [cos, sin] = [Op::Cos, Op::Sin].map(|op| graph.intern(Node::Unary(op, heading)));
    let swing = graph.intern(Node::Unary(Op::Sin, angle));
    let factors = [(v, cos), (v, sin), (gain, swing)];
    let rates = factors.map(|(a, b)| graph.intern(Node::Binary(Op::Mul, a, b)));
    with_flow(graph, rates.to_vec())
}
