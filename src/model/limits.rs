//! The limits of this floor, by name. They are far above any model in sight and cannot be raised by a setting: each
//! guards memory or time against a model that asks for too much by mistake, and each has a diagnostic.

/// How many agents there may be at t = 0.
pub const AGENTS_MAX: usize = 10_000_000;

/// How many operations all constants and initial values together may take.
pub const STEPS_MAX: u64 = 500_000_000;

/// How many expressions a model may have.
pub const EXPRESSIONS_MAX: usize = 20_000_000;

/// How many definitions may wait for each other while one is looked up through another agent's.
pub const WAITING_MAX: usize = 64;

/// How many branches an `if ... else if ...` among actions may have.
pub const BRANCHES_MAX: usize = 256;
