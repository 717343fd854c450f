//! The limits of this floor, by name. They are far above any model in sight and cannot be raised by a setting: each
//! guards memory or time against a model that asks for too much by mistake, and each has a diagnostic.

/// How many agents there may be at t = 0.
pub const AGENTS_MAX: usize = 10_000_000;

/// How many operations all constants together may take.
pub const STEPS_MAX: u64 = 50_000_000;

/// How many operations the initial values of an agent may take, on average.
pub const STEPS_PER_AGENT_MAX: u64 = 1_000;

/// How deep expressions may nest, over definitions that are looked up inside others; one expression alone stays below it.
pub const DEPTH_MAX: usize = 1_600;

/// What a definition that is looked up inside another counts in [`DEPTH_MAX`].
pub const DEPTH_OF_DEFINITION: usize = 8;

/// How many expressions of functions are measured again for the dimensions of their calls, all together; later calls are checked by
/// what their functions declare.
pub const INLINED_STEPS_MAX: u64 = 10_000_000;

/// How deep calls inside calls are measured again for their dimensions.
pub const INLINED_DEPTH_MAX: usize = 64;

/// How many branches an `if ... else if ...` among actions may have.
pub const BRANCHES_MAX: usize = 256;
