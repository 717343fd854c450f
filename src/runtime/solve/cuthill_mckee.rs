//! An order of the equations in which the Jacobian's entries lie near its diagonal: reverse Cuthill-McKee.
//!
//! In: the places of the entries. Equations that read each other are neighbours; from an end of the graph outwards, level by
//! level, each level in the order of the one before and, among the neighbours of one, those with few neighbours first.
//! Chains, rings and strips get a band that is as wide as two levels, however their equations are numbered. E. Cuthill &
//! J. McKee, 1969; George & Liu, 1981, for the begin at an end.

use crate::runtime::solve::jacobian::Jacobian;

/// The equations in the new order.
pub fn order(jacobian: &Jacobian) -> Vec<usize> {
    let neighbours = neighbours(jacobian);
    let mut order = Vec::with_capacity(jacobian.n);
    let mut placed = vec![false; jacobian.n];
    let mut by_degree: Vec<usize> = (0..jacobian.n).collect();
    by_degree.sort_by_key(|&k| neighbours[k].len());
    for begin in by_degree {
        if !placed[begin] {
            let level = levels(&neighbours, begin, &mut placed.clone());
            let end = *level.last().expect("at least where it begins");
            order.extend(levels(&neighbours, end, &mut placed));
        }
    }
    order.reverse();
    order
}

/// How far below and above the diagonal entries lie in an order.
pub fn widths(jacobian: &Jacobian, order: &[usize]) -> (usize, usize) {
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
    let (mut below, mut above) = (0, 0);
    for entry in &jacobian.entries {
        let (row, column) = (place[entry.row], place[entry.column]);
        below = below.max(row.saturating_sub(column));
        above = above.max(column.saturating_sub(row));
    }
    (below, above)
}

/// For each equation those that it reads or that read it, those with few neighbours first.
fn neighbours(jacobian: &Jacobian) -> Vec<Vec<usize>> {
    let mut neighbours = vec![Vec::new(); jacobian.n];
    for entry in jacobian.entries.iter().filter(|entry| entry.row != entry.column) {
        neighbours[entry.row].push(entry.column);
        neighbours[entry.column].push(entry.row);
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    let degrees: Vec<usize> = neighbours.iter().map(Vec::len).collect();
    neighbours.iter_mut().for_each(|list| list.sort_by_key(|&k| degrees[k]));
    neighbours
}

/// All that can be reached from `begin`, level by level.
fn levels(neighbours: &[Vec<usize>], begin: usize, placed: &mut [bool]) -> Vec<usize> {
    let mut reached = vec![begin];
    placed[begin] = true;
    let mut next = 0;
    while let Some(&here) = reached.get(next) {
        for &neighbour in &neighbours[here] {
            if !std::mem::replace(&mut placed[neighbour], true) {
                reached.push(neighbour);
            }
        }
        next += 1;
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equations that read each other, numbered anew by `k -> 7 k mod n` so that no order is left.
    fn scattered(n: usize, pairs: impl IntoIterator<Item = (usize, usize)>) -> Jacobian {
        let mut jacobian = Jacobian::default();
        jacobian.reset(n);
        for (a, b) in pairs {
            let (a, b) = (7 * a % n, 7 * b % n);
            jacobian.push(a, b, 1.0);
            jacobian.push(b, a, 1.0);
            jacobian.push(a, a, 1.0);
        }
        jacobian
    }

    #[test]
    fn a_chain_becomes_tridiagonal() {
        let jacobian = scattered(100, (0..99).map(|k| (k, k + 1)));
        let order = order(&jacobian);
        assert_eq!(widths(&jacobian, &order), (1, 1));
        let mut sorted = order;
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..100));
    }

    #[test]
    fn a_ring_has_twice_the_band() {
        let jacobian = scattered(100, (0..100).map(|k| (k, (k + 1) % 100)));
        assert_eq!(widths(&jacobian, &order(&jacobian)), (2, 2));
    }

    #[test]
    fn parts_that_do_not_meet_are_ordered_one_by_one() {
        let jacobian = scattered(40, (0..10).flat_map(|k| [(4 * k, 4 * k + 1), (4 * k + 1, 4 * k + 2)]));
        assert_eq!(widths(&jacobian, &order(&jacobian)), (1, 1));
    }

    #[test]
    fn where_all_read_all_there_is_no_band() {
        let jacobian = scattered(5, (0..5).flat_map(|a| (0..a).map(move |b| (a, b))));
        assert_eq!(widths(&jacobian, &order(&jacobian)), (4, 4));
    }
}
