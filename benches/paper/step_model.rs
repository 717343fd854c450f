//! Section 7.2 of the paper, figures 7 and 8: the least of N steps that are uniform on [h_min, h_max].

use crate::figure::{Style, figure, panel, series};
use crate::fit;
use crate::report::Report;

/// In units of h_max; h_min = 0.01 h_max.
const H_MIN: f64 = 0.01;
/// Draws of the least step for each N.
const DRAWS: usize = 20_000;

/// Numbers in [0, 1), the same in every run.
struct Dice(u64);

impl Dice {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// (32)
    fn least(&mut self, n: usize) -> f64 {
        let least = (0..n).map(|_| self.uniform()).fold(1.0, f64::min);
        H_MIN + (1.0 - H_MIN) * least
    }
}

/// E[min of N uniform steps]: h_min + (h_max - h_min)/(N + 1).
fn exact(n: f64) -> f64 {
    H_MIN + (1.0 - H_MIN) / (n + 1.0)
}

/// Draws, fits, compares.
pub fn figures(report: &mut Report) {
    let mut dice = Dice(1);
    let ns: Vec<usize> = (1..=20).chain([25, 30, 40, 50, 70, 100, 150, 200, 300, 500, 700, 1000]).collect();
    let drawn: Vec<(f64, f64)> = ns
        .iter()
        .map(|&n| (n as f64, (0..DRAWS).map(|_| dice.least(n)).sum::<f64>() / DRAWS as f64))
        .collect();
    let to_20: Vec<(f64, f64)> = drawn.iter().copied().filter(|p| p.0 <= 20.0).collect();
    let fitted = fit::exponential(&to_20);
    let all = fit::exponential(&drawn);
    let curve =
        |of: &dyn Fn(f64) -> f64, to: usize| (1..=to).map(|n| (n as f64, of(n as f64))).collect::<Vec<_>>();
    let panels = [20, 1000].map(|to| {
        let points = drawn.iter().copied().filter(|p| p.0 <= to as f64).collect();
        panel(
            &format!("E[h_SA]/h_max, N up to {to}"),
            "N",
            "E[h_SA]/h_max",
            vec![
                series("drawn (32)", Style::Dots, points),
                series("exact, 1/(N+1)", Style::Line, curve(&exact, to)),
                series("(33), fitted to N <= 20", Style::Dashes, curve(&|n| fitted.at(n), to)),
            ],
        )
    });
    figure("figure_7", &panels);
    let histograms = [1, 2, 5, 20, 100].map(|n| {
        let mut bins = [0.0; 40];
        for _ in 0..10 * DRAWS {
            let share = (dice.least(n) - H_MIN) / (1.0 - H_MIN);
            bins[(share * 40.0).min(39.0) as usize] += 1.0;
        }
        let top = bins.iter().copied().fold(0.0, f64::max);
        let points = bins
            .iter()
            .enumerate()
            .map(|(k, bin)| (H_MIN + (1.0 - H_MIN) * (k as f64 + 0.5) / 40.0, bin / top))
            .collect();
        series(format!("N = {n}"), Style::Line, points)
    });
    figure(
        "figure_8",
        &[panel("Histogram of h_SA", "h_SA/h_max", "frequency, of the largest", histograms.into())],
    );
    let mut text = String::from(
        "| N | drawn | exact | (33) fitted to N <= 20 | (33) fitted to N <= 1000 |\n|---:|---:|---:|---:|---:|\n",
    );
    for &(n, mean) in drawn.iter().filter(|p| [1.0, 2.0, 5.0, 10.0, 20.0, 100.0, 1000.0].contains(&p.0)) {
        text += &format!("| {n} | {mean:.4} | {:.4} | {:.4} | {:.4} |\n", exact(n), fitted.at(n), all.at(n));
    }
    text += &format!("\nR² of (33): {:.4} over N <= 20, {:.4} over N <= 1000.\n", fitted.r2, all.r2);
    report.table("step_model", &text);
}
