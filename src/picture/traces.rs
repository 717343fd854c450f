//! What plots show: recorded variables of agents over time, their modes, and events.

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

impl Traces {
    /// The lines of a recording that is closed; `columns` are the names of its columns.
    pub fn of(recording: &Recording<'_>, columns: &[String]) -> Self {
        let agents = recording.tracks.iter().map(|track| Trace {
            name: track.name.clone(),
            times: recording.times.clone(),
            values: track
                .values
                .iter()
                .map(|values| values.iter().copied().map(f64::from).collect())
                .collect(),
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
        for record in reader.records() {
            let record = record.map_err(|error| error.to_string())?;
            let line = record.position().map_or(0, csv::Position::line);
            let t: f64 =
                record[time].parse().map_err(|_| format!("line {line}: `{}` is no time", &record[time]))?;
            let place_of_agent = traces.agent(&record[agent]);
            if log {
                traces.events.push((t, place_of_agent));
                if let Some(other) = place("other").filter(|&k| !record[k].is_empty()) {
                    let other = traces.agent(&record[other]);
                    traces.events.push((t, other));
                }
                continue;
            }
            let mode = place("mode").map(|k| &record[k]).filter(|mode| !mode.is_empty());
            let mode = mode.map(|mode| traces.mode(mode));
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
        Ok(traces)
    }

    fn agent(&mut self, name: &str) -> usize {
        self.agents.iter().position(|trace| trace.name == name).unwrap_or_else(|| {
            let values = vec![Vec::new(); self.columns.len()];
            self.agents.push(Trace { name: name.into(), values, ..Trace::default() });
            self.agents.len() - 1
        })
    }

    fn mode(&mut self, name: &str) -> usize {
        self.modes.iter().position(|mode| mode == name).unwrap_or_else(|| {
            self.modes.push(name.into());
            self.modes.len() - 1
        })
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
