//! Types and units as they are declared.

use super::context::{Context, Global, GlobalKind};
use super::error::{NameError, TypeError};
use super::ir::TypeId;
use super::suggest::closest;
use super::types::{Slot, Ty};
use super::units::{self, Unit};
use crate::base::Span;
use crate::syntax::ast;

impl Context<'_> {
    /// The agent type of this name; none, and a diagnostic, if there is none.
    pub fn agent_named(&mut self, name: &ast::Name) -> Option<TypeId> {
        if let Some(Global { kind: GlobalKind::Agent(ty), .. }) = self.globals.get(name.text.as_str()) {
            return Some(*ty);
        }
        if !self.imports {
            let similar = closest(&name.text, self.model.types.iter().map(|ty| ty.name.as_str()));
            self.report(NameError::UnknownType { name: name.text.clone(), span: name.span, similar });
        }
        None
    }

    /// A declared type with its unit.
    pub fn slot(&mut self, item: &ast::TypeName) -> Slot {
        let ty = match item.name.text.as_str() {
            "real" => Ty::Real,
            "int" => Ty::Int,
            "bool" => Ty::Bool,
            "string" => Ty::Text,
            name => match self.globals.get(name) {
                Some(Global { kind: GlobalKind::Agent(ty), .. }) => Ty::Agent(*ty),
                _ => {
                    if !self.imports {
                        let types = self.model.types.iter().map(|ty| ty.name.as_str());
                        let similar = closest(name, types.chain(["real", "int", "bool", "string"]));
                        let (name, span) = (name.to_string(), item.name.span);
                        self.report(NameError::UnknownType { name, span, similar });
                    }
                    Ty::Wrong
                }
            },
        };
        let Some(text) = &item.unit else { return Slot::plain(ty) };
        if !matches!(ty, Ty::Real | Ty::Wrong) {
            self.report(TypeError::UnitOnType { ty: item.name.text.clone(), span: text.span });
        }
        match self.unit(text) {
            Some(unit) => Slot { ty, unit: Some(unit), place: Some(text.span) },
            None => Slot::plain(ty),
        }
    }

    /// A unit; none, and a diagnostic, if the text is none.
    pub fn unit(&mut self, item: &ast::UnitText) -> Option<Unit> {
        let unit = units::parse(&item.text);
        unit.map_err(|problem| self.report(TypeError::Unit { problem, span: item.span })).ok()
    }

    /// Refuses a text where only parameters of the file may be one.
    pub fn no_text(&mut self, slot: Slot, what: &'static str, span: Span) -> Slot {
        if slot.ty != Ty::Text {
            return slot;
        }
        let help = "only a `param` of the file can be a `string`";
        self.report(TypeError::NotAllowed { what, found: "a text".to_string(), span, help });
        Slot::plain(Ty::Wrong)
    }
}
