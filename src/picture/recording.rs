//! A run kept in memory for pictures: what some record samples, and the events.
//!
//! An agent has samples while it lives. The record is thinned out as the run goes on, so that their number is bounded, wherever the run ends
//! and however many agents come and go.

use std::io;

use rustc_hash::FxHashMap;

use crate::model::Diagram;
use crate::output::Cast;
use crate::runtime::observe::{Cell, Event, Observer, Row, Who};

/// Of more events only the first so many are kept.
pub const EVENTS_MAX: usize = 50_000;

/// The observer.
pub struct Recording<'a> {
    cast: &'a Cast,
    /// The number of the record that is kept; its samples are at the same times for all agents.
    record: usize,
    n_columns: usize,
    /// For each type, the number of each of its modes by its path.
    numbers: Vec<FxHashMap<String, u16>>,
    /// The place of each agent's track.
    places: FxHashMap<usize, usize>,
    /// All modes that agents can be in, by number, as `type: path`.
    pub modes: Vec<String>,
    /// s.
    pub times: Vec<f64>,
    /// Those of agents that were sampled, or that have had an event; closed, in order of their numbers.
    pub tracks: Vec<Track>,
    /// The first of them.
    pub events: Vec<Happened>,
    /// All of them.
    pub n_events: u64,
    /// The labels that events refer to.
    pub transitions: Vec<String>,
    /// The mode paths that events refer to.
    pub paths: Vec<String>,
}

/// What is known of one agent.
#[derive(Clone, Debug)]
pub struct Track {
    who: Who,
    has_event: bool,
    /// Its name.
    pub name: String,
    /// The number of its first sample's time; it has one at each from there on, until it dies.
    pub first: usize,
    /// For each column, for each of its samples, the value; NaN if there is none.
    pub values: Vec<Vec<f64>>,
    /// For each of its samples the mode's number.
    pub modes: Vec<u16>,
}

/// An event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Happened {
    /// s.
    pub time: f64,
    /// The number of its transition's label.
    pub transition: usize,
    /// The agent: its number, and from [`Recording::close`] on that of its track.
    pub agent: usize,
    /// The other participant of an interaction.
    pub other: Option<usize>,
    /// The numbers of the paths of the mode that is left and of the one that is entered.
    pub modes: Option<(usize, usize)>,
}

impl<'a> Recording<'a> {
    /// Nothing yet of this record, which has so many columns. Modes have the numbers of the leaves of the diagrams, which are those of their colours.
    pub fn new(cast: &'a Cast, diagrams: &[Diagram], (record, n_columns): (usize, usize)) -> Self {
        let mut numbers = vec![FxHashMap::default(); diagrams.len()];
        let mut modes = Vec::new();
        for (numbers, diagram) in numbers.iter_mut().zip(diagrams) {
            for leaf in diagram.boxes.iter().filter(|shown| shown.children.is_empty()) {
                numbers.insert(leaf.path.clone(), u16::try_from(modes.len()).unwrap_or(u16::MAX));
                modes.push(match (diagrams.len(), leaf.path.as_str()) {
                    (_, "") => diagram.name.clone(),
                    (1, path) => path.into(),
                    (_, path) => format!("{}: {path}", diagram.name),
                });
            }
        }
        let (places, times, tracks, events, transitions, paths) = Default::default();
        Self {
            cast,
            record,
            n_columns,
            numbers,
            places,
            modes,
            times,
            tracks,
            events,
            n_events: 0,
            transitions,
            paths,
        }
    }

    /// Puts the tracks in order, and has the events refer to them.
    pub fn close(&mut self) {
        self.tracks.sort_by_key(|track| track.who);
        self.find_places();
        for event in &mut self.events {
            event.agent = self.places[&event.agent];
            event.other = event.other.map(|other| self.places[&other]);
        }
    }

    fn find_places(&mut self) {
        let numbers = self.tracks.iter().enumerate();
        self.places = numbers.map(|(place, track)| (track.who.number, place)).collect();
    }

    /// How many agents have been sampled.
    pub fn n_sampled(&self) -> usize {
        self.tracks.iter().filter(|track| !track.modes.is_empty()).count()
    }

    /// Whether some agent has both of these at some time; time is there always.
    pub fn shows(&self, pair: [Option<usize>; 2]) -> bool {
        self.tracks.iter().any(|track| {
            let is_there = |column: Option<usize>, k: usize| {
                column.is_none_or(|column| track.values[column][k].is_finite())
            };
            (0..track.modes.len()).any(|k| is_there(pair[0], k) && is_there(pair[1], k))
        })
    }

    /// Whether agents have at least two different values in a column, and at most so many.
    pub fn has_few(&self, column: usize, most: usize) -> bool {
        let mut found: Vec<f64> = Vec::new();
        for &value in self.tracks.iter().flat_map(|track| &track.values[column]) {
            if value.is_finite() && !found.contains(&value) {
                found.push(value);
                if found.len() > most {
                    return false;
                }
            }
        }
        found.len() >= 2
    }

    /// An agent's track.
    fn track(&mut self, who: Who) -> &mut Track {
        let place = *self.places.entry(who.number).or_insert_with(|| {
            let (name, values) = (self.cast.agent(who).into_owned(), vec![Vec::new(); self.n_columns]);
            self.tracks.push(Track { who, name, has_event: false, first: 0, values, modes: Vec::new() });
            self.tracks.len() - 1
        });
        &mut self.tracks[place]
    }

    /// The number of a mode by its path. Where regions have one each, that of the first counts.
    fn mode(&self, ty: usize, path: &str) -> u16 {
        let first = path.split('|').next().unwrap_or(path);
        self.numbers.get(ty).and_then(|numbers| numbers.get(first)).copied().unwrap_or(u16::MAX)
    }
}

impl Track {
    /// Gives up the samples with odd numbers.
    fn thin(&mut self) {
        let from = self.first % 2;
        for values in &mut self.values {
            *values = values.iter().copied().skip(from).step_by(2).collect();
        }
        self.modes = self.modes.iter().copied().skip(from).step_by(2).collect();
        self.first = self.first.div_ceil(2);
    }
}

impl Observer for Recording<'_> {
    fn event(&mut self, event: &Event<'_>) -> io::Result<()> {
        self.n_events += 1;
        if self.events.len() < EVENTS_MAX {
            let transition = number_in(&mut self.transitions, event.transition);
            let modes = event
                .modes
                .map(|(from, to)| (number_in(&mut self.paths, from), number_in(&mut self.paths, to)));
            for who in [Some(event.agent), event.other].into_iter().flatten() {
                self.track(who).has_event = true;
            }
            let (time, agent) = (event.time, event.agent.number);
            let other = event.other.map(|other| other.number);
            self.events.push(Happened { time, transition, agent, other, modes });
        }
        Ok(())
    }

    fn sample(&mut self, record: usize, row: &Row<'_>) -> io::Result<()> {
        if record != self.record {
            return Ok(());
        }
        if self.times.last() != Some(&row.time) {
            self.times.push(row.time);
        }
        let mode = self.mode(row.agent.ty, row.mode);
        let number = self.times.len() - 1;
        let track = self.track(row.agent);
        if track.modes.is_empty() {
            track.first = number;
        }
        track.modes.push(mode);
        for (values, cell) in track.values.iter_mut().zip(row.cells) {
            values.push(match *cell {
                Cell::Number(value) => value,
                Cell::Bool(value) => f64::from(u8::from(value)),
                Cell::Empty | Cell::Agent(_) => f64::NAN,
            });
        }
        Ok(())
    }

    fn thinned(&mut self, record: usize) -> io::Result<()> {
        if record != self.record {
            return Ok(());
        }
        self.times = self.times.iter().copied().step_by(2).collect();
        self.tracks.iter_mut().for_each(Track::thin);
        // Of those who lived between two samples that are left nothing is to be shown.
        self.tracks.retain(|track| track.has_event || !track.modes.is_empty());
        self.find_places();
        Ok(())
    }
}

/// The place of a text in a list of a few, added if it is not there.
fn number_in(list: &mut Vec<String>, text: &str) -> usize {
    list.iter().position(|other| other == text).unwrap_or_else(|| {
        list.push(text.into());
        list.len() - 1
    })
}
