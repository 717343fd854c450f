//! tests

mod syntax;
