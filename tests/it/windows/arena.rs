//! What the crowds at random have in common who move about in an arena: their types, their members, its walls.

use std::fmt::Write as _;

use crate::differential::dice::Dice;

/// The names of the types.
pub const NAMES: [&str; 2] = ["Pod", "Qit"];

/// What differs from one kind of crowd to another.
pub struct Crowd {
    /// Half of the least side of the arena.
    pub half: f64,
    /// Of each type there are so many at least, and fewer than so many more.
    pub members: (usize, usize),
    /// No run is longer, s.
    pub until: f64,
    /// Writes the type of this number, of so many, in an arena of this half.
    pub agent: fn(&mut Dice, usize, usize, f64, &mut String),
    /// What a member is given beside its place, by name.
    pub given: fn(&mut Dice) -> String,
}

impl Crowd {
    /// A model of one or two types.
    pub fn model(&self, mut dice: Dice) -> String {
        let dice = &mut dice;
        let n_types = 1 + dice.below(2);
        let half = self.half + dice.below(4) as f64;
        let mut text = "param nudge = 1\n".to_string();
        for ty in 0..n_types {
            (self.agent)(dice, ty, n_types, half, &mut text);
        }
        let _ = writeln!(text, "system {{");
        for ty in 0..n_types {
            for k in 0..self.members.0 + dice.below(self.members.1) {
                let (x, y) = (dice.number(-half, half), dice.number(-half, half));
                let (name, label, given) = (NAMES[ty], ["p", "q"][ty], (self.given)(dice));
                let _ = writeln!(text, "  {label}{k} = {name}(x = {x}, y = {y}, {given})");
            }
        }
        let _ = writeln!(text, "}}\nrun {{ until {} }}", dice.number(1.0, self.until));
        text
    }
}

/// Whoever comes to a wall is put beside the other one.
pub fn walls(half: f64, text: &mut String) {
    let _ = writeln!(text, "  right: when x >= {half} {{ x := x - 2*{half} + 0.1 }}");
    let _ = writeln!(text, "  left: when x <= -{half} {{ x := x + 2*{half} - 0.1 }}");
}

/// A transition that puts an agent elsewhere from time to time.
pub fn jump(half: f64, text: &mut String) {
    let _ = writeln!(
        text,
        "  jump: every 0.4 + 0.2*abs(w) {{ y := mod(y + 3.7*w + {half}, 2*{half}) - {half} }}"
    );
}
