//! Is a condition in normal form true exactly where the source is?

use crate::calculus::condition::{self, Cond, Sense};
use crate::calculus::draft::Draft;
use crate::calculus::error::Error;
use crate::calculus::evaluate;
use crate::calculus::frame::Scope;
use crate::calculus::graph::{Graph, Node, NodeId};
use crate::calculus::jumps;
use crate::calculus::system::Relation;
use crate::calculus::tests::random::{self, Point, Random};
use crate::calculus::tests::simplification::leaf;
use crate::math::Op;
use crate::model::ir::{ExprKind, Model, Type, TypeId};

fn holds(draft: &Draft, cond: &Cond, at: &Point) -> bool {
    let value =
        |id: NodeId| evaluate::values(&draft.graph, &[id], &mut |node| leaf(node, draft.layout(0), at))[0];
    match cond {
        Cond::Constant(value) => *value,
        Cond::Discrete(node) => value(*node) != 0.0,
        Cond::Atom(Relation::NonPositive, g, _) => value(*g) <= 0.0,
        Cond::Atom(Relation::Negative, g, _) => value(*g) < 0.0,
        Cond::And(terms) => terms.iter().all(|term| holds(draft, term, at)),
        Cond::Or(terms) => terms.iter().any(|term| holds(draft, term, at)),
        other => panic!("{other:?} is not made here"),
    }
}

/// Small whole numbers, so that comparisons are often on their boundary.
fn point(random: &mut Random) -> Point {
    let mut whole = |n: usize| random.below(n) as f64 - 1.0;
    let (time, states, param) = (whole(4), vec![whole(4), whole(4), whole(4)], whole(4));
    Point { time, states, param, discrete: random.below(3) as f64, flag: random.below(2) as f64 }
}

#[test]
fn the_normal_form_is_true_where_the_source_is() {
    let mut random = Random(5);
    let ops = [
        Op::Add,
        Op::Sub,
        Op::Mul,
        Op::Neg,
        Op::Abs,
        Op::Max,
        Op::Hypot,
        Op::Powi,
        Op::Select,
        Op::Floor,
        Op::Ceil,
        Op::Sign,
    ];
    let (mut compared, mut yes) = (0, 0);
    for _ in 0..4000 {
        let mut model = random::model();
        let depth = 1 + random.below(4);
        let expr = random::condition(&mut model, &mut random, &ops, depth);
        let mut draft = Draft::new(&model);
        let mut scope = Scope::of_self(TypeId::new(0));
        let [plain, negated] = [Sense::Positive, Sense::Negative]
            .map(|sense| condition::lower(&mut draft, &mut scope, expr, sense).expect("no quantifiers"));
        for _ in 0..6 {
            let at = point(&mut random);
            let expected = random::naive(&model, expr, &at, &[]);
            if only_finite(&model, &at) {
                assert_eq!(
                    holds(&draft, &plain, &at),
                    expected != 0.0,
                    "{:?} at {at:?}\n{plain:?}",
                    model.exprs
                );
                assert_eq!(holds(&draft, &negated, &at), expected == 0.0, "{:?} at {at:?}", model.exprs);
                compared += 1;
                yes += usize::from(expected != 0.0);
            }
        }
    }
    assert!(compared > 10_000 && yes > 2_000 && yes < compared - 2_000, "{compared} {yes}");
}

/// Whether all numbers of the model are finite at a point: division and powers of zero are not compared.
fn only_finite(model: &Model, at: &Point) -> bool {
    let ids = model.exprs.iter_enumerated().filter(|(_, e)| matches!(e.kind, ExprKind::Apply(..)));
    ids.into_iter()
        .filter(|(id, _)| id.index() > 8)
        .all(|(id, _)| random::naive(model, id, at, &[]).is_finite())
}

#[test]
fn distances_are_compared_by_their_squares() {
    let mut model = random::model();
    let me = random::push(&mut model, ExprKind::SelfAgent, Type::Real);
    let [x, y] = [0, 1].map(|k| random::push(&mut model, ExprKind::State(me, k), Type::Real));
    let distance = random::push(&mut model, ExprKind::Apply(Op::Hypot, [x, y].into()), Type::Real);
    let (five, param) = (
        random::push(&mut model, ExprKind::Number(5.0), Type::Real),
        random::push(&mut model, ExprKind::AgentParam(me, 0), Type::Real),
    );
    let near = random::push(&mut model, ExprKind::Apply(Op::Le, [distance, five].into()), Type::Bool);
    let far = random::push(&mut model, ExprKind::Apply(Op::Lt, [param, distance].into()), Type::Bool);
    let mut draft = Draft::new(&model);
    let mut scope = Scope::of_self(TypeId::new(0));
    let near = condition::lower(&mut draft, &mut scope, near, Sense::Positive).expect("a comparison");
    let Cond::Atom(Relation::NonPositive, g, _) = near else { panic!("one atom: {near:?}") };
    let roots =
        draft.graph.reach(&[g]).iter().filter(|&&id| draft.graph.node(id).op() == Some(Op::Hypot)).count();
    assert_eq!(roots, 0);
    let far = condition::lower(&mut draft, &mut scope, far, Sense::Positive).expect("a comparison");
    for (param, states, expected) in
        [(-1.0, [0.0, 0.0], true), (5.0, [3.0, 4.0], false), (4.0, [3.0, 4.0], true)]
    {
        let at =
            Point { time: 0.0, states: vec![states[0], states[1], 0.0], param, discrete: 0.0, flag: 0.0 };
        assert_eq!(holds(&draft, &far, &at), expected, "{at:?}");
    }
}

#[test]
fn jumps_are_comparisons_of_their_own() {
    let mut random = Random(7);
    for op in [Op::Sign, Op::Atan2] {
        let mut graph = Graph::default();
        let operands: Vec<NodeId> =
            (0..op.arity() as u32).map(|column| graph.intern(Node::State { slot: 0, column })).collect();
        let plain = graph.apply(op, &operands);
        let choices = jumps::as_choices(&mut graph, plain);
        for _ in 0..200 {
            let states = [(); 2].map(|()| random.pick(&[-1.0, 0.0, 2.0, 0.25]) * random.real(0.5, 1.0));
            let mut read = |node| match node {
                // The cut belongs to the upper side, so a zero is a positive one.
                Node::State { column, .. } => states[column as usize] + 0.0,
                node => panic!("{node:?} is not read"),
            };
            let [expected, found] = evaluate::values(&graph, &[plain, choices], &mut read)[..] else {
                panic!("two")
            };
            let at_origin = op == Op::Atan2 && states == [0.0; 2];
            assert!(
                at_origin || (expected - found).abs() < 1e-15,
                "{}: {expected} {found} at {states:?}",
                op.name()
            );
        }
    }
}

#[test]
fn conditions_have_limits_and_chains_do_not_count_as_depth() {
    let mut model = random::model();
    let me = random::push(&mut model, ExprKind::SelfAgent, Type::Real);
    let x = random::push(&mut model, ExprKind::State(me, 0), Type::Real);
    let mut chain = None;
    for k in 0..2 * condition::PARTS_MAX {
        let bound = random::push(&mut model, ExprKind::Number(k as f64), Type::Real);
        let term = random::push(&mut model, ExprKind::Apply(Op::Le, [x, bound].into()), Type::Bool);
        let joined = chain.map(|chain| ExprKind::Apply(Op::And, [chain, term].into()));
        chain = Some(joined.map_or(term, |kind| random::push(&mut model, kind, Type::Bool)));
        if k == 5000 {
            let result = lower(&model, chain.expect("just made"));
            assert!(matches!(result, Ok(Cond::And(terms)) if terms.len() == 5001));
        }
    }
    let result = lower(&model, chain.expect("made"));
    assert!(matches!(result, Err(Error::ConditionTooLarge { .. })));
    let mut deep = chain.expect("made");
    for _ in 0..2 * condition::DEPTH_MAX {
        let yes = random::push(&mut model, ExprKind::Number(1.0), Type::Bool);
        let flag = random::push(&mut model, ExprKind::Discrete(me, 1), Type::Bool);
        deep = random::push(&mut model, ExprKind::Apply(Op::Select, [flag, deep, yes].into()), Type::Bool);
    }
    let result = lower(&model, deep);
    assert!(matches!(result, Err(Error::ConditionTooDeep { .. })));
}

fn lower(model: &Model, expr: crate::model::ir::ExprId) -> Result<Cond, Error> {
    let mut draft = Draft::new(model);
    let mut scope = Scope::of_self(TypeId::new(0));
    condition::lower(&mut draft, &mut scope, expr, Sense::Positive)
}
