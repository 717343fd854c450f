//! Crowds at random, as text: many agents in an arena, with walls, teleports, pauses, and meetings that count or move.
//! A crowd may be chaotic: all its speeds are multiplied by the parameter `nudge`.

use std::fmt::Write as _;

use crate::differential::dice::Dice;

/// The model of this number.
pub fn model(seed: u64) -> String {
    let mut dice = Dice::new(seed.wrapping_add(7_000_000));
    let dims = 1 + dice.below(3);
    let names = &["x", "y", "z"][..dims];
    let n_types = 1 + dice.below(2);
    let sizes: Vec<usize> = (0..n_types).map(|_| 10 + dice.below(if dims == 1 { 20 } else { 45 })).collect();
    let half = 3.0 + dice.below(5) as f64 + if dims == 1 { 30.0 } else { 0.0 };
    let mut text = "param nudge = 1\n".to_string();
    let turning: Vec<bool> = (0..n_types).map(|ty| agent(&mut dice, ty, names, half, &mut text)).collect();
    for number in 0..1 + dice.below(3) {
        interaction(&mut dice, number, names, n_types, &mut text);
    }
    let _ = writeln!(text, "system {{");
    for (ty, &size) in sizes.iter().enumerate() {
        for k in 0..size {
            let mut arguments: Vec<String> =
                names.iter().map(|name| format!("{name} = {}", dice.number(-half, half))).collect();
            arguments.push(format!("u = {}", dice.signed(0.1, if turning[ty] { 2.0 } else { 3.0 })));
            arguments.push(format!("w = {}", dice.signed(0.2, 3.0)));
            let _ =
                writeln!(text, "  {}{k} = {}({})", ["p", "q"][ty], ["Pod", "Qit"][ty], arguments.join(", "));
        }
    }
    let _ = writeln!(text, "}}");
    let _ = writeln!(text, "run {{ until {} }}", dice.number(0.6, 1.8));
    text
}

/// An agent type; whether it turns.
fn agent(dice: &mut Dice, ty: usize, names: &[&str], half: f64, text: &mut String) -> bool {
    let name = ["Pod", "Qit"][ty];
    let kind = dice.below(4);
    let _ = writeln!(text, "agent {name}(w: real) {{");
    let turns = kind >= 2;
    let _ = writeln!(text, "  state {}{}", names.join(", "), if turns { ", th = w" } else { "" });
    let _ = writeln!(text, "  discrete u = 0, k: int = 0, met: int = 0");
    // where it goes: straight, to a point, turning steadily, or on a wave
    let rate = |axis: usize, dice: &mut Dice| match (kind, axis) {
        (0, 0) => "u".to_string(),
        (0, _) => "0.7*w".to_string(),
        (1, _) => format!("u - {}*{}", dice.number(0.1, 0.4), names[axis]),
        (2, 0) => "u*cos(th)".to_string(),
        (2, _) => "u*sin(th)".to_string(),
        (_, 0) => format!("u + cos({}*time + th)", dice.number(1.0, 3.0)),
        (_, _) => "0.5*w*sin(th)".to_string(),
    };
    let rates: Vec<String> =
        (0..names.len()).map(|axis| format!("{}' = nudge*({})", names[axis], rate(axis, dice))).collect();
    let turn = if turns { if dice.percent(30) { "  th' = w - 0.1*th" } else { "  th' = w" } } else { "" };
    let flow = format!("flow {{ {}{turn} }}", rates.join("  "));
    let modes = dice.percent(50);
    if modes {
        let _ = writeln!(text, "  initial mode Go {{");
        let _ = writeln!(text, "    {flow}");
        if dice.percent(50) {
            let _ = writeln!(text, "    entry {{ k := k + 1 }}");
        }
        match dice.below(4) {
            0 => {
                let _ = writeln!(text, "    tire: after {} -> Rest", dice.number(0.5, 2.0));
            }
            1 => {
                let _ = writeln!(text, "    tire: after 0.5 + 0.1*abs(w) -> Rest {{ u := -u }}");
            }
            2 => {
                let _ = writeln!(text, "    tire: when met >= {} -> Rest", 1 + dice.below(3));
            }
            _ => {
                let _ = writeln!(text, "    tire: when {} >= {} -> Rest", names[0], dice.number(0.0, half));
            }
        }
        let _ = writeln!(text, "  }}\n  mode Rest {{");
        let fast = dice.pick(&["0", "0", "8*u", "0.1*u"]).to_string();
        let zero: Vec<String> = names
            .iter()
            .enumerate()
            .map(|(axis, name)| format!("{name}' = {}", if axis == 0 { &fast } else { "0" }))
            .collect();
        let _ = writeln!(text, "    flow {{ {}{} }}", zero.join("  "), if turns { "  th' = 0" } else { "" });
        if dice.percent(40) {
            let _ = writeln!(text, "    exit {{ met := 0 }}");
        }
        let _ = writeln!(text, "    wake: after {} -> Go", dice.number(0.1, 0.9));
        let _ = writeln!(text, "  }}");
    } else {
        let _ = writeln!(text, "  {flow}");
    }
    // walls, or round the arena; where it does not push back, once is enough
    match dice.below(4) {
        0 if kind == 0 => {
            let _ = writeln!(text, "  right: when {} >= {half} {{ u := -abs(u) }}", names[0]);
            let _ = writeln!(text, "  left: when {} <= -{half} {{ u := abs(u) }}", names[0]);
        }
        1 | 2 => {
            let _ = writeln!(text, "  right: when {0} >= {half} {{ {0} := {0} - 2*{half} + 0.1 }}", names[0]);
            let _ = writeln!(text, "  left: when {0} <= -{half} {{ {0} := {0} + 2*{half} - 0.1 }}", names[0]);
        }
        _ => {}
    }
    match dice.below(5) {
        0 => {
            let _ = writeln!(
                text,
                "  jump: every 0.7 + 0.3*abs(w) {{ {0} := mod({0} + 3.7*w + {half}, 2*{half}) - {half} }}",
                names[0]
            );
        }
        1 => {
            let _ = writeln!(text, "  sway: every {} {{ u := -0.9*u }}", dice.number(0.3, 1.5));
        }
        2 => {
            let _ = writeln!(
                text,
                "  crowd: when (count o in other {name} where abs(o.{0} - {0}) <= {1}) >= 2 {{ met := met + 10 }}",
                names[0],
                dice.number(0.1, 0.6)
            );
        }
        3 => {
            let _ = writeln!(
                text,
                "  near: when exists o in other {name} where o.k >= 1: abs(o.{0} - {0}) <= {1} {{ met := met + 10 }}",
                names[0],
                dice.number(0.1, 0.5)
            );
        }
        _ => {}
    }
    text.push_str("}\n");
    turns
}

fn interaction(dice: &mut Dice, number: usize, names: &[&str], n_types: usize, text: &mut String) {
    let (a, b) = (dice.below(n_types), dice.below(n_types));
    let range = dice.number(0.2, 1.0);
    let n = 1 + dice.below(names.len());
    let distance: Vec<String> = names[..n].iter().map(|s| format!("(a.{s} - b.{s})^2")).collect();
    let near = format!("{} <= {range}^2", distance.join(" + "));
    let guard = match dice.below(6) {
        0 => format!("{near} and a.u > b.u"),
        1 => format!("{near} and a.k == b.k"),
        2 => format!("hypot(a.{0} - b.{0}, 0.3) <= {range} + 0.3", names[0]),
        3 => format!("abs(a.{0} - b.{0}) <= {range} and time >= 0.5", names[0]),
        _ => near,
    };
    let actions = match dice.below(6) {
        0 => "a.u := -a.u".to_string(),
        1 => "a.u := b.u  b.u := a.u".to_string(),
        2 => format!("b.{0} := b.{0} + 1.7", names[0]),
        3 => "a.k := a.k + 1".to_string(),
        _ => "a.met := a.met + 1  b.met := b.met + 1".to_string(),
    };
    let types = ["Pod", "Qit"];
    let _ = writeln!(text, "interaction Meet{number}(a: {}, b: {}) {{", types[a], types[b]);
    let _ = writeln!(text, "  pair: when {guard} {{ {actions} }}\n}}");
}
