//! Transferring runs: the same run gives the same archive, an interrupted export leaves nothing, and a run is imported to the folder
//! of its player.

use std::fs;
use std::path::Path;

use super::{export, folders, played, text};
use crate::support::home::{Home, Said, id, said};

fn checksum(said: &Said) -> String {
    said.out.split("checksum ").nth(1).expect("a checksum").trim().to_owned()
}

#[test]
fn an_unchanged_run_gives_the_same_archive_each_time() {
    let home = Home::new();
    let run = played(&home, "P01");
    for ending in ["tar", "tar.gz"] {
        let (first, said_first) = export(&home, &run, &format!("first.{ending}"));
        let (second, said_second) = export(&home, &run, &format!("second.{ending}"));
        assert_eq!(checksum(&said_first), checksum(&said_second));
        assert!(fs::read(first).expect("bytes") == fs::read(second).expect("bytes"), "{ending}");
    }
    let go_on = home.play(&["--run", &id(&run)], "set_prices A=13\n");
    assert_eq!(go_on.code, 0, "{}", go_on.err);
    let (_, changed) = export(&home, &run, "third.tar");
    let (_, again) = export(&home, &run, "fourth.tar");
    assert_eq!(checksum(&changed), checksum(&again));
    let before = fs::read(home.0.path().join("first.tar")).expect("bytes");
    assert!(fs::read(home.0.path().join("third.tar")).expect("bytes") != before);
}

#[cfg(unix)]
#[test]
fn an_interrupted_export_leaves_nothing_on_the_stick() {
    let home = Home::new();
    let run = played(&home, "P01");
    let stick = home.0.path().join("stick");
    fs::create_dir(&stick).expect("a folder");
    let hidden = |name: &str| name.starts_with(".novamind-");
    let names = |stick: &Path| -> Vec<String> {
        let entries = fs::read_dir(stick).expect("a folder").flatten();
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
    };
    let (mut tries, mut interrupted) = (0, 0);
    while interrupted < 3 {
        // Sometimes the export finishes before the signal arrives.
        tries += 1;
        assert!(tries < 100, "it was never interrupted");
        let mut program = home.program();
        program.args(["runs", "export", &id(&run), "--out", &text(&stick.join("run.tar.gz"))]);
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
fn a_run_is_imported_into_the_folder_of_its_participant() {
    let (home, lab) = (Home::new(), Home::new());
    let run = played(&home, "P01");
    let (archive, _) = export(&home, &run, "run.tar");
    let own = lab.runs().join("participants/P01");
    let import = |options: &[&str]| lab.run(&[options, &["runs", "import", &text(&archive)]].concat());
    import(&["--as", "P02"]).fails(1, &["belongs to P01, not to P02", "--as P01", "Nothing was imported"]);
    assert!(!lab.runs().join("participants/P02").join(id(&run)).exists());
    fs::create_dir_all(&own).expect("a folder");
    let imported = import(&[]);
    assert_eq!(imported.code, 0, "{}", imported.err);
    assert_eq!(folders(&own), [own.join(id(&run))], "where its participant finds it");
    for options in [&[][..], &["--as", "P01"]] {
        let again = import(options);
        assert!(again.code == 0 && again.out.contains("already exists"), "{}{}", again.out, again.err);
    }
    let list = lab.run(&["runs"]);
    assert_eq!(list.out.matches(&id(&run)).count(), 1, "once on a machine: {}", list.out);
    let mine = said(lab.program().args(["--as", "P01", "runs"]), "");
    assert!(mine.out.contains(&id(&run)), "{}", mine.out);
}
