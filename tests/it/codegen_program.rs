//! What does compilation promise: once per type, deterministic, bounded, nothing left behind?

use hyc::base::Arena;
use hyc::calculus::graph::{Graph, Node};
use hyc::calculus::system::{Function, System};
use hyc::codegen::kernel::{AgentView, Kernel, StepKernel};
use hyc::codegen::program::Cost;
use hyc::codegen::{Backend, compile, dump_clif, dump_tape};
use hyc::math::Op;
use hyc::model::ir::{Instance, ModeId, TypeId};

use crate::codegen_systems::{Dice, bare, bumper, random_functions, with_flow};

fn with_agents(n_agents: usize) -> System {
    let mut system = bumper();
    let instance = Instance {
        ty: TypeId::new(0),
        mode: ModeId::new(0),
        params: vec![1.0; 4],
        states: vec![0.0; 3],
        discretes: Vec::new(),
        links: Vec::new(),
    };
    system.population.agents = vec![instance; n_agents].into();
    system
}

#[test]
fn the_cost_does_not_depend_on_the_number_of_agents() {
    let cost = |n_agents| Cost { seconds: 0.0, ..compile(with_agents(n_agents), Backend::Jit).unwrap().cost };
    let few = cost(10);
    assert_eq!(few, cost(100_000));
    assert_eq!((few.functions, few.interpreted), (2, 0));
    assert!(few.code_bytes > 0);
}

#[test]
fn two_hundred_programs_can_be_compiled_and_dropped() {
    let mut dice = Dice(77);
    for _ in 0..200 {
        let (graph, functions) = random_functions(&mut dice, 20);
        let program = compile(bare(graph, functions), Backend::Jit).unwrap();
        assert_eq!(program.kernels.len(), 2);
    }
}

#[test]
fn kernels_can_be_shared_by_threads() {
    fn shared<T: Send + Sync>() {}
    shared::<Kernel>();
    shared::<StepKernel>();
    let program = compile(bumper(), Backend::Jit).unwrap();
    let heading = &|th: f64| {
        let mut out = [0.0; 3];
        let view = AgentView { states: &[0.0, 0.0, th], rates: &[], accelerations: &[], aux: &[1.0; 7] };
        program.kernels[0].eval(&[view], 0.0, &mut out);
        out[0]
    };
    std::thread::scope(|scope| {
        let headings = [0.0, 1.0, 2.0, 3.0];
        let threads = headings.map(|th| scope.spawn(move || heading(th)));
        for (th, thread) in headings.into_iter().zip(threads) {
            assert_eq!(thread.join().unwrap(), Op::Cos.eval([th, 0.0, 0.0]));
        }
    });
}

#[test]
fn machine_code_is_made_when_it_pays_and_changes_no_bit() {
    let [auto, jit] = [Backend::Auto, Backend::Jit].map(|backend| compile(bumper(), backend).unwrap());
    assert_eq!(auto.machine_code(), (0, 0), "nothing is compiled for a few evaluations");
    let mut n_interpreted = 0;
    while !auto.kernels[0].is_compiled() {
        let th = 0.001 * f64::from(n_interpreted);
        let view = AgentView { states: &[0.0, 0.0, th], rates: &[], accelerations: &[], aux: &[1.0; 7] };
        let [ours, theirs] = [&auto, &jit].map(|program| {
            let mut out = [0.0; 3];
            program.kernels[0].eval(&[view], th, &mut out);
            out.map(f64::to_bits)
        });
        assert_eq!(ours, theirs, "at {th}");
        n_interpreted += 1;
        assert!(n_interpreted < 1_000_000, "it never pays");
    }
    assert!(n_interpreted > 1000, "{n_interpreted}");
    assert_eq!(auto.machine_code(), jit.machine_code());
}

#[test]
fn a_function_that_is_too_long_is_interpreted() {
    let mut graph = Graph::default();
    let x = graph.intern(Node::State { slot: 0, column: 0 });
    let mut sum = x;
    for _ in 0..25_000 {
        let size = graph.intern(Node::Unary(Op::Abs, sum));
        sum = graph.intern(Node::Binary(Op::Add, size, x));
    }
    let functions: Arena<Function> = [("long", sum), ("short", x)]
        .map(|(name, node)| Function { name: name.into(), outputs: vec![node] })
        .into_iter()
        .collect();
    let system = bare(graph, functions);
    assert!(
        dump_tape(&system).starts_with("long: 50001 instructions, 2 registers\n"),
        "registers are used again"
    );
    let program = compile(system, Backend::Jit).unwrap();
    assert_eq!((program.cost.functions, program.cost.interpreted), (1, 1));
    let mut out = [0.0];
    let view = AgentView { states: &[0.5], rates: &[], accelerations: &[], aux: &[] };
    program.kernels[0].eval(&[view], 0.0, &mut out);
    assert_eq!(out, [0.5 * 25_001.0]);
}

#[test]
fn absent_agents_trap_nowhere() {
    let mut dice = Dice(4711);
    let (graph, functions) = random_functions(&mut dice, 300);
    let program = compile(bare(graph, functions), Backend::Jit).unwrap();
    let nan = [f64::NAN; 4];
    let view = AgentView { states: &nan, rates: &nan, accelerations: &nan, aux: &nan };
    let mut out = vec![0.0; program.kernels[0].n_outputs()];
    program.kernels[0].eval(&[view; 3], 0.0, &mut out);
}

#[test]
fn rows_that_are_too_short_are_refused() {
    let program = compile(bumper(), Backend::Jit).unwrap();
    let call = |states: &[f64], aux: &[f64], n_out: usize| {
        let view = AgentView { states, rates: &[], accelerations: &[], aux };
        program.kernels[0].eval(&[view], 0.0, &mut vec![0.0; n_out]);
    };
    let refused = |states: &[f64], aux: &[f64], n_out: usize| {
        std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| call(states, aux, n_out))).is_err()
    };
    assert!(!refused(&[0.0; 3], &[0.0; 7], 3));
    assert!(refused(&[0.0; 2], &[0.0; 7], 3));
    assert!(refused(&[0.0; 3], &[0.0; 6], 3));
    assert!(refused(&[0.0; 3], &[0.0; 7], 2));
}

#[test]
fn reads_say_which_columns_are_needed() {
    let program = compile(bumper(), Backend::Interpreter).unwrap();
    let reads = program.kernels[0].reads();
    assert!(reads.time);
    assert_eq!(reads.slots.len(), 1);
    assert_eq!((reads.slots[0].states, reads.slots[0].aux, reads.slots[0].rates), (3, 7, 0));
}

#[test]
fn dumps_are_readable_and_always_the_same() {
    insta::assert_snapshot!(dump_tape(&bumper()));
    let decay = || {
        let mut graph = Graph::default();
        let x = graph.intern(Node::State { slot: 0, column: 0 });
        let rate = graph.intern(Node::Aux { slot: 0, column: 3 });
        let product = graph.intern(Node::Binary(Op::Mul, rate, x));
        with_flow(graph, vec![product])
    };
    insta::assert_snapshot!(dump_clif(&decay()));
    assert_eq!(dump_clif(&decay()), dump_clif(&decay()));
    assert_eq!(dump_clif(&bumper()), dump_clif(&with_agents(1000)));
}
