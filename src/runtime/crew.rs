//! The threads that may work at once. What is shared among them is divided so that no result depends on how many there are.

use std::sync::OnceLock;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// A share of work that is worth a thread.
const SHARE: usize = 512;
/// Shares for each thread: some take longer than others.
const SHARES: usize = 4;

/// The threads of a run; they are made when there first is enough to do.
#[derive(Debug)]
pub struct Crew {
    most: usize,
    pool: OnceLock<Option<ThreadPool>>,
}

impl Crew {
    /// So many threads at most.
    pub fn new(most: usize) -> Self {
        Self { most, pool: OnceLock::new() }
    }

    /// How many threads have worked.
    pub fn n_threads(&self) -> usize {
        self.pool.get().and_then(Option::as_ref).map_or(1, ThreadPool::current_num_threads)
    }

    /// Into how many shares `n` pieces of work are to be divided.
    pub fn shares(&self, n: usize) -> usize {
        if self.most == 1 { 1 } else { (n / SHARE).clamp(1, SHARES * self.most) }
    }

    /// Does the work of all shares; what comes of them is in their order.
    pub fn map<T: Send, R: Send>(&self, shares: Vec<T>, work: impl Fn(T) -> R + Send + Sync) -> Vec<R> {
        let pool = || self.pool.get_or_init(|| ThreadPoolBuilder::new().num_threads(self.most).build().ok());
        match if shares.len() > 1 { pool() } else { &None } {
            Some(pool) => pool.install(|| shares.into_par_iter().map(work).collect()),
            None => shares.into_iter().map(work).collect(),
        }
    }
}
