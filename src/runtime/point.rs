//! Comparisons at the present instant, by kernels on the present rows: what rounding may do to them, and, where they jump, on
//! which side of their surfaces they are.

use crate::codegen::kernel::{AgentBox, Kernel};
use crate::codegen::program::{Atom, Jumps};
use crate::math::Interval;
use crate::runtime::branches::{Point, own_columns, truth_of, width};
use crate::runtime::engine::Engine;
use crate::runtime::fold::{self, Folded};
use crate::runtime::population::{ABSENT, Slots};
use crate::runtime::present::{Boxes, Depth, Views, depth_read};
use crate::runtime::solve::time_resolution;
use crate::runtime::truth::{self, Side};
use crate::runtime::zeros::root_width;

impl Engine<'_, '_> {
    /// The truth of a comparison that jumps, on one side of the present instant. What is given afresh (`At`) meets its surfaces
    /// within rounding; what has flowed there, within the resolution of time.
    pub fn truth_on(
        &mut self,
        side: Side,
        jumps: &Jumps,
        (slots, folds): (&Slots, &[Folded<'_>]),
        before: bool,
    ) -> bool {
        let aux = self.agents.agents[slots[0]].aux.clone();
        let resolution = match side {
            Side::At => 0.0,
            Side::After => time_resolution(self.present.time),
        };
        let mut here = Here { engine: self, slots, folds };
        let own = own_columns(&mut here, jumps, &aux, side, resolution);
        truth_of(&mut here, &jumps.between, &own, side, resolution, before)
    }

    /// What rounding may do to the single output of a kernel on the present rows.
    pub fn rounding(&mut self, kernel: &Kernel, slots: &Slots, folds: &[Folded<'_>]) -> f64 {
        let mut out = [Interval::WHOLE];
        self.point_range(kernel, slots, folds, None, &mut out);
        width(out[0])
    }

    /// What rounding may do to the three outputs of one.
    pub fn jet_rounding(
        &mut self,
        kernel: &Kernel,
        slots: &Slots,
        folds: &[Folded<'_>],
        own: Option<&[f64]>,
    ) -> [f64; 3] {
        let mut out = [Interval::WHOLE; 3];
        self.point_range(kernel, slots, folds, own, &mut out);
        out.map(width)
    }

    /// How well a comparison is known of agents that go on from before the instant: by its rate along the flows that led to it, over the
    /// width to which roots are isolated (rule 3). Zero where nothing is known of that.
    pub fn width_by_approach(&mut self, atom: &Atom, slots: &Slots) -> f64 {
        let time = self.present.time;
        let has_come = |&slot: &usize| self.approach.rates(slots[slot], time).is_some();
        if !atom.folds.is_empty() || atom.jumps.is_some() || !atom.slots.iter().any(has_come) {
            return 0.0;
        }
        self.present.make(&self.agents, slots, Depth::Accelerations);
        let mut views = self.present.views(&self.agents, slots);
        for (view, &agent) in views.iter_mut().zip(slots) {
            view.rates = self.approach.rates(agent, time).unwrap_or(view.rates);
        }
        let mut jet = [0.0; 3];
        self.program.kernel(atom.rates).eval(&views, time, &mut jet);
        let width = jet[1].abs() * (time_resolution(time) + root_width(time));
        if width.is_finite() { width } else { 0.0 }
    }

    /// The outputs of a kernel with the present rows as intervals without width.
    fn point_range(
        &mut self,
        kernel: &Kernel,
        slots: &Slots,
        folds: &[Folded<'_>],
        own: Option<&[f64]>,
        out: &mut [Interval],
    ) {
        let involved = fold::involved(slots, folds);
        let absent = self.present.view(&self.agents, ABSENT);
        let views: Views<'_> =
            involved.iter().map(|&agent| self.present.view(&self.agents, agent)).chain([absent]).collect();
        self.points.clear();
        for view in &views {
            for row in [view.states, view.rates, view.accelerations] {
                self.points.extend(row.iter().map(|&v| Interval { lo: v, hi: v }));
            }
        }
        let mut rest = self.points.as_slice();
        let mut take = |row: &[f64]| {
            let (row, after) = rest.split_at(row.len());
            rest = after;
            row
        };
        let points: Boxes<'_> = views
            .iter()
            .map(|view| AgentBox {
                states: take(view.states),
                rates: take(view.rates),
                accelerations: take(view.accelerations),
                aux: view.aux,
            })
            .collect();
        let row = |agent: usize| points[involved.binary_search(&agent).unwrap_or(involved.len())];
        let time = Interval { lo: self.present.time, hi: self.present.time };
        self.curves.ranges += 1;
        self.curves.operations += 2 * kernel.operations();
        let depth = depth_read(kernel);
        let leaves = fold::leaf_ranges(self.program, folds, depth, time, &mut self.registers, &row);
        let mut boxes = fold::boxes(slots, &leaves, &row);
        if let Some(own) = own {
            boxes[0].aux = own;
        }
        kernel.range(&boxes, time, &mut self.registers, out);
    }
}

/// The present instant.
struct Here<'h, 'p, 'o> {
    engine: &'h mut Engine<'p, 'o>,
    slots: &'h Slots,
    folds: &'h [Folded<'h>],
}

impl Point for Here<'_, '_, '_> {
    fn jet(&mut self, atom: &Atom, own: &[f64]) -> [f64; 3] {
        let engine = &mut *self.engine;
        let kernel = engine.program.kernel(atom.rates);
        engine.curves.evaluations += 1;
        engine.curves.operations += kernel.operations();
        truth::jet_with(&engine.agents, &mut engine.present, kernel, self.slots, self.folds, Some(own))
    }

    fn rounding(&mut self, atom: &Atom, own: &[f64]) -> [f64; 3] {
        let kernel = self.engine.program.kernel(atom.rates);
        self.engine.jet_rounding(kernel, self.slots, self.folds, Some(own))
    }
}
