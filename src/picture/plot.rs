//! Plots of a run: variables over time with modes and events below, paths in a plane, or events alone; as SVG or PNG.
//!
//! The font is part of the program, so that pictures look the same on every machine.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::bitmap::Bitmap;
use super::legend::{legend, legend_height};
use super::lines::{Resolution, stretches};
use super::sheet::{
    FAINT, Failed, INK, LEFT, LINE, MARGIN, NAMED_MAX, WIDTH, band_styles, below_rows, clipped, line_style,
    shortened,
};
use super::traces::{Trace, Traces};

/// The height of a panel of variables, of a row of modes, of a plane.
const PANEL: u32 = 210;
const ROW: u32 = 18;
const PLANE: u32 = 640;
/// So many variables have a panel.
const PANELS_MAX: usize = 6;
/// Of more points only those are drawn that can be told apart.
const POINTS_MAX: usize = 20_000;
/// So many events are marked in a plane.
const CROSSES_MAX: usize = 2000;
/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum View {
    /// Variables, by number, over time.
    OverTime(Vec<usize>),
    /// One variable against another; none: the time.
    Plane(Option<usize>, Option<usize>),
}

/// The form of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Text.
    Svg,
    /// Points.
    Png,
}

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
            let area = Bitmap::new(&mut pixels, size).into_drawing_area();
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
        View::OverTime(columns) if columns.is_empty() => rows_height(traces) + legend_height(traces),
        View::OverTime(columns) => {
            36 + columns.len().min(PANELS_MAX) as u32 * PANEL + below + legend_height(traces)
        }
    }
}

/// The height of a picture that has rows of modes and events only.
fn rows_height(traces: &Traces) -> u32 {
    70 + traces.agents.len().clamp(4, 60) as u32 * ROW
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
        View::OverTime(columns) if columns.is_empty() => {
            let (panel, below) = rest.split_vertically(rows_height(traces) - 36);
            rows(&panel, traces, &span(traces))?;
            legend(&below, traces)?;
        }
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
        .build_cartesian_2d(span.clone(), range.clone())?;
    let resolution = resolution(traces, &chart, span, &range);
    mesh(&mut chart, if last { "time, s" } else { "" }, &traces.columns[column])?;
    for (agent, trace) in traces.agents.iter().enumerate() {
        let style = line_style(traces, agent);
        for stretch in stretches(&trace.times, &trace.values[column], resolution) {
            chart.draw_series(LineSeries::new(stretch, style))?;
        }
    }
    Ok(())
}

/// How finely lines are drawn in a chart of these ranges: of a few agents each point is kept.
fn resolution<B: DrawingBackend>(
    traces: &Traces,
    chart: &Chart<'_, B>,
    across: &Range<f64>,
    up: &Range<f64>,
) -> Resolution {
    let n_points: usize = traces.agents.iter().map(|trace| trace.times.len()).sum();
    let (wide, high) = chart.plotting_area().dim_in_pixel();
    let each = [(wide, across), (high, up)].map(|(n, range)| f64::from(n) / (range.end - range.start));
    (n_points > POINTS_MAX).then_some(each)
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
        .x_desc(shortened(across, 40, 12))
        .y_desc(shortened(up, 16, 8))
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
            let corners = [(from, row as f64 + 0.2), (to, row as f64 + 0.8)];
            chart.draw_series(band_styles(mode).map(|style| Rectangle::new(corners, style)))?;
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
    across: Option<usize>,
    up: Option<usize>,
) -> Result<(), Failed>
where
    B::ErrorType: 'static,
{
    let of = |column: Option<usize>| traces.agents.iter().flat_map(move |trace| trace.along(column)).copied();
    let [label_across, label_up] =
        [across, up].map(|column| column.map_or("time, s", |column| traces.columns[column].as_str()));
    let (mut xs, mut ys) = (spread(of(across), 0.05), spread(of(up), 0.05));
    let named = traces.agents.len() <= NAMED_MAX && traces.agents.len() > 1;
    let wide = f64::from(WIDTH - LEFT - 18 - if named { 130 } else { 0 }) / f64::from(PLANE - 60);
    if is_length(label_across) && is_length(label_up) {
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
        .build_cartesian_2d(xs.clone(), ys.clone())?;
    mesh(&mut chart, label_across, label_up)?;
    let resolution = resolution(traces, &chart, &xs, &ys);
    for (agent, trace) in traces.agents.iter().enumerate() {
        let style = line_style(traces, agent);
        for stretch in stretches(trace.along(across), trace.along(up), resolution) {
            chart.draw_series(LineSeries::new(stretch, style))?;
        }
        let place = |k: usize| (trace.along(across)[k], trace.along(up)[k]);
        let ends = (0..trace.times.len()).filter(|&k| place(k).0.is_finite() && place(k).1.is_finite());
        let ends: Vec<usize> = ends.collect();
        if let (Some(&first), Some(&last)) = (ends.first(), ends.last()) {
            chart.draw_series([Circle::new(place(first), 4, WHITE.filled())])?;
            chart.draw_series([Circle::new(place(first), 4, style)])?;
            chart.draw_series([Circle::new(place(last), 4, style.filled())])?;
        }
    }
    let crosses = if traces.events.len() > CROSSES_MAX { &[][..] } else { &traces.events[..] };
    for &(time, agent) in crosses {
        let trace = &traces.agents[agent];
        let k = trace.times.partition_point(|&t| t <= time).saturating_sub(1);
        let (Some(&x), Some(&y)) = (trace.along(across).get(k), trace.along(up).get(k)) else { continue };
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
