//! The bumper arena of `models/bumper.hy` for any number of cars, seed and spread of time scales, and the other models, through
//! the doors of the library.
//!
//! `masim` is run by `tsit5` here, whatever `auto` comes to; the algorithms of 2004 have Adams' method only.

use std::io;

use hyc::base::SourceMap;
use hyc::codegen::program::Program;
use hyc::codegen::{self, Backend};
use hyc::model::ir::Integrator;
use hyc::model::{Files, Settings};

/// The ratio of the fastest to the slowest weaving that the benchmark has.
pub const SPREAD: f64 = 40.0;

/// The cars of the benchmark as the model's data file: `n` of them, drawn by SplitMix64 from `seed`.
///
/// v is log-uniform in [0.2, 2], w log-uniform in an interval with ends in the ratio `spread` (40: [0.5, 20]), p and th
/// are uniform in [0, 2 pi), each car is within 3 of the middle of a cell of its own, of 10 by 10.
pub fn cars(n: usize, seed: u64, spread: f64) -> String {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(n as u64);
    let mut uniform = || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    let m = (1..).find(|m| m * m >= n).unwrap_or(1);
    let mut text = String::from("i,x,y,th,v,w,p\n");
    for i in 0..n {
        let cell = |k: usize| (k as f64 + 0.5) * 10.0 - 5.0 * m as f64;
        let x = cell(i % m) + (uniform() * 6.0 - 3.0);
        let y = cell(i / m) + (uniform() * 6.0 - 3.0);
        let th = uniform() * 2.0 * std::f64::consts::PI;
        let v = 0.2 * 10f64.powf(uniform());
        let w = (10f64 / spread).sqrt() * spread.powf(uniform());
        let p = uniform() * 2.0 * std::f64::consts::PI;
        text += &format!("{i},{x:?},{y:?},{th:?},{v:?},{w:?},{p:?}\n");
    }
    text
}

/// A model with its only data file.
struct Data(String);

impl Files for Data {
    fn read(&mut self, _: &str) -> io::Result<Vec<u8>> {
        Ok(self.0.clone().into_bytes())
    }
}

/// Compiles a model, to be run by `tsit5`; what is wrong with it ends the process.
fn compile(text: &str, data: String, settings: Settings) -> Program {
    let settings = &Settings { integrator: Some(Integrator::Tsit5), ..settings };
    let mut sources = SourceMap::default();
    let file = sources.add("model.hy", text);
    let ast = hyc::syntax::parse(file, text).expect("the model is right");
    let checked = hyc::model::check(&ast, &mut sources, &mut Data(data), settings);
    let model = checked.model.unwrap_or_else(|| panic!("{:#?}", checked.diagnostics));
    let system = hyc::calculus::derive(&model).expect("the model has equations");
    codegen::compile(system, Backend::Jit).expect("the equations can be compiled")
}

/// The arena with `n` cars until `until`, s; with every accepted step recorded, if `record` says so.
pub fn bumper(n: usize, seed: u64, spread: f64, until: f64, record: bool) -> Program {
    let text = include_str!("../../models/bumper.hy");
    let params = vec![("N".into(), n.to_string())];
    let settings = Settings { params, until: Some(until), record_all: record, ..Settings::default() };
    compile(text, cars(n, seed, spread), settings)
}

/// One of the models with two cars, with every accepted step recorded.
pub fn two_cars(text: &str, until: f64) -> Program {
    let text = text.replace("record fast, slow every 0.05 [s]", "record fast, slow");
    compile(&text, String::new(), Settings { until: Some(until), ..Settings::default() })
}

/// A model without data, with some of its params given.
pub fn shipped(text: &str, params: &[(&str, String)]) -> Program {
    let params = params.iter().map(|(name, value)| (name.to_string(), value.clone())).collect();
    compile(text, String::new(), Settings { params, ..Settings::default() })
}
