//! The page of a run: one HTML file that holds everything it needs, and asks no network for anything.
//!
//! Samples lie in it as base64 of 32-bit numbers, column by column, agent by agent, each from its first sample to its last. Styles and
//! scripts are those of `page/`; charts are drawn by uPlot, which lies in `page/vendor/` with its licence.

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::highlight::highlighted;
use super::modes_svg::{Theme, escaped, modes_svg};
use super::palette::{ON_DARK, ON_LIGHT, declared};
use super::recording::Recording;
use crate::model::Diagram;

const TEMPLATE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");
const SCRIPT: [&str; 5] = [
    include_str!("page/run.js"),
    include_str!("page/plane.js"),
    include_str!("page/charts.js"),
    include_str!("page/events.js"),
    include_str!("page/page.js"),
];
const UPLOT_SCRIPT: &str = include_str!("page/vendor/uPlot.iife.min.js");
const UPLOT_STYLE: &str = include_str!("page/vendor/uPlot.min.css");

/// A run, for its page.
pub struct Scene<'a> {
    /// The model's name.
    pub title: &'a str,
    /// Its files; the first one is its own, the others are those that it imports.
    pub texts: &'a [Text<'a>],
    /// Where transitions stand, by their labels.
    pub places: &'a BTreeMap<String, Lines>,
    /// The modes of its agent types.
    pub diagrams: &'a [Diagram],
    /// What happened; closed.
    pub recording: &'a Recording<'a>,
    /// The columns of the record.
    pub columns: &'a [Shown],
    /// The columns that are shown across and up; none: time.
    pub plane: [Option<usize>; 2],
    /// What is drawn there besides.
    pub landmarks: &'a Landmarks,
    /// How it ended and what it took, as text.
    pub summary: &'a str,
    /// What stopped it, if an error did.
    pub error: Option<&'a str>,
    /// What is not shown of it, in words.
    pub left_out: &'a str,
}

/// What a model says of the plane: columns are those of the record, numbers are in their units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Landmarks {
    /// Where a column alone makes a guard true.
    pub walls: Vec<(usize, f64)>,
    /// How near two agents have to be in two columns for an interaction.
    pub ranges: Vec<([usize; 2], f64)>,
}

/// A column of the record, for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: Option<String>,
    /// Whether it is worth a chart over time.
    pub varies: Varies,
    /// Whether all its values are whole numbers.
    pub is_whole: bool,
}

/// A file of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Text<'a> {
    /// As the user or an `import` names it.
    pub name: &'a str,
    /// What stands in it.
    pub text: &'a str,
}

/// Lines of a file of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lines {
    /// The number of the file.
    pub file: usize,
    /// The first and the last one, from 1.
    pub lines: [usize; 2],
}

/// Whether a column changes during a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Varies {
    /// By flow or by events.
    InTime,
    /// Only from agent to agent; a whole number.
    AmongAgents,
}

/// The page.
pub fn page(scene: &Scene<'_>) -> String {
    let data = data(scene).to_string().replace('<', "\\u003c");
    let mut html = String::with_capacity(data.len() + 200_000);
    for (k, part) in TEMPLATE.split('@').enumerate() {
        if k % 2 == 0 {
            html += part;
            continue;
        }
        match part {
            "TITLE" => html += &escaped(scene.title),
            "CSS" => html += &style(),
            "UPLOT_CSS" => html += UPLOT_STYLE,
            "UPLOT_JS" => html += UPLOT_SCRIPT,
            "JS" => html += &format!("\"use strict\";\n(() => {{\n{}}})();\n", SCRIPT.concat()),
            "MODES" => html += &modes_svg(scene.diagrams, Theme::Page),
            "SOURCE" => html += &texts(scene.texts),
            "DATA" => html += &data,
            other => unreachable!("the template has no place called {other}"),
        }
    }
    html
}

/// The style sheet, with the colours of marks where its themes say which ones they have.
fn style() -> String {
    STYLE.replace("--marks: light;", &declared(&ON_LIGHT)).replace("--marks: dark;", &declared(&ON_DARK))
}

/// The files one below the other, each with a tab if there are several.
fn texts(texts: &[Text<'_>]) -> String {
    let mut html = String::new();
    if texts.len() > 1 {
        html += "<div class=\"bar\" id=\"tabs\" role=\"tablist\">";
        for (k, Text { name, .. }) in texts.iter().enumerate() {
            html += &format!(
                "<button role=\"tab\" id=\"tab{k}\" aria-controls=\"text{k}\" aria-selected=\"{}\">{}</button>",
                k == 0,
                escaped(name)
            );
        }
        html += "</div>";
    }
    for (k, Text { name, text }) in texts.iter().enumerate() {
        let (hidden, name) = (if k == 0 { "" } else { " hidden" }, escaped(name));
        html +=
            &format!("<div class=\"text\" id=\"text{k}\" role=\"tabpanel\" aria-label=\"{name}\"{hidden}>");
        html += &highlighted(text);
        html += "</div>";
    }
    html
}

/// The file, the first and the last line of a transition; null for what stands nowhere.
fn place(scene: &Scene<'_>, label: &str) -> Value {
    match scene.places.get(label) {
        Some(Lines { file, lines: [first, last] }) => json!([file, first, last]),
        None => Value::Null,
    }
}

fn data(scene: &Scene<'_>) -> Value {
    let recording = scene.recording;
    let (ending, summary) = scene.summary.split_once('\n').unwrap_or((scene.summary, ""));
    let [across, up] = scene.plane.map(|column| column.map_or(-1, |column| column as i64));
    let columns = scene.columns.iter().enumerate().map(|(k, shown)| column(recording, k, shown));
    let events = recording.events.iter().map(|event| {
        let number = |place: Option<usize>| place.map_or(-1, |place| place as i64);
        let (from, to) = (event.modes.map(|modes| modes.0), event.modes.map(|modes| modes.1));
        json!([event.time, event.transition, event.agent, number(event.other), number(from), number(to)])
    });
    let modes = recording.tracks.iter().flat_map(|track| &track.modes).flat_map(|mode| mode.to_le_bytes());
    let lives = recording.tracks.iter().flat_map(|track| [track.first as u32, track.modes.len() as u32]);
    json!({
        "ending": ending.split_once(": ").map_or(ending, |(_, ending)| ending),
        "summary": summary,
        "error": scene.error,
        "leftOut": scene.left_out,
        "agents": recording.tracks.iter().map(|track| &track.name).collect::<Vec<_>>(),
        "times": recording.times,
        "lives": base64(lives.flat_map(u32::to_le_bytes)),
        "columns": columns.collect::<Vec<_>>(),
        "modes": base64(modes),
        "modeNames": recording.modes,
        "nColours": ON_LIGHT.len(),
        "events": events.collect::<Vec<_>>(),
        "nEvents": recording.n_events,
        "transitions": recording.transitions,
        "places": recording.transitions.iter().map(|label| place(scene, label)).collect::<Vec<_>>(),
        "modePaths": recording.paths,
        "walls": scene.landmarks.walls,
        "ranges": scene.landmarks.ranges,
        "across": across,
        "up": up,
    })
}

fn column(recording: &Recording<'_>, k: usize, shown: &Shown) -> Value {
    let values = || recording.tracks.iter().flat_map(|track| &track.values[k]).copied();
    let finite = values().filter(|value| value.is_finite());
    let (low, high) =
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    // what differs little for its size is told from the middle on, so that 32 bits are enough
    let is_narrow = high - low < NARROW * low.abs().max(high.abs());
    let middle = if is_narrow { low + (high - low) / 2.0 } else { 0.0 };
    let label = match &shown.unit {
        Some(unit) => format!("{}, {unit}", shown.name),
        None => shown.name.clone(),
    };
    // where both columns of the plane have the same of these, a circle is drawn as one
    let length =
        shown.unit.clone().or_else(|| ["x", "y", "z"].contains(&&*shown.name).then(|| "plane".into()));
    json!({
        "label": label,
        "length": length,
        "chart": shown.varies == Varies::InTime,
        "whole": shown.is_whole,
        "middle": middle,
        "values": base64(values().flat_map(|value| ((value - middle) as f32).to_le_bytes())),
    })
}

/// A column whose values differ by less than this share of their size is narrow.
const NARROW: f64 = 0.01;

fn base64(bytes: impl Iterator<Item = u8>) -> String {
    STANDARD.encode(bytes.collect::<Vec<u8>>())
}
