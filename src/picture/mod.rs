//! What a person looks at: mode diagrams, plots, and the page of a run.
//!
//! In: the diagrams of a model, and what the runtime tells an observer ([`Recording`]). Out: texts of pictures and pages. It
//! opens no file, and what it looks at it leaves as it is.

mod palette;
mod layered;
mod modes_dot;
mod modes_svg;
mod highlight;
mod recording;
mod page;
mod traces;
mod bitmap;
mod lines;
mod sheet;
mod legend;
mod plot;

pub use modes_dot::modes_dot;
pub use modes_svg::{Theme, modes_svg};
pub use page::{Landmarks, Lines, Scene, Shown, Text, Varies, page};
pub use plot::{Form, View, plot, ready_font};
pub use recording::{EVENTS_MAX, Happened, Recording, Track};
pub use traces::{Trace, Traces};
