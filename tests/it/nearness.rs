//! How near must two agents be for a condition over both to be true? The ranges that the compiler derives from guards, against
//! conditions of which they are known, and against the guards themselves at random points beyond them.

use hyc::calculus::evaluate;
use hyc::calculus::graph::Node;
use hyc::calculus::system::{
    Condition, Entry, FunctionId, Guard, Layout, Near, Quantified, Relation, System, Trigger, Whither,
};

use crate::harness::Case;

/// Agents with four states, two parameters and three discrete variables: one that nobody writes, one that stays at 4 or
/// below, one that grows without end. `own` stands in their type, `rest` after it.
fn model(own: &str, rest: &str) -> System {
    let text = format!(
        "fn dist2(p: A, q: A) = (p.x - q.x)^2 + (p.y - q.y)^2
         fn near(p: A, q: A, r: real) = dist2(p, q) <= r^2
         agent A(r: real, k: real) {{
           state x = 0, y = 0, z = 0, v = 0
           discrete q = 0.25, w = 1, u = 1
           link lead: A
           flow {{ x' = v  y' = 1  z' = 0  v' = 0 }}
           tick: every 1 {{ w := min(w + 1, 4)  u := u + 1 }}
           initial mode M {{ }}
           mode N {{ }}
           {own}
         }}
         agent B {{ state s = 0, x = 0  flow {{ s' = 1  x' = 1 }} }}
         {rest}
         system {{ a = A[3](r = 0.5 + 0.25*index, k = 2)  b = B[2] }}
         run {{ until 10 }}"
    );
    Case::new(&text).system().1
}

/// With an interaction of two of them that has this guard.
fn interaction(guard: &str) -> System {
    model("", &format!("interaction I(a: A, b: A) {{ t: when {guard} {{ a.v := 0 }} }}"))
}

fn guard(trigger: &Trigger) -> &Guard {
    match trigger {
        Trigger::When(guard) => guard,
        Trigger::After { .. } | Trigger::Every { .. } | Trigger::On { .. } => panic!("it waits"),
        Trigger::Rate { .. } | Trigger::Chance { .. } => panic!("it waits"),
    }
}

/// A condition over two agents, with the bounds that the compiler has found.
struct Asked<'s> {
    system: &'s System,
    guard: &'s Guard,
    condition: &'s Condition,
    near: &'s [Near],
    /// The slot of the other one.
    slot: usize,
    /// What the condition is for those who are too far away.
    far: bool,
}

impl<'s> Asked<'s> {
    fn interaction(system: &'s System) -> Self {
        let pair = &system.interactions[0].transitions[0];
        let guard = guard(&pair.transition.trigger);
        Self { system, guard, condition: &guard.condition, near: &pair.near, slot: 1, far: false }
    }

    /// Of the first quantifier of the last transition of the first type.
    fn quantifier(system: &'s System) -> Self {
        let guard = guard(&system.types[0].transitions.last().unwrap().trigger);
        let (quantified, far) = first(&guard.condition).expect("there is one");
        let Quantified { slot, near, body, .. } = quantified;
        Self { system, guard, condition: body, near, slot: *slot, far }
    }

    /// Whether the condition holds, boundaries included; for those too far to be `true`, excluded.
    fn holds(&self, leaf: &mut dyn FnMut(Node) -> f64) -> bool {
        self.holds_in(self.condition, leaf)
    }

    fn holds_in(&self, condition: &Condition, leaf: &mut dyn FnMut(Node) -> f64) -> bool {
        match condition {
            Condition::Constant(value) => *value,
            Condition::Discrete(function) => self.value(*function, leaf) != 0.0,
            Condition::Atom(k) => {
                let atom = &self.guard.atoms[*k];
                let g = self.value(atom.value, leaf);
                match atom.relation {
                    Relation::NonPositive | Relation::Negative if self.far => g < 0.0,
                    Relation::NonPositive | Relation::Negative => g <= 0.0,
                    Relation::Crossing => g == 0.0,
                }
            }
            Condition::And(terms) => terms.iter().all(|term| self.holds_in(term, leaf)),
            Condition::Or(terms) => terms.iter().any(|term| self.holds_in(term, leaf)),
            Condition::Rising(_, inner) => self.holds_in(inner, leaf),
            Condition::Exists(_) | Condition::Forall(_) => panic!("one quantifier at a time"),
        }
    }

    fn value(&self, function: FunctionId, leaf: &mut dyn FnMut(Node) -> f64) -> f64 {
        let root = self.system.functions[function].outputs[0];
        evaluate::values(&self.system.graph, &[root], leaf)[0]
    }

    /// The bounds as text: state, state, width.
    fn bounds(&self) -> Vec<(usize, usize, f64)> {
        self.near.iter().map(|near| (axis(near.own), axis(near.other), near.within)).collect()
    }
}

fn first(condition: &Condition) -> Option<(&Quantified, bool)> {
    match condition {
        Condition::Exists(quantified) => Some((quantified, false)),
        Condition::Forall(quantified) => Some((quantified, true)),
        Condition::And(terms) | Condition::Or(terms) => terms.iter().find_map(first),
        Condition::Rising(_, inner) => first(inner),
        Condition::Constant(_) | Condition::Discrete(_) | Condition::Atom(_) => None,
    }
}

/// Uniform numbers (xorshift64*).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Of either sign, of all sizes from `low` to `high`.
    fn of_any_size(&mut self, low: f64, high: f64) -> f64 {
        let size = low * (high / low).powf(self.unit());
        if self.unit() < 0.5 { size } else { -size }
    }
}

/// Two agents that are close in every state.
struct Point {
    states: [Vec<f64>; 2],
    aux: [Vec<f64>; 2],
    time: f64,
}

impl Point {
    fn random(asked: &Asked, random: &mut Random) -> Self {
        let layout = &asked.system.types[0].layout;
        let scale = if random.unit() < 0.5 { 1.0 } else { 100.0 };
        let own: Vec<f64> = (0..layout.n_states).map(|_| random.of_any_size(1e-3, 1.0) * scale).collect();
        let other = own.iter().map(|x| x + random.of_any_size(1e-3, 10.0)).collect();
        let aux = [0, 1].map(|_| {
            let mut aux = vec![0.0; layout.n_aux()];
            aux[layout.param(0)] = 0.5 + 0.25 * (3.0 * random.unit()).floor();
            aux[layout.param(1)] = 2.0;
            aux[layout.discrete(0)] = 0.25;
            aux[layout.discrete(1)] = 1.0 + (4.0 * random.unit()).floor();
            aux[layout.discrete(2)] = 1.0 + (20.0 * random.unit()).floor();
            aux[Layout::MODE] = 1.0 + (2.0 * random.unit()).floor();
            aux
        });
        Self { states: [own, other], aux, time: 10.0 * random.unit() }
    }

    /// What a leaf is; a slot that is neither is of an agent that is not there.
    fn leaf(&self, node: Node, slot: usize) -> f64 {
        let side = |of: u32| match of as usize {
            0 => Some(0),
            of if of == slot => Some(1),
            _ => None,
        };
        match node {
            Node::Time => self.time,
            Node::State { slot, column } => side(slot).map_or(f64::NAN, |k| self.states[k][column as usize]),
            Node::Aux { slot, column } => side(slot).map_or(f64::NAN, |k| self.aux[k][column as usize]),
            other => panic!("{other:?} is not read here"),
        }
    }
}

impl Point {
    fn entry(&mut self, side: usize, entry: Entry) -> &mut f64 {
        match entry {
            Entry::State(k) => &mut self.states[side][k],
            Entry::Aux(column) => &mut self.aux[side][column],
        }
    }

    /// a.x - b.y
    fn gap(&mut self, near: &Near) -> f64 {
        *self.entry(0, near.own) - *self.entry(1, near.other)
    }

    fn put_apart(&mut self, near: &Near, gap: f64) {
        *self.entry(1, near.other) = *self.entry(0, near.own) + gap;
    }
}

/// Beyond a bound the condition is settled, wherever the agents are; somewhere within all bounds it is not.
fn sampled(asked: &Asked, text: &str, random: &mut Random) {
    let n_samples = 4000;
    for near in asked.near {
        for _ in 0..n_samples {
            let mut at = Point::random(asked, random);
            let beyond = 1.0 + random.of_any_size(1e-8, 1e4).abs();
            let gap = near.within * beyond * if random.unit() < 0.5 { 1.0 } else { -1.0 };
            at.put_apart(near, gap);
            if at.gap(near).abs() > near.within {
                let holds = asked.holds(&mut |node| at.leaf(node, asked.slot));
                assert_eq!(holds, asked.far, "{text}: {near:?} at {:?}", at.states);
            }
        }
    }
    let mut matters = false;
    for _ in 0..40 * n_samples {
        let at = Point::random(asked, random);
        matters |= asked.holds(&mut |node| at.leaf(node, asked.slot)) != asked.far;
        if matters {
            break;
        }
    }
    assert!(matters, "{text} is settled everywhere");
}

#[track_caller]
fn assert_bounds(found: &[(usize, usize, f64)], expected: &[(usize, usize, f64)], text: &str) {
    let states = |bounds: &[(usize, usize, f64)]| bounds.iter().map(|b| (b.0, b.1)).collect::<Vec<_>>();
    assert_eq!(states(found), states(expected), "{text}: {found:?}");
    for (found, expected) in found.iter().zip(expected) {
        let (found, expected) = (found.2, expected.2);
        assert!(expected <= found && found <= expected * (1.0 + 1e-6), "{text}: {found}, not {expected}");
    }
}

/// x with x, y with y, at the same distance.
/// The number of a state.
#[track_caller]
fn axis(entry: Entry) -> usize {
    match entry {
        Entry::State(k) => k,
        Entry::Aux(column) => panic!("column {column} is no state"),
    }
}

fn xy(within: f64) -> Vec<(usize, usize, f64)> {
    vec![(0, 0, within), (1, 1, within)]
}

fn x(within: f64) -> Vec<(usize, usize, f64)> {
    vec![(0, 0, within)]
}

#[test]
fn conditions_of_interactions_bound_differences() {
    let guards = [
        ("hypot(a.x - b.x, a.y - b.y) <= 2", xy(2.0)),
        ("sqrt((a.x - b.x)^2 + (a.y - b.y)^2) < 2", xy(2.0)),
        ("(a.x - b.x)^2 + (a.y - b.y)^2 + (a.z - b.z)^2 <= 9", vec![(0, 0, 3.0), (1, 1, 3.0), (2, 2, 3.0)]),
        ("(a.x - b.x)*(a.x - b.x) + (b.y - a.y)*(b.y - a.y) <= 4", xy(2.0)),
        ("dist2(a, b) <= 4", xy(2.0)),
        ("near(b, a, a.r + b.r)", xy(2.0)),
        ("hypot(a.x - b.x, a.y - b.y) <= a.r + b.r", xy(2.0)),
        ("dist2(a, b) - (a.r + b.r)^2 <= 0", xy(2.0)),
        ("abs(a.x - b.x) <= 1.5", x(1.5)),
        ("2*abs(a.x - b.x) <= 3", x(1.5)),
        ("(a.x - b.x)^2/a.r <= 1", x(1.0)),
        ("abs(a.x - b.x)^3 <= 8", x(2.0)),
        ("max(abs(a.x - b.x), abs(a.y - b.y)) < 3", xy(3.0)),
        ("max(abs(a.x - b.x) - 1, a.v - b.v) <= 0", x(1.0)),
        ("1/(a.x - b.x)^2 > 4", x(0.5)),
        ("exp(-(a.x - b.x)^2) >= 0.5", x(std::f64::consts::LN_2.sqrt())),
        ("abs(a.x - b.x) < 1 and abs(a.y - b.y) < 2", vec![(0, 0, 1.0), (1, 1, 2.0)]),
        ("abs(a.x - b.x) < 1 and hypot(a.x - b.x, a.y - b.y) < 2", vec![(0, 0, 1.0), (1, 1, 2.0)]),
        ("a.x - b.x < 1 and b.x - a.x < 2", x(2.0)),
        ("a.x < b.x + 1 and b.x < a.x + 1", x(1.0)),
        ("a.x > b.x and a.x - b.x <= 1 and a.v > b.v", x(1.0)),
        ("abs(a.x - b.x) <= 1 or hypot(a.x - b.x, a.y - b.y) <= 2", x(2.0)),
        ("(a.v > b.v or a.w > 2) and abs(a.x - b.x) <= 1", x(1.0)),
        ("not (abs(a.x - b.x) > 1) and a is M", x(1.0)),
        ("abs(a.x - b.x + 3) <= 1", x(4.0)),
        ("abs(a.x + 3 - b.x) <= 1", x(4.0)),
        ("abs((a.x - b.x)*3 + 1) <= 2", x(1.0)),
        ("abs(a.k*a.x - b.k*b.x) <= 2", x(1.0)),
        ("abs(a.x - b.y) <= 1", vec![(0, 1, 1.0)]),
        ("abs(a.x - b.x) <= a.q", x(0.25)),
        ("abs(a.x - b.x) <= a.w", x(4.0)),
        ("abs(a.x - b.x) <= 1 + time/10", x(2.0)),
        ("if a.y > 0 then abs(a.x - b.x) <= 1 else abs(a.x - b.x) <= 2", x(2.0)),
        ("abs(a.x - b.x) <= (if a.y > 0 then 1 else 2)", x(2.0)),
        ("floor(abs(a.x - b.x)) <= 2", x(3.0)),
        ("rising(abs(a.x - b.x) <= 1)", x(1.0)),
        ("abs(a.x - b.x) <= 1 and a.lead.x > 2", x(1.0)),
        ("a.x <= b.x and a.x >= b.x", x(0.0)),
    ];
    let mut random = Random(7);
    for (text, expected) in guards {
        let system = interaction(text);
        let asked = Asked::interaction(&system);
        assert_bounds(&asked.bounds(), &expected, text);
        // Of an agent that is not there nothing holds, and that two numbers are the same no sample shows.
        if !text.contains("lead") && expected != x(0.0) {
            sampled(&asked, text, &mut random);
        }
    }
}

#[test]
fn what_bounds_no_difference_has_no_range() {
    let guards = [
        "a.x*b.x < 1",
        "a.v > b.v",
        "hypot(a.x - b.x, a.y - b.y) <= 2 or a.v > 3",
        "hypot(a.x - b.x, a.y - b.y) <= a.v",
        "hypot(a.x - b.x, a.y - b.y) >= 2",
        "abs(a.x - b.x) <= 1 or abs(a.y - b.y) <= 1",
        "a.x - b.x <= 1",
        "abs(a.x + b.x) <= 1",
        "abs(2*a.x - b.x) <= 1",
        "abs(a.x - b.x) <= a.u",
        "abs(sin(a.x - b.x)) <= 0.5",
        "mod(a.x - b.x, 10) <= 1",
        "max(1 - (a.x - b.x)^2, 0) > 0 and max(1 - (a.x - b.x)^2, 0) < 5",
        "abs(a.x - b.x)/(1 + a.y^2) <= 1",
        "abs(a.lead.x - b.x) <= 1",
        "crossing(a.x - b.x + a.y)",
    ];
    for text in guards {
        let system = interaction(text);
        assert_eq!(Asked::interaction(&system).bounds(), [], "{text}");
    }
}

/// Parameters and discrete variables differ by as little as states do.
#[test]
fn columns_are_compared_as_states_are() {
    let w = 3 + 2 + 1;
    let guards = [
        ("a.w == b.w", vec![(Entry::Aux(w), Entry::Aux(w), 0.0)]),
        ("b.w == a.w + 1", vec![(Entry::Aux(w), Entry::Aux(w), 1.0)]),
        (
            "a.w == b.w and abs(a.x - b.x) <= 2",
            vec![(Entry::State(0), Entry::State(0), 2.0), (Entry::Aux(w), Entry::Aux(w), 0.0)],
        ),
        ("abs(a.x - b.u) <= 2", vec![(Entry::State(0), Entry::Aux(w + 1), 2.0)]),
        ("a.w != b.w", vec![]),
        ("a.w <= b.w", vec![]),
    ];
    let mut random = Random(11);
    for (text, expected) in guards {
        let system = interaction(text);
        let asked = Asked::interaction(&system);
        let found: Vec<_> = asked.near.iter().map(|near| (near.own, near.other, near.within)).collect();
        let columns = |bounds: &[(Entry, Entry, f64)]| bounds.iter().map(|b| (b.0, b.1)).collect::<Vec<_>>();
        assert_eq!(columns(&found), columns(&expected), "{text}");
        for (found, expected) in found.iter().zip(&expected) {
            assert!(expected.2 <= found.2 && found.2 <= expected.2 * (1.0 + 1e-6), "{text}: {found:?}");
        }
        for near in asked.near {
            for _ in 0..4000 {
                let mut at = Point::random(&asked, &mut random);
                let gap = random.of_any_size(near.within.max(1e-6) * 1.000_001, 1e4);
                at.put_apart(near, gap);
                if at.gap(near).abs() > near.within {
                    assert!(!asked.holds(&mut |node| at.leaf(node, asked.slot)), "{text}: {near:?}");
                }
            }
        }
    }
}

/// Of whoever is nearest: nobody beyond the bound for a key has a lesser one.
#[test]
fn nobody_beyond_its_bound_has_a_lesser_key() {
    let links = [
        ("nearest o in other A by (o.x - x)^2 + (o.y - y)^2", 2),
        ("nearest o in other A by hypot(o.x - x, o.y - y)", 2),
        ("nearest o in other A by abs(o.x - x) + 2*abs(o.y - y) + 3", 2),
        ("nearest o in other A where o.x > x by o.x - x", 1),
        ("nearest o in other A where o.w == w and o.x > x by o.x - x", 2),
        ("nearest o in other A where abs(o.y - y) <= 2 by abs(o.x - x)", 2),
        ("nearest o in other A by o.x - x", 0),
        ("nearest o in other A by abs(o.x + x)", 0),
        ("nearest o in other A by o.v", 0),
    ];
    let mut random = Random(12);
    for (text, n_axes) in links {
        let system = model(&format!("link mate = {text}"), "");
        let link = system.types[0].links.iter().find(|link| !link.updates.is_empty()).expect("there is one");
        let update = &link.updates[0];
        let Whither::Nearest { range, filter, key, near, keys } = &update.target else {
            panic!("{text} leads to {:?}", update.target)
        };
        assert_eq!(near.len(), n_axes, "{text}: {near:?}");
        let asked = Asked {
            system: &system,
            guard: filter,
            condition: &filter.condition,
            near,
            slot: range.slot,
            far: false,
        };
        let mut n_less = 0;
        for _ in 0..4000 {
            let mut at = Point::random(&asked, &mut random);
            for (near, keys) in near.iter().zip(keys) {
                let scale = if random.unit() < 0.5 { 1.0 } else { 100.0 };
                let gap = random.of_any_size(scale, 1e4);
                at.put_apart(near, gap);
                let holds = asked.holds(&mut |node| at.leaf(node, asked.slot));
                let found = asked.value(*key, &mut |node| at.leaf(node, asked.slot));
                let limit = found + random.of_any_size(1.0, 1e3).abs();
                let within = near.within.min(keys.within(limit)) * (1.0 + 1e-9);
                let is_beyond = at.gap(near).abs() > within;
                assert!(!(holds && is_beyond), "{text}: {near:?}, key {found} < {limit}, beyond {within}");
                assert!(
                    keys.within(keys.beyond(within)) <= within.max(keys.within(f64::NEG_INFINITY)),
                    "{text}"
                );
                n_less += usize::from(holds && within.is_finite());
            }
        }
        assert!(near.is_empty() || n_less > 100, "{text}: only {n_less} points say anything");
    }
}

#[test]
fn a_crossing_is_near_its_zero() {
    let guards = [
        ("crossing(hypot(a.x - b.x, a.y - b.y) - 2)", xy(2.0)),
        ("crossing(a.x - b.x)", x(0.0)),
        ("crossing(a.x - b.x - 3)", x(3.0)),
    ];
    let mut random = Random(3);
    for (text, expected) in guards {
        let system = interaction(text);
        let asked = Asked::interaction(&system);
        assert_bounds(&asked.bounds(), &expected, text);
        // Beyond it the sign is the same on each side, so that no sign changes there.
        let g = asked.guard.atoms[0].value;
        for near in asked.near {
            let mut signs = [None; 2];
            for _ in 0..4000 {
                let mut at = Point::random(&asked, &mut random);
                let gap = random.of_any_size(near.within.max(1e-6) * 1.000_001, 1e4);
                at.put_apart(near, gap);
                let sign = asked.value(g, &mut |node| at.leaf(node, 1)).signum();
                let known = signs[usize::from(gap > 0.0)].get_or_insert(sign);
                assert_eq!(*known, sign, "{text} at {:?}", at.states);
            }
        }
    }
}

#[test]
fn quantifiers_bound_differences_from_the_agent_itself() {
    let guards = [
        ("exists o in other A: abs(o.x - x) <= 1", x(1.0)),
        ("exists o in other A: hypot(x - o.x, y - o.y) < r + o.r and o is M", xy(2.0)),
        ("exists o in other A where o.v > v: dist2(self, o) <= 9", xy(3.0)),
        ("v > 2 and exists o in other A: abs(o.x - x) <= 1", x(1.0)),
        ("forall o in other A: abs(o.x - x) > 1", x(1.0)),
        ("forall o in other A: abs(o.x - x) > 1 or o.v < v", x(1.0)),
        ("forall o in other A where abs(o.x - x) <= 3: o.v > v", x(3.0)),
        ("not exists o in other A: dist2(self, o) < 4 and v > 1", xy(2.0)),
        ("(min o in other A: abs(o.x - x)) <= 1", x(1.0)),
        ("exists o in other A: o.v > v", Vec::new()),
        ("exists o in other A: abs(o.x - x) >= 1", Vec::new()),
        ("forall o in other A: abs(o.x - x) < 1", Vec::new()),
        ("forall o in other A: abs(o.lead.x - x) > 1", Vec::new()),
    ];
    let mut random = Random(11);
    for (text, expected) in guards {
        let system = model(&format!("t: when {text} {{ v := 0 }}"), "");
        let asked = Asked::quantifier(&system);
        assert_bounds(&asked.bounds(), &expected, text);
        if !expected.is_empty() {
            sampled(&asked, text, &mut random);
        }
    }
}

#[test]
fn claims_have_ranges_as_what_violates_them() {
    let system = model("assert forall o in other A: dist2(self, o) >= 4", "");
    let violation = &system.types[0].modes[0].claims[0].violation;
    let (quantified, all) = first(&violation.condition).unwrap();
    let found: Vec<_> =
        quantified.near.iter().map(|near| (axis(near.own), axis(near.other), near.within)).collect();
    assert_bounds(&found, &xy(2.0), "an assert");
    assert!(!all);
}

#[test]
fn two_types_have_columns_of_their_own() {
    let system = model("", "interaction I(b: B, a: A) { t: when abs(a.x - b.x) <= 1 { a.v := 0 } }");
    assert_bounds(&Asked::interaction(&system).bounds(), &[(1, 0, 1.0)], "of two types");
}

#[test]
fn parameters_are_those_of_the_population() {
    for (r, range) in [("1", 2.0), ("index", 4.0), ("-1", 0.0)] {
        let text = format!(
            "agent A(r: real) {{ state x = 0  flow {{ x' = 1 }} }}
             interaction I(a: A, b: A) {{ t: when abs(a.x - b.x) <= a.r + b.r {{ a.x := 0 }} }}
             system {{ a = A[3](r = {r}) }}"
        );
        let system = Case::new(&text).system().1;
        let found = Asked::interaction(&system).bounds();
        assert_bounds(&found, &x(range), r);
    }
}
