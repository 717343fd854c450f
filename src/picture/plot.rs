//! Plots of a run: variables over time with modes and events below, paths in a plane, or events alone; as SVG or PNG.
//!
//! The font is part of the program, so that pictures look the same on every machine.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::palette::{Colour, colour};
use super::traces::{Trace, Traces};

/// Points across and down.
const WIDTH: u32 = 900;
/// The height of a panel of variables, of a row of modes, of a plane.
const PANEL: u32 = 210;
const ROW: u32 = 18;
const PLANE: u32 = 640;
/// So many variables have a panel.
const PANELS_MAX: usize = 6;
/// So many agents have a colour and a name of their own.
const NAMED_MAX: usize = 8;
/// So many agents have a row of modes; of more, only events are marked.
const ROWS_MAX: usize = 24;

/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum View {
    /// Variables, by number, over time.
    OverTime(Vec<usize>),
    /// One variable against another.
    Plane(usize, usize),
}

/// The form of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Text.
    Svg,
    /// Points.
    Png,
}

/// A picture could not be drawn: why.
type Failed = Box<dyn std::error::Error + Send + Sync>;

/// Draws; the bytes are those of a file.
///
/// # Errors
///
/// If the library that draws fails.
pub fn plot(traces: &Traces, view: &View, title: &str, form: Form) -> Result<Vec<u8>, String> {
    ready_font()?;
    let size = (WIDTH, height(traces, view));
    let drawn = match form {
        Form::Svg => {
            let mut text = String::new();
            let drawn =
                draw(SVGBackend::with_string(&mut text, size).into_drawing_area(), traces, view, title);
            drawn.map(|()| text.into_bytes())
        }
        Form::Png => {
            let mut pixels = vec![0; size.0 as usize * size.1 as usize * 3];
            let area = BitMapBackend::with_buffer(&mut pixels, size).into_drawing_area();
            draw(area, traces, view, title).and_then(|()| encoded(&pixels, size))
        }
    };
    drawn.map_err(|error| error.to_string())
}

/// Makes the program's font the one that plotters uses.
///
/// # Errors
///
/// If the font is broken.
pub fn ready_font() -> Result<(), String> {
    let font = include_bytes!("font/DejaVuSans-subset.ttf");
    let registered = plotters::style::register_font("sans-serif", FontStyle::Normal, font);
    registered.map_err(|_| "the font of the program is broken".to_string())
}

fn height(traces: &Traces, view: &View) -> u32 {
    let below = if below_rows(traces) > 0 { below_rows(traces) as u32 * ROW + 60 } else { 0 };
    match view {
        View::Plane(..) => PLANE + 40,
        View::OverTime(columns) if columns.is_empty() => 70 + traces.agents.len().clamp(4, 60) as u32 * ROW,
        View::OverTime(columns) => {
            36 + columns.len().min(PANELS_MAX) as u32 * PANEL + below + 26 * legend_rows(traces)
        }
    }
}

/// How many rows of modes and events there are.
fn below_rows(traces: &Traces) -> usize {
    let modes = traces.agents.iter().any(|trace| trace.modes.iter().any(Option::is_some));
    if (modes || !traces.events.is_empty()) && traces.agents.len() <= ROWS_MAX {
        traces.agents.len()
    } else {
        0
    }
}

fn legend_rows(traces: &Traces) -> u32 {
    u32::from((2..=NAMED_MAX).contains(&traces.agents.len())) + u32::from(traces.modes.len() > 1)
}

fn encoded(pixels: &[u8], (width, height): (u32, u32)) -> Result<Vec<u8>, Failed> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(bytes)
}

fn draw<B: DrawingBackend>(
    area: DrawingArea<B, Shift>,
    traces: &Traces,
    view: &View,
    title: &str,
) -> Result<(), Failed>
where
    B::ErrorType: 'static,
{
    area.fill(&WHITE)?;
    let style = ("sans-serif", 17).into_font().color(&INK);
    area.draw(&Text::new(title.to_string(), (14, 10), style))?;
    let (_, mut rest) = area.split_vertically(36);
    match view {
        View::Plane(across, up) => plane(&rest, traces, *across, *up)?,
        View::OverTime(columns) if columns.is_empty() => rows(&rest, traces, &span(traces))?,
        View::OverTime(columns) => {
            let span = span(traces);
            for (k, &column) in columns.iter().take(PANELS_MAX).enumerate() {
                let last = k + 1 == columns.len().min(PANELS_MAX) && below_rows(traces) == 0;
                let (panel, below) = rest.split_vertically(PANEL);
                over_time(&panel, traces, column, &span, last)?;
                rest = below;
            }
            if below_rows(traces) > 0 {
                let (panel, below) = rest.split_vertically(below_rows(traces) as u32 * ROW + 60);
                rows(&panel, traces, &span)?;
                rest = below;
            }
            legend(&rest, traces)?;
        }
    }
    area.present()?;
    Ok(())
}

const INK: RGBColor = RGBColor(0x1b, 0x1f, 0x24);
const FAINT: RGBColor = RGBColor(0x59, 0x63, 0x6e);
const LINE: RGBColor = RGBColor(0xe3, 0xe7, 0xeb);
const LEFT: u32 = 100;
const MARGIN: u32 = 16;

fn rgb([red, green, blue]: Colour) -> RGBColor {
    RGBColor(red, green, blue)
}

/// The colour and width of an agent's line; of many agents all look alike.
fn line_style(traces: &Traces, agent: usize) -> ShapeStyle {
    match traces.agents.len() {
        n if n <= NAMED_MAX => rgb(colour(agent)).stroke_width(2),
        n => rgb(colour(0)).mix((12.0 / n as f64).clamp(0.15, 0.7)).stroke_width(1),
    }
}

/// From the first time to the last.
fn span(traces: &Traces) -> Range<f64> {
    let times = traces.agents.iter().flat_map(|trace| [trace.times.first(), trace.times.last()]).flatten();
    let events = [traces.events.first(), traces.events.last()].into_iter().flatten().map(|(time, _)| time);
    spread(times.chain(events).copied(), 0.0)
}

/// The range of some numbers with a margin; never empty.
fn spread(values: impl Iterator<Item = f64>, margin: f64) -> Range<f64> {
    let finite = values.filter(|value| value.is_finite());
    let (low, high) =
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if low > high {
        return 0.0..1.0;
    }
    let margin = ((high - low) * margin).max(if low == high { 0.5 } else { 0.0 });
    low - margin..high + margin
}

/// Stretches of a line without gaps; of very many points those that can be seen.
fn stretches(across: &[f64], up: &[f64]) -> Vec<Vec<(f64, f64)>> {
    let mut stretches: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    for (&x, &y) in across.iter().zip(up) {
        match stretches.last_mut() {
            Some(stretch) if x.is_finite() && y.is_finite() => stretch.push((x, y)),
            Some(_) | None => stretches.push(Vec::new()),
        }
    }
    stretches.retain(|stretch| !stretch.is_empty());
    stretches.into_iter().map(thinned).collect()
}

/// Of each few neighbours the first, the lowest and the highest, in their order.
fn thinned(stretch: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let few = stretch.len() / (2 * WIDTH as usize);
    if few < 4 {
        return stretch;
    }
    let mut kept = Vec::new();
    for points in stretch.chunks(few) {
        let by = |pick: fn(f64, f64) -> bool| {
            (1..points.len()).fold(0, |best, k| if pick(points[k].1, points[best].1) { k } else { best })
        };
        let mut places = [0, by(|one, other| one < other), by(|one, other| one > other)];
        places.sort_unstable();
        kept.extend(places.map(|k| points[k]));
    }
    kept.dedup();
    kept.extend(stretch.last());
    kept
}

fn over_time<B: DrawingBackend>(
    panel: &DrawingArea<B, Shift>,
    traces: &Traces,
    column: usize,
    span: &Range<f64>,
    last: bool,
) -> Result<(), Failed>
where
    B::ErrorType: 'static,
{
    let values = traces.agents.iter().flat_map(|trace| &trace.values[column]).copied();
    let range = spread(values, 0.06);
    let mut chart = ChartBuilder::on(panel)
        .margin_right(18)
        .margin_top(8)
        .x_label_area_size(if last { 40 } else { 22 })
        .margin_left(MARGIN)
        .y_label_area_size(LEFT - MARGIN)
        .build_cartesian_2d(span.clone(), range)?;
    mesh(&mut chart, if last { "time, s" } else { "" }, &traces.columns[column])?;
    for (agent, trace) in traces.agents.iter().enumerate() {
        let style = line_style(traces, agent);
        for stretch in stretches(&trace.times, &trace.values[column]) {
            chart.draw_series(LineSeries::new(stretch, style))?;
        }
    }
    Ok(())
}

type Chart<'a, B> = ChartContext<
    'a,
    B,
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
>;

fn mesh<B: DrawingBackend>(chart: &mut Chart<'_, B>, across: &str, up: &str) -> Result<(), Failed>
where
    B::ErrorType: 'static,
{
    let small = ("sans-serif", 13).into_font().color(&FAINT);
    chart
        .configure_mesh()
        .bold_line_style(LINE)
        .light_line_style(TRANSPARENT)
        .axis_style(FAINT)
        .label_style(small.clone())
        .axis_desc_style(("sans-serif", 14).into_font().color(&INK))
        .x_labels(10)
        .y_labels(6)
        .x_label_formatter(&|x| short(*x))
        .y_label_formatter(&|y| short(*y))
        .x_desc(across)
        .y_desc(up)
        .draw()?;
    Ok(())
}

/// A tick's number without what rounding has left behind it.
fn short(value: f64) -> String {
    let text = format!("{value:.9e}");
    crate::base::number_text(text.parse().unwrap_or(value))
}

/// Modes as bands and events as ticks, a row for each agent.
fn rows<B: DrawingBackend>(
    panel: &DrawingArea<B, Shift>,
    traces: &Traces,
    span: &Range<f64>,
) -> Result<(), Failed>
where
    B::ErrorType: 'static,
{
    let n = traces.agents.len().max(1);
    let mut chart = ChartBuilder::on(panel)
        .margin_right(18)
        .margin_top(4)
        .x_label_area_size(44)
        .margin_left(MARGIN)
        .y_label_area_size(LEFT - MARGIN)
        .build_cartesian_2d(span.clone(), n as f64..0.0)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .axis_style(FAINT)
        .label_style(("sans-serif", 13).into_font().color(&FAINT))
        .axis_desc_style(("sans-serif", 14).into_font().color(&INK))
        .x_labels(10)
        .y_labels(0)
        .x_label_formatter(&|x| short(*x))
        .x_desc("time, s")
        .draw()?;
    for (row, trace) in traces.agents.iter().enumerate() {
        for (from, to, mode) in bands(trace) {
            let fill = rgb(colour(mode)).mix(0.55).filled();
            let corners = [(from, row as f64 + 0.12), (to, row as f64 + 0.88)];
            chart.draw_series([Rectangle::new(corners, fill)])?;
        }
    }
    let half = if traces.agents.len() <= 60 { 0.42 } else { 0.9 };
    for &(time, agent) in &traces.events {
        let row = agent as f64 + 0.5;
        chart
            .draw_series([PathElement::new([(time, row - half), (time, row + half)], INK.stroke_width(1))])?;
    }
    let every = n.div_ceil(60);
    let place = chart.plotting_area().get_pixel_range();
    let (left, top, high) = (place.0.start, place.1.start, (place.1.end - place.1.start) as f64 / n as f64);
    let base = panel.get_base_pixel();
    let style = ("sans-serif", 12).into_font().color(&FAINT).pos(Pos::new(HPos::Right, VPos::Center));
    for (row, trace) in traces.agents.iter().enumerate().step_by(every) {
        let y = top + ((row as f64 + 0.5) * high) as i32;
        panel.draw(&Text::new(clipped(&trace.name), (left - 6 - base.0, y - base.1), style.clone()))?;
    }
    Ok(())
}

fn clipped(name: &str) -> String {
    if name.chars().count() <= 12 { name.into() } else { name.chars().take(11).chain(['\u{2026}']).collect() }
}

/// The stretches of time in one mode.
fn bands(trace: &Trace) -> Vec<(f64, f64, usize)> {
    let mut bands: Vec<(f64, f64, usize)> = Vec::new();
    for (k, mode) in trace.modes.iter().enumerate() {
        let Some(mode) = *mode else { continue };
        let until = trace.times.get(k + 1).copied().unwrap_or(trace.times[k]);
        match bands.last_mut() {
            Some(band) if band.2 == mode && band.1 == trace.times[k] => band.1 = until,
            Some(_) | None => bands.push((trace.times[k], until, mode)),
        }
    }
    bands
}

fn plane<B: DrawingBackend>(
    panel: &DrawingArea<B, Shift>,
    traces: &Traces,
    across: usize,
    up: usize,
) -> Result<(), Failed>
where
    B::ErrorType: 'static,
{
    let of = |column: usize| traces.agents.iter().flat_map(move |trace| &trace.values[column]).copied();
    let (mut xs, mut ys) = (spread(of(across), 0.05), spread(of(up), 0.05));
    let named = traces.agents.len() <= NAMED_MAX && traces.agents.len() > 1;
    let wide = f64::from(WIDTH - LEFT - 18 - if named { 130 } else { 0 }) / f64::from(PLANE - 60);
    if is_length(&traces.columns[across]) && is_length(&traces.columns[up]) {
        // a circle is drawn as one
        let (w, h) = (xs.end - xs.start, ys.end - ys.start);
        let (dx, dy) = (((h * wide - w) / 2.0).max(0.0), ((w / wide - h) / 2.0).max(0.0));
        (xs, ys) = (xs.start - dx..xs.end + dx, ys.start - dy..ys.end + dy);
    }
    let mut chart = ChartBuilder::on(panel)
        .margin_right(if named { 148 } else { 18 })
        .margin_top(8)
        .x_label_area_size(44)
        .margin_left(MARGIN)
        .y_label_area_size(LEFT - MARGIN)
        .build_cartesian_2d(xs.clone(), ys)?;
    mesh(&mut chart, &traces.columns[across], &traces.columns[up])?;
    for (agent, trace) in traces.agents.iter().enumerate() {
        let style = line_style(traces, agent);
        for stretch in stretches(&trace.values[across], &trace.values[up]) {
            chart.draw_series(LineSeries::new(stretch, style))?;
        }
        let place = |k: usize| (trace.values[across][k], trace.values[up][k]);
        let ends = (0..trace.times.len()).filter(|&k| place(k).0.is_finite() && place(k).1.is_finite());
        let ends: Vec<usize> = ends.collect();
        if let (Some(&first), Some(&last)) = (ends.first(), ends.last()) {
            chart.draw_series([Circle::new(place(first), 4, WHITE.filled())])?;
            chart.draw_series([Circle::new(place(first), 4, style)])?;
            chart.draw_series([Circle::new(place(last), 4, style.filled())])?;
        }
    }
    for &(time, agent) in &traces.events {
        let trace = &traces.agents[agent];
        let k = trace.times.partition_point(|&t| t <= time).saturating_sub(1);
        let (Some(&x), Some(&y)) = (trace.values[across].get(k), trace.values[up].get(k)) else { continue };
        if x.is_finite() && y.is_finite() {
            chart.draw_series([Cross::new((x, y), 4, INK.stroke_width(1))])?;
        }
    }
    if named {
        for (agent, trace) in traces.agents.iter().enumerate() {
            let (x, y) = (WIDTH as i32 - 138, 20 + 20 * agent as i32);
            panel.draw(&PathElement::new([(x, y), (x + 22, y)], line_style(traces, agent)))?;
            let style = ("sans-serif", 13).into_font().color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
            panel.draw(&Text::new(clipped(&trace.name), (x + 28, y), style))?;
        }
    }
    Ok(())
}

/// Whether a column is a length in space, so that both axes have one scale.
fn is_length(name: &str) -> bool {
    let name = name.split(',').next().unwrap_or(name);
    ["x", "y", "z"].contains(&name)
}

/// Who has which line, which mode which band.
fn legend<B: DrawingBackend>(area: &DrawingArea<B, Shift>, traces: &Traces) -> Result<(), Failed>
where
    B::ErrorType: 'static,
{
    let style = ("sans-serif", 13).into_font().color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
    let mut y = 12;
    if (2..=NAMED_MAX).contains(&traces.agents.len()) {
        let mut x = LEFT as i32;
        for (agent, trace) in traces.agents.iter().enumerate() {
            area.draw(&PathElement::new([(x, y), (x + 22, y)], line_style(traces, agent)))?;
            area.draw(&Text::new(clipped(&trace.name), (x + 28, y), style.clone()))?;
            x += 44 + 8 * clipped(&trace.name).chars().count() as i32;
        }
        y += 26;
    }
    if traces.modes.len() > 1 {
        let mut x = LEFT as i32;
        for (mode, name) in traces.modes.iter().enumerate().take(10) {
            area.draw(&Rectangle::new([(x, y - 6), (x + 14, y + 6)], rgb(colour(mode)).mix(0.55).filled()))?;
            area.draw(&Text::new(name.clone(), (x + 20, y), style.clone()))?;
            x += 40 + 8 * name.chars().count() as i32;
        }
    }
    Ok(())
}
