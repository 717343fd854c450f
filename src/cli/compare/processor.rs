//! The time that this thread has had a processor, which other programs on the machine do not change much.

/// s, from some beginning.
#[cfg(unix)]
pub(super) fn processor_seconds() -> f64 {
    use nix::time::{ClockId, clock_gettime};
    match clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID) {
        Ok(time) => time.tv_sec() as f64 + 1e-9 * time.tv_nsec() as f64,
        Err(_) => elapsed(),
    }
}

/// s, from some beginning: where there is no such clock, by the wall.
#[cfg(not(unix))]
pub(super) fn processor_seconds() -> f64 {
    elapsed()
}

fn elapsed() -> f64 {
    use std::sync::OnceLock;
    use std::time::Instant;
    static BEGIN: OnceLock<Instant> = OnceLock::new();
    BEGIN.get_or_init(Instant::now).elapsed().as_secs_f64()
}
