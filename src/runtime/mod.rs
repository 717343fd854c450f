//! From a program to what happens: events and samples, told to an observer.

pub mod limits;
pub mod observe;
