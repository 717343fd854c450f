//! From a condition over nodes to a guard: atoms numbered, each with its rates, all as functions.
//!
//! An atom that can jump also gets the surfaces at which it does, and what it is between them, with every branch read from a
//! lock: so that its roots and its jumps are both roots of what is smooth.

use rustc_hash::FxHashMap;

use crate::calculus::atom;
use crate::calculus::condition::{self, Cond, Sense, Written};
use crate::calculus::draft::Draft;
use crate::calculus::error::Error;
use crate::calculus::frame::Scope;
use crate::calculus::graph::NodeId;
use crate::calculus::locks::{self, Place, Purpose};
use crate::calculus::system::{Atom, Condition, Frame, Guard, Jumps, Quantified, Range, Relation};
use crate::model::ir::{ExprId, Quantifier};

/// At how many surfaces one comparison may jump; of one with more only its own bounds are known.
pub const SURFACES_MAX: usize = 64;

/// Lowers a boolean expression to a guard; `name` is for listings.
pub fn guard(
    draft: &mut Draft,
    scope: &mut Scope,
    expr: ExprId,
    sense: Sense,
    name: &str,
) -> Result<Guard, Error> {
    let cond = condition::lower(draft, scope, expr, sense)?;
    let guard = finish(draft, &scope.frame, cond, name);
    draft.check_work(draft.model.exprs[expr].span)?;
    Ok(guard)
}

/// Lowers a boolean expression to a guard whose comparisons have their margins.
pub fn margins(draft: &mut Draft, scope: &mut Scope, expr: ExprId, name: &str) -> Result<Guard, Error> {
    let cond = condition::lower_margins(draft, scope, expr)?;
    let guard = finish(draft, &scope.frame, cond, name);
    draft.check_work(draft.model.exprs[expr].span)?;
    Ok(guard)
}

/// Numbers the atoms of a condition.
pub fn finish(draft: &mut Draft, frame: &Frame, cond: Cond, name: &str) -> Guard {
    let mut numbering = Numbering { draft, frame, name, atoms: Vec::new(), nodes: Vec::new(), n_rising: 0 };
    let condition = numbering.condition(cond);
    let Numbering { mut atoms, n_rising, .. } = numbering;
    atoms.shrink_to_fit();
    Guard { condition, atoms, n_rising }
}

struct Numbering<'d, 'm> {
    draft: &'d mut Draft<'m>,
    frame: &'d Frame,
    name: &'d str,
    atoms: Vec<Atom>,
    nodes: Vec<(Relation, NodeId)>,
    n_rising: usize,
}

impl Numbering<'_, '_> {
    /// As deep as the lowering was, which has a limit.
    fn condition(&mut self, cond: Cond) -> Condition {
        match cond {
            Cond::Constant(value) => Condition::Constant(value),
            Cond::Discrete(node) => {
                let name = self.name;
                Condition::Discrete(self.draft.function(|| format!("{name} test"), vec![node]))
            }
            Cond::Atom(relation, g, written) => Condition::Atom(self.atom(relation, g, written)),
            Cond::And(terms) => Condition::And(terms.into_iter().map(|term| self.condition(term)).collect()),
            Cond::Or(terms) => Condition::Or(terms.into_iter().map(|term| self.condition(term)).collect()),
            Cond::Quantified(kind, range, body) => {
                let body = Box::new(self.condition(*body));
                let Range { slot, ty, other } = range;
                let quantified = Quantified { slot, ty, other, body, near: Vec::new() };
                match kind {
                    Quantifier::Exists => Condition::Exists(quantified),
                    Quantifier::Forall => Condition::Forall(quantified),
                }
            }
            Cond::Rising(inner) => {
                let number = self.n_rising;
                self.n_rising += 1;
                Condition::Rising(number, Box::new(self.condition(*inner)))
            }
        }
    }

    fn atom(&mut self, relation: Relation, g: NodeId, written: Written) -> usize {
        if let Some(k) = self.nodes.iter().position(|&known| known == (relation, g)) {
            return k;
        }
        let name = format!("{} {}", self.name, self.atoms.len() + 1);
        let mut atom = atom::atom(self.draft, self.frame, relation, g, written, &name);
        if !atom.smooth {
            atom.jumps = self.jumps(relation, g, written, &name).map(Box::new);
        }
        self.atoms.push(atom);
        self.nodes.push((relation, g));
        self.atoms.len() - 1
    }

    /// The surfaces at which g jumps, and what it is between them; none if it jumps in other ways, too.
    fn jumps(&mut self, relation: Relation, g: NodeId, written: Written, name: &str) -> Option<Jumps> {
        let first = self.draft.layout(self.frame.slots[0].ty()).n_aux();
        let (spans, span) = (FxHashMap::default(), written.span);
        let surface_name = format!("{name} jump");
        let place = Place { frame: self.frame, first, spans: &spans, span, name: &surface_name };
        let (locked, locks) = locks::lock(self.draft, place, Purpose::Guard, &[g]);
        if self.draft.is_exhausted() || locks.len() > SURFACES_MAX {
            return None;
        }
        let name = format!("{name} between jumps");
        let between = atom::atom(self.draft, self.frame, relation, locked[&g], written, &name);
        let surfaces = locks.into_iter().map(|lock| lock.kind).collect();
        between.smooth.then_some(Jumps { first, surfaces, between })
    }
}
