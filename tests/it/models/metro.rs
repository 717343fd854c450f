//! Does the train stop where and when the areas under its speed say, with both regions in step?

use crate::harness::{Case, all_near, near};

#[test]
fn the_train_keeps_its_timetable() {
    let run = Case::shipped("metro.hy").run();
    // 20 s and 200 m to gain 20 m/s, 16 s and 160 m to brake: between them 240 m at 20 m/s
    let (gain, roll, brake) = (20.0, 12.0, 16.0);
    let (opening, dwell, closing) = (2.0, 12.0, 4.0);
    let cycle = gain + roll + brake + opening + dwell + closing;
    let at = |part: f64| -> Vec<f64> {
        (0..9).map(|k| f64::from(k) * cycle + part).take_while(|time| *time <= 300.0).collect()
    };
    let halt = gain + roll + brake;
    all_near(&run.times("Train.top"), &at(gain), 1e-6);
    all_near(&run.times("Train.brake"), &at(gain + roll), 1e-6);
    all_near(&run.times("Train.halt"), &at(halt), 1e-6);
    all_near(&run.times("Train.arrive"), &at(halt), 1e-6);
    all_near(&run.times("Train.wide"), &at(halt + opening), 1e-6);
    all_near(&run.times("Train.close"), &at(halt + opening + dwell), 1e-6);
    all_near(&run.times("Train.shut"), &at(cycle), 1e-6);
    all_near(&run.times("Train.depart"), &at(cycle), 1e-6);
    near(run.value("train.next_stop"), 600.0 * (1.0 + run.times("Train.halt").len() as f64), 1e-9);
    assert!(run.false_asserts.is_empty());
}

#[test]
fn one_region_answers_the_other_in_the_next_micro_step() {
    let run = Case::shipped("metro.hy").until(70.0).run();
    assert_eq!(
        run.log(),
        [
            "0 Train.top train Motion.Run.Gain->Motion.Run.Roll",
            "0 Train.brake train Motion.Run.Roll->Motion.Brake",
            "0 Train.halt train Motion.Brake->Motion.Halt",
            "1 Train.arrive train Doors.Closed->Doors.Opening",
            "0 Train.wide train Doors.Opening->Doors.Wide",
            "0 Train.close train Doors.Wide->Doors.Closing",
            "0 Train.shut train Doors.Closing->Doors.Closed",
            "1 Train.depart train Motion.Halt->Motion.Run.Gain",
        ]
    );
    assert_eq!(run.mode("train"), "Motion.Run.Gain|Doors.Closed");
}

#[test]
fn where_stations_are_near_the_train_brakes_before_it_is_fast() {
    // v^2/2a + v^2/2b = 200: brakes from Gain
    let run = Case::shipped("metro.hy").param("distance", 200).until(60.0).run();
    let v = (2.0f64 * 200.0 / (1.0 + 1.0 / 1.25)).sqrt();
    near(run.times("Train.brake")[0], v, 1e-6);
    near(run.times("Train.halt")[0], v + v / 1.25, 1e-6);
    assert!(run.times("Train.top").is_empty());
}
