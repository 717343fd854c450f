//! The method for stiff flows: Rodas5P, a Rosenbrock method of order 5 with an embedded one of order 4.
//!
//! Eight linear systems with one matrix take the place of the nonlinear ones of an implicit Runge-Kutta method:
//!
//! ```text
//! (1/(h gamma) I - J) u_i = f(t + c_i h, x + sum_j a_ij u_j) + 1/h sum_j C_ij u_j + h d_i df/dt      j < i
//! x(t + h) = x + sum_j a_8j u_j + u_8,   error u_8
//! x(t + theta h) = x + theta (x(t + h) - x) + theta (1 - theta) (k_1 + theta k_2 + theta^2 k_3),  k_m = sum_j D_mj u_j
//! ```
//!
//! with J = df/dx and df/dt at the step's begin. Method and embedded method are stiffly accurate and L-stable; the dense
//! output is of order 4. G. Steinebach, Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within
//! the Julia Differential Equations package, BIT 63 (2023) 27; the form is that of Hairer & Wanner, Solving ODEs II, IV.7.
//! The error is also looked at in the middle of the step: where the dense output p misses the flow by the defect
//! d = f(t, p) - p', it is off by about (1/(h gamma) I - J)^-1 d, however stiff J is.
//!
//! The coefficients are held to the order conditions by the tests.

use crate::runtime::solve::control::Pace;
use crate::runtime::solve::jacobian::Jacobian;
use crate::runtime::solve::method::{Flow, Method, Start, Stretch, Trial};
use crate::runtime::solve::segment::Segment;
use crate::runtime::solve::shifted::{Plan, Shifted};

#[cfg(test)]
mod tests;

/// Stages of the method.
const STAGES: usize = 8;
/// Order of the method; the estimated error falls with this power of the step.
const ORDER: f64 = 5.0;
/// The most that a step may be longer than the one before.
const GROW: f64 = 6.0;

/// The diagonal.
const GAMMA: f64 = 0.21193756319429014;

/// Row i: how much of each u is added to the state before stage i. From the sixth stage on each adds the u before it.
const A: [&[f64]; STAGES] = [
    &[],
    &[3.0],
    &[2.849394379747939, 0.45842242204463923],
    &[-6.954028509809101, 2.489845061869568, -10.358996098473584],
    &[2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641],
    &[-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946],
    &[
        -7.502846399306121,
        2.561846144803919,
        -11.627539656261098,
        -0.18268767659942256,
        0.030198172008377946,
        1.0,
    ],
    &[
        -7.502846399306121,
        2.561846144803919,
        -11.627539656261098,
        -0.18268767659942256,
        0.030198172008377946,
        1.0,
        1.0,
    ],
];

/// Row i: how much of each u, over h, is added to the rates of stage i.
const C: [&[f64]; STAGES] = [
    &[],
    &[-14.155112264123755],
    &[-17.97296035885952, -2.859693295451294],
    &[147.12150275711716, -1.41221402718213, 71.68940251302358],
    &[165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306],
    &[24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471],
    &[
        30.91273214028599,
        -3.1208243349937974,
        77.79954646070892,
        34.28646028294783,
        -19.097331116725623,
        -28.087943162872662,
    ],
    &[
        37.80277123390563,
        -3.2571969029072276,
        112.26918849496327,
        66.9347231244047,
        -40.06618937091002,
        -54.66780262877968,
        -9.48861652309627,
    ],
];

/// The times of the stages, as parts of the step.
const TIMES: [f64; STAGES] =
    [0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0];

/// How much of h df/dt is added to the rates of each stage.
const TIME_RATES: [f64; STAGES] = [
    0.21193756319429014,
    -0.42387512638858027,
    -0.3384627126235924,
    1.8046452872882734,
    2.325825639765069,
    0.0,
    0.0,
    0.0,
];

/// How much of each u is in the three terms of the dense output beyond the straight line.
const DENSE: [[f64; STAGES]; 3] = [
    [
        25.948786856663858,
        -2.5579724845846235,
        10.433815404888879,
        -2.3679251022685204,
        0.524948541321073,
        1.1241088310450404,
        0.4272876194431874,
        -0.17202221070155493,
    ],
    [
        -9.91568850695171,
        -0.9689944594115154,
        3.0438037242978453,
        -24.495224566215796,
        20.176138334709044,
        15.98066361424651,
        -6.789040303419874,
        -6.710236069923372,
    ],
    [
        11.419903575922262,
        2.8879645146136994,
        72.92137995996029,
        80.12511834622643,
        -52.072871366152654,
        -59.78993625266729,
        -0.15582684282751913,
        4.883087185713722,
    ],
];

/// The method.
#[derive(Clone, Debug, Default)]
pub struct Rodas5p {
    /// df/dx and df/dt at the begin of the last trial.
    jacobian: Jacobian,
    time_rates: Vec<f64>,
    /// How its linear systems are solved.
    plan: Plan,
    /// 8 rows of n.
    u: Vec<f64>,
    /// The states of the stage at hand.
    stage: Vec<f64>,
    /// Of each equation the coefficients of theta, theta^2, .. of the dense output.
    quartics: Vec<[f64; 4]>,
}

impl Rodas5p {
    /// The Jacobian at the begin of the last trial.
    pub fn jacobian(&self) -> &Jacobian {
        &self.jacobian
    }

    /// Operations of a step for each equation with such a Jacobian, without the right-hand sides: states of the stages 54,
    /// their right-hand sides 66, dense output 51, its end 4, its middle 21, norm of the error 4, and its
    /// share of the linear systems.
    pub fn operations_with(&mut self, jacobian: &Jacobian) -> u64 {
        self.plan.suit(jacobian);
        self.share(jacobian.n)
    }

    fn share(&self, n: usize) -> u64 {
        200 + self.plan.operations(STAGES as u64 + 1) / (n as u64).max(1)
    }
}

impl Rodas5p {
    /// Takes the error of the dense output in the middle of the step for that of the step, where it is larger. Of a very
    /// stiff flow the ends of a step are much better than what lies between, where events are.
    fn look_between(&mut self, start: &Start<'_>, system: &Shifted, flow: &mut dyn Flow, trial: &mut Trial) {
        let &Start { t, h, x, .. } = start;
        let defect = &mut self.time_rates;
        for (i, (stage, x)) in self.stage.iter_mut().zip(x).enumerate() {
            let [c1, c2, c3, c4] = self.quartics[i];
            *stage = x + 0.5 * (c1 + 0.5 * (c2 + 0.5 * (c3 + 0.5 * c4)));
        }
        flow.rates(t + 0.5 * h, &self.stage, defect);
        for (i, defect) in defect.iter_mut().enumerate() {
            let [c1, c2, c3, c4] = self.quartics[i];
            *defect -= (c1 + (c2 + 0.75 * c3 + 0.5 * c4)) / h;
        }
        system.solve(defect);
        for (error, between) in trial.error.iter_mut().zip(defect.iter()) {
            if between.is_nan() || between.abs() > error.abs() {
                *error = *between;
            }
        }
    }
}

impl Method for Rodas5p {
    fn order(&self) -> f64 {
        ORDER
    }

    fn depth(&self) -> usize {
        1
    }

    fn operations(&self, _n_known: usize) -> u64 {
        self.share(self.jacobian.n)
    }

    fn step(&mut self, start: &Start<'_>, flow: &mut dyn Flow, trial: &mut Trial) {
        let &Start { t, h, x, past } = start;
        let n = x.len();
        trial.pace = Pace::Free { order: ORDER, grow: GROW };
        self.u.resize(STAGES * n, 0.0);
        self.stage.resize(n, 0.0);
        self.time_rates.resize(n, 0.0);
        flow.jacobian(t, x, &mut self.jacobian);
        flow.time_rates(t, x, &mut self.time_rates);
        self.plan.suit(&self.jacobian);
        let Some(system) = Shifted::new(&self.jacobian, &self.plan, 1.0 / (h * GAMMA)) else {
            return trial.rates.fill(f64::NAN);
        };
        for s in 0..STAGES {
            let (known, rest) = self.u.split_at_mut(s * n);
            let u = &mut rest[..n];
            if s == 0 {
                u.copy_from_slice(past.rates(0));
            } else {
                for (i, (stage, x)) in self.stage.iter_mut().zip(x).enumerate() {
                    *stage = x + weighted(A[s], known, n, i);
                }
                flow.rates(t + TIMES[s] * h, &self.stage, u);
            }
            for (i, u) in u.iter_mut().enumerate() {
                *u += weighted(C[s], known, n, i) / h + h * TIME_RATES[s] * self.time_rates[i];
            }
            system.solve(u);
        }
        let last = (STAGES - 1) * n;
        self.quartics.clear();
        for (i, &x) in x.iter().enumerate() {
            let moved = weighted(A[STAGES - 1], &self.u, n, i) + self.u[last + i];
            let [k1, k2, k3] = DENSE.map(|row| weighted(&row, &self.u, n, i));
            let quartic = [moved + k1, k2 - k1, k3 - k2, -k3];
            trial.x_new[i] = at_end(x, &quartic);
            trial.error[i] = self.u[last + i];
            self.quartics.push(quartic);
        }
        self.look_between(start, &system, flow, trial);
        flow.rates(t + h, &trial.x_new, &mut trial.rates);
    }

    fn dense(&self, stretch: &Stretch, x: &[f64], first: usize, segment: &mut Segment) {
        let &Stretch { t, h, end } = stretch;
        let coefficients = segment.reset(t, h, end, 5, x.len());
        for (i, c) in coefficients.chunks_exact_mut(5).enumerate() {
            c[0] = x[i];
            c[1..].copy_from_slice(&self.quartics[first + i]);
        }
        segment.own_rates();
    }
}

/// The sum of `weights[s] u_s[i]`, from left to right.
fn weighted(weights: &[f64], u: &[f64], n: usize, i: usize) -> f64 {
    weights.iter().enumerate().fold(0.0, |sum, (s, weight)| sum + weight * u[s * n + i])
}

/// The dense output at theta = 1, in the order of operations in which a segment evaluates it: the new state is where it
/// ends, to the bit.
fn at_end(x: f64, quartic: &[f64; 4]) -> f64 {
    (((quartic[3] + quartic[2]) + quartic[1]) + quartic[0]) + x
}
