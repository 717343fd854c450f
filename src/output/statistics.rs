//! The statistics of a run as JSON. Keys are stable; only times of the computer (`_seconds`, `compile_parts`) differ from run
//! to run.

use serde_json::{Map, Value, json};

use super::diagnostic_json::diagnostic_json;
use super::report::Report;
use crate::runtime::observe::{End, FalseAssert, Verdict};

/// The statistics, one object over several lines with a line end. `until` is null where only a `stop` ends the run.
pub fn statistics(report: &Report<'_>) -> String {
    let outcome = report.outcome;
    let stats = &outcome.stats;
    let mut value = json!({
        "model": report.model,
        "algorithm": report.algorithm,
        "engine": report.engine,
        "integrator": report.integrator,
        "backend": report.backend,
        "threads": stats.threads,
        "tolerance": report.tolerance,
        "absolute": report.absolute,
        "seed": report.seed,
        "until": report.until,
        "end": end(&outcome.end, report),
        "end_time": outcome.time,
        "agents": report.cast.agents.len(),
        "events": stats.events,
        "steps": stats.steps,
        "rejected": stats.rejected,
        "starts": stats.starts,
        "rhs_evaluations": stats.rhs_evaluations,
        "jacobians": stats.jacobians,
        "guard_evaluations": stats.guard_evaluations,
        "guard_ranges": stats.guard_ranges,
        "places": stats.places,
        "guard_places": stats.guard_places,
        "pairs_listed": stats.pairs_listed,
        "undecided_roots": stats.undecided_roots,
        "cuts": stats.cuts,
        "operations": stats.operations,
        "guard_polynomials": stats.guard_polynomials,
        "missed_events": stats.misses.map(|misses| misses.missed),
        "late_events": stats.misses.map(|misses| misses.late),
        "latest_event": stats.misses.map(|misses| misses.latest),
        "false_asserts": outcome.false_asserts.iter().map(|claim| false_assert(claim, report)).collect::<Vec<_>>(),
        "methods": counts(&stats.methods),
        "types": types(report),
        "transitions": counts(&stats.transitions),
        "functions": report.functions,
        "instructions": report.instructions,
        "code_bytes": report.code_bytes,
        "compile_seconds": report.compile_seconds,
        "run_seconds": report.run_seconds,
        "version": env!("CARGO_PKG_VERSION"),
    });
    value["properties"] = outcome.verdicts.iter().map(property).collect();
    value["busiest_agents"] = counts(report.busiest);
    value["slowest_agents"] = counts(report.slowest);
    value["compile_parts"] = parts(report.compile_parts);
    value["writing_seconds"] = json!(report.writing_seconds);
    value["page_seconds"] = json!(report.page_seconds);
    let mut text = serde_json::to_string_pretty(&value).expect("every key is a string");
    text.push('\n');
    text
}

fn end(end: &End, report: &Report<'_>) -> Value {
    match end {
        End::Until => json!({ "kind": "until" }),
        End::Stop { reason, by: Some((agent, by)) } => {
            json!({ "kind": "stop", "reason": reason, "agent": report.cast.agent(*agent), "by": by })
        }
        End::Stop { reason, by: None } => {
            json!({ "kind": "stop", "reason": reason, "agent": null, "by": "stop when" })
        }
        End::Interrupted => json!({ "kind": "interrupted" }),
        End::Error(diagnostic) => {
            let mut whole = diagnostic_json(report.sources, diagnostic);
            whole["kind"] = json!("error");
            whole["message"] = json!(diagnostic.title);
            whole
        }
        End::Output(error) => json!({ "kind": "output", "message": error.to_string() }),
    }
}

fn false_assert(claim: &FalseAssert, report: &Report<'_>) -> Value {
    json!({
        "message": claim.message,
        "time": claim.time,
        "agent": report.cast.agent(claim.agent),
        "count": claim.count,
    })
}

/// A margin that is not finite is null.
fn property(verdict: &Verdict) -> Value {
    let agents = verdict.agents.iter().map(|(name, agent)| (name.clone(), json!(agent)));
    json!({
        "name": verdict.name,
        "holds": verdict.holds,
        "margin": verdict.margin.is_finite().then_some(verdict.margin),
        "time": verdict.time,
        "agents": Value::Object(agents.collect::<Map<_, _>>()),
    })
}

fn types(report: &Report<'_>) -> Value {
    let of_type = report.outcome.stats.types.iter().map(|ty| {
        let counts = json!({
            "agents": ty.agents,
            "created": ty.created,
            "destroyed": ty.destroyed,
            "steps": ty.steps,
            "events": ty.events,
        });
        (ty.name.clone(), counts)
    });
    Value::Object(of_type.collect::<Map<_, _>>())
}

fn parts(named: &[(&str, f64)]) -> Value {
    Value::Object(
        named.iter().map(|(name, seconds)| (name.replace(' ', "_"), json!(seconds))).collect::<Map<_, _>>(),
    )
}

fn counts(named: &[(String, u64)]) -> Value {
    Value::Object(named.iter().map(|(name, count)| (name.clone(), json!(count))).collect::<Map<_, _>>())
}
