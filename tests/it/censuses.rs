//! Are aggregates that read nothing of who asks, and are worked out once for all, as they are in every micro-step?

use crate::harness::{Case, simulate_by_both_forms};

/// One after the other, each when as many have gone before it as it waits for.
const IN_TURN: &str = "\
agent A(k: int) {
  discrete n: int = 0
  go: when time >= 1 and (count o in A where o.n >= 1) == k { n := 1 }
}
system { a = A[5](k = 4 - index) }
run { until 2 }
";

#[test]
fn what_a_micro_step_writes_counts_in_the_next() {
    let run = simulate_by_both_forms(IN_TURN);
    assert_eq!(run.log(), ["0 A.go a[4]", "1 A.go a[3]", "2 A.go a[2]", "3 A.go a[1]", "4 A.go a[0]"]);
    assert!(run.event_times().iter().all(|&time| time == 1.0));
}

#[test]
fn what_is_explained_is_the_state_before() {
    let run = Case::new(IN_TURN).run_explained();
    assert_eq!(run.log(), simulate_by_both_forms(IN_TURN).log());
}

#[test]
fn modes_links_births_and_deaths_count() {
    let run = simulate_by_both_forms(
        "agent A { link l: A
           initial mode Off { after 1 -> On }
           mode On { after 1 { create A(l = self) }  after 2 { destroy self } } }
         agent W { discrete n: int = 0
           on_: when (count a in A where a is On) == 2 { n := n + 1 }
           led: when (count a in A where a.l) == 2 { n := n + 10 }
           lost: when (count a in A where a.l) == 0 and time > 2.1 { n := n + 100 }
           gone: when (sum a in A: 1) == 2 and time > 2.5 { n := n + 1000 } }
         system { a = A[2]()  w = W() }
         run { until 3.5 }",
    );
    assert_eq!(run.times("W.on_"), [1.0]);
    assert_eq!(run.times("W.led"), [2.0]);
    assert_eq!(run.times("W.lost"), [3.0]);
    assert_eq!(run.times("W.gone"), [3.0]);
}

#[test]
fn a_population_with_a_cap_ends() {
    // With each agent counting all others after each birth and death this would not end in an hour.
    let run = simulate_by_both_forms(
        "agent Cell(g: int) { state x = 0  flow { x' = 1 }
           div: when x >= 1 and (count c in Cell) <= 3000 { create Cell(g = g + 1)  x := 0.1 }
           die: rate 0.2*x { destroy self } }
         system { c = Cell[4](g = 0) }
         run { until 12  seed 5 }",
    );
    assert_eq!(run.times("Cell.div").len() + 4, run.finals.len() + run.times("Cell.die").len());
    assert!(run.finals.len() > 1000);
}
