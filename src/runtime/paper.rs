//! How the agents' clocks advance: by `masim`, or by an algorithm as it was published in 2004, with the numbers that its
//! user gives.

/// An algorithm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Algorithm {
    /// Each agent on its own clock; events certified.
    Masim(Form),
    /// Algorithms 1 and 2 of Esposito & Kumar (2004).
    Masim2004(Paper),
    /// Algorithms 3 and 4: one clock for all.
    Sasim2004(Paper),
}

/// The form of the engine that runs `masim`. Both find the same events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// In windows of time: who cannot meet anybody runs ahead, and only near pairs are listed.
    #[default]
    Fast,
    /// One queue of clocks, all pairs: slow and simple.
    Plain,
}

impl Form {
    /// The name that users give it.
    pub fn name(self) -> &'static str {
        match self {
            Form::Fast => "fast",
            Form::Plain => "plain",
        }
    }
}

impl Default for Algorithm {
    fn default() -> Self {
        Algorithm::Masim(Form::default())
    }
}

impl Algorithm {
    /// The form of the engine that runs it: the published ones have the plain one only.
    pub fn form(self) -> Form {
        match self {
            Algorithm::Masim(form) => form,
            Algorithm::Masim2004(_) | Algorithm::Sasim2004(_) => Form::Plain,
        }
    }

    /// The name that users give it.
    pub fn name(self) -> &'static str {
        match self {
            Algorithm::Masim(_) => "masim",
            Algorithm::Masim2004(_) => "masim-2004",
            Algorithm::Sasim2004(_) => "sasim-2004",
        }
    }
}

/// What the user of the 2004 algorithms gives besides the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paper {
    /// The share of g and of every tau that a step is to leave over: 0 <= gamma < 1.
    pub gamma: f64,
    /// The least step that a guard may ask for, s.
    pub h_min: f64,
    /// The longest step, s.
    pub h_max: f64,
    /// Clocks count as equal within this, s (tau = 0).
    pub synchronisation: f64,
    /// A guard counts as zero within this, in its own unit (g = 0).
    pub event_tolerance: f64,
    /// Whether certified detection follows the run and counts what the algorithm misses; its cost is not counted.
    pub audit: bool,
}

impl Default for Paper {
    fn default() -> Self {
        Self {
            gamma: 0.1,
            h_min: 1e-10,
            h_max: 0.5,
            synchronisation: 1e-9,
            event_tolerance: 1e-6,
            audit: false,
        }
    }
}
