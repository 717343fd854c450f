//! Tables as text: each column, each kind of cell, numbers that read back, failures that name their file.

use std::io::{self, Write};
use std::sync::{Arc, LazyLock, Mutex};

use super::*;
use crate::base::{Diagnostic, SourceMap, write_number};
use crate::runtime::observe::{
    Cell, End, Event, FalseAssert, Last, Observer, Outcome, Row, Stats, TypeStats, Who,
};

/// Bytes that a test can look at afterwards.
#[derive(Clone, Default)]
struct Page(Arc<Mutex<Vec<u8>>>);

impl Write for Page {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Page {
    fn sink(&self) -> Sink {
        Sink { name: "page".into(), writer: Box::new(self.clone()) }
    }
    fn text(&self) -> String {
        String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
    }
}

/// A disk without room.
struct Full;

impl Write for Full {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(io::Error::from(io::ErrorKind::StorageFull))
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn cast() -> Cast {
    let names = |names: &[&str]| names.iter().map(|name| name.to_string()).collect::<Vec<_>>();
    Cast {
        agents: names(&["fast", "cars[0]", "odd, name"]),
        types: vec![
            TypeColumns {
                name: "Car".into(),
                states: names(&["x", "y"]),
                discretes: names(&["lane"]),
                discrete_kinds: vec![Kind::Number],
            },
            TypeColumns {
                name: "Lamp".into(),
                states: names(&["y"]),
                discretes: names(&["on"]),
                discrete_kinds: vec![Kind::Bool],
            },
        ],
    }
}

fn who(number: usize) -> Who {
    Who { number, ty: 0 }
}

fn event(time: f64) -> Event<'static> {
    Event { time, micro: 0, row: 0, transition: "Car.left", agent: who(0), other: None, modes: None }
}

#[test]
fn numbers_read_back_to_the_same_bits() {
    let awkward = [
        0.0,
        -0.0,
        1.0,
        -1.5,
        0.1,
        1.0 / 3.0,
        1e-5,
        9.999999e-6,
        1e16,
        9999999999999998.0,
        1e300,
        5e-324,
        f64::MAX,
        f64::MIN_POSITIVE,
        9.116696228810179,
        f64::INFINITY,
        f64::NEG_INFINITY,
    ];
    for value in awkward {
        let mut text = String::new();
        write_number(&mut text, value);
        assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{text}");
        assert!(text.len() <= 24, "{text}");
    }
    let mut text = String::new();
    write_number(&mut text, f64::NAN);
    assert_eq!(text, "NaN");
}

#[test]
fn an_event_is_one_row() {
    let (cast, page) = (cast(), Page::default());
    let mut tables = Tables::new(&cast);
    tables.event_log(page.sink()).unwrap();
    tables.event(&event(0.5)).unwrap();
    let bump = Event {
        time: 1e-9,
        micro: 2,
        row: 0,
        transition: "Bump.pair",
        agent: who(1),
        other: Some(who(2)),
        modes: Some(("Drive.Cruise", "Brake")),
    };
    tables.event(&bump).unwrap();
    tables.finish().unwrap();
    assert_eq!(
        page.text(),
        "time,micro,transition,agent,other,from,to\n\
         0.5,0,Car.left,fast,,,\n\
         1e-9,2,Bump.pair,cars[0],\"odd, name\",Drive.Cruise,Brake\n"
    );
}

#[test]
fn each_record_has_its_table_and_each_kind_of_cell_its_form() {
    let (cast, first, second) = (cast(), Page::default(), Page::default());
    let mut tables = Tables::new(&cast);
    tables.trajectory(first.sink(), &[Column::new("x", Kind::Number)]).unwrap();
    let kinds = [Kind::Number, Kind::Number, Kind::Bool, Kind::Text, Kind::Text];
    let columns: Vec<Column> = ["a", "b", "c", "d", "e"]
        .into_iter()
        .zip(kinds)
        .map(|(name, kind)| Column::new(name, kind))
        .collect();
    tables.trajectory(second.sink(), &columns).unwrap();
    let cells =
        [Cell::Empty, Cell::Number(2.0), Cell::Bool(true), Cell::Agent(Some(who(1))), Cell::Agent(None)];
    let row = Row { time: 0.25, micro: 1, agent: who(0), mode: "Spiral", cells: &cells };
    tables.sample(1, &row).unwrap();
    tables.finish().unwrap();
    assert_eq!(first.text(), "time,micro,agent,mode,x\n");
    assert_eq!(second.text(), "time,micro,agent,mode,a,b,c,d,e\n0.25,1,fast,Spiral,,2,true,cars[0],none\n");
}

#[test]
fn final_states_of_several_types_share_columns_by_name() {
    let (cast, page) = (cast(), Page::default());
    let mut tables = Tables::new(&cast);
    tables.final_states(page.sink()).unwrap();
    let car = Last {
        time: 20.0,
        agent: who(0),
        ty: 0,
        mode: "",
        states: &[1.0, 2.0],
        discretes: &[Cell::Number(3.0)],
    };
    tables.last(&car).unwrap();
    let lamp = Last {
        time: 20.0,
        agent: who(1),
        ty: 1,
        mode: "On",
        states: &[-0.5],
        discretes: &[Cell::Bool(false)],
    };
    tables.last(&lamp).unwrap();
    tables.finish().unwrap();
    assert_eq!(page.text(), "time,agent,mode,x,y,lane,on\n20,fast,,1,2,3,\n20,cars[0],On,,-0.5,,false\n");
}

#[test]
fn a_full_disk_is_reported_with_the_name_of_the_file() {
    let cast = cast();
    let mut tables = Tables::new(&cast);
    let _ = tables.event_log(Sink { name: "events.csv".into(), writer: Box::new(Full) });
    let error = (0..10_000_000).find_map(|k| tables.event(&event(f64::from(k))).err()).unwrap();
    assert_eq!(error.kind(), io::ErrorKind::StorageFull);
    assert!(error.to_string().contains("`events.csv`"), "{error}");
}

fn outcome(end: End) -> Outcome {
    let ty = TypeStats { name: "Car".into(), agents: 3, created: 2, destroyed: 1, steps: 40, events: 7 };
    Outcome {
        end,
        time: 12.5,
        stats: Stats {
            events: 7,
            steps: 40,
            rejected: 1,
            types: vec![ty],
            transitions: vec![("Car.left".into(), 2), ("Car.right".into(), 0), ("Bump.pair".into(), 5)],
            ..Stats::default()
        },
        verdicts: Vec::new(),
        false_asserts: vec![FalseAssert {
            span: Default::default(),
            message: Some("rear-end collision".into()),
            time: 3.5,
            agent: who(1),
            mode: "Drive".into(),
            compared: Vec::new(),
            count: 2,
        }],
        warnings: Vec::new(),
    }
}

/// No text has been read.
static NO_SOURCES: LazyLock<SourceMap> = LazyLock::new(SourceMap::default);

fn report<'a>(cast: &'a Cast, outcome: &'a Outcome, files: &'a [String]) -> Report<'a> {
    Report {
        sources: &NO_SOURCES,
        model: "models/cars.hy",
        algorithm: "masim",
        engine: "plain",
        integrator: "tsit5",
        backend: "jit",
        tolerance: 1e-6,
        absolute: 1e-6,
        seed: 0,
        until: Some(30.0),
        cast,
        outcome,
        functions: 4,
        instructions: 100,
        code_bytes: 2000,
        busiest: &[],
        slowest: &[],
        compile_parts: &[],
        writing_seconds: 0.0,
        compile_seconds: 0.0042,
        run_seconds: 1.5,
        page_seconds: None,
        files,
    }
}

#[test]
fn statistics_have_the_promised_keys() {
    let (cast, outcome) = (cast(), outcome(End::Until));
    let text = statistics(&report(&cast, &outcome, &[]));
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    let promised = [
        "model",
        "algorithm",
        "backend",
        "threads",
        "tolerance",
        "until",
        "agents",
        "events",
        "steps",
        "rejected",
        "rhs_evaluations",
        "guard_evaluations",
        "pairs_listed",
        "undecided_roots",
        "compile_seconds",
        "run_seconds",
    ];
    for key in promised {
        assert!(value.get(key).is_some(), "{key}");
    }
    assert_eq!(value["agents"], 3);
    assert_eq!(value["types"]["Car"]["events"], 7);
    assert_eq!(value["transitions"]["Bump.pair"], 5);
    assert_eq!(value["false_asserts"][0]["agent"], "cars[0]");
    assert!(text.ends_with("}\n"));
}

#[test]
fn every_end_is_told() {
    let cast = cast();
    let stop = End::Stop { reason: Some("all home".into()), by: Some((who(1), "Car.home".into())) };
    let ends = [
        (End::Until, "ended at t = 12.5 s"),
        (stop, "stopped at t = 12.5 s by Car.home of cars[0]: all home"),
        (End::Interrupted, "interrupted at t = 12.5 s"),
        (
            End::Error(Box::new(Diagnostic::error("HY0501", "a value is not finite"))),
            "in error at t = 12.5 s (HY0501)",
        ),
        (End::Output(io::ErrorKind::StorageFull.into()), "could not be written"),
    ];
    for (end, words) in ends {
        let outcome = outcome(end);
        let report = report(&cast, &outcome, &[]);
        assert!(summary(&report).contains(words), "{}", summary(&report));
        let value: serde_json::Value = serde_json::from_str(&statistics(&report)).unwrap();
        assert!(value["end"]["kind"].is_string());
    }
}

#[test]
fn a_summary_lists_what_fired_and_what_was_written() {
    let (cast, outcome) = (cast(), outcome(End::Until));
    let files = ["events.csv".to_string()];
    let busiest = [("fast".to_string(), 6), ("cars[0]".to_string(), 1)];
    let report = Report {
        busiest: &busiest,
        slowest: &[("cars[0]".to_string(), 39)],
        page_seconds: Some(0.5),
        compile_parts: &[("reading", 0.0012), ("machine code", 0.003)],
        writing_seconds: 0.25,
        ..report(&cast, &outcome, &files)
    };
    assert_eq!(
        summary(&report),
        "models/cars.hy: ended at t = 12.5 s\n\
         \x20 3 agents (2 created, 1 destroyed), 7 events, 40 steps (1 rejected)\n\
         \x20   Bump.pair  5  ########################\n\
         \x20   Car.left   2  ##########\n\
         \x20 busiest    fast (6 events), cars[0] (1 event)\n\
         \x20 slowest    cars[0] (39 steps)\n\
         \x20 guards     evaluated 0 times at a point, 0 over an interval\n\
         \x20 asserts    1 false, 2 times\n\
         \x20 time       compiled in 4.2 ms (reading 1.2 ms, machine code 3.0 ms), ran in 1.50 s (250.0 ms of it writing), page in 500.0 ms\n\
         \x20 wrote      events.csv\n"
    );
}

/// A place that takes its time.
struct Slow(Arc<Mutex<std::time::Duration>>);

impl Write for Slow {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let begun = std::time::Instant::now();
        std::thread::sleep(std::time::Duration::from_millis(2));
        *self.0.lock().unwrap() += begun.elapsed();
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Handing rows on is part of writing, once: neither passed over nor multiplied, however the rows that are timed fall.
#[test]
fn the_time_of_writing_is_that_of_the_writer() {
    for name in ["t.csv", "t.arrows"] {
        let (cast, spent) = (cast(), Arc::new(Mutex::new(std::time::Duration::ZERO)));
        let mut tables = Tables::new(&cast);
        let begun = std::time::Instant::now();
        let sink = Sink { name: name.into(), writer: Box::new(Slow(spent.clone())) };
        tables.trajectory(sink, &[Column::new("x", Kind::Number)]).unwrap();
        for k in 0..100_000 {
            let cells = [Cell::Number(f64::from(k))];
            let row = Row { time: f64::from(k), micro: 0, agent: who(0), mode: "", cells: &cells };
            tables.sample(0, &row).unwrap();
        }
        tables.finish().unwrap();
        let spent = *spent.lock().unwrap();
        let wall = begun.elapsed();
        assert!(
            tables.writing() >= spent && tables.writing() < 2 * wall + spent,
            "{name}: {:?} of {wall:?}, {spent:?}",
            tables.writing()
        );
    }
}
