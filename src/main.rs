//! Parses the arguments, calls `cli`, and maps failures to exit codes.

use std::process::ExitCode;

use clap::Parser;
use novamind::cli::{Arguments, run};

/// A simulated day allocates and frees thousands of blocks on several threads. With the default allocator a run of 500
/// days takes 7 %
/// longer and requests twice as many pages from the system.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    match run(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let text = failure.to_string();
            if !text.is_empty() {
                eprintln!("novamind: {text}");
            }
            ExitCode::from(failure.code)
        }
    }
}
