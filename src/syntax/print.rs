//! Writes a tree as a text in the canonical layout: what `hyc fmt` makes of a file.
//!
//! One statement a line, four columns of indentation a brace, an empty line between the items of a file that have
//! braces, parentheses only where the tree needs them. Comments are not in the tree and not in the text.

mod expr;
mod items;

use std::ops::Fn;

use super::ast::*;

/// The text of a tree.
pub fn print(ast: &Ast) -> String {
    let mut printer = Printer { text: String::new(), depth: 0 };
    for (k, item) in ast.items.iter().enumerate() {
        if k > 0 && (is_block(item) || is_block(&ast.items[k - 1])) {
            printer.text.push('\n');
        }
        printer.item(item);
    }
    printer.text
}

fn is_block(item: &Item) -> bool {
    match item {
        Item::Agent(_) | Item::Interaction(_) | Item::System(_) | Item::Run(_) => true,
        Item::Import(_) | Item::Param(_) | Item::Let(_) | Item::Fn(_) | Item::Property(_) => false,
    }
}

/// The text so far, and how far the next line is indented.
struct Printer {
    text: String,
    depth: usize,
}

impl Printer {
    fn put(&mut self, text: &str) {
        self.text.push_str(text);
    }

    fn indent(&mut self) {
        self.text.extend(std::iter::repeat_n("    ", self.depth));
    }

    /// One line, written by `inside`.
    fn line(&mut self, inside: impl FnOnce(&mut Self)) {
        self.indent();
        inside(self);
        self.put("\n");
    }

    /// Braces with a line for each of `items`, which `inside` writes.
    fn block<T>(&mut self, items: &[T], inside: impl Fn(&mut Self, &T)) {
        if items.is_empty() {
            self.put("{}");
            return;
        }
        self.put("{\n");
        self.depth += 1;
        items.iter().for_each(|item| inside(self, item));
        self.depth -= 1;
        self.indent();
        self.put("}");
    }

    /// `items` with commas between them.
    fn list<T>(&mut self, items: &[T], inside: impl Fn(&mut Self, &T)) {
        for (k, item) in items.iter().enumerate() {
            if k > 0 {
                self.put(", ");
            }
            inside(self, item);
        }
    }

    fn quoted(&mut self, text: &str) {
        self.put("\"");
        self.put(text);
        self.put("\"");
    }

    fn message(&mut self, message: &Option<Text>) {
        if let Some(message) = message {
            self.put(" ");
            self.quoted(&message.value);
        }
    }

    fn unit(&mut self, unit: Option<&UnitText>) {
        if let Some(unit) = unit {
            self.put(" [");
            self.put(&unit.text);
            self.put("]");
        }
    }

    fn type_name(&mut self, ty: &TypeName) {
        self.put(&ty.name.text);
        self.unit(ty.unit.as_ref());
    }

    fn annotation(&mut self, ty: &Option<TypeName>) {
        if let Some(ty) = ty {
            self.put(": ");
            self.type_name(ty);
        }
    }

    fn target(&mut self, target: &Target) {
        for (k, name) in target.path.iter().enumerate() {
            self.put(if k > 0 { "." } else { "" });
            self.put(&name.text);
        }
        if target.history.is_some() {
            self.put(".history");
        }
    }

    /// ` word expr`, if there is an expression.
    fn clause(&mut self, word: &str, expr: &Option<Expr>) {
        if let Some(expr) = expr {
            self.put(" ");
            self.put(word);
            self.put(" ");
            self.expr(expr);
        }
    }

    fn given(&mut self, value_sign: &str, given: &Given) {
        self.put(match given.kind {
            GivenKind::Value => value_sign,
            GivenKind::Draw => " ~ ",
        });
        self.expr(&given.value);
    }
}
