//! Is a property true whose margin is zero, just when its condition is? Whole numbers that are compared sit at zero all the time,
//! some by comparisons that hold there and some by others that do not.

mod formula;

use formula::{Formula, N_AGENTS, Schedule, TIMES};

use crate::differential::dice::Dice;
use crate::properties::{run, verdict};

/// Checks which properties hold; each has its truth, and the margin zero.
#[track_caller]
fn check(model: &str, properties: &[(&str, bool)]) {
    let texts = properties.iter().enumerate().map(|(k, (text, _))| format!("property p{k} = {text}\n"));
    let run = run(&format!("{model}\n{}", texts.collect::<String>()));
    for (k, (text, holds)) in properties.iter().enumerate() {
        let found = verdict(&run, &format!("p{k}"));
        assert_eq!((found.holds, found.margin), (*holds, 0.0), "{text}: {found:?}");
    }
}

/// n = 0 for all time, k = 1 from 1 until 2.
const ONE: &str =
    "agent A { discrete n: int = 0, k: int = 0  up: after 1 { k := 1 }  down: after 2 { k := 0 } }
    system { a = A() }
    run { until 3 }";

#[test]
fn of_several_comparisons_at_zero_all_count() {
    check(
        ONE,
        &[
            ("always forall a in A: not (a.n >= 0 and a.n != 0)", true),
            ("always forall a in A: a.n >= 0 and a.n != 0", false),
            ("always forall a in A: a.n != 0 and a.n >= 0", false),
            ("always forall a in A: a.n != 0 or a.n >= 0", true),
            ("eventually exists a in A: a.n >= 0 and a.n > 0", false),
            ("always forall a in A: a.n > 0 or a.n >= 0", true),
            ("always exists a in A where a.n != a.k: a.n <= 0", false),
            ("always forall a in A: if a.k == 1 then a.n < 0 else a.n <= 0", false),
        ],
    );
}

#[test]
fn of_several_agents_at_zero_all_count() {
    check(
        "agent A { discrete n: int = 1, k: int = 1 }
         system { a = A[3]() }
         run { until 2 }",
        &[
            ("always not (exists a in A: a.n == 1 and a.k != 1)", true),
            ("eventually exists a in A: a.n == 1 and a.k != 1", false),
            ("always forall a in A: a.k != 1 or a.n == 1", true),
            ("always forall a in A: a.k != 1", false),
            ("eventually exists a in A where a.k == 1: a.n != 1", false),
            ("(forall a in A: a.n == 1) until [0, 1] (exists a in A: a.n == 1 and a.k != 1)", false),
        ],
    );
    // one of two is at zero where that is enough, the other where it is not; in either order
    for values in ["0, 1", "1, 0"] {
        let [first, last] = [0, 3].map(|k| &values[k..k + 1]);
        let model = format!(
            "agent A(c: int) {{ discrete n: int = 0 }}
             system {{ a = A(c = {first})  b = A(c = {last}) }}
             run {{ until 2 }}"
        );
        let body = "(a.c == 0 and a.n >= 0) or (a.c == 1 and a.n > 0)";
        check(
            &model,
            &[
                (&format!("always forall a in A: {body}"), false),
                (&format!("eventually exists a in A: {body}"), true),
                (&format!("always exists a in A: {body}"), true),
                (&format!("eventually forall a in A: {body}"), false),
            ],
        );
        let decided = run(&format!(
            "{model} property worst = always forall x in A: {body_of_x}
             property best = eventually exists x in A: {body_of_x}
             property worst_ahead = eventually [0, 1] always [0, 1] forall x in A: {body_of_x}
             property best_ahead = always [0, 1] eventually [0, 1] exists x in A: {body_of_x}",
            body_of_x = body.replace("a.", "x.")
        ));
        let [closed, open] = if first == "0" { ["a", "b"] } else { ["b", "a"] };
        for (name, agent) in
            [("worst", open), ("best", closed), ("worst_ahead", open), ("best_ahead", closed)]
        {
            assert_eq!(verdict(&decided, name).agents, [("x".to_string(), agent.to_string())], "{name}");
        }
    }
}

/// What is zero on both sides one after the other: c is 0 or 1, from 1 on 1 or 0.
#[test]
fn of_several_times_at_zero_all_count() {
    for (first, last) in [(0, 1), (1, 0)] {
        let model = format!(
            "agent A {{ discrete n: int = 0, c: int = {first}  turn: after 1 {{ c := {last} }} }}
             system {{ a = A() }}
             run {{ until 3 }}"
        );
        let body = "forall a in A: (a.c == 0 and a.n >= 0) or (a.c == 1 and a.n > 0)";
        let at_first = first == 0;
        check(
            &model,
            &[
                (&format!("always {body}"), false),
                (&format!("eventually {body}"), true),
                (&format!("always [0, 0.5] {body}"), at_first),
                (&format!("eventually [1.5, 2] {body}"), !at_first),
                (&format!("always [0, 1.5] eventually [0, 0.25] {body}"), false),
                (&format!("eventually [0, 1.5] always [0, 0.25] {body}"), true),
                (&format!("always [0, 0.5] eventually [0, 1.5] {body}"), true),
                (&format!("eventually [0, 0.5] always [0, 1.5] {body}"), false),
                (&format!("({body}) until [1.5, 2] (forall a in A: a.n <= 0)"), false),
                (&format!("(forall a in A: a.n <= 0) until [1.5, 2] ({body})"), !at_first),
                (&format!("always [0, 0.25] (forall a in A: a.n <= 0) until [1.5, 2] ({body})"), !at_first),
                (
                    &format!("eventually [0, 0.25] ({body}) until [0.5, 2] (forall a in A: a.n <= 0)"),
                    at_first,
                ),
            ],
        );
    }
}

/// x touches zero at 1 and at no other time; n is zero all the time.
#[test]
fn a_touch_is_on_the_other_side_for_an_instant() {
    for agents in ["a = A(x0 = -1)", "a = A(x0 = 5)  b = A(x0 = -1)", "b = A(x0 = -1)  a = A(x0 = 5)"] {
        let model = format!(
            "agent A(x0: real) {{ state x = x0  discrete n: int = 0  flow {{ x' = 1 }} }}
             system {{ {agents} }}
             run {{ until 4 }}"
        );
        let (left_out, met) =
            ("forall a in A: a.n >= 0 and a.x*a.x > 0", "exists a in A: a.n > 0 or a.x*a.x <= 0");
        check(
            &model,
            &[
                (&format!("always {left_out}"), false),
                (&format!("always [1.1, 2] {left_out}"), true),
                (&format!("eventually {met}"), true),
                (&format!("eventually [1.1, 2] {met}"), false),
                (&format!("eventually [0, 0.25] always [0, 2] {left_out}"), false),
                (&format!("eventually [0, 1.5] always [0, 2] {left_out}"), true),
                (&format!("always [0, 0.25] eventually [0, 2] {met}"), true),
                (&format!("always [0, 1.5] eventually [0, 2] {met}"), false),
                (&format!("({left_out}) until [2, 3] (forall a in A: a.n >= 0)"), false),
                (&format!("({left_out}) until [0.5, 3] (forall a in A: a.n >= 0)"), true),
                (&format!("(forall a in A: a.n >= 0) until [0.5, 3] ({met})"), true),
                (&format!("(forall a in A: a.n >= 0) until [1.5, 3] ({met})"), false),
                (&format!("always [0, 0.25] (forall a in A: a.n >= 0) until [0.5, 3] ({met})"), true),
            ],
        );
    }
}

#[test]
fn a_crossing_is_not_on_both_sides() {
    check(
        "agent A { state x = -1  discrete n: int = 0  flow { x' = 1 } }
         system { a = A() }
         run { until 4 }",
        &[
            ("always forall a in A: a.n >= 0 or a.x > 0", true),
            ("always [0, 0.5] eventually [0, 1] forall a in A: a.n >= 0 or a.x > 0", true),
            ("always [0, 2] eventually [0, 0.25] forall a in A: a.n >= 0 or a.x > 0", true),
            ("eventually forall a in A: a.n > 0 and a.x <= 0", false),
            ("eventually [0, 0.5] always [0, 0.75] forall a in A: a.n > 0 and a.x <= 0", false),
            ("eventually [0, 2] always [0, 0.25] forall a in A: a.n >= 0 and a.x > 0", true),
        ],
    );
}

/// Random conditions of numbers that are written at some times, under random operators, against a slow evaluator that knows no
/// margins.
#[test]
fn random_formulas_are_as_true_as_their_conditions() {
    const N_MODELS: u64 = 45;
    const N_FORMULAS: usize = 12;
    let mut n_true = 0;
    let mut n_at_zero = 0;
    for seed in 0..N_MODELS {
        let mut dice = Dice::new(seed);
        let schedule = Schedule::random(&mut dice);
        let formulas: Vec<Formula> = (0..N_FORMULAS).map(|_| Formula::random(&mut dice)).collect();
        let texts = formulas.iter().enumerate().map(|(k, formula)| format!("property p{k} = {formula}\n"));
        let text = format!("{schedule}{}", texts.collect::<String>());
        let run = run(&text);
        for (k, formula) in formulas.iter().enumerate() {
            let found = verdict(&run, &format!("p{k}"));
            let expected = formula.holds(&schedule);
            assert_eq!(found.holds, expected, "{formula}\n{found:?}\n{schedule}");
            n_true += usize::from(expected);
            n_at_zero += usize::from(found.margin == 0.0);
        }
    }
    let n = N_MODELS as usize * N_FORMULAS;
    assert!(n / 5 < n_true && n_true < n - n / 5, "{n_true} of {n} hold");
    assert!(n / 4 < n_at_zero, "{n_at_zero} of {n} are at zero");
    assert_eq!((N_AGENTS, TIMES.len()), (3, 3));
}
