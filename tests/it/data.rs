//! Do all forms of a table hold the same? CSV, Arrow and Parquet of one run; what a killed run leaves; the pages' snippets.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, UInt32Type};
use arrow_ipc::reader::{FileReader, StreamReader};
use arrow_schema::DataType;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

use crate::skipped::tell_skipped;

/// Every kind of column: numbers, truth values, agents, cells that are empty for some.
const MIXED: &str = "\
agent Ball(h: real [m], next: Ball) {
  state x: real [m] = h, v: real [m/s] = 0
  discrete n: int = 0, odd: bool = false
  flow { x' = v  v' = -9.81 }
  let high = x > 0.5
  bounce: when x <= 0 { v := -0.8*v  n := n + 1  odd := not odd }
}
agent Lamp {
  initial mode Off { after 0.3 -> On }
  mode On { let glow = time/2  after 0.2 -> Off }
}
system { a = Ball(h = 1, next = b)  b = Ball(h = 2, next = a)  lamp = Lamp() }
run { until 1.5  record Ball, Ball.next, Ball.high, Lamp every 0.125 to \"out.csv\"  events to \"events.csv\" }
";

fn run(folder: &Path, model: &str, words: &[&str]) {
    fs::write(folder.join("model.hy"), model).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_hyc"))
        .args(["run", "model.hy", "-q"])
        .args(words)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

fn batches(path: &Path) -> Vec<RecordBatch> {
    let file = File::open(path).unwrap();
    match path.extension().unwrap().to_str().unwrap() {
        "arrows" => StreamReader::try_new(file, None).unwrap().map(Result::unwrap).collect(),
        "arrow" => FileReader::try_new(file, None).unwrap().map(Result::unwrap).collect(),
        _ => ParquetRecordBatchReaderBuilder::try_new(file)
            .unwrap()
            .build()
            .unwrap()
            .map(Result::unwrap)
            .collect(),
    }
}

/// The table as CSV has it; no cell of these has a comma.
fn as_text(batches: &[RecordBatch]) -> String {
    let mut text = String::new();
    for (k, batch) in batches.iter().enumerate() {
        let schema = batch.schema();
        if k == 0 {
            let names: Vec<&str> = schema.fields().iter().map(|field| field.name().as_str()).collect();
            text += &(names.join(",") + "\n");
        }
        for row in 0..batch.num_rows() {
            let cells = batch.columns().iter().map(|column| {
                if column.is_null(row) {
                    return String::new();
                }
                match column.data_type() {
                    DataType::Float64 => {
                        hyc::base::number_text(column.as_primitive::<Float64Type>().value(row))
                    }
                    DataType::UInt32 => column.as_primitive::<UInt32Type>().value(row).to_string(),
                    DataType::Boolean => column.as_boolean().value(row).to_string(),
                    DataType::Utf8 => column.as_string::<i32>().value(row).to_string(),
                    other => panic!("{other}"),
                }
            });
            text += &(cells.collect::<Vec<_>>().join(",") + "\n");
        }
    }
    text
}

#[test]
fn every_form_of_a_table_holds_what_the_csv_does() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    run(folder, MIXED, &["--final", "last.csv"]);
    let csv = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    let (rows, events, last) = (csv("out.csv"), csv("events.csv"), csv("last.csv"));
    assert!(
        rows.contains(",true,") && rows.contains(",b,") && rows.contains(",,") && events.lines().count() > 5,
        "{rows}{events}"
    );
    for form in ["arrows", "arrow", "parquet"] {
        let model = MIXED.replace("csv", form);
        run(folder, &model, &["--final", &format!("last.{form}")]);
        let read = |name: &str| as_text(&batches(&folder.join(format!("{name}.{form}"))));
        assert_eq!(read("out"), rows, "{form}");
        assert_eq!(read("events"), events, "{form}");
        assert_eq!(read("last"), last, "{form}");
    }
}

#[test]
fn columns_have_the_types_of_what_they_hold() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), MIXED, &["--record", "out.parquet"]);
    let schema = batches(&folder.path().join("out.parquet"))[0].schema();
    let types = ["time", "micro", "agent", "mode", "x", "v", "n", "odd"];
    let types = types.map(|name| schema.field_with_name(name).unwrap().data_type().clone());
    use DataType::{Boolean, Float64, UInt32, Utf8};
    assert_eq!(types, [Float64, UInt32, Utf8, Utf8, Float64, Float64, Float64, Boolean]);
}

#[test]
fn a_killed_run_leaves_a_prefix_that_can_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let model = "agent Spring { state x = 1, v = 0  flow { x' = v  v' = -x }  turn: when v <= 0 and x <= -0.5 { v := 0.1 } }
         system { springs = Spring[4]() }
         run { until 1e7  record springs every 0.01 to \"out.NAME\"  events to \"events.NAME\" }";
    for form in ["arrows", "csv"] {
        fs::write(folder.path().join("model.hy"), model.replace("NAME", form)).unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_hyc"))
            .args(["run", "model.hy", "-q"])
            .current_dir(folder.path())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let path = folder.path().join(format!("out.{form}"));
        let begun = Instant::now();
        while fs::metadata(&path).map_or(0, |file| file.len()) < 3_000_000 {
            assert!(begun.elapsed() < Duration::from_secs(120), "nothing is written");
            std::thread::sleep(Duration::from_millis(20));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        if form == "csv" {
            let text = fs::read_to_string(&path).unwrap();
            let whole = text.rsplit_once('\n').unwrap().0;
            assert!(
                whole.lines().all(|line| line.split(',').count() == 6),
                "{}",
                whole.lines().last().unwrap()
            );
            continue;
        }
        let reader = StreamReader::try_new(File::open(&path).unwrap(), None).unwrap();
        let (mut rows, mut last) = (0, -1.0);
        for batch in reader.map_while(Result::ok) {
            for &time in batch.column(0).as_primitive::<Float64Type>().values() {
                assert!(time >= last);
                last = time;
            }
            rows += batch.num_rows();
        }
        assert!(rows >= 30_000, "{rows}");
    }
}

#[test]
fn what_is_recorded_changes_no_event() {
    let folder = tempfile::tempdir().unwrap();
    let events = |setting: &str| {
        let model =
            MIXED.replace("record Ball, Ball.next, Ball.high, Lamp every 0.125 to \"out.csv\"", setting);
        run(folder.path(), &model, &[]);
        fs::read(folder.path().join("events.csv")).unwrap()
    };
    let plain = events("");
    assert!(plain.len() > 200);
    for setting in [
        "record Ball every 0.01 to \"a.arrows\"",
        "record Ball to \"a.parquet\"",
        "record Lamp every 0.7 to \"a.arrow\"",
    ] {
        assert_eq!(events(setting), plain, "{setting}");
    }
}

#[test]
fn the_snippets_for_python_run_and_agree() {
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/DATA.md")).unwrap();
    let snippets: Vec<&str> =
        page.split("```python\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
    assert!(snippets.len() >= 5);
    let python = std::env::var("HYC_PYTHON").unwrap_or("python3".into());
    let there = Command::new(&python).args(["-c", "import pandas, polars, pyarrow"]).output();
    if !there.is_ok_and(|output| output.status.success()) {
        tell_skipped(&format!("`{python}` has no pandas, polars and pyarrow; HYC_PYTHON names another"));
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let ball = include_str!("../../models/ball.hy");
    for form in ["csv", "arrows", "arrow", "parquet"] {
        let model = ball.replace("to \"balls.csv\"", "to \"balls.FORM\" events to \"bounces.FORM\"");
        assert!(model.contains("bounces"));
        run(folder.path(), &model.replace("FORM", form), &[]);
    }
    // a stream of two batches, cut within the second one's head, within its body, and before both
    let model = ball.replace("to \"balls.csv\"", "to \"balls.arrows\"").replace("every 0.01", "every 0.0001");
    let cut = folder.path().join("cut");
    fs::create_dir(&cut).unwrap();
    run(&cut, &model, &[]);
    let whole = fs::read(cut.join("balls.arrows")).unwrap();
    let last = whole.len() * 32_768 / 50_002;
    let killed = snippets.iter().find(|snippet| snippet.contains("not whole")).unwrap();
    for length in [whole.len() - 1, whole.len() - 1000, last + 5000, last + 600, last / 2, 2000] {
        fs::write(cut.join("balls.arrows"), &whole[..length]).unwrap();
        let output = Command::new(&python).args(["-c", killed]).current_dir(&cut).output().unwrap();
        assert!(output.status.success(), "{length}: {}", String::from_utf8_lossy(&output.stderr));
    }
    for snippet in snippets {
        let output = Command::new(&python).args(["-c", snippet]).current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{snippet}\n{}", String::from_utf8_lossy(&output.stderr));
    }
}
