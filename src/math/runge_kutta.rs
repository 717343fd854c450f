//! Coefficients of explicit Runge-Kutta pairs.
//!
//! A step of length `h` from `(t, x)`, component by component, in this order of operations (compiled steps and the
//! plain ones give the same bits because both keep to it):
//!
//! ```text
//! k_1   = f(t, x)
//! x_s   = x + h ((a_s1 k_1 + a_s2 k_2) + a_s3 k_3 + ...)    from left to right, coefficients that are 0 left out
//! k_s   = f(t + c_s h, x_s)
//! x_new = x_7                                               the last stage is the first of the next step
//! err   = h ((e_1 k_1 + e_2 k_2) + ...)
//! x(t + theta h) = x + h sum over i of b_i(theta) k_i
//! ```

/// An explicit Runge-Kutta pair of `S` stages whose last stage is the next step's first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tableau<const S: usize> {
    /// Where in the step each stage stands, as a fraction of it.
    pub c: [f64; S],
    /// Row `s` makes stage `s`; its last row holds the weights of the result.
    pub a: [[f64; S]; S],
    /// The weights of the result less those of the embedded method of lower order.
    pub error: [f64; S],
    /// `b_i(theta)` is the sum over `p` of `dense[i][p] theta^(p + 1)`.
    pub dense: [[f64; 4]; S],
}

impl<const S: usize> Tableau<S> {
    /// The weights of the result: stage `S` is made with them.
    pub fn b(&self) -> &[f64; S] {
        &self.a[S - 1]
    }

    /// The weights `b_i(theta)` of the dense output.
    pub fn weights(&self, theta: f64) -> [f64; S] {
        self.dense.map(|[p1, p2, p3, p4]| theta * (p1 + theta * (p2 + theta * (p3 + theta * p4))))
    }
}

/// Tsitouras' pair of orders 5 and 4, with dense output of order 4 that is continuous with its rate.
///
/// Ch. Tsitouras, Runge-Kutta pairs of order 5(4) satisfying only the first column simplifying assumption,
/// Computers & Mathematics with Applications 62 (2011) 770-775.
pub const TSIT5: Tableau<7> = Tableau {
    c: [0.0, 0.161, 0.327, 0.9, 0.9800255409045097, 1.0, 1.0],
    a: [
        [0.0; 7],
        [0.161, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [-0.008480655492356989, 0.335480655492357, 0.0, 0.0, 0.0, 0.0, 0.0],
        [2.8971530571054935, -6.359448489975075, 4.3622954328695815, 0.0, 0.0, 0.0, 0.0],
        [5.325864828439257, -11.748883564062828, 7.4955393428898365, -0.09249506636175525, 0.0, 0.0, 0.0],
        [
            5.86145544294642,
            -12.92096931784711,
            8.159367898576159,
            -0.071584973281401,
            -0.028269050394068383,
            0.0,
            0.0,
        ],
        [
            0.09646076681806523,
            0.01,
            0.4798896504144996,
            1.379008574103742,
            -3.290069515436081,
            2.324710524099774,
            0.0,
        ],
    ],
    error: [
        -0.001780011052225777,
        -0.0008164344596567469,
        0.007880878010261995,
        -0.1447110071732629,
        0.5823571654525552,
        -0.45808210592918697,
        0.015151515151515152,
    ],
    dense: [
        [1.0, -2.763706197274826, 2.9132554618219126, -1.0530884977290216],
        [0.0, 0.13169999999999998, -0.2234, 0.1017],
        [0.0, 3.9302962368947516, -5.941033872131505, 2.490627285651253],
        [0.0, -12.411077166933676, 30.33818863028232, -16.548102889244902],
        [0.0, 37.50931341651104, -88.1789048947664, 47.37952196281928],
        [0.0, -27.896526289197286, 65.09189467479366, -34.87065786149661],
        [0.0, 1.5, -4.0, 2.5],
    ],
};

#[cfg(test)]
mod tests {
    use super::*;

    /// Sum over j of `a_ij v_j`.
    fn through(v: [f64; 7]) -> [f64; 7] {
        TSIT5.a.map(|row| dot(row, v))
    }

    fn times(u: [f64; 7], v: [f64; 7]) -> [f64; 7] {
        std::array::from_fn(|i| u[i] * v[i])
    }

    fn dot(u: [f64; 7], v: [f64; 7]) -> f64 {
        times(u, v).iter().sum()
    }

    /// For each rooted tree of at most 5 nodes: its order, its elementary weight at each stage, its density.
    fn trees() -> Vec<(i32, [f64; 7], f64)> {
        let c = TSIT5.c;
        let (c2, ac) = (times(c, c), through(c));
        vec![
            (1, [1.0; 7], 1.0),
            (2, c, 2.0),
            (3, c2, 3.0),
            (3, ac, 6.0),
            (4, times(c, c2), 4.0),
            (4, times(c, ac), 8.0),
            (4, through(c2), 12.0),
            (4, through(ac), 24.0),
            (5, times(c2, c2), 5.0),
            (5, times(c2, ac), 10.0),
            (5, times(c, through(c2)), 15.0),
            (5, times(c, through(ac)), 30.0),
            (5, times(ac, ac), 20.0),
            (5, through(times(c, c2)), 20.0),
            (5, through(times(c, ac)), 40.0),
            (5, through(through(c2)), 60.0),
            (5, through(through(ac)), 120.0),
        ]
    }

    #[test]
    fn stages_stand_where_their_rows_sum_to() {
        for (c, sum) in TSIT5.c.iter().zip(through([1.0; 7])) {
            assert!((c - sum).abs() < 1e-14, "{c} {sum}");
        }
    }

    #[test]
    fn the_result_has_order_five_and_the_embedded_one_exactly_four() {
        let embedded: [f64; 7] = std::array::from_fn(|i| TSIT5.b()[i] - TSIT5.error[i]);
        let mut defect: f64 = 0.0;
        for (order, weight, density) in trees() {
            assert!(
                (dot(*TSIT5.b(), weight) - 1.0 / density).abs() < 1e-14,
                "order {order}, density {density}"
            );
            let miss = (dot(embedded, weight) - 1.0 / density).abs();
            assert!(order == 5 || miss < 1e-14, "embedded, order {order}, density {density}");
            defect = defect.max(miss);
        }
        assert!(defect > 1e-4);
    }

    #[test]
    fn the_dense_output_has_order_four_everywhere() {
        for step in 0..=20 {
            let theta = f64::from(step) / 20.0;
            for (order, weight, density) in trees().into_iter().filter(|tree| tree.0 <= 4) {
                let got = dot(TSIT5.weights(theta), weight);
                assert!((got - theta.powi(order) / density).abs() < 2e-14, "theta {theta}, order {order}");
            }
        }
    }

    #[test]
    fn the_dense_output_meets_value_and_rate_at_both_ends() {
        let start = TSIT5.weights(0.0);
        let end = TSIT5.weights(1.0);
        for i in 0..7 {
            let [p1, p2, p3, p4] = TSIT5.dense[i];
            assert_eq!(start[i], 0.0);
            assert!((end[i] - TSIT5.b()[i]).abs() < 2e-14, "value at the end, stage {i}");
            assert_eq!(p1, if i == 0 { 1.0 } else { 0.0 }, "rate at the start, stage {i}");
            let rate = p1 + 2.0 * p2 + 3.0 * p3 + 4.0 * p4;
            assert!(
                (rate - if i == 6 { 1.0 } else { 0.0 }).abs() < 1e-13,
                "rate at the end, stage {i}: {rate}"
            );
        }
    }
}
