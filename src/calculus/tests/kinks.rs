//! Is a flow with fresh locks the flow as written, and smooth otherwise?

use rustc_hash::FxHashMap;

use crate::calculus::build;
use crate::calculus::draft::Draft;
use crate::calculus::evaluate;
use crate::calculus::frame::Scope;
use crate::calculus::graph::{Node, NodeId};
use crate::calculus::kinks;
use crate::calculus::system::{Kink, KinkKind};
use crate::calculus::tests::random::{self, Point, Random};
use crate::calculus::tests::simplification::leaf;
use crate::math::Op;
use crate::model::ir::TypeId;

/// The value of a node with given locks.
fn locked_value(draft: &Draft, id: NodeId, at: &Point, locks: &FxHashMap<usize, f64>) -> f64 {
    let layout = draft.layout(0);
    let mut read = |node| match node {
        Node::Aux { column, .. } if column as usize >= layout.lock(0) => locks[&(column as usize)],
        node => leaf(node, layout, at),
    };
    evaluate::values(&draft.graph, &[id], &mut read)[0]
}

fn initial(draft: &Draft, kinks: &[Kink], at: &Point) -> FxHashMap<usize, f64> {
    let none = FxHashMap::default();
    let value = |kink: &Kink| locked_value(draft, draft.functions[kink.initial].outputs[0], at, &none);
    kinks.iter().map(|kink| (kink.lock, value(kink))).collect()
}

fn point(random: &mut Random) -> Point {
    let mut real = || random.real(-3.0, 3.0);
    let (time, states, param) = (real(), vec![real(), real(), real()], real());
    Point { time, states, param, discrete: random.below(3) as f64, flag: random.below(2) as f64 }
}

#[test]
fn rule_15_a_locked_flow_with_fresh_locks_is_the_flow_as_written() {
    let mut random = Random(6);
    // At 0 a locked sign is 1, so that one is looked at below only.
    let ops: Vec<Op> = random::numeric_ops().into_iter().filter(|&op| op != Op::Sign).collect();
    let (mut compared, mut kinked) = (0, 0);
    for _ in 0..3000 {
        let mut model = random::model();
        let depth = 1 + random.below(3);
        let expr = random::number(&mut model, &mut random, &ops, depth);
        let mut draft = Draft::new(&model);
        let mut scope = Scope::of_self(TypeId::new(0));
        let plain = build::number(&mut draft, &mut scope, Scope::TOP, expr).expect("no quantifiers");
        let (locked, kinks) = kinks::lock(&mut draft, &mut scope, 0, &[plain], "test");
        kinked += usize::from(!kinks.is_empty());
        for _ in 0..5 {
            let at = point(&mut random);
            let locks = initial(&draft, &kinks, &at);
            let expected = locked_value(&draft, plain, &at, &FxHashMap::default());
            let found = locked_value(&draft, locked[0], &at, &locks);
            if expected.is_finite() && expected.abs() < 1e6 {
                compared += 1;
                let close = (expected - found).abs() <= 1e-9 * (1.0 + expected.abs());
                assert!(close, "{expected} {found}: {:?} at {at:?}", draft.graph.nodes());
                for kink in &kinks {
                    surfaces_agree(&draft, kink, &at, &locks);
                }
            }
        }
    }
    assert!(compared > 5_000 && kinked > 900, "{compared} {kinked}");
}

/// With fresh locks no surface says that the lock should change.
fn surfaces_agree(draft: &Draft, kink: &Kink, at: &Point, locks: &FxHashMap<usize, f64>) {
    let g = |function| locked_value(draft, draft.functions[function].outputs[0], at, locks);
    let lock = locks[&kink.lock];
    match &kink.kind {
        KinkKind::Branch(atom) if !g(atom.value).is_nan() => assert_eq!(g(atom.value) <= 0.0, lock == 1.0),
        KinkKind::Branch(_) => {}
        KinkKind::Integer { below, above } => {
            assert!(g(below.value) >= 0.0 || lock.is_nan());
            assert!(g(above.value) > 0.0 || lock.is_nan() || lock.abs() > 1e15);
        }
    }
}

#[test]
fn rule_15_a_locked_operator_continues_beyond_its_kink() {
    for (op, x, beyond, expected) in [
        (Op::Abs, 1.0, -0.5, -0.5),
        (Op::Sign, 1.0, -0.5, 1.0),
        (Op::Floor, 1.5, 2.5, 1.0),
        (Op::Ceil, 1.5, 2.5, 2.0),
        (Op::Round, 1.6, 2.6, 2.0),
        (Op::Trunc, -1.5, -2.5, -1.0),
    ] {
        assert_eq!(continued(op, [x, 0.0], [beyond, 0.0]), expected, "{}", op.name());
    }
    assert_eq!(continued(Op::Min, [1.0, 2.0], [3.0, 2.0]), 3.0);
    assert_eq!(continued(Op::Max, [1.0, 2.0], [3.0, 2.0]), 2.0);
    assert_eq!(continued(Op::Mod, [1.5, 2.0], [2.5, 2.0]), 2.5);
    assert!(
        (continued(Op::Atan2, [0.1, -1.0], [-0.1, -1.0]) - (std::f64::consts::PI + 0.1f64.atan())).abs()
            < 1e-12
    );
    assert!(
        (continued(Op::Atan2, [-0.1, -1.0], [0.1, -1.0]) + (std::f64::consts::PI + 0.1f64.atan())).abs()
            < 1e-12
    );
}

/// `op` of the first states with the locks of `from`, at `to`.
fn continued(op: Op, from: [f64; 2], to: [f64; 2]) -> f64 {
    let model = random::model();
    let mut draft = Draft::new(&model);
    let mut scope = Scope::of_self(TypeId::new(0));
    let operands: Vec<NodeId> =
        (0..op.arity() as u32).map(|column| draft.graph.intern(Node::State { slot: 0, column })).collect();
    let plain = draft.graph.apply(op, &operands);
    let (locked, kinks) = kinks::lock(&mut draft, &mut scope, 0, &[plain], "test");
    let at =
        |[x, y]: [f64; 2]| Point { time: 0.0, states: vec![x, y, 0.0], param: 0.0, discrete: 0.0, flag: 0.0 };
    let locks = initial(&draft, &kinks, &at(from));
    locked_value(&draft, locked[0], &at(to), &locks)
}
