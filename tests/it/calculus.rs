//! What systems of equations do models become? Snapshots of the system stage, and of every diagnostic of that floor.

use std::path::{Path, PathBuf};

use hyc::base::SourceMap;
use hyc::base::render::{Colours, render};
use hyc::calculus::system::{ActionStep, Condition, System, Trigger};
use hyc::calculus::{derive, dump};
use hyc::model::{Files, Settings, check};
use hyc::syntax::parse;

/// Data files beside the model.
struct Beside(PathBuf);

impl Files for Beside {
    fn read(&mut self, path: &str) -> std::io::Result<Vec<u8>> {
        std::fs::read(self.0.join(path))
    }
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// The system of a text that stands in `models/`, or what a person is told.
fn system(name: &str, text: &str, settings: &Settings) -> Result<System, String> {
    let mut sources = SourceMap::default();
    let file = sources.add(name, text);
    let told = |sources: &SourceMap, problems: &[_]| render(sources, problems, Colours::None);
    let ast = parse(file, text).map_err(|problems| told(&sources, &problems))?;
    let checked = check(&ast, &mut sources, &mut Beside(folder("models")), settings);
    let model = checked.model.ok_or_else(|| told(&sources, &checked.diagnostics))?;
    derive(&model).map_err(|problems| told(&sources, &problems))
}

/// The system of a text that is right.
fn right(text: &str) -> System {
    system("test.hy", text, &Settings::default()).unwrap_or_else(|told| panic!("{told}"))
}

/// The `.hy` files of a folder by name, with their texts.
fn texts_in(folder: &Path) -> Vec<(String, String)> {
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("readable").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|end| end == "hy"));
    paths.sort();
    let read = |path: PathBuf| {
        let name = path.file_stem().and_then(|name| name.to_str()).expect("a plain name").to_owned();
        (name, std::fs::read_to_string(&path).expect("readable"))
    };
    paths.into_iter().map(read).collect()
}

fn snapshot(beside: &str, name: &str, text: String) {
    insta::with_settings!({ snapshot_path => beside, prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::assert_snapshot!(name, text);
    });
}

#[test]
fn every_model_becomes_the_equations_of_its_snapshot() {
    let texts = [texts_in(&folder("models")), texts_in(&folder("tests/it/calculus"))].concat();
    for (name, text) in texts {
        let system = system(&name, &text, &Settings::default()).unwrap_or_else(|told| panic!("{told}"));
        snapshot("calculus", &name, dump(&system));
    }
}

#[test]
fn what_has_no_equations_is_told_as_its_snapshot_says() {
    for (name, text) in texts_in(&folder("tests/it/errors")) {
        if name.starts_with("HY03") {
            let file = format!("{name}.hy");
            let told =
                system(&file, &text, &Settings::default()).err().unwrap_or_else(|| panic!("{name} is wrong"));
            assert!(told.contains(&name[..6]), "{name} shows another code:\n{told}");
            snapshot("errors", &name, told);
        }
    }
}

#[test]
fn the_same_functions_serve_any_number_of_agents() {
    let text = std::fs::read_to_string(folder("models/bumper.hy")).expect("readable");
    let [few, many] = ["N=2", "N=50"].map(|setting| {
        let (name, value) = setting.split_once('=').expect("NAME=VALUE");
        let data = ("data".to_owned(), format!("bumper_{value}.csv"));
        let settings =
            Settings { params: vec![(name.to_owned(), value.to_owned()), data], ..Settings::default() };
        system("bumper.hy", &text, &settings).unwrap_or_else(|told| panic!("{told}"))
    });
    assert_eq!(few.functions.len(), many.functions.len());
    assert_eq!(few.graph.nodes().len(), many.graph.nodes().len());
    assert_ne!(few.population.agents.len(), many.population.agents.len());
}

/// Whether the transition `when guard { actions }` of an interaction of two cars is symmetric.
fn symmetric(guard: &str, actions: &str) -> bool {
    let text = format!(
        "fn near(p: Car, q: Car) = abs(p.x - q.x) <= 30
         agent Car {{
           state x = 0, y = 0
           discrete lane: int = 1, ill: bool = false
           link lead: Car
           flow {{ x' = 1 y' = 0 }}
           initial mode Drive {{ }}
           mode Avoid {{ }}
         }}
         interaction Meet(a: Car, b: Car) {{ when {guard} {{ {actions} }} }}
         system {{ cars = Car[2] }}
         run {{ until 1 }}"
    );
    right(&text).interactions[0].transitions[0].symmetric
}

#[test]
fn rule_05_an_interaction_is_symmetric_if_its_mirror_image_has_the_same_normal_form() {
    let both = "a.y := b.y - a.y  b.y := a.y - b.y";
    for guard in [
        "(a.x - b.x)^2 + (a.y - b.y)^2 <= 1",
        "(b.x - a.x)^2 + ((a.y - b.y)^2 + 1) <= 2",
        "hypot(a.x - b.x, a.y - b.y) <= 1",
        "sqrt((a.x - b.x)^2 + (a.y - b.y)^2) <= 1",
        "abs(a.x - b.x) <= 30 and a.lane == b.lane",
        "near(a, b)",
        "max(a.x, b.x) >= 3 or min(a.y, b.y) < 1",
        "a.ill == b.ill and a.x + b.x > 2",
        "a.x*(2*b.x) > 2",
        "a is Drive and b is Drive and near(b, a)",
        "a.lead.x > 1 and b.lead.x > 1",
        "exists o in other Car: (o.x - a.x)^2 + (o.x - b.x)^2 < 1",
        "(exists o in other Car: near(a, o)) and (exists p in other Car: near(b, p))",
    ] {
        assert!(symmetric(guard, both), "{guard}");
        assert!(!symmetric(guard, "a.y := 1"), "{guard}");
    }
    for guard in [
        "a.x <= b.x",
        "a.x - b.x <= 1",
        "a.lane == b.lane + 1",
        "a.ill and not b.ill",
        "(a.x - 2*b.x)^2 <= 1",
        "a.lead.x > b.x",
        "exists o in other Car: near(a, o)",
    ] {
        assert!(!symmetric(guard, both), "{guard}");
    }
    let guard = "near(a, b)";
    assert!(symmetric(guard, "a -> Avoid b -> Avoid"));
    assert!(symmetric(guard, "b.lane := a.lane a.lane := b.lane stop \"met\""));
    assert!(symmetric(guard, "if a.ill or b.ill { a.ill := true b.ill := true }"));
    assert!(!symmetric(guard, "a -> Avoid b -> Drive"));
    assert!(!symmetric(guard, "if a.ill { b.ill := true }"));
}

#[test]
fn rule_13_a_flow_is_coupled_with_the_agents_whose_states_it_reads() {
    let system = right(
        "agent Lead { state x = 0 discrete speed = 1 flow { x' = speed } }
         agent Car(lead: Lead) {
           state x = 0
           initial mode Free { flow { x' = lead.speed } when x >= lead.x -> Follow }
           mode Follow { flow { x' = lead.x - x } }
         }
         system { lead = Lead  car = Car(lead = lead) }
         run { until 1 }",
    );
    let couples: Vec<_> = system.types[1].modes.iter().filter_map(|mode| mode.flow.as_ref()).collect();
    assert_eq!(couples.iter().map(|flow| flow.couples.len()).collect::<Vec<_>>(), [0, 1]);
    let entries: Vec<_> =
        couples[1].jacobian.iter().map(|entry| (entry.row, entry.slot, entry.column)).collect();
    assert_eq!(entries, [(0, 0, 0), (0, 1, 0)]);
}

#[test]
fn a_witness_is_the_slot_of_the_outermost_exists() {
    let system = right(
        "fn near(p: Car, q: Car) = exists m in Car: abs(m.x - p.x) + abs(m.x - q.x) < 1
         agent Car {
           state x = 0  discrete seen = 0, crowded: bool = false
           flow { x' = 1 }
           meet: when x > 1 and exists o in other Car: near(self, o) {
             seen := o.x
             crowded := forall p in other Car: p.x > x
           }
         }
         system { cars = Car[2] }
         run { until 1 }",
    );
    let transition = &system.types[0].transitions[0];
    assert_eq!(transition.witnesses.len(), 1);
    let witness = transition.witnesses[0];
    assert_eq!(transition.frame.slots[witness].name(), "o");
    let Trigger::When(guard) = &transition.trigger else { panic!("a guard") };
    let Condition::And(terms) = &guard.condition else { panic!("an `and`") };
    assert!(
        terms.iter().any(|term| matches!(term, Condition::Exists(quantified) if quantified.slot == witness))
    );
    assert!(matches!(&transition.actions.steps[1], ActionStep::If { then, otherwise, .. }
        if then.len() == 1 && otherwise.len() == 1));
    assert_eq!(transition.actions.writes.len(), 2);
}

#[test]
fn declarations_are_numbered_as_they_stand_in_the_text() {
    let system = right(
        "agent A { state x = 0 flow { x' = 1 } one: when x > 1 { } }
         interaction I(a: A, b: B) { two: when a.x > b.x { } }
         agent B { state x = 0 flow { x' = 1 } three: when x > 1 { } four: every 1 { } }
         system { a = A  b = B }
         run { until 1 }",
    );
    let own = system.types.iter().flat_map(|ty| &ty.transitions).map(|transition| transition.declaration);
    assert_eq!(own.collect::<Vec<_>>(), [0, 2, 3]);
    assert_eq!(system.interactions[0].transitions[0].transition.declaration, 1);
}
