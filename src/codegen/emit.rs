//! The emitter: translates a tape into Cranelift IR, instruction by instruction.
//!
//! In: a [`Tape`]. Out: one function without branches, with the bits of `Op::eval`. Cranelift contracts nothing into
//! a fused multiplication and its comparisons, roundings, `fmin` and `fmax` treat NaN and -0 as `Op::eval` does; what
//! it has no instruction for is called. Values are numbered while they are emitted, so that what a Runge-Kutta step
//! computes alike in every stage is computed once, calls included (Cranelift itself does not merge calls).
//!
//! A comparison stays a flag (an 8-bit integer) until it is needed as a number.

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::types::{F64, I8, I64};
use cranelift_codegen::ir::{
    FuncRef, Function, InstBuilder, MemFlagsData, StackSlot, StackSlotData, StackSlotKind, Value,
};
use cranelift_frontend::{FuncInstBuilder, FunctionBuilder};
use rustc_hash::FxHashMap;

use crate::codegen::tape::{Instruction, Row, Tape};
use crate::math::Op;

/// A function that code can call.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Callee {
    /// The function of an operator.
    Operator(Op),
    /// Sine, which also writes the cosine to an address: both share nearly all of their work, and many models need both.
    SinCos,
}

/// Finds or declares a function to be called.
pub type Import<'a> = dyn FnMut(Callee, &mut Function) -> FuncRef + 'a;

/// Bytes of a pointer, and of a number.
const WORD: i32 = 8;

/// Pointers in a row of the table that machine code is given: one for each [`Row`].
pub const N_ROWS: usize = 4;

/// A value, in the form in which it was computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operand {
    /// An f64.
    Number(Value),
    /// 1 or 0.
    Flag(Value),
}

/// What a tape's leaves mean at the place where it is emitted.
pub struct Leaves<'v> {
    /// The time.
    pub time: Value,
    /// The states of slot 0, where they are not those in memory.
    pub states: Option<&'v [Value]>,
}

/// A function being emitted.
pub struct Emitter<'f, 'i> {
    pub(super) builder: FunctionBuilder<'f>,
    import: &'i mut Import<'i>,
    /// The table of pointers to rows.
    table: Value,
    constants: FxHashMap<u64, Value>,
    rows: FxHashMap<(u32, Row), Value>,
    columns: FxHashMap<(u32, Row, u32), Value>,
    callees: FxHashMap<Callee, FuncRef>,
    /// Where cosines are written.
    cosine: Option<StackSlot>,
    applied: FxHashMap<(Op, [Operand; 3]), Operand>,
    numbers: FxHashMap<Value, Value>,
    flags: FxHashMap<Value, Value>,
}

impl<'f, 'i> Emitter<'f, 'i> {
    /// Opens the only block of a function whose first parameter is the table; returns the parameters too.
    pub fn new(mut builder: FunctionBuilder<'f>, import: &'i mut Import<'i>) -> (Self, Vec<Value>) {
        let block = builder.create_block();
        builder.append_block_params_for_function_params(block);
        builder.switch_to_block(block);
        builder.seal_block(block);
        let params = builder.block_params(block).to_vec();
        let emitter = Self {
            builder,
            import,
            table: params[0],
            constants: FxHashMap::default(),
            rows: FxHashMap::default(),
            columns: FxHashMap::default(),
            callees: FxHashMap::default(),
            cosine: None,
            applied: FxHashMap::default(),
            numbers: FxHashMap::default(),
            flags: FxHashMap::default(),
        };
        (emitter, params)
    }

    /// Ends the function. `FunctionBuilder::finalize` is left out: it only clears the builder's context for another.
    pub fn finish(mut self) {
        self.builder.ins().return_(&[]);
    }

    /// Emits a tape; returns its outputs.
    pub fn tape(&mut self, tape: &Tape, leaves: &Leaves<'_>) -> Vec<Value> {
        let constants = tape.constants.iter().map(|&value| Operand::Number(self.constant(value)));
        let mut registers: Vec<Operand> = constants.collect();
        registers.resize(tape.n_registers, Operand::Number(leaves.time));
        for instruction in &tape.instructions {
            match *instruction {
                Instruction::Time { to } => registers[to as usize] = Operand::Number(leaves.time),
                Instruction::Load { to, slot, row, column } => {
                    let given = leaves.states.filter(|_| slot == 0 && row == Row::States);
                    let value = given
                        .map_or_else(|| self.column(slot, row, column), |states| states[column as usize]);
                    registers[to as usize] = Operand::Number(value);
                }
                Instruction::Apply { to, op, operands } => {
                    let values = operands.map(|register| registers[register as usize]);
                    let exponent = tape.constant(operands[1]).filter(|_| op == Op::Powi);
                    registers[to as usize] = match exponent {
                        Some(exponent) => self.powi(values, exponent),
                        None => self.apply(op, values),
                    };
                }
            }
        }
        tape.outputs.iter().map(|&register| self.number(registers[register as usize])).collect()
    }

    /// A constant.
    pub fn constant(&mut self, value: f64) -> Value {
        let builder = &mut self.builder;
        *self.constants.entry(value.to_bits()).or_insert_with(|| builder.ins().f64const(value))
    }

    /// A column of the agent in a slot.
    pub fn column(&mut self, slot: u32, row: Row, column: u32) -> Value {
        if let Some(&value) = self.columns.get(&(slot, row, column)) {
            return value;
        }
        let flags = MemFlagsData::trusted().with_readonly();
        let (builder, table) = (&mut self.builder, self.table);
        let pointer = *self.rows.entry((slot, row)).or_insert_with(|| {
            let place = slot as i32 * N_ROWS as i32 + row as i32;
            builder.ins().load(I64, flags, table, place * WORD)
        });
        let value = self.builder.ins().load(F64, flags, pointer, column as i32 * WORD);
        self.columns.insert((slot, row, column), value);
        value
    }

    /// Number `index` of an array.
    pub fn load(&mut self, pointer: Value, index: usize) -> Value {
        self.builder.ins().load(F64, MemFlagsData::trusted(), pointer, index as i32 * WORD)
    }

    /// Writes number `index` of an array.
    pub fn store(&mut self, value: Value, pointer: Value, index: usize) {
        self.builder.ins().store(MemFlagsData::trusted(), value, pointer, index as i32 * WORD);
    }

    /// `a + b`.
    pub fn add(&mut self, a: Value, b: Value) -> Value {
        self.arithmetic(Op::Add, a, b)
    }

    /// `a * b`.
    pub fn mul(&mut self, a: Value, b: Value) -> Value {
        self.arithmetic(Op::Mul, a, b)
    }

    fn arithmetic(&mut self, op: Op, a: Value, b: Value) -> Value {
        let (a, b) = (Operand::Number(a), Operand::Number(b));
        let result = self.apply(op, [a, b, a]);
        self.number(result)
    }

    /// The value of an operator, emitted unless it is known.
    fn apply(&mut self, op: Op, operands: [Operand; 3]) -> Operand {
        if let Some(&known) = self.applied.get(&(op, operands)) {
            return known;
        }
        let result = self.emit(op, operands);
        self.applied.insert((op, operands), result);
        result
    }

    /// One operator: `Op::eval` in Cranelift's words.
    fn emit(&mut self, op: Op, operands: [Operand; 3]) -> Operand {
        use Operand::{Flag, Number};
        match op {
            Op::Neg => Number(self.unary(operands, |ins, a| ins.fneg(a))),
            Op::Sqrt => Number(self.unary(operands, |ins, a| ins.sqrt(a))),
            Op::Abs => Number(self.unary(operands, |ins, a| ins.fabs(a))),
            Op::Floor => Number(self.unary(operands, |ins, a| ins.floor(a))),
            Op::Ceil => Number(self.unary(operands, |ins, a| ins.ceil(a))),
            Op::Trunc => Number(self.unary(operands, |ins, a| ins.trunc(a))),
            Op::Add => Number(self.binary(operands, |ins, a, b| ins.fadd(a, b))),
            Op::Sub => Number(self.binary(operands, |ins, a, b| ins.fsub(a, b))),
            Op::Mul => Number(self.binary(operands, |ins, a, b| ins.fmul(a, b))),
            Op::Div => Number(self.binary(operands, |ins, a, b| ins.fdiv(a, b))),
            Op::Min => Number(self.binary(operands, |ins, a, b| ins.fmin(a, b))),
            Op::Max => Number(self.binary(operands, |ins, a, b| ins.fmax(a, b))),
            Op::Sign => Number(self.sign(operands[0])),
            Op::Lt => Flag(self.binary(operands, |ins, a, b| ins.fcmp(FloatCC::LessThan, a, b))),
            Op::Le => Flag(self.binary(operands, |ins, a, b| ins.fcmp(FloatCC::LessThanOrEqual, a, b))),
            Op::Eq => Flag(self.binary(operands, |ins, a, b| ins.fcmp(FloatCC::Equal, a, b))),
            Op::Ne => Flag(self.binary(operands, |ins, a, b| ins.fcmp(FloatCC::NotEqual, a, b))),
            Op::Not => Flag(self.not(operands[0])),
            Op::And => {
                let (a, b) = (self.flag(operands[0]), self.flag(operands[1]));
                Flag(self.builder.ins().band(a, b))
            }
            Op::Or => {
                let (a, b) = (self.flag(operands[0]), self.flag(operands[1]));
                Flag(self.builder.ins().bor(a, b))
            }
            Op::Select => {
                let (a, b, c) = (self.flag(operands[0]), self.number(operands[1]), self.number(operands[2]));
                Number(self.builder.ins().select(a, b, c))
            }
            Op::Powi | Op::Pow | Op::Atan2 | Op::Mod | Op::Hypot => {
                let arguments = [self.number(operands[0]), self.number(operands[1])];
                Number(self.call(op, &arguments))
            }
            Op::Sin | Op::Cos => self.sin_cos(op, operands),
            Op::Tan
            | Op::Asin
            | Op::Acos
            | Op::Atan
            | Op::Sinh
            | Op::Cosh
            | Op::Tanh
            | Op::Asinh
            | Op::Acosh
            | Op::Atanh
            | Op::Exp
            | Op::Log
            | Op::Log2
            | Op::Log10
            | Op::Cbrt
            | Op::Round => {
                let argument = self.number(operands[0]);
                Number(self.call(op, &[argument]))
            }
        }
    }

    fn unary(&mut self, operands: [Operand; 3], emit: impl FnOnce(Ins<'_, 'f>, Value) -> Value) -> Value {
        let a = self.number(operands[0]);
        emit(self.builder.ins(), a)
    }

    fn binary(
        &mut self,
        operands: [Operand; 3],
        emit: impl FnOnce(Ins<'_, 'f>, Value, Value) -> Value,
    ) -> Value {
        let (a, b) = (self.number(operands[0]), self.number(operands[1]));
        emit(self.builder.ins(), a, b)
    }

    /// Calls the function of an operator.
    fn call(&mut self, op: Op, arguments: &[Value]) -> Value {
        self.call_function(Callee::Operator(op), arguments)
    }

    fn call_function(&mut self, callee: Callee, arguments: &[Value]) -> Value {
        let (builder, import) = (&mut self.builder, &mut self.import);
        let function = *self.callees.entry(callee).or_insert_with(|| import(callee, builder.func));
        let call = builder.ins().call(function, arguments);
        builder.inst_results(call)[0]
    }

    /// Sine and cosine at once; the one that was not asked for is known from now on.
    fn sin_cos(&mut self, op: Op, operands: [Operand; 3]) -> Operand {
        let angle = self.number(operands[0]);
        let builder = &mut self.builder;
        let place = StackSlotData::new(StackSlotKind::ExplicitSlot, WORD as u32, 3);
        let slot = *self.cosine.get_or_insert_with(|| builder.create_sized_stack_slot(place));
        let address = builder.ins().stack_addr(I64, slot, 0);
        let sine = Operand::Number(self.call_function(Callee::SinCos, &[angle, address]));
        let cosine = Operand::Number(self.load(address, 0));
        self.applied.insert((Op::Sin, operands), sine);
        self.applied.insert((Op::Cos, operands), cosine);
        if op == Op::Sin { sine } else { cosine }
    }

    /// `elementary::sign`.
    fn sign(&mut self, operand: Operand) -> Value {
        let a = self.number(operand);
        let [zero, one, minus_one] = [0.0, 1.0, -1.0].map(|value| self.constant(value));
        let positive = self.builder.ins().fcmp(FloatCC::GreaterThan, a, zero);
        let negative = self.builder.ins().fcmp(FloatCC::LessThan, a, zero);
        let is_zero = self.builder.ins().fcmp(FloatCC::Equal, a, zero);
        let zero_or_nan = self.builder.ins().select(is_zero, zero, a);
        let not_positive = self.builder.ins().select(negative, minus_one, zero_or_nan);
        self.builder.ins().select(positive, one, not_positive)
    }

    fn not(&mut self, operand: Operand) -> Value {
        match operand {
            Operand::Flag(flag) => {
                let one = self.builder.ins().iconst(I8, 1);
                self.builder.ins().bxor(flag, one)
            }
            Operand::Number(number) => {
                let zero = self.constant(0.0);
                self.builder.ins().fcmp(FloatCC::Equal, number, zero)
            }
        }
    }

    /// `elementary::powi`, unrolled, where the exponent is a constant integer.
    fn powi(&mut self, operands: [Operand; 3], exponent: f64) -> Operand {
        let n = exponent as i32;
        if f64::from(n) != exponent {
            return self.apply(Op::Powi, operands);
        }
        let mut bits = n.unsigned_abs();
        let mut square = self.number(operands[0]);
        let mut product = None;
        while bits != 0 {
            if bits & 1 != 0 {
                product = Some(product.map_or(square, |product| self.mul(product, square)));
            }
            bits >>= 1;
            if bits != 0 {
                square = self.mul(square, square);
            }
        }
        let one = self.constant(1.0);
        let power = product.unwrap_or(one);
        Operand::Number(if n < 0 { self.arithmetic(Op::Div, one, power) } else { power })
    }

    /// As a number: 1 or 0 for a flag.
    fn number(&mut self, operand: Operand) -> Value {
        let flag = match operand {
            Operand::Number(number) => return number,
            Operand::Flag(flag) => flag,
        };
        let (one, zero) = (self.constant(1.0), self.constant(0.0));
        let builder = &mut self.builder;
        *self.numbers.entry(flag).or_insert_with(|| builder.ins().select(flag, one, zero))
    }

    /// As a flag: every number but ±0 is true, NaN too.
    fn flag(&mut self, operand: Operand) -> Value {
        let number = match operand {
            Operand::Flag(flag) => return flag,
            Operand::Number(number) => number,
        };
        let zero = self.constant(0.0);
        let builder = &mut self.builder;
        *self.flags.entry(number).or_insert_with(|| builder.ins().fcmp(FloatCC::NotEqual, number, zero))
    }
}

/// Cranelift's builder at the place where the next instruction goes.
type Ins<'b, 'f> = FuncInstBuilder<'b, 'f>;
