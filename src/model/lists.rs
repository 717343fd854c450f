//! Lists: `[a, b, c]`, and what stands at a place of one, `xs[i]`.
//!
//! A list is not a value that a run holds: it is numbers, or truth values, side by side in the text. `xs[i]` is a choice among
//! them, a tree of `if i < k`; a place that is known is the element itself. Beside the list there is nothing: a place known to
//! be there is an error, any other gives no number (NaN).

use super::context::{Context, Scope, Value};
use super::error::{ListError, OverrideError, TypeError};
use super::expression::join_numbers;
use super::types::{List, Slot, Ty};
use crate::base::Span;
use crate::math::Op;
use crate::syntax::ast;

impl<'a> Context<'a> {
    /// `[a, b, c]`; what goes into a declared type does so element by element.
    pub fn lower_list(
        &mut self,
        scope: &mut Scope<'a>,
        items: &'a [ast::Expr],
        slot: Option<Slot>,
        span: Span,
    ) -> Value {
        let elements = items.iter().map(|item| match slot {
            Some(slot) => self.lower_into(scope, item, slot, "an element of a list"),
            None => self.lower(scope, item),
        });
        let elements: Vec<Value> = elements.collect();
        let mut ty = elements.first().map_or(Ty::Wrong, |first| first.ty);
        for (item, element) in items.iter().zip(&elements) {
            ty = match (ty, element.ty) {
                (Ty::Wrong, _) | (_, Ty::Wrong) => Ty::Wrong,
                (Ty::Bool, Ty::Bool) => Ty::Bool,
                (a, b) if a.is_number() && b.is_number() => join_numbers(a, b),
                (_, found) => {
                    let (what, found) = ("an element of a list".to_string(), self.describe(found));
                    let expected = "a number, or true or false, as those before it".to_string();
                    self.report(TypeError::Mismatch { what, expected, found, span: item.span, help: None });
                    Ty::Wrong
                }
            };
        }
        if ty == Ty::Wrong {
            return self.wrong(span);
        }
        self.new_list(elements, span)
    }

    fn new_list(&mut self, elements: Vec<Value>, span: Span) -> Value {
        self.lists.push(List { elements });
        let list = Ty::List(self.lists.len() - 1);
        self.number(0.0, list, span)
    }

    /// A list that the command line gives in place of a parameter's: `-p xs=1,2,3`; none if it gives none.
    pub fn list_override(&mut self, name: &ast::Name, slot: Slot) -> Option<Value> {
        let (_, text) = self.overrides.iter().rev().find(|(key, _)| *key == name.text)?;
        let text = text.clone();
        let inner = text.trim().trim_start_matches('[').trim_end_matches(']');
        let numbers = inner.split(',').map(|cell| cell.trim().parse::<f64>().ok());
        let whole = |value: &f64| slot.ty != Ty::Int || value.fract() == 0.0;
        let numbers: Option<Vec<f64>> =
            numbers.map(|number| number.filter(|value| value.is_finite() && whole(value))).collect();
        let Some(numbers) = numbers else {
            let span = self.command_line(&format!("-p {}=", name.text), &text);
            let expected =
                if slot.ty == Ty::Int { "whole numbers with commas" } else { "numbers with commas" };
            self.report(OverrideError::Bad { name: name.text.clone(), expected, span, declared: name.span });
            return Some(self.wrong(name.span));
        };
        let elements = numbers.into_iter().map(|number| {
            let ty = if slot.ty == Ty::Int { Ty::Int } else { Ty::Real };
            let element = self.number(slot.scale().to_si(number), ty, name.span);
            self.quantities.insert(element.id, slot.quantity());
            element
        });
        let elements = elements.collect();
        Some(self.new_list(elements, name.span))
    }

    /// What stands at a place of a list.
    pub fn lower_element(
        &mut self,
        scope: &mut Scope<'a>,
        list: usize,
        (base, place): (&'a ast::Expr, &'a ast::Expr),
        span: Span,
    ) -> Value {
        let elements = self.lists[list].elements.clone();
        let index = self.lower(scope, place);
        let index = self.fit(index, Ty::Int, place.span, "the place in a list");
        if index.ty == Ty::Wrong {
            return self.wrong(span);
        }
        let count = elements.len();
        if self.facts[index.id.index()].closed {
            let Some(number) = self.evaluate_closed(index.id) else { return self.wrong(span) };
            if number >= 0.0 && number < count as f64 {
                return elements[number as usize];
            }
            let list = self.sources.text(base.span).to_string();
            self.report(ListError::OutOfRange { list, count, index: number, span: place.span });
            return self.wrong(span);
        }
        let ty = elements.iter().fold(elements[0].ty, |ty, element| match ty {
            Ty::Bool => Ty::Bool,
            _ => join_numbers(ty, element.ty),
        });
        let inside = self.choose_among(&elements, 0, (index, ty), span);
        let nothing = self.number(f64::NAN, ty, span);
        let below = self.before(index, 0, span);
        let within = self.before(index, count, span);
        let inside = self.apply(Op::Select, [within.id, inside.id, nothing.id], ty, span);
        self.apply(Op::Select, [below.id, nothing.id, inside.id], ty, span)
    }

    /// The choice among elements, of which the first has this number.
    fn choose_among(
        &mut self,
        elements: &[Value],
        first: usize,
        (index, ty): (Value, Ty),
        span: Span,
    ) -> Value {
        if let [element] = elements {
            return *element;
        }
        let middle = elements.len() / 2;
        let before = self.choose_among(&elements[..middle], first, (index, ty), span);
        let after = self.choose_among(&elements[middle..], first + middle, (index, ty), span);
        let test = self.before(index, first + middle, span);
        self.apply(Op::Select, [test.id, before.id, after.id], ty, span)
    }

    /// Whether a whole number is less than another: halfway between them, where none lies.
    fn before(&mut self, index: Value, number: usize, span: Span) -> Value {
        let between = self.number(number as f64 - 0.5, Ty::Real, span);
        self.apply(Op::Lt, [index.id, between.id], Ty::Bool, span)
    }
}
