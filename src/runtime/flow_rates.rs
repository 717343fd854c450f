//! `x'` in an expression: the rate of an agent's state by the flow that is active, where its trajectory has come to.
//!
//! The slope of dense output is not that: it is off by what a step may be off by, and jumps where the next step begins. So
//! the flow is evaluated on the states of the dense output. A stiff flow answers an error of these, however small, by rates
//! that the solution does not have; there the slope is taken ([`Segment::own_rates`]).
//!
//! [`Segment::own_rates`]: crate::runtime::solve::segment::Segment::own_rates

use smallvec::SmallVec;

use crate::codegen::kernel::{AgentBox, AgentView};
use crate::math::Interval;
use crate::runtime::population::{ABSENT, Agent, Agents};
use crate::runtime::present::{Boxes, Views};
use crate::runtime::solve::segment::Segment;

/// States, rates and second rates of one agent: row after row.
type Rows<T> = SmallVec<[T; 12]>;

/// Overwrites the rates and the second rates of an agent at `t`, not cold, by those of its flow, if its slopes are not its rates.
pub fn flow_rates_at(agents: &Agents<'_>, agent: usize, t: f64, rates: &mut [f64], seconds: &mut [f64]) {
    if agents.agents[agent].segment.has_own_rates(t) {
        return;
    }
    let flow = agents.flow(agent);
    let slots = agents.slots(&flow.frame, &[agent]);
    let rows_of = |agent: usize| {
        let mut rows = Rows::new();
        if agent != ABSENT {
            let n = agents.agents[agent].states.len();
            rows.resize(2 * n, 0.0);
            let (states, slopes) = rows.split_at_mut(n);
            agents.states_at(agent, t, states);
            agents.rates_at(agent, t, slopes);
        }
        rows
    };
    let all: SmallVec<[Rows<f64>; 2]> = slots.iter().map(|&agent| rows_of(agent)).collect();
    let views: Views<'_> = slots
        .iter()
        .zip(&all)
        .map(|(&agent, rows)| {
            if agent == ABSENT {
                return AgentView::absent(agents.absent_row());
            }
            let (states, rates) = rows.split_at(rows.len() / 2);
            AgentView { states, rates, accelerations: &[], aux: &agents.agents[agent].aux }
        })
        .collect();
    agents.program.kernel(flow.rates).eval(&views, t, rates);
    agents.program.kernel(flow.accelerations).eval(&views, t, seconds);
}

/// Bounds of the rates and the second rates of an agent over [s, e] by its flow; none if its slopes are its rates.
pub fn flow_rates_over(
    agents: &Agents<'_>,
    agent: usize,
    (s, e): (f64, f64),
    registers: &mut Vec<Interval>,
) -> Option<[Vec<Interval>; 2]> {
    if agents.agents[agent].segment.has_own_rates(s) {
        return None;
    }
    let flow = agents.flow(agent);
    let slots = agents.slots(&flow.frame, &[agent]);
    let rows_of = |agent: usize| {
        let n = if agent == ABSENT { agents.row_width() } else { agents.agents[agent].states.len() };
        let mut rows: Rows<Interval> = SmallVec::from_elem(Interval::WHOLE, 2 * n);
        if agent != ABSENT {
            for state in 0..n {
                (rows[state], rows[n + state]) = range_along(&agents.agents[agent], state, (s, e));
            }
        }
        rows
    };
    let all: SmallVec<[Rows<Interval>; 2]> = slots.iter().map(|&agent| rows_of(agent)).collect();
    let boxes: Boxes<'_> = slots
        .iter()
        .zip(&all)
        .map(|(&agent, rows)| {
            let (states, rates) = rows.split_at(rows.len() / 2);
            let aux = if agent == ABSENT { agents.absent_row() } else { &agents.agents[agent].aux };
            AgentBox { states, rates, accelerations: &[], aux }
        })
        .collect();
    let time = Interval { lo: s, hi: e };
    Some([flow.rates, flow.accelerations].map(|function| {
        let mut bounds = vec![Interval::WHOLE; agents.agents[agent].states.len()];
        agents.program.kernel(function).range(&boxes, time, registers, &mut bounds);
        bounds
    }))
}

/// Bounds of a state over [s, e], and of its slope, by its last step and those ahead of it.
fn range_along(agent: &Agent, state: usize, (s, e): (f64, f64)) -> (Interval, Interval) {
    let steps = std::iter::once(&agent.segment).chain(agent.ahead.segments());
    let is_there = |segment: &&Segment| segment.start <= e && s <= segment.end;
    let bounds = steps.filter(is_there).map(|segment| {
        let [value, slope, _] = segment.jet_range(state, s.max(segment.start), e.min(segment.end));
        (value, slope)
    });
    let hull = bounds.reduce(|one, other| (one.0.hull(other.0), one.1.hull(other.1)));
    hull.unwrap_or((Interval::WHOLE, Interval::WHOLE))
}
