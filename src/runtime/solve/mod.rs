//! Numerics only: steps, dense output, step control, roots. Knows no agent, kernel or event.
//!
//! Single letters, here only: `t` time, `h` step, `x` state, `k` stage rates, `g` the expression of a guard,
//! `s`, `e` the ends of a stretch of time.

pub mod segment;
pub mod control;
pub mod jacobian;
pub mod method;
pub mod tsit5;
pub mod adams;
pub mod series_step;
pub mod taylor;
mod cuthill_mckee;
mod banded;
mod shifted;
mod rodas5p;
pub mod switch;
pub mod integrate;
pub mod quadrature;
mod bracket;
mod curve;
pub mod roots;
pub mod polynomial;
pub mod step_select;
pub mod extra_state;

use adams::Adams;
use control::Accuracy;
use method::Method;
use rodas5p::Rodas5p;
use taylor::Taylor;
use tsit5::Tsit5;

/// A method's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodName {
    /// [`Tsit5`].
    Tsit5,
    /// [`Adams`].
    Adams,
    /// [`Taylor`].
    Taylor,
    /// [`Rodas5p`].
    Stiff,
}

impl MethodName {
    /// As users call it.
    pub fn name(self) -> &'static str {
        match self {
            MethodName::Tsit5 => "tsit5",
            MethodName::Adams => "adams",
            MethodName::Taylor => "taylor",
            MethodName::Stiff => "stiff",
        }
    }
}

/// Which methods take the steps of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Methods {
    /// One for all.
    One(MethodName),
    /// An explicit one, and [`MethodName::Stiff`] where a flow is stiff.
    Automatic(MethodName),
}

impl Methods {
    /// The one that begins.
    pub fn first(self) -> MethodName {
        match self {
            Methods::One(name) | Methods::Automatic(name) => name,
        }
    }
}

/// The method of this name for an accuracy.
pub fn method(name: MethodName, accuracy: Accuracy) -> Box<dyn Method> {
    match name {
        MethodName::Tsit5 => Box::<Tsit5>::default(),
        MethodName::Adams => Box::<Adams>::default(),
        MethodName::Taylor => Box::new(Taylor::new(accuracy.tolerance)),
        MethodName::Stiff => Box::<Rodas5p>::default(),
    }
}

/// The width to which the time of a root is known at least: max(1e-12, 4 ulp of t), s.
pub fn time_resolution(t: f64) -> f64 {
    (4.0 * ulp(t)).max(1e-12)
}

/// Whether what ends at `end` leads on from `t`: by more than the rounding of two ways to the same time, on which no step is possible.
pub fn leads_on(t: f64, end: f64) -> bool {
    end > t + 4.0 * ulp(t)
}

/// A time that is scheduled; the end of the run if it lies within 4 ulp of that (rule 11).
pub fn scheduled(time: f64, end: f64) -> f64 {
    if (time - end).abs() <= 4.0 * ulp(end) { end } else { time }
}

/// The distance from |t| to the next number.
pub fn ulp(t: f64) -> f64 {
    let size = t.abs();
    size.next_up() - size
}
