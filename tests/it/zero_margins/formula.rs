//! Random formulas, and whether they hold by the meaning of their words alone: all signals are constant between a few times.

use std::fmt::{self, Display, Formatter};

use crate::differential::dice::Dice;

/// How many agents there are.
pub const N_AGENTS: usize = 3;
/// When all numbers are written, s.
pub const TIMES: [f64; 3] = [1.0, 2.0, 3.0];
/// The end of the run, s.
const END: f64 = 4.0;
/// The numbers of an agent.
const NAMES: [&str; 2] = ["n", "m"];
const RELATIONS: [&str; 6] = ["<", "<=", "==", "!=", ">=", ">"];

/// The numbers of all agents.
type Values = [[i32; 2]; N_AGENTS];

/// The numbers from each time on.
pub struct Schedule {
    values: [Values; TIMES.len() + 1],
    /// Whether the agents have a state besides.
    moves: bool,
}

impl Schedule {
    /// Small numbers.
    pub fn random(dice: &mut Dice) -> Self {
        let mut number = || dice.below(3) as i32;
        let values = std::array::from_fn(|_| std::array::from_fn(|_| [number(), number()]));
        Self { values, moves: dice.percent(50) }
    }

    fn at(&self, t: f64) -> &Values {
        &self.values[TIMES.iter().filter(|&&time| time <= t).count()]
    }
}

impl Display for Schedule {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let stretches = 0..self.values.len();
        let name = |k: usize, name: &str| format!("{name}{k}");
        let parameters: Vec<String> =
            stretches.clone().flat_map(|k| NAMES.map(|of| format!("{}: int", name(k, of)))).collect();
        write!(f, "agent A({}) {{ discrete n: int = n0, m: int = m0", parameters.join(", "))?;
        if self.moves {
            write!(f, "  state x = 1  flow {{ x' = -x }}")?;
        }
        for (k, time) in TIMES.iter().enumerate() {
            write!(f, "  t{k}: after {time} {{ n := n{}  m := m{} }}", k + 1, k + 1)?;
        }
        writeln!(f, " }}\nsystem {{")?;
        for agent in 0..N_AGENTS {
            let argument =
                |k: usize| [0, 1].map(|of| format!("{}{k} = {}", NAMES[of], self.values[k][agent][of]));
            let arguments: Vec<String> = stretches.clone().flat_map(argument).collect();
            writeln!(f, "  a{agent} = A({})", arguments.join(", "))?;
        }
        writeln!(f, "}}\nrun {{ until {END} }}")
    }
}

/// A side of a comparison; agents are bound by depth.
pub enum Side {
    Number(i32),
    Variable(usize, usize),
    Count(usize, Box<Condition>),
}

/// What is so or not at a time.
pub enum Condition {
    Compare(Side, &'static str, Side),
    Not(Box<Condition>),
    And(Box<[Condition; 2]>),
    Or(Box<[Condition; 2]>),
    If(Box<[Condition; 3]>),
    /// Of all agents, or of some: who binds, those who count, what is so.
    Of(&'static str, usize, Option<Box<Condition>>, Box<Condition>),
}

impl Side {
    fn random(dice: &mut Dice, depth: usize, room: usize) -> Self {
        match dice.below(8) {
            0 if room > 0 => Side::Count(depth, Box::new(Condition::random(dice, depth + 1, 0))),
            1..=4 if depth > 0 => Side::Variable(dice.below(depth), dice.below(2)),
            _ => Side::Number(dice.below(3) as i32),
        }
    }

    fn value(&self, values: &Values, bound: &mut Vec<usize>) -> i32 {
        match self {
            Side::Number(number) => *number,
            Side::Variable(by, of) => values[bound[*by]][*of],
            Side::Count(_, condition) => {
                let holds = |agent: &usize| with(bound, *agent, |bound| condition.holds(values, bound));
                (0..N_AGENTS).filter(holds).count() as i32
            }
        }
    }
}

/// With one more agent bound.
fn with(bound: &mut Vec<usize>, agent: usize, ask: impl FnOnce(&mut Vec<usize>) -> bool) -> bool {
    bound.push(agent);
    let answer = ask(bound);
    bound.pop();
    answer
}

impl Condition {
    fn random(dice: &mut Dice, depth: usize, room: usize) -> Self {
        let part = |dice: &mut Dice| Condition::random(dice, depth, room.saturating_sub(1));
        match dice.below(12) {
            0 if room > 0 => Condition::Not(Box::new(part(dice))),
            1 | 2 if room > 0 => Condition::And(Box::new([part(dice), part(dice)])),
            3 | 4 if room > 0 => Condition::Or(Box::new([part(dice), part(dice)])),
            5 if room > 0 => Condition::If(Box::new([part(dice), part(dice), part(dice)])),
            6..=9 if room > 0 && depth < 2 => Condition::quantified(dice, depth, room - 1),
            _ if depth == 0 && room > 0 => Condition::quantified(dice, depth, room - 1),
            _ => {
                let first = if depth > 0 {
                    Side::Variable(dice.below(depth), dice.below(2))
                } else {
                    Side::Count(depth, Box::new(Condition::random(dice, depth + 1, 0)))
                };
                Condition::Compare(
                    first,
                    RELATIONS[dice.below(RELATIONS.len())],
                    Side::random(dice, depth, room),
                )
            }
        }
    }

    fn quantified(dice: &mut Dice, depth: usize, room: usize) -> Self {
        let word = *dice.pick(&["forall", "exists"]);
        let who = dice.percent(30).then(|| Box::new(Condition::random(dice, depth + 1, 0)));
        Condition::Of(word, depth, who, Box::new(Condition::random(dice, depth + 1, room)))
    }

    fn holds(&self, values: &Values, bound: &mut Vec<usize>) -> bool {
        match self {
            Condition::Compare(a, relation, b) => {
                let (a, b) = (a.value(values, bound), b.value(values, bound));
                match *relation {
                    "<" => a < b,
                    "<=" => a <= b,
                    "==" => a == b,
                    "!=" => a != b,
                    ">=" => a >= b,
                    _ => a > b,
                }
            }
            Condition::Not(part) => !part.holds(values, bound),
            Condition::And(parts) => parts.iter().all(|part| part.holds(values, bound)),
            Condition::Or(parts) => parts.iter().any(|part| part.holds(values, bound)),
            Condition::If(parts) => {
                let [condition, then, otherwise] = &**parts;
                if condition.holds(values, bound) { then } else { otherwise }.holds(values, bound)
            }
            Condition::Of(word, _, who, body) => {
                let all = *word == "forall";
                let decides = |agent: usize| {
                    with(bound, agent, |bound| {
                        let counts = who.as_ref().is_none_or(|who| who.holds(values, bound));
                        counts && body.holds(values, bound) != all
                    })
                };
                (0..N_AGENTS).any(decides) != all
            }
        }
    }
}

impl Display for Side {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Side::Number(number) => write!(f, "{number}"),
            Side::Variable(by, of) => write!(f, "v{by}.{}", NAMES[*of]),
            Side::Count(by, condition) => write!(f, "(count v{by} in A: {condition})"),
        }
    }
}

impl Display for Condition {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Condition::Compare(a, relation, b) => write!(f, "{a} {relation} {b}"),
            Condition::Not(part) => write!(f, "not ({part})"),
            Condition::And(parts) => write!(f, "({}) and ({})", parts[0], parts[1]),
            Condition::Or(parts) => write!(f, "({}) or ({})", parts[0], parts[1]),
            Condition::If(parts) => write!(f, "(if {} then ({}) else ({}))", parts[0], parts[1], parts[2]),
            Condition::Of(word, by, None, body) => write!(f, "({word} v{by} in A: {body})"),
            Condition::Of(word, by, Some(who), body) => write!(f, "({word} v{by} in A where {who}: {body})"),
        }
    }
}

/// A property.
pub enum Formula {
    Holds(Condition),
    Over(&'static str, [f64; 2], Box<Formula>),
    Until(Condition, [f64; 2], Condition),
}

impl Formula {
    /// With up to three windows in each other.
    pub fn random(dice: &mut Dice) -> Self {
        let mut formula = if dice.percent(35) {
            let before = Condition::random(dice, 0, 3);
            Formula::Until(before, window(dice), Condition::random(dice, 0, 3))
        } else {
            Formula::Holds(Condition::random(dice, 0, 4))
        };
        for _ in 0..dice.below(4) {
            let word = *dice.pick(&["always", "eventually"]);
            formula = Formula::Over(word, window(dice), Box::new(formula));
        }
        formula
    }

    /// Whether it holds at the beginning.
    pub fn holds(&self, schedule: &Schedule) -> bool {
        self.at(schedule, 0.0)
    }

    /// The last time at which the run comes to its window, s.
    fn last(&self) -> f64 {
        match self {
            Formula::Holds(_) => END,
            Formula::Over(_, [from, _], inner) => inner.last() - from,
            Formula::Until(_, [from, _], _) => END - from,
        }
    }

    /// Times between which it is the same.
    fn breaks(&self) -> Vec<f64> {
        let (window, mut breaks) = match self {
            Formula::Holds(_) => return TIMES.to_vec(),
            Formula::Over(_, window, inner) => (window, [inner.breaks(), vec![inner.last()]].concat()),
            Formula::Until(_, window, _) => (window, [&TIMES[..], &[END]].concat()),
        };
        let moved: Vec<f64> = breaks.iter().flat_map(|time| window.map(|by| time - by)).collect();
        breaks.extend(moved.into_iter().filter(|time| time.is_finite()));
        breaks
    }

    /// Whether it holds at a time that is no break.
    fn at(&self, schedule: &Schedule, t: f64) -> bool {
        match self {
            Formula::Holds(condition) => condition.holds(schedule.at(t), &mut Vec::new()),
            Formula::Over(word, [from, to], inner) => {
                let (from, to) = (t + from, (t + to).min(inner.last()));
                let holds = |&(start, end): &(f64, f64)| inner.at(schedule, 0.5 * (start + end));
                let stretches = stretches(inner.breaks(), from, to);
                if *word == "always" { stretches.iter().all(holds) } else { stretches.iter().any(holds) }
            }
            Formula::Until(before, [from, to], goal) => {
                let holds = |condition: &Condition, t: f64| condition.holds(schedule.at(t), &mut Vec::new());
                let (from, to) = (t + from, (t + to).min(END));
                let middle = |(start, end): (f64, f64)| 0.5 * (start + end);
                // The goal as early as it may be in each stretch.
                stretches(TIMES.to_vec(), from, to).into_iter().any(|stretch| {
                    let mut way = stretches(TIMES.to_vec(), t, stretch.0).into_iter();
                    holds(goal, middle(stretch)) && way.all(|part| holds(before, middle(part)))
                })
            }
        }
    }
}

/// What some times cut [from, to] into.
fn stretches(mut times: Vec<f64>, from: f64, to: f64) -> Vec<(f64, f64)> {
    times.retain(|&time| from < time && time < to);
    times.extend([from, to]);
    times.sort_by(f64::total_cmp);
    let pairs = times.windows(2).map(|pair| (pair[0], pair[1]));
    pairs.filter(|(start, end)| start < end && from < to).collect()
}

/// From and to, s from now; nothing is written just at its ends.
fn window(dice: &mut Dice) -> [f64; 2] {
    let mut time = |most: usize| (1 + dice.below(most * 10_007 - 1)) as f64 / 10_007.0;
    let (from, length) = (time(1), 0.01 + time(3));
    let from = if dice.percent(50) { 0.0 } else { from };
    [from, if dice.percent(20) { f64::INFINITY } else { from + length }]
}

impl Display for Formula {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Formula::Holds(condition) => write!(f, "({condition})"),
            Formula::Over(word, [0.0, f64::INFINITY], inner) => write!(f, "{word} {inner}"),
            Formula::Over(word, [from, to], inner) => write!(f, "{word} [{from}, {to}] {inner}"),
            Formula::Until(before, [from, to], goal) => write!(f, "({before}) until [{from}, {to}] ({goal})"),
        }
    }
}
