//! Writes a giant model, to see what the compiler makes of it: `cargo run --example giant -- SHAPE MEGABYTES > giant.hy`.
//!
//! Without words it lists the shapes.

#[allow(dead_code, reason = "shared with a test that counts")]
mod shapes;

use std::io::{self, Write as _};

fn main() -> io::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let wanted = words.first().and_then(|name| shapes::SHAPES.iter().find(|shape| shape.name == name));
    let megabytes = words.get(1).map_or(Some(10.0), |word| word.parse::<f64>().ok());
    match (wanted, megabytes) {
        (Some(shape), Some(size)) => {
            io::stdout().write_all(shape.with_bytes((size * 1e6) as usize).as_bytes())
        }
        _ => {
            let names: Vec<&str> = shapes::SHAPES.iter().map(|shape| shape.name).collect();
            Err(io::Error::other(format!("give a shape and megabytes; there are {}", names.join(", "))))
        }
    }
}
