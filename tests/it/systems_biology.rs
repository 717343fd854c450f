//! Do the events of systems biology mean here what docs/LANGUAGE.md says they do? Its samples, run.

use crate::harness::{Run, all_near, near, simulate_by_both_forms};

/// The samples of the section, run.
fn samples() -> Vec<Run> {
    let path = format!("{}/docs/LANGUAGE.md", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("the reference is there");
    let section = text.split("### As systems biology writes events").nth(1).expect("the section is there");
    let section = section.split("\n## ").next().expect("there is a first part");
    let fenced = section.split("```hy\n").skip(1).map(|rest| rest.split("```").next().expect("it ends"));
    fenced.map(simulate_by_both_forms).collect()
}

#[test]
fn the_samples_of_the_section_do_what_it_says() {
    let runs = samples();
    let [trigger, delay, persistence, priority] = &runs[..] else { panic!("{} samples", runs.len()) };

    // S = 2 + 3 sin t is above 1 but from pi + asin(1/3) to 2 pi - asin(1/3)
    let again = std::f64::consts::TAU - (1.0_f64 / 3.0).asin();
    all_near(&trigger.times("Cell.taken_for_false"), &[0.0, again], 1e-5);
    all_near(&trigger.times("Cell.taken_for_true"), &[again], 1e-5);

    // S = exp(t/2) is below 4 at 1 and at 2
    assert_eq!(delay.times("Cell.execute"), [3.0, 4.0]);
    near(delay.value("cell.P"), 2.0 * 1.0_f64.exp(), 1e-5);
    near(delay.value("cell.Q"), 2.0 * 2.0_f64.exp(), 1e-4);

    // S = sin t is above 1/2 from pi/6 to 5 pi/6
    let begin = std::f64::consts::PI / 6.0;
    all_near(&persistence.times("Cell.persistent"), &[begin + 1.0, begin + 3.0], 1e-5);
    all_near(&persistence.times("Cell.revocable"), &[begin + 1.0], 1e-5);

    assert_eq!(priority.value("cell.done"), 21.0);
    let at_once = ["0 Cell.slow_due", "1 Cell.quick_due", "2 Cell.act_quickly", "3 Cell.act_slowly"];
    let log: Vec<String> = priority.log()[1..].iter().map(|line| line.replace(" cell", "")).collect();
    assert_eq!(log, at_once);
}
