//! Does everybody who enters the sector leave it, in order and at a distance?

use crate::harness::Case;

const SIDE: f64 = 150.0;

#[test]
fn who_enters_leaves_in_order() {
    let run = Case::shipped("sector.hy").run();
    assert!(run.false_asserts.is_empty());
    let count = |transition: &str| run.times(transition).len() as u64;
    let aircraft = run.stats.types.iter().find(|ty| ty.name == "Aircraft").unwrap();
    assert_eq!((aircraft.created, aircraft.destroyed), (count("Gate.enter"), count("Aircraft.leave")));
    assert_eq!(aircraft.agents, aircraft.created - aircraft.destroyed);
    // Every 100 s at four gates, unless somebody is still near; 150 km take 600 to 750 s.
    assert!(count("Gate.enter") >= 120 && count("Aircraft.leave") >= 90);
    let most = run.value("tower.most");
    assert!((20.0..=36.0).contains(&most), "{most}");
    // Nobody overtakes on an airway: numbers leave in the order in which they came.
    assert!(count("Aircraft.close") > 5);
    let rows = &run.samples[0];
    for pair in rows.windows(2).filter(|pair| pair[0].agent == pair[1].agent) {
        assert!(pair[1].cells[0] >= pair[0].cells[0], "{pair:?}");
    }
    for row in rows {
        // The one ahead, recorded by its number, is so.
        let [s, _, ahead] = row.cells[..] else { panic!("{row:?}") };
        let name = format!("Aircraft#{ahead}");
        let other = rows.iter().find(|other| other.time == row.time && other.agent == name);
        match other {
            Some(other) => assert!(other.cells[0] - s > 9.26, "{row:?} {other:?}"),
            None => assert_eq!(ahead, -1.0),
        }
        assert!((0.0..=SIDE).contains(&s));
    }
}
