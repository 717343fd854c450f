//! Does the number of threads change anything? Thousands of agents that run ahead, of whom some meet, are born, die, are watched
//! step by step, or have a flow that has to be looked at.

use hyc::runtime::limits::Limits;

use crate::harness::{Case, Run};

const SWARM: &str = "agent Ball(k: real) {
   state x = 4*k, v = sin(7*k), y = 0
   discrete hits: int = 0
   flow { x' = v  v' = -0.2*sin(x - 4*k) - 0.01*v  y' = cos(x)*v }
   turn: when x > 4*k + 1.2 { v := -v }
   lay: after 3 when hits > 1 { create Ball(k = k + 0.25, v = 0.5)  destroy self }
 }
 agent Slow(k: real) { state z = k  flow { z' = -k*(z - sin(time)) }  low: when crossing(z - 0.5) { } }
 interaction Meet(a: Ball, b: Ball) {
   meet: when abs(a.x - b.x) <= 3 { a.v := -a.v  b.v := -b.v  a.hits := a.hits + 1  b.hits := b.hits + 1 } }
 system { balls = Ball[2500](k = index)  slow = Slow[1100](k = 1 + 0.1*index) }
 run { until 8  record balls[3].x, balls[2499].y to \"a.csv\"  record Ball.hits every 4 to \"b.csv\" }";

fn run(threads_max: usize) -> Run {
    Case::new(SWARM).limits(Limits { threads_max, ..Limits::default() }).run()
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let alone = run(1);
    assert!(alone.stats.threads == 1 && alone.events.len() > 1000, "{:?}", alone.stats);
    for threads_max in [2, 5] {
        let many = run(threads_max);
        assert_eq!(many.stats.threads, threads_max as u64);
        assert_eq!(many.log(), alone.log());
        let times = |run: &Run| run.events.iter().map(|event| event.time.to_bits()).collect::<Vec<_>>();
        assert_eq!(times(&many), times(&alone));
        assert_eq!(format!("{:?}", many.samples), format!("{:?}", alone.samples));
        let steps = |run: &Run| (run.stats.steps, run.stats.guard_evaluations, run.stats.guard_ranges);
        assert_eq!(steps(&many), steps(&alone));
    }
}
