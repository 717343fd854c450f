//! Who is cold: which agents run ahead in herds, and where they were at a time.

use smallvec::SmallVec;

use crate::codegen::program::{Flow, Program, Slot};
use crate::math::Interval;
use crate::runtime::crew::Crew;
use crate::runtime::herd::Herd;
use crate::runtime::leap::{Covering, Leaps, STATES_MAX};
use crate::runtime::solve::control::Accuracy;
use crate::runtime::solve::segment::{N_MAX, Segment};
use crate::runtime::solve::series_step;
use crate::runtime::stretch::Advanced;
use crate::runtime::tracks::TrackStep;

/// A place in a herd.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    /// Which herd; [`NONE`] if it is in none.
    herd: u32,
    /// The place in it.
    place: u32,
    /// Whether it runs ahead now.
    cold: bool,
}

/// The place of an agent that is in no herd.
const NOWHERE: Place = Place { herd: NONE, place: 0, cold: false };

const NONE: u32 = u32::MAX;

/// The herds, and who is where.
#[derive(Clone, Debug, Default)]
pub struct Cold<'p> {
    /// One for each type and mode whose agents can be cold.
    herds: Vec<Herd<'p>>,
    /// For each type and mode, its herd.
    of_mode: Vec<Vec<Option<u32>>>,
    /// By agent; empty if nobody is ever cold.
    places: Vec<Place>,
    /// By agent, up to where the steps have been counted that it takes when it runs ahead no more, s.
    counted: Vec<f64>,
    /// By agent, the steps that it took in the herds that it has left.
    left: Vec<u64>,
}

impl<'p> Cold<'p> {
    /// Herds for `n_agents`, all of which are not cold.
    pub fn new(program: &'p Program, n_agents: usize, accuracy: Accuracy, stop: f64) -> Self {
        let mut herds = Vec::new();
        let order = series_step::order(accuracy.tolerance, N_MAX - 1);
        let mut herd_of = |ty: usize, mode: usize| {
            let flow = program.types[ty].modes[mode].flow.as_ref()?;
            let tape = program.series[ty][mode].as_ref()?;
            if !is_alone(flow) || tape.n_states > STATES_MAX || tape.n_states == 0 {
                return None;
            }
            let leaps = Leaps { tape, order, accuracy, stop };
            herds.push(Herd::new(leaps));
            Some(herds.len() as u32 - 1)
        };
        let modes = |ty: usize| 0..program.types[ty].modes.len();
        let of_mode: Vec<Vec<Option<u32>>> =
            (0..program.types.len()).map(|ty| modes(ty).map(|mode| herd_of(ty, mode)).collect()).collect();
        let n_places = if herds.is_empty() { 0 } else { n_agents };
        let counted = vec![f64::NEG_INFINITY; n_places];
        Self { herds, of_mode, places: vec![NOWHERE; n_places], counted, left: vec![0; n_places] }
    }

    /// Whether anybody can be cold.
    pub fn is_used(&self) -> bool {
        !self.herds.is_empty()
    }

    /// Whether agents of a type can be cold in a mode.
    pub fn may_be(&self, ty: usize, mode: usize) -> bool {
        self.is_used() && self.of_mode[ty][mode].is_some()
    }

    /// Whether agents of a type can be cold in any mode.
    pub fn may_ever_be(&self, ty: usize) -> bool {
        self.is_used() && self.of_mode[ty].iter().any(Option::is_some)
    }

    /// Whether an agent is cold.
    #[inline]
    pub fn is_cold(&self, agent: usize) -> bool {
        self.places.get(agent).is_some_and(|place| place.cold)
    }

    /// How far a cold agent has come, and its states there; none if it is not cold.
    #[inline]
    pub fn now(&self, agent: usize) -> Option<(f64, &[f64])> {
        let place = self.places.get(agent).filter(|place| place.cold)?;
        Some(self.herds[place.herd as usize].now(place.place as usize))
    }

    /// The herd of a cold agent, and its place there.
    fn find(&self, agent: usize) -> (&Herd<'p>, usize) {
        let Place { herd, place, .. } = self.places[agent];
        (&self.herds[herd as usize], place as usize)
    }

    /// Whether the way of a cold agent at `t` is followed in its herd; before, it is on its last segment.
    pub fn knows(&self, agent: usize, t: f64) -> bool {
        let (herd, place) = self.find(agent);
        t >= herd.known(place).0
    }

    /// The step of a cold agent that covers `t`, and its states at the end of that.
    pub fn follow(
        &self,
        agent: usize,
        t: f64,
        states: &mut [f64],
        segment: &mut Segment,
    ) -> Option<Covering> {
        let (herd, place) = self.find(agent);
        herd.follow(place, t, states, segment)
    }

    /// The states of a cold agent at `t`, from which or from before which its way is followed.
    pub fn states_at(&self, agent: usize, t: f64, states: &mut [f64]) {
        let (herd, place) = self.find(agent);
        herd.states_at(place, t, states);
    }

    /// Tells the states of cold agents at `t`, from which or from before which their ways are followed.
    pub fn survey(&self, agents: &[usize], t: f64, tell: &mut dyn FnMut(usize, &[f64])) {
        let mut places = vec![Vec::new(); self.herds.len()];
        for &agent in agents {
            let Place { herd, place, .. } = self.places[agent];
            places[herd as usize].push(place as usize);
        }
        for (herd, places) in self.herds.iter().zip(&places) {
            herd.survey(places, t, &mut |place, states| tell(herd.agents[place] as usize, states));
        }
    }

    /// Forgets all tracks.
    pub fn clear_tracks(&mut self) {
        self.herds.iter_mut().for_each(|herd| herd.tracks.clear());
    }

    /// Of how many agents steps are kept.
    pub fn n_tracked(&self) -> usize {
        self.herds.iter().map(|herd| herd.tracks.wanted().len()).sum()
    }

    /// Has the steps of a cold agent kept when it is advanced next.
    pub fn want_track(&mut self, agent: usize) {
        let Place { herd, place, cold, .. } = self.places[agent];
        if cold {
            self.herds[herd as usize].tracks.want(place as usize);
        }
    }

    /// The steps that were kept of an agent are not its steps any more.
    pub fn void_track(&mut self, agent: usize) {
        if let Some(&Place { herd, place, .. }) = self.places.get(agent)
            && herd != NONE
        {
            self.herds[herd as usize].tracks.void(place as usize);
            self.counted[agent] = f64::NEG_INFINITY;
        }
    }

    /// Whether a step of an agent that ends at `end` was counted when the agent ran ahead.
    pub fn has_counted(&self, agent: usize, end: f64) -> bool {
        self.counted.get(agent).is_some_and(|&counted| end <= counted)
    }

    /// The step that was kept of an agent, not cold now, from `t` on, and the states at its end.
    pub fn kept_step(
        &self,
        agent: usize,
        t: f64,
        states: &mut [f64],
        segment: &mut Segment,
    ) -> Option<TrackStep> {
        let &Place { herd, place, .. } = self.places.get(agent).filter(|place| place.herd != NONE)?;
        let tracks = &self.herds[herd as usize].tracks;
        let step = tracks.beginning(place as usize, t)?;
        Some(tracks.take(step, states, segment))
    }

    /// Bounds of a state of a cold agent over [s, e], by the steps that were kept of it; none if they do not cover that.
    pub fn range(&self, agent: usize, state: usize, span: (f64, f64)) -> Option<Interval> {
        let (herd, place) = self.find(agent);
        herd.tracks.range(place, state, span)
    }

    /// Where the steps begin and end that were kept of a cold agent, s.
    pub fn joints(&self, agent: usize) -> impl Iterator<Item = f64> {
        let place = self.places.get(agent).filter(|place| place.cold);
        place
            .into_iter()
            .flat_map(|place| self.herds[place.herd as usize].tracks.joints(place.place as usize))
    }

    /// Makes the tracks that are wanted, of ways that are followed from `from` on at least.
    pub fn make_tracks(&mut self, from: f64, crew: &Crew) {
        self.herds.iter_mut().for_each(|herd| herd.make_tracks(from, crew));
    }

    /// The time from which the way of a cold agent is followed, s.
    pub fn known_from(&self, agent: usize) -> f64 {
        let (herd, place) = self.find(agent);
        herd.known(place).0
    }

    /// The time and the states from which the way of a cold agent is followed.
    pub fn known(&self, agent: usize) -> (f64, SmallVec<[f64; 8]>) {
        let (herd, place) = self.find(agent);
        let (t, states) = herd.known(place);
        (t, states.into())
    }

    /// Bounds of the states of a cold agent, in order, from the begin of the window on to where it has come.
    pub fn bounds(&self, agent: usize) -> &[Interval] {
        let (herd, place) = self.find(agent);
        herd.bounds(place)
    }

    /// Has an agent, which may be cold in its mode, run ahead from `(t, states)`; `bounds` are those of its states from the
    /// present to there.
    pub fn freeze(
        &mut self,
        agent: usize,
        (ty, mode): (usize, usize),
        (t, states): (f64, &[f64]),
        aux: &[f64],
        bounds: impl Iterator<Item = Interval>,
    ) {
        let Some(herd) = self.of_mode[ty][mode] else { return };
        if self.places[agent].herd != herd {
            self.leave(agent);
            let place = self.herds[herd as usize].push(agent) as u32;
            self.places[agent] = Place { herd, place, cold: false };
            self.counted[agent] = f64::NEG_INFINITY;
        }
        let place = &mut self.places[agent];
        place.cold = true;
        self.herds[herd as usize].start(place.place as usize, (t, states), aux, bounds);
    }

    /// Has an agent run ahead no more; it keeps its place.
    pub fn thaw(&mut self, agent: usize) {
        let place = &mut self.places[agent];
        let herd = &mut self.herds[place.herd as usize];
        place.cold = false;
        self.counted[agent] = herd.now(place.place as usize).0;
        herd.halt(place.place as usize);
    }

    /// Makes room for an agent in a place that nobody has.
    pub fn admit(&mut self, place: usize) {
        if place == self.places.len() {
            self.places.push(NOWHERE);
            self.counted.push(f64::NEG_INFINITY);
            self.left.push(0);
        }
        self.places[place] = NOWHERE;
        self.counted[place] = f64::NEG_INFINITY;
        self.left[place] = 0;
    }

    /// Takes an agent out that is not cold.
    pub fn dismiss(&mut self, agent: usize) {
        self.leave(agent);
    }

    /// How many steps an agent has taken in herds.
    pub fn steps_of(&self, agent: usize) -> u64 {
        let Some(&Place { herd, place, .. }) = self.places.get(agent) else { return 0 };
        let here = if herd == NONE { 0 } else { self.herds[herd as usize].steps_of(place as usize) };
        here + self.left[agent]
    }

    /// Takes an agent out of its herd, if it is in one.
    fn leave(&mut self, agent: usize) {
        let Place { herd, place, .. } = self.places[agent];
        if herd == NONE {
            return;
        }
        self.left[agent] += self.herds[herd as usize].steps_of(place as usize);
        if let Some(moved) = self.herds[herd as usize].remove(place as usize) {
            self.places[moved].place = place;
        }
        self.places[agent].herd = NONE;
    }

    /// The agent type of a herd; right-hand sides and arithmetic operations that one of its steps takes.
    pub fn cost(&self, herd: usize) -> (usize, u64, u64) {
        let leaps = &self.herds[herd].leaps;
        let is_of = |ty: &usize| self.of_mode[*ty].contains(&Some(herd as u32));
        let ty = (0..self.of_mode.len()).find(is_of).unwrap_or(0);
        (ty, leaps.order as u64 + 1, leaps.tape.operations(leaps.order) + leaps.tape.operations(1))
    }

    /// Advances all cold agents to `until` or beyond; those are told that could go no further, and those of whom it should be
    /// looked at whether their flow is stiff (true). Their ways stay known from `from` on.
    pub fn advance(
        &mut self,
        (from, until): (f64, f64),
        crew: &Crew,
        tell: &mut dyn FnMut(usize, bool),
    ) -> Vec<u64> {
        let mut steps = Vec::with_capacity(self.herds.len());
        for herd in &mut self.herds {
            let Advanced { steps: taken, refused, unlooked } = herd.advance(from, until, crew);
            steps.push(taken);
            refused.into_iter().for_each(|place| tell(herd.agents[place] as usize, false));
            unlooked.into_iter().for_each(|place| tell(herd.agents[place] as usize, true));
        }
        steps
    }
}

/// Whether a flow reads nobody but its own agent, and has no kinks.
fn is_alone(flow: &Flow) -> bool {
    flow.kinks.is_empty() && flow.frame.slots.len() == 1 && matches!(flow.frame.slots[0], Slot::Root { .. })
}
