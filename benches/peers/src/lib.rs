//! The bench is `benches/bumper.rs`.
