//! `novamind study code`: prints the line of study.toml that requires an experimenter's code.

use std::io::{self, BufRead, IsTerminal, Write};

use crossterm::event::{Event, KeyCode, KeyEventKind, KeyModifiers, read};
use crossterm::terminal::{disable_raw_mode, enable_raw_mode};

use crate::cli::{Failure, print};
use novamind_study::{CodeDigest, MIN_CODE_CHARACTERS};

/// Reads a code and prints the digest of the code. At a terminal, the code is typed twice and not shown.
pub fn run() -> Result<(), Failure> {
    let code = read_new_code()?;
    print(&format!("[access]\ncode = \"{}\"\n", CodeDigest::from_code(&code, &new_salt()).as_str()))
}

/// Reads a new code. At a terminal, the code is typed twice and not shown.
pub(in crate::cli) fn read_new_code() -> Result<String, Failure> {
    if io::stdin().is_terminal() { read_code_twice() } else { read_first_line() }
}

/// Returns a text that makes the digests of equal codes different.
pub(in crate::cli) fn new_salt() -> String {
    let moment = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    format!("{:08x}", (moment.as_nanos() as u64 ^ u64::from(std::process::id()) << 32) as u32)
}

fn check_length(code: &str) -> Result<String, Failure> {
    let code = code.trim();
    match code.chars().count() {
        0..MIN_CODE_CHARACTERS => {
            Err(Failure::usage(format!("a code needs at least {MIN_CODE_CHARACTERS} characters")))
        }
        _ => Ok(code.to_owned()),
    }
}

fn read_first_line() -> Result<String, Failure> {
    let mut code = String::new();
    io::stdin().lock().read_line(&mut code).map_err(|error| Failure::failed(error.to_string()))?;
    check_length(&code)
}

fn read_code_twice() -> Result<String, Failure> {
    let code = check_length(&prompt_hidden("Code (not shown): ")?)?;
    if prompt_hidden("Repeat: ")?.trim() != code {
        return Err(Failure::usage("the two codes differ; nothing was saved"));
    }
    Ok(code)
}

/// Reads a line at the terminal without showing the typed characters.
fn prompt_hidden(question: &str) -> Result<String, Failure> {
    let failed = |error: io::Error| Failure::failed(error.to_string());
    eprint!("{question}");
    io::stderr().flush().map_err(failed)?;
    enable_raw_mode().map_err(failed)?;
    let typed = read_hidden_line();
    disable_raw_mode().map_err(failed)?;
    eprintln!();
    typed.map_err(failed)?.ok_or_else(|| Failure::signal(2))
}

/// Returns the characters typed before Enter, or `None` after ctrl-c, ctrl-d or Escape.
fn read_hidden_line() -> io::Result<Option<String>> {
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
