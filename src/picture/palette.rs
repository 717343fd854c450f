//! Colours that people who see few colours can tell apart too: those of M. Okabe and K. Ito, 2008.

/// Red, green, blue.
pub type Colour = [u8; 3];

/// In the order in which they are given out. Yellow, hard to see on white, comes last.
pub const COLOURS: [Colour; 8] = [
    [0x00, 0x72, 0xb2],
    [0xe6, 0x9f, 0x00],
    [0x00, 0x9e, 0x73],
    [0xd5, 0x5e, 0x00],
    [0xcc, 0x79, 0xa7],
    [0x56, 0xb4, 0xe9],
    [0x8c, 0x8c, 0x8c],
    [0xd8, 0xc8, 0x1e],
];

/// The colour of the thing with this number; they come again after eight.
pub fn colour(number: usize) -> Colour {
    COLOURS[number % COLOURS.len()]
}

/// As SVG and CSS write it.
pub fn hex(colour: Colour) -> String {
    let [red, green, blue] = colour;
    format!("#{red:02x}{green:02x}{blue:02x}")
}
