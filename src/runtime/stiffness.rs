//! How fast a flow is: the spectral radius of its Jacobian, for messages about steps that become too small.

use nalgebra::DMatrix;

use crate::runtime::population::Agents;
use crate::runtime::present::{Depth, Present};

/// The largest magnitude of an eigenvalue of df/dx of an agent's flow at the present instant, 1/s; NaN if the Jacobian
/// is not finite there.
pub fn fastest_rate(agents: &Agents<'_>, present: &mut Present, agent: usize) -> f64 {
    let flow = agents.flow(agent);
    let n = agents.layout(agent).n_states;
    let slots = agents.slots(&flow.frame, &[agent]);
    present.make(agents, &slots, Depth::States);
    let mut values = vec![0.0; flow.jacobian.len()];
    agents.program.kernel(flow.jacobian_values).eval(
        &present.views(agents, &slots),
        present.time,
        &mut values,
    );
    let mut matrix = DMatrix::zeros(n, n);
    for (entry, value) in flow.jacobian.iter().zip(&values) {
        if entry.slot == 0 {
            matrix[(entry.row, entry.column)] = *value;
        }
    }
    if !matrix.iter().all(|value| value.is_finite()) {
        return f64::NAN;
    }
    matrix.complex_eigenvalues().iter().map(|value| value.norm()).fold(0.0, f64::max)
}
