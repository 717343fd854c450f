//! What steps cost, counted as they are taken.

/// Counts of steps, and of what they took.
#[derive(Clone, Debug, Default)]
pub struct Counts {
    /// Accepted, one for each member.
    pub steps: u64,
    /// Accepted, for each agent type.
    pub steps_of_type: Vec<u64>,
    /// Accepted, by agent, but for those that it took in herds.
    pub steps_of: Vec<u64>,
    /// Those of them that the method for stiff flows took where there is a choice.
    pub steps_stiff: u64,
    /// Rejected, one for each member.
    pub rejected: u64,
    /// Right-hand sides, one for each member.
    pub rhs_evaluations: u64,
    /// Jacobians, one for each member.
    pub jacobians: u64,
    /// Arithmetic operations: of the right-hand sides as their tapes have them, and of the method.
    pub operations: u64,
    /// Beginnings of an integration: at t = 0 and after every restart, one for each member.
    pub starts: u64,
}
