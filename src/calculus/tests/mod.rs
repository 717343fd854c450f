//! Tests of this floor's inner passes on random expressions, from a fixed seed.

mod conditions;
mod derivatives;
mod kinks;
mod random;
mod simplification;
