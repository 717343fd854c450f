//! Numerics only: steps, dense output, step control, roots. Knows no agent, kernel or event.
//!
//! Single letters, here only: `t` time, `h` step, `x` state, `k` stage rates, `g` the expression of a guard,
//! `s`, `e` the ends of a stretch of time.

pub mod segment;
pub mod control;
pub mod method;
pub mod tsit5;
pub mod adams;
pub mod integrate;
mod bracket;
mod curve;
pub mod roots;
pub mod polynomial;
pub mod step_select;
pub mod extra_state;

use adams::Adams;
use method::Method;
use tsit5::Tsit5;

/// A method's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodName {
    /// [`Tsit5`].
    Tsit5,
    /// [`Adams`].
    Adams,
}

/// The method of this name.
pub fn method(name: MethodName) -> Box<dyn Method> {
    match name {
        MethodName::Tsit5 => Box::<Tsit5>::default(),
        MethodName::Adams => Box::<Adams>::default(),
    }
}

/// The width to which the time of a root is known at least: max(1e-12, 4 ulp of t), s.
pub fn time_resolution(t: f64) -> f64 {
    (4.0 * ulp(t)).max(1e-12)
}

/// The distance from |t| to the next number.
pub fn ulp(t: f64) -> f64 {
    let size = t.abs();
    size.next_up() - size
}
