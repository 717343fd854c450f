//! Long lists: several threads build the slices of one at once.
//!
//! In: parts that are still in slices. Out: what is made of each slice, in the order of the text, and the errors that one thread would
//! have found in their order. Which thread builds what is left to chance, and shows nowhere.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use super::Builder;
use crate::syntax::STACK_BYTES;
use crate::syntax::error::SyntaxError;
use crate::syntax::pieces::{Parts, Piece, Unread};

/// Fewer slices are not worth another thread.
const SLICES_MIN: usize = 8;

/// What is made of a slice, and what is wrong with it.
type Built<T> = (Result<T, Unread>, Vec<SyntaxError>);

impl Builder<'_> {
    /// Those of these parts that become something.
    pub(super) fn many_of<'p, T: Send>(
        &mut self,
        parts: Parts<'p>,
        make: impl Fn(&mut Self, Piece<'p>) -> Result<Option<T>, Unread> + Sync,
    ) -> Result<Vec<T>, Unread> {
        if !self.is_worth_sharing(&parts) {
            return self.some_of(parts, make);
        }
        let mut made = Vec::new();
        let make_all = |this: &mut Self, parts| this.some_of(parts, &make);
        self.shared(parts, make_all, |_, mut some| made.append(&mut some))?;
        made.shrink_to_fit();
        Ok(made)
    }

    /// Whether several threads should build these parts: they are many, and none of them is most of all.
    pub(super) fn is_worth_sharing(&self, parts: &Parts<'_>) -> bool {
        let slices = parts.ahead();
        let longest = slices.iter().map(|slice| slice.tokens.len()).max();
        let all: usize = slices.iter().map(|slice| slice.tokens.len()).sum();
        !self.is_helper && slices.len() >= SLICES_MIN && longest.is_some_and(|longest| 4 * longest <= all)
    }

    /// Makes something of these parts slice by slice, and takes it in their order: what is made stays around for a short time only.
    pub(super) fn shared<'p, T: Send>(
        &mut self,
        mut parts: Parts<'p>,
        make: impl Fn(&mut Self, Parts<'p>) -> Result<T, Unread> + Sync,
        mut take: impl FnMut(&mut Self, T),
    ) -> Result<(), Unread> {
        let (text, slices) = parts.take_ahead();
        let first = make(self, parts)?;
        take(self, first);
        let (source, next) = (self.source, AtomicUsize::new(0));
        let build_next = || {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let slice = slices.get(number)?.clone();
            let ended = Cell::new(slice.tokens.start);
            let mut builder = Self { source, ended, errors: Vec::new(), is_helper: true };
            let made = make(&mut builder, Parts::of_slice(text, slice));
            if made.is_err() {
                // The text is read again as a whole: what others would find is not asked for.
                next.store(slices.len(), Ordering::Relaxed);
            }
            Some((number, (made, builder.errors)))
        };
        let (sender, receiver) = mpsc::channel::<(usize, Built<T>)>();
        let n_helpers = thread::available_parallelism().map_or(0, |threads| threads.get() - 1);
        thread::scope(|scope| {
            for _ in 0..n_helpers {
                let sender = sender.clone();
                let help = || {
                    let sender = sender;
                    while build_next().is_some_and(|built| sender.send(built).is_ok()) {}
                };
                // Without a helper the work is done here.
                let _ = thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, help);
            }
            drop(sender);
            let mut early: BTreeMap<usize, Built<T>> = BTreeMap::new();
            for number in 0..slices.len() {
                let (made, mut errors) = loop {
                    early.extend(receiver.try_iter());
                    if let Some(built) = early.remove(&number) {
                        break built;
                    }
                    early.extend([build_next().or_else(|| receiver.recv().ok()).ok_or(Unread)?]);
                };
                self.errors.append(&mut errors);
                take(self, made?);
            }
            Ok(())
        })
    }
}
