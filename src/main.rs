//! hyc
fn main() {}
