//! Distributions over seeds agree with the released simulator (chapter 70 §4).

use std::path::Path;
use std::process::Command;

#[test]
fn policies_end_where_the_released_simulator_ends() {
    let runs = tempfile::tempdir().expect("a folder");
    let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/golden");
    let mut command = Command::new(env!("CARGO_BIN_EXE_novamind"));
    command.args(["lab", "golden"]).arg(reference).env("NOVAMIND_RUNS", runs.path());
    let output = command.output().expect("the program starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    for policy in ["P0", "P10", "P1a", "P1b", "P6", "P8"] {
        assert!(said.contains(&format!("{policy} ")), "{policy} was not compared:\n{said}");
    }
}
