//! Does simplification leave every bit as it was?

use crate::calculus::build;
use crate::calculus::draft::Draft;
use crate::calculus::evaluate;
use crate::calculus::frame::Scope;
use crate::calculus::graph::{Graph, Node};
use crate::calculus::system::Layout;
use crate::calculus::tests::random::{self, Point, Random};
use crate::math::{Interval, Op};
use crate::model::ir::TypeId;

/// The value of a leaf that reads self.
pub fn leaf(node: Node, layout: &Layout, at: &Point) -> f64 {
    match node {
        Node::Time => at.time,
        Node::State { column, .. } => at.states[column as usize],
        Node::Aux { column, .. } if column as usize == layout.param(0) => at.param,
        Node::Aux { column, .. } if column as usize == layout.discrete(0) => at.discrete,
        Node::Aux { column, .. } if column as usize == layout.discrete(1) => at.flag,
        node => panic!("{node:?} is not read"),
    }
}

pub fn point(random: &mut Random) -> Point {
    let awkward = [0.0, -0.0, 1.0, -1.0, 2.0, 0.5, 1e-310, -1e-310, 1e150, 3.0];
    let mut real = || if random.below(3) == 0 { random.pick(&awkward) } else { random.real(-3.0, 3.0) };
    let (time, states, param) = (real(), vec![real(), real(), real()], real());
    Point { time, states, param, discrete: random.below(3) as f64, flag: random.below(2) as f64 }
}

#[test]
fn simplification_changes_no_bit_of_a_finite_value() {
    let mut random = Random(1);
    let ops = random::numeric_ops();
    let mut compared = 0;
    for _ in 0..3000 {
        let mut model = random::model();
        let depth = 1 + random.below(4);
        let expr = random::number(&mut model, &mut random, &ops, depth);
        let mut draft = Draft::new(&model);
        let mut scope = Scope::of_self(TypeId::new(0));
        let node = build::number(&mut draft, &mut scope, Scope::TOP, expr).expect("no quantifiers");
        for _ in 0..8 {
            let at = point(&mut random);
            let expected = random::naive(&model, expr, &at, &[]);
            let layout = draft.layout(0).clone();
            let found = evaluate::values(&draft.graph, &[node], &mut |node| leaf(node, &layout, &at))[0];
            if expected.is_finite() {
                compared += 1;
                assert_eq!(
                    expected.to_bits(),
                    found.to_bits(),
                    "{:?} at {at:?}: {expected} {found}",
                    model.exprs
                );
            }
        }
    }
    assert!(compared > 10_000, "only {compared} were finite");
}

#[test]
fn intervals_contain_the_values_of_their_members() {
    let mut random = Random(2);
    let ops = random::numeric_ops();
    let mut bounded = 0;
    for _ in 0..3000 {
        let mut model = random::model();
        let depth = 1 + random.below(3);
        let expr = random::number(&mut model, &mut random, &ops, depth);
        let mut draft = Draft::new(&model);
        let mut scope = Scope::of_self(TypeId::new(0));
        let node = build::number(&mut draft, &mut scope, Scope::TOP, expr).expect("no quantifiers");
        let layout = draft.layout(0).clone();
        let (low, width) = (point(&mut random), random.real(0.0, 0.5));
        let mut range = |node| match node {
            Node::Aux { .. } => Interval::point(leaf(node, &layout, &low)),
            node => Interval::new(leaf(node, &layout, &low), leaf(node, &layout, &low) + width),
        };
        let interval = evaluate::intervals(&draft.graph, &[node], &mut range)[0];
        bounded += usize::from(!interval.is_whole());
        for _ in 0..8 {
            let mut at = low.clone();
            at.time = (low.time + random.real(0.0, width)).clamp(low.time, low.time + width);
            for x in &mut at.states {
                *x = (*x + random.real(0.0, width)).clamp(*x, *x + width);
            }
            let value = evaluate::values(&draft.graph, &[node], &mut |node| leaf(node, &layout, &at))[0];
            assert!(
                interval.is_whole() || (interval.lo <= value && value <= interval.hi),
                "{value} not in {interval:?}: {:?} at {at:?}",
                model.exprs
            );
        }
    }
    assert!(bounded > 1000, "only {bounded} were bounded");
}

#[test]
fn equal_expressions_are_one_node() {
    let mut graph = Graph::default();
    let [a, b] = [0, 1].map(|column| graph.intern(Node::State { slot: 0, column }));
    assert_eq!(graph.binary(Op::Add, a, b), graph.binary(Op::Add, b, a));
    let (forth, back) = (graph.binary(Op::Sub, a, b), graph.binary(Op::Sub, b, a));
    let two = graph.number(2.0);
    assert_eq!(graph.binary(Op::Powi, forth, two), graph.binary(Op::Mul, back, back));
    assert_eq!(graph.unary(Op::Abs, forth), graph.unary(Op::Abs, back));
    assert_ne!(forth, back);
}

#[test]
fn long_chains_do_not_overflow_the_stack() {
    let mut model = random::model();
    let me = random::push(&mut model, crate::model::ir::ExprKind::SelfAgent, crate::model::ir::Type::Real);
    let mut chain =
        random::push(&mut model, crate::model::ir::ExprKind::State(me, 0), crate::model::ir::Type::Real);
    for k in 0..100_000 {
        let next = random::push(
            &mut model,
            crate::model::ir::ExprKind::State(me, k % 3),
            crate::model::ir::Type::Real,
        );
        let op = [Op::Add, Op::Mul, Op::Max][k % 3];
        let kind = crate::model::ir::ExprKind::Apply(op, [chain, next].into());
        chain = random::push(&mut model, kind, crate::model::ir::Type::Real);
    }
    let mut draft = Draft::new(&model);
    let mut scope = Scope::of_self(TypeId::new(0));
    let node = build::number(&mut draft, &mut scope, Scope::TOP, chain).expect("no quantifiers");
    let [first, second] = crate::calculus::derive::rates(&mut draft.graph, node);
    assert!(draft.graph.moves(first) && draft.graph.moves(second));
    assert_eq!(crate::calculus::derive::gradient(&mut draft.graph, node).len(), 3);
}
