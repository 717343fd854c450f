//! A comparison along the trajectories of the agents it reads: the curve on which roots are searched.

use std::sync::atomic::{AtomicBool, Ordering};

use smallvec::{SmallVec, smallvec};

use crate::codegen::kernel::{AgentBox, AgentView};
use crate::codegen::program::{Atom, FunctionId};
use crate::math::Interval;
use crate::runtime::flow_rates::{flow_rates_at, flow_rates_over};
use crate::runtime::fold::{self, Folded};
use crate::runtime::population::{ABSENT, Agents, Slots};
use crate::runtime::present::{Boxes, Depth, Views};
use crate::runtime::solve::roots::{AT_TURN, Curve};
use crate::runtime::solve::segment::Segment;

/// Scratch rows for evaluating along segments; three rows (x, x', x'') for each slot.
#[derive(Clone, Debug, Default)]
pub struct CurveRows {
    numbers: Vec<f64>,
    boxes: Vec<Interval>,
    registers: Vec<Interval>,
    absent: Vec<f64>,
    absent_box: Vec<Interval>,
    /// Evaluations at a point.
    pub evaluations: u64,
    /// Evaluations over an interval.
    pub ranges: u64,
    /// Arithmetic operations of both.
    pub operations: u64,
}

impl CurveRows {
    /// Room for the widest agent type.
    pub fn new(agents: &Agents<'_>) -> Self {
        let width = agents.row_width();
        Self { absent: vec![f64::NAN; width], absent_box: vec![Interval::WHOLE; width], ..Self::default() }
    }
}

/// An atom with its agents.
pub struct AtomCurve<'a, 'p> {
    agents: &'a Agents<'p>,
    atom: &'a Atom,
    slots: &'a Slots,
    folds: &'a [Folded<'a>],
    /// The agents that are read, if there are aggregates; rising.
    involved: Vec<usize>,
    /// The auxiliary columns of self with locks after them, where the comparison reads its branches from locks.
    own: Option<&'a [f64]>,
    /// Ends a search.
    interrupt: Option<&'a AtomicBool>,
    rows: &'a mut CurveRows,
    width: usize,
    /// Whether the source reads rates (`x'`): they are those of the flow.
    by_flow: bool,
}

impl<'a, 'p> AtomCurve<'a, 'p> {
    /// The curve of an atom over the last segments of the agents in its slots and of the members of its aggregates.
    pub fn new(
        agents: &'a Agents<'p>,
        atom: &'a Atom,
        slots: &'a Slots,
        folds: &'a [Folded<'a>],
        rows: &'a mut CurveRows,
    ) -> Self {
        let involved = if folds.is_empty() { Vec::new() } else { fold::involved(slots, folds) };
        let read = atom.slots.iter().map(|&slot| slots[slot]).chain(involved.iter().copied());
        let width = read.map(|agent| n_states(agents, agent)).max().unwrap_or(0);
        let total = 3 * width * slots.len().max(involved.len());
        if rows.numbers.len() < total {
            rows.numbers.resize(total, 0.0);
            rows.boxes.resize(total, Interval::WHOLE);
        }
        let by_flow = fold::depth(agents.program, agents.program.kernel(atom.value), folds) != Depth::States;
        Self { agents, atom, slots, folds, involved, own: None, interrupt: None, rows, width, by_flow }
    }

    /// The same with these auxiliary columns of self.
    pub fn with_own(self, own: &'a [f64]) -> Self {
        Self { own: Some(own), ..self }
    }

    /// The same, given up when this is set.
    pub fn with_interrupt(self, interrupt: &'a AtomicBool) -> Self {
        Self { interrupt: Some(interrupt), ..self }
    }

    /// The jet of an atom with aggregates.
    fn folded_jet(&mut self, t: f64) -> [f64; 3] {
        let (agents, width) = (self.agents, self.width);
        for (k, &agent) in self.involved.iter().enumerate() {
            let (x, rest) = self.rows.numbers[3 * width * k..3 * width * (k + 1)].split_at_mut(width);
            let (dx, ddx) = rest.split_at_mut(width);
            agents.agents[agent].segment.jet(t, x, dx, ddx);
        }
        self.put_flow_rates(t);
        let row = |agent: usize| {
            let Ok(k) = self.involved.binary_search(&agent) else {
                return AgentView::absent(&self.rows.absent);
            };
            let [states, rates, accelerations] = rows_of(&self.rows.numbers, width, k);
            AgentView { states, rates, accelerations, aux: &agents.agents[agent].aux }
        };
        let leaves = fold::leaves(agents.program, self.folds, Depth::Accelerations, t, &row);
        let mut out = [0.0; 3];
        let kernel = agents.program.kernel(self.atom.rates);
        let mut views = fold::views(self.slots, &leaves, &row);
        if let Some(own) = self.own {
            views[0].aux = own;
        }
        kernel.eval(&views, t, &mut out);
        out
    }

    /// Bounds of the jet of an atom with aggregates.
    fn folded_range(&mut self, time: Interval) -> [Interval; 3] {
        let agents = self.agents;
        for (k, &agent) in self.involved.iter().enumerate() {
            let segment = &agents.agents[agent].segment;
            for state in 0..agents.agents[agent].states.len() {
                let jet = segment.jet_range(state, time.lo, time.hi);
                put(&mut self.rows.boxes, self.width, (k, state), jet);
            }
        }
        let mut out = [Interval::WHOLE; 3];
        let of_flow = self.flow_ranges(time);
        self.put_flow(&of_flow, Interval::hull);
        self.fold_rows(self.atom.rates, Depth::Accelerations, time, &mut out);
        if self.by_flow {
            self.put_flow(&of_flow, |_, of_flow| of_flow);
            self.fold_rows(self.atom.value, Depth::States, time, &mut out);
        }
        out
    }

    /// A function with aggregates over the rows of those involved.
    fn fold_rows(&mut self, function: FunctionId, depth: Depth, time: Interval, out: &mut [Interval]) {
        let (agents, width) = (self.agents, self.width);
        let CurveRows { boxes, registers, absent, absent_box, .. } = &mut *self.rows;
        let row = |agent: usize| {
            let Ok(k) = self.involved.binary_search(&agent) else {
                return AgentBox::absent(absent_box, absent);
            };
            let [states, rates, accelerations] = rows_of(boxes, width, k);
            AgentBox { states, rates, accelerations, aux: &agents.agents[agent].aux }
        };
        let leaves = fold::leaf_ranges(agents.program, self.folds, depth, time, registers, &row);
        let kernel = agents.program.kernel(function);
        let mut boxes = fold::boxes(self.slots, &leaves, &row);
        if let Some(own) = self.own {
            boxes[0].aux = own;
        }
        kernel.range(&boxes, time, registers, out);
    }
}

/// The rows of a place: states, rates, second rates.
fn rows_of<T>(rows: &[T], width: usize, place: usize) -> [&[T]; 3] {
    [0, 1, 2].map(|row| &rows[(3 * place + row) * width..][..width])
}

/// Puts a state, its rate and its second rate into the rows of a slot.
fn put<T: Copy>(rows: &mut [T], width: usize, (slot, state): (usize, usize), jet: [T; 3]) {
    let first = 3 * width * slot + state;
    for (row, value) in jet.into_iter().enumerate() {
        rows[first + row * width] = value;
    }
}

fn n_states(agents: &Agents<'_>, agent: usize) -> usize {
    if agent == ABSENT { 0 } else { agents.agents[agent].states.len() }
}

impl Curve for AtomCurve<'_, '_> {
    fn jet(&mut self, t: f64) -> [f64; 3] {
        self.rows.evaluations += 1;
        self.rows.operations += self.agents.program.kernel(self.atom.rates).operations();
        if !self.folds.is_empty() {
            return self.folded_jet(t);
        }
        self.fill_numbers(self.atom.rates, &|segment, state| segment.state_jet(state, t));
        self.put_flow_rates(t);
        let mut out = [0.0; 3];
        self.apply(self.atom.rates, t, &mut out);
        out
    }

    fn value(&mut self, t: f64) -> f64 {
        let kernel = self.agents.program.kernel(self.atom.value);
        if !self.folds.is_empty() || self.own.is_some() || self.by_flow {
            return self.jet(t)[0];
        }
        self.rows.evaluations += 1;
        self.rows.operations += kernel.operations();
        self.fill_numbers(self.atom.value, &|segment, state| [segment.state(state, t), f64::NAN, f64::NAN]);
        let mut out = [0.0];
        self.apply(self.atom.value, t, &mut out);
        debug_assert!(out[0].total_cmp(&self.jet(t)[0]).is_eq() || out[0].is_nan(), "the jet has another g");
        out[0]
    }

    fn smooth(&self) -> bool {
        self.atom.smooth
    }

    fn turns(&mut self, t: f64) -> bool {
        if self.atom.turns.is_none() || !self.folds.is_empty() {
            return false;
        }
        let time = Interval { lo: t, hi: t };
        self.fill_boxes(t, t);
        let of_flow = self.flow_ranges(time);
        self.put_flow(&of_flow, |_, of_flow| of_flow);
        self.any_turn(time, |turn| turn.mig() <= AT_TURN)
    }

    fn given_up(&self) -> bool {
        self.interrupt.is_some_and(|interrupt| interrupt.load(Ordering::Relaxed))
    }

    fn jet_range(&mut self, s: f64, e: f64) -> [Interval; 3] {
        let time = Interval { lo: s, hi: e };
        if !self.folds.is_empty() {
            return self.folded_jet_range(time);
        }
        self.fill_boxes(s, e);
        if self.atom.affine && s < e && !self.may_turn(time) {
            return self.affine_range(s, e);
        }
        let mut out = [Interval::WHOLE; 3];
        let of_flow = self.flow_ranges(time);
        self.put_flow(&of_flow, Interval::hull);
        self.evaluate(self.atom.rates, time, &mut out);
        if self.by_flow {
            self.put_flow(&of_flow, |_, of_flow| of_flow);
            self.evaluate(self.atom.value, time, &mut out);
        }
        if s < e && !self.atom.smooth {
            // The rates hold between the jumps of g only, and bound nothing across one.
            (out[1], out[2]) = (Interval::WHOLE, Interval::WHOLE);
        } else if s < e && self.may_turn(time) {
            out[2] = Interval::WHOLE;
        }
        out
    }
}

impl<'a> AtomCurve<'a, '_> {
    /// The rows that a function reads, from the segments of the agents: state, rate and second rate.
    fn fill_numbers(&mut self, function: FunctionId, jet: &dyn Fn(&Segment, usize) -> [f64; 3]) {
        for &(slot, state) in &self.agents.program.kernel(function).reads().moving {
            if let Some(segment) = self.segment(slot) {
                put(&mut self.rows.numbers, self.width, (slot, state), jet(segment, state));
            }
        }
    }

    /// The last segment of the agent in a slot; none if there is nobody, or nothing is read of it but what events change.
    fn segment(&self, slot: usize) -> Option<&'a Segment> {
        let agent = self.slots[slot];
        let is_read = agent != ABSENT && self.atom.slots.contains(&slot);
        is_read.then(|| &self.agents.agents[agent].segment)
    }

    /// A function of the numbers at t.
    fn apply(&self, function: FunctionId, t: f64, out: &mut [f64]) {
        let width = self.width;
        let mut views: Views<'_> = (0..self.slots.len())
            .map(|slot| {
                let agent = self.slots[slot];
                if agent == ABSENT {
                    return AgentView::absent(&self.rows.absent);
                }
                let [states, rates, accelerations] = rows_of(&self.rows.numbers, width, slot);
                AgentView { states, rates, accelerations, aux: &self.agents.agents[agent].aux }
            })
            .collect();
        if let Some(own) = self.own {
            views[0].aux = own;
        }
        self.agents.program.kernel(function).eval(&views, t, out);
    }

    /// The rows that the comparison and its turns read over [s, e].
    fn fill_boxes(&mut self, s: f64, e: f64) {
        for function in [Some(self.atom.rates), self.atom.turns].into_iter().flatten() {
            for &(slot, state) in &self.agents.program.kernel(function).reads().moving {
                if let Some(segment) = self.segment(slot) {
                    let jet = segment.jet_range(state, s, e);
                    put(&mut self.rows.boxes, self.width, (slot, state), jet);
                }
            }
        }
    }

    /// Where the source reads rates: the places of rows with their agents.
    fn places_by_flow(&self) -> Vec<(usize, usize)> {
        if !self.by_flow {
            return Vec::new();
        }
        if !self.folds.is_empty() {
            return self.involved.iter().copied().enumerate().collect();
        }
        let is_read = |&(slot, _): &(usize, &usize)| self.segment(slot).is_some();
        self.slots.iter().enumerate().filter(is_read).map(|(slot, &agent)| (slot, agent)).collect()
    }

    /// Where the source reads rates: puts those of the flow in place of the slopes of the segments.
    fn put_flow_rates(&mut self, t: f64) {
        let width = self.width;
        for (place, agent) in self.places_by_flow() {
            let n = self.agents.agents[agent].states.len();
            let (dx, ddx) = self.rows.numbers[3 * width * place..][width..3 * width].split_at_mut(width);
            flow_rates_at(self.agents, agent, t, &mut dx[..n], &mut ddx[..n]);
        }
    }

    /// Where the source reads rates: bounds of those of the flow, and of the second ones, by place.
    fn flow_ranges(&mut self, time: Interval) -> Vec<(usize, [Vec<Interval>; 2])> {
        let span = (time.lo, time.hi);
        let places = self.places_by_flow().into_iter();
        let bounds = |(place, agent)| {
            Some((place, flow_rates_over(self.agents, agent, span, &mut self.rows.registers)?))
        };
        places.filter_map(bounds).collect()
    }

    /// Puts rates of the flow into the boxes in place of the slopes of the segments, or beside them. A rate of g is along the
    /// slopes; g itself is of the rates.
    fn put_flow(
        &mut self,
        of_flow: &[(usize, [Vec<Interval>; 2])],
        join: impl Fn(Interval, Interval) -> Interval,
    ) {
        let width = self.width;
        for (place, [rates, seconds]) in of_flow {
            let (dx, ddx) = self.rows.boxes[3 * width * place..][width..3 * width].split_at_mut(width);
            dx.iter_mut().zip(rates).for_each(|(slope, &rate)| *slope = join(*slope, rate));
            ddx[..seconds.len()].copy_from_slice(seconds);
        }
    }

    /// A function over the boxes.
    fn evaluate(&mut self, function: FunctionId, time: Interval, out: &mut [Interval]) {
        self.rows.ranges += 1;
        self.rows.operations += 2 * self.agents.program.kernel(function).operations();
        let width = self.width;
        let mut boxes: Boxes<'_> = (0..self.slots.len())
            .map(|slot| {
                let agent = self.slots[slot];
                if agent == ABSENT {
                    return AgentBox::absent(&self.rows.absent_box, &self.rows.absent);
                }
                let [states, rates, accelerations] = rows_of(&self.rows.boxes, width, slot);
                AgentBox { states, rates, accelerations, aux: &self.agents.agents[agent].aux }
            })
            .collect();
        if let Some(own) = self.own {
            boxes[0].aux = own;
        }
        self.agents.program.kernel(function).range(&boxes, time, &mut self.rows.registers, out);
    }

    /// The same for an atom with aggregates.
    fn folded_jet_range(&mut self, time: Interval) -> [Interval; 3] {
        self.rows.ranges += 1;
        self.rows.operations += 2 * self.agents.program.kernel(self.atom.rates).operations();
        let mut out = self.folded_range(time);
        if time.lo < time.hi && !self.atom.smooth {
            (out[1], out[2]) = (Interval::WHOLE, Interval::WHOLE);
        } else if time.lo < time.hi && self.atom.turns.is_some() {
            out[2] = Interval::WHOLE;
        }
        out
    }

    /// Whether the rate of g may jump on the boxes.
    fn may_turn(&mut self, time: Interval) -> bool {
        self.any_turn(time, |turn| turn.lo <= 0.0 && turn.hi >= 0.0)
    }

    /// Whether something that is zero where the rate of g may jump is so, on the boxes.
    fn any_turn(&mut self, time: Interval, is_so: impl Fn(&Interval) -> bool) -> bool {
        let Some(turns) = self.atom.turns else { return false };
        let mut out: SmallVec<[Interval; 4]> =
            smallvec![Interval::WHOLE; self.agents.program.kernel(turns).n_outputs()];
        self.evaluate(turns, time, &mut out);
        out.iter().any(is_so)
    }

    /// Bounds for an affine g, which is a polynomial on the segments: from its terms about the middle of [s, e].
    fn affine_range(&mut self, s: f64, e: f64) -> [Interval; 3] {
        let (middle, r) = (0.5 * (s + e), 0.5 * (e - s));
        let mut jet = self.jet_range(middle, middle);
        let degree = |agent: &usize| match *agent {
            ABSENT => 0,
            agent => self.agents.agents[agent].segment.degree(),
        };
        let degree = self.slots.iter().map(degree).max().unwrap_or(0);
        let size = |bound: Interval| bound.lo.abs().max(bound.hi.abs());
        let mut spread = [size(jet[1]) * r + 0.5 * size(jet[2]) * r * r, size(jet[2]) * r, 0.0];
        for power in 3..=degree {
            for &(slot, state) in &self.agents.program.kernel(self.atom.rates).reads().moving {
                if let Some(segment) = self.segment(slot) {
                    let first = 3 * self.width * slot;
                    self.rows.boxes[first + 2 * self.width + state] = segment.term_range(state, s, e, power);
                }
            }
            let mut out = [Interval::WHOLE; 3];
            self.evaluate(self.atom.rates, Interval { lo: middle, hi: middle }, &mut out);
            let (term, k) = (size(out[2]), power as f64);
            spread[0] += term;
            spread[1] += k * term / r;
            spread[2] += k * (k - 1.0) * term / (r * r);
        }
        for (bound, spread) in jet.iter_mut().zip(spread) {
            let room = spread * (1.0 + 1e-12);
            *bound = Interval { lo: bound.lo - room, hi: bound.hi + room };
        }
        jet
    }
}
