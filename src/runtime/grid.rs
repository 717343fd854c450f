//! A grid of boxes: finds all pairs that overlap without looking at all pairs.
//!
//! Every box lies in all cells that it overlaps, cells being about as wide as boxes are. Two that overlap are found
//! once, in the cell of the lower corner of what they have in common. Cells share buckets by their lowest bits; boxes that
//! change afterwards are entered beside these. A box too large for the cells is compared with those that overlap it in the
//! dimension in which these are fewest.

use std::cell::OnceCell;
use std::ops::ControlFlow;

use rustc_hash::FxHashMap;

use crate::math::Interval;

/// How many dimensions have cells; boxes of more are compared in all of them.
const DIMENSIONS: usize = 3;
/// A box that overlaps more cells in one dimension is too large.
const CELLS_MAX: f64 = 4.0;
/// Cells are numbered from minus this to this in each dimension, and again from there.
const CELL_NUMBERS: i64 = 1 << 20;

/// The cell of a place; cells far apart may share a number.
type Cell = u64;

/// Boxes of one number of dimensions, in cells.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    n: usize,
    /// `n` intervals for each box.
    boxes: Vec<Interval>,
    /// One over the width of a cell.
    scale: [f64; DIMENSIONS],
    /// Cells with boxes, by bucket.
    entries: Vec<(Cell, u32)>,
    /// Where each bucket begins in `entries`, and where the last ends.
    starts: Vec<u32>,
    /// Where those of boxes that changed lie now.
    moved: FxHashMap<Cell, Vec<u32>>,
    /// Boxes that are too large, rising.
    large: Vec<u32>,
    /// Of boxes that changed those that are too large now.
    moved_large: Vec<u32>,
    /// The other boxes, and those that are too large, in order; made when first asked for.
    orders: OnceCell<[Orders; 2]>,
}

/// Some boxes in the order of their lower ends, in each dimension; whoever changed since is where it was.
#[derive(Clone, Debug, Default)]
struct Orders(Vec<Order>);

/// The same in one dimension.
#[derive(Clone, Debug, Default)]
struct Order {
    /// Lower end, number; rising.
    boxes: Vec<(f64, u32)>,
    /// The greatest width.
    width: f64,
}

impl Orders {
    fn new(grid: &Grid, numbers: &[u32]) -> Self {
        let in_dimension = |dimension: usize| {
            let bound = |number: u32| grid.get(number)[dimension];
            let lower = numbers.iter().map(|&number| (bound(number).lo, number));
            let mut boxes: Vec<(f64, u32)> = lower.filter(|(lo, _)| *lo < f64::INFINITY).collect();
            boxes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let widths = boxes.iter().map(|&(_, number)| bound(number).width());
            let width = widths.fold(0.0, f64::max);
            Order { boxes, width }
        };
        Self((0..grid.n).map(in_dimension).collect())
    }

    /// All that may overlap a box: those that do in the dimension in which these are fewest.
    fn near(&self, bounds: &[Interval]) -> impl Iterator<Item = u32> {
        let near = bounds.iter().zip(&self.0).map(|(bound, Order { boxes, width })| {
            let first = boxes.partition_point(|&(lo, _)| lo + width < bound.lo);
            let last = boxes.partition_point(|&(lo, _)| lo <= bound.hi);
            &boxes[first.min(last)..last]
        });
        near.min_by_key(|near| near.len()).unwrap_or(&[]).iter().map(|&(_, number)| number)
    }
}

impl Grid {
    /// A grid of these boxes, `n` intervals each.
    pub fn new(n: usize, boxes: Vec<Interval>) -> Self {
        let mut grid = Self::default();
        grid.renew(n, boxes);
        grid
    }

    /// The boxes, emptied, to be filled again for [`Grid::renew`].
    pub fn take_boxes(&mut self) -> Vec<Interval> {
        let mut boxes = std::mem::take(&mut self.boxes);
        boxes.clear();
        boxes
    }

    /// The same as a new grid of these boxes, in the memory of this one.
    pub fn renew(&mut self, n: usize, boxes: Vec<Interval>) {
        (self.n, self.boxes, self.orders) = (n, boxes, OnceCell::new());
        self.large.clear();
        self.moved.clear();
        self.moved_large.clear();
        let n_boxes = self.len();
        for dimension in 0..n.min(DIMENSIONS) {
            let widths = (0..n_boxes).map(|k| self.boxes[k * n + dimension].width());
            let (sum, count) = widths
                .filter(|width| width.is_finite())
                .fold((0.0, 0_usize), |(sum, count), width| (sum + width, count + 1));
            self.scale[dimension] = if sum > 0.0 { count as f64 / (2.0 * sum) } else { 1.0 };
        }
        self.fill();
    }

    /// Enters all boxes into the buckets of their cells, those that are too large into their list.
    fn fill(&mut self) {
        let (mut starts, mut entries) = (std::mem::take(&mut self.starts), std::mem::take(&mut self.entries));
        let mut large = std::mem::take(&mut self.large);
        starts.clear();
        starts.resize((2 * self.len()).next_power_of_two() + 1, 0);
        let n_buckets = starts.len() - 1;
        for number in 0..self.len() as u32 {
            let count = &mut |cell| starts[bucket(cell, n_buckets)] += 1;
            if !self.for_each_cell(self.get(number), count) {
                large.push(number);
            }
        }
        // First where each bucket ends; where it begins, when it has been filled from its end on.
        let mut end = 0;
        for start in &mut starts {
            end += *start;
            *start = end;
        }
        entries.clear();
        entries.resize(end as usize, (0, 0));
        for number in (0..self.len() as u32).rev() {
            self.for_each_cell(self.get(number), &mut |cell| {
                let place = &mut starts[bucket(cell, n_buckets)];
                *place -= 1;
                entries[*place as usize] = (cell, number);
            });
        }
        (self.starts, self.entries, self.large) = (starts, entries, large);
    }

    /// All boxes in the bucket of a cell.
    fn here(&self, cell: Cell) -> &[(Cell, u32)] {
        match self.starts.len() {
            0 => &[],
            _ => {
                let bucket = bucket(cell, self.starts.len() - 1);
                &self.entries[self.starts[bucket] as usize..self.starts[bucket + 1] as usize]
            }
        }
    }

    /// How many boxes there are.
    pub fn len(&self) -> usize {
        self.boxes.len().checked_div(self.n).unwrap_or(0)
    }

    /// A box.
    pub fn get(&self, number: u32) -> &[Interval] {
        &self.boxes[number as usize * self.n..][..self.n]
    }

    /// Calls `visit` for every two boxes that overlap, once, the lower number first, until it breaks off.
    pub fn for_each_pair(&self, visit: &mut dyn FnMut(u32, u32) -> ControlFlow<()>) -> ControlFlow<()> {
        debug_assert!(self.moved.is_empty(), "pairs are listed of a new grid");
        for bucket in self.starts.windows(2) {
            let bucket = &self.entries[bucket[0] as usize..bucket[1] as usize];
            for (k, &(cell, a)) in bucket.iter().enumerate() {
                for &(_, b) in bucket[k + 1..].iter().filter(|entry| entry.0 == cell) {
                    if self.overlap(a, b) && self.corner(a, b) == cell {
                        visit(a.min(b), a.max(b))?;
                    }
                }
            }
        }
        for &a in &self.large {
            let [small, large] = self.orders();
            let bounds = self.get(a);
            for b in small.near(bounds).chain(large.near(bounds).filter(|&b| a < b)) {
                if self.overlap(a, b) {
                    visit(a.min(b), a.max(b))?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Changes a box.
    pub fn change(&mut self, number: u32, bounds: &[Interval]) {
        self.boxes[number as usize * self.n..][..self.n].copy_from_slice(bounds);
        let mut moved = std::mem::take(&mut self.moved);
        let is_small = self.for_each_cell(bounds, &mut |cell| {
            let moved = moved.entry(cell).or_default();
            if !moved.contains(&number) {
                moved.push(number);
            }
        });
        self.moved = moved;
        if !is_small && !self.moved_large.contains(&number) {
            self.moved_large.push(number);
        }
    }

    /// All other boxes that overlap one, rising.
    pub fn around(&self, number: u32) -> Vec<u32> {
        let mut found = self.touching(self.get(number));
        found.retain(|&other| other != number);
        found
    }

    /// All boxes that overlap one that need not be among them, rising.
    pub fn touching(&self, bounds: &[Interval]) -> Vec<u32> {
        let overlaps = |&other: &u32| overlap(bounds, self.get(other));
        let mut found: Vec<u32> = self.moved_large.iter().copied().filter(overlaps).collect();
        if !self.large.is_empty() {
            found.extend(self.orders()[1].near(bounds).filter(overlaps));
        }
        let is_small = self.for_each_cell(bounds, &mut |cell| {
            let here = self.here(cell).iter().filter(|entry| entry.0 == cell).map(|entry| entry.1);
            found.extend(here.filter(overlaps));
            found.extend(self.moved.get(&cell).into_iter().flatten().copied().filter(overlaps));
        });
        if !is_small {
            found.extend(self.orders()[0].near(bounds).filter(overlaps));
            found.extend(self.moved.values().flatten().copied().filter(overlaps));
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    fn orders(&self) -> &[Orders; 2] {
        self.orders.get_or_init(|| {
            let is_small = |number: &u32| self.large.binary_search(number).is_err();
            let small: Vec<u32> = (0..self.len() as u32).filter(is_small).collect();
            [Orders::new(self, &small), Orders::new(self, &self.large)]
        })
    }

    /// How wide cells are in one dimension; as wide as a box if that has none.
    pub fn cell_width(&self, dimension: usize) -> f64 {
        self.scale.get(dimension).map_or(1.0, |scale| 1.0 / scale)
    }

    fn overlap(&self, a: u32, b: u32) -> bool {
        overlap(self.get(a), self.get(b))
    }

    /// The cell of the lower corner of what two boxes that overlap have in common.
    fn corner(&self, a: u32, b: u32) -> Cell {
        let (a, b) = (self.get(a), self.get(b));
        let place = |dimension: usize| self.place(dimension, a[dimension].lo.max(b[dimension].lo));
        (0..self.n.min(DIMENSIONS)).fold(0, |cell, dimension| join(cell, place(dimension)))
    }

    /// The number of the cell in which x lies, in one dimension.
    fn place(&self, dimension: usize, x: f64) -> i64 {
        (x * self.scale[dimension]).floor() as i64
    }

    /// Calls `visit` for every cell that a box overlaps, once; false, and it does not, if there are too many. A box of nobody
    /// overlaps none.
    fn for_each_cell(&self, bounds: &[Interval], visit: &mut dyn FnMut(Cell)) -> bool {
        let dimensions = self.n.min(DIMENSIONS);
        let (mut first, mut last) = ([0; DIMENSIONS], [0; DIMENSIONS]);
        for dimension in 0..dimensions {
            let bound = bounds[dimension];
            let is_narrow = bound.width() * self.scale[dimension] < CELLS_MAX;
            if !is_narrow {
                return false;
            }
            (first[dimension], last[dimension]) =
                (self.place(dimension, bound.lo), self.place(dimension, bound.hi));
            if first[dimension] > last[dimension] {
                return true;
            }
        }
        let mut place = first;
        loop {
            visit(place[..dimensions].iter().fold(0, |cell, &place| join(cell, place)));
            let Some(next) = (0..dimensions).rev().find(|&dimension| place[dimension] < last[dimension])
            else {
                return true;
            };
            place[next] += 1;
            place[next + 1..dimensions].copy_from_slice(&first[next + 1..dimensions]);
        }
    }
}

/// The bucket of a cell, of a number that is a power of two: those of neighbours are near.
fn bucket(cell: Cell, n_buckets: usize) -> usize {
    let mixed = cell ^ (cell >> 21).wrapping_mul(0x9E37_79B9) ^ (cell >> 42).wrapping_mul(0x85EB_CA6B);
    mixed as usize & (n_buckets - 1)
}

/// An empty box overlaps nothing, not even one without end.
fn overlap(a: &[Interval], b: &[Interval]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.lo.max(b.lo) <= a.hi.min(b.hi))
}

/// A cell's number with one more dimension.
fn join(cell: Cell, place: i64) -> Cell {
    (cell << 21) | (place.rem_euclid(2 * CELL_NUMBERS) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dice() -> impl FnMut() -> f64 {
        let mut state: u64 = 0x9E37_79B9_7F4A_7C15;
        move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    fn meet(a: &[Interval], b: &[Interval]) -> bool {
        let is_empty = |bounds: &[Interval]| bounds.iter().any(|bound| bound.lo > bound.hi);
        !is_empty(a) && !is_empty(b) && a.iter().zip(b).all(|(a, b)| a.lo <= b.hi && b.lo <= a.hi)
    }

    /// Boxes of very different sizes, some without end, some empty.
    fn some(n: usize, dimensions: usize, die: &mut dyn FnMut() -> f64) -> Vec<Interval> {
        (0..n * dimensions)
            .map(|_| {
                let (place, size) = (100.0 * (die() - 0.5), 10.0_f64.powf(4.0 * die() - 2.5));
                let bound = Interval { lo: place, hi: place + size };
                match die() {
                    rare if rare < 0.01 => Interval::WHOLE,
                    rare if rare < 0.02 => Interval { lo: f64::INFINITY, hi: f64::NEG_INFINITY },
                    _ => bound,
                }
            })
            .collect()
    }

    #[test]
    fn the_pairs_are_those_of_all_pairs_each_once() {
        let mut die = dice();
        for dimensions in 1..=4 {
            let boxes = some(300, dimensions, &mut die);
            let grid = Grid::new(dimensions, boxes);
            let mut found = Vec::new();
            let whole = grid.for_each_pair(&mut |a, b| {
                found.push((a, b));
                ControlFlow::Continue(())
            });
            assert!(whole.is_continue());
            found.sort_unstable();
            let mut expected = Vec::new();
            for a in 0..300 {
                expected.extend((a + 1..300).filter(|&b| meet(grid.get(a), grid.get(b))).map(|b| (a, b)));
            }
            assert!(!expected.is_empty());
            assert_eq!(found, expected, "{dimensions} dimensions");
        }
    }

    #[test]
    fn a_changed_box_finds_and_is_found() {
        let mut die = dice();
        for dimensions in 1..=4 {
            let mut grid = Grid::new(dimensions, some(200, dimensions, &mut die));
            for round in 0..200 {
                let number = (die() * 200.0) as u32;
                let bounds = some(1, dimensions, &mut die);
                grid.change(number, &bounds);
                for asked in [number, (die() * 200.0) as u32] {
                    let expected: Vec<u32> =
                        (0..200).filter(|&b| b != asked && meet(grid.get(asked), grid.get(b))).collect();
                    assert_eq!(grid.around(asked), expected, "{dimensions} dimensions, round {round}");
                }
            }
        }
    }
}
