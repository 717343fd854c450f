//! Which instructions a loop is compiled for, and the choice among them by what the CPU has.
//!
//! A level exists only where the CPU has its instructions: that is why [`Level::run`] may call what is compiled for them.
//! On other processors than x86-64 there is the baseline alone, which on AArch64 has NEON's lanes.

use std::sync::OnceLock;

/// A set of instructions that this CPU has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Set {
    /// What every processor of this architecture has.
    Baseline,
    /// Four lanes at a time.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// Eight lanes at a time.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    /// What every processor of this architecture has.
    pub const BASELINE: Level = Level(Set::Baseline);

    /// The levels that this CPU has, the best one last.
    pub fn available() -> &'static [Level] {
        static AVAILABLE: OnceLock<Vec<Level>> = OnceLock::new();
        AVAILABLE.get_or_init(|| {
            let mut levels = vec![Level::BASELINE];
            #[cfg(target_arch = "x86_64")]
            {
                if is_x86_feature_detected!("avx2") {
                    levels.push(Level(Set::Avx2));
                }
                if is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
                {
                    levels.push(Level(Set::Avx512));
                }
            }
            levels
        })
    }

    /// The last of [`Level::available`].
    #[inline]
    pub fn best() -> Level {
        static BEST: OnceLock<Level> = OnceLock::new();
        *BEST.get_or_init(|| Level::available().last().copied().unwrap_or(Level::BASELINE))
    }

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self.0 {
            Set::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => "AVX2",
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => "AVX-512",
        }
    }
}

/// A loop over lanes that is compiled for each level.
pub trait Work {
    /// Does it; to be `#[inline(always)]`, with all that it calls, or it is compiled for the baseline.
    fn work(self);
}

impl Level {
    /// Does the work with this level's instructions.
    #[inline]
    pub fn run(self, work: impl Work) {
        match self.0 {
            Set::Baseline => work.work(),
            // SAFETY: this level exists only where the CPU has AVX2.
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => unsafe { with_avx2(work) },
            // SAFETY: this level exists only where the CPU has AVX-512F, -DQ and -VL.
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => unsafe { with_avx512(work) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2(work: impl Work) {
    work.work();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl")]
fn with_avx512(work: impl Work) {
    work.work();
}
