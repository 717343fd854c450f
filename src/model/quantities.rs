//! Where the dimensions of numbers, arguments and named expressions come from.
//!
//! Every mention of a name has an entry, and most entries are those of names without a unit: an expression holds the number of its
//! quantity, and quantities that come one after the other and are the same have one number.

use super::ir::ExprId;
use super::types::Quantity;

/// Quantities by expression.
#[derive(Default)]
pub(super) struct Quantities {
    /// By expression, the number in `all` and one more; 0, as beyond the end, if it has none.
    numbers: Vec<u32>,
    all: Vec<Quantity>,
}

impl Quantities {
    /// That of an expression, if it has been given one.
    pub fn get(&self, id: ExprId) -> Option<Quantity> {
        let number = *self.numbers.get(id.index())?;
        number.checked_sub(1).map(|number| self.all[number as usize])
    }

    /// Gives an expression its quantity.
    pub fn insert(&mut self, id: ExprId, quantity: Quantity) {
        if self.all.last() != Some(&quantity) {
            self.all.push(quantity);
        }
        if self.numbers.len() <= id.index() {
            self.numbers.resize(id.index() + 1, 0);
        }
        // There are no more of them than expressions, whose numbers have 32 bits.
        self.numbers[id.index()] = self.all.len() as u32;
    }
}
