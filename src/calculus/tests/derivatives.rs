//! Are the derivatives of every operator those of its values? Checked against central differences.

use crate::calculus::build;
use crate::calculus::derive;
use crate::calculus::draft::Draft;
use crate::calculus::evaluate;
use crate::calculus::frame::Scope;
use crate::calculus::graph::{Graph, Node, NodeId};
use crate::calculus::tests::random::{self, Random};
use crate::math::Op;
use crate::model::ir::TypeId;

/// States, their rates, their second rates; auxiliary columns; the time.
struct Motion {
    rows: [[f64; 3]; 3],
    aux: f64,
    time: f64,
}

impl Motion {
    fn random(random: &mut Random, low: f64, high: f64) -> Self {
        let mut row = |low, high| [(); 3].map(|()| random.real(low, high));
        let rows = [row(low, high), row(-1.0, 1.0), row(-1.0, 1.0)];
        Self { rows, aux: random.real(low, high), time: random.real(low, high) }
    }

    /// `order`: 0 for a state, 1 for its rate, 2 for its second rate; all moved on by `h`.
    fn leaf(&self, node: Node, h: f64) -> f64 {
        let at = |order: usize, column: u32| {
            let column = column as usize;
            match order {
                0 => self.rows[0][column] + h * self.rows[1][column] + h * h / 2.0 * self.rows[2][column],
                1 => self.rows[1][column] + h * self.rows[2][column],
                _ => self.rows[2][column],
            }
        };
        match node {
            Node::State { column, .. } => at(0, column),
            Node::Rate { column, .. } => at(1, column),
            Node::Acceleration { column, .. } => at(2, column),
            Node::Aux { .. } => self.aux,
            Node::Time => self.time + h,
            node => panic!("{node:?} is no leaf"),
        }
    }

    fn value(&self, graph: &Graph, id: NodeId, h: f64) -> f64 {
        evaluate::values(graph, &[id], &mut |node| self.leaf(node, h))[0]
    }

    /// The rate of `u`, by central differences; none near a kink, a jump or a pole.
    fn difference(&self, graph: &Graph, u: NodeId) -> Option<f64> {
        let slope = |h: f64| (self.value(graph, u, h) - self.value(graph, u, -h)) / (2.0 * h);
        let sides = |h: f64| {
            let middle = self.value(graph, u, 0.0);
            [(self.value(graph, u, h) - middle) / h, (middle - self.value(graph, u, -h)) / h]
        };
        let (fine, coarse) = (slope(1e-6), slope(1e-5));
        let [right, left] = sides(1e-6);
        let scale = 1.0 + fine.abs() + self.value(graph, u, 0.0).abs();
        let regular = (fine - coarse).abs() < 1e-4 * scale && (right - left).abs() < 1e-3 * scale;
        (fine.is_finite() && scale < 1e4 && regular).then_some(fine)
    }
}

fn close(expected: f64, found: f64) -> bool {
    (expected - found).abs() <= 1e-4 * (1.0 + expected.abs() + found.abs())
}

/// Checks first rate, second rate and gradient; the number of comparisons made.
fn check(graph: &mut Graph, u: NodeId, motion: &Motion) -> usize {
    let [first, second] = derive::rates(graph, u);
    let parts = graph.reach(&[u, first, second]);
    if evaluate::values(graph, &parts, &mut |node| motion.leaf(node, 0.0)).iter().any(|x| !x.is_finite()) {
        return 0;
    }
    let mut compared = 0;
    for (of, derivative) in [(u, first), (first, second)] {
        if let Some(expected) = motion.difference(graph, of) {
            let found = motion.value(graph, derivative, 0.0);
            assert!(close(expected, found), "{:?}: {expected} {found}", graph.nodes());
            compared += 1;
        }
    }
    let whole = motion.value(graph, first, 0.0);
    if whole.is_finite() && whole.abs() < 1e6 {
        let mut sum = 0.0;
        for (leaf, partial) in derive::gradient(graph, u) {
            let rate = match leaf {
                Node::State { column, .. } => motion.rows[1][column as usize],
                _ => 1.0,
            };
            sum += motion.value(graph, partial, 0.0) * rate;
        }
        assert!(close(whole, sum), "reverse {sum}, forward {whole}: {:?}", graph.nodes());
    }
    compared
}

#[test]
fn rates_and_gradients_of_every_operator_match_differences() {
    let mut random = Random(3);
    for &op in Op::ALL.iter().filter(|op| !op.is_boolean()) {
        let mut compared = 0;
        for k in 0..300 {
            let mut graph = Graph::default();
            let mut operands: Vec<NodeId> =
                (0..op.arity() as u32).map(|column| graph.intern(Node::State { slot: 0, column })).collect();
            if op == Op::Powi {
                operands[1] = graph.number([-2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 7.0][k % 7]);
            }
            if op == Op::Select {
                operands[0] = graph.binary(Op::Lt, operands[1], operands[2]);
            }
            let u = graph.apply(op, &operands);
            let (low, high) = [(0.1, 0.9), (1.1, 3.0), (-0.9, 0.9), (-3.0, 3.0)][k % 4];
            compared += check(&mut graph, u, &Motion::random(&mut random, low, high));
        }
        assert!(compared > 150, "{} was compared {compared} times only", op.name());
    }
}

#[test]
fn rates_of_random_expressions_match_differences() {
    let mut random = Random(4);
    let ops = random::numeric_ops();
    let mut compared = 0;
    for _ in 0..3000 {
        let mut model = random::model();
        let depth = 2 + random.below(2);
        let expr = random::number(&mut model, &mut random, &ops, depth);
        let mut draft = Draft::new(&model);
        let mut scope = Scope::of_self(TypeId::new(0));
        let u = build::number(&mut draft, &mut scope, Scope::TOP, expr).expect("no quantifiers");
        compared += check(&mut draft.graph, u, &Motion::random(&mut random, -1.5, 1.5));
    }
    assert!(compared > 2500, "only {compared}");
}

#[test]
fn derivatives_are_finite_where_the_true_ones_are() {
    let mut graph = Graph::default();
    let [x, y] = [0, 1].map(|column| graph.intern(Node::State { slot: 0, column }));
    let (three, absent) = (graph.number(3.0), graph.number(f64::NAN));
    let motion = Motion { rows: [[0.0; 3], [1.0; 3], [0.0; 3]], aux: 0.0, time: 0.0 };
    for (op, operands, expected) in [
        (Op::Powi, vec![x, three], 0.0),
        (Op::Pow, vec![x, three], 0.0),
        (Op::Tanh, vec![x], 1.0),
        (Op::Sinh, vec![x], 1.0),
        (Op::Sqrt, vec![x], f64::INFINITY),
    ] {
        let u = graph.apply(op, &operands);
        let [first, _] = derive::rates(&mut graph, u);
        assert_eq!(motion.value(&graph, first, 0.0), expected, "{}", op.name());
    }
    // What the branch that is not taken cannot compute does not reach the derivative.
    let condition = graph.binary(Op::Lt, x, y);
    let (product, root) = (graph.binary(Op::Mul, x, absent), graph.unary(Op::Sqrt, x));
    let product = graph.binary(Op::Mul, product, root);
    let u = graph.select(condition, product, y);
    let [first, second] = derive::rates(&mut graph, u);
    assert_eq!(motion.value(&graph, first, 0.0), 1.0);
    assert_eq!(motion.value(&graph, second, 0.0), 0.0);
    for (_, partial) in derive::gradient(&mut graph, u) {
        assert!(motion.value(&graph, partial, 0.0).is_finite());
    }
}

#[test]
fn the_second_rate_of_what_reads_a_rate_is_unknown() {
    let mut graph = Graph::default();
    let rate = graph.intern(Node::Rate { slot: 0, column: 0 });
    let two = graph.number(2.0);
    let g = graph.binary(Op::Sub, rate, two);
    let [first, second] = derive::rates(&mut graph, g);
    assert_eq!(graph.node(first), Node::Acceleration { slot: 0, column: 0 });
    assert!(graph.constant(second).is_some_and(f64::is_nan));
}
