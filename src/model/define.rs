//! Pass 2: parameters with their values, `let`s and functions, each after those that it needs.
//!
//! A definition is looked up while its users are checked, so its order needs no pass of its own; but a chain of lookups
//! would recurse. The pass therefore starts with an order guessed from names alone, which leaves few lookups to wait.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::context::{Body, Context, Home, Meaning, Progress, Scope, Signature, Value};
use super::error::{NameError, TypeError, ValueError};
use super::ir::{Function, Let, ModeId, Param, ParamValue, TypeId};
use super::limits;
use super::mentions::names_in;
use super::order::in_order_of_need;
use super::overrides::Given;
use super::types::{Quantity, Slot, Ty};
use crate::base::Span;
use crate::math::Scale;
use crate::syntax::ast;

/// Defines everything that has been declared.
pub(super) fn define(context: &mut Context) {
    for number in context.guessed_order() {
        context.define(number);
    }
    context.collect_params();
    context.check_overrides();
}

/// Numbers of definitions, of which there are few.
type Few = SmallVec<[usize; 2]>;

impl<'a> Context<'a> {
    fn guessed_order(&self) -> Vec<usize> {
        let mut by_name: FxHashMap<&str, Few> = FxHashMap::default();
        by_name.reserve(self.definitions.len());
        for (number, definition) in self.definitions.iter().enumerate() {
            by_name.entry(&definition.name.text).or_default().push(number);
        }
        // A name that many definitions share says little about which one is meant.
        by_name.retain(|_, numbers| numbers.len() <= 8);
        let mut names = Vec::new();
        let needs = self.definitions.iter().map(|definition| {
            names.clear();
            names_in(definition.body.value(), &mut names);
            names.sort_unstable();
            names.dedup();
            names.iter().filter_map(|name| by_name.get(name)).flatten().copied().collect()
        });
        in_order_of_need(&needs.collect::<Vec<Few>>())
    }

    /// What a definition means, for a text that mentions it.
    pub fn mention(&mut self, number: usize) -> Meaning {
        self.definitions[number].used = true;
        self.define(number)
    }

    /// What a definition means; it is worked out when it is first asked for.
    pub fn define(&mut self, number: usize) -> Meaning {
        match self.definitions[number].progress {
            Progress::Done(meaning) => return meaning,
            Progress::Running => {
                self.report_circle(number);
                return Meaning::Failed;
            }
            Progress::Waiting => {}
        }
        self.definitions[number].progress = Progress::Running;
        self.running.push(number);
        self.depth += limits::DEPTH_OF_DEFINITION;
        let meaning = match self.definitions[number].body {
            Body::Param(item) => self.define_param(number, item),
            Body::Let(item) => self.define_let(number, item),
            Body::Function(item) => self.define_function(item),
            Body::AgentLet(ty, mode, item) => self.define_agent_let(ty, mode, item),
            Body::PairLet(pair, item) => self.define_pair_let(pair, item),
        };
        self.running.pop();
        self.depth -= limits::DEPTH_OF_DEFINITION;
        self.definitions[number].progress = Progress::Done(meaning);
        meaning
    }

    fn report_circle(&mut self, number: usize) {
        let start = self.running.iter().position(|&running| running == number).unwrap_or(0);
        let circle = self.running[start..].iter().map(|&k| &self.definitions[k]).collect::<Vec<_>>();
        let names = circle.iter().map(|item| (item.name.text.clone(), item.name.span)).collect();
        if circle.iter().all(|item| item.is_function()) {
            self.report(NameError::Recursion { names });
        } else {
            self.report(NameError::Circle { names, what: "definitions need each other in a circle" });
        }
    }

    fn define_param(&mut self, number: usize, item: &'a ast::Param) -> Meaning {
        let declared = item.ty.as_ref().map(|ty| self.slot(ty));
        if let ast::ExprKind::List(items) = &item.value.kind {
            return self.define_list(&item.name, declared, items, item.value.span);
        }
        let what = format!("the value of `{}`", item.name.text);
        let mut scope = Scope::of(Home::File);
        let value = match declared {
            Some(slot) => self.lower_into(&mut scope, &item.value, slot, &what),
            None => self.lower(&mut scope, &item.value),
        };
        let slot = match (declared, value.ty) {
            (Some(slot), _) => slot,
            (None, Ty::Int) => Slot::plain(Ty::Real),
            (None, ty) => Slot::plain(ty),
        };
        self.definitions[number].quantity = slot.quantity();
        if value.ty == Ty::Wrong {
            return Meaning::Failed;
        }
        let given = self.override_of(&item.name, slot);
        match slot.ty {
            Ty::Text => {
                let text = match given {
                    Some(Given::Text(text)) => Some(text),
                    Some(Given::Number(_)) | None => self.text_of(&item.value),
                };
                self.texts.push(text.unwrap_or_default());
                Meaning::Text(self.texts.len() - 1)
            }
            Ty::Real | Ty::Int | Ty::Bool => match (self.constant(value, &item.value, &what), given) {
                (None, _) => Meaning::Failed,
                (Some(_), Some(Given::Number(number))) => Meaning::Number(number, slot.ty),
                (Some(number), Some(Given::Text(_)) | None) => Meaning::Number(number, slot.ty),
            },
            Ty::Agent(_) | Ty::Link(_) | Ty::Nobody | Ty::List(_) | Ty::Wrong => {
                self.no_reference(slot.ty, "a `param`", item.value.span);
                Meaning::Failed
            }
        }
    }

    /// A parameter that is a list of constants.
    fn define_list(
        &mut self,
        name: &'a ast::Name,
        declared: Option<Slot>,
        items: &'a [ast::Expr],
        span: Span,
    ) -> Meaning {
        let list = self.lower_list(&mut Scope::of(Home::File), items, declared, span);
        let Ty::List(number) = list.ty else { return Meaning::Failed };
        for (element, item) in self.lists[number].elements.clone().into_iter().zip(items) {
            if self.constant(element, item, "an element of a parameter").is_none() {
                return Meaning::Failed;
            }
        }
        match self.list_override(name, declared.unwrap_or(Slot::plain(Ty::Real))) {
            Some(given) if given.ty == Ty::Wrong => Meaning::Failed,
            Some(given) => Meaning::Shared(given),
            None => Meaning::Shared(list),
        }
    }

    /// The number that an expression is; none, and a diagnostic, if it is not a constant or not a number.
    pub fn constant(&mut self, value: Value, expr: &ast::Expr, what: &str) -> Option<f64> {
        if value.ty == Ty::Wrong {
            return None;
        }
        if !self.facts[value.id.index()].closed {
            self.report(ValueError::NotConstant { what: what.to_string(), span: expr.span });
            return None;
        }
        let number = self.evaluate_closed(value.id)?;
        if number.is_nan() {
            self.report(ValueError::NotFinite { what: what.to_string(), value: number, span: expr.span });
            return None;
        }
        Some(number)
    }

    /// The text that an expression is: a literal, or the name of a parameter that is one.
    pub fn text_of(&mut self, expr: &'a ast::Expr) -> Option<String> {
        match &expr.kind {
            ast::ExprKind::Text(text) => Some(text.clone()),
            ast::ExprKind::Name(name) => match self.globals.get(name.as_str())?.kind {
                super::context::GlobalKind::Definition(number) => match self.mention(number) {
                    Meaning::Text(number) => Some(self.texts[number].clone()),
                    _ => None,
                },
                _ => None,
            },
            _ => None,
        }
    }

    fn no_reference(&mut self, ty: Ty, what: &'static str, span: Span) {
        let found = self.describe(ty);
        let help = "it holds a number or a truth value; a reference to an agent is a `link` or a parameter of an agent";
        self.report(TypeError::NotAllowed { what, found, span, help });
    }

    /// The value of a `let`, which is a number or a condition, and what is declared of it.
    fn lower_let(&mut self, scope: &mut Scope<'a>, item: &'a ast::Let) -> (Value, Option<Slot>) {
        let slot = item.ty.as_ref().map(|ty| {
            let slot = self.slot(ty);
            self.no_text(slot, "a `let`", ty.span)
        });
        let value = match (slot, &item.value.kind) {
            (_, ast::ExprKind::List(items)) => self.lower_list(scope, items, slot, item.value.span),
            (Some(slot), _) => {
                self.lower_into(scope, &item.value, slot, &format!("the value of `{}`", item.name.text))
            }
            (None, _) => self.lower(scope, &item.value),
        };
        match value.ty {
            Ty::Real | Ty::Int | Ty::Bool | Ty::Wrong => (value, slot),
            Ty::List(_) if !matches!(scope.home, Home::Agent(..)) => (value, slot),
            Ty::List(_) => {
                let (what, found) = ("a `let` of an agent", "a list".to_string());
                let help = "declare the list outside of agents, or take one of its elements here";
                self.report(TypeError::NotAllowed { what, found, span: item.value.span, help });
                (Value { ty: Ty::Wrong, ..value }, slot)
            }
            Ty::Text | Ty::Agent(_) | Ty::Link(_) | Ty::Nobody => {
                self.no_reference(value.ty, "a `let`", item.value.span);
                (Value { ty: Ty::Wrong, ..value }, slot)
            }
        }
    }

    fn define_let(&mut self, number: usize, item: &'a ast::Let) -> Meaning {
        let (value, slot) = self.lower_let(&mut Scope::of(Home::File), item);
        if value.ty == Ty::Wrong {
            return Meaning::Failed;
        }
        if !self.facts[value.id.index()].closed || matches!(value.ty, Ty::List(_)) {
            return self.shared(value, slot);
        }
        self.definitions[number].quantity = slot.map_or(Quantity::As(value.id), |slot| slot.quantity());
        match self.constant(value, &item.value, &format!("the value of `{}`", item.name.text)) {
            Some(number) => Meaning::Number(number, value.ty),
            None => Meaning::Failed,
        }
    }

    fn define_pair_let(&mut self, pair: usize, item: &'a ast::Let) -> Meaning {
        let (value, slot) = self.lower_let(&mut Scope::of(Home::Pair(pair)), item);
        if value.ty == Ty::Wrong { Meaning::Failed } else { self.shared(value, slot) }
    }

    /// A `let` whose users share its expression.
    fn shared(&mut self, value: Value, slot: Option<Slot>) -> Meaning {
        let quantity = slot.map_or(Quantity::As(value.id), |slot| slot.quantity());
        if self.quantities.get(value.id).is_none() {
            self.quantities.insert(value.id, quantity);
        }
        Meaning::Shared(value)
    }

    fn define_agent_let(&mut self, ty: TypeId, mode: ModeId, item: &'a ast::Let) -> Meaning {
        let (value, slot) = self.lower_let(&mut Scope::of(Home::Agent(ty, mode)), item);
        if value.ty == Ty::Wrong {
            return Meaning::Failed;
        }
        let unit = item.ty.as_ref().and_then(|ty| ty.unit.as_ref());
        let scale = slot.map_or(Scale::ONE, |slot| slot.scale());
        let quantity = slot.map_or(Quantity::As(value.id), |slot| slot.quantity());
        self.agents[ty.index()].lets.push(quantity);
        let lets = &mut self.model.types[ty].lets;
        lets.push(Let {
            name: item.name.text.clone(),
            mode,
            value: value.id,
            unit: unit.map(|unit| unit.text.clone()),
            scale,
            span: item.name.span,
        });
        Meaning::Let(lets.len() - 1, value.ty)
    }

    fn define_function(&mut self, item: &'a ast::Fn) -> Meaning {
        let mut scope = Scope::of(Home::Function);
        let mut formals: Vec<(Slot, Option<Value>)> = Vec::new();
        for (k, formal) in item.formals.iter().enumerate() {
            let slot = self.slot(&formal.ty);
            let mut slot = self.no_text(slot, "a parameter of a function", formal.ty.span);
            // A function takes an agent that may be none as well, and reads NaN from it.
            if let Ty::Agent(ty) = slot.ty {
                slot.ty = Ty::Link(ty);
            }
            if let Some(first) =
                item.formals[..k].iter().find(|earlier| earlier.name.text == formal.name.text)
            {
                let (name, span, first) = (formal.name.text.clone(), formal.name.span, first.name.span);
                self.report(NameError::Taken { name, span, first });
            }
            let what = format!("the default of `{}`", formal.name.text);
            let default = formal.default.as_ref();
            let default =
                default.map(|value| self.lower_into(&mut Scope::of(Home::File), value, slot, &what));
            if let (None, Some((_, Some(_)))) = (default, formals.last()) {
                let (name, span) = (formal.name.text.clone(), formal.name.span);
                self.report(NameError::DefaultsLast { name, span });
            }
            scope.locals.push((&formal.name.text, slot));
            formals.push((slot, default));
        }
        let declared = item.ty.as_ref().map(|ty| self.slot(ty));
        let body = match declared {
            Some(slot) => {
                let what = format!("the value of `{}`", item.name.text);
                self.lower_into(&mut scope, &item.body, slot, &what)
            }
            None => self.lower(&mut scope, &item.body),
        };
        if matches!(body.ty, Ty::Text | Ty::Agent(_) | Ty::Link(_) | Ty::Nobody | Ty::List(_)) {
            self.no_reference(body.ty, "the value of a function", item.body.span);
            return Meaning::Failed;
        }
        if body.ty == Ty::Wrong || formals.iter().any(|(slot, _)| slot.ty == Ty::Wrong) {
            return Meaning::Failed;
        }
        let names = item.formals.iter().map(|formal| formal.name.text.clone());
        let params = names.zip(formals.iter().map(|(slot, _)| slot.ty.ir())).collect();
        let result = Slot { ty: body.ty, ..declared.unwrap_or(Slot::plain(body.ty)) };
        self.signatures.push(Signature { formals, result });
        let (name, span) = (item.name.text.clone(), item.name.span);
        Meaning::Function(self.model.functions.push(Function { name, params, body: body.id, span }))
    }

    fn collect_params(&mut self) {
        for definition in &self.definitions {
            let (Body::Param(item), Progress::Done(meaning)) = (definition.body, definition.progress) else {
                continue;
            };
            let (value, ty) = match meaning {
                Meaning::Number(value, ty) => (ParamValue::Number(value), ty.ir()),
                Meaning::Text(number) => (ParamValue::Text(self.texts[number].clone()), Ty::Text.ir()),
                Meaning::Shared(_) | Meaning::Function(_) | Meaning::Let(..) | Meaning::Failed => continue,
            };
            self.model.params.push(Param {
                name: item.name.text.clone(),
                ty,
                unit: item.ty.as_ref().and_then(|ty| ty.unit.as_ref()).map(|unit| unit.text.clone()),
                value,
                span: item.name.span,
            });
        }
    }
}
