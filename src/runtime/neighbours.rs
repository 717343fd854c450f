//! Near pairs (I7): which pairs of an interaction have instances, and the boxes by which they are found.
//!
//! An interaction whose condition has a range ([`crate::codegen::program::Near`]) has instances for pairs only that can
//! come within it before the list is made anew. Each agent has a box: where it can get to until then, in the states that
//! are compared, with half of the range around it. Pairs whose boxes do not overlap cannot make the condition true.

use smallvec::SmallVec;

use crate::math::Interval;
use crate::runtime::grid::Grid;
use crate::runtime::population::Agents;

/// Where nobody is: it overlaps nothing.
pub const NOWHERE: Interval = Interval { lo: f64::INFINITY, hi: f64::NEG_INFINITY };

/// Boxes of an agent's states.
pub type Way = SmallVec<[Interval; 8]>;

/// The pairs of all interactions that have a range.
#[derive(Default)]
pub struct Neighbours {
    /// The lists hold up to here, s.
    pub until: f64,
    /// For how long they were made, s.
    pub span: f64,
    /// One for each transition of an interaction, and for each quantifier, that has a range.
    pub fields: Vec<Field>,
    /// Where agents get to before that who follow others, or may be followed, by place, as far as anybody has asked.
    pub ways: Vec<Option<Way>>,
}

/// The pairs of one transition of an interaction, or of the owners of a guard and those at whom a quantifier of it looks.
pub struct Field {
    /// Its definition.
    pub definition: usize,
    /// The number of the quantifier; none for an interaction.
    pub quantifier: Option<usize>,
    /// The types of the two.
    pub types: [usize; 2],
    /// Whether each of the two is found by the same states of the same type: then an agent has one box.
    pub alike: bool,
    /// Whether a pair counts once, the lower number first.
    pub symmetric: bool,
    /// How many seats either type had when the list was made.
    pub seats: [usize; 2],
    /// The boxes of the first type, then, if they are not alike, those of the second, each by seat.
    pub grid: Grid,
    /// Whether an agent is paired with itself.
    pub with_self: bool,
    /// Pairs that have instances, with those; of a quantifier with the instance of the guard. In no order, and with some whose agents
    /// have died since.
    pub listed: Vec<Listed>,
    /// Whether it is of a link to whoever is nearest: then its scopes say how far each owner looks.
    pub is_link: bool,
    /// See above.
    pub scopes: Scopes,
}

/// How far those look who have a link to whoever is nearest.
#[derive(Default)]
pub struct Scopes {
    /// By seat: whoever has a lesser key, for all of the time for which the lists hold, is a candidate.
    pub keys: Vec<f64>,
    /// Boxes that have changed since their pairs were listed.
    pub changed: Vec<u32>,
}

impl Scopes {
    /// The scope of whoever has a seat.
    pub fn key(&mut self, seat: usize) -> &mut f64 {
        if self.keys.len() <= seat {
            self.keys.resize(seat + 1, f64::INFINITY);
        }
        &mut self.keys[seat]
    }
}

/// A pair with its instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Listed {
    /// The two, in the order of the interaction's participants.
    pub agents: [u32; 2],
    /// Their instance.
    pub instance: u32,
}

impl Field {
    /// The sides that have boxes of their own.
    pub fn sides(&self) -> std::ops::Range<usize> {
        0..if self.alike { 1 } else { 2 }
    }

    /// The number of an agent's box on one side; none if it is of another type.
    pub fn number(&self, agents: &Agents<'_>, agent: usize, side: usize) -> Option<u32> {
        let agent = &agents.agents[agent];
        let before = if side == 0 { 0 } else { self.seats[0] };
        (agent.ty == self.types[side]).then(|| (before + agent.seat) as u32)
    }

    /// How many seats either type has now.
    pub fn seats_of(&self, agents: &Agents<'_>) -> [usize; 2] {
        self.types.map(|ty| agents.seats[ty].len())
    }

    /// Those who are paired with themselves.
    pub fn selves<'a>(&self, agents: &'a Agents<'_>) -> &'a [usize] {
        if self.with_self { &agents.of_type[self.types[0]] } else { &[] }
    }

    /// The pairs of agents that two boxes, a < b, stand for.
    pub fn pairs(&self, agents: &Agents<'_>, a: u32, b: u32) -> SmallVec<[[u32; 2]; 2]> {
        let first = &agents.seats[self.types[0]];
        let in_order = |a: u32, b: u32| agents.number(a as usize) < agents.number(b as usize);
        if self.alike {
            let (a, b) = (first[a as usize] as u32, first[b as usize] as u32);
            return match self.symmetric {
                true if in_order(a, b) => SmallVec::from_slice(&[[a, b]]),
                true => SmallVec::from_slice(&[[b, a]]),
                false => SmallVec::from_slice(&[[a, b], [b, a]]),
            };
        }
        // Boxes of the two sides only, and not of an agent with itself.
        let (a, b) = (a as usize, b as usize);
        if a >= first.len() || b < first.len() {
            return SmallVec::new();
        }
        let (a, b) = (first[a] as u32, agents.seats[self.types[1]][b - first.len()] as u32);
        let is_one = a != b && (!self.symmetric || in_order(a, b));
        if is_one { SmallVec::from_slice(&[[a, b]]) } else { SmallVec::new() }
    }
}

impl Neighbours {
    /// Forgets the box of an agent that dies; its pairs are listed until the lists are made anew.
    pub fn forget(&mut self, agents: &Agents<'_>, agent: usize) {
        if let Some(way) = self.ways.get_mut(agent) {
            *way = None;
        }
        for field in &mut self.fields {
            if field.is_link && agents.agents[agent].ty == field.types[0] {
                *field.scopes.key(agents.agents[agent].seat) = f64::INFINITY;
            }
            for side in field.sides() {
                let number = field.number(agents, agent, side);
                if let Some(number) = number.filter(|&number| (number as usize) < field.grid.len()) {
                    let nowhere: SmallVec<[Interval; 4]> =
                        field.grid.get(number).iter().map(|_| NOWHERE).collect();
                    field.grid.change(number, &nowhere);
                }
            }
        }
    }
}
