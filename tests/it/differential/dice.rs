//! A small generator of pseudo-random numbers (splitmix64): the same seed gives the same model on every machine.

/// Models from this number on have aggregates (`count`, `sum`, ...) besides.
pub const WITH_AGGREGATES: u64 = 1_000_000;

/// Models from this number on have events, and no aggregates.
pub const WITH_EVENTS: u64 = 2_000_000;

/// Models from this number on have modes in modes, regions, and agents that are created and destroyed; no aggregates and no events.
pub const WITH_LIVES: u64 = 3_000_000;

/// The state of the generator.
pub struct Dice {
    state: u64,
    /// Whether aggregates may be written.
    pub aggregates: bool,
    /// Whether events may be written.
    pub events: bool,
    /// Whether modes may hold modes, and agents come and go.
    pub lives: bool,
}

impl Dice {
    /// The dice of one model.
    pub fn new(seed: u64) -> Self {
        let state = seed.wrapping_mul(0xD134_2543_DE82_EF95).wrapping_add(0x2545_F491_4F6C_DD1D);
        Self {
            state,
            aggregates: (WITH_AGGREGATES..WITH_EVENTS).contains(&seed),
            events: (WITH_EVENTS..WITH_LIVES).contains(&seed),
            lives: seed >= WITH_LIVES,
        }
    }

    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// True in so many of a hundred cases.
    pub fn percent(&mut self, share: usize) -> bool {
        self.below(100) < share
    }

    /// One of these.
    pub fn pick<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }

    /// A number between these with three decimals, as text; a negative one in parentheses.
    pub fn number(&mut self, low: f64, high: f64) -> String {
        let unit = (self.next() >> 11) as f64 / (1u64 << 53) as f64;
        let value = low + (high - low) * unit;
        if value < 0.0 { format!("({value:.3})") } else { format!("{value:.3}") }
    }

    /// A number of this size at least and at most, of either sign.
    pub fn signed(&mut self, low: f64, high: f64) -> String {
        if self.percent(50) { self.number(low, high) } else { self.number(-high, -low) }
    }
}
