//! Mode diagrams in the language of Graphviz, for who wants to lay them out otherwise.

use std::fmt::Write;

use super::palette::{colour, hex};
use crate::model::{Arrow, Diagram};

/// One graph with a cluster for each agent type.
pub fn modes_dot(diagrams: &[Diagram]) -> String {
    let mut dot = Dot { text: String::new(), colour: 0 };
    dot.line(0, "digraph modes {");
    dot.line(1, "compound=true; fontname=\"sans-serif\"; rankdir=TB;");
    dot.line(1, "node [shape=box, style=\"rounded\", fontname=\"sans-serif\"];");
    dot.line(1, "edge [fontname=\"monospace\", fontsize=10];");
    for (number, diagram) in diagrams.iter().enumerate() {
        dot.cluster(number, diagram, 0, 1);
        for arrow in &diagram.arrows {
            dot.arrow(number, diagram, arrow);
        }
    }
    dot.line(0, "}");
    dot.text
}

struct Dot {
    text: String,
    /// The number of the next leaf's colour.
    colour: usize,
}

impl Dot {
    fn line(&mut self, depth: usize, text: &str) {
        writeln!(self.text, "{:width$}{text}", "", width = 2 * depth).expect("writing to memory cannot fail");
    }

    fn cluster(&mut self, number: usize, diagram: &Diagram, place: usize, depth: usize) {
        let shown = &diagram.boxes[place];
        let label = [std::slice::from_ref(&shown.name), &shown.lines].concat().join("\n");
        if shown.children.is_empty() {
            let colour = hex(colour(self.colour));
            self.colour += 1;
            let label = quoted(&label);
            let name = node(number, place);
            self.line(depth, &format!("{name} [label={label}, color=\"{colour}\", penwidth=2];"));
            return;
        }
        self.line(depth, &format!("subgraph cluster_{number}_{place} {{"));
        self.line(depth + 1, &format!("label={}; style=rounded; labeljust=l;", quoted(&label)));
        self.line(depth + 1, &format!("start_{number}_{place} [shape=point, label=\"\"];"));
        for &child in &shown.children {
            self.cluster(number, diagram, child, depth + 1);
            if diagram.boxes[child].initial {
                let head = if diagram.boxes[child].children.is_empty() {
                    String::new()
                } else {
                    format!(" [lhead=cluster_{number}_{child}]")
                };
                let to = node(number, leaf(diagram, child));
                self.line(depth + 1, &format!("start_{number}_{place} -> {to}{head};"));
            }
        }
        self.line(depth, "}");
    }

    /// An arrow of a box with boxes inside is drawn from or to one of these, and cut at the outer border.
    fn arrow(&mut self, number: usize, diagram: &Diagram, arrow: &Arrow) {
        let label = arrow.label.iter().chain([&arrow.trigger]).chain(Some(&arrow.actions));
        let label: Vec<&str> = label.map(String::as_str).filter(|part| !part.is_empty()).collect();
        let mut settings = format!("label={}", quoted(&label.join("\n")));
        for (place, what) in [(arrow.from, "ltail"), (arrow.to, "lhead")] {
            if !diagram.boxes[place].children.is_empty() {
                settings += &format!(", {what}=cluster_{number}_{place}");
            }
        }
        let (from, to) = (node(number, leaf(diagram, arrow.from)), node(number, leaf(diagram, arrow.to)));
        self.line(1, &format!("{from} -> {to} [{settings}];"));
    }
}

fn node(number: usize, place: usize) -> String {
    format!("m_{number}_{place}")
}

/// The first box without boxes inside.
fn leaf(diagram: &Diagram, place: usize) -> usize {
    let first = |&place: &usize| diagram.boxes[place].children.first().copied();
    std::iter::successors(Some(place), first).last().unwrap_or(place)
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n"))
}
