//! Links that follow from an expression, as guards: each case has a condition that is true while the link does not lead where
//! it should.
//!
//! Of `nearest o in S where F(o) by K(o)` that is: somebody else with F is nearer, `F(o) and K(o) < K(link)`; or the link leads
//! to somebody without F; or to nobody, and there is somebody with F. The tree of such a condition has a fixed shape, which the
//! runtime takes apart: see [`Whither::Nearest`].

use crate::calculus::aggregate;
use crate::calculus::births;
use crate::calculus::condition::{self, Cond, Sense};
use crate::calculus::draft::Draft;
use crate::calculus::error::Error;
use crate::calculus::frame::{AgentRef, Scope};
use crate::calculus::graph::Node;
use crate::calculus::guard;
use crate::calculus::system::{LinkUpdate, Range, Whither};
use crate::math::Op;
use crate::model::ir::{ExprId, LinkCase, LinkTarget, Quantifier, TypeId};

/// The updates of all links, in the order of their cases.
pub fn updates(draft: &mut Draft) {
    for (id, ty) in draft.model.types.iter_enumerated() {
        for (number, link) in ty.links.iter().enumerate() {
            for case in &link.cases {
                let name = format!("{}.{}", ty.name, link.name);
                let lowered = update(draft, id, number, case, &name);
                let lowered = draft.keep(lowered);
                draft.types[id.index()].links[number].updates.extend(lowered);
            }
        }
    }
}

fn update(
    draft: &mut Draft,
    ty: TypeId,
    number: usize,
    case: &LinkCase,
    name: &str,
) -> Result<LinkUpdate, Error> {
    let (mut scope, span) = (Scope::of_self(ty), case.span);
    let holds = test(draft, &mut scope, case.condition)?;
    let own = AgentRef::link(0, number);
    let link = scope.slot(draft.model, own, span)?.expect("a link has a slot");
    let column = draft.layout(ty.index()).link(number) as u32;
    let whom = draft.graph.intern(Node::Aux { slot: 0, column });
    let zero = draft.graph.number(0.0);
    let (strays, target) = match &case.target {
        LinkTarget::Nobody => {
            let nobody = draft.graph.number(-1.0);
            (Cond::Discrete(draft.graph.binary(Op::Ne, whom, nobody)), Whither::Nobody)
        }
        LinkTarget::Agent(agent) => match births::agent(draft, &mut scope, *agent, span)? {
            None => {
                let nobody = draft.graph.number(-1.0);
                (Cond::Discrete(draft.graph.binary(Op::Ne, whom, nobody)), Whither::Nobody)
            }
            Some(slot) => {
                let wanted = crate::calculus::build::agent_number(draft, &scope, AgentRef::Slot(slot));
                (Cond::Discrete(draft.graph.binary(Op::Ne, whom, wanted)), Whither::Slot(slot))
            }
        },
        LinkTarget::Nearest { binder, other, filter, key } => {
            let model = draft.model;
            let bound = &model.binders[*binder];
            let slot = scope.bind(bound.name.clone(), bound.ty, *other, span)?;
            let range = Range { slot, ty: bound.ty.index(), other: *other };
            let theirs = scope.bound_env(Scope::TOP, *binder, slot);
            let its = scope.bound_env(Scope::TOP, *binder, link);
            let belongs = |draft: &mut Draft, scope: &mut Scope, env, sense: Sense| match filter {
                Some(filter) => condition::lower_in(draft, scope, env, *filter, sense),
                None => Ok(Cond::Constant(sense == Sense::Positive)),
            };
            let filter = belongs(draft, &mut scope, theirs, Sense::Positive)?;
            let lost = belongs(draft, &mut scope, its, Sense::Negative)?;
            let [near, far] = [theirs, its].map(|env| aggregate::number(draft, &mut scope, env, *key));
            let (near, far) = (near?, far?);
            let nearer = condition::less(draft, &mut scope, near, far, span)?;
            let absent = Cond::Discrete(draft.graph.binary(Op::Lt, whom, zero));
            let present = Cond::Discrete(draft.graph.binary(Op::Le, zero, whom));
            let alone = guard::finish(draft, &scope.frame, filter.clone(), &format!("{name} where"));
            let key = draft.function(|| format!("{name} by"), vec![near]);
            let better = Cond::And(vec![filter, Cond::Or(vec![absent, nearer])]);
            let better = Cond::Quantified(Quantifier::Exists, range, Box::new(better));
            let strays = Cond::Or(vec![better, Cond::And(vec![present, lost])]);
            let target = Whither::Nearest { range, filter: alone, key, near: Vec::new(), keys: Vec::new() };
            (strays, target)
        }
    };
    let stale = Cond::And(vec![holds.clone(), strays]);
    let case = guard::finish(draft, &scope.frame, holds, &format!("{name} if"));
    let stale = guard::finish(draft, &scope.frame, stale, &format!("{name} update"));
    draft.check_work(span)?;
    let label = name.to_owned();
    Ok(LinkUpdate { link: number, label, frame: scope.into_frame(), case, stale, target, span })
}

fn test(draft: &mut Draft, scope: &mut Scope, condition: Option<ExprId>) -> Result<Cond, Error> {
    match condition {
        Some(condition) => condition::lower(draft, scope, condition, Sense::Positive),
        None => Ok(Cond::Constant(true)),
    }
}
