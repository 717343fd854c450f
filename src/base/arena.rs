//! Arenas with typed indices: storage in which an index of one arena cannot be used on another.
//!
//! A large arena grows by chunks: what is in a full one is never copied, and no more than a chunk lies idle.

use std::fmt;
use std::hash::{Hash, Hasher};
use std::iter::{Chain, Flatten};
use std::marker::PhantomData;
use std::num::NonZeroU32;
use std::ops::{Index, IndexMut};
use std::slice;

/// The place of a `T` in an [`Arena<T>`]; 32 bits, whatever `T` is, also if it may be missing.
pub struct Idx<T> {
    /// The number of the element, from 1.
    raw: NonZeroU32,
    marker: PhantomData<fn() -> T>,
}

impl<T> Idx<T> {
    /// The index with this number. Panics beyond 2^32 - 2, which every arena's own limit excludes.
    pub fn new(index: usize) -> Self {
        let raw = u32::try_from(index + 1).ok().and_then(NonZeroU32::new);
        Self { raw: raw.expect("arenas are limited to 2^32 - 1 elements"), marker: PhantomData }
    }

    /// The number of the element, from 0.
    pub fn index(self) -> usize {
        self.raw.get() as usize - 1
    }
}

impl<T> Clone for Idx<T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<T> Copy for Idx<T> {}
impl<T> PartialEq for Idx<T> {
    fn eq(&self, other: &Self) -> bool {
        self.raw == other.raw
    }
}
impl<T> Eq for Idx<T> {}
impl<T> PartialOrd for Idx<T> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl<T> Ord for Idx<T> {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.raw.cmp(&other.raw)
    }
}
impl<T> Hash for Idx<T> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.raw.hash(state);
    }
}
impl<T> fmt::Debug for Idx<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}", self.index())
    }
}

/// How many elements a full chunk has.
const CHUNK: usize = 1 << 12;

/// A growing list whose elements are named by [`Idx<T>`]; nothing is ever removed.
#[derive(Clone, Debug, PartialEq)]
pub struct Arena<T> {
    full: Vec<Box<[T]>>,
    last: Vec<T>,
}

impl<T> Default for Arena<T> {
    fn default() -> Self {
        Self { full: Vec::new(), last: Vec::new() }
    }
}

impl<T> Arena<T> {
    /// An empty arena.
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends and names an element.
    pub fn push(&mut self, item: T) -> Idx<T> {
        let idx = self.next_idx();
        if self.last.len() == CHUNK {
            let full = std::mem::replace(&mut self.last, Vec::with_capacity(CHUNK));
            self.full.push(full.into_boxed_slice());
        }
        self.last.push(item);
        idx
    }

    /// The index that the next [`push`](Self::push) will return.
    pub fn next_idx(&self) -> Idx<T> {
        Idx::new(self.len())
    }

    /// How many elements there are.
    pub fn len(&self) -> usize {
        self.full.len() * CHUNK + self.last.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.last.is_empty()
    }

    /// The elements in order.
    pub fn iter(&self) -> <&Self as IntoIterator>::IntoIter {
        self.into_iter()
    }

    /// The elements in order, to be changed.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut T> {
        self.full.iter_mut().flatten().chain(&mut self.last)
    }

    /// The elements with their names, in order.
    pub fn iter_enumerated(&self) -> impl DoubleEndedIterator<Item = (Idx<T>, &T)> + ExactSizeIterator {
        (0..self.len()).map(|k| (Idx::new(k), &self[Idx::new(k)]))
    }

    /// All names, in order.
    pub fn indices(&self) -> impl DoubleEndedIterator<Item = Idx<T>> + use<T> {
        (0..self.len()).map(Idx::new)
    }

    /// Gives back room that nothing is in.
    pub fn shrink_to_fit(&mut self) {
        self.last.shrink_to_fit();
    }
}

impl<T> Index<Idx<T>> for Arena<T> {
    type Output = T;
    fn index(&self, idx: Idx<T>) -> &T {
        let (chunk, place) = (idx.index() / CHUNK, idx.index() % CHUNK);
        if chunk < self.full.len() {
            &self.full[chunk][place]
        } else {
            &self.last[idx.index() - self.full.len() * CHUNK]
        }
    }
}
impl<T> IndexMut<Idx<T>> for Arena<T> {
    fn index_mut(&mut self, idx: Idx<T>) -> &mut T {
        let (chunk, place) = (idx.index() / CHUNK, idx.index() % CHUNK);
        let n_full = self.full.len();
        if chunk < n_full {
            &mut self.full[chunk][place]
        } else {
            &mut self.last[idx.index() - n_full * CHUNK]
        }
    }
}
impl<T> FromIterator<T> for Arena<T> {
    fn from_iter<I: IntoIterator<Item = T>>(iter: I) -> Self {
        let mut arena = Self::new();
        for item in iter {
            arena.push(item);
        }
        arena
    }
}
impl<'a, T> IntoIterator for &'a Arena<T> {
    type Item = &'a T;
    type IntoIter = Chain<Flatten<slice::Iter<'a, Box<[T]>>>, slice::Iter<'a, T>>;
    fn into_iter(self) -> Self::IntoIter {
        self.full.iter().flatten().chain(&self.last)
    }
}
