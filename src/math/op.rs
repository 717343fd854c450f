//! The operators: name, number of operands, and meaning in f64, each said once.
//!
//! Truth values are 1 and 0; as an operand every number but ±0 counts as true, NaN too. All operands are evaluated:
//! `And`, `Or` and `Select` skip none. "The same bits" holds up to the sign and payload of a NaN, which nothing in
//! the language can observe. What each operator does with NaN, -0 and infinity, where IEEE 754 leaves a choice:
//!
//! | operator | rule |
//! |---|---|
//! | `Min`, `Max` | NaN if either is; -0 is below +0 |
//! | `Sign` | 0 for ±0, NaN for NaN |
//! | `Round` | halves away from zero |
//! | `Mod` | the exact remainder with the divisor's sign, in [0, b) or (b, 0] |
//! | `Lt`, `Le`, `Eq` | false if either is NaN; `Ne` is true |
//! | `Powi` | the order of [`elementary::powi`]; `x^0` is 1 |
//! | `Pow`, `Hypot`, `Atan2` | as C's Annex F: `pow(x, 0)` and `pow(1, y)` are 1, `hypot(inf, NaN)` is inf |

use super::elementary;

/// A function of one number that machine code can call.
pub type Unary = extern "C" fn(f64) -> f64;

/// A function of two numbers that machine code can call.
pub type Binary = extern "C" fn(f64, f64) -> f64;

/// An operator on f64: booleans are 1.0 and 0.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Op {
    /// `-a`.
    Neg,
    /// `a + b`.
    Add,
    /// `a - b`.
    Sub,
    /// `a * b`.
    Mul,
    /// `a / b`.
    Div,
    /// `a` to the power `b`, where `b` is a constant integer of i32 size: repeated multiplication.
    Powi,
    /// `a` to the real power `b`.
    Pow,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// Arc sine, in [-pi/2, pi/2].
    Asin,
    /// Arc cosine, in [0, pi].
    Acos,
    /// Arc tangent, in [-pi/2, pi/2].
    Atan,
    /// `atan2(y, x)`: the angle of the point (x, y), in [-pi, pi].
    Atan2,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// Inverse of `Sinh`.
    Asinh,
    /// Inverse of `Cosh`, at least 0.
    Acosh,
    /// Inverse of `Tanh`.
    Atanh,
    /// Natural exponential.
    Exp,
    /// Natural logarithm.
    Log,
    /// Logarithm to base 2.
    Log2,
    /// Logarithm to base 10.
    Log10,
    /// Square root.
    Sqrt,
    /// Cube root, odd.
    Cbrt,
    /// Absolute value.
    Abs,
    /// -1, 0 or 1.
    Sign,
    /// The smaller one.
    Min,
    /// The larger one.
    Max,
    /// The largest integer that is not above.
    Floor,
    /// The smallest integer that is not below.
    Ceil,
    /// The nearest integer, halves away from zero.
    Round,
    /// The integer part, towards zero.
    Trunc,
    /// The remainder with the sign of the divisor `b`.
    Mod,
    /// `sqrt(a^2 + b^2)` without overflow.
    Hypot,
    /// `a < b`.
    Lt,
    /// `a <= b`.
    Le,
    /// `a == b`.
    Eq,
    /// `a != b`.
    Ne,
    /// Not `a`.
    Not,
    /// `a` and `b`.
    And,
    /// `a` or `b`.
    Or,
    /// `b` if `a` is true, else `c`.
    Select,
}

impl Op {
    /// Every operator once, in the order of the declaration.
    pub const ALL: &[Op] = &[
        Op::Neg,
        Op::Add,
        Op::Sub,
        Op::Mul,
        Op::Div,
        Op::Powi,
        Op::Pow,
        Op::Sin,
        Op::Cos,
        Op::Tan,
        Op::Asin,
        Op::Acos,
        Op::Atan,
        Op::Atan2,
        Op::Sinh,
        Op::Cosh,
        Op::Tanh,
        Op::Asinh,
        Op::Acosh,
        Op::Atanh,
        Op::Exp,
        Op::Log,
        Op::Log2,
        Op::Log10,
        Op::Sqrt,
        Op::Cbrt,
        Op::Abs,
        Op::Sign,
        Op::Min,
        Op::Max,
        Op::Floor,
        Op::Ceil,
        Op::Round,
        Op::Trunc,
        Op::Mod,
        Op::Hypot,
        Op::Lt,
        Op::Le,
        Op::Eq,
        Op::Ne,
        Op::Not,
        Op::And,
        Op::Or,
        Op::Select,
    ];

    /// The name in dumps; a function's is its name in the language.
    pub fn name(self) -> &'static str {
        match self {
            Op::Neg => "neg",
            Op::Add => "add",
            Op::Sub => "sub",
            Op::Mul => "mul",
            Op::Div => "div",
            Op::Powi => "powi",
            Op::Pow => "pow",
            Op::Sin => "sin",
            Op::Cos => "cos",
            Op::Tan => "tan",
            Op::Asin => "asin",
            Op::Acos => "acos",
            Op::Atan => "atan",
            Op::Atan2 => "atan2",
            Op::Sinh => "sinh",
            Op::Cosh => "cosh",
            Op::Tanh => "tanh",
            Op::Asinh => "asinh",
            Op::Acosh => "acosh",
            Op::Atanh => "atanh",
            Op::Exp => "exp",
            Op::Log => "log",
            Op::Log2 => "log2",
            Op::Log10 => "log10",
            Op::Sqrt => "sqrt",
            Op::Cbrt => "cbrt",
            Op::Abs => "abs",
            Op::Sign => "sign",
            Op::Min => "min",
            Op::Max => "max",
            Op::Floor => "floor",
            Op::Ceil => "ceil",
            Op::Round => "round",
            Op::Trunc => "trunc",
            Op::Mod => "mod",
            Op::Hypot => "hypot",
            Op::Lt => "lt",
            Op::Le => "le",
            Op::Eq => "eq",
            Op::Ne => "ne",
            Op::Not => "not",
            Op::And => "and",
            Op::Or => "or",
            Op::Select => "select",
        }
    }

    /// The number of operands, 1 to 3.
    pub fn arity(self) -> usize {
        match self {
            Op::Neg
            | Op::Sin
            | Op::Cos
            | Op::Tan
            | Op::Asin
            | Op::Acos
            | Op::Atan
            | Op::Sinh
            | Op::Cosh
            | Op::Tanh
            | Op::Asinh
            | Op::Acosh
            | Op::Atanh
            | Op::Exp
            | Op::Log
            | Op::Log2
            | Op::Log10
            | Op::Sqrt
            | Op::Cbrt
            | Op::Abs
            | Op::Sign
            | Op::Floor
            | Op::Ceil
            | Op::Round
            | Op::Trunc
            | Op::Not => 1,
            Op::Add
            | Op::Sub
            | Op::Mul
            | Op::Div
            | Op::Powi
            | Op::Pow
            | Op::Atan2
            | Op::Min
            | Op::Max
            | Op::Mod
            | Op::Hypot
            | Op::Lt
            | Op::Le
            | Op::Eq
            | Op::Ne
            | Op::And
            | Op::Or => 2,
            Op::Select => 3,
        }
    }

    /// Whether the result is always 0 or 1.
    pub fn is_boolean(self) -> bool {
        matches!(self, Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::Not | Op::And | Op::Or)
    }

    /// The meaning. Operands beyond [`Op::arity`] are not looked at.
    #[inline]
    pub fn eval(self, [a, b, c]: [f64; 3]) -> f64 {
        match self {
            Op::Neg => -a,
            Op::Add => a + b,
            Op::Sub => a - b,
            Op::Mul => a * b,
            Op::Div => a / b,
            Op::Powi => integer_power(a, b),
            Op::Pow => elementary::pow(a, b),
            Op::Sin => elementary::sin(a),
            Op::Cos => elementary::cos(a),
            Op::Tan => elementary::tan(a),
            Op::Asin => elementary::asin(a),
            Op::Acos => elementary::acos(a),
            Op::Atan => elementary::atan(a),
            Op::Atan2 => elementary::atan2(a, b),
            Op::Sinh => elementary::sinh(a),
            Op::Cosh => elementary::cosh(a),
            Op::Tanh => elementary::tanh(a),
            Op::Asinh => elementary::asinh(a),
            Op::Acosh => elementary::acosh(a),
            Op::Atanh => elementary::atanh(a),
            Op::Exp => elementary::exp(a),
            Op::Log => elementary::log(a),
            Op::Log2 => elementary::log2(a),
            Op::Log10 => elementary::log10(a),
            Op::Sqrt => a.sqrt(),
            Op::Cbrt => elementary::cbrt(a),
            Op::Abs => a.abs(),
            Op::Sign => elementary::sign(a),
            Op::Min => elementary::minimum(a, b),
            Op::Max => elementary::maximum(a, b),
            Op::Floor => a.floor(),
            Op::Ceil => a.ceil(),
            Op::Round => elementary::round(a),
            Op::Trunc => a.trunc(),
            Op::Mod => elementary::modulo(a, b),
            Op::Hypot => elementary::hypot(a, b),
            Op::Lt => truth(a < b),
            Op::Le => truth(a <= b),
            Op::Eq => truth(a == b),
            Op::Ne => truth(a != b),
            Op::Not => truth(a == 0.0),
            Op::And => truth(a != 0.0 && b != 0.0),
            Op::Or => truth(a != 0.0 || b != 0.0),
            Op::Select => {
                if a != 0.0 {
                    b
                } else {
                    c
                }
            }
        }
    }

    /// The meaning as a callable function, for operators of one operand that machine code has no instruction for.
    pub fn unary_fn(self) -> Option<Unary> {
        /// The code of `Op::eval` for one operator, behind C's calling convention.
        macro_rules! shim {
            ($op:ident) => {{
                extern "C" fn call(a: f64) -> f64 {
                    Op::$op.eval([a, 0.0, 0.0])
                }
                Some(call as Unary)
            }};
        }
        match self {
            Op::Sin => shim!(Sin),
            Op::Cos => shim!(Cos),
            Op::Tan => shim!(Tan),
            Op::Asin => shim!(Asin),
            Op::Acos => shim!(Acos),
            Op::Atan => shim!(Atan),
            Op::Sinh => shim!(Sinh),
            Op::Cosh => shim!(Cosh),
            Op::Tanh => shim!(Tanh),
            Op::Asinh => shim!(Asinh),
            Op::Acosh => shim!(Acosh),
            Op::Atanh => shim!(Atanh),
            Op::Exp => shim!(Exp),
            Op::Log => shim!(Log),
            Op::Log2 => shim!(Log2),
            Op::Log10 => shim!(Log10),
            Op::Cbrt => shim!(Cbrt),
            Op::Sign => shim!(Sign),
            Op::Floor => shim!(Floor),
            Op::Ceil => shim!(Ceil),
            Op::Round => shim!(Round),
            Op::Trunc => shim!(Trunc),
            Op::Neg | Op::Abs | Op::Sqrt | Op::Not => None,
            Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Powi | Op::Pow | Op::Atan2 => None,
            Op::Min | Op::Max | Op::Mod | Op::Hypot | Op::Lt | Op::Le | Op::Eq | Op::Ne => None,
            Op::And | Op::Or | Op::Select => None,
        }
    }

    /// The meaning as a callable function, for operators of two operands that machine code has no instruction for.
    pub fn binary_fn(self) -> Option<Binary> {
        /// The code of `Op::eval` for one operator, behind C's calling convention.
        macro_rules! shim {
            ($op:ident) => {{
                extern "C" fn call(a: f64, b: f64) -> f64 {
                    Op::$op.eval([a, b, 0.0])
                }
                Some(call as Binary)
            }};
        }
        match self {
            Op::Powi => shim!(Powi),
            Op::Pow => shim!(Pow),
            Op::Atan2 => shim!(Atan2),
            Op::Min => shim!(Min),
            Op::Max => shim!(Max),
            Op::Mod => shim!(Mod),
            Op::Hypot => shim!(Hypot),
            Op::Add | Op::Sub | Op::Mul | Op::Div => None,
            Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::And | Op::Or | Op::Select => None,
            Op::Neg | Op::Sin | Op::Cos | Op::Tan | Op::Asin | Op::Acos | Op::Atan => None,
            Op::Sinh | Op::Cosh | Op::Tanh | Op::Asinh | Op::Acosh | Op::Atanh => None,
            Op::Exp | Op::Log | Op::Log2 | Op::Log10 | Op::Sqrt | Op::Cbrt | Op::Abs | Op::Sign => None,
            Op::Floor | Op::Ceil | Op::Round | Op::Trunc | Op::Not => None,
        }
    }
}

/// True as a number.
#[inline]
fn truth(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}

/// [`elementary::powi`] with the exponent as a number; one that is no integer of i32 size goes to `pow`.
#[inline]
fn integer_power(x: f64, n: f64) -> f64 {
    let integer = n as i32;
    if f64::from(integer) == n { elementary::powi(x, integer) } else { elementary::pow(x, n) }
}
