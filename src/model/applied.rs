//! What an operator is applied to: one to three expressions, held in place.
//!
//! A giant model has millions of operators; a list on the heap for each would cost more than the rest of the expression.

use std::ops::Deref;

use super::ir::ExprId;

/// The operands of an operator, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operands {
    /// Those beyond `count` repeat the first.
    ids: [ExprId; 3],
    count: u8,
}

impl From<[ExprId; 1]> for Operands {
    fn from([a]: [ExprId; 1]) -> Self {
        Self { ids: [a; 3], count: 1 }
    }
}

impl From<[ExprId; 2]> for Operands {
    fn from([a, b]: [ExprId; 2]) -> Self {
        Self { ids: [a, b, a], count: 2 }
    }
}

impl From<[ExprId; 3]> for Operands {
    fn from(ids: [ExprId; 3]) -> Self {
        Self { ids, count: 3 }
    }
}

impl Deref for Operands {
    type Target = [ExprId];

    fn deref(&self) -> &[ExprId] {
        &self.ids[..usize::from(self.count)]
    }
}

impl<'o> IntoIterator for &'o Operands {
    type Item = &'o ExprId;
    type IntoIter = std::slice::Iter<'o, ExprId>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}
