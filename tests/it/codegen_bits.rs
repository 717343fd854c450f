//! Do all back ends give the bits of `Op::eval`, and do bounds contain them?

use hyc::calculus::graph::{Graph, Node, NodeId};
use hyc::calculus::system::{Function, FunctionId, System};
use hyc::codegen::kernel::{AgentBox, AgentView};
use hyc::codegen::{Backend, compile};
use hyc::math::runge_kutta::TSIT5;
use hyc::math::{Interval, Op};

use crate::codegen_systems::{AWKWARD, Dice, N_COLUMNS, N_SLOTS, bare, bumper, random_functions, with_flow};

/// Rows of all agents: states, rates, accelerations, aux.
type Rows<T> = [[Vec<T>; 4]; N_SLOTS];

fn rows<T>(mut value: impl FnMut() -> T) -> Rows<T> {
    std::array::from_fn(|_| std::array::from_fn(|_| (0..N_COLUMNS).map(|_| value()).collect()))
}

fn views(rows: &Rows<f64>) -> [AgentView<'_>; N_SLOTS] {
    std::array::from_fn(|slot| {
        let [states, rates, accelerations, aux] = &rows[slot];
        AgentView { states, rates, accelerations, aux }
    })
}

/// The meaning of every node, straight from the graph.
fn direct(graph: &Graph, rows: &Rows<f64>, time: f64) -> Vec<f64> {
    let mut values: Vec<f64> = Vec::new();
    for node in graph.nodes() {
        let at = |id: NodeId| values[id.index()];
        let column = |slot: u32, row: usize, column: u32| rows[slot as usize][row][column as usize];
        values.push(match *node {
            Node::Constant(bits) => f64::from_bits(bits),
            Node::Time => time,
            Node::State { slot, column: c } => column(slot, 0, c),
            Node::Rate { slot, column: c } => column(slot, 1, c),
            Node::Acceleration { slot, column: c } => column(slot, 2, c),
            Node::Aux { slot, column: c } => column(slot, 3, c),
            Node::Unary(op, a) => op.eval([at(a), 0.0, 0.0]),
            Node::Binary(op, a, b) => op.eval([at(a), at(b), 0.0]),
            Node::Select(a, b, c) => Op::Select.eval([at(a), at(b), at(c)]),
        });
    }
    values
}

/// Equal bits; the sign and payload of a NaN cannot be observed.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

#[test]
fn both_back_ends_give_the_bits_of_the_operators() {
    let mut dice = Dice(0x9e37_79b9_7f4a_7c15);
    for _ in 0..40 {
        let (graph, functions) = random_functions(&mut dice, 120);
        let system = bare(graph, functions);
        let programs =
            [Backend::Interpreter, Backend::Jit].map(|back| compile(system.clone(), back).unwrap());
        for _ in 0..60 {
            let mut value = || if dice.below(3) > 0 { dice.pick(AWKWARD) } else { 4.0 * dice.real() };
            let (rows, time) = (rows(&mut value), value());
            let expected = direct(&system.graph, &rows, time);
            for (function, program) in
                (0..system.functions.len()).flat_map(|f| programs.iter().map(move |p| (f, p)))
            {
                let function = FunctionId::new(function);
                let outputs = &system.functions[function].outputs;
                let mut out = vec![0.0; outputs.len()];
                program.kernel(function).eval(&views(&rows), time, &mut out);
                for (&node, got) in outputs.iter().zip(out) {
                    let want = expected[node.index()];
                    let what = system.graph.node(node);
                    let compiled = program.kernel(function).is_compiled();
                    assert!(same(want, got), "{what:?} is {want:e}, got {got:e}, compiled: {compiled}");
                }
            }
        }
    }
}

#[test]
fn every_operator_alone_agrees_on_all_awkward_operands() {
    for &op in Op::ALL {
        let mut graph = Graph::default();
        let [a, b, c] = [0, 1, 2].map(|column| graph.intern(Node::State { slot: 0, column }));
        let node = match op.arity() {
            1 => Node::Unary(op, a),
            2 => Node::Binary(op, a, b),
            _ => Node::Select(a, b, c),
        };
        let outputs = vec![graph.intern(node)];
        let functions = [Function { name: op.name().to_owned(), outputs }].into_iter().collect();
        let program = compile(bare(graph, functions), Backend::Jit).unwrap();
        for &a in AWKWARD {
            for &b in AWKWARD {
                let mut got = [0.0];
                let view = AgentView { states: &[a, b, 0.25], rates: &[], accelerations: &[], aux: &[] };
                program.kernels[0].eval(&[view], 0.0, &mut got);
                let want = op.eval([a, b, 0.25]);
                assert!(same(want, got[0]), "{} of {a:e} and {b:e} is {want:e}, got {:e}", op.name(), got[0]);
            }
        }
    }
}

#[test]
fn bounds_contain_the_values_of_every_member() {
    let mut dice = Dice(0x1234_5678_9abc_def1);
    let mut bounded = 0;
    for _ in 0..60 {
        let (graph, functions) = random_functions(&mut dice, 60);
        let program = compile(bare(graph, functions), Backend::Jit).unwrap();
        let kernel = &program.kernels[0];
        let width = dice.pick(&[0.0, 1e-9, 0.1, 3.0]);
        let mut interval = || {
            let lo = 3.0 * dice.real();
            Interval::new(lo, lo + width)
        };
        let (boxes, time) = (rows(&mut interval), interval());
        let aux: [Vec<f64>; N_SLOTS] = std::array::from_fn(|_| (0..N_COLUMNS).map(|_| dice.real()).collect());
        let slots: [AgentBox<'_>; N_SLOTS] = std::array::from_fn(|slot| {
            let [states, rates, accelerations, _] = &boxes[slot];
            AgentBox { states, rates, accelerations, aux: &aux[slot] }
        });
        let mut bounds = vec![Interval::ZERO; kernel.n_outputs()];
        kernel.range(&slots, time, &mut Vec::new(), &mut bounds);
        bounded += bounds.iter().filter(|bound| !bound.is_whole()).count();
        for _ in 0..30 {
            let mut inside = |of: Interval| match dice.below(4) {
                0 => of.lo,
                1 => of.hi,
                _ => (of.lo + (of.hi - of.lo) * dice.real().abs()).clamp(of.lo, of.hi),
            };
            let mut sample: Rows<f64> = std::array::from_fn(|slot| {
                std::array::from_fn(|row| boxes[slot][row].iter().map(|&of| inside(of)).collect())
            });
            sample.iter_mut().zip(&aux).for_each(|(agent, aux)| agent[3].clone_from(aux));
            let mut out = vec![0.0; kernel.n_outputs()];
            kernel.eval(&views(&sample), inside(time), &mut out);
            for (k, (bound, value)) in bounds.iter().zip(out).enumerate() {
                let contained = bound.is_whole() || bound.lo <= value && value <= bound.hi;
                assert!(contained, "output {k}: {value:e} is not in {bound:?}");
            }
        }
    }
    assert!(bounded > 1000, "only {bounded} bounds say anything");
}

/// Rates at a state and a time.
type Rates<'a> = dyn Fn(&[f64], f64, &mut [f64]) + 'a;

/// A step as the formula says: the new states and the errors.
fn plain_step(rates: &Rates<'_>, x: &[f64], time: f64, h: f64, k: &mut [f64]) -> (Vec<f64>, Vec<f64>) {
    let n = x.len();
    let combine = |k: &[f64], weights: &[f64], i: usize| {
        let terms = weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
        h * terms
            .map(|(s, weight)| weight * k[s * n + i])
            .reduce(|sum, term| sum + term)
            .expect("a weight is not 0")
    };
    let mut stage = Vec::new();
    for s in 1..7 {
        stage = (0..n).map(|i| x[i] + combine(k, &TSIT5.a[s], i)).collect();
        rates(&stage, time + TSIT5.c[s] * h, &mut k[s * n..(s + 1) * n]);
    }
    let err = (0..n).map(|i| combine(k, &TSIT5.error, i)).collect();
    (stage, err)
}

fn check_steps(system: System, dice: &mut Dice, rounds: usize) {
    let [interpreted, compiled] =
        [Backend::Interpreter, Backend::Jit].map(|back| compile(system.clone(), back).expect("it compiles"));
    assert!(interpreted.steps[0][0].is_none());
    let step = compiled.steps[0][0].as_ref().expect("the flow reads no foreign state");
    let n = step.n_states();
    let mut value = || if dice.below(12) == 0 { dice.pick(AWKWARD) } else { 2.0 * dice.real() };
    for _ in 0..rounds {
        let x: Vec<f64> = (0..n).map(|_| value()).collect();
        let aux: Vec<f64> = (0..8).map(|_| value()).collect();
        let (time, h) = (value(), 0.1 * value());
        let rates = |x: &[f64], time: f64, out: &mut [f64]| {
            let view = AgentView { states: x, rates: &[], accelerations: &[], aux: &aux };
            interpreted.kernels[0].eval(&[view], time, out);
        };
        let mut k = vec![0.0; 7 * n];
        rates(&x, time, &mut k[..n]);
        let mut k_step = k.clone();
        let (x_new, err) = plain_step(&rates, &x, time, h, &mut k);
        let (mut x_got, mut err_got) = (vec![0.0; n], vec![0.0; n]);
        let view = AgentView { states: &x, rates: &[], accelerations: &[], aux: &aux };
        step.step(&[view], time, h, &mut k_step, &mut x_got, &mut err_got);
        let want = k.iter().chain(&x_new).chain(&err);
        let got = k_step.iter().chain(&x_got).chain(&err_got);
        assert!(want.zip(got).all(|(&want, &got)| same(want, got)));
    }
}

#[test]
fn a_whole_step_has_the_bits_of_its_formula() {
    let mut dice = Dice(0xdead_beef_0bad_cafe);
    check_steps(bumper(), &mut dice, 200);
    for _ in 0..20 {
        let (mut graph, functions) = random_functions(&mut dice, 40);
        // Rates may read states, time and auxiliary columns of slot 0.
        let outputs = functions[hyc::base::Idx::new(0)].outputs.iter().copied();
        let allowed = outputs.filter(|&node| reads_slot_zero_only(&graph, node)).collect::<Vec<_>>();
        let first = graph.intern(Node::State { slot: 0, column: 0 });
        let rates = (0..N_COLUMNS).map(|i| allowed.iter().rev().nth(i).copied().unwrap_or(first)).collect();
        check_steps(with_flow(graph, rates), &mut dice, 30);
    }
}

fn reads_slot_zero_only(graph: &Graph, node: NodeId) -> bool {
    let mut pending = vec![node];
    while let Some(node) = pending.pop() {
        match graph.node(node) {
            Node::Constant(_) | Node::Time => {}
            Node::State { slot, .. } | Node::Aux { slot, .. } if slot == 0 => {}
            Node::State { .. } | Node::Aux { .. } | Node::Rate { .. } | Node::Acceleration { .. } => {
                return false;
            }
            Node::Unary(_, a) => pending.push(a),
            Node::Binary(_, a, b) => pending.extend([a, b]),
            Node::Select(a, b, c) => pending.extend([a, b, c]),
        }
    }
    true
}
