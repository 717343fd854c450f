//! Random expressions over quantities with known dimensions: the compiler's verdict against the evaluator of the tests.

use hyc::base::SourceMap;

use super::evaluator::{Kind, ONE, Powers, Tree};
use crate::harness::Case;

/// Names of the model, and literals, with their dimensions in sixtieths.
const LEAVES: [(&str, Kind); 14] = [
    ("len", Kind::Written([60, 0, 0])),
    ("way", Kind::Written([60, 0, 0])),
    ("lag", Kind::Written([0, 0, 60])),
    ("wait", Kind::Written([0, 0, 60])),
    ("mass", Kind::Written([0, 60, 0])),
    ("v", Kind::Written([60, 0, -60])),
    ("force", Kind::Written([60, 60, -120])),
    ("share", Kind::Written(ONE)),
    ("5 [km/h]", Kind::Written([60, 0, -60])),
    ("3 [mm]", Kind::Written([60, 0, 0])),
    ("2", Kind::Bare),
    ("0.5", Kind::Bare),
    ("free", Kind::Free),
    ("time", Kind::Implied([0, 0, 60])),
];

const MODEL: &str = "\
agent A {
  state len: real [m] = 1, way: real [km] = 1, lag: real [s] = 1, free = 1
  discrete wait: real [ms] = 1, mass: real [t] = 1, v: real [mph] = 1, force: real [kN] = 1, share: real [%] = 1
  flow { len' = 0  way' = 0  lag' = 0  free' = 0 }
";

/// A linear congruential generator; its upper bits are random enough for trees.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % sides
    }

    fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.roll(of.len())]
    }

    fn tree(&mut self, depth: usize) -> Box<Tree> {
        if depth == 0 || self.roll(5) == 0 {
            let (name, kind) = self.pick(&LEAVES);
            return Box::new(Tree::Leaf(name.to_string(), kind));
        }
        let depth = depth - 1;
        Box::new(match self.roll(14) {
            0 => Tree::Same(self.pick(&["-", "abs", "floor", "round"]), self.tree(depth)),
            1..=3 => {
                let op = self.pick(&["+", "-", "min", "max", "hypot", "mod"]);
                Tree::Alike(op, self.tree(depth), self.tree(depth))
            }
            4 => Tree::If([self.tree(depth), self.tree(depth), self.tree(depth), self.tree(depth)]),
            5 | 6 => Tree::Times(self.tree(depth), self.tree(depth)),
            7 | 8 => Tree::Over(self.tree(depth), self.tree(depth)),
            9 | 10 => {
                let sixtieths = self.pick(&[120, 180, -60, 30, 20, 90, 0]);
                Tree::Power(self.tree(depth), sixtieths)
            }
            // what is alike, so that not everything is wrong
            11 => {
                let one = self.tree(depth);
                Tree::Alike("+", one.clone(), one)
            }
            12 => {
                let one = self.tree(depth);
                Tree::Pure(self.pick(&["sin", "exp", "tanh"]), Box::new(Tree::Over(one.clone(), one)))
            }
            _ => match self.roll(2) {
                0 => Tree::Pure(self.pick(&["cos", "log10", "atan"]), self.tree(depth)),
                _ => Tree::Angle(self.tree(depth), self.tree(depth)),
            },
        })
    }
}

/// How many mistakes the compiler finds in a model with these `let`s.
fn found(lets: &str) -> usize {
    let found = Case::new(&format!("{MODEL}{lets} }}")).model(&mut SourceMap::default());
    let found = found.err().unwrap_or_default();
    assert!(found.iter().all(|error| error.code.starts_with("HY023")), "{lets}\n{found:#?}");
    found.len()
}

/// A unit with these whole powers.
fn unit(powers: Powers) -> Option<String> {
    let whole = powers.iter().all(|power| power % 60 == 0 && power.abs() <= 60 * 99);
    whole.then(|| format!("m^{}*kg^{}*s^{}", powers[0] / 60, powers[1] / 60, powers[2] / 60))
}

#[test]
fn the_verdict_on_random_expressions_is_that_of_the_reference() {
    let mut dice = Dice(20_261_122);
    let (mut right, mut wrong, mut declared) = (0, 0, 0);
    while right < 500 || wrong < 500 || declared < 300 {
        let tree = dice.tree(4);
        if !tree.is_exact() {
            continue;
        }
        let text = tree.text();
        let (kind, mistakes) = tree.kind();
        assert_eq!(found(&format!("let e = {text}")), mistakes, "{text}");
        if mistakes > 0 {
            wrong += 1;
            continue;
        }
        right += 1;
        // what it comes to: it goes into its own unit and into no other
        if let Kind::Written(powers) | Kind::Implied(powers) = kind
            && let (Some(own), Some(other)) = (unit(powers), unit([powers[0] + 60, powers[1], powers[2]]))
        {
            assert_eq!(found(&format!("let e: real [{own}] = {text}")), 0, "{text} in {own}");
            assert_eq!(found(&format!("let e: real [{other}] = {text}")), 1, "{text} in {other}");
            declared += 1;
        }
    }
}
