//! A whole study without a screen: twelve scripted participants on three machines, then the experimenter's commands on their
//! runs. The tables are compared with the actions of the scripts: every line, time, week, question and decision.
//!
//!     cargo test --test study

mod console;
mod diary;
#[path = "../console/harness.rs"]
#[allow(dead_code, reason = "the console tests use the rest")]
mod harness;
mod lab;
mod limits;
mod plain;
mod scripts;
#[path = "../support/mod.rs"]
mod support;
mod tables;

use std::sync::Mutex;

use lab::StudyLab;
use support::python::recompute_measures;

/// Held by tests that control the clock of the whole process.
static CLOCK: Mutex<()> = Mutex::new(());

#[test]
fn tables_match_twelve_scripted_participants() {
    let _clock = CLOCK.lock();
    let lab = StudyLab::new();
    let mut diaries = scripts::play_first_machine(&lab);
    diaries.extend(scripts::play_second_machine(&lab));
    diaries.extend(scripts::play_third_machine(&lab));
    let program_output = lab.collect();
    // Two participants have no session, which `collect` reports.
    let notes = [
        "label P05 has no session; last visit: consent declined",
        "label P06 has no session; last visit: withdrew",
        "12 came: 1 declined, 1 withdrew, 10 finished, 0 in progress or left · rejected: 2 labels, 0 codes",
    ];
    let output_lines = program_output.stdout.lines().filter(|line| !line.contains("verified"));
    assert_eq!(
        output_lines.filter(|line| !line.is_empty()).collect::<Vec<_>>(),
        notes,
        "{}",
        program_output.stdout
    );
    tables::compare_tables(&lab, &diaries);
    if let Some((output, code)) = recompute_measures(&lab.tables_folder()) {
        assert_eq!(code, Some(0), "{output}");
    }
    tables::compare_anonymized_tables(&lab, &diaries);
    lab.assert_audit_finds_nothing();
}
