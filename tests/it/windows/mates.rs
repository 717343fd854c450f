//! Crowds at random whose agents have links to whoever is nearest, by several keys, some only within a lane; some follow the
//! one to whom their link leads, some have kinks; they jump, change lanes, are born and die. What a link leads to is written down.

use std::fmt::Write as _;

use super::arena::{Crowd, NAMES, jump, walls};
use crate::differential::dice::Dice;

/// The model of this number.
pub fn model(seed: u64) -> String {
    let crowd = Crowd { half: 3.0, members: (6, 10), until: 4.0, agent, given };
    crowd.model(Dice::new(seed.wrapping_add(7_000_000)))
}

/// Speed, rate of turning, lane.
fn given(dice: &mut Dice) -> String {
    let (u, w, lane) = (dice.signed(0.1, 1.5), dice.signed(0.2, 2.0), dice.below(3));
    format!("u = {u}, w = {w}, lane = {lane}")
}

fn agent(dice: &mut Dice, ty: usize, n_types: usize, half: f64, text: &mut String) {
    let name = NAMES[ty];
    let over = NAMES[dice.below(n_types)];
    let _ = writeln!(text, "agent {name}(w: real) {{\n  state x, y, th = w");
    let _ = writeln!(text, "  discrete u = 0, lane: int = 0, k: int = 0, met: int = 0, seen = 0");
    let other = if dice.percent(80) { "other " } else { "" };
    let own = if over == name && other.is_empty() { "abs(o.u - u) > 0 and " } else { "" };
    let (filter, key) = match dice.below(8) {
        0 => ("o.lane == lane and o.x > x", "o.x - x"),
        1 => ("o.lane == lane", "hypot(o.x - x, o.y - y)"),
        2 => ("o.lane == lane + 1", "abs(o.x - x)"),
        3 => ("o.x > x", "o.x - x + abs(o.y - y)"),
        4 => ("o.u > u", "(o.x - x)^2 + (o.y - y)^2"),
        5 => ("abs(o.y - y) <= 1", "abs(o.x - x)"),
        6 => ("true", "(o.x - x)^2 + 2*(o.y - y)^2"),
        _ => ("o.met <= met", "abs(o.x - x) + abs(o.y - y)"),
    };
    let _ = writeln!(text, "  link mate = nearest o in {other}{over} where {own}{filter} by {key}");
    let _ = writeln!(text, "  let away = if mate then mate.x - x else 0");
    let slow = *dice.pick(&["u", "if x > 0 then u else 0.2*u", "u*cos(th)", "u - 0.2*x"]);
    let follow = *dice.pick(&["u + 0.5*away", "0.8*away", "if away > 1 then 2*u else u + 0.1*away", "u"]);
    let y = *dice.pick(&["u*sin(th)", "0.5*w", "0.5*w*sin(th)"]);
    let _ = writeln!(text, "  flow {{ y' = nudge*({y})  th' = w }}");
    walls(half, text);
    let (period, first) = (dice.number(0.2, 0.7), dice.number(0.1, 0.9));
    let _ = writeln!(
        text,
        "  looks: every {period} {{ seen := if mate then mate.u else 9  met := met + (if mate then 1 else 0) }}"
    );
    match dice.below(4) {
        0 => jump(half, text),
        1 => {
            let _ = writeln!(text, "  change: every {first} {{ lane := mod(lane + 1, 3) }}");
        }
        2 => {
            let _ = writeln!(text, "  sway: every {first} + 0.3 {{ u := -0.9*u }}");
        }
        _ => {}
    }
    let range = dice.number(0.3, 1.5);
    let _ =
        writeln!(text, "  close: when mate and hypot(mate.x - x, mate.y - y) <= {range} {{ k := k + 1 }}");
    let _ = writeln!(text, "  initial mode Go {{\n    flow {{ x' = nudge*({slow}) }}");
    let _ = writeln!(text, "    when mate and away <= {range} and away >= -{range} -> Near\n  }}");
    let _ = writeln!(text, "  mode Near {{\n    flow {{ x' = nudge*({follow}) }}");
    let _ = writeln!(
        text,
        "    when not mate or abs(away) >= 2*{range} -> Go\n    after {} -> Go\n  }}",
        dice.number(0.3, 1.0)
    );
    match dice.below(4) {
        0 => {
            let _ = writeln!(text, "  dies: when k >= {} {{ destroy self }}", 1 + dice.below(3));
        }
        1 => {
            let _ = writeln!(
                text,
                "  bears: when k == {} and seen < 50 {{ k := k + 10  create {name}(x = -x, y = y + 0.7, u = -0.8*u, w = 0.7*w, lane = lane, k = 10, seen = 60) }}",
                1 + dice.below(3)
            );
        }
        _ => {}
    }
    text.push_str("}\n");
}
