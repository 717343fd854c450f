//! Which modes a change of mode leaves and enters, from docs/LANGUAGE.md ("Hierarchy", "Regions") and from nothing of the engine.

use hyc::model::ir::{AgentType, Destination, Inside, ModeId};

use super::world::Agent;

/// A change of mode of one agent.
#[derive(Clone)]
pub struct Change {
    /// Who.
    pub agent: usize,
    /// The modes left, inner ones first.
    pub left: Vec<ModeId>,
    /// The modes entered, outer ones first.
    pub entered: Vec<ModeId>,
    /// From where and to where, as logs tell it.
    pub names: (String, String),
}

/// The agent itself.
pub fn root() -> ModeId {
    ModeId::new(0)
}

/// The modes around a mode and that mode, outermost first.
fn path(ty: &AgentType, mode: ModeId) -> Vec<ModeId> {
    let mut path = vec![mode];
    while let Some(parent) = ty.modes[path[0]].parent {
        path.insert(0, parent);
    }
    path
}

/// What is active beside each other: the regions, or the agent itself if it has none.
pub fn regions(ty: &AgentType) -> Vec<ModeId> {
    let regions: Vec<ModeId> = ty.modes.indices().filter(|mode| ty.modes[*mode].is_region).collect();
    if regions.is_empty() { vec![root()] } else { regions }
}

/// The region that a mode stands in; none for the agent itself where it has regions.
pub fn region_of(ty: &AgentType, mode: ModeId) -> Option<ModeId> {
    regions(ty).into_iter().find(|region| path(ty, mode).contains(region))
}

/// A mode's initial mode, the initial one of that, and so on.
fn initial(ty: &AgentType, mode: ModeId) -> Vec<ModeId> {
    std::iter::successors(ty.modes[mode].initial, |mode| ty.modes[*mode].initial).collect()
}

/// The modes that an agent is in which begins in a mode, or in the root by default.
pub fn beginning(ty: &AgentType, mode: ModeId) -> Vec<ModeId> {
    let mut active = vec![root()];
    for region in regions(ty) {
        let way = if path(ty, mode).contains(&region) { path(ty, mode) } else { path(ty, region) };
        active.extend(way.iter().skip(1));
        active.extend(initial(ty, *way.last().expect("a path has an end")));
    }
    active
}

/// The name of what an agent is in: its leaves.
pub fn name(ty: &AgentType, active: &[ModeId]) -> String {
    let leaves = active.iter().filter(|mode| ty.modes[**mode].children.is_empty());
    leaves.map(|mode| ty.modes[*mode].path.as_str()).collect::<Vec<_>>().join("|")
}

/// The change of mode of an agent by a transition of the mode `source`.
pub fn change(
    ty: &AgentType,
    (number, agent): (usize, &Agent),
    source: ModeId,
    target: Destination,
) -> Change {
    let own = region_of(ty, source);
    // The agent and its regions are never left, nor what is around both source and target.
    let mut stays = regions(ty);
    stays.push(root());
    if own.is_some_and(|region| region != source) {
        let around = |mode: ModeId| path(ty, mode).into_iter().filter(|other| *other != mode).collect();
        let (of_source, of_target): (Vec<ModeId>, Vec<ModeId>) = (around(source), around(target.mode));
        stays.extend(of_source.into_iter().filter(|mode| of_target.contains(mode)));
    }
    let concerned = |mode: &ModeId| own.is_none_or(|own| path(ty, *mode).contains(&own));
    let mut left: Vec<ModeId> = agent.active.clone();
    left.retain(|mode| concerned(mode) && !stays.contains(mode));
    left.sort_by_key(|mode| std::cmp::Reverse(ty.modes[*mode].depth));
    let mut entered = Vec::new();
    for region in regions(ty).into_iter().filter(concerned) {
        if !path(ty, target.mode).contains(&region) {
            entered.extend(initial(ty, region));
            continue;
        }
        entered.extend(path(ty, target.mode));
        let last = match target.inside {
            Inside::History => agent.last[target.mode.index()],
            Inside::Initial => None,
        };
        match last {
            Some(last) => entered.extend([last].into_iter().chain(initial(ty, last))),
            None => entered.extend(initial(ty, target.mode)),
        }
    }
    entered.retain(|mode| !stays.contains(mode));
    entered.sort_by_key(|mode| ty.modes[*mode].depth);
    let told = |active: &[ModeId]| {
        let told: Vec<ModeId> = active.iter().copied().filter(concerned).collect();
        name(ty, &told)
    };
    let names = (told(&agent.active), told(&after(ty, &agent.active, &left, &entered)));
    Change { agent: number, left, entered, names }
}

/// The modes that an agent is in after a change.
pub fn after(ty: &AgentType, active: &[ModeId], left: &[ModeId], entered: &[ModeId]) -> Vec<ModeId> {
    let mut active: Vec<ModeId> = active.iter().copied().filter(|mode| !left.contains(mode)).collect();
    active.extend(entered);
    // As they are declared, which is outer ones before inner ones.
    active.sort_by_key(|mode| ty.modes[*mode].span.start);
    active
}
