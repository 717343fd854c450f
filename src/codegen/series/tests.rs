//! Are the coefficients those of the solution? Checked against repeated total derivatives of the rates, which are symbolic
//! and of another making; and lane by lane against one agent alone, to the bit.

use rustc_hash::FxHashMap;

use crate::calculus::derive;
use crate::calculus::evaluate;
use crate::calculus::graph::{Graph, Node, NodeId};
use crate::codegen::kernel::AgentView;
use crate::codegen::series::{NoSeries, SeriesTape, record};
use crate::codegen::{interpret, tape};
use crate::math::{N_LANES, Op, Wide};

const N_STATES: usize = 3;
const N_AUX: usize = 3;

/// A generator of uniform numbers (xorshift64*).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    fn real(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next() as f64 / (1_u64 << 53) as f64
    }
}

/// Where an agent is.
#[derive(Clone, Debug)]
struct Point {
    time: f64,
    states: [f64; N_STATES],
    aux: [f64; N_AUX],
}

impl Point {
    /// Anywhere between two numbers; the last auxiliary column is a lock.
    fn random(random: &mut Random, low: f64, high: f64) -> Self {
        let mut real = || random.real(low, high);
        let (time, states, mut aux) = (real(), [(); N_STATES].map(|()| real()), [(); N_AUX].map(|()| real()));
        aux[N_AUX - 1] = (random.below(2)) as f64;
        Self { time, states, aux }
    }

    fn leaf(&self, node: Node) -> f64 {
        match node {
            Node::Time => self.time,
            Node::State { column, .. } => self.states[column as usize],
            Node::Aux { column, .. } => self.aux[column as usize],
            node => panic!("{node:?} is no leaf of a flow"),
        }
    }

    fn views(&self) -> [AgentView<'_>; 1] {
        [AgentView { states: &self.states, rates: &[], accelerations: &[], aux: &self.aux }]
    }
}

fn state(graph: &mut Graph, column: u32) -> NodeId {
    graph.intern(Node::State { slot: 0, column })
}

fn aux(graph: &mut Graph, column: u32) -> NodeId {
    graph.intern(Node::Aux { slot: 0, column })
}

/// The coefficients of all states: a row for each.
fn coefficients(series: &SeriesTape, at: &Point, order: usize) -> Vec<Vec<f64>> {
    let mut fixed = vec![f64::NAN; series.fixed.len()];
    let mut rows = vec![f64::NAN; series.n_coefficients(order)];
    series.fix(|_, column| at.aux[column as usize], &mut fixed);
    series.expand(at.time, &at.states, &fixed, order, &mut rows);
    rows.chunks_exact(order + 1).take(series.n_states).map(<[f64]>::to_vec).collect()
}

/// The total derivative of `u` along the flow.
fn total_derivative(graph: &mut Graph, u: NodeId, rates: &[NodeId]) -> NodeId {
    let formal = derive::along_flow(graph, u);
    let mut new: FxHashMap<NodeId, NodeId> = FxHashMap::default();
    for id in graph.reach(&[formal]) {
        let made = match graph.node(id) {
            Node::Rate { column, .. } => rates[column as usize],
            Node::Unary(op, a) => graph.unary(op, new[&a]),
            Node::Binary(op, a, b) => graph.binary(op, new[&a], new[&b]),
            Node::Select(a, b, c) => graph.select(new[&a], new[&b], new[&c]),
            _ => id,
        };
        new.insert(id, made);
    }
    new[&formal]
}

/// Compares the coefficients up to `order` with the derivatives; how many could be compared.
fn check(graph: &mut Graph, rates: &[NodeId], at: &Point, order: usize, tolerance: f64) -> usize {
    let series = record(graph, rates).expect("a smooth flow has a series");
    let found = coefficients(&series, at, order);
    let mut compared = 0;
    for (column, &rate) in rates.iter().enumerate() {
        assert_eq!(found[column][0], at.states[column]);
        let (mut derivative, mut factorial) = (rate, 1.0);
        let mut size: f64 = 1.0;
        for (k, &c) in found[column].iter().enumerate().skip(1) {
            factorial *= k as f64;
            let nodes = graph.reach(&[derivative]);
            let values = evaluate::values(graph, &nodes, &mut |node| at.leaf(node));
            // What the formula goes through says how exact it can be.
            let largest = values.iter().fold(1.0_f64, |largest, value| largest.max(value.abs()));
            if !values.iter().all(|value| value.is_finite()) || largest > 1e9 {
                break;
            }
            let expected = values[values.len() - 1] / factorial;
            size = size.max(expected.abs()).max(c.abs());
            let off = (expected - c).abs();
            assert!(
                off <= tolerance * size.max(largest / factorial),
                "state {column}, coefficient {k}: {c:?} is not {expected:?} at {at:?}\n{series}"
            );
            compared += 1;
            derivative = total_derivative(graph, derivative, rates);
        }
    }
    compared
}

/// The operators that have a recurrence.
fn smooth_ops() -> Vec<Op> {
    let jumps = [Op::Abs, Op::Sign, Op::Min, Op::Max, Op::Floor, Op::Ceil, Op::Round, Op::Trunc, Op::Mod];
    let smooth = |op: &Op| !op.is_boolean() && !jumps.contains(op);
    Op::ALL.iter().copied().filter(smooth).collect()
}

#[test]
fn coefficients_of_every_operator_match_repeated_derivatives() {
    let mut random = Random(11);
    // Among them where arc sines, roots, logarithms and angles are near their ends.
    let boxes = [(0.1, 0.9), (1.1, 3.0), (-0.9, 0.9), (-3.0, 3.0), (0.01, 0.05), (0.93, 0.97), (-8.0, -2.0)];
    for op in smooth_ops() {
        let mut compared = 0;
        for k in 0..140 {
            let mut graph = Graph::default();
            let mut operands: Vec<NodeId> =
                (0..op.arity() as u32).map(|column| state(&mut graph, column)).collect();
            // Both move, or one of them.
            if op.arity() > 1 && k % 3 > 0 {
                operands[k % 3 - 1] = aux(&mut graph, 0);
            }
            if op == Op::Powi {
                operands = vec![
                    state(&mut graph, 0),
                    graph.number([-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 6.0, 7.0, 11.0][k % 10]),
                ];
            }
            if op == Op::Select {
                operands[0] = aux(&mut graph, N_AUX as u32 - 1);
                operands[1] = state(&mut graph, 1);
            }
            let u = graph.apply(op, &operands);
            let (x, y, time) = (state(&mut graph, 0), state(&mut graph, 1), graph.intern(Node::Time));
            let turning = graph.unary(Op::Cos, time);
            let minus = graph.unary(Op::Neg, x);
            let product = graph.binary(Op::Mul, y, turning);
            let rates = [u, graph.binary(Op::Add, minus, product), graph.binary(Op::Sub, y, x)];
            let (low, high) = boxes[k % boxes.len()];
            compared += check(&mut graph, &rates, &Point::random(&mut random, low, high), 7, 1e-9);
        }
        assert!(compared > 700, "{}: {compared} comparisons", op.name());
    }
}

/// A random expression; nothing in it jumps.
fn expression(graph: &mut Graph, random: &mut Random, ops: &[Op], depth: usize) -> NodeId {
    if depth == 0 {
        return match random.below(8) {
            0 => graph.number([0.5, 1.0, 2.0, -1.5][random.below(4)]),
            1 => graph.intern(Node::Time),
            2 => aux(graph, random.below(2) as u32),
            _ => state(graph, random.below(N_STATES) as u32),
        };
    }
    let op = ops[random.below(ops.len())];
    let mut operands: Vec<NodeId> =
        (0..op.arity()).map(|_| expression(graph, random, ops, depth - 1)).collect();
    match op {
        Op::Powi => operands[1] = graph.number([-2.0, -1.0, 2.0, 3.0, 5.0][random.below(5)]),
        Op::Select => operands[0] = aux(graph, N_AUX as u32 - 1),
        _ => {}
    }
    graph.apply(op, &operands)
}

fn random_flow(random: &mut Random, depth: usize) -> (Graph, Vec<NodeId>) {
    let mut graph = Graph::default();
    let rates = (0..N_STATES).map(|_| expression(&mut graph, random, &smooth_ops(), depth)).collect();
    (graph, rates)
}

#[test]
fn coefficients_of_random_flows_match_repeated_derivatives() {
    let mut random = Random(12);
    let mut compared = 0;
    for _ in 0..400 {
        let depth = 1 + random.below(2);
        let (mut graph, rates) = random_flow(&mut random, depth);
        compared += check(&mut graph, &rates, &Point::random(&mut random, -1.5, 1.5), 4, 1e-8);
    }
    assert!(compared > 2500, "only {compared}");
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

#[test]
fn the_first_coefficient_is_the_rate_to_the_bit() {
    let mut random = Random(13);
    for _ in 0..1000 {
        let depth = 1 + random.below(4);
        let (graph, rates) = random_flow(&mut random, depth);
        let at = Point::random(&mut random, -2.0, 2.0);
        let series = record(&graph, &rates).expect("a smooth flow has a series");
        let tape = tape::record(&graph, &rates);
        let mut registers = vec![0.0; tape.n_registers];
        let mut expected = [0.0; N_STATES];
        interpret::run(&tape, &at.views()[..], at.time, &mut registers, &mut expected);
        for (row, expected) in coefficients(&series, &at, 1).iter().zip(expected) {
            assert!(same(row[1], expected), "{} is not {expected} at {at:?}\n{tape}\n{series}", row[1]);
        }
    }
}

#[test]
fn a_lane_has_the_bits_that_its_agent_has_alone() {
    let mut random = Random(14);
    for round in 0..200 {
        let depth = 1 + random.below(4);
        let (graph, rates) = random_flow(&mut random, depth);
        let series = record(&graph, &rates).expect("a smooth flow has a series");
        let order = 1 + round % 16;
        let points: Vec<Point> = (0..N_LANES).map(|_| Point::random(&mut random, -2.0, 2.0)).collect();
        let wide = |of: &dyn Fn(&Point) -> f64| Wide(std::array::from_fn(|lane| of(&points[lane])));
        let nothing = Wide([f64::NAN; N_LANES]);
        let (mut fixed, mut rows) =
            (vec![nothing; series.fixed.len()], vec![nothing; series.n_coefficients(order)]);
        series.fix_wide(|_, column| wide(&|point| point.aux[column as usize]), &mut fixed);
        let states: Vec<Wide> = (0..N_STATES).map(|column| wide(&|point| point.states[column])).collect();
        series.expand_wide(wide(&|point| point.time), &states, &fixed, order, &mut rows);
        for (lane, point) in points.iter().enumerate() {
            let alone = coefficients(&series, point, order).concat();
            for (k, (alone, together)) in alone.iter().zip(&rows).enumerate() {
                assert!(same(*alone, together.0[lane]), "number {k} of lane {lane} at {point:?}\n{series}");
            }
        }
    }
}

#[test]
fn what_does_not_move_and_what_ends_costs_little() {
    let mut graph = Graph::default();
    let [w, p] = [0, 1].map(|column| aux(&mut graph, column));
    let time = graph.intern(Node::Time);
    let phase = graph.binary(Op::Mul, w, time);
    let phase = graph.binary(Op::Add, phase, p);
    let wave = graph.unary(Op::Sin, phase);
    let (speed, height) = (state(&mut graph, 1), state(&mut graph, 2));
    let falling = graph.number(-9.81);
    // x' = sin(w t + p), v' = -9.81, h' = v: the last two are polynomials, and nothing waits for itself.
    let rates = [wave, falling, speed];
    let series = record(&graph, &rates).expect("a smooth flow has a series");
    assert_eq!(series.lengths[..N_STATES], [u32::MAX, 2, 3]);
    assert_eq!(series.cycle.len(), 0);
    let at = Point { time: 0.5, states: [1.0, 2.0, 3.0], aux: [0.7, 0.1, 0.0] };
    let found = coefficients(&series, &at, 9);
    assert_eq!(found[1], [2.0, -9.81, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(found[2], [3.0, 2.0, -9.81 / 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(series.operations(9) < 80, "{}", series.operations(9));
    let _ = height;
}

#[test]
fn what_jumps_has_no_series_and_says_so() {
    let mut graph = Graph::default();
    let [x, y] = [0, 1].map(|column| state(&mut graph, column));
    let foreign = graph.intern(Node::State { slot: 1, column: 0 });
    let (below, one) = (graph.binary(Op::Le, x, y), graph.number(1.0));
    for (rate, reason) in [
        (graph.unary(Op::Abs, x), NoSeries::Jumps(Op::Abs)),
        (graph.binary(Op::Max, x, y), NoSeries::Jumps(Op::Max)),
        (graph.select(below, x, one), NoSeries::Jumps(Op::Le)),
        (graph.binary(Op::Mul, below, x), NoSeries::Jumps(Op::Le)),
        (graph.binary(Op::Mul, foreign, x), NoSeries::ReadsOthers),
    ] {
        assert_eq!(record(&graph, &[rate]), Err(reason));
    }
}
