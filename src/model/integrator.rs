//! The methods of integration, by the names that users give them.

/// A method of integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// What suits each agent and mode: [`Integrator::Tsit5`], and [`Integrator::Stiff`] where the flow is stiff.
    #[default]
    Auto,
    /// Taylor series of an order chosen from the tolerance.
    Taylor,
    /// Tsitouras' explicit Runge-Kutta pair of orders 5 and 4.
    Tsit5,
    /// Adams' predictor-corrector of orders 3 and 4, as in Esposito & Kumar (2004).
    Adams,
    /// Rodas5P, a linearly implicit method of orders 5 and 4 for stiff flows.
    Stiff,
}

impl Integrator {
    /// All, by the names that users give them.
    pub const NAMED: [(&'static str, Integrator); 5] = [
        ("auto", Integrator::Auto),
        ("taylor", Integrator::Taylor),
        ("tsit5", Integrator::Tsit5),
        ("adams", Integrator::Adams),
        ("stiff", Integrator::Stiff),
    ];

    /// The name that users give it.
    pub fn name(self) -> &'static str {
        let named = Self::NAMED.iter().find(|(_, integrator)| *integrator == self);
        named.expect("every method has a name").0
    }
}
