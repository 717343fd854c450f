//! Guards whose threshold is a row of a table, which it touches there, passes, or stays on: against what the rows say exactly.
//!
//! All numbers are multiples of 1/8, so that no rounding decides anything. `HYC_MODELS=n` has that many tried.

use std::fmt::Write as _;

use hyc::model::ir::Integrator;

use crate::differential::dice::Dice;
use crate::harness::{Case, all_near};

/// A broken line through rows, constant outside.
struct Line {
    at: Vec<f64>,
    values: Vec<f64>,
}

fn eighth(dice: &mut Dice, low: i32, high: i32) -> f64 {
    f64::from(low + dice.below((high - low + 1) as usize) as i32) / 8.0
}

impl Line {
    fn random(dice: &mut Dice) -> Self {
        let mut line = Self { at: vec![eighth(dice, -8, 8)], values: vec![eighth(dice, -8, 8)] };
        for _ in 0..2 + dice.below(7) {
            let last = line.at[line.at.len() - 1];
            // Powers of two apart, so that slopes are exact, too.
            line.at.push(last + [0.25, 0.5, 1.0, 2.0][dice.below(4)]);
            let value = if dice.percent(40) {
                line.values[dice.below(line.values.len())]
            } else {
                eighth(dice, -8, 8)
            };
            line.values.push(value);
        }
        line
    }

    fn file(&self) -> String {
        let rows = self.at.iter().zip(&self.values);
        rows.fold("t,u\n".to_string(), |mut text, (t, u)| {
            let _ = writeln!(text, "{t},{u}");
            text
        })
    }

    /// The signs of `u(t - shift) - level` along [0, end]: at points where they change or may, and between them.
    fn signs(&self, shift: f64, level: f64, end: f64) -> Vec<(f64, f64, f64)> {
        let mut times: Vec<f64> = vec![0.0, end];
        times.extend(self.at.iter().map(|t| t + shift));
        for k in 1..self.at.len() {
            let (a, b) = (self.values[k - 1] - level, self.values[k] - level);
            if a * b < 0.0 {
                times.push(self.at[k - 1] + shift + (self.at[k] - self.at[k - 1]) * a / (a - b));
            }
        }
        times.retain(|t| (0.0..=end).contains(t));
        times.sort_by(f64::total_cmp);
        times.dedup();
        let crosses = |t: f64| {
            let e = t - shift;
            let k = self.at.partition_point(|at| *at <= e);
            let between = k > 0 && k < self.at.len() && self.at[k - 1] < e;
            between && (self.values[k - 1] - level) * (self.values[k] - level) < 0.0
        };
        let sign = |value: f64| if value == 0.0 { 0.0 } else { value.signum() };
        let at = |t: f64| sign(self.value(t - shift) - level);
        let mut signs = Vec::new();
        for (k, t) in times.iter().enumerate() {
            // A root between rows is zero, whatever rounding says.
            let is_root = crosses(*t) && at(*t).abs() > 0.0 && (self.value(t - shift) - level).abs() < 1e-9;
            let here = if is_root { 0.0 } else { at(*t) };
            let after = times.get(k + 1).map_or(f64::NAN, |next| at(0.5 * (t + next)));
            signs.push((*t, here, after));
        }
        signs
    }

    fn value(&self, e: f64) -> f64 {
        let k = self.at.partition_point(|at| *at <= e);
        if k == 0 || k == self.at.len() {
            return self.values[k.min(self.at.len() - 1)];
        }
        let share = (e - self.at[k - 1]) / (self.at[k] - self.at[k - 1]);
        self.values[k - 1] + share * (self.values[k] - self.values[k - 1])
    }
}

/// When `u >= level` and `u > level` fire (rules 2 and 3), and `crossing(u - level)`.
fn expected(signs: &[(f64, f64, f64)]) -> [Vec<f64>; 3] {
    let [mut closed, mut open, mut crossing] = [Vec::new(), Vec::new(), Vec::new()];
    let (mut before_closed, mut before_open, mut side) = (false, false, 0.0);
    for (t, here, after) in signs.iter().copied() {
        if !before_closed && (here >= 0.0 || after >= 0.0) {
            closed.push(t);
        }
        if !before_open && (here > 0.0 || after > 0.0) {
            open.push(t);
        }
        if after != 0.0 && !after.is_nan() && after != side {
            crossing.extend((side != 0.0).then_some(t));
            side = after;
        }
        // Being false at a single point does not arm.
        (before_closed, before_open) = (after >= 0.0, after > 0.0);
    }
    [closed, open, crossing]
}

#[test]
fn thresholds_that_are_rows_of_tables_are_exact() {
    let methods = [Integrator::Auto, Integrator::Tsit5, Integrator::Adams, Integrator::Stiff];
    let models = std::env::var("HYC_MODELS").map_or(120, |text| text.parse().expect("a number"));
    for number in 0..models {
        let dice = &mut Dice::new(number);
        let line = Line::random(dice);
        let level = line.values[dice.below(line.values.len())];
        let [shift, other] = [eighth(dice, -16, 16), eighth(dice, -16, 16)];
        let flow = *dice.pick(&[
            "1",
            "table(\"rows.csv\", \"u\", time - shift)",
            "table(\"rows.csv\", \"u\", time - shift) - x",
        ]);
        // No row lies at the end: there what comes after would decide.
        let end = 8.0625;
        let text = format!(
            "agent A(shift: real) {{ state x = 0  flow {{ x' = {flow} }}
               let u = table(\"rows.csv\", \"u\", time - shift)
               closed: when u >= {level} {{ }}  open: when u > {level} {{ }}  crosses: when crossing(u - ({level})) {{ }} }}
             system {{ a = A(shift = {shift})  b = A(shift = {other}) }}  run {{ until {end} }}"
        );
        let method = *dice.pick(&methods);
        let run = Case::new(&text).file("rows.csv", &line.file()).integrator(method).run();
        for (agent, shift) in [("a", shift), ("b", other)] {
            let signs = line.signs(shift, level, end);
            for (name, times) in ["A.closed", "A.open", "A.crosses"].into_iter().zip(expected(&signs)) {
                let found = run.times_of(name, agent);
                assert_eq!(
                    found.len(),
                    times.len(),
                    "model {number}, {name} of {agent} by {method:?}: {found:?} for {times:?}\n{text}\n{}",
                    line.file()
                );
                all_near(&found, &times, 1e-11);
            }
        }
    }
}
