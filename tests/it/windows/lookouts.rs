//! Crowds at random whose agents look around: `exists` and `forall` with a range, over their own type or another, with and
//! without `other`, in modes that come and go; some are put elsewhere, some are born and die.

use std::fmt::Write as _;

use super::arena::{Crowd, NAMES, jump, walls};
use crate::differential::dice::Dice;

/// The model of this number.
pub fn model(seed: u64) -> String {
    let crowd = Crowd { half: 4.0, members: (8, 12), until: 3.0, agent, given };
    crowd.model(Dice::new(seed.wrapping_add(9_000_000)))
}

/// Speed, rate of turning.
fn given(dice: &mut Dice) -> String {
    let (u, w) = (dice.signed(0.1, 2.0), dice.signed(0.2, 3.0));
    format!("u = {u}, w = {w}")
}

fn agent(dice: &mut Dice, ty: usize, n_types: usize, half: f64, text: &mut String) {
    let name = NAMES[ty];
    let _ = writeln!(text, "agent {name}(w: real) {{\n  state x, y, th = w");
    let _ = writeln!(text, "  discrete u = 0, k: int = 0, met: int = 0, free: int = 0");
    let x = *dice.pick(&["u*cos(th)", "u", "u + cos(2*time + th)", "u - 0.2*x"]);
    let y = *dice.pick(&["u*sin(th)", "0.5*w", "0.5*w*sin(th)"]);
    let _ = writeln!(text, "  flow {{ x' = nudge*({x})  y' = nudge*({y})  th' = w }}");
    walls(half, text);
    match dice.below(4) {
        0 => jump(half, text),
        1 => {
            let _ = writeln!(text, "  sway: every {} {{ u := -0.9*u  k := k + 1 }}", dice.number(0.3, 1.5));
        }
        _ => {}
    }
    let _ = writeln!(text, "  initial mode Go {{");
    look(dice, "close", "-> Shy { met := met + 1 }", n_types, text);
    let _ = writeln!(text, "  }}\n  mode Shy {{");
    look(dice, "clear", "-> Go { free := free + 1 }", n_types, text);
    let _ = writeln!(text, "  }}");
    for number in 0..dice.below(3) {
        look(dice, &format!("look{number}"), "{ k := k + 1 }", n_types, text);
    }
    match dice.below(4) {
        0 => {
            let _ = writeln!(text, "  dies: when met >= {} {{ destroy self }}", 1 + dice.below(3));
        }
        1 => {
            let _ = writeln!(
                text,
                "  bears: when met == {} and k < 100 {{ k := k + 100  create {name}(x = -x, y = y + 1, u = -u, w = 0.7*w, k = 100) }}",
                1 + dice.below(3)
            );
        }
        2 => {
            let _ = writeln!(text, "  turns: when met >= 2 {{ met := 0  u := -u }}");
        }
        _ => {}
    }
    text.push_str("}\n");
}

/// A transition whose guard looks at others.
fn look(dice: &mut Dice, label: &str, then: &str, n_types: usize, text: &mut String) {
    let range = dice.number(0.3, 1.2);
    let over = NAMES[dice.below(n_types)];
    let other = if dice.percent(85) { "other " } else { "" };
    let distance = match dice.below(4) {
        0 => "abs(o.x - x)".to_string(),
        1 => "hypot(o.x - x, o.y - y)".to_string(),
        2 => "max(abs(o.x - x), abs(o.y - y))".to_string(),
        _ => "sqrt((o.x - x)^2 + (o.y - y)^2 + 0.01)".to_string(),
    };
    let near = match dice.below(5) {
        0 => format!("{distance} <= {range} and o.u > u"),
        1 => format!("o.met >= met and {distance} < {range}"),
        2 => format!("{distance} <= {range} and o.y >= y - 0.1"),
        _ => format!("{distance} <= {range}"),
    };
    let exists = format!("exists o in {other}{over}: {near}");
    let guard = match dice.below(6) {
        0 => format!("not {exists}"),
        1 => format!("forall o in {other}{over}: {distance} > {range} or o.u < 0.5"),
        2 => format!("th >= 0.3 and ({exists})"),
        3 => format!("({exists}) or (exists p in other {over}: abs(p.y - y) + abs(p.x - x) <= 0.5*{range})"),
        _ => exists,
    };
    let trigger = match dice.below(6) {
        0 => format!("after {} when", dice.number(0.1, 0.6)),
        1 => format!("every {} when", dice.number(0.2, 0.7)),
        _ => "when".to_string(),
    };
    let _ = writeln!(text, "    {label}: {trigger} {guard} {then}");
}
