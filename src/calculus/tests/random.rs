//! Random numbers, random expressions of the model, and what they mean, said naively.

use crate::base::Span;
use crate::math::{Op, Scale};
use crate::model::ir::{
    AgentType, Expr, ExprId, ExprKind, Function, Let, Mode, ModeId, Model, Type, Variable,
};

/// A generator of uniform numbers (xorshift64*).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    pub fn real(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next() as f64 / (1u64 << 53) as f64
    }

    pub fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())]
    }
}

/// The values of an agent's variables.
#[derive(Clone, Debug)]
pub struct Point {
    pub time: f64,
    pub states: Vec<f64>,
    pub param: f64,
    pub discrete: f64,
    pub flag: f64,
}

/// A model of one agent type: states x y z, a parameter, a discrete, a boolean; a function and a let.
pub fn model() -> Model {
    let mut model = Model::default();
    let variable = |name: &str, ty| Variable {
        name: name.to_owned(),
        ty,
        unit: None,
        scale: Scale::ONE,
        span: Span::default(),
    };
    let root = Mode {
        name: "A".to_owned(),
        path: String::new(),
        parent: None,
        depth: 0,
        children: Vec::new(),
        initial: None,
        is_region: false,
        flow: Vec::new(),
        invariants: Vec::new(),
        asserts: Vec::new(),
        entry: Vec::new(),
        exit: Vec::new(),
        span: Span::default(),
    };
    model.types.push(AgentType {
        name: "A".to_owned(),
        span: Span::default(),
        params: vec![variable("p", Type::Real)],
        states: ["x", "y", "z"].map(|name| variable(name, Type::Real)).into(),
        discretes: vec![variable("d", Type::Int), variable("b", Type::Bool)],
        links: Vec::new(),
        sets: Vec::new(),
        events: Vec::new(),
        lets: Vec::new(),
        declared: Vec::new(),
        memberships: Vec::new(),
        initials: Default::default(),
        modes: [root].into_iter().collect(),
        transitions: Vec::new(),
    });
    let me = push(&mut model, ExprKind::SelfAgent, Type::Real);
    let (x, y) = (
        push(&mut model, ExprKind::State(me, 0), Type::Real),
        push(&mut model, ExprKind::State(me, 1), Type::Real),
    );
    let value = push(&mut model, ExprKind::Apply(Op::Sub, [x, y].into()), Type::Real);
    let ty = model.types.indices().next().expect("one type");
    model.types[ty].lets.push(Let {
        name: "l".to_owned(),
        mode: ModeId::new(0),
        value,
        unit: None,
        scale: Scale::ONE,
        span: Span::default(),
    });
    let [a, b] = [0, 1].map(|k| push(&mut model, ExprKind::Local(k), Type::Real));
    let body = push(&mut model, ExprKind::Apply(Op::Mul, [a, b].into()), Type::Real);
    let params = vec![("a".to_owned(), Type::Real), ("b".to_owned(), Type::Real)];
    model.functions.push(Function { name: "f".to_owned(), params, body, span: Span::default() });
    model
}

pub fn push(model: &mut Model, kind: ExprKind, ty: Type) -> ExprId {
    model.exprs.push(Expr { kind, ty, span: Span::default() })
}

/// A random number; `ops` are those it may use.
pub fn number(model: &mut Model, random: &mut Random, ops: &[Op], depth: usize) -> ExprId {
    let kind = if depth == 0 {
        let me = push(model, ExprKind::SelfAgent, Type::Real);
        match random.below(8) {
            0 => ExprKind::Number(random.pick(&[0.0, -0.0, 1.0, -1.0, 2.0, 0.5, -3.0, 1e3])),
            1 => ExprKind::Time,
            2 => ExprKind::AgentParam(me, 0),
            3 => ExprKind::Discrete(me, 0),
            4 => ExprKind::Let(me, 0),
            _ => ExprKind::State(me, random.below(3)),
        }
    } else if random.below(12) == 0 {
        let arguments = [(); 2].map(|()| number(model, random, ops, depth - 1));
        ExprKind::Call(model.functions.indices().next().expect("one function"), arguments.into())
    } else {
        let op = random.pick(ops);
        let mut operands: Vec<ExprId> =
            (0..op.arity()).map(|_| number(model, random, ops, depth - 1)).collect();
        if op == Op::Powi {
            operands[1] =
                push(model, ExprKind::Number(random.pick(&[-2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0])), Type::Int);
        }
        if op == Op::Select {
            operands[0] = condition(model, random, ops, depth - 1);
        }
        match operands[..] {
            [a] => ExprKind::Apply(op, [a].into()),
            [a, b] => ExprKind::Apply(op, [a, b].into()),
            _ => ExprKind::Apply(op, [operands[0], operands[1], operands[2]].into()),
        }
    };
    push(model, kind, Type::Real)
}

/// A random condition without quantifiers.
pub fn condition(model: &mut Model, random: &mut Random, ops: &[Op], depth: usize) -> ExprId {
    let me = push(model, ExprKind::SelfAgent, Type::Real);
    let kind = match if depth == 0 { random.below(3) } else { random.below(9) } {
        0 => ExprKind::Number(random.pick(&[0.0, 1.0])),
        1 => ExprKind::Discrete(me, 1),
        3 => ExprKind::Apply(Op::Not, [condition(model, random, ops, depth - 1)].into()),
        k @ (4..=6) => {
            let operands = [(); 2].map(|()| condition(model, random, ops, depth - 1));
            ExprKind::Apply([Op::And, Op::Or, Op::Eq][k - 4], operands.into())
        }
        7 => {
            let operands = [(); 3].map(|()| condition(model, random, ops, depth - 1));
            ExprKind::Apply(Op::Select, operands.into())
        }
        _ => {
            let op = random.pick(&[Op::Le, Op::Lt]);
            let operands = [(); 2].map(|()| number(model, random, ops, depth.saturating_sub(1)));
            ExprKind::Apply(op, operands.into())
        }
    };
    push(model, kind, Type::Bool)
}

/// What an expression is at a point, straight from the model.
pub fn naive(model: &Model, expr: ExprId, at: &Point, locals: &[f64]) -> f64 {
    let inner = |e: ExprId| naive(model, e, at, locals);
    match &model.exprs[expr].kind {
        ExprKind::Number(x) => *x,
        ExprKind::Time => at.time,
        ExprKind::Local(k) => locals[*k],
        ExprKind::State(_, k) => at.states[*k],
        ExprKind::Discrete(_, 0) => at.discrete,
        ExprKind::Discrete(..) => at.flag,
        ExprKind::AgentParam(..) => at.param,
        ExprKind::Let(..) => at.states[0] - at.states[1],
        ExprKind::Call(function, arguments) => {
            let values: Vec<f64> = arguments.iter().map(|&e| inner(e)).collect();
            naive(model, model.functions[*function].body, at, &values)
        }
        ExprKind::Apply(op, operands) => {
            let mut values = [0.0; 3];
            for (value, &e) in values.iter_mut().zip(operands) {
                *value = inner(e);
            }
            op.eval(values)
        }
        kind => panic!("{kind:?} is not made here"),
    }
}

/// Every operator that makes a number of numbers.
pub fn numeric_ops() -> Vec<Op> {
    Op::ALL.iter().copied().filter(|op| !op.is_boolean()).collect()
}
