//! Random numbers: bits that belong to a key, and the distributions that are made of them.
//!
//! There is no stream that is used up, so no draw depends on another, on how many there are or on the order of work. The
//! bits are SipHash-2-4 (Aumasson & Bernstein 2012), a keyed hash with published test vectors, of this message:
//!
//! | | bytes |
//! |---|---|
//! | key | the seed, little-endian (8), then the ASCII text `hyc draw` (8) |
//! | message | the agent's path in UTF-8, a zero byte, the variable's name in UTF-8, a zero byte, the word's number k, little-endian (8) |
//!
//! The path is the agent's name in `system`, `cars[3]`. Draw number n of a variable (0: its initial value; then, from 1 on, those
//! of actions) has the words 2 n and 2 n + 1; a transition by `rate` draws as a variable of its label would. The hash is word k. Its first 52 bits are a number
//! n, and `u = (n + 1/2) / 2^52`, exactly, is uniform in the open interval from 0 to 1. With u for the first word and w for the second:
//!
//! | | value |
//! |---|---|
//! | `Uniform(a, b)` | `a (1 - u) + b u`, no less than a and no more than b |
//! | `Normal(mean, sd)` | `mean + sd (sqrt(-2 log u) cos(2 pi w))` (Box & Muller 1958) |
//! | `Exponential(rate)` | `-log(u) / rate` |
//!
//! The functions are those of [`elementary`], so the values are the same on every machine.

use std::hash::Hasher;

use siphasher::sip::SipHasher24;

use crate::math::elementary;

/// The second half of the hash's key.
const PURPOSE: u64 = u64::from_le_bytes(*b"hyc draw");

/// The randomness of one variable of one agent.
#[derive(Clone, Copy, Debug)]
pub struct Key<'k> {
    /// The seed of the run.
    pub seed: u64,
    /// The agent's path, `cars[3]`.
    pub agent: &'k str,
    /// The variable's name.
    pub variable: &'k str,
    /// The number of the draw.
    pub draw: u64,
}

impl Key<'_> {
    /// Word number `k` of this key's bits.
    pub fn word(self, k: u64) -> u64 {
        let mut hasher = SipHasher24::new_with_keys(self.seed, PURPOSE);
        for text in [self.agent, self.variable] {
            hasher.write(text.as_bytes());
            hasher.write(&[0]);
        }
        hasher.write(&k.to_le_bytes());
        hasher.finish()
    }

    /// A number made of word `k` of this draw, uniform in the open interval from 0 to 1.
    fn unit(self, k: u64) -> f64 {
        const SCALE: f64 = 1.0 / (1_u64 << 52) as f64;
        ((self.word(2 * self.draw + k) >> 12) as f64 + 0.5) * SCALE
    }
}

/// A distribution of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Uniform between two bounds.
    Uniform,
    /// Normal with a mean and a standard deviation.
    Normal,
    /// Exponential with a rate.
    Exponential,
}

impl Distribution {
    /// All of them.
    pub const ALL: [Distribution; 3] =
        [Distribution::Uniform, Distribution::Normal, Distribution::Exponential];

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Distribution::Uniform => "Uniform",
            Distribution::Normal => "Normal",
            Distribution::Exponential => "Exponential",
        }
    }

    /// Its parameters in words, in order.
    pub fn parameters(self) -> &'static [&'static str] {
        match self {
            Distribution::Uniform => &["the lower bound", "the upper bound"],
            Distribution::Normal => &["the mean", "the standard deviation"],
            Distribution::Exponential => &["the rate"],
        }
    }

    /// The first parameter that is out of range, by its number, and what it has to be; there are as many as [`Self::parameters`].
    pub fn problem(self, parameters: &[f64]) -> Option<(usize, &'static str)> {
        if let Some(k) = parameters.iter().position(|value| !value.is_finite()) {
            return Some((k, "a finite number"));
        }
        match self {
            Distribution::Uniform if parameters[1] < parameters[0] => {
                Some((1, "no less than the lower bound"))
            }
            Distribution::Normal if parameters[1] < 0.0 => Some((1, "0 or more")),
            Distribution::Exponential if parameters[0] <= 0.0 => Some((0, "more than 0")),
            Distribution::Uniform | Distribution::Normal | Distribution::Exponential => None,
        }
    }

    /// The value that a key has; parameters without a [`Self::problem`]. Infinite only if the distribution is too wide for numbers.
    pub fn draw(self, parameters: &[f64], key: Key) -> f64 {
        let u = key.unit(0);
        match self {
            Distribution::Uniform => {
                let [a, b] = [parameters[0], parameters[1]];
                elementary::minimum(elementary::maximum(a * (1.0 - u) + b * u, a), b)
            }
            Distribution::Normal => {
                let angle = 2.0 * std::f64::consts::PI * key.unit(1);
                let radius = (-2.0 * elementary::log(u)).sqrt();
                parameters[0] + parameters[1] * (radius * elementary::cos(angle))
            }
            Distribution::Exponential => -elementary::log(u) / parameters[0],
        }
    }
}
