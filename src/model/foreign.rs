//! Names of other languages, and what is written here instead: of types, of functions, of values.
//!
//! They are free: a model may declare them. They are looked at only where a name is not known.

/// What to write for a type that is not known.
pub(super) fn ty(name: &str) -> Option<&'static str> {
    find(&TYPES, name)
}

/// What to write for a function that is not known.
pub(super) fn function(name: &str) -> Option<&'static str> {
    find(&FUNCTIONS, name)
}

/// What to write for a value that is not known.
pub(super) fn value(name: &str) -> Option<&'static str> {
    find(&VALUES, name)
}

/// What to write for a setting of `run` that is not known.
pub(super) fn setting(name: &str) -> Option<&'static str> {
    find(&SETTINGS, name)
}

type Table<const N: usize> = [(&'static [&'static str], &'static str); N];

fn find<const N: usize>(table: &Table<N>, name: &str) -> Option<&'static str> {
    table.iter().find(|(names, _)| names.contains(&name)).map(|(_, help)| *help)
}

const TYPES: Table<6> = [
    (
        &["float", "double", "number", "Real", "Float", "Double", "float64", "f64", "decimal", "num"],
        "write `real`, with a unit if it has one: `real [m/s]`",
    ),
    (&["integer", "Integer", "long", "uint", "i32", "i64", "nat", "natural"], "write `int`"),
    (&["boolean", "Boolean", "logical"], "write `bool`"),
    (&["str", "String", "text", "char"], "write `string`; only a `param` can be one"),
    (
        &[
            "vector", "Vector", "vec", "vec2", "vec3", "Vec2", "Vec3", "point", "Point", "array", "matrix",
            "complex",
        ],
        "write a `real` for each component: `px: real, py: real`",
    ),
    (&["time", "Time", "duration", "Duration"], "write `real [s]`"),
];

const FUNCTIONS: Table<13> = [
    (&["ln"], "the natural logarithm is `log(x)`"),
    (&["pow", "power"], "a power is written `x^2`"),
    (&["square", "sqr"], "a square is written `x^2`"),
    (&["fabs", "Abs"], "write `abs(x)`"),
    (&["arcsin", "arccos", "arctan"], "write `asin(x)`, `acos(x)`, `atan(x)`"),
    (&["arctan2"], "write `atan2(y, x)`"),
    (&["fmod", "remainder"], "write `mod(a, b)`"),
    (&["sgn", "signum"], "write `sign(x)`"),
    (&["ceiling"], "write `ceil(x)`"),
    (&["int", "real", "float"], "write `round(x)`, `floor(x)` or `ceil(x)` for a whole number"),
    (
        &["rand", "random", "uniform", "normal", "randn", "gauss"],
        "a random value is drawn by `~`, at a declaration or in actions: `x ~ Uniform(0, 1)`",
    ),
    (&["der", "ddt", "derivative"], "the rate of a state is `x'`"),
    (&["norm", "dist", "distance"], "the length of a vector is `hypot(x, y)`"),
];

const VALUES: Table<8> = [
    (&["t", "T", "now", "clock"], "the time of the run is `time`, in s"),
    (&["dt", "h", "timestep"], "a model has no step size: rates stand in a flow, `flow { x' = v }`"),
    (&["this", "me", "myself"], "an agent itself is `self`"),
    (&["null", "nil", "nothing", "undefined", "nobody"], "no agent is written `none`"),
    (&["id", "who", "i"], "the number of an agent in its array, from 0, is `index`"),
    (&["e"], "e is written `exp(1)`"),
    (&["infinity", "Infinity", "oo"], "infinity is written `inf`"),
    (&["yes", "on", "no", "off"], "write `true` or `false`"),
];

const SETTINGS: Table<6> = [
    (&["end", "duration", "stop_time", "t_end", "tend", "tmax", "tstop", "horizon"], "write `until 10 [s]`"),
    (
        &["output", "plot", "save", "print", "write", "trajectory"],
        "write `record Car.x every 0.1 [s] to \"cars.csv\"`",
    ),
    (&["logfile", "trace"], "write `events to \"events.csv\"`"),
    (&["solver", "method", "ode"], "write `integrator taylor`, or leave it to hyc"),
    (&["rtol", "reltol", "precision", "accuracy", "tol", "eps"], "write `tolerance 1e-8`"),
    (&["atol", "abstol"], "write `absolute 1e-8`"),
];
