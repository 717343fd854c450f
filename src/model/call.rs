//! Calls: the functions of the language and those of the file.

use super::context::{Context, Global, GlobalKind, Meaning, Scope, Value};
use super::error::{ModeError, NameError, TypeError};
use super::expression::join_numbers;
use super::ir::FunctionId;
use super::suggest::closest;
use super::types::Ty;
use crate::base::Span;
use crate::math::Op;
use crate::syntax::ast;

/// The type of what a function of the language gives.
#[derive(Clone, Copy)]
enum Gives {
    /// A real number.
    Real,
    /// A whole number if all arguments are.
    AsArguments,
    /// A whole number.
    Whole,
}

/// The functions of the language that are one operator.
const FUNCTIONS: &[(&str, Op, Gives)] = &[
    ("sin", Op::Sin, Gives::Real),
    ("cos", Op::Cos, Gives::Real),
    ("tan", Op::Tan, Gives::Real),
    ("asin", Op::Asin, Gives::Real),
    ("acos", Op::Acos, Gives::Real),
    ("atan", Op::Atan, Gives::Real),
    ("atan2", Op::Atan2, Gives::Real),
    ("sinh", Op::Sinh, Gives::Real),
    ("cosh", Op::Cosh, Gives::Real),
    ("tanh", Op::Tanh, Gives::Real),
    ("asinh", Op::Asinh, Gives::Real),
    ("acosh", Op::Acosh, Gives::Real),
    ("atanh", Op::Atanh, Gives::Real),
    ("exp", Op::Exp, Gives::Real),
    ("log", Op::Log, Gives::Real),
    ("log2", Op::Log2, Gives::Real),
    ("log10", Op::Log10, Gives::Real),
    ("sqrt", Op::Sqrt, Gives::Real),
    ("cbrt", Op::Cbrt, Gives::Real),
    ("abs", Op::Abs, Gives::AsArguments),
    ("sign", Op::Sign, Gives::Whole),
    ("min", Op::Min, Gives::AsArguments),
    ("max", Op::Max, Gives::AsArguments),
    ("floor", Op::Floor, Gives::Whole),
    ("ceil", Op::Ceil, Gives::Whole),
    ("round", Op::Round, Gives::Whole),
    ("trunc", Op::Trunc, Gives::Whole),
    ("mod", Op::Mod, Gives::AsArguments),
    ("hypot", Op::Hypot, Gives::Real),
];

impl<'a> Context<'a> {
    /// `f(a, b)`.
    pub fn lower_call(
        &mut self,
        scope: &mut Scope<'a>,
        callee: &'a ast::Expr,
        args: &'a [ast::Expr],
        span: Span,
    ) -> Value {
        let ast::ExprKind::Name(name) = &callee.kind else {
            let title = "only functions can be called, by their name".to_string();
            self.report(NameError::NotAFunction { title, span: callee.span });
            return self.wrong(span);
        };
        if let Some(&(_, op, gives)) = FUNCTIONS.iter().find(|(known, _, _)| known == name) {
            return self.lower_operator(scope, name, op, gives, args, span);
        }
        match name.as_str() {
            "clamp" => return self.lower_clamp(scope, args, span),
            "rising" | "crossing" => {
                self.report(ModeError::EdgeOutsideGuard { name: name.clone(), span });
                return self.wrong(span);
            }
            "table" | "spline" => return self.lower_table(scope, name, args, span),
            "csv" | "Uniform" | "Normal" | "Exponential" => {
                let (why, help) = if name == "csv" {
                    ("is not a value", "it stands behind `from` in `system`")
                } else {
                    ("is a distribution, not a value", "a random value is drawn by `~`")
                };
                self.report(NameError::NotHere { name: name.clone(), span, why, help });
                return self.wrong(span);
            }
            _ => {}
        }
        match self.globals.get(name.as_str()) {
            Some(&Global { kind: GlobalKind::Definition(number), .. }) => match self.mention(number) {
                Meaning::Function(function) => self.lower_user_call(scope, function, args, span),
                Meaning::Failed => self.wrong(span),
                Meaning::Number(..) | Meaning::Text(_) | Meaning::Shared(_) | Meaning::Let(..) => {
                    let title = format!("`{name}` is not a function");
                    self.report(NameError::NotAFunction { title, span: callee.span });
                    self.wrong(span)
                }
            },
            _ => self.unknown_function(name, callee.span),
        }
    }

    fn unknown_function(&mut self, name: &str, span: Span) -> Value {
        if !self.imports {
            let functions = FUNCTIONS.iter().map(|(name, _, _)| *name);
            let own = self.definitions.iter().filter(|definition| definition.is_function());
            let own = own.map(|definition| definition.name.text.as_str());
            let similar = closest(name, functions.chain(["clamp", "rising", "crossing"]).chain(own));
            self.report(NameError::UnknownFunction { name: name.to_string(), span, similar });
        }
        self.wrong(span)
    }

    /// Whether there are as many arguments as there must be; a diagnostic if not.
    pub fn check_count(
        &mut self,
        function: &str,
        least: usize,
        most: usize,
        found: usize,
        span: Span,
    ) -> bool {
        let fits = (least..=most).contains(&found);
        if !fits {
            let function = function.to_string();
            self.report(TypeError::Arguments { function, least, most, found, span });
        }
        fits
    }

    fn lower_operator(
        &mut self,
        scope: &mut Scope<'a>,
        name: &str,
        op: Op,
        gives: Gives,
        args: &'a [ast::Expr],
        span: Span,
    ) -> Value {
        let values = args.iter().map(|arg| self.lower_number(scope, arg, name)).collect::<Vec<_>>();
        if !self.check_count(name, op.arity(), op.arity(), args.len(), span) {
            return self.wrong(span);
        }
        let joined = values.iter().fold(Ty::Int, |ty, value| join_numbers(ty, value.ty));
        let ty = match gives {
            _ if joined == Ty::Wrong => Ty::Wrong,
            Gives::Real => Ty::Real,
            Gives::Whole => Ty::Int,
            Gives::AsArguments => joined,
        };
        match values[..] {
            [a] => self.apply(op, [a.id], ty, span),
            [a, b] => self.apply(op, [a.id, b.id], ty, span),
            [a, b, c] => self.apply(op, [a.id, b.id, c.id], ty, span),
            _ => unreachable!("operators have one to three operands"),
        }
    }

    /// `clamp(x, low, high)` is `min(max(x, low), high)`.
    fn lower_clamp(&mut self, scope: &mut Scope<'a>, args: &'a [ast::Expr], span: Span) -> Value {
        let values = args.iter().map(|arg| self.lower_number(scope, arg, "clamp")).collect::<Vec<_>>();
        if !self.check_count("clamp", 3, 3, args.len(), span) {
            return self.wrong(span);
        }
        let ty = values.iter().fold(Ty::Int, |ty, value| join_numbers(ty, value.ty));
        let raised = self.apply(Op::Max, [values[0].id, values[1].id], ty, span);
        self.apply(Op::Min, [raised.id, values[2].id], ty, span)
    }

    fn lower_user_call(
        &mut self,
        scope: &mut Scope<'a>,
        function: FunctionId,
        args: &'a [ast::Expr],
        span: Span,
    ) -> Value {
        let signature = self.signatures[function.index()].clone();
        let name = self.model.functions[function].name.clone();
        let mut values = Vec::with_capacity(signature.formals.len());
        for (k, arg) in args.iter().enumerate() {
            let value = match signature.formals.get(k) {
                Some((slot, _)) => {
                    let what =
                        format!("argument `{}` of `{name}`", self.model.functions[function].params[k].0);
                    self.lower_given(scope, arg, *slot, &what)
                }
                None => self.lower(scope, arg),
            };
            values.push(value);
        }
        let least = signature.formals.iter().filter(|(_, default)| default.is_none()).count();
        if !self.check_count(&name, least, signature.formals.len(), args.len(), span) {
            return self.wrong(span);
        }
        values.extend(signature.formals.iter().skip(args.len()).filter_map(|(_, default)| *default));
        let wrong = values.iter().any(|value| value.ty == Ty::Wrong);
        let ty = if wrong { Ty::Wrong } else { signature.result.ty };
        self.call_by_cases(function, values, ty, span)
    }
}
