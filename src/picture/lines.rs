//! Lines of a plot: where they have gaps, and which of very many points can be seen.

/// Two points of a line that are nearer than this to each other, or to the straight line between two others, are not told apart; in points
/// of the picture.
const SEEN: f64 = 0.4;

/// How many points of the picture a unit is long, across and up; none: all points of the lines are kept.
pub(super) type Resolution = Option<[f64; 2]>;

/// Stretches of a line without gaps; of very many points those that can be seen.
pub(super) fn stretches(across: &[f64], up: &[f64], resolution: Resolution) -> Vec<Vec<(f64, f64)>> {
    let mut stretches: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    for (&x, &y) in across.iter().zip(up) {
        match stretches.last_mut() {
            Some(stretch) if x.is_finite() && y.is_finite() => stretch.push((x, y)),
            Some(_) | None => stretches.push(Vec::new()),
        }
    }
    stretches.retain(|stretch| !stretch.is_empty());
    match resolution {
        Some(resolution) => stretches.iter().map(|stretch| seen(stretch, resolution)).collect(),
        None => stretches,
    }
}

/// The points without which the line would look different (Ramer, Douglas and Peucker, 1972 and 1973).
fn seen(stretch: &[(f64, f64)], [wide, high]: [f64; 2]) -> Vec<(f64, f64)> {
    let mut kept = vec![false; stretch.len()];
    let last = stretch.len() - 1;
    (kept[0], kept[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let (x0, y0) = stretch[from];
        let [dx, dy] = [(stretch[to].0 - x0) * wide, (stretch[to].1 - y0) * high];
        let length = dx * dx + dy * dy;
        let distance = |k: usize| {
            let [px, py] = [(stretch[k].0 - x0) * wide, (stretch[k].1 - y0) * high];
            let share = if length > 0.0 { ((px * dx + py * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
            (px - share * dx).hypot(py - share * dy)
        };
        let farthest = (from + 1..to).map(|k| (distance(k), k)).max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((distance, k)) = farthest
            && distance > SEEN
        {
            kept[k] = true;
            open.extend([(from, k), (k, to)]);
        }
    }
    stretch.iter().zip(kept).filter_map(|(&point, kept)| kept.then_some(point)).collect()
}
