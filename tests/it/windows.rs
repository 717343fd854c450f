//! Does the fast form of the engine find what the plain form finds? Whatever happens in the middle of a window, with
//! agents that have run ahead: the same events, ends and samples, by hand-written models and by generated ones.

mod forms;
mod crowd;
mod arena;
mod lookouts;
mod mates;
mod threads;
mod written;
mod generated;
