//! `novamind study code`: prints the line that requires an experimenter's code.

use std::io::{self, BufRead, IsTerminal, Write};

use crossterm::event::{Event, KeyCode, KeyEventKind, KeyModifiers, read};
use crossterm::terminal::{disable_raw_mode, enable_raw_mode};

use crate::cli::{Failure, print};
use novamind_study::CodeDigest;

const FEWEST: usize = 4;

/// Reads a code and prints its digest. At a terminal, the code is typed twice and not shown.
pub fn run() -> Result<(), Failure> {
    let code = if io::stdin().is_terminal() { typed_twice()? } else { first_line()? };
    let moment = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    let salt = format!("{:08x}", (moment.as_nanos() as u64 ^ u64::from(std::process::id()) << 32) as u32);
    print(&format!("[access]\ncode = \"{}\"\n", CodeDigest::of(&code, &salt).as_text()))
}

fn long_enough(code: &str) -> Result<String, Failure> {
    let code = code.trim();
    match code.chars().count() {
        0..FEWEST => Err(Failure::usage(format!("a code needs at least {FEWEST} characters"))),
        _ => Ok(code.to_owned()),
    }
}

fn first_line() -> Result<String, Failure> {
    let mut code = String::new();
    io::stdin().lock().read_line(&mut code).map_err(|error| Failure::failed(error.to_string()))?;
    long_enough(&code)
}

fn typed_twice() -> Result<String, Failure> {
    let code = long_enough(&asked("Code (not shown): ")?)?;
    if asked("Repeat: ")?.trim() != code {
        return Err(Failure::usage("the two codes differ; nothing was printed"));
    }
    Ok(code)
}

/// Reads a line at the terminal without showing it.
fn asked(question: &str) -> Result<String, Failure> {
    let failed = |error: io::Error| Failure::failed(error.to_string());
    eprint!("{question}");
    io::stderr().flush().map_err(failed)?;
    enable_raw_mode().map_err(failed)?;
    let typed = hidden_line();
    disable_raw_mode().map_err(failed)?;
    eprintln!();
    typed.map_err(failed)?.ok_or_else(|| Failure::signal(2))
}

/// Returns the keys before Enter, or `None` after ctrl-c, ctrl-d or Escape.
fn hidden_line() -> io::Result<Option<String>> {
    let mut line = String::new();
    loop {
        let Event::Key(key) = read()? else { continue };
        if key.kind == KeyEventKind::Release {
            continue;
        }
        match key.code {
            KeyCode::Enter => return Ok(Some(line)),
            KeyCode::Esc => return Ok(None),
            KeyCode::Char('c' | 'd') if key.modifiers.contains(KeyModifiers::CONTROL) => return Ok(None),
            KeyCode::Char('u') if key.modifiers.contains(KeyModifiers::CONTROL) => line.clear(),
            KeyCode::Backspace => drop(line.pop()),
            KeyCode::Char(letter) => line.push(letter),
            _ => {}
        }
    }
}
