//! What the parts of a plot share: measures, colours, styles of lines, and names.

use plotters::prelude::*;

use super::palette::{CROWD, Colour, colour};
use super::traces::Traces;

/// Points across.
pub(super) const WIDTH: u32 = 900;
/// So many agents have a colour and a name of their own.
pub(super) const NAMED_MAX: usize = 8;
/// So many agents have a row of modes; of more, only events are marked.
pub(super) const ROWS_MAX: usize = 24;
/// What is written.
pub(super) const INK: RGBColor = RGBColor(0x1b, 0x1f, 0x24);
/// What is written small.
pub(super) const FAINT: RGBColor = RGBColor(0x59, 0x63, 0x6e);
/// Behind all lines.
pub(super) const LINE: RGBColor = RGBColor(0xe3, 0xe7, 0xeb);
/// Left of all lines.
pub(super) const LEFT: u32 = 100;
/// Left of the names of the axes.
pub(super) const MARGIN: u32 = 16;

/// As the library has it.
pub(super) fn rgb([red, green, blue]: Colour) -> RGBColor {
    RGBColor(red, green, blue)
}

/// The colour and width of an agent's line; of many agents all look alike.
pub(super) fn line_style(traces: &Traces, agent: usize) -> ShapeStyle {
    match traces.agents.len() {
        n if n <= NAMED_MAX => rgb(colour(agent)).stroke_width(2),
        _ => rgb(CROWD.0).mix(CROWD.1).stroke_width(1),
    }
}

/// How a mode is marked: a ground on which events can be seen, and a border that can be seen itself.
pub(super) fn band_styles(mode: usize) -> [ShapeStyle; 2] {
    [rgb(colour(mode)).mix(0.4).filled(), rgb(colour(mode)).stroke_width(1)]
}

/// A picture could not be drawn: why.
pub(super) type Failed = Box<dyn std::error::Error + Send + Sync>;

/// How many rows of modes and events there are.
pub(super) fn below_rows(traces: &Traces) -> usize {
    let modes = traces.agents.iter().any(|trace| trace.modes.iter().any(Option::is_some));
    if (modes || !traces.events.is_empty()) && traces.agents.len() <= ROWS_MAX {
        traces.agents.len()
    } else {
        0
    }
}

/// A name with what is in its middle left out, if it is long: what tells agents apart is often at the end.
pub(super) fn clipped(name: &str) -> String {
    shortened(name, 5, 6)
}

/// A name of which so many letters are left at its begin and at its end.
pub(super) fn shortened(name: &str, begin: usize, end: usize) -> String {
    let n = name.chars().count();
    if n <= begin + end + 1 {
        return name.into();
    }
    let (first, last) = (name.chars().take(begin), name.chars().skip(n - end));
    first.chain(['\u{2026}']).chain(last).collect()
}
