//! Machine code that is made when it pays: when interpreting has cost about as much as making the code does.
//!
//! In: the routines of a program. Out: their [`Code`], from the evaluation on at which enough has been interpreted. Both give the
//! same bits, so that nobody can tell when that was; a short run ends before.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use crate::codegen::jit::{self, Code};
use crate::codegen::routine::{Kind, Routine};
use crate::codegen::step::Task;
use crate::codegen::tape::Tape;

/// How often an instruction is interpreted in the time that it takes to be compiled.
const WORTH: u64 = 1500;

/// Routines that have not been compiled, or have been at last.
#[derive(Debug)]
pub struct Later {
    routines: Vec<(String, Arc<Tape>, Kind)>,
    n_functions: usize,
    /// So many instructions are interpreted first.
    worth: u64,
    interpreted: AtomicU64,
    code: OnceLock<Code>,
}

impl Later {
    /// Nothing is compiled yet; `tapes` are those of all functions.
    pub fn new(routines: &[Routine<'_>], tapes: &[Arc<Tape>]) -> Self {
        let tape_of = |routine: &Routine<'_>| match routine.kind {
            Kind::Kernel { function } => function,
            Kind::Step(task) => task.function,
        };
        let own = |routine: &Routine<'_>| {
            (routine.name.to_string(), Arc::clone(&tapes[tape_of(routine)]), routine.kind)
        };
        let length: u64 = routines.iter().map(|routine| routine.tape.instructions.len() as u64).sum();
        Self {
            routines: routines.iter().map(own).collect(),
            n_functions: tapes.len(),
            worth: WORTH * length,
            interpreted: AtomicU64::new(0),
            code: OnceLock::new(),
        }
    }

    /// The code, if it has been made or is worth it now; if there is none, `length` instructions will be interpreted.
    #[inline]
    pub fn code(&self, length: usize) -> Option<&Code> {
        if let Some(code) = self.code.get() {
            return Some(code);
        }
        // Some may not be counted where threads meet, which does not matter.
        let interpreted = self.interpreted.load(Ordering::Relaxed) + length as u64;
        self.interpreted.store(interpreted, Ordering::Relaxed);
        (interpreted > self.worth).then(|| self.make())
    }

    /// The whole steps, in the order in which the code has them.
    pub fn steps(&self) -> impl Iterator<Item = Task> {
        self.routines.iter().filter_map(|(_, _, kind)| match *kind {
            Kind::Step(task) => Some(task),
            Kind::Kernel { .. } => None,
        })
    }

    /// The code, if it has been made.
    pub fn made(&self) -> Option<&Code> {
        self.code.get()
    }

    /// Where no code can be made, everything goes on being interpreted.
    #[cold]
    fn make(&self) -> &Code {
        let make = || {
            let routines: Vec<Routine<'_>> =
                self.routines.iter().map(|(name, tape, kind)| Routine { name, tape, kind: *kind }).collect();
            jit::assemble(&routines, self.n_functions).unwrap_or_else(|_| Code::none(self.n_functions))
        };
        self.code.get_or_init(make)
    }
}
