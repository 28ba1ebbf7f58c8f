//! Frozen output: all output and files that the program writes for other programs are compared byte for byte.
//!
//! A case is a command line in `tests/data/frozen/cases/GROUP.toml`. Its expected output is `tests/data/frozen/GROUP/NAME.txt`:
//! standard output, then standard error, the exit code, and the files that the command wrote.
//! `NOVAMIND_WRITE_FROZEN=1 cargo test --test program frozen` writes the expected outputs.

mod case;
mod coverage;
mod home;
mod masks;
mod served;

use std::fs;
use std::path::{Path, PathBuf};

use case::cases;
use home::FrozenHome;

/// Length above which an output is stored as its length and BLAKE3 digest, bytes.
const MAX_STORED_BYTES: usize = 100_000;

/// Returns the path of `tests/data/frozen`.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/frozen")
}

/// Runs the cases of a group in one home, in order, and compares each output with the expected output.
fn check_group(group: &str) {
    let mut home = FrozenHome::new();
    let found = cases(group)
        .iter()
        .filter_map(|case| compare_or_write(group, &case.name, &home.case_output(case)))
        .collect();
    report(found);
}

#[track_caller]
fn report(differences: Vec<String>) {
    assert!(
        differences.is_empty(),
        "{}\nIf the change is deliberate, write the outputs again with NOVAMIND_WRITE_FROZEN=1 and say in the changelog \
         what readers have to adapt.",
        differences.join("\n")
    );
}

/// Compares an output with the expected output, or writes the expected output. Returns a description of the first difference.
fn compare_or_write(group: &str, name: &str, output: &str) -> Option<String> {
    let path = root().join(group).join(format!("{name}.txt"));
    if std::env::var_os("NOVAMIND_WRITE_FROZEN").is_some() {
        fs::create_dir_all(root().join(group)).expect("a folder");
        fs::write(&path, output).expect("written");
        return None;
    }
    let Ok(expected) = fs::read_to_string(&path) else {
        return Some(format!("{group}/{name}: there is no expected output"));
    };
    if expected == output {
        return None;
    }
    let (mut old, mut new) = (expected.split('\n'), output.split('\n'));
    let mut line = 1;
    loop {
        match (old.next(), new.next()) {
            (before, now) if before == now => line += 1,
            (before, now) => {
                let [before, now] = differing_lines(before.unwrap_or("(end)"), now.unwrap_or("(end)"));
                return Some(format!("{group}/{name}, line {line}:\n  expected {before}\n  found    {now}"));
            }
        }
    }
}

/// Returns the parts of both texts around their first difference.
fn differing_lines<'a>(before: &'a str, now: &'a str) -> [String; 2] {
    let same = before.chars().zip(now.chars()).take_while(|(one, other)| one == other).count();
    let part = |line: &'a str| -> String { line.chars().skip(same.saturating_sub(60)).take(160).collect() };
    [part(before), part(now)]
}

/// Returns a text, or its length and digest if the text is long.
fn stored_form(text: String) -> String {
    match text.len() {
        0..=MAX_STORED_BYTES => text,
        length => format!("({length} bytes, BLAKE3 {})\n", blake3::hash(text.as_bytes()).to_hex()),
    }
}

#[test]
fn output_of_descriptive_commands_is_unchanged() {
    check_group("catalogue");
}

#[test]
fn output_of_run_commands_is_unchanged() {
    check_group("runs");
}

#[test]
fn output_of_exports_and_imports_is_unchanged() {
    check_group("exports");
}

#[test]
fn output_of_lab_commands_is_unchanged() {
    check_group("lab");
}

#[test]
fn output_of_lessons_classes_and_studies_is_unchanged() {
    check_group("people");
}

#[test]
fn output_of_played_runs_is_unchanged() {
    check_group("play");
}

#[test]
fn output_of_program_interfaces_is_unchanged() {
    check_group("agents");
}
