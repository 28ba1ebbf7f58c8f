//! Transfer of runs: exports of the same run are equal, an interrupted export leaves no file, and a run is imported
//! into the folder of its participant.

use std::fs;
use std::path::Path;

use super::{export_run, played_run, run_folders, text};
use crate::support::home::{Home, ProgramOutput, run_id, run_with_input};

fn checksum(program_output: &ProgramOutput) -> String {
    program_output.stdout.split("checksum ").nth(1).expect("a checksum").trim().to_owned()
}

#[test]
fn export_is_reproducible() {
    let home = Home::new();
    let run = played_run(&home, "P01");
    for ending in ["tar", "tar.gz"] {
        let (first, first_output) = export_run(&home, &run, &format!("first.{ending}"));
        let (second, second_output) = export_run(&home, &run, &format!("second.{ending}"));
        assert_eq!(checksum(&first_output), checksum(&second_output));
        assert!(fs::read(first).expect("bytes") == fs::read(second).expect("bytes"), "{ending}");
    }
    let go_on = home.play(&["--run", &run_id(&run)], "set_prices A=13\n");
    assert_eq!(go_on.exit_code, 0, "{}", go_on.stderr);
    let (_, changed) = export_run(&home, &run, "third.tar");
    let (_, program_output) = export_run(&home, &run, "fourth.tar");
    assert_eq!(checksum(&changed), checksum(&program_output));
    let before = fs::read(home.0.path().join("first.tar")).expect("bytes");
    assert!(fs::read(home.0.path().join("third.tar")).expect("bytes") != before);
}

#[cfg(unix)]
#[test]
fn interrupted_export_leaves_no_file() {
    let home = Home::new();
    let run = played_run(&home, "P01");
    let stick = home.0.path().join("stick");
    fs::create_dir(&stick).expect("a folder");
    let hidden = |name: &str| name.starts_with(".novamind-");
    let names = |stick: &Path| -> Vec<String> {
        let entries = fs::read_dir(stick).expect("a folder").flatten();
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
    };
    let (mut tries, mut interrupted) = (0, 0);
    while interrupted < 3 {
        // The export can finish before the signal arrives, so the test tries several times.
        tries += 1;
        assert!(tries < 100, "it was never interrupted");
        let mut program = home.program();
        program.args(["runs", "export", &run_id(&run), "--out", &text(&stick.join("run.tar.gz"))]);
        let mut child = program.spawn().expect("it starts");
        while !names(&stick).iter().any(|name| hidden(name)) && child.try_wait().expect("a process").is_none()
        {
            std::thread::yield_now();
        }
        let _ = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        let code = child.wait().expect("it ends").code();
        interrupted += usize::from(code == Some(128 + 2));
        let left: Vec<String> = names(&stick).into_iter().filter(|name| hidden(name)).collect();
        assert_eq!(left, Vec::<String>::new(), "exit code {code:?}");
        let _ = fs::remove_file(stick.join("run.tar.gz"));
    }
}

#[test]
fn run_is_imported_into_the_folder_of_its_participant() {
    let (home, lab) = (Home::new(), Home::new());
    let run = played_run(&home, "P01");
    let (archive, _) = export_run(&home, &run, "run.tar");
    let path = lab.runs().join("participants/P01");
    let import = |options: &[&str]| lab.run(&[options, &["runs", "import", &text(&archive)]].concat());
    import(&["--as", "P02"])
        .assert_fails(1, &["belongs to P01, not to P02", "--as P01", "Nothing was imported"]);
    assert!(!lab.runs().join("participants/P02").join(run_id(&run)).exists());
    fs::create_dir_all(&path).expect("a folder");
    let imported = import(&[]);
    assert_eq!(imported.exit_code, 0, "{}", imported.stderr);
    assert_eq!(run_folders(&path), [path.join(run_id(&run))], "the folder in which its participant finds it");
    for options in [&[][..], &["--as", "P01"]] {
        let program_output = import(options);
        assert!(
            program_output.exit_code == 0 && program_output.stdout.contains("already exists"),
            "{}{}",
            program_output.stdout,
            program_output.stderr
        );
    }
    let list = lab.run(&["runs"]);
    assert_eq!(list.stdout.matches(&run_id(&run)).count(), 1, "one copy per machine: {}", list.stdout);
    let mine = run_with_input(lab.program().args(["--as", "P01", "runs"]), "");
    assert!(mine.stdout.contains(&run_id(&run)), "{}", mine.stdout);
}
