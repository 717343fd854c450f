//! A run kept in memory for pictures: what some record samples, and the events.

use std::collections::BTreeMap;
use std::io;

use crate::model::Diagram;
use crate::output::Cast;
use crate::runtime::observe::{Cell, Event, Observer, Row, Who};

/// Of more events only the first so many are kept.
const EVENTS_MAX: usize = 50_000;
/// Agents with higher numbers are not shown.
const TRACKS_MAX: usize = 20_000;

/// The observer.
pub struct Recording<'a> {
    cast: &'a Cast,
    /// The number of the record that is kept; its samples are at the same times for all agents.
    record: usize,
    numbers: BTreeMap<(usize, String), u16>,
    /// All modes that agents can be in, by number, as `type: path`.
    pub modes: Vec<String>,
    /// s.
    pub times: Vec<f64>,
    /// By number.
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
#[derive(Clone, Debug, Default)]
pub struct Track {
    /// Its name.
    pub name: String,
    /// For each column, for each time, the value; NaN if there is none.
    pub values: Vec<Vec<f32>>,
    /// For each time, the mode's number.
    pub modes: Vec<u16>,
}

/// An event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Happened {
    /// s.
    pub time: f64,
    /// The number of its transition's label.
    pub transition: usize,
    /// The number of the agent.
    pub agent: usize,
    /// The other participant of an interaction.
    pub other: Option<usize>,
    /// The numbers of the paths of the mode that is left and of the one that is entered.
    pub modes: Option<(usize, usize)>,
}

impl<'a> Recording<'a> {
    /// Nothing yet. Modes have the numbers of the leaves of the diagrams, which are those of their colours.
    pub fn new(cast: &'a Cast, diagrams: &[Diagram], record: usize) -> Self {
        let mut numbers = BTreeMap::new();
        let mut modes = Vec::new();
        for (ty, diagram) in diagrams.iter().enumerate() {
            for leaf in diagram.boxes.iter().filter(|shown| shown.children.is_empty()) {
                numbers.insert((ty, leaf.path.clone()), u16::try_from(modes.len()).unwrap_or(u16::MAX));
                modes.push(match (diagrams.len(), leaf.path.as_str()) {
                    (_, "") => diagram.name.clone(),
                    (1, path) => path.into(),
                    (_, path) => format!("{}: {path}", diagram.name),
                });
            }
        }
        let (times, tracks, events, transitions, paths) = Default::default();
        Self { cast, record, numbers, modes, times, tracks, events, n_events: 0, transitions, paths }
    }

    /// Gives every track a value for every time.
    pub fn close(&mut self) {
        let n = self.times.len();
        for track in &mut self.tracks {
            track.fill(n);
        }
    }

    /// The track of an agent; those of agents with lower numbers that have not been met have no values yet.
    fn track(&mut self, agent: Who, n_columns: usize) -> &mut Track {
        while self.tracks.len() <= agent.number {
            let who = Who { number: self.tracks.len(), ..agent };
            let name = self.cast.agent(who).into_owned();
            let values = vec![Vec::new(); n_columns];
            self.tracks.push(Track { name, values, modes: Vec::new() });
        }
        let track = &mut self.tracks[agent.number];
        if track.modes.is_empty() {
            track.name = self.cast.agent(agent).into_owned();
        }
        track
    }
}

impl Track {
    fn fill(&mut self, n: usize) {
        for values in &mut self.values {
            values.resize(n, f32::NAN);
        }
        self.modes.resize(n, u16::MAX);
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
            let (time, agent) = (event.time, event.agent.number);
            let other = event.other.map(|other| other.number);
            self.events.push(Happened { time, transition, agent, other, modes });
        }
        Ok(())
    }

    fn sample(&mut self, record: usize, row: &Row<'_>) -> io::Result<()> {
        if record != self.record || row.agent.number >= TRACKS_MAX {
            return Ok(());
        }
        if self.times.last() != Some(&row.time) {
            self.times.push(row.time);
        }
        let n = self.times.len();
        let ty = row.agent.ty;
        let mode = self.numbers.get(&(ty, row.mode.to_string())).copied().unwrap_or(u16::MAX);
        let track = self.track(row.agent, row.cells.len());
        track.fill(n - 1);
        track.modes.push(mode);
        for (values, cell) in track.values.iter_mut().zip(row.cells) {
            values.push(match *cell {
                Cell::Number(value) => value as f32,
                Cell::Bool(value) => f32::from(u8::from(value)),
                Cell::Empty | Cell::Agent(_) => f32::NAN,
            });
        }
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
