//! The program `hyc`: hands the words of the command line to the topmost floor.

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// `mi_option_purge_delay` of mimalloc's C header.
const PURGE_DELAY: libmimalloc_sys::mi_option_t = 15;

fn main() -> ExitCode {
    // In ms. What is freed is mostly taken again soon: given back in between, its pages would be cleared each time.
    // SAFETY: sets one number of the allocator; nothing else runs yet.
    unsafe { libmimalloc_sys::mi_option_set(PURGE_DELAY, 1000) };
    hyc::cli::main(std::env::args_os()).into()
}
