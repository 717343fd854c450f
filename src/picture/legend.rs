//! The legend of a plot: who has which line, which mode which band. Entries that do not fit into a row begin the next.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::sheet::{Failed, INK, LEFT, NAMED_MAX, WIDTH, band_styles, below_rows, clipped, line_style};
use super::traces::Traces;

/// The height of a row.
const ROW: u32 = 26;
/// So many modes are named.
const MODES_MAX: usize = 40;

/// What an entry explains, by number.
enum Entry {
    Agent(usize),
    Mode(usize),
}

/// The height of the legend.
pub(super) fn legend_height(traces: &Traces) -> u32 {
    rows(traces).len() as u32 * ROW
}

/// Draws it, from the top of the area on.
pub(super) fn legend<B: DrawingBackend>(area: &DrawingArea<B, Shift>, traces: &Traces) -> Result<(), Failed>
where
    B::ErrorType: 'static,
{
    let style = ("sans-serif", 13).into_font().color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
    for (row, entries) in rows(traces).into_iter().enumerate() {
        let y = 12 + (row as u32 * ROW) as i32;
        for (x, entry, name) in entries {
            match entry {
                Entry::Agent(agent) => {
                    area.draw(&PathElement::new([(x, y), (x + 22, y)], line_style(traces, agent)))?
                }
                Entry::Mode(mode) => {
                    let corners = [(x, y - 6), (x + 14, y + 6)];
                    for style in band_styles(mode) {
                        area.draw(&Rectangle::new(corners, style))?;
                    }
                }
            }
            area.draw(&Text::new(name, (x + 28, y), style.clone()))?;
        }
    }
    Ok(())
}

/// The entries of each row: where each begins, what it explains, and its text.
fn rows(traces: &Traces) -> Vec<Vec<(i32, Entry, String)>> {
    let has_names = (2..=NAMED_MAX).contains(&traces.agents.len()) && !traces.columns.is_empty();
    let agents: Vec<_> = match has_names {
        true => traces
            .agents
            .iter()
            .enumerate()
            .map(|(k, trace)| (Entry::Agent(k), clipped(&trace.name)))
            .collect(),
        false => Vec::new(),
    };
    let mut modes: Vec<_> = match below_rows(traces) {
        0 if !traces.columns.is_empty() => Vec::new(),
        _ => drawn_modes(traces)
            .into_iter()
            .map(|mode| (Entry::Mode(mode), traces.modes[mode].clone()))
            .collect(),
    };
    if modes.len() < 2 {
        modes.clear();
    }
    let mut rows = Vec::new();
    for entries in [agents, modes].into_iter().filter(|entries| !entries.is_empty()) {
        let mut row = Vec::new();
        let mut x = LEFT as i32;
        for (entry, name) in entries {
            let wide = 44 + 8 * name.chars().count() as i32;
            if x + wide > WIDTH as i32 && !row.is_empty() {
                rows.push(std::mem::take(&mut row));
                x = LEFT as i32;
            }
            row.push((x, entry, name));
            x += wide;
        }
        rows.push(row);
    }
    rows
}

/// The modes that some agent is in, rising.
fn drawn_modes(traces: &Traces) -> Vec<usize> {
    let mut is_drawn = vec![false; traces.modes.len()];
    for &mode in traces.agents.iter().flat_map(|trace| &trace.modes).flatten() {
        is_drawn[mode] = true;
    }
    (0..is_drawn.len()).filter(|&mode| is_drawn[mode]).take(MODES_MAX).collect()
}
