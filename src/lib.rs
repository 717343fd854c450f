//! hyc: a language, a compiler and a simulator for multi-agent hybrid systems.
//!
//! One model travels through every floor, from the first below to the last:
//!
//! ```
//! use std::io;
//! use std::sync::atomic::AtomicBool;
//!
//! use hyc::base::SourceMap;
//! use hyc::codegen::Backend;
//! use hyc::model::{Files, Settings};
//! use hyc::runtime::Limits;
//! use hyc::runtime::observe::{Event, Observer};
//!
//! // What a model may read, and who is told what happens: the command line has files and terminals for these.
//! struct NoFiles;
//! impl Files for NoFiles {
//!     fn read(&mut self, path: &str) -> io::Result<Vec<u8>> {
//!         Err(io::Error::new(io::ErrorKind::NotFound, path.to_string()))
//!     }
//! }
//! #[derive(Default)]
//! struct Times(Vec<f64>);
//! impl Observer for Times {
//!     fn event(&mut self, event: &Event<'_>) -> io::Result<()> {
//!         self.0.push(event.time);
//!         Ok(())
//!     }
//! }
//!
//! let text = "agent Ball { state h = 1, v = 0  flow { h' = v  v' = -2 }  when h <= 0 { v := -v } }
//!             system { ball = Ball() }
//!             run { until 4 }";
//! let mut sources = SourceMap::default();
//! let file = sources.add("ball.hy", text);
//!
//! let tree = hyc::syntax::parse(file, text).expect("it follows the grammar");
//! let checked = hyc::model::check(&tree, &mut sources, &mut NoFiles, &Settings::default());
//! let model = checked.model.expect("its names and types are right");
//! let system = hyc::calculus::derive(&model).expect("its equations can be derived");
//! let program = hyc::codegen::compile(system, Backend::Jit).expect("it can be compiled");
//!
//! let mut times = Times::default();
//! hyc::runtime::simulate(&program, &Limits::default(), &AtomicBool::new(false), &mut times);
//! assert_eq!(times.0.len(), 2); // it falls for a second, and is back after two
//! assert!((times.0[0] - 1.0).abs() < 1e-9 && (times.0[1] - 3.0).abs() < 1e-9);
//! ```

pub mod base;
pub mod math;
pub mod syntax;
pub mod model;
pub mod calculus;
pub mod codegen;
pub mod runtime;
pub mod output;
pub mod picture;
pub mod cli;
