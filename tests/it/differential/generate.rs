//! Small models at random, as text: agents with modes, guards, resets, links, and interactions between them.
//!
//! Flows are bounded or grow at most exponentially with small rates, so that nothing leaves in finite time. Numbers have
//! three decimals, which makes events at the same time rare unless a model asks for them.

use std::fmt::Write as _;

use super::dice::Dice;
use super::tree::{Inside, Node, lives, targets, tree};

/// What is known of an agent type before its text is written.
pub struct Shape {
    /// Its name.
    pub name: &'static str,
    /// Its states.
    pub states: Vec<&'static str>,
    /// What `is` and transitions may name.
    pub modes: Vec<String>,
    /// Its modes with those inside them, if any are.
    nodes: Vec<Node>,
    /// It may be destroyed; nobody has it as a parameter.
    pub mortal: bool,
    /// It has a discrete `k` of 0, 1, 2.
    counts: bool,
    /// It has a discrete `lit`.
    switches: bool,
    /// It has a discrete `c`, a real.
    keeps: bool,
    /// It has a parameter `p`.
    pub tuned: bool,
    /// The type of the agent that its link `mate` leads to.
    pub mate: Option<usize>,
    /// It has an event `ping` that carries a real.
    pings: bool,
    /// How many there are at the start.
    pub agents: usize,
}

/// What an expression may name, and how.
pub struct View<'a> {
    /// Before a name: empty, `o.`, `mate.`, `a.`.
    pub prefix: &'a str,
    /// Whose.
    pub shape: &'a Shape,
}

/// The model of this number.
pub fn model(seed: u64) -> String {
    let mut dice = Dice::new(seed);
    let shapes = shapes(&mut dice);
    let mut text = String::new();
    for shape in &shapes {
        agent(&mut dice, &shapes, shape, &mut text);
    }
    for k in 0..[0, 0, 1, 1, 1, 2][dice.below(6)] {
        interaction(&mut dice, &shapes, k, &mut text);
    }
    system(&mut dice, &shapes, &mut text);
    let _ = writeln!(text, "run {{ until {} [s]  tolerance 1e-11 }}", dice.number(3.0, 6.0));
    text
}

/// Whether the pairs of an interaction are ordered: the generator writes it into the name.
pub fn is_ordered(interaction: &str) -> bool {
    !interaction.starts_with("Both")
}

fn shapes(dice: &mut Dice) -> Vec<Shape> {
    let n = 1 + dice.below(3);
    let mut agents = vec![1; n];
    for _ in 0..dice.below(7 - n) {
        agents[dice.below(n)] += 1;
    }
    let mortal: Vec<bool> = (0..n).map(|_| dice.lives && dice.percent(60)).collect();
    let shape = |k: usize, agents: usize, dice: &mut Dice| {
        let modes = [0, 2, 2, 3, 1][dice.below(5)];
        let nodes = if dice.lives && modes != 0 { tree(dice) } else { Vec::new() };
        let flat = (0..modes).map(|mode| format!("M{mode}")).collect();
        Shape {
            name: ["Ant", "Bee", "Cat"][k],
            states: ["x", "y", "z"][..1 + dice.below(3)].to_vec(),
            modes: if nodes.is_empty() { flat } else { targets(&nodes, "").0 },
            nodes,
            mortal: mortal[k],
            counts: dice.percent(50),
            switches: dice.percent(40),
            keeps: dice.percent(30),
            tuned: dice.percent(40),
            mate: dice.percent(35).then(|| dice.below(n)).filter(|mate| !mortal[*mate]),
            pings: dice.events && (k == 0 || dice.percent(60)),
            agents,
        }
    };
    agents.into_iter().enumerate().map(|(k, agents)| shape(k, agents, dice)).collect()
}

fn agent(dice: &mut Dice, shapes: &[Shape], shape: &Shape, text: &mut String) {
    let mut parameters = Vec::new();
    if shape.tuned {
        parameters.push("p: real".to_string());
    }
    if let Some(mate) = shape.mate {
        parameters.push(format!("mate: {}", shapes[mate].name));
    }
    let parameters =
        if parameters.is_empty() { String::new() } else { format!("({})", parameters.join(", ")) };
    let _ = writeln!(text, "agent {}{parameters} {{", shape.name);
    let _ = writeln!(text, "  state {}", shape.states.join(", "));
    let mut discretes = Vec::new();
    if shape.counts {
        discretes.push(format!("k: int = {}", dice.below(3)));
    }
    if shape.switches {
        discretes.push(format!("lit: bool = {}", dice.pick(&["true", "false"])));
    }
    if shape.keeps {
        discretes.push(format!("c = {}", dice.number(-1.0, 1.0)));
    }
    if !discretes.is_empty() {
        let _ = writeln!(text, "  discrete {}", discretes.join(", "));
    }
    if shape.pings {
        text.push_str("  event ping(w: real)\n");
    }
    // each state flows the same in all modes, or in each mode in its own way
    let (mut outer, mut inner) = (Vec::new(), Vec::new());
    for state in &shape.states {
        let everywhere = shape.modes.is_empty() || dice.percent(35);
        if everywhere { outer.push(*state) } else { inner.push(*state) }
    }
    flow(dice, shapes, shape, &outer, "  ", text);
    let outer_transitions = if shape.modes.is_empty() { 1 + dice.below(3) } else { dice.below(2) };
    for k in 0..outer_transitions {
        transition(dice, shapes, shape, &format!("t{k}"), None, "  ", text);
    }
    if dice.lives {
        lives(dice, shapes, shape, text);
    }
    if !shape.nodes.is_empty() {
        let (mut targets, histories) = targets(&shape.nodes, "");
        targets.extend(histories);
        let inside = Inside { shapes, shape, targets, around: String::new(), states: inner };
        inside.write(dice, &shape.nodes, 1, text);
        text.push_str("}\n");
        return;
    }
    for (mode, name) in shape.modes.iter().enumerate() {
        let _ = writeln!(text, "  {}mode {name} {{", if mode == 0 { "initial " } else { "" });
        flow(dice, shapes, shape, &inner, "    ", text);
        for list in ["entry", "exit"] {
            if dice.percent(20) {
                let _ = writeln!(
                    text,
                    "    {list} {{ {} }}",
                    writes(dice, shape, "", &[View { prefix: "", shape }], 1)
                );
            }
        }
        for k in 0..1 + dice.below(2) {
            transition(dice, shapes, shape, &format!("m{mode}{k}"), Some(&shape.modes), "    ", text);
        }
        text.push_str("  }\n");
    }
    text.push_str("}\n");
}

pub fn flow(
    dice: &mut Dice,
    shapes: &[Shape],
    shape: &Shape,
    states: &[&str],
    indent: &str,
    text: &mut String,
) {
    if states.is_empty() {
        return;
    }
    let _ = write!(text, "{indent}flow {{");
    if states.len() >= 2 && dice.percent(35) {
        let (a, b, w) = (states[0], states[1], dice.signed(0.7, 3.0));
        let _ = write!(text, " {a}' = {w}*{b}  {b}' = -{w}*{a}");
    } else if states.len() >= 2 && dice.percent(35) {
        let (a, b, g) = (states[0], states[1], dice.number(1.0, 4.0));
        let _ = write!(text, " {a}' = {b}  {b}' = -{g}");
    } else {
        for state in states.iter().take(2) {
            let _ = write!(text, " {state}' = {}", rate(dice, shapes, shape, state));
        }
    }
    for state in states.iter().skip(2) {
        let _ = write!(text, " {state}' = {}", rate(dice, shapes, shape, state));
    }
    text.push_str(" }\n");
}

fn rate(dice: &mut Dice, shapes: &[Shape], shape: &Shape, state: &str) -> String {
    let own = View { prefix: "", shape };
    let other = *dice.pick(&shape.states);
    let c = dice.signed(0.3, 2.0);
    match dice.below(12) {
        0 | 1 => c,
        2 => format!("{c} - {}*{state}", dice.number(0.2, 2.0)),
        3 | 4 => format!("{c}*sin({}*time + {})", dice.number(1.0, 5.0), dice.number(-3.0, 3.0)),
        5 => format!("{c}*cos({other})"),
        6 => format!("{c}*{other}*sin({}*time)", dice.number(1.0, 4.0)),
        7 if shape.mate.is_some_and(|mate| shapes[mate].name != shape.name) => {
            // types with later numbers follow earlier ones, or each other
            format!("{}*(mate.x - {state})", dice.number(0.3, 1.5))
        }
        8 if shape.counts => format!("{c}*(k - 1) + {}", dice.signed(0.1, 0.5)),
        9 if shape.switches => format!("if lit then {c} else {}", dice.signed(0.3, 2.0)),
        10 => match dice.below(4) {
            0 => format!("if {other} >= {} then {c} else {}", dice.number(-1.0, 1.0), dice.signed(0.3, 2.0)),
            1 => format!("{} - {}*abs({other})", dice.number(0.2, 1.5), dice.number(0.2, 0.8)),
            2 => format!("max({other}, {}) - {state}", dice.number(-1.0, 1.0)),
            _ => format!("{c}*cos(time) - min({other}, {})", dice.number(0.0, 1.0)),
        },
        11 if shape.tuned => format!("p - {}*{state}", dice.number(0.0, 1.0)),
        _ => format!("{c} + {}*sin({})", dice.signed(0.3, 1.5), real(dice, &own)),
    }
}

/// A real number that a view offers.
pub fn real(dice: &mut Dice, view: &View<'_>) -> String {
    let mut names: Vec<&str> = view.shape.states.clone();
    if view.shape.keeps {
        names.push("c");
    }
    format!("{}{}", view.prefix, dice.pick(&names))
}

pub fn transition(
    dice: &mut Dice,
    shapes: &[Shape],
    shape: &Shape,
    label: &str,
    targets: Option<&[String]>,
    indent: &str,
    text: &mut String,
) {
    let mut views = vec![View { prefix: "", shape }];
    if let Some(mate) = shape.mate {
        views.push(View { prefix: "mate.", shape: &shapes[mate] });
    }
    let mut witness = None;
    let hears = dice.events && dice.percent(40);
    let hazards = dice.events && dice.percent(25);
    let trigger = match dice.below(10) {
        _ if hears => heard(dice, shapes, shape, &views),
        _ if hazards => hazard(dice, &views),
        0 => format!("after {} [s]", dice.number(0.2, 1.5)),
        1 => format!("after {} [s] when {}", dice.number(0.2, 1.0), condition(dice, &views, 1)),
        2 => format!("every {} [s]", dice.number(0.3, 1.5)),
        3 => format!("every {} [s] when {}", dice.number(0.2, 0.8), condition(dice, &views, 1)),
        5 if dice.aggregates => {
            let set = dice.pick(shapes);
            format!("when {}", aggregated(dice, shape, set))
        }
        4 | 5 => {
            let set = dice.pick(shapes);
            let (guard, visible) = quantified(dice, shape, set);
            if visible {
                witness = Some(set);
            }
            format!("when {guard}")
        }
        _ => format!("when {}", condition(dice, &views, 2)),
    };
    let _ = write!(text, "{indent}{label}: {trigger}");
    if dice.percent(20) {
        let _ = write!(text, " priority {}", [1, 2, 3][dice.below(3)]);
    }
    let moves = !shape.modes.is_empty() && dice.percent(if targets.is_some() { 75 } else { 40 });
    if moves {
        let _ = write!(text, " -> {}", dice.pick(targets.unwrap_or(&shape.modes)));
    }
    if let Some(set) = witness {
        views.push(View { prefix: "o.", shape: set });
    }
    if let Some(set) = witness.filter(|set| set.mortal && dice.percent(25)) {
        let _ = write!(text, " {{ destroy o{} }}", if set.agents > 1 { "" } else { "  x := 0.5*x" });
    } else if shape.mortal && !moves && dice.percent(10) {
        text.push_str(" { destroy self }");
    } else if hears && dice.percent(70) {
        let (state, c) = (dice.pick(&shape.states), dice.number(-0.5, 0.5));
        let _ = write!(text, " {{ {state} := 0.6*w + {c}{} }}", emission(dice, shape, "", &views));
    } else if !moves || dice.percent(60) {
        let n = 1 + dice.below(2);
        let _ = write!(text, " {{ {} }}", writes(dice, shape, "", &views, n));
    }
    text.push('\n');
}

/// What fires at random.
fn hazard(dice: &mut Dice, views: &[View<'_>]) -> String {
    let rate = match dice.below(4) {
        0 => format!("0.3*{}^2", real(dice, &views[0])),
        1 => format!("1 + 0.8*sin({})", real(dice, &views[0])),
        _ => dice.number(0.4, 2.5),
    };
    let guard = if dice.percent(60) { format!(" when {}", condition(dice, views, 1)) } else { String::new() };
    format!("rate {rate}{guard}")
}

/// What waits for a message.
fn heard(dice: &mut Dice, shapes: &[Shape], shape: &Shape, views: &[View<'_>]) -> String {
    let from = match (dice.below(4), shape.mate) {
        (0, _) if shape.pings => " from self",
        (1 | 2, Some(mate)) if shapes[mate].pings => " from mate",
        _ => "",
    };
    let sign = *dice.pick(&["<=", ">="]);
    let guard = match dice.below(5) {
        0 => format!(" when {}", condition(dice, views, 1)),
        1 => format!(" when w {sign} {}", real(dice, &views[0])),
        2 => format!(" when w {sign} {} or {}", dice.number(-0.5, 0.5), comparison(dice, views)),
        _ => String::new(),
    };
    format!("on ping(w){from}{guard}")
}

/// Perhaps an event that the target emits.
fn emission(dice: &mut Dice, shape: &Shape, target: &str, views: &[View<'_>]) -> String {
    if !shape.pings || !dice.percent(45) {
        return String::new();
    }
    let value = if dice.percent(50) { dice.number(-1.0, 1.0) } else { real(dice, &views[0]) };
    let delay =
        if dice.percent(50) { format!(" after {} [s]", dice.number(0.05, 0.9)) } else { String::new() };
    format!("  emit {target}ping({value}){delay}")
}

/// A guard over a set; whether the agent it finds may be named in the actions.
fn quantified(dice: &mut Dice, shape: &Shape, set: &Shape) -> (String, bool) {
    let other = if set.name == shape.name { "other " } else { "" };
    let (own, bound) = (View { prefix: "", shape }, View { prefix: "o.", shape: set });
    let filter = if set.counts && dice.percent(30) {
        format!(" where o.k {} {}", dice.pick(&["==", "!="]), dice.below(3))
    } else if set.modes.len() > 1 && dice.percent(25) {
        format!(" where o is {}", dice.pick(&set.modes))
    } else {
        String::new()
    };
    let forall = dice.percent(35);
    let (a, b) = (real(dice, &own), real(dice, &bound));
    let body = match dice.below(4) {
        0 => format!("{b} {} {}", dice.pick(&["<=", ">=", "<", ">"]), dice.number(-1.2, 1.2)),
        1 => format!("({a} - {b})^2 {} {}", if forall { ">=" } else { "<=" }, dice.number(0.05, 0.8)),
        2 => format!("abs({a} - {b}) {} {}", if forall { ">" } else { "<" }, dice.number(0.1, 1.0)),
        _ => format!("{a} {} {b} + {}", dice.pick(&["<=", ">="]), dice.number(-0.8, 0.8)),
    };
    let kind = if forall { "forall" } else { "exists" };
    let guard = format!("{kind} o in {other}{}{filter}: {body}", set.name);
    if dice.percent(25) {
        return (format!("{} and {guard}", comparison(dice, &[own])), !forall);
    }
    if dice.percent(12) {
        return (format!("not {guard}"), false);
    }
    (guard, !forall)
}

/// A guard that compares an aggregate.
fn aggregated(dice: &mut Dice, shape: &Shape, set: &Shape) -> String {
    let other = if set.name == shape.name && dice.percent(70) { "other " } else { "" };
    let range = format!("o in {other}{}", set.name);
    let (own, bound) = (View { prefix: "", shape }, View { prefix: "o.", shape: set });
    let filter = match dice.below(4) {
        0 if set.counts => format!("o.k {} {}", dice.pick(&["==", "!="]), dice.below(3)),
        1 => format!("abs({} - {}) <= {}", real(dice, &own), real(dice, &bound), dice.number(0.2, 1.2)),
        _ => comparison(dice, &[bound]),
    };
    let bound = View { prefix: "o.", shape: set };
    let sign = *dice.pick(&["<=", ">=", "<", ">"]);
    let (a, b) = (real(dice, &own), real(dice, &bound));
    let guard = match dice.below(8) {
        0..=2 => {
            format!("(count {range} where {filter}) {} {}", dice.pick(&["<=", ">=", "=="]), dice.below(3))
        }
        3 => format!("(sum {range}: {b}) {sign} {}", dice.number(-1.5, 1.5)),
        4 => format!("(sum {range} where {filter}: {b} + 0.5*{a}) {sign} {}", dice.number(-1.0, 1.0)),
        5 => format!("({} {range}: {b} - {a}) {sign} {}", dice.pick(&["min", "max"]), dice.number(-1.2, 1.2)),
        6 => format!(
            "({} {range} where {filter}: {b}) {sign} {a} + {}",
            dice.pick(&["min", "max"]),
            dice.number(-0.8, 0.8)
        ),
        _ => format!("(max {range}: {b})*(min {range}: {b}) {sign} {}", dice.number(-0.6, 0.6)),
    };
    if dice.percent(25) { format!("{} and {guard}", comparison(dice, &[own])) } else { guard }
}

/// A condition over what the views offer.
fn condition(dice: &mut Dice, views: &[View<'_>], depth: usize) -> String {
    if depth == 0 || dice.percent(60) {
        return comparison(dice, views);
    }
    let (a, b) = (condition(dice, views, depth - 1), condition(dice, views, depth - 1));
    match dice.below(5) {
        0 | 1 => format!("({a}) and ({b})"),
        2 | 3 => format!("({a}) or ({b})"),
        _ => format!("not ({a})"),
    }
}

pub fn comparison(dice: &mut Dice, views: &[View<'_>]) -> String {
    let view = dice.pick(views);
    let prefix = view.prefix;
    let sign = *dice.pick(&["<=", ">=", "<", ">"]);
    match dice.below(14) {
        0 if view.shape.counts => {
            format!("{prefix}k {} {}", dice.pick(&["==", "!=", "<=", ">"]), dice.below(3))
        }
        1 if view.shape.switches => format!("{}{prefix}lit", dice.pick(&["", "not "])),
        2 if !view.prefix.is_empty() && view.shape.modes.len() > 1 => {
            format!("{} is {}", prefix.trim_end_matches('.'), dice.pick(&view.shape.modes))
        }
        3 => format!("time >= {} [s]", dice.number(0.5, 3.0)),
        4 => format!("{prefix}x^2 + {}^2 {sign} {}", real(dice, view), dice.number(0.2, 2.0)),
        5 => {
            format!("({} - {})^2 {sign} {}", real(dice, view), dice.number(-1.0, 1.0), dice.number(0.02, 1.0))
        }
        6 => {
            format!("{} {sign} {}*{}", real(dice, view), dice.signed(0.5, 1.5), real(dice, dice_view(views)))
        }
        7 => format!(
            "{} + {} {sign} {}",
            real(dice, view),
            real(dice, dice_view(views)),
            dice.number(-1.0, 1.0)
        ),
        8 => format!("sin({}*time) {sign} {}", dice.number(1.5, 6.0), dice.number(-0.9, 0.9)),
        _ => format!("{} {sign} {}", real(dice, view), dice.number(-1.2, 1.2)),
    }
}

fn dice_view<'a, 'b>(views: &'a [View<'b>]) -> &'a View<'b> {
    &views[views.len() - 1]
}

/// Assignments to so many different variables of an agent, reading what the views offer.
pub fn writes(dice: &mut Dice, shape: &Shape, target: &str, views: &[View<'_>], n: usize) -> String {
    let mut names: Vec<&str> = shape.states.clone();
    if shape.counts {
        names.push("k");
    }
    if shape.switches {
        names.push("lit");
    }
    if shape.keeps {
        names.push("c");
    }
    let mut list = Vec::new();
    for _ in 0..n.min(names.len()) {
        let name = names.remove(dice.below(names.len()));
        let left = format!("{target}{name}");
        let write = |dice: &mut Dice| format!("{left} := {}", value(dice, name, &left, shape, views));
        if dice.percent(12) {
            let test = comparison(dice, views);
            let (then, otherwise) = (write(dice), write(dice));
            list.push(format!("if {test} {{ {then} }} else {{ {otherwise} }}"));
        } else {
            list.push(write(dice));
        }
    }
    list.join("  ") + &emission(dice, shape, target, views)
}

fn value(dice: &mut Dice, name: &str, left: &str, shape: &Shape, views: &[View<'_>]) -> String {
    let view = &views[dice.below(views.len())];
    match name {
        "k" => {
            dice.pick(&[format!("mod({left} + 1, 3)"), format!("2 - {left}"), "0".into(), "1".into()]).clone()
        }
        "lit" => {
            dice.pick(&[format!("not {left}"), format!("not {left}"), "true".into(), "false".into()]).clone()
        }
        _ => match dice.below(6) {
            0 | 1 => dice.number(-1.2, 1.2),
            2 if dice.aggregates => {
                let kind = dice.pick(&["sum", "min", "max", "count"]);
                let range = format!("o in {}", shape.name);
                match *kind {
                    "count" => format!("0.3*(count {range} where o.x >= {})", dice.number(-0.5, 0.5)),
                    kind => format!("0.4*({kind} {range}: o.x - {})", dice.number(-0.5, 0.5)),
                }
            }
            2 => format!("-{left}"),
            3 => format!("-{}*{left}", dice.number(0.3, 0.9)),
            4 => format!("{left} {} {}", dice.pick(&["+", "-"]), dice.number(0.3, 2.0)),
            _ => format!("0.5*{} + {}", real(dice, view), dice.number(-1.0, 1.0)),
        },
    }
}

fn interaction(dice: &mut Dice, shapes: &[Shape], number: usize, text: &mut String) {
    let a = dice.pick(shapes);
    let b = if dice.percent(60) { a } else { dice.pick(shapes) };
    let (first, second) = (View { prefix: "a.", shape: a }, View { prefix: "b.", shape: b });
    let both = a.name == b.name && dice.percent(60);
    let near = |dice: &mut Dice, sign: &str| {
        let shared = a.states.len().min(b.states.len());
        let terms = a.states[..shared.min(1 + dice.below(2))].iter().map(|s| format!("(a.{s} - b.{s})^2"));
        format!("{} {sign} {}", terms.collect::<Vec<_>>().join(" + "), dice.number(0.02, 0.6))
    };
    let guard = if both {
        near(dice, "<=")
    } else {
        match dice.below(3) {
            0 => format!("{} and {}", near(dice, "<="), comparison(dice, &[first])),
            1 => format!("{} >= {} + {}", real(dice, &first), real(dice, &second), dice.number(0.1, 0.9)),
            _ => format!(
                "{} > {} and {}",
                real(dice, &first),
                real(dice, &second),
                comparison(dice, &[second])
            ),
        }
    };
    let actions = if both { symmetric(dice, a) } else { lopsided(dice, a, b) };
    let name = if both { "Both" } else { "Each" };
    let _ = writeln!(text, "interaction {name}{number}(a: {}, b: {}) {{", a.name, b.name);
    let _ = write!(text, "  pair: when {guard}");
    if dice.percent(20) {
        let _ = write!(text, " priority {}", 1 + dice.below(2));
    }
    let _ = writeln!(text, " {{ {actions} }}\n}}");
}

/// Actions that are the same when the participants change places.
fn symmetric(dice: &mut Dice, shape: &Shape) -> String {
    let state = *dice.pick(&shape.states);
    let (c, d) = (dice.signed(0.3, 1.2), dice.number(0.2, 1.2));
    let write = match dice.below(5) {
        0 => ("{a} := {b}").to_string(),
        1 => format!("{{a}} := -{d}*{{a}}"),
        2 => format!("{{a}} := {{a}} + {c}*({{a}} - {{b}})"),
        3 if shape.counts => "{A}k := mod({A}k + 1, 3)".to_string(),
        4 if shape.modes.len() > 1 => format!("{{N}} -> {}", dice.pick(&shape.modes)),
        _ => format!("{{a}} := {c}"),
    };
    let side = |own: &str, other: &str| {
        write
            .replace("{a}", &format!("{own}.{state}"))
            .replace("{b}", &format!("{other}.{state}"))
            .replace("{A}", &format!("{own}."))
            .replace("{N}", own)
    };
    format!("{}  {}", side("a", "b"), side("b", "a"))
}

/// Actions that are not.
fn lopsided(dice: &mut Dice, a: &Shape, b: &Shape) -> String {
    let views = [View { prefix: "a.", shape: a }, View { prefix: "b.", shape: b }];
    let mut list = Vec::new();
    let which = dice.below(3);
    if which != 0 {
        list.push(writes(dice, a, "a.", &views, 1));
    }
    if which != 1 {
        list.push(writes(dice, b, "b.", &views, 1));
    }
    if which == 0 && b.mortal && dice.percent(40) {
        return format!("{}  destroy b", list.join("  "));
    }
    if b.modes.len() > 1 && dice.percent(30) {
        list.push(format!("b -> {}", dice.pick(&b.modes)));
    }
    list.join("  ")
}

fn system(dice: &mut Dice, shapes: &[Shape], text: &mut String) {
    text.push_str("system {\n");
    for shape in shapes {
        for k in 0..shape.agents {
            let name = |shape: &Shape, k: usize| format!("{}{k}", shape.name.to_lowercase());
            let mut arguments = Vec::new();
            for state in &shape.states {
                arguments.push(format!("{state} = {}", dice.number(-1.3, 1.3)));
            }
            if shape.tuned {
                arguments.push(format!("p = {}", dice.signed(0.3, 1.5)));
            }
            if let Some(mate) = shape.mate {
                let mate = &shapes[mate];
                arguments.push(format!("mate = {}", name(mate, dice.below(mate.agents))));
            }
            let _ = writeln!(text, "  {} = {}({})", name(shape, k), shape.name, arguments.join(", "));
        }
    }
    text.push_str("}\n");
}
