//! Kinks (rule 15): a flow in which every branch is read from a lock, so that it is smooth while no lock changes.

use crate::base::Span;
use crate::calculus::draft::Draft;
use crate::calculus::frame::Scope;
use crate::calculus::graph::NodeId;
use crate::calculus::locks::{self, Place, Purpose};
use crate::calculus::system::Kink;

/// The locked forms of `flow` (the rates of self, whose type is `ty`), and the kinks. What is locked stands where it stood.
pub fn lock(
    draft: &mut Draft,
    scope: &mut Scope,
    ty: usize,
    flow: &[NodeId],
    name: &str,
) -> (Vec<NodeId>, Vec<Kink>) {
    let first = draft.layout(ty).lock(0);
    let kink_name = format!("{name} kink");
    let place =
        Place { frame: &scope.frame, first, spans: &scope.spans, span: Span::default(), name: &kink_name };
    let (locked, locks) = locks::lock(draft, place, Purpose::Flow, flow);
    let initial = |(k, lock): (usize, locks::Lock)| {
        let initial = draft.function(|| format!("{kink_name} {} initial", k + 1), vec![lock.initial]);
        Kink { lock: first + k, initial, kind: lock.kind, span: lock.span }
    };
    let kinks = locks.into_iter().enumerate().map(initial).collect();
    if draft.is_exhausted() {
        // The flow is refused for it.
        return (flow.to_vec(), kinks);
    }
    let smooth = flow.iter().map(|id| locked[id]).collect();
    let moved = locked.into_iter().filter_map(|(old, new)| scope.spans.get(&old).map(|&span| (new, span)));
    for (new, span) in moved.collect::<Vec<_>>() {
        let first = scope.spans.entry(new).or_insert(span);
        *first = span.min(*first);
    }
    (smooth, kinks)
}
