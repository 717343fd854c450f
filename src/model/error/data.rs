//! Failures of constants, of the command line's values, of `system` with its data files, of `run`; and the limits.

use super::{advised, with_similar, with_similar_or};
use crate::base::{Diagnostic, Span};
use crate::model::foreign;

/// What is wrong with a value from the command line.
pub(in crate::model) enum OverrideError {
    /// `-p` names no parameter.
    Unknown { name: String, span: Span, similar: Option<String>, other: Option<Span> },
    /// `-p` gives a value that the parameter cannot take.
    Bad { name: String, expected: &'static str, span: Span, declared: Span },
}

impl From<OverrideError> for Diagnostic {
    fn from(error: OverrideError) -> Self {
        match error {
            OverrideError::Unknown { name, span, similar, other } => {
                let unknown = Diagnostic::error("HY0260", format!("the model has no parameter `{name}`"))
                    .label(span, "given by `-p`");
                match other {
                    Some(declared) => unknown
                        .label(declared, "not a `param`")
                        .help(format!("declare it `param {name} = ...` to set it from the command line")),
                    None => with_similar(unknown, &similar),
                }
            }
            OverrideError::Bad { name, expected, span, declared } => {
                Diagnostic::error("HY0261", format!("the value of `{name}` must be {expected}"))
                    .label(span, format!("not {expected}"))
                    .label(declared, "declared here")
            }
        }
    }
}

/// What is wrong with a constant or an initial value.
pub(in crate::model) enum ValueError {
    /// Something that must be known now reads time or agents.
    NotConstant { what: String, span: Span },
    /// Not a number, or infinite where that is impossible.
    NotFinite { what: String, value: f64, span: Span },
    /// An initial value or a default reads something that is not there yet.
    NotInitial { what: String, read: &'static str, span: Span },
    /// A count that is not a whole number, or negative.
    BadCount { value: f64, span: Span },
    /// `~` before something that is no distribution.
    NotADistribution { span: Span },
    /// A parameter that its distribution cannot have.
    BadDraw { parameter: String, needs: &'static str, value: f64, variable: String, span: Span },
}

impl From<ValueError> for Diagnostic {
    fn from(error: ValueError) -> Self {
        match error {
            ValueError::NotConstant { what, span } => {
                Diagnostic::error("HY0262", format!("{what} must be a constant"))
                    .label(span, "reads time or an agent")
                    .help("it is worked out once, before the run: it may read `param`s and constant `let`s")
            }
            ValueError::NotFinite { what, value, span } => {
                Diagnostic::error("HY0263", format!("{what} is {}", in_words(value)))
                    .label(span, "worked out here")
            }
            ValueError::NotInitial { what, read, span } => {
                Diagnostic::error("HY0264", format!("{what} cannot read {read}"))
                    .label(span, "not known while the agent is made")
                    .help("it may read parameters, `index` and the agent's other initial values")
            }
            ValueError::BadCount { value, span } => {
                Diagnostic::error("HY0265", "the size of an array must be a whole number from 0 on")
                    .label(span, format!("this is {value}"))
                    .help("write a whole number, or say how it becomes whole: `round`, `floor` or `ceil`")
            }
            ValueError::NotADistribution { span } => Diagnostic::error(
                "HY0278",
                "a distribution must stand behind `~`",
            )
            .label(span, "this is none")
            .help(
                "write `Uniform(a, b)`, `Normal(mean, sd)` or `Exponential(rate)`; a value is given by `=`",
            ),
            ValueError::BadDraw { parameter, needs, value, variable, span } => {
                Diagnostic::error("HY0279", format!("{parameter} must be {needs}"))
                    .label(span, format!("this is {value} where `{variable}` is drawn"))
            }
        }
    }
}

/// What is wrong with an agent that `system` makes.
pub(in crate::model) enum SystemError {
    /// No value for something without a default.
    Missing { kind: &'static str, name: String, agent: String, span: Span, declared: Span },
    /// An argument that the agent type has no place for.
    UnknownArgument { name: String, agent: String, span: Span, similar: Option<String>, is_let: bool },
    /// An argument for a link that has an expression.
    FollowsLink { name: String, span: Span },
    /// Two values for one variable.
    GivenTwice { name: String, span: Span, first: Span, help: &'static str },
    /// An index beyond its array.
    OutOfRange { array: String, count: usize, index: f64, instance: String, help: String, span: Span },
    /// A parameter of agent type that turns out to be none.
    RequiredNone { name: String, instance: String, span: Span },
    /// `Car[]` without a data file.
    NoRows { agent: String, span: Span },
    /// Something that names no agent.
    NotAnInstance { span: Span, found: String, similar: Option<String> },
}

impl From<SystemError> for Diagnostic {
    fn from(error: SystemError) -> Self {
        match error {
            SystemError::Missing { kind, name, agent, span, declared } => {
                Diagnostic::error("HY0266", format!("`{agent}` needs a value for its {kind} `{name}`"))
                    .label(span, format!("no `{name}` here"))
                    .label(declared, "declared without a value")
                    .help(format!("write `{agent}({name} = ...)`, or give it a value where it is declared"))
            }
            SystemError::UnknownArgument { name, agent, span, similar, is_let } => {
                let unknown = Diagnostic::error(
                    "HY0267",
                    format!("agent `{agent}` has nothing to set called `{name}`"),
                )
                .label(span, "not a parameter, a state, a discrete variable or a link");
                if is_let {
                    return unknown.help(format!("`{name}` is a `let`: it follows from other values"));
                }
                with_similar_or(
                    unknown,
                    &similar,
                    format!("declare `{name}` in `agent {agent}`, or leave it out here"),
                )
            }
            SystemError::FollowsLink { name, span } => {
                Diagnostic::error("HY0258", format!("`{name}` follows from its own expression"))
                    .label(span, "given here all the same")
                    .help("leave it out, or declare the link without an expression")
            }
            SystemError::GivenTwice { name, span, first, help } => {
                Diagnostic::error("HY0268", format!("`{name}` is given twice"))
                    .label(span, "the second time")
                    .label(first, "the first time")
                    .help(help)
            }
            SystemError::OutOfRange { array, count, index, instance, help, span } => {
                let title = format!("`{array}[{index}]` does not exist, for `{instance}`");
                Diagnostic::error("HY0269", title)
                    .label(span, format!("`{array}` has {count} agents, numbered from 0"))
                    .help(help)
            }
            SystemError::RequiredNone { name, instance, span } => {
                Diagnostic::error("HY0270", format!("`{name}` of `{instance}` is none"))
                    .label(span, "none here")
                    .help("a parameter of agent type is never none; what may be none is declared as a `link`")
            }
            SystemError::NoRows { agent, span } => {
                Diagnostic::error("HY0277", format!("`{agent}[]` has no data file to count its rows"))
                    .label(span, "how many?")
                    .help(format!("write `{agent}[10]`, or `{agent}[] from csv(\"file.csv\")`"))
            }
            SystemError::NotAnInstance { span, found, similar } => with_similar(
                Diagnostic::error("HY0271", "an agent of `system` is needed")
                    .label(span, format!("this is {found}")),
                &similar,
            ),
        }
    }
}

/// What is wrong with a `table`.
pub(in crate::model) enum TableError {
    /// The file has no such column.
    NoColumn { name: String, file: String, span: Span, similar: Option<String> },
    /// Nothing but a header line.
    NoRows { span: Span, used: Span },
    /// The first column does not rise from row to row.
    NotRising { span: Span, first: Span, used: Span },
}

impl From<TableError> for Diagnostic {
    fn from(error: TableError) -> Self {
        match error {
            TableError::NoColumn { name, file, span, similar } => with_similar_or(
                Diagnostic::error("HY0286", format!("`{file}` has no column `{name}`"))
                    .label(span, "in no place of its header line"),
                &similar,
                "columns are called what the first line of the file calls them",
            ),
            TableError::NoRows { span, used } => Diagnostic::error("HY0287", "a table without rows")
                .label(span, "nothing follows")
                .label(used, "read here"),
            TableError::NotRising { span, first, used } => {
                Diagnostic::error("HY0288", "the first column of a table must rise from row to row")
                    .label(span, "not above the one before")
                    .label(first, "the one before")
                    .label(used, "read here")
                    .help("sort the rows; of two values at one place write the second a little later")
            }
        }
    }
}

/// What is wrong with a data file.
pub(in crate::model) enum FileError {
    /// A file that cannot be read.
    Unreadable { path: String, why: String, span: Span },
    /// Not a CSV file.
    Malformed { why: String, span: Span },
    /// A column that matches nothing.
    UnknownColumn { name: String, agent: String, span: Span, similar: Option<String>, used: Span },
    /// Fewer rows than agents.
    TooFewRows { needed: usize, found: usize, span: Span, used: Span },
    /// A cell that is empty, or no value of its variable's type; what is in it, in words.
    BadCell { column: String, expected: &'static str, found: String, span: Span },
    /// Two columns of one name.
    ColumnTwice { name: String, span: Span, first: Span },
    /// A row with more or fewer cells than the header line has names.
    Ragged { found: usize, named: usize, span: Span },
}

impl From<FileError> for Diagnostic {
    fn from(error: FileError) -> Self {
        match error {
            FileError::Unreadable { path, why, span } => {
                Diagnostic::error("HY0272", format!("cannot read `{path}`: {why}"))
                    .label(span, "named here")
                    .help("paths are relative to the model file")
            }
            FileError::Malformed { why, span } => {
                Diagnostic::error("HY0273", format!("not a CSV file with a header line: {why}"))
                    .label(span, "here")
            }
            FileError::UnknownColumn { name, agent, span, similar, used } => {
                let title = match name.as_str() {
                    "" => "a column has no name".to_string(),
                    name => format!("agent `{agent}` has no place for column `{name}`"),
                };
                let unknown = Diagnostic::error("HY0274", title)
                    .label(span, "not a parameter, a state or a discrete variable")
                    .label(used, "the data is used here");
                match similar {
                    Some(similar) => unknown.help(format!("did you mean `{similar}`?")),
                    None if name.contains([';', '\t']) => unknown.help("separate columns by commas"),
                    None => unknown.help(format!("a column that begins with `_` is passed over: `_{name}`")),
                }
            }
            FileError::ColumnTwice { name, span, first } => {
                Diagnostic::error("HY0284", format!("two columns are called `{name}`"))
                    .label(span, "the second one")
                    .label(first, "the first one")
                    .help(format!("a column that begins with `_` is passed over: `_{name}`"))
            }
            FileError::Ragged { found, named, span } => {
                let cells = if found == 1 { "1 cell".to_string() } else { format!("{found} cells") };
                Diagnostic::error("HY0285", format!("a row has {cells}, and the header line names {named}"))
                    .label(span, if found > named { "more than the header names" } else { "too few" })
                    .help("write one cell for each column; numbers have a point, not a comma")
            }
            FileError::TooFewRows { needed, found, span, used } => Diagnostic::error(
                "HY0275",
                format!("{needed} agents need {needed} rows, and there are {found}"),
            )
            .label(used, format!("{needed} agents"))
            .label(span, "the last row")
            .help("empty brackets make one agent for each row: `Car[] from csv(...)`"),
            FileError::BadCell { column, expected, found, span } => {
                Diagnostic::error("HY0276", format!("column `{column}` needs {expected} in every row"))
                    .label(span, found)
                    .help("write a value in every row; of what a column leaves out there is none")
            }
        }
    }
}

/// A limit that the model exceeds.
pub(in crate::model) enum LimitError {
    /// More agents than the limit.
    Agents { count: f64, most: usize, span: Span },
    /// More numbers than the limit.
    Values { what: &'static str, most: usize, span: Span },
    /// More states of one agent type than the limit.
    States { agent: String, most: usize, span: Span },
    /// More modes of one agent type than the limit.
    Modes { agent: String, most: usize, span: Span },
    /// More combinations of modes of the regions of an agent type than the limit.
    Configurations { agent: String, count: usize, most: usize, span: Span },
    /// More rows of a table than the limit.
    TableRows { most: usize, span: Span },
    /// A set that is more than an expression can reach.
    Reached { count: usize, most: usize, span: Span },
    /// More cells of one sample than the limit.
    Cells { most: usize, span: Span },
    /// More samples of a record than the limit.
    Samples { most: u64, span: Span },
    /// Constants that take too long.
    Steps { span: Span },
    /// Definitions that are looked up inside each other, many deep.
    Depth { span: Span },
}

impl From<LimitError> for Diagnostic {
    fn from(error: LimitError) -> Self {
        match error {
            LimitError::Agents { count, most, span } => {
                Diagnostic::error("HY0291", format!("{count} agents are more than the limit of {most}"))
                    .label(span, "too many")
                    .help(raise("max_agents"))
            }
            LimitError::Values { what, most, span } => {
                Diagnostic::error("HY0296", format!("more than {most} numbers {what}"))
                    .label(span, "too many, with what comes before")
                    .help(raise("max_values"))
            }
            LimitError::States { agent, most, span } => {
                Diagnostic::error("HY0297", format!("`{agent}` has more than {most} states"))
                    .label(span, "one too many")
                    .help(raise("max_states"))
            }
            LimitError::Modes { agent, most, span } => {
                Diagnostic::error("HY0298", format!("`{agent}` has more than {most} modes"))
                    .label(span, "one too many")
                    .help(raise("max_modes"))
            }
            LimitError::Configurations { agent, count, most, span } => {
                let title = format!("the regions of `{agent}` have {count} combinations of modes, more than {most}");
                Diagnostic::error("HY0293", title)
                    .label(span, "each combination has equations of its own")
                    .help(raise("max_configurations"))
            }
            LimitError::TableRows { most, span } => {
                Diagnostic::error("HY0289", format!("a table of more than {most} rows"))
                    .label(span, "each row is a kink of what reads it")
                    .help(raise("max_table_rows"))
            }
            LimitError::Reached { count, most, span } => {
                Diagnostic::error("HY0304", "an expression that reaches too many agents")
                    .label(span, format!("{count} of a set, those who may join it included"))
                    .note(format!("the limit is {most} agents bound by quantifiers or reached by links"))
                    .help("range over fewer agents, or read what a `discrete` keeps of them")
            }
            LimitError::Cells { most, span } => {
                Diagnostic::error("HY0299", format!("a sample of more than {most} cells"))
                    .label(span, "agents times variables")
                    .help(raise("max_cells"))
            }
            LimitError::Samples { most, span } => {
                Diagnostic::error("HY0535", format!("a record of more than {most} samples"))
                    .label(span, "so many of this length up to the end of the run")
                    .help(format!("write a longer time behind `every`; {}", raise("max_samples")))
            }
            LimitError::Steps { span } => {
                Diagnostic::error("HY0292", "the constants of this model take too long to work out")
                    .label(span, "gave up here")
                    .help("functions that call each other twice or more double the work at every level; or raise the limit: `--limit max_evaluations=N`")
            }
            LimitError::Depth { span } => {
                Diagnostic::error("HY0294", "this is defined through too many other definitions")
                    .label(span, "gave up here")
                    .help("split the definition, or define what is read before what reads it")
            }
        }
    }
}

/// How a limit is raised.
fn raise(name: &str) -> String {
    format!("if it is meant so, raise the limit: `--limit {name}=N`")
}

fn in_words(value: f64) -> &'static str {
    if value.is_nan() { "not a number (NaN)" } else { "infinite" }
}

/// What is wrong with `run`.
pub(in crate::model) enum RunError {
    /// No such setting.
    Unknown { name: String, span: Span, similar: Option<String> },
    /// A value that the setting cannot take.
    OutOfRange { name: String, needs: &'static str, found: String, span: Span },
    /// Set twice.
    Twice { name: String, span: Span, first: Span },
    /// A step size, which no model contains.
    StepSize { name: String, span: Span },
    /// Something that has nothing to record.
    NotRecordable { found: String, span: Span, similar: Option<String> },
    /// A column whose numbers would be in two units: those of two types, by their names, with the units that these declare, if any; and
    /// whether one unit would do for both.
    TwoUnits { column: String, sides: [(String, Option<String>, Span); 2], one_kind: bool },
}

impl From<RunError> for Diagnostic {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Unknown { name, span, similar } => {
                let unknown = Diagnostic::error("HY0280", format!("`run` has no setting `{name}`"))
                    .label(span, "not known")
                    .help("among the settings are `until`, `tolerance`, `seed`, `record` and `events`");
                advised(unknown, &name, foreign::setting(&name), &similar)
            }
            RunError::StepSize { name, span } => {
                Diagnostic::error("HY0280", format!("a model contains no step size, and so no `{name}`"))
                    .label(span, "steps are the engine's")
                    .help("steps follow from `tolerance`, and events are located whatever the steps; rows at fixed times are `record ... every d`")
            }
            RunError::OutOfRange { name, needs, found, span } => {
                Diagnostic::error("HY0281", format!("`{name}` must be {needs}"))
                    .label(span, format!("this is {found}"))
            }
            RunError::Twice { name, span, first } => {
                Diagnostic::error("HY0282", format!("`{name}` is set twice"))
                    .label(span, "the second time")
                    .label(first, "the first time")
                    .help("leave one of them out")
            }
            RunError::NotRecordable { found, span, similar } => {
                let unknown = Diagnostic::error("HY0283", format!("{found} cannot be recorded"))
                    .label(span, "not an agent, an agent type, or a variable of one");
                match similar {
                    Some(similar) => unknown.help(format!("did you mean `{similar}`?")),
                    None => {
                        unknown.help("record `cars`, `cars[3]`, `Car`, or one variable: `cars.x`, `Car.x`")
                    }
                }
            }
            RunError::TwoUnits { column, sides: [first, second], one_kind } => {
                let told = |unit: &Option<String>| match unit {
                    Some(unit) => format!("in {unit}"),
                    None => "in SI, as it has no unit".to_string(),
                };
                let label = |(ty, unit, _): &(String, Option<String>, Span)| format!("`{ty}.{column}` is {}", told(unit));
                let (at_first, at_second) = (label(&first), label(&second));
                let otherwise = if one_kind { "declare both in one unit" } else { "name one of them otherwise" };
                let units = [&first, &second].map(|(_, unit, _)| unit.as_deref().unwrap_or("SI"));
                Diagnostic::error("HY0290", format!("the column `{column}` would have two units: {} and {}", units[0], units[1]))
                    .label(second.2, at_second)
                    .label(first.2, at_first)
                    .help(format!(
                        "record them to two files, `record {}.{column} to \"...\"` and `record {}.{column} to \"...\"`, or {otherwise}",
                        first.0, second.0
                    ))
            }
        }
    }
}
