//! Machine code in memory: compiles routines with Cranelift, and calls them.
//!
//! In: routines. Out: [`KernelCode`] and [`StepCode`], which keep the memory that they lie in alive.
//! Every function that the code can call is registered by address, Cranelift's fallbacks for roundings on old CPUs
//! too; nothing is looked up elsewhere.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use cranelift_codegen::ir::{ExternalName, LibCall};
use cranelift_codegen::settings::{self, Configurable};
use cranelift_codegen::{Context, FinalizedRelocTarget};
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{FuncId, Linkage, Module, default_libcall_names};
use rustc_hash::FxHashMap;

use crate::base::Diagnostic;
use crate::codegen::emit::Callee;
use crate::codegen::kernel::AgentView;
use crate::codegen::routine::{Kind, Routine};
use crate::codegen::step;
use crate::math::{Op, elementary};

/// Everything that was compiled.
#[derive(Debug)]
pub struct Code {
    /// By number of the function; none: interpreted.
    pub kernels: Vec<Option<KernelCode>>,
    /// The whole steps.
    pub steps: Vec<(step::Task, StepCode)>,
    /// Bytes of machine code.
    pub bytes: usize,
}

impl Code {
    /// No code: everything is interpreted.
    pub fn none(n_functions: usize) -> Self {
        let mut code = Self { kernels: Vec::new(), steps: Vec::new(), bytes: 0 };
        code.kernels.resize_with(n_functions, || None);
        code
    }
}

/// Compiles routines; `n_functions` is how many functions the system has.
pub fn assemble(routines: &[Routine<'_>], n_functions: usize) -> Result<Code, Diagnostic> {
    let mut module = JITModule::new(builder()?);
    let callees = declare_callees(&mut module)?;
    let mut bytes = 0;
    let mut ids = Vec::with_capacity(routines.len());
    for routine in routines {
        let (id, size) = define(&mut module, &callees, routine)?;
        ids.push(id);
        bytes += size;
    }
    module.finalize_definitions().map_err(|error| refused("the program", &error))?;

    let starts: Vec<*const u8> = ids.iter().map(|&id| module.get_finalized_function(id)).collect();
    let memory = Arc::new(Memory(Mutex::new(Some(module))));
    let mut code = Code { bytes, ..Code::none(n_functions) };
    for (routine, start) in routines.iter().zip(starts) {
        match routine.kind {
            Kind::Kernel { function } => {
                // SAFETY: the routine's signature is that of `KernelEntry`, and the memory stays as it is from now on.
                let entry = unsafe { std::mem::transmute::<*const u8, KernelEntry>(start) };
                code.kernels[function] = Some(KernelCode { entry, _memory: Arc::clone(&memory) });
            }
            Kind::Step(task) => {
                // SAFETY: the routine's signature is that of `StepEntry`, and the memory stays as it is from now on.
                let entry = unsafe { std::mem::transmute::<*const u8, StepEntry>(start) };
                code.steps.push((task, StepCode { entry, _memory: Arc::clone(&memory) }));
            }
        }
    }
    Ok(code)
}

/// Cranelift for this host, with all functions that code may call.
fn builder() -> Result<JITBuilder, Diagnostic> {
    let mut flags = settings::builder();
    let choices = [
        ("opt_level", "speed"),
        ("is_pic", "false"),
        ("use_colocated_libcalls", "false"),
        ("enable_probestack", "true"),
        ("probestack_strategy", "inline"),
        ("enable_verifier", if cfg!(debug_assertions) { "true" } else { "false" }),
    ];
    for (name, value) in choices {
        flags.set(name, value).map_err(|error| unsupported(&error))?;
    }
    let isa = cranelift_native::builder().map_err(|reason| unsupported(&reason))?;
    let isa = isa.finish(settings::Flags::new(flags)).map_err(|error| unsupported(&error))?;
    let mut builder = JITBuilder::with_isa(isa, default_libcall_names());
    for (callee, address) in callees() {
        builder.symbol(symbol(callee), address);
    }
    for (libcall, op) in ROUNDINGS {
        let address = address(op).expect("the roundings have functions");
        builder.symbol(default_libcall_names()(libcall), address);
    }
    Ok(builder)
}

/// What Cranelift calls on CPUs without instructions for it.
const ROUNDINGS: [(LibCall, Op); 3] =
    [(LibCall::FloorF64, Op::Floor), (LibCall::CeilF64, Op::Ceil), (LibCall::TruncF64, Op::Trunc)];

/// The function of an operator, for those that have one.
fn address(op: Op) -> Option<*const u8> {
    let unary = op.unary_fn().map(|function| function as *const u8);
    unary.or_else(|| op.binary_fn().map(|function| function as *const u8))
}

/// Everything that code can call, with its address.
fn callees() -> impl Iterator<Item = (Callee, *const u8)> {
    let operators = Op::ALL.iter().filter_map(|&op| Some((Callee::Operator(op), address(op)?)));
    operators.chain([(Callee::SinCos, sin_cos as *const u8)])
}

/// [`elementary::sin_cos`] behind C's calling convention.
extern "C" fn sin_cos(x: f64, cosine: &mut f64) -> f64 {
    let sine;
    (sine, *cosine) = elementary::sin_cos(x);
    sine
}

/// The name under which a function is registered.
fn symbol(callee: Callee) -> String {
    format!("hyc_{}", callee.name())
}

/// Makes all functions that code can call known to the module.
fn declare_callees(module: &mut JITModule) -> Result<FxHashMap<Callee, FuncId>, Diagnostic> {
    let call_conv = module.isa().default_call_conv();
    let mut ids = FxHashMap::default();
    for (callee, _) in callees() {
        let id = module.declare_function(&symbol(callee), Linkage::Import, &callee.signature(call_conv));
        ids.insert(callee, id.map_err(|error| refused(callee.name(), &error))?);
    }
    Ok(ids)
}

/// Compiles one routine; also returns its size in bytes.
fn define(
    module: &mut JITModule,
    callees: &FxHashMap<Callee, FuncId>,
    routine: &Routine<'_>,
) -> Result<(FuncId, usize), Diagnostic> {
    let signature = routine.signature(module.isa().default_call_conv());
    let id = module.declare_anonymous_function(&signature).map_err(|error| refused(routine.name, &error))?;
    let mut context = Context::new();
    context.func.signature = signature;
    routine.build(&mut context.func, &mut |callee, function| {
        let id = callees.get(&callee).expect("every operator that is called has a function");
        module.declare_func_in_func(*id, function)
    });
    module.define_function(id, &mut context).map_err(|error| refused(routine.name, &error))?;
    let compiled = context.compiled_code().expect("the function was just compiled");
    for reloc in compiled.buffer.relocs() {
        if let FinalizedRelocTarget::ExternalName(ExternalName::LibCall(libcall)) = reloc.target
            && !ROUNDINGS.iter().any(|(known, _)| *known == libcall)
        {
            return Err(refused(routine.name, &format!("it would call `{libcall}`")));
        }
    }
    Ok((id, compiled.code_info().total_size as usize))
}

/// HY0401: there is no compiler for this machine.
fn unsupported(reason: &dyn fmt::Display) -> Diagnostic {
    Diagnostic::error("HY0401", "machine code cannot be made on this machine")
        .note(format!("Cranelift says: {reason}"))
        .help("use the interpreter: `--backend interp` gives the same results")
}

/// HY0402: the compiler refused a function.
fn refused(name: &str, reason: &dyn fmt::Display) -> Diagnostic {
    Diagnostic::error("HY0402", format!("machine code for `{name}` could not be made"))
        .note(format!("Cranelift says: {reason}"))
        .help("use the interpreter: `--backend interp` gives the same results")
}

/// The memory that code lies in; freed with the last kernel that points into it.
struct Memory(Mutex<Option<JITModule>>);

impl fmt::Debug for Memory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Memory")
    }
}

impl Drop for Memory {
    fn drop(&mut self) {
        if let Some(module) = self.0.get_mut().unwrap_or_else(PoisonError::into_inner).take() {
            // SAFETY: whoever could call the code held an `Arc` of this memory, and no one does any more.
            unsafe { module.free_memory() };
        }
    }
}

/// Pointers to the rows of the agent in a slot, in the order of `Row`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct Rows {
    states: *const f64,
    rates: *const f64,
    accelerations: *const f64,
    aux: *const f64,
}

impl Rows {
    #[inline]
    fn of(agent: &AgentView<'_>) -> Self {
        Self {
            states: agent.states.as_ptr(),
            rates: agent.rates.as_ptr(),
            accelerations: agent.accelerations.as_ptr(),
            aux: agent.aux.as_ptr(),
        }
    }
}

/// Calls with a table of at least `n_slots` slots, of which there are at least so many.
#[inline]
fn with_table(n_slots: usize, slots: &[AgentView<'_>], call: impl FnOnce(*const Rows)) {
    match n_slots {
        0 => call(std::ptr::null()),
        1 => call(table::<1>(slots).as_ptr()),
        2 => call(table::<2>(slots).as_ptr()),
        3..=4 => call(table::<4>(slots).as_ptr()),
        5..=16 => call(table::<16>(slots).as_ptr()),
        _ => call(slots[..n_slots].iter().map(Rows::of).collect::<Vec<_>>().as_ptr()),
    }
}

/// A table on the stack; slots that are not there repeat the first.
#[inline]
fn table<const N: usize>(slots: &[AgentView<'_>]) -> [Rows; N] {
    std::array::from_fn(|slot| Rows::of(slots.get(slot).unwrap_or(&slots[0])))
}

/// Machine code of a kernel: table, time, out.
type KernelEntry = unsafe extern "C" fn(*const Rows, f64, *mut f64);

/// Machine code of a step: table, time, h, k, x_new, err.
type StepEntry = unsafe extern "C" fn(*const Rows, f64, f64, *mut f64, *mut f64, *mut f64);

/// Machine code of a kernel.
#[derive(Clone, Debug)]
pub struct KernelCode {
    entry: KernelEntry,
    _memory: Arc<Memory>,
}

impl KernelCode {
    /// Runs it on the first `n_slots` of `slots`.
    ///
    /// # Safety
    ///
    /// There are at least `n_slots` slots, as many as the tape reads, with all columns that it reads, and `out` is as
    /// long as its outputs are many.
    #[inline]
    pub unsafe fn call(&self, n_slots: usize, slots: &[AgentView<'_>], time: f64, out: &mut [f64]) {
        // SAFETY: the code reads the columns of its tape through the table, writes its outputs, and nothing else.
        with_table(n_slots, slots, |table| unsafe { (self.entry)(table, time, out.as_mut_ptr()) });
    }
}

/// Machine code of a step.
#[derive(Clone, Debug)]
pub struct StepCode {
    entry: StepEntry,
    _memory: Arc<Memory>,
}

/// Where a step reads and writes: rates of the stages, new states, errors.
#[derive(Debug)]
pub struct StepRows<'a> {
    /// 7 n rates.
    pub k: &'a mut [f64],
    /// n new states.
    pub x_new: &'a mut [f64],
    /// n errors.
    pub err: &'a mut [f64],
}

impl StepCode {
    /// Runs it on the first `n_slots` of `slots`.
    ///
    /// # Safety
    ///
    /// As for [`KernelCode::call`]; slot 0 holds n states, and the rows are as long as [`StepRows`] says.
    #[inline]
    pub unsafe fn call(
        &self,
        n_slots: usize,
        slots: &[AgentView<'_>],
        time: f64,
        h: f64,
        rows: StepRows<'_>,
    ) {
        let StepRows { k, x_new, err } = rows;
        with_table(n_slots, slots, |table| {
            // SAFETY: the code reads the columns of its tape, the states and k through these pointers, and writes k,
            // x_new and err, nothing else.
            unsafe { (self.entry)(table, time, h, k.as_mut_ptr(), x_new.as_mut_ptr(), err.as_mut_ptr()) }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::{refused, unsupported};

    /// No model and no machine at hand makes these: they are made here.
    #[test]
    fn what_cranelift_refuses_points_to_the_interpreter() {
        insta::assert_debug_snapshot!([
            unsupported(&"support for this target is not implemented"),
            refused("Car.Drive flow", &"the function is too large"),
        ]);
    }
}
