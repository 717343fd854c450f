//! Values of parameters from the command line: `-p NAME=VALUE`.
//!
//! A value is read by the parameter's type, in its declared unit. A wrong one is shown as a text of its own.

use super::context::{Body, Context};
use super::error::OverrideError;
use super::suggest::closest;
use super::types::{Slot, Ty};
use crate::base::Span;
use crate::syntax::ast;

/// What the command line gives.
pub(super) enum Given {
    /// A number, SI; truth values are 1 and 0.
    Number(f64),
    /// A text.
    Text(String),
}

impl Context<'_> {
    /// The value that the command line gives to a parameter; the last one counts.
    pub fn override_of(&mut self, name: &ast::Name, slot: Slot) -> Option<Given> {
        let (_, text) = self.overrides.iter().rev().find(|(key, _)| *key == name.text)?;
        let text = text.clone();
        let (number, expected) = match slot.ty {
            Ty::Text => return Some(Given::Text(text)),
            Ty::Int => {
                let whole = text.trim().parse::<f64>().ok().filter(|value| value.fract() == 0.0);
                (whole, "a whole number")
            }
            Ty::Bool => {
                let truth = match text.trim() {
                    "true" => Some(1.0),
                    "false" => Some(0.0),
                    _ => None,
                };
                (truth, "`true` or `false`")
            }
            Ty::Real | Ty::Agent(_) | Ty::Link(_) | Ty::Nobody | Ty::List(_) | Ty::Wrong => {
                let value = text.trim().parse::<f64>().ok().map(|value| slot.scale().to_si(value));
                // What is too large is not meant to be infinite.
                let is_meant = |value: &f64| {
                    value.is_finite() || value.is_infinite() && !text.contains(char::is_numeric)
                };
                (value.filter(is_meant), "a number")
            }
        };
        if number.is_none() {
            let span = self.command_line(&format!("-p {}=", name.text), &text);
            let expected = if text.contains('[') { "a bare number, in its declared unit" } else { expected };
            self.report(OverrideError::Bad { name: name.text.clone(), expected, span, declared: name.span });
        }
        number.map(Given::Number)
    }

    /// Reports the names that are no parameters.
    pub fn check_overrides(&mut self) {
        for (name, value) in self.overrides.clone() {
            let is_param = |body: &Body| matches!(body, Body::Param(item) if item.name.text == name);
            if self.imports || self.definitions.iter().any(|definition| is_param(&definition.body)) {
                continue;
            }
            let params = self.definitions.iter().filter_map(|definition| match definition.body {
                Body::Param(item) => Some(item.name.text.as_str()),
                _ => None,
            });
            let similar = closest(&name, params);
            let other = self.globals.get(name.as_str()).map(|global| global.span);
            let at = self.command_line("-p ", &format!("{name}={value}"));
            let span = Span { end: at.start + u32::try_from(name.len()).unwrap_or(0), ..at };
            self.report(OverrideError::Unknown { name, span, similar, other });
        }
    }

    /// A place for a word of the command line, which no file holds.
    pub fn command_line(&mut self, before: &str, word: &str) -> Span {
        let file = self.sources.add("command line", format!("{before}{word}"));
        Span::new(file, before.len(), before.len() + word.len())
    }
}
