//! Figures as SVG, and tables as CSV.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;

/// How a series is drawn.
#[derive(Clone, Copy, PartialEq)]
pub enum Style {
    /// A line.
    Line,
    /// A broken line.
    Dashes,
    /// Points.
    Dots,
    /// Points joined by a line.
    Chain,
}

/// A series with its label.
pub struct Series {
    pub label: String,
    pub style: Style,
    pub points: Vec<(f64, f64)>,
}

/// A series.
pub fn series(label: impl Into<String>, style: Style, points: Vec<(f64, f64)>) -> Series {
    Series { label: label.into(), style, points }
}

/// One panel of a figure.
pub struct Panel {
    pub title: String,
    pub x: String,
    pub y: String,
    pub log_y: bool,
    pub legend: SeriesLabelPosition,
    pub series: Vec<Series>,
}

/// A panel with linear axes.
pub fn panel(title: &str, x: &str, y: &str, series: Vec<Series>) -> Panel {
    let legend = SeriesLabelPosition::MiddleRight;
    Panel { title: title.into(), x: x.into(), y: y.into(), log_y: false, legend, series }
}

/// A panel with linear axes and falling curves: its legend is out of their way.
pub fn falling_panel(title: &str, x: &str, y: &str, series: Vec<Series>) -> Panel {
    Panel { legend: SeriesLabelPosition::UpperRight, ..panel(title, x, y, series) }
}

/// A panel with a logarithmic axis of y.
pub fn log_panel(title: &str, x: &str, y: &str, series: Vec<Series>) -> Panel {
    Panel { log_y: true, legend: SeriesLabelPosition::LowerRight, ..panel(title, x, y, series) }
}

/// Where everything is written.
pub fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("docs/paper")
}

const COLOURS: [RGBColor; 7] = [
    RGBColor(31, 88, 156),
    RGBColor(200, 80, 30),
    RGBColor(40, 130, 70),
    RGBColor(130, 60, 150),
    RGBColor(120, 120, 120),
    RGBColor(180, 140, 20),
    RGBColor(0, 140, 150),
];

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Draws panels side by side into `NAME.svg`, with their points in `NAME.csv`.
pub fn figure(name: &str, panels: &[Panel]) {
    let path = folder().join(format!("{name}.svg"));
    let width = 520 * panels.len() as u32;
    let drawn = (|| -> Outcome {
        let root = SVGBackend::new(&path, (width, 400)).into_drawing_area();
        root.fill(&WHITE)?;
        for (area, panel) in root.split_evenly((1, panels.len())).iter().zip(panels) {
            draw(area, panel)?;
        }
        root.present()?;
        Ok(())
    })();
    drawn.unwrap_or_else(|error| panic!("cannot draw {}: {error}", path.display()));
    let mut text = String::from("panel,series,x,y\n");
    for panel in panels {
        for series in &panel.series {
            for (x, y) in &series.points {
                let _ = writeln!(text, "{},{},{x:?},{y:?}", quoted(&panel.title), quoted(&series.label));
            }
        }
    }
    write(&folder().join(format!("{name}.csv")), &text);
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.into() }
}

/// Writes a file of results.
pub fn write(path: &Path, text: &str) {
    fs::write(path, text).unwrap_or_else(|error| panic!("cannot write {}: {error}", path.display()));
}

/// The least and the largest of all finite values that can be drawn, with a margin.
fn range(values: impl Iterator<Item = f64>, log: bool) -> std::ops::Range<f64> {
    let usable = values.filter(|v| v.is_finite() && (!log || *v > 0.0));
    let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return if log { 0.1..1.0 } else { 0.0..1.0 };
    }
    if log {
        return low / 1.5..high * 1.5;
    }
    let margin = if high > low { 0.05 * (high - low) } else { 0.5 };
    low - margin..high + margin
}

fn draw(area: &DrawingArea<SVGBackend<'_>, Shift>, panel: &Panel) -> Outcome {
    hyc::picture::ready_font()?;
    let xs = range(panel.series.iter().flat_map(|s| s.points.iter().map(|p| p.0)), false);
    let ys = range(panel.series.iter().flat_map(|s| s.points.iter().map(|p| p.1)), panel.log_y);
    if panel.log_y { on_axes(area, panel, xs, ys.log_scale()) } else { on_axes(area, panel, xs, ys) }
}

fn on_axes<R>(
    area: &DrawingArea<SVGBackend<'_>, Shift>,
    panel: &Panel,
    xs: std::ops::Range<f64>,
    ys: R,
) -> Outcome
where
    R: AsRangedCoord<Value = f64>,
    R::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, ("sans-serif", 17))
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(62)
        .build_cartesian_2d(xs, ys)?;
    let number = |value: &f64| {
        if *value != 0.0 && !(1e-3..1e5).contains(&value.abs()) {
            format!("{value:.0e}")
        } else {
            let text = format!("{value:.3}");
            text.trim_end_matches('0').trim_end_matches('.').to_string()
        }
    };
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_desc(&panel.x)
        .y_desc(&panel.y)
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .label_style(("sans-serif", 13))
        .draw()?;
    for (k, series) in panel.series.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let points = series.points.iter().copied().filter(|p| p.1.is_finite() && (!panel.log_y || p.1 > 0.0));
        let points: Vec<(f64, f64)> = points.collect();
        if matches!(series.style, Style::Line | Style::Chain) {
            chart.draw_series(LineSeries::new(points.clone(), colour.stroke_width(2)))?;
        }
        if series.style == Style::Dashes {
            chart.draw_series(DashedLineSeries::new(points.clone(), 6, 4, colour.stroke_width(2)))?;
        }
        let dots = matches!(series.style, Style::Dots | Style::Chain);
        let shown = if dots { points } else { Vec::new() };
        let drawn = chart.draw_series(shown.into_iter().map(|p| Circle::new(p, 2.5, colour.filled())))?;
        let line = !matches!(series.style, Style::Dots);
        drawn.label(&series.label).legend(move |(x, y)| {
            let (from, to) = if line { (x, x + 18) } else { (x + 7, x + 11) };
            PathElement::new(vec![(from, y), (to, y)], colour.stroke_width(if line { 2 } else { 4 }))
        });
    }
    if panel.series.len() > 1 {
        chart
            .configure_series_labels()
            .position(panel.legend.clone())
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(200, 200, 200))
            .label_font(("sans-serif", 13))
            .draw()?;
    }
    Ok(())
}
