//! Rule 10 for many at once: each birth and each death takes the same work, however many there are. Nothing here looks at a clock:
//! with work that grows with the number of agents these tests would not end in an hour.

use crate::harness::simulate_by_both_forms;

#[test]
fn rule_10_a_hundred_thousand_are_born_and_more_die_in_one_instant() {
    let run = simulate_by_both_forms(
        "agent D { d: when time >= 1 { destroy self } }
         agent E { state x = 0  flow { x' = 1 }  d: when x >= 1 { create D()  destroy self } }
         system { e = E[100000]()  d = D[100000]() }
         run { until 2 }",
    );
    assert_eq!(run.events.len(), 300_000);
    assert!(run.event_times().iter().all(|&time| time == 1.0));
    assert!(run.finals.is_empty());
}

#[test]
fn rule_10_those_who_live_on_keep_their_order() {
    let run = simulate_by_both_forms(
        "agent A(k: int) { discrete first: int = -1
           die: when time >= 1 and mod(k, 3) == 0 { destroy self }
           look: after 2 { first := k }
           see: when time >= 3 and exists o in other A: o.first >= 0 { first := o.k } }
         system { a = A[10](k = index) }
         run { until 4 }",
    );
    let names: Vec<&str> = run.finals.iter().map(|agent| agent.agent.as_str()).collect();
    assert_eq!(names, ["a[1]", "a[2]", "a[4]", "a[5]", "a[7]", "a[8]"]);
    let see: Vec<String> = run.log().into_iter().filter(|line| line.contains("A.see")).collect();
    assert_eq!(
        see,
        ["0 A.see a[1]", "0 A.see a[2]", "0 A.see a[4]", "0 A.see a[5]", "0 A.see a[7]", "0 A.see a[8]"]
    );
    // whoever looks for one finds the first of those who are left
    assert_eq!([run.value("a[1].first"), run.value("a[2].first"), run.value("a[8].first")], [2.0, 1.0, 1.0]);
}
