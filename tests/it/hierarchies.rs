//! Does a model with modes in modes do what the same model does without them? Trees of modes are generated, and written twice: as
//! they are, and flat, with a mode for each leaf, a transition for each leaf that it can leave and each history that it can find, and
//! exit and entry actions put into each other. The two must tell the same events. And regions: an agent with two of them
//! against two agents with one each.

use std::fmt::Write as _;

use hyc::runtime::Algorithm;
use hyc::runtime::paper::Form;

use crate::differential::dice::Dice;
use crate::harness::{Case, Ended, Run, near};

/// A node of the tree; number 0 is the agent.
struct Node {
    parent: usize,
    children: Vec<usize>,
    /// Which of the children is initial.
    initial: usize,
    x_rate: String,
    /// The rate of y, if it stands here.
    y_rate: Option<String>,
    /// Whether there are actions on exit and on entry.
    acts: [bool; 2],
    transitions: Vec<Step>,
}

struct Step {
    number: usize,
    after: Option<String>,
    guard: Option<String>,
    priority: &'static str,
    /// None: stays.
    target: Option<(usize, Inside)>,
    /// New x and y; whether seq is written.
    resets: [String; 2],
    writes_seq: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Inside {
    Initial,
    History,
}

struct Tree {
    nodes: Vec<Node>,
    n_steps: usize,
}

impl Tree {
    fn generate(dice: &mut Dice) -> Self {
        let mut tree = Tree { nodes: Vec::new(), n_steps: 0 };
        tree.add(0, 0, false, dice);
        for node in 1..tree.nodes.len() {
            let mut steps = Vec::new();
            for _ in 0..=dice.below(2) {
                steps.push(tree.step(node, dice));
            }
            tree.nodes[node].transitions = steps;
        }
        tree
    }

    fn add(&mut self, parent: usize, depth: usize, has_y: bool, dice: &mut Dice) -> usize {
        let id = self.nodes.len();
        let n_children = match depth {
            0 => 2 + dice.below(2),
            1 | 2 if dice.percent(60) => 1 + dice.below(3),
            _ => 0,
        };
        let y_here = !has_y && depth > 0 && (n_children == 0 || dice.percent(40));
        let y_rate = y_here.then(|| dice.signed(0.3, 1.5));
        let acts = [dice.percent(50), dice.percent(50)].map(|acts| acts && depth > 0);
        let x_rate = dice.signed(0.5, 2.0);
        let transitions = Vec::new();
        let initial = dice.below(n_children.max(1));
        self.nodes.push(Node { parent, children: Vec::new(), initial, x_rate, y_rate, acts, transitions });
        for _ in 0..n_children {
            let child = self.add(id, depth + 1, has_y || y_here, dice);
            self.nodes[id].children.push(child);
        }
        id
    }

    fn step(&mut self, source: usize, dice: &mut Dice) -> Step {
        let threshold = |dice: &mut Dice| {
            let (variable, bound) = (*dice.pick(&["x", "y"]), dice.number(1.0, 3.0));
            match dice.percent(50) {
                true => format!("{variable} >= {bound}"),
                false => format!("{variable} <= -{bound}"),
            }
        };
        let after = dice.percent(40).then(|| dice.number(0.3, 2.5));
        let guard = (after.is_none() || dice.percent(30)).then(|| threshold(dice));
        let is_leaf = self.nodes[source].children.is_empty();
        let stays = is_leaf && guard.is_some() && after.is_none() && dice.percent(20);
        let target = (!stays).then(|| {
            let mode = 1 + dice.below(self.nodes.len() - 1);
            let inside = match !self.nodes[mode].children.is_empty() && dice.percent(50) {
                true => Inside::History,
                false => Inside::Initial,
            };
            (mode, inside)
        });
        self.n_steps += 1;
        Step {
            number: self.n_steps,
            after,
            guard,
            priority: dice.pick::<&str>(&["", "", "", " priority 1", " priority -1"]),
            target,
            resets: [dice.signed(0.0, 0.5), dice.signed(0.0, 0.5)],
            writes_seq: dice.percent(30),
        }
    }

    fn around(&self, node: usize) -> Vec<usize> {
        let mut list = vec![node];
        while list[list.len() - 1] != 0 {
            list.push(self.nodes[list[list.len() - 1]].parent);
        }
        list
    }

    fn path(&self, node: usize) -> String {
        let mut names: Vec<String> =
            self.around(node).iter().filter(|&&id| id != 0).map(|id| format!("M{id}")).collect();
        names.reverse();
        names.join(".")
    }

    fn leaves_in(&self, node: usize) -> Vec<usize> {
        let all = 0..self.nodes.len();
        all.filter(|&leaf| self.nodes[leaf].children.is_empty() && self.around(leaf).contains(&node))
            .collect()
    }

    /// A node and what is entered inside it by default.
    fn down(&self, node: usize) -> Vec<usize> {
        let mut list = vec![node];
        while let Some(&child) =
            self.nodes[list[list.len() - 1]].children.get(self.nodes[list[list.len() - 1]].initial)
        {
            list.push(child);
        }
        list
    }
}

/// What actions write, as expressions of what the variables were.
fn exited(node: usize) -> String {
    format!("mod(5*seq + {node}, 101)")
}

fn entered(node: usize, seq: &str, x: &str) -> [String; 2] {
    [format!("mod(3*({seq}) + {node}, 101)"), format!("0.8*({x}) + {}/500", node)]
}

fn own(step: &Step) -> String {
    format!("mod(7*seq + {}, 101)", step.number)
}

fn trigger(step: &Step, guards: &[String]) -> String {
    let guards: Vec<String> = step.guard.iter().chain(guards).map(|guard| format!("({guard})")).collect();
    let guard = guards.join(" and ");
    match &step.after {
        Some(delay) if guard.is_empty() => format!("after {delay}"),
        Some(delay) => format!("after {delay} when {guard}"),
        None => format!("when {guard}"),
    }
}

const HEAD: &str = "state x = 0, y = 0  discrete seq = 1";
const TAIL: &str = "system { a = A()  w = W(a = a) }  run { until 12 }";

impl Tree {
    /// As it is.
    fn nested(&self) -> String {
        let mut text = format!("agent A {{ {HEAD}\n");
        for &child in &self.nodes[0].children {
            self.write(child, &mut text);
        }
        text.push_str("}\n");
        self.watcher(&mut text, &|node| format!("a is {}", self.path(node)));
        text + TAIL
    }

    fn write(&self, id: usize, text: &mut String) {
        let node = &self.nodes[id];
        let parent = &self.nodes[node.parent];
        let initial = if parent.children[parent.initial] == id { "initial " } else { "" };
        let _ = writeln!(text, "{initial}mode M{id} {{");
        if let Some(rate) = &node.y_rate {
            let _ = writeln!(text, "flow {{ y' = {rate} }}");
        }
        if node.children.is_empty() {
            let _ = writeln!(text, "flow {{ x' = {} }}", node.x_rate);
        }
        if node.acts[0] {
            let _ = writeln!(text, "exit {{ seq := {} }}", exited(id));
        }
        if node.acts[1] {
            let [seq, x] = entered(id, "seq", "x");
            let _ = writeln!(text, "entry {{ seq := {seq}  x := {x} }}");
        }
        for step in &node.transitions {
            let target = step.target.map_or(String::new(), |(mode, inside)| {
                format!(" -> {}{}", self.path(mode), if inside == Inside::History { ".history" } else { "" })
            });
            let [x, y] = &step.resets;
            let seq = if step.writes_seq { format!("seq := {}", own(step)) } else { String::new() };
            let (label, priority) = (step.number, step.priority);
            let trigger = trigger(step, &[]);
            let _ = writeln!(text, "t{label}: {trigger}{priority}{target} {{ x := {x}  y := {y}  {seq} }}");
        }
        for &child in &node.children {
            self.write(child, text);
        }
        text.push_str("}\n");
    }

    /// Another agent that waits for modes.
    fn watcher(&self, text: &mut String, condition: &dyn Fn(usize) -> String) {
        text.push_str("agent W(a: A) { discrete n = 0\n");
        for node in 1..self.nodes.len() {
            let _ = writeln!(text, "w{node}: when {} {{ n := n + 1 }}", condition(node));
        }
        text.push_str("}\n");
    }

    /// With a mode for each leaf.
    fn flat(&self) -> String {
        let first = self.down(0);
        let (mut seq, mut x) = (1.0, 0.0);
        for &node in first.iter().filter(|&&node| self.nodes[node].acts[1]) {
            seq = f64::rem_euclid(3.0 * seq + node as f64, 101.0);
            x = 0.8 * x + node as f64 / 500.0;
        }
        let mut text = format!("agent A {{ state x = {x:?}, y = 0  discrete seq = {seq}\n");
        for node in 0..self.nodes.len() {
            let children = &self.nodes[node].children;
            let last = children.get(self.nodes[node].initial).copied().unwrap_or(0);
            let _ = writeln!(text, "discrete last{node} = {last}, since{node} = 0");
        }
        for leaf in self.leaves_in(0) {
            let initial = if first.contains(&leaf) { "initial " } else { "" };
            let _ = writeln!(text, "{initial}mode M{leaf} {{ flow {{ x' = {} }}", self.nodes[leaf].x_rate);
            let y = self.around(leaf).iter().find_map(|&node| self.nodes[node].y_rate.clone()).unwrap();
            let _ = writeln!(text, "flow {{ y' = {y} }}");
            // outer modes first: what stands first has its turn first
            for source in self.around(leaf).into_iter().rev() {
                for step in &self.nodes[source].transitions {
                    self.flat_steps(leaf, source, step, &mut text);
                }
            }
            text.push_str("}\n");
        }
        text.push_str("}\n");
        self.watcher(&mut text, &|node| {
            let leaves = self.leaves_in(node);
            leaves.iter().map(|leaf| format!("a is M{leaf}")).collect::<Vec<_>>().join(" or ")
        });
        text + TAIL
    }

    fn flat_steps(&self, leaf: usize, source: usize, step: &Step, text: &mut String) {
        let mut guards = Vec::new();
        let mut plain = Step { resets: step.resets.clone(), guard: step.guard.clone(), after: None, ..*step };
        match &step.after {
            Some(delay) if source != leaf => guards.push(format!("time - since{source} >= {delay}")),
            Some(delay) => plain.after = Some(delay.clone()),
            None => {}
        }
        let ways: Vec<(Option<usize>, Option<Vec<usize>>)> = match step.target {
            None => vec![(None, None)],
            Some((mode, Inside::Initial)) => vec![(None, Some(self.down(mode)))],
            Some((mode, Inside::History)) => {
                let way = |&child: &usize| {
                    let inside: Vec<usize> = [mode].into_iter().chain(self.down(child)).collect();
                    (Some(child), Some(inside))
                };
                self.nodes[mode].children.iter().map(way).collect()
            }
        };
        for (last, inside) in ways {
            let mut guards = guards.clone();
            guards.extend(last.map(|child| format!("last{} == {child}", self.nodes[child].parent)));
            let (label, priority) = (step.number, step.priority);
            let case = last.unwrap_or(0);
            let (target, actions) = self.flat_actions(leaf, source, step, inside.as_deref());
            let trigger = trigger(&plain, &guards);
            let _ = writeln!(text, "t{label}_{leaf}_{case}: {trigger}{priority}{target} {{ {actions} }}");
        }
    }

    /// Everything from leaving the leaf to being in the next one, as one list that reads the state before.
    fn flat_actions(
        &self,
        leaf: usize,
        source: usize,
        step: &Step,
        inside: Option<&[usize]>,
    ) -> (String, String) {
        let [mut x, y] = step.resets.clone();
        let mut seq = if step.writes_seq { own(step) } else { "seq".to_string() };
        let Some(inside) = inside else {
            return (String::new(), format!("x := {x}  y := {y}  seq := {seq}"));
        };
        let goal = inside[0];
        let stays = self.around(goal).into_iter().skip(1);
        let outside: Vec<usize> = self.around(source).into_iter().skip(1).collect();
        let scope = stays.into_iter().find(|node| outside.contains(node)).unwrap();
        let left: Vec<usize> = self.around(leaf).into_iter().take_while(|&node| node != scope).collect();
        if !step.writes_seq
            && let Some(&node) = left.iter().rev().find(|&&node| self.nodes[node].acts[0])
        {
            seq = exited(node);
        }
        let mut enters: Vec<usize> =
            self.around(goal).into_iter().skip(1).take_while(|&node| node != scope).collect();
        enters.reverse();
        enters.extend(inside);
        let mut notes = String::new();
        for &node in &enters {
            if self.nodes[node].acts[1] {
                [seq, x] = entered(node, &seq, &x);
            }
            let _ = write!(notes, "last{} := {node}  since{node} := time  ", self.nodes[node].parent);
        }
        let to = inside[inside.len() - 1];
        (format!(" -> M{to}"), format!("x := {x}  y := {y}  seq := {seq}  {notes}"))
    }
}

/// Time, label, from and to of the events, in the words of the flat model.
fn events(run: &Run) -> Vec<(f64, String, String, String)> {
    let mode = |path: &str| path.rsplit('.').next().unwrap().to_string();
    let label = |label: &str| label.split('_').next().unwrap().to_string();
    let told = run.events.iter();
    told.map(|event| (event.time, label(&event.transition), mode(&event.from), mode(&event.to))).collect()
}

/// Fails if the two models differ; tells how many events they have, none if the first ends in an error.
#[track_caller]
fn compare(nested: &str, flat: &str) -> Option<usize> {
    let by = |text: &str, form| Case::new(text).tolerance(1e-9).algorithm(Algorithm::Masim(form)).run_any();
    let [one, other] = [by(nested, Form::Fast), by(flat, Form::Plain)];
    if matches!(one.end, Ended::Error(_)) {
        return None;
    }
    let (ours, theirs) = (events(&one), events(&other));
    for (k, (a, b)) in ours.iter().zip(&theirs).enumerate() {
        let same = (a.0 - b.0).abs() <= 1e-6 && (&a.1, &a.2, &a.3) == (&b.1, &b.2, &b.3);
        assert!(same, "event {k}: {a:?} is not {b:?}\n{nested}\n\n{flat}");
    }
    assert_eq!(ours.len(), theirs.len(), "{nested}\n\n{flat}");
    for name in ["a.x", "a.y", "a.seq", "w.n"] {
        near(one.value(name), other.value(name), 1e-5);
    }
    Some(ours.len())
}

#[test]
fn modes_in_modes_do_what_they_do_written_flat() {
    let (mut n_models, mut n_events, mut n_histories) = (0, 0, 0);
    for seed in 0..80 {
        let tree = Tree::generate(&mut Dice::new(seed));
        let (nested, flat) = (tree.nested(), tree.flat());
        if let Some(events) = compare(&nested, &flat) {
            n_models += 1;
            n_events += events;
            n_histories += usize::from(nested.contains(".history"));
        }
    }
    assert!(n_models >= 60 && n_events >= 1000 && n_histories >= 20, "{n_models} {n_events} {n_histories}");
}

/// One half of an agent with two regions: its variables carry its letter, and it reads those of the other half.
fn half(own: &str, other: &str, dice: &mut Dice) -> String {
    let n = 2 + dice.below(3);
    let mut text = format!("flow {{ x{own}' = r{own} }}\n");
    for k in 0..n {
        let initial = if k == 0 { "initial " } else { "" };
        let _ = writeln!(text, "{initial}mode {own}{k} {{ entry {{ r{own} := {} }}", dice.signed(0.5, 2.0));
        for step in 0..=dice.below(2) {
            let (sign, bound) = if dice.percent(50) { (">=", "") } else { ("<=", "-") };
            let bound = format!("{bound}{}", dice.number(1.0, 2.0));
            let trigger = match dice.below(4) {
                0 => format!("after {}", dice.number(0.3, 2.0)),
                1 => format!("when OTHER.x{other} {sign} {bound} and x{own} >= 0.2"),
                2 => format!("when OTHER is {other}0 and x{own} {sign} {bound}"),
                _ => format!("when x{own} {sign} {bound}"),
            };
            let (to, x) = (dice.below(n), dice.signed(0.0, 0.2));
            let _ = writeln!(text, "{own}{k}_{step}: {trigger} -> {own}{to} {{ x{own} := {x} }}");
        }
        text.push_str("}\n");
    }
    text
}

#[test]
fn regions_do_what_agents_of_their_own_do() {
    let (mut n_models, mut n_events) = (0, 0);
    for seed in 0..60 {
        let dice = &mut Dice::new(seed + 10_000);
        let halves = [half("p", "q", dice), half("q", "p", dice)];
        let variables = |own: &str| format!("state x{own} = 0  discrete r{own} = 0");
        let [p, q] = &halves;
        let (p_in, q_in) = (
            p.replace("OTHER.", "").replace("OTHER is q", "self is Q.q"),
            q.replace("OTHER.", "").replace("OTHER is p", "self is P.p"),
        );
        let one = format!(
            "agent A {{ {} {}\nregion P {{ {p_in} }}\nregion Q {{ {q_in} }} }}\nsystem {{ a = A() }}  run {{ until 10 }}",
            variables("p"),
            variables("q")
        );
        let two = format!(
            "agent P(o: Q) {{ {} {} }}\nagent Q(o: P) {{ {} {} }}\nsystem {{ p = P(o = q)  q = Q(o = p) }}  run {{ until 10 }}",
            variables("p"),
            p.replace("OTHER", "o"),
            variables("q"),
            q.replace("OTHER", "o")
        );
        let by =
            |text: &str, form| Case::new(text).tolerance(1e-9).algorithm(Algorithm::Masim(form)).run_any();
        let [ours, theirs] = [by(&one, Form::Fast), by(&two, Form::Plain)];
        if matches!(ours.end, Ended::Error(_)) || matches!(theirs.end, Ended::Error(_)) {
            continue;
        }
        let told = |run: &Run| {
            let name = |text: &str| text.rsplit('.').next().unwrap().to_string();
            let mode = |path: &str| path.rsplit('.').next().unwrap().to_string();
            let line = |event: &crate::harness::Fired| {
                (event.time, event.micro, name(&event.transition), mode(&event.from), mode(&event.to))
            };
            run.events.iter().map(line).collect::<Vec<_>>()
        };
        let (ours_told, theirs_told) = (told(&ours), told(&theirs));
        for (a, b) in ours_told.iter().zip(&theirs_told) {
            let same = (a.0 - b.0).abs() <= 1e-6 && (a.1, &a.2, &a.3, &a.4) == (b.1, &b.2, &b.3, &b.4);
            assert!(same, "{a:?} is not {b:?}\n{one}\n\n{two}");
        }
        assert_eq!(ours_told.len(), theirs_told.len(), "{one}\n\n{two}");
        near(ours.value("a.xp"), theirs.value("p.xp"), 1e-5);
        near(ours.value("a.xq"), theirs.value("q.xq"), 1e-5);
        n_models += 1;
        n_events += ours_told.len();
    }
    assert!(n_models >= 40 && n_events >= 300, "{n_models} {n_events}");
}
