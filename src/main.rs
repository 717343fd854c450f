//! The program `hyc`: hands the words of the command line to the topmost floor.

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    hyc::cli::main(std::env::args_os()).into()
}
