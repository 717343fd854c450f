//! Routines: which functions of machine code a program consists of, and how each is built.
//!
//! In: tapes. Out: a list of [`Routine`]s, and the Cranelift IR of each, which depends on nothing but the tape.

use std::sync::Arc;

use cranelift_codegen::ir::types::{F64, I64};
use cranelift_codegen::ir::{AbiParam, ExtFuncData, ExternalName, Function, Signature, UserFuncName};
use cranelift_codegen::isa::CallConv;
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};

use crate::base::Idx;
use crate::calculus::system::System;
use crate::codegen::emit::{Callee, Emitter, Import, Leaves};
use crate::codegen::step;
use crate::codegen::tape::Tape;

/// The longest tape that is compiled, in instructions; longer ones are interpreted, because the time that Cranelift
/// takes grows faster than the tape.
pub const KERNEL_LENGTH_MAX: usize = 20_000;

/// A function to be compiled.
#[derive(Clone, Copy, Debug)]
pub struct Routine<'p> {
    /// The function of the system that it serves, for listings.
    pub name: &'p str,
    /// What it computes, or what a step of it computes.
    pub tape: &'p Tape,
    /// What it is.
    pub kind: Kind,
}

/// What a routine is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The outputs of function number `function`: `(table, time, out)`.
    Kernel {
        /// Its number.
        function: usize,
    },
    /// A whole step: `(table, time, h, k, x_new, err)`.
    Step(step::Task),
}

/// All routines of a system, kernels first.
pub fn routines<'p>(system: &'p System, tapes: &'p [Arc<Tape>]) -> Vec<Routine<'p>> {
    let name = |function: usize| system.functions[Idx::new(function)].name.as_str();
    let short = tapes.iter().enumerate().filter(|(_, tape)| tape.instructions.len() <= KERNEL_LENGTH_MAX);
    let kernels =
        short.map(|(function, tape)| Routine { name: name(function), tape, kind: Kind::Kernel { function } });
    let tasks = step::plan(system, tapes).into_iter();
    let steps = tasks.map(|task| Routine {
        name: name(task.function),
        tape: &tapes[task.function],
        kind: Kind::Step(task),
    });
    kernels.chain(steps).collect()
}

impl Routine<'_> {
    /// What it takes.
    pub fn signature(&self, call_conv: CallConv) -> Signature {
        let mut signature = Signature::new(call_conv);
        let params: &[_] = match self.kind {
            Kind::Kernel { .. } => &[I64, F64, I64],
            Kind::Step(_) => &[I64, F64, F64, I64, I64, I64],
        };
        signature.params = params.iter().map(|&ty| AbiParam::new(ty)).collect();
        signature
    }

    /// Emits its body into `function`, which has its signature.
    pub fn build(&self, function: &mut Function, import: &mut Import<'_>) {
        let mut context = FunctionBuilderContext::new();
        let (mut emitter, params) = Emitter::new(FunctionBuilder::new(function, &mut context), import);
        match self.kind {
            Kind::Kernel { .. } => {
                let outputs = emitter.tape(self.tape, &Leaves { time: params[1], states: None });
                outputs.iter().enumerate().for_each(|(k, &output)| emitter.store(output, params[2], k));
            }
            Kind::Step(_) => step::emit(&mut emitter, &params, self.tape),
        }
        emitter.finish();
    }

    /// Its IR as text: the same on every host, before Cranelift's optimisations.
    pub fn listing(&self, number: usize) -> String {
        let call_conv = CallConv::SystemV;
        let name = UserFuncName::user(0, number as u32);
        let mut function = Function::with_name_signature(name, self.signature(call_conv));
        self.build(&mut function, &mut |callee, function| {
            let signature = function.import_signature(callee.signature(call_conv));
            let name = ExternalName::testcase(callee.name());
            function.import_function(ExtFuncData { name, signature, colocated: false, patchable: false })
        });
        let what = match self.kind {
            Kind::Kernel { .. } => "",
            Kind::Step(_) => ", a whole step",
        };
        format!("; {}{what}\n{}", self.name, function.display())
    }
}

impl Callee {
    /// Its name in listings.
    pub fn name(self) -> &'static str {
        match self {
            Callee::Operator(op) => op.name(),
            Callee::SinCos => "sin_cos",
        }
    }

    /// What it takes and returns.
    pub fn signature(self, call_conv: CallConv) -> Signature {
        let mut signature = Signature::new(call_conv);
        signature.params = match self {
            Callee::Operator(op) => vec![AbiParam::new(F64); op.arity()],
            Callee::SinCos => vec![AbiParam::new(F64), AbiParam::new(I64)],
        };
        signature.returns = vec![AbiParam::new(F64)];
        signature
    }
}
