//! Mode diagrams as SVG: the boxes of each level in layers, boxes inside boxes, texts beside their arrows.

use std::fmt::Write;

use super::layered::{Edge, Layout, Point, Size, lay_out};
use super::palette::{ON_DARK, ON_LIGHT, declared, variable};
use crate::model::{Arrow, Diagram};

/// The advance of a monospace character and the height of a line, at a font of 11 px.
const ADVANCE: f64 = 6.7;
const LINE: f64 = 15.0;
/// The title of a box.
const TITLE: f64 = 22.0;
const TITLE_ADVANCE: f64 = 8.4;
/// Between the border of a box and what is inside.
const PAD: f64 = 12.0;
/// Room for the mark of an initial mode.
const MARK: f64 = 12.0;
/// Characters on a line, lines of a condition or of a list of actions.
const WRAP: usize = 34;
const LINES_MAX: usize = 4;
/// Between two diagrams.
const APART: f64 = 30.0;

/// Who says which colours `--ink`, `--paper` and the like are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Theme {
    /// The picture itself, light or dark as its reader likes.
    Own,
    /// The page that it is part of.
    Page,
}

/// The diagrams of all agent types, one beside the other.
pub fn modes_svg(diagrams: &[Diagram], theme: Theme) -> String {
    let mut colours = 0;
    let pictures: Vec<Picture<'_>> = diagrams
        .iter()
        .map(|diagram| {
            let picture = Picture::new(diagram, colours);
            colours += diagram.boxes.iter().filter(|shown| shown.children.is_empty()).count();
            picture
        })
        .collect();
    let width: f64 = pictures.iter().map(|picture| picture.frames[0].size.width + APART).sum::<f64>() + APART;
    let height =
        pictures.iter().map(|picture| picture.frames[0].size.height).fold(0.0, f64::max) + 2.0 * APART;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"modes\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" aria-label=\"Modes of the agent types\">\n"
    );
    match theme {
        Theme::Own => svg.push_str(&own_theme()),
        Theme::Page => {}
    }
    svg.push_str(STYLE);
    let mut x = APART;
    for picture in &pictures {
        picture.draw(&mut svg, (x, APART));
        x += picture.frames[0].size.width + APART;
    }
    svg.push_str("</svg>\n");
    svg
}

fn own_theme() -> String {
    let (light, dark) = (declared(&ON_LIGHT), declared(&ON_DARK));
    format!(
        "<style>
svg.modes {{ --ink: #1b1f24; --faint: #6b7480; --paper: #ffffff; --inside: #f6f7f9; {light} background: var(--paper) }}
@media (prefers-color-scheme: dark) {{
  svg.modes {{ --ink: #e6e8eb; --faint: #9aa4af; --paper: #15181c; --inside: #1d2126; {dark} }}
}}
</style>
"
    )
}

const STYLE: &str = "<style>
.modes rect { fill: var(--inside); stroke: var(--faint); stroke-width: 1 }
.modes rect.leaf { fill: var(--paper) }
.modes path { fill: none; stroke: var(--ink); stroke-width: 1.2 }
.modes .head, .modes circle { fill: var(--ink); stroke: none }
.modes text { font: 11px ui-monospace, 'DejaVu Sans Mono', Menlo, Consolas, monospace; fill: var(--ink); white-space: pre }
.modes text.title { font: bold 13px ui-sans-serif, 'DejaVu Sans', Helvetica, Arial, sans-serif }
.modes text.label { font-weight: bold }
.modes text.faint { fill: var(--faint) }
</style>
";

/// A box, with what lies in it laid out.
struct Frame {
    size: Size,
    /// How far down the inside begins.
    head: f64,
    /// The boxes inside, then, if it is needed, the place from which transitions of the whole box leave.
    inside: Vec<usize>,
    anywhere: bool,
    layout: Layout,
    /// The arrows of this level, by number, in the order of the layout's edges.
    arrows: Vec<usize>,
    lines: Vec<String>,
    /// Of a box without boxes inside.
    colour: Option<usize>,
}

struct Picture<'a> {
    diagram: &'a Diagram,
    frames: Vec<Frame>,
}

/// On which level an arrow is drawn, and between which boxes of it (none: the box of that level as a whole).
struct Lifted {
    level: usize,
    from: Option<usize>,
    to: usize,
}

impl<'a> Picture<'a> {
    fn new(diagram: &'a Diagram, first_colour: usize) -> Self {
        let n = diagram.boxes.len();
        let mut colours = first_colour;
        let mut frames: Vec<Frame> = Vec::with_capacity(n);
        for shown in &diagram.boxes {
            let colour = shown.children.is_empty().then_some(colours);
            colours += usize::from(colour.is_some());
            frames.push(Frame {
                size: Size { width: 0.0, height: 0.0 },
                head: 0.0,
                inside: shown.children.clone(),
                anywhere: false,
                layout: Layout::default(),
                arrows: Vec::new(),
                lines: shown.lines.iter().map(|line| clipped(line)).collect(),
                colour,
            });
        }
        let mut picture = Self { diagram, frames };
        let mut edges: Vec<Vec<(Option<usize>, usize)>> = vec![Vec::new(); n];
        for (number, arrow) in diagram.arrows.iter().enumerate() {
            let Lifted { level, from, to } = picture.lift(arrow);
            if from == Some(to) {
                let line = format!("{}again", named(arrow));
                picture.frames[arrow.from].lines.push(clipped(&line));
            } else {
                picture.frames[level].arrows.push(number);
                picture.frames[level].anywhere |= from.is_none();
                edges[level].push((from, to));
            }
        }
        // inner boxes have higher numbers than those that they lie in
        for place in (0..n).rev() {
            picture.measure(place, &edges[place]);
        }
        picture
    }

    /// Outer boxes first.
    fn chain(&self, place: usize) -> Vec<usize> {
        let above = |&place: &usize| self.diagram.boxes[place].parent;
        let mut chain: Vec<usize> = std::iter::successors(Some(place), above).collect();
        chain.reverse();
        chain
    }

    fn lift(&self, arrow: &Arrow) -> Lifted {
        let (from, to) = (self.chain(arrow.from), self.chain(arrow.to));
        let shared = from.iter().zip(&to).take_while(|(one, other)| one == other).count();
        let level = from[shared - 1];
        let entered =
            || self.diagram.boxes[level].children.iter().copied().find(|&k| self.diagram.boxes[k].initial);
        match (from.get(shared), to.get(shared)) {
            (from, Some(&to)) => Lifted { level, from: from.copied(), to },
            (from, None) => match entered() {
                Some(to) => Lifted { level, from: from.copied(), to },
                None => Lifted { level, from: Some(level), to: level },
            },
        }
    }

    fn measure(&mut self, place: usize, edges: &[(Option<usize>, usize)]) {
        let frame = &self.frames[place];
        let mut order = frame.inside.clone();
        order.sort_by_key(|&child| !self.diagram.boxes[child].initial);
        let mut sizes: Vec<Size> = order.iter().map(|&child| self.frames[child].size).collect();
        if frame.anywhere {
            sizes.push(Size { width: ANYWHERE.len() as f64 * ADVANCE + PAD, height: LINE + 4.0 });
        }
        let position = |child: usize| order.iter().position(|&other| other == child).unwrap_or(0);
        let edges: Vec<Edge> = edges
            .iter()
            .zip(&frame.arrows)
            .map(|((from, to), &arrow)| Edge {
                from: from.map_or(order.len(), position),
                to: position(*to),
                text: size_of(&arrow_lines(&self.diagram.arrows[arrow])),
            })
            .collect();
        let layout = lay_out(&sizes, &edges);
        let shown = &self.diagram.boxes[place];
        let title = shown.name.chars().count() as f64 * TITLE_ADVANCE;
        let longest = frame.lines.iter().map(|line| line.chars().count()).max().unwrap_or(0) as f64 * ADVANCE;
        let head = TITLE + frame.lines.len() as f64 * LINE + if frame.lines.is_empty() { 4.0 } else { 8.0 };
        let inner = if sizes.is_empty() { 0.0 } else { layout.height + 2.0 * PAD + MARK };
        let frame = &mut self.frames[place];
        frame.size = Size { width: title.max(longest).max(layout.width) + 2.0 * PAD, height: head + inner };
        frame.head = head;
        frame.inside = order;
        frame.layout = layout;
    }

    /// Draws all, the outermost box at this corner.
    fn draw(&self, svg: &mut String, corner: Point) {
        let mut corners = vec![corner; self.frames.len()];
        for (place, frame) in self.frames.iter().enumerate() {
            let inside = self.inside_of(place, corners[place]);
            for (child, at) in frame.inside.iter().zip(&frame.layout.boxes) {
                corners[*child] = (inside.0 + at.0, inside.1 + at.1);
            }
            self.draw_box(svg, place, corners[place]);
        }
        for (place, frame) in self.frames.iter().enumerate() {
            let inside = self.inside_of(place, corners[place]);
            if frame.anywhere
                && let Some(at) = frame.layout.boxes.last()
            {
                text(svg, "faint", (inside.0 + at.0 + PAD / 2.0, inside.1 + at.1 + LINE - 2.0), ANYWHERE);
            }
            for (edge, &number) in frame.arrows.iter().enumerate() {
                self.draw_arrow(svg, number, &corners, &frame.layout, edge, inside);
            }
        }
    }

    /// The inside's corner: what is laid out stands in the middle.
    fn inside_of(&self, place: usize, (x, y): Point) -> Point {
        let frame = &self.frames[place];
        (x + (frame.size.width - frame.layout.width) / 2.0, y + frame.head + PAD + MARK)
    }

    fn draw_box(&self, svg: &mut String, place: usize, (x, y): Point) {
        let (frame, shown) = (&self.frames[place], &self.diagram.boxes[place]);
        let Size { width, height } = frame.size;
        let class = if frame.colour.is_some() { " class=\"leaf\"" } else { "" };
        put(
            svg,
            format_args!(
                "<rect{class} x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"6\"/>"
            ),
        );
        if let Some(number) = frame.colour {
            let fill = variable(number);
            let bar = height - 8.0;
            put(
                svg,
                format_args!(
                    "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"4\" height=\"{bar:.1}\" rx=\"2\" style=\"fill:{fill};stroke:none\"/>",
                    x + 3.0,
                    y + 4.0
                ),
            );
        }
        if shown.initial {
            let (x, y) = (x + 14.0, y - 16.0);
            put(svg, format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\"/>"));
            put(svg, format_args!("<path d=\"M{x:.1} {y:.1}v9\"/>"));
            head(svg, (x, y + 16.0), 1.0);
        }
        text(svg, "title", (x + PAD, y + 16.0), &shown.name);
        for (k, line) in frame.lines.iter().enumerate() {
            text(svg, "faint", (x + PAD, y + TITLE + LINE * (k as f64 + 1.0) - 3.0), line);
        }
    }

    fn draw_arrow(
        &self,
        svg: &mut String,
        number: usize,
        corners: &[Point],
        layout: &Layout,
        edge: usize,
        inside: Point,
    ) {
        let arrow = &self.diagram.arrows[number];
        let mut route: Vec<Point> =
            layout.routes[edge].iter().map(|(x, y)| (x + inside.0, y + inside.1)).collect();
        // an arrow between boxes further inside goes on to these
        let begin = self.side_of(arrow.from, corners, route[0]);
        if let Some(begin) = begin.filter(|_| self.diagram.boxes[arrow.from].children.is_empty()) {
            route.insert(0, begin);
        }
        let end = self.side_of(arrow.to, corners, route[route.len() - 1]);
        route.extend(end);
        let mut path = format!("M{:.1} {:.1}", route[0].0, route[0].1);
        for pair in route.windows(2) {
            let ((x, y), (u, v)) = (pair[0], pair[1]);
            let middle = (y + v) / 2.0;
            path += &format!("C{x:.1} {middle:.1} {u:.1} {middle:.1} {u:.1} {v:.1}");
        }
        put(svg, format_args!("<path d=\"{path}\"/>"));
        let (before, last) = (route[route.len() - 2], route[route.len() - 1]);
        head(svg, last, if before.1 <= last.1 { 1.0 } else { -1.0 });
        let (x, y) = layout.texts[edge];
        let (x, y) = (x + inside.0 + 7.0, y + inside.1);
        for (k, (class, line)) in arrow_lines(arrow).iter().enumerate() {
            text(svg, class, (x, y + LINE * (k as f64 + 1.0) - 3.0), line);
        }
    }

    /// The middle of the side of a box that looks at a point; none if the point is on its border.
    fn side_of(&self, place: usize, corners: &[Point], (x, y): Point) -> Option<Point> {
        let ((left, top), size) = (corners[place], self.frames[place].size);
        let on_border = x >= left - 1.0
            && x <= left + size.width + 1.0
            && ((y - top).abs() < 1.0 || (y - top - size.height).abs() < 1.0);
        let side = if y < top { top } else { top + size.height };
        (!on_border).then_some((left + size.width / 2.0, side))
    }
}

/// Where transitions begin that leave a whole box.
const ANYWHERE: &str = "from any mode";

/// The name of an arrow, its condition, and what it does: what class each line has, and the line.
fn arrow_lines(arrow: &Arrow) -> Vec<(&'static str, String)> {
    let label = arrow.label.iter().map(|label| ("label", label.clone()));
    let trigger = wrapped(&arrow.trigger).into_iter().map(|line| ("", line));
    let actions =
        if arrow.actions.is_empty() { Vec::new() } else { wrapped(&format!("{{ {} }}", arrow.actions)) };
    label.chain(trigger).chain(actions.into_iter().map(|line| ("faint", line))).collect()
}

fn named(arrow: &Arrow) -> String {
    let label = arrow.label.as_ref().map(|label| format!("{label}: ")).unwrap_or_default();
    format!("{label}{}, ", arrow.trigger)
}

fn size_of(lines: &[(&str, String)]) -> Size {
    let longest = lines.iter().map(|(_, line)| line.chars().count()).max().unwrap_or(0);
    Size { width: longest as f64 * ADVANCE + 12.0, height: lines.len() as f64 * LINE + 4.0 }
}

/// Broken between words; what is too long ends in dots.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + word.chars().count() < WRAP => {
                line.push(' ');
                line.push_str(word);
            }
            Some(_) | None => lines.push(word.into()),
        }
    }
    if lines.len() > LINES_MAX {
        lines.truncate(LINES_MAX);
        lines[LINES_MAX - 1].push_str(" ...");
    }
    lines
}

/// A line of a box.
fn clipped(line: &str) -> String {
    const LONGEST: usize = 44;
    if line.chars().count() <= LONGEST {
        return line.into();
    }
    line.chars().take(LONGEST - 4).collect::<String>() + " ..."
}

fn head(svg: &mut String, (x, y): Point, down: f64) {
    let back = y - 8.0 * down;
    put(svg, format_args!("<path class=\"head\" d=\"M{x:.1} {y:.1}L{:.1} {back:.1}h8z\"/>", x - 4.0));
}

fn text(svg: &mut String, class: &str, (x, y): Point, content: &str) {
    let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
    put(svg, format_args!("<text{class} x=\"{x:.1}\" y=\"{y:.1}\">{}</text>", escaped(content)));
}

/// Text as XML and HTML have it.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn put(svg: &mut String, content: std::fmt::Arguments<'_>) {
    writeln!(svg, "{content}").expect("writing to memory cannot fail");
}
