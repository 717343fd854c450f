//! Does the block interpreter give each of its 32 agents the bits that the others give one?

use hyc::calculus::graph::{Graph, Node};
use hyc::calculus::system::{Function, FunctionId, System};
use hyc::codegen::block::{Block, BlockScratch, BlockStep, BlockView, N_LANES};
use hyc::codegen::kernel::AgentView;
use hyc::codegen::program::Program;
use hyc::codegen::{Backend, compile};
use hyc::math::Op;

use crate::codegen_systems::{AWKWARD, Dice, N_COLUMNS, N_SLOTS, bare, bumper, random_functions, with_flow};

/// States, rates, accelerations and auxiliary columns of one agent of each lane.
type Rows = [Vec<Block>; 4];

fn block(dice: &mut Dice) -> Block {
    Block(std::array::from_fn(|_| if dice.below(3) == 0 { dice.pick(AWKWARD) } else { 4.0 * dice.real() }))
}

fn blocks(dice: &mut Dice, n: usize) -> Vec<Block> {
    (0..n).map(|_| block(dice)).collect()
}

fn rows(dice: &mut Dice, n: usize) -> Rows {
    std::array::from_fn(|_| blocks(dice, n))
}

fn view(rows: &Rows) -> BlockView<'_> {
    let [states, rates, accelerations, aux] = rows;
    BlockView { states, rates, accelerations, aux }
}

/// One lane of columns.
fn lane(columns: &[Block], lane: usize) -> Vec<f64> {
    columns.iter().map(|block| block[lane]).collect()
}

/// Equal bits; the sign and payload of a NaN cannot be observed.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

/// Each function over a block against each function of one agent after the other.
fn check_kernels(program: &Program, dice: &mut Dice, scratch: &mut BlockScratch) {
    let slots: Vec<Rows> = (0..N_SLOTS).map(|_| rows(dice, N_COLUMNS)).collect();
    let time = block(dice);
    let views: Vec<BlockView<'_>> = slots.iter().map(view).collect();
    for kernel in &program.kernels {
        let mut got = vec![Block::splat(f64::NAN); kernel.n_outputs()];
        kernel.eval_block(&views, &time, scratch, &mut got);
        for k in 0..N_LANES {
            let alone: Vec<[Vec<f64>; 4]> =
                slots.iter().map(|rows| rows.each_ref().map(|columns| lane(columns, k))).collect();
            let alone: Vec<AgentView<'_>> = alone
                .iter()
                .map(|[states, rates, accelerations, aux]| AgentView { states, rates, accelerations, aux })
                .collect();
            let mut want = vec![0.0; kernel.n_outputs()];
            kernel.eval(&alone, time[k], &mut want);
            for (place, (want, got)) in want.iter().zip(&got).enumerate() {
                assert!(same(*want, got[k]), "output {place} of lane {k} is {want:e}, got {:e}", got[k]);
            }
        }
    }
}

#[test]
fn every_lane_of_a_block_has_the_bits_of_an_agent_alone() {
    let mut dice = Dice(0x51ed_270b_9f11_2ac5);
    let mut scratch = BlockScratch::default();
    for _ in 0..30 {
        let (graph, functions) = random_functions(&mut dice, 120);
        let program = compile(bare(graph, functions), Backend::Interpreter).unwrap();
        for _ in 0..5 {
            check_kernels(&program, &mut dice, &mut scratch);
        }
    }
}

#[test]
fn sine_and_cosine_of_one_angle_are_found_together() {
    let mut dice = Dice(0x0123_4567_89ab_cdef);
    let mut graph = Graph::default();
    let [x, y] = [0, 1].map(|column| graph.intern(Node::State { slot: 0, column }));
    let sum = graph.intern(Node::Binary(Op::Add, x, y));
    // Angles in a register, in a column, and one that is itself a sine found beside its cosine.
    let mut outputs = Vec::new();
    for angle in [sum, x] {
        let [sin, cos] = [Op::Sin, Op::Cos].map(|op| graph.intern(Node::Unary(op, angle)));
        let product = graph.intern(Node::Binary(Op::Mul, sin, cos));
        let [of_cos, of_sin] =
            [(Op::Cos, cos), (Op::Sin, cos)].map(|(op, a)| graph.intern(Node::Unary(op, a)));
        outputs.extend([product, of_cos, of_sin]);
    }
    let functions = [Function { name: "f".to_owned(), outputs }].into_iter().collect();
    let program = compile(bare(graph, functions), Backend::Interpreter).unwrap();
    check_kernels(&program, &mut dice, &mut BlockScratch::default());
}

/// A step of a block against the compiled steps of its lanes.
fn check_steps(system: System, dice: &mut Dice, rounds: usize) {
    let program = compile(system, Backend::Jit).unwrap();
    let step = program.steps[0][0].as_ref().expect("the flow reads no foreign state");
    let n = step.n_states();
    let kernel = program.kernel(FunctionId::new(0));
    let mut scratch = BlockScratch::default();
    for _ in 0..rounds {
        let (states, aux) = (blocks(dice, n), blocks(dice, 8));
        let (time, mut h) = (block(dice), block(dice));
        h.iter_mut().for_each(|h| *h *= 0.1);
        let agents = [BlockView { states: &states, aux: &aux, ..BlockView::default() }];
        let mut k = vec![Block::default(); 7 * n];
        kernel.eval_block(&agents, &time, &mut scratch, &mut k[..n]);
        let start = k.clone();
        let (mut x_new, mut err) = (vec![Block::default(); n], vec![Block::default(); n]);
        let to = BlockStep { k: &mut k, x_new: &mut x_new, err: &mut err };
        kernel.step_block(&agents, &time, &h, &mut scratch, to);
        for agent in 0..N_LANES {
            let (states, aux) = (lane(&states, agent), lane(&aux, agent));
            let (mut k_want, mut x_want, mut err_want) = (lane(&start, agent), vec![0.0; n], vec![0.0; n]);
            let alone = AgentView { states: &states, rates: &[], accelerations: &[], aux: &aux };
            step.step(&[alone], time[agent], h[agent], &mut k_want, &mut x_want, &mut err_want);
            let want = k_want.iter().chain(&x_want).chain(&err_want);
            let got = [lane(&k, agent), lane(&x_new, agent), lane(&err, agent)].concat();
            assert!(want.zip(got).all(|(&want, got)| same(want, got)), "lane {agent}");
        }
    }
}

#[test]
fn a_step_of_a_block_has_the_bits_of_the_steps_of_its_lanes() {
    let mut dice = Dice(0xfeed_beef_cafe_0001);
    check_steps(bumper(), &mut dice, 20);
    for _ in 0..12 {
        let mut graph = Graph::default();
        let mut nodes: Vec<_> = (0..N_COLUMNS as u32)
            .flat_map(|column| [Node::State { slot: 0, column }, Node::Aux { slot: 0, column }])
            .chain([Node::Time])
            .map(|node| graph.intern(node))
            .collect();
        for _ in 0..40 {
            let op = dice.pick(Op::ALL);
            let [a, b, c] = [dice.pick(&nodes), dice.pick(&nodes), dice.pick(&nodes)];
            nodes.push(graph.intern(match op.arity() {
                1 => Node::Unary(op, a),
                2 => Node::Binary(op, a, b),
                _ => Node::Select(a, b, c),
            }));
        }
        let rates = nodes[nodes.len() - N_COLUMNS..].to_vec();
        check_steps(with_flow(graph, rates), &mut dice, 5);
    }
}
