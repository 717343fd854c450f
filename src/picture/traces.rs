//! What plots show: recorded variables of agents over time, their modes, and events.

use rustc_hash::FxHashMap;

use super::recording::Recording;

/// Lines of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Traces {
    /// The names of the variables.
    pub columns: Vec<String>,
    /// The agents in order.
    pub agents: Vec<Trace>,
    /// Names of modes.
    pub modes: Vec<String>,
    /// In the order of time: when, of which agent.
    pub events: Vec<(f64, usize)>,
}

/// The lines of one agent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Its name.
    pub name: String,
    /// s, not falling.
    pub times: Vec<f64>,
    /// For each column the values, NaN where there is none.
    pub values: Vec<Vec<f64>>,
    /// For each time the number of the mode; none for an agent without modes.
    pub modes: Vec<Option<usize>>,
}

impl Trace {
    /// The values of a column; none: the times.
    pub fn along(&self, column: Option<usize>) -> &[f64] {
        column.map_or(&self.times, |column| &self.values[column])
    }
}

/// The numbers of agents and modes by their names, while a table is read.
#[derive(Default)]
struct Numbers {
    agents: FxHashMap<String, usize>,
    modes: FxHashMap<String, usize>,
}

impl Traces {
    /// The lines of a recording that is closed; `columns` are the names of its columns.
    pub fn of(recording: &Recording<'_>, columns: &[String]) -> Self {
        let agents = recording.tracks.iter().map(|track| Trace {
            name: track.name.clone(),
            times: recording.times[track.first..][..track.modes.len()].to_vec(),
            values: track.values.clone(),
            modes: track
                .modes
                .iter()
                .map(|&mode| Some(usize::from(mode)).filter(|&mode| mode < recording.modes.len()))
                .collect(),
        });
        let events = recording.events.iter().flat_map(|event| {
            [Some(event.agent), event.other].into_iter().flatten().map(|agent| (event.time, agent))
        });
        Self {
            columns: columns.to_vec(),
            agents: agents.collect(),
            modes: recording.modes.clone(),
            events: events.collect(),
        }
    }

    /// The lines of a table: a trajectory, or an event log, which has no lines but events.
    ///
    /// # Errors
    ///
    /// What keeps the table from being one of these, in words.
    pub fn read(text: &str) -> Result<Self, String> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().map_err(|error| error.to_string())?.clone();
        let place = |name: &str| header.iter().position(|column| column == name);
        let (Some(time), Some(agent)) = (place("time"), place("agent")) else {
            return Err("it has no columns `time` and `agent`, as tables of `hyc run` have".into());
        };
        let fixed = ["time", "micro", "agent", "mode", "transition", "other", "from", "to"];
        let log = place("transition").is_some();
        let columns: Vec<usize> = match log {
            true => Vec::new(),
            false => (0..header.len()).filter(|&k| !fixed.contains(&&header[k])).collect(),
        };
        let mut traces =
            Self { columns: columns.iter().map(|&k| header[k].to_string()).collect(), ..Self::default() };
        let mut numbers = Numbers::default();
        for record in reader.records() {
            let record = record.map_err(|error| error.to_string())?;
            let line = record.position().map_or(0, csv::Position::line);
            let t: f64 =
                record[time].parse().map_err(|_| format!("line {line}: `{}` is no time", &record[time]))?;
            let place_of_agent = traces.agent(&mut numbers, &record[agent]);
            if log {
                traces.events.push((t, place_of_agent));
                if let Some(other) = place("other").filter(|&k| !record[k].is_empty()) {
                    let other = traces.agent(&mut numbers, &record[other]);
                    traces.events.push((t, other));
                }
                continue;
            }
            let mode = place("mode").map(|k| &record[k]).filter(|mode| !mode.is_empty());
            let mode = mode.map(|mode| traces.mode(&mut numbers, mode));
            let trace = &mut traces.agents[place_of_agent];
            trace.times.push(t);
            trace.modes.push(mode);
            for (values, &k) in trace.values.iter_mut().zip(&columns) {
                values.push(match &record[k] {
                    "true" => 1.0,
                    "false" => 0.0,
                    text => text.parse().unwrap_or(f64::NAN),
                });
            }
        }
        traces.drop_empty_columns();
        if log {
            // they come in the order of their first events
            traces.sort();
        }
        Ok(traces)
    }

    /// Has the events of a log marked, of the agents that are there.
    pub fn mark(&mut self, log: &Traces) {
        let places: FxHashMap<&str, usize> =
            self.agents.iter().enumerate().map(|(place, trace)| (trace.name.as_str(), place)).collect();
        let of_log = log.events.iter();
        let found = of_log.filter_map(|&(t, agent)| Some((t, *places.get(log.agents[agent].name.as_str())?)));
        self.events = found.collect();
    }

    fn agent(&mut self, numbers: &mut Numbers, name: &str) -> usize {
        if let Some(&number) = numbers.agents.get(name) {
            return number;
        }
        let values = vec![Vec::new(); self.columns.len()];
        self.agents.push(Trace { name: name.into(), values, ..Trace::default() });
        numbers.agents.insert(name.into(), self.agents.len() - 1);
        self.agents.len() - 1
    }

    fn mode(&mut self, numbers: &mut Numbers, name: &str) -> usize {
        if let Some(&number) = numbers.modes.get(name) {
            return number;
        }
        self.modes.push(name.into());
        numbers.modes.insert(name.into(), self.modes.len() - 1);
        self.modes.len() - 1
    }

    /// Puts agents in the order of their names, `cars[2]` before `cars[10]`.
    fn sort(&mut self) {
        let mut order: Vec<usize> = (0..self.agents.len()).collect();
        order.sort_by_cached_key(|&place| key_of(&self.agents[place].name));
        let mut place_of = vec![0; order.len()];
        for (place, &before) in order.iter().enumerate() {
            place_of[before] = place;
        }
        self.agents = order.iter().map(|&before| std::mem::take(&mut self.agents[before])).collect();
        self.events.iter_mut().for_each(|(_, agent)| *agent = place_of[*agent]);
    }

    /// Columns without a single number (links, say) cannot be drawn.
    fn drop_empty_columns(&mut self) {
        let drawn: Vec<bool> = (0..self.columns.len())
            .map(|k| self.agents.iter().any(|trace| trace.values[k].iter().any(|value| value.is_finite())))
            .collect();
        let mut keep = drawn.iter();
        self.columns.retain(|_| *keep.next().unwrap_or(&true));
        for trace in &mut self.agents {
            let mut keep = drawn.iter();
            trace.values.retain(|_| *keep.next().unwrap_or(&true));
        }
    }
}

/// A name up to its last number, that, and what stands behind it.
fn key_of(name: &str) -> (String, u64, String) {
    let up_to_number = name.trim_end_matches(|letter: char| !letter.is_ascii_digit());
    if up_to_number.is_empty() {
        return (name.into(), 0, String::new());
    }
    let before = up_to_number.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let number = up_to_number[before.len()..].parse().unwrap_or(0);
    (before.into(), number, name[up_to_number.len()..].into())
}
