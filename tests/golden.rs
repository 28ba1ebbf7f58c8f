//! Distributions over seeds agree with the released simulator (chapter 70 §4).

use std::path::Path;
use std::process::Command;

/// Figures of mechanics that are not built yet.
const NOT_YET: [&str; 4] = ["ent_accepted*", "ent_acc_*", "ent_cancel*", "notif_cum"];

#[test]
fn policies_end_where_the_released_simulator_ends() {
    let runs = tempfile::tempdir().expect("a folder");
    let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/golden");
    let mut command = Command::new(env!("CARGO_BIN_EXE_novamind"));
    command.args(["lab", "golden"]).arg(reference).env("NOVAMIND_RUNS", runs.path());
    NOT_YET.iter().for_each(|figure| {
        command.args(["--without", figure]);
    });
    let output = command.output().expect("the program starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    for policy in ["P0", "P1a", "P1b", "P6"] {
        assert!(said.contains(&format!("{policy} ")), "{policy} was not compared:\n{said}");
    }
}
