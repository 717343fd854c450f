//! Do cars that enter and leave the highway keep apart, and do what their neighbours' messages and places say?

use crate::harness::{Case, Run};

const LEN: f64 = 5.0;
const ROAD: f64 = 2000.0;

#[test]
fn who_enters_the_highway_keeps_apart_and_leaves() {
    let run = Case::shipped("highway.hy").until(100.0).run();
    assert!(run.false_asserts.is_empty(), "{:?}", run.false_asserts);
    let count = |transition: &str| run.times(transition).len() as u64;
    let cars = run.stats.types.iter().find(|ty| ty.name == "Car").unwrap();
    assert_eq!((cars.created, cars.destroyed), (count("Ramp.enter"), count("Car.leave")));
    assert_eq!(cars.agents, cars.created - cars.destroyed);
    // Three ramps at 0.25 a second, each closed for a second or two after a car: a Poisson count of about 55.
    assert!((35..=75).contains(&cars.created), "{}", cars.created);
    assert!(cars.destroyed >= 8, "{}", cars.destroyed);
    assert!(count("Car.pass") > 0 && count("Car.panic") > 0 && count("Car.light") > 0, "nothing happens");
    apart(&run);
    lights(&run);
}

/// At each sample no two cars of one lane overlap, and all are on the road.
fn apart(run: &Run) {
    let rows = &run.samples[0];
    let mut from = 0;
    let mut most = 0;
    while from < rows.len() {
        let here: Vec<_> = rows[from..].iter().take_while(|row| row.time == rows[from].time).collect();
        let mut places: Vec<(f64, f64)> = here.iter().map(|row| (row.cells[2], row.cells[0])).collect();
        places.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        assert!(places.iter().all(|&(lane, x)| (1.0..=3.0).contains(&lane) && (0.0..=ROAD).contains(&x)));
        for pair in places.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            assert!(pair[1].1 - pair[0].1 > LEN, "{pair:?} at {} s", here[0].time);
        }
        most = most.max(here.len());
        from += here.len();
    }
    assert!(most > 20, "at most {most} cars at a time");
}

/// Who sees brake lights sees those of a car that begins to brake in this instant.
fn lights(run: &Run) {
    for light in run.events.iter().filter(|event| event.transition == "Car.light") {
        let brakes = run
            .events
            .iter()
            .any(|event| event.time == light.time && event.to == "Brake" && event.agent != light.agent);
        assert!(brakes, "{light:?}");
    }
}
