//! Do mode diagrams show the modes that a model has? Every mode once, every transition between modes, nothing outside.

use hyc::base::SourceMap;
use hyc::model::{Arrow, Diagram, ModeBox, diagrams};
use hyc::picture::{Theme, modes_dot, modes_svg};

use crate::harness::Case;

fn of(case: Case) -> Vec<Diagram> {
    let mut sources = SourceMap::default();
    let model = case.model(&mut sources).unwrap();
    diagrams(&model, &sources)
}

const FACTORY: &str = "\
agent Machine {
  state x = 0
  breaks: when x >= 9 -> Broken
  mode Broken { flow { x' = 0 }  mended: after 2 -> Slow }
  initial mode Slow { flow { x' = 1 }  when x >= 1 and x <= 2 -> Fast  again: when x >= 8 -> Slow { x := 0 } }
  mode Fast { flow { x' = 2 }  tick: every 1 { x := x + 0.1 }  slow: when x >= 5 -> Slow  over: when x >= 7 -> Broken }
}
interaction Meet(a: Machine, b: Machine) { pair: when a.x <= b.x - 1 { a -> Broken } }
system { machines = Machine[2](x = index) }
run { until 1 }
";

#[test]
fn the_diagram_has_every_mode_and_every_change() {
    let diagrams = of(Case::new(FACTORY));
    assert_eq!(diagrams.len(), 1);
    let diagram = &diagrams[0];
    let paths: Vec<&str> = diagram.boxes.iter().map(|shown| shown.path.as_str()).collect();
    let modes = ["", "Broken", "Slow", "Fast"];
    let mut sorted = paths.clone();
    sorted.sort_by_key(|path| modes.iter().position(|mode| mode == path));
    assert_eq!(sorted, modes);
    let place = |path: &str| paths.iter().position(|other| *other == path).unwrap();
    let arrows: Vec<(usize, usize, Option<&str>, &str)> = (diagram.arrows.iter())
        .map(|arrow| (arrow.from, arrow.to, arrow.label.as_deref(), arrow.trigger.as_str()))
        .collect();
    let expected = [
        ("Broken", "Slow", Some("mended"), "after 2"),
        ("", "Broken", Some("breaks"), "when x >= 9"),
        ("Slow", "Slow", Some("again"), "when x >= 8"),
        ("Slow", "Fast", None, "when x >= 1 and x <= 2"),
        ("Fast", "Slow", Some("slow"), "when x >= 5"),
        ("Fast", "Broken", Some("over"), "when x >= 7"),
        ("", "Broken", Some("Meet.pair"), "when a.x <= b.x - 1"),
    ];
    for (from, to, label, trigger) in expected {
        let arrow = (place(from), place(to), label, trigger);
        assert!(arrows.contains(&arrow), "{arrow:?} in {arrows:?}");
    }
    assert_eq!(arrows.len(), expected.len());
    assert_eq!(
        diagram.arrows.iter().find(|arrow| arrow.label.as_deref() == Some("again")).unwrap().actions,
        "x := 0"
    );
    assert_eq!(diagram.boxes[place("Fast")].lines, ["x' = 2", "tick: every 1 { x := x + 0.1 }"]);
    assert!(diagram.boxes[place("Slow")].initial && !diagram.boxes[place("Broken")].initial);
}

#[test]
fn both_forms_name_everything() {
    let diagrams = of(Case::new(FACTORY));
    let (dot, svg) = (modes_dot(&diagrams), modes_svg(&diagrams, Theme::Own));
    for word in ["Machine", "Broken", "Slow", "Fast", "mended", "again", "Meet.pair", "after 2"] {
        assert!(dot.contains(word) && svg.contains(word), "{word}");
    }
    assert!(svg.contains("x &lt;= 2") && dot.contains("x <= 2"));
    assert_eq!(dot.matches('{').count(), dot.matches('}').count());
    // every agent type, mode and arrow is drawn: a box each, an arrow's head each, and one for each initial mode; what leads
    // back to its own mode is a line in it
    assert_eq!(svg.matches("<rect").count() - svg.matches("width=\"4\"").count(), 4);
    assert_eq!(svg.matches("class=\"head\"").count(), 6 + 1);
    assert!(svg.contains("again: when x &gt;= 8, again"));
}

#[test]
fn modes_in_modes_and_their_history_are_shown() {
    let text = "agent Car { state x = 0  flow { x' = 1 }
          initial mode Drive {
            jam: when x >= 5 -> Brake
            initial mode Cruise { when x >= 1 -> Follow }
            mode Follow { when x >= 2 -> Cruise }
          }
          mode Brake { after 1 -> Drive.history }
        }
        system { car = Car() }
        run { until 1 }";
    let diagram = of(Case::new(text)).remove(0);
    let place = |path: &str| diagram.boxes.iter().position(|shown| shown.path == path).unwrap();
    assert_eq!(diagram.boxes[place("Drive.Follow")].parent, Some(place("Drive")));
    let arrow = |from: &str| diagram.arrows.iter().find(|arrow| arrow.from == place(from)).unwrap();
    assert_eq!((arrow("Drive").to, arrow("Drive").label.as_deref()), (place("Brake"), Some("jam")));
    assert_eq!((arrow("Brake").to, arrow("Brake").trigger.as_str()), (place("Drive"), "after 1 (history)"));
}

#[test]
fn modes_lie_inside_the_modes_that_they_belong_to() {
    let shown = |name: &str, parent: Option<usize>, children: &[usize], initial: bool| ModeBox {
        name: name.into(),
        path: name.into(),
        parent,
        children: children.to_vec(),
        initial,
        lines: Vec::new(),
    };
    let boxes = vec![
        shown("Car", None, &[1, 2], false),
        shown("Drive", Some(0), &[3, 4], true),
        shown("Brake", Some(0), &[], false),
        shown("Cruise", Some(1), &[], true),
        shown("Follow", Some(1), &[], false),
    ];
    let arrow =
        |from, to| Arrow { from, to, label: None, trigger: "when x > 0".into(), actions: String::new() };
    // from a whole mode, from inside to outside, to the mode around, from the mode around
    let arrows =
        [(1, 2), (4, 2), (3, 4), (2, 1), (4, 1), (1, 4), (0, 2), (1, 1)].map(|(from, to)| arrow(from, to));
    let diagram = Diagram { name: "Car".into(), boxes, arrows: arrows.to_vec() };
    let svg = modes_svg(std::slice::from_ref(&diagram), Theme::Own);
    let rects: Vec<[f64; 4]> = svg
        .lines()
        .filter(|line| line.starts_with("<rect") && !line.contains("width=\"4\""))
        .map(frame)
        .collect();
    assert_eq!(rects.len(), 5);
    let holds = |one: [f64; 4], other: [f64; 4]| {
        one[0] < other[0]
            && one[1] < other[1]
            && one[0] + one[2] > other[0] + other[2]
            && one[1] + one[3] > other[1] + other[3]
    };
    for (place, shown) in diagram.boxes.iter().enumerate() {
        for other in 0..5 {
            let inside = std::iter::successors(shown.parent, |&parent| diagram.boxes[parent].parent)
                .any(|around| around == other);
            assert_eq!(holds(rects[other], rects[place]), inside, "{place} in {other}");
        }
    }
    let drawn = svg.matches("class=\"head\"").count() + svg.matches("again").count();
    assert_eq!(drawn, arrows.len() + 2);
    let dot = modes_dot(&[diagram]);
    assert_eq!(dot.matches("subgraph").count(), 2);
    assert_eq!(dot.matches("when x > 0").count(), arrows.len());
}

/// Left, top, width and height of a line of SVG.
fn frame(line: &str) -> [f64; 4] {
    ["x", "y", "width", "height"].map(|key| {
        let rest = line.split(&format!(" {key}=\"")).nth(1).unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    })
}

#[test]
fn every_shipped_model_has_a_diagram_that_lies_within_its_frame() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/models");
    let files = std::fs::read_dir(folder).unwrap();
    let names = files.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    for name in names.filter(|name| name.ends_with(".hy")) {
        let diagrams = of(Case::shipped(&name));
        let svg = modes_svg(&diagrams, Theme::Own);
        let (mut size, mut furthest) = (None, (0.0_f64, 0.0_f64));
        for line in svg.lines() {
            let number = |key: &str| {
                let rest = line.split(&format!(" {key}=\"")).nth(1)?;
                rest.split('"').next()?.parse::<f64>().ok()
            };
            if line.starts_with("<svg") {
                size = number("width").zip(number("height"));
            } else if line.starts_with("<rect") || line.starts_with("<text") {
                let (x, y) = (number("x").unwrap(), number("y").unwrap());
                assert!(x >= 0.0 && y >= 0.0, "{name}: {line}");
                furthest.0 = furthest.0.max(x + number("width").unwrap_or(0.0));
                furthest.1 = furthest.1.max(y + number("height").unwrap_or(0.0));
            }
        }
        let (width, height) = size.unwrap();
        assert!(furthest.0 <= width && furthest.1 <= height, "{name}: {furthest:?} in {size:?}");
        assert!(modes_dot(&diagrams).starts_with("digraph"));
    }
}
