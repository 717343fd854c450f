//! How far those look who have a link to whoever is nearest (I7): as far as anybody could be who is nearer than the one it leads to.
//!
//! While the link leads to somebody, whoever is farther away does not matter, and how far away that is follows from bounds of the key of the
//! one it leads to ([`crate::codegen::program::Keys`]). If that one is lost, the search goes on from there in wider and wider boxes. Who has found
//! nobody looks as far as anybody may be who belongs to the set.

use rustc_hash::FxHashSet;
use smallvec::SmallVec;

use crate::codegen::program::{Entry, Keys, LinkUpdate, Near, Whither};
use crate::math::Interval;
use crate::runtime::engine::Engine;
use crate::runtime::failure::Failure;
use crate::runtime::grid::Grid;
use crate::runtime::guards::Origin;
use crate::runtime::neighbours::{Field, NOWHERE, Way};
use crate::runtime::population::ABSENT;
use crate::runtime::present::Depth;
use crate::runtime::sleep::StateBoxes;

/// By how much a box is wider than the one before in which nobody was found.
const WIDER: f64 = 4.0;
/// How many boxes are tried before everybody is asked.
const TRIES: usize = 5;
/// Ranges are bounds of real numbers.
const ROUNDING: f64 = 1e-9;

/// A link to whoever is nearest that has a range.
#[derive(Clone, Copy)]
struct Nearest<'p> {
    update: &'p LinkUpdate,
    near: &'p [Near],
    keys: &'p [Keys],
}

impl<'p> Nearest<'p> {
    fn of(origin: Origin<'p>) -> Option<Self> {
        let Origin::Link(update) = origin else { return None };
        let Whither::Nearest { near, keys, .. } = &update.target else { return None };
        Some(Self { update, near, keys })
    }

    /// How far away, in each of what is compared, anybody is at most whose key is less.
    fn rooms(&self, key: f64) -> SmallVec<[f64; 4]> {
        let room = |(near, keys): (&Near, &Keys)| near.within.min(keys.within(key)) * (1.0 + ROUNDING);
        self.near.iter().zip(self.keys).map(room).collect()
    }

    /// What the key of anybody is at least who is not within a distance in all that has no range of its own.
    fn beyond(&self, distance: f64) -> f64 {
        let unbounded = self.near.iter().zip(self.keys).filter(|(near, _)| near.within.is_infinite());
        unbounded.map(|(_, keys)| keys.beyond(distance)).fold(f64::INFINITY, f64::min)
    }

    /// A first distance at which to look for somebody, from how wide the cells of a grid are.
    fn first(&self, grid: &Grid) -> f64 {
        let axis = self.near.iter().position(|near| near.within.is_infinite()).unwrap_or(0);
        0.25 * grid.cell_width(axis)
    }
}

impl<'p> Engine<'p, '_> {
    fn nearest_of(&self, field: &Field) -> Nearest<'p> {
        Nearest::of(self.guards.definitions[field.definition].origin).expect("it is the field of a link")
    }

    /// How much room there is to be around the box of an agent in a field of a link.
    pub fn rooms(&mut self, field: &mut Field, agent: usize, side: usize) -> SmallVec<[f64; 4]> {
        let nearest = self.nearest_of(field);
        if side == 1 {
            return SmallVec::from_elem(0.0, nearest.near.len());
        }
        let target = self.agents.linked(agent, nearest.update.link);
        let seat = self.agents.agents[agent].seat;
        if target != ABSENT {
            *field.scopes.key(seat) = self.key_at_most(nearest.update, agent, target);
        }
        nearest.rooms(*field.scopes.key(seat))
    }

    /// The greatest key that the one to whom a link leads can have before the lists are made anew.
    fn key_at_most(&mut self, update: &LinkUpdate, agent: usize, target: usize) -> f64 {
        let Whither::Nearest { range, key, .. } = update.target else { return f64::INFINITY };
        let mut slots = self.agents.slots(&update.frame, &[agent]);
        slots[range.slot] = target;
        self.agents.follow_links(&update.frame, &mut slots);
        let mut states = StateBoxes::new();
        for (slot, &agent) in slots.iter().enumerate() {
            let is_read = (slot == 0 || slot == range.slot) && agent != ABSENT;
            states.push(if is_read { self.way(agent) } else { Way::new() });
        }
        let span = (self.present.time, self.neighbours.until.max(self.present.time));
        self.range_over(key, &slots, &states, span).hi
    }

    /// Those whose link leads to one of some agents: how far they look depends on these.
    pub fn owners_led_to(&self, field: &Field, agents: &[usize]) -> Vec<usize> {
        if !field.is_link {
            return Vec::new();
        }
        let known: FxHashSet<usize> = agents.iter().copied().collect();
        let mut owners: Vec<usize> =
            agents.iter().flat_map(|&agent| self.agents.linked_from(agent)).copied().collect();
        owners.retain(|owner| !known.contains(owner) && self.agents.is_alive(*owner));
        owners.sort_unstable();
        owners.dedup();
        owners
    }

    /// Has a link whose target is lost look farther, if nobody is certain to be the nearest among those at whom it looks: as far
    /// as `key` asks for, the least one among them, or `tries` times wider. False if it looks far enough.
    pub fn look_farther(&mut self, instance: u32, key: Option<f64>, tries: usize) -> Result<bool, Failure> {
        let definition = self.guards.instances[instance as usize].definition as usize;
        let mut fields = std::mem::take(&mut self.neighbours.fields);
        let field = fields.iter_mut().find(|field| field.is_link && field.definition == definition);
        let done = field.map_or(Ok(false), |field| self.look_farther_in(field, instance, key, tries));
        self.neighbours.fields = fields;
        done
    }

    fn look_farther_in(
        &mut self,
        field: &mut Field,
        instance: u32,
        key: Option<f64>,
        tries: usize,
    ) -> Result<bool, Failure> {
        let nearest = self.nearest_of(field);
        let agent = self.guards.instances[instance as usize].roots[0] as usize;
        let distance = nearest.first(&field.grid) * WIDER.powi(tries as i32);
        let scope = field.scopes.key(self.agents.agents[agent].seat);
        if *scope == f64::INFINITY || key.is_some_and(|key| key <= *scope) {
            return Ok(false);
        }
        *scope = match key {
            Some(key) => key,
            None if tries >= TRIES => f64::INFINITY,
            None => nearest.beyond(distance).max(*scope),
        };
        let rooms = nearest.rooms(*scope);
        let bounds = self.box_of(field, agent, 0, &rooms);
        let Some(number) = field.number(&self.agents, agent, 0) else { return Ok(false) };
        field.grid.change(number, &bounds);
        let wanted = self.pairs_around(field, &[number]);
        self.enter_new(field, wanted, &[], &mut Vec::new())?;
        Ok(true)
    }

    /// Those among whom to look for the nearest by numbers, by places, at the n-th try, and what the keys of all others are at least.
    pub fn among(&mut self, agent: usize, update: &LinkUpdate, tries: usize) -> (Vec<usize>, f64) {
        let Whither::Nearest { range, .. } = &update.target else { return (Vec::new(), f64::INFINITY) };
        let fields = std::mem::take(&mut self.neighbours.fields);
        let field = fields.iter().find(|field| {
            field.is_link && std::ptr::eq(self.nearest_of(field).update, update) && self.is_placed(field)
        });
        let found = field.map(|field| self.among_in(field, agent, tries));
        self.neighbours.fields = fields;
        found.unwrap_or_else(|| (self.agents.of_type[range.ty].clone(), f64::INFINITY))
    }

    fn among_in(&mut self, field: &Field, agent: usize, tries: usize) -> (Vec<usize>, f64) {
        let nearest = self.nearest_of(field);
        let is_last = tries >= TRIES;
        let distance = nearest.first(&field.grid) * WIDER.powi(tries as i32);
        let distance = if is_last { f64::INFINITY } else { distance };
        let place = self.place_of(field, agent, 0);
        let around = |(near, at): (&Near, &Interval)| {
            let room = near.within.min(distance) * (1.0 + ROUNDING);
            Interval { lo: at.lo - room, hi: at.hi + room }
        };
        let bounds: Way = nearest.near.iter().zip(&place).map(around).collect();
        let [ty, first] = [field.types[1], field.seats[0]];
        let numbers = field.grid.touching(&bounds).into_iter();
        let seats = numbers.filter_map(|number| (number as usize).checked_sub(first));
        let mut found: Vec<usize> = seats.map(|seat| self.agents.seats[ty][seat]).collect();
        found.retain(|&agent| agent != ABSENT);
        found.sort_unstable_by_key(|&agent| self.agents.number(agent));
        (found, if is_last { f64::INFINITY } else { nearest.beyond(distance) })
    }

    fn is_placed(&self, field: &Field) -> bool {
        field.seats == field.seats_of(&self.agents) && field.grid.len() == field.seats.iter().sum::<usize>()
    }

    /// Where an agent is now, in what is compared of it.
    fn place_of(&mut self, field: &Field, agent: usize, side: usize) -> Way {
        self.present.make(&self.agents, &[agent], Depth::States);
        let (states, aux) = (self.present.states(agent), &self.agents.agents[agent].aux);
        let at = |near: &Near| match near.entry(side) {
            Entry::State(k) => Interval::point(states[k]),
            Entry::Aux(column) => Interval::point(aux[column]),
        };
        self.ranges_of(field).iter().map(at).collect()
    }

    /// Before the first lists are made: fields of links say where everybody is.
    pub fn place_all(&mut self) {
        let mut fields = std::mem::take(&mut self.neighbours.fields);
        for field in fields.iter_mut().filter(|field| field.is_link) {
            let n = self.ranges_of(field).len();
            field.seats = field.seats_of(&self.agents);
            let mut boxes = vec![NOWHERE; n * field.seats[0]];
            for seat in 0..field.seats[1] {
                let agent = self.agents.seats[field.types[1]][seat];
                boxes.extend(self.place_of(field, agent, 1));
            }
            let places = &boxes[n * field.seats[0]..];
            let halves: Vec<f64> = (0..n).map(|axis| half_distance(places, n, axis)).collect();
            for (place, half) in boxes.iter_mut().zip(halves.iter().cycle()) {
                *place = Interval { lo: place.lo - half, hi: place.hi + half };
            }
            field.grid = Grid::new(n, boxes);
        }
        self.neighbours.fields = fields;
    }

    /// In the middle of an instant: fields of links hold those of some agents, too, who are no more where they were.
    pub fn place_anew(&mut self, agents: impl Iterator<Item = usize>) {
        let agents: Vec<usize> = agents.collect();
        let mut fields = std::mem::take(&mut self.neighbours.fields);
        for field in fields.iter_mut().filter(|field| field.is_link) {
            if !self.is_placed(field) {
                continue;
            }
            for &agent in &agents {
                let Some(number) = field.number(&self.agents, agent, 1) else { continue };
                let place = self.place_of(field, agent, 1);
                let known = field.grid.get(number);
                if !known.iter().zip(&place).all(|(known, &place)| known.encloses(place)) {
                    field.grid.change(number, &place);
                    field.scopes.changed.push(number);
                }
            }
        }
        self.neighbours.fields = fields;
    }
}

/// Half of how far agents are apart in one axis, if they are spread evenly over all of them.
fn half_distance(places: &[Interval], n: usize, axis: usize) -> f64 {
    let of_axis = places.iter().skip(axis).step_by(n);
    let hull = of_axis.copied().reduce(Interval::hull).unwrap_or(Interval::ZERO);
    let n_agents = places.len() as f64 / n as f64;
    0.5 * hull.width() / n_agents.powf(1.0 / n as f64)
}
