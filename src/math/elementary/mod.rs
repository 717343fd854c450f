//! The functions of one or two real arguments that no IEEE instruction gives, the same bits on every CPU.
//!
//! Ours are the frequent ones: sine, cosine, exponential, logarithm, power, arc tangent, cube root and hypotenuse,
//! within 1 unit in the last place, written without data-dependent branches on the usual path so that the same
//! source can serve several lanes. The others come from a correctly rounded crate
//! (docs/decisions/0001-elementary-functions.md). `twofold` carries the precision, `quadrant` reduces angles; all use
//! nothing but +, -, *, /, square roots and the bits of a number.

mod twofold;
mod quadrant;
mod sincos;
mod exponential;
mod logarithm;
mod power;
mod arctangent;
mod root;
mod exact;
mod library;

pub use arctangent::{atan, atan2};
pub use exact::{maximum, minimum, modulo, powi, round, sign};
pub use exponential::exp;
pub use library::{acos, acosh, asin, asinh, atanh, cosh, log2, log10, sinh, tan, tanh};
pub use logarithm::log;
pub use power::pow;
pub use root::{cbrt, hypot};
pub use sincos::{cos, sin, sin_cos};

pub(super) use quadrant::is_moderate;
pub(super) use sincos::{cos_moderate, sin_cos_moderate, sin_moderate};
