//! Parse arguments, call `cli`, map failures to exit codes. Nothing else.

use std::process::ExitCode;

use clap::Parser;
use novamind::cli::{Arguments, run};

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
