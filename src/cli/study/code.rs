//! `novamind study code`: the line that asks for an experimenter's code.

use std::io::{BufRead, IsTerminal};

use crate::cli::{Failure, print};
use crate::session::CodeDigest;

/// Reads a code and prints its digest.
pub fn run() -> Result<(), Failure> {
    if std::io::stdin().is_terminal() {
        eprint!("Code: ");
    }
    let mut code = String::new();
    std::io::stdin().lock().read_line(&mut code).map_err(|error| Failure::failed(error.to_string()))?;
    let code = code.trim();
    if code.chars().count() < 4 {
        return Err(Failure::usage("a code has at least 4 characters"));
    }
    let moment = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    let salt = format!("{:08x}", (moment.as_nanos() as u64 ^ u64::from(std::process::id()) << 32) as u32);
    print(&format!("[access]\ncode = \"{}\"\n", CodeDigest::of(code, &salt).as_text()))
}
