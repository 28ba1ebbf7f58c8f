//! A class on the command line, which is handed out, played on several machines, collected and shown. Every command
//! finds the runs of the class.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::home::{Home, run_id, run_with_input};

/// The folder of a class with three students, and a machine for each student.
struct Classroom {
    teacher: Home,
}

const PLAY_LINES: &str =
    "set_prices A=8 B=20 C=50\nguess 2\nnext naive\nguess 100\nnext naive\nnext naive\nquit\n";

impl Classroom {
    fn new() -> Classroom {
        let room = Classroom { teacher: Home::new() };
        let lesson = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/three-weeks.toml");
        let made = room.teacher.run(&[
            "class",
            "new",
            &lesson.display().to_string(),
            "--students",
            "3",
            "--out",
            &room.folder(),
        ]);
        assert_eq!(made.exit_code, 0, "{}", made.stderr);
        assert!(made.stdout.contains("S01.nm to S03.nm for 3 students"), "{}", made.stdout);
        room
    }

    fn folder(&self) -> String {
        self.teacher.0.path().join("class").display().to_string()
    }

    fn handout(&self, label: &str) -> String {
        format!("{}/{label}.nm", self.folder())
    }
}

fn only_run(machine: &Home, label: &str) -> PathBuf {
    let entries = fs::read_dir(machine.runs().join("participants").join(label)).expect("a folder").flatten();
    let folders: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    assert_eq!(folders.len(), 1);
    folders[0].clone()
}

#[test]
fn class_workflow_from_handouts_to_the_projector_page() {
    let room = Classroom::new();
    let machines = [Home::new(), Home::new()];
    for (machine, label) in machines.iter().zip(["S01", "S02"]) {
        let played = machine.play(&["--handout", &room.handout(label)], PLAY_LINES);
        assert_eq!(played.exit_code, 0, "{}{}", played.stdout, played.stderr);
        assert!(played.stdout.contains("Three weeks · step 1 of 2"), "{}", played.stdout);
    }
    let run = only_run(&machines[0], "S01");
    let program_output = machines[0].play(&["--handout", &room.handout("S01")], "lesson\nquit\n");
    assert!(program_output.stdout.contains("The lesson is complete"), "{}", program_output.stdout);
    only_run(&machines[0], "S01");
    machines[0]
        .run(&["--as", "S02", "play", "--handout", &room.handout("S01")])
        .assert_fails(2, &["leave out --as S02"]);
    let archive = room.teacher.0.path().join("from-one.tar.gz").display().to_string();
    let exported = machines[0].run(&["runs", "export", &run_id(&run), "--out", &archive]);
    assert_eq!(exported.exit_code, 0, "{}", exported.stderr);

    let runs = machines[1].runs().display().to_string();
    let collected = room.teacher.run(&["class", "collect", &room.folder(), &archive, &runs]);
    assert_eq!(collected.exit_code, 1, "a student is missing: {}", collected.stderr);
    assert!(
        collected.stdout.contains("runs: 2 finished") && collected.stdout.contains("! S03: no submission"),
        "{}",
        collected.stdout
    );
    let table = fs::read_to_string(Path::new(&room.folder()).join("class.csv")).expect("a table");
    assert_eq!(table.lines().count(), 3, "{table}");
    assert!(table.starts_with("label,run,part,seed,day,tries,hints,goals,goals_reached"), "{table}");
    let columns = fs::read_to_string(Path::new(&room.folder()).join("class-columns.csv")).expect("a table");
    assert!(columns.contains("of_good,"), "{columns}");

    let output = room.teacher.run(&["class", "show", &room.folder(), "--student", "S02"]);
    assert!(
        output.stdout.contains("Cash by day: S02 #") && output.stdout.contains("100%"),
        "{}{}",
        output.stdout,
        output.stderr
    );
    room.teacher
        .run(&["class", "show", &room.folder(), "--student", "S99"])
        .assert_fails(2, &["no student S99"]);
    let page = room.teacher.0.path().join("class.html").display().to_string();
    let written = room.teacher.run(&["class", "show", &room.folder(), "--hide-names", "--html", &page]);
    assert_eq!(written.exit_code, 0, "{}", written.stderr);
    assert!(!fs::read_to_string(&page).expect("a page").contains("S0"));

    // An archive of a lesson run is complete, so the run can be viewed after the import.
    let teacher = &room.teacher;
    assert_eq!(teacher.run(&["runs", "import", &archive]).exit_code, 0);
    assert_eq!(teacher.run(&["report", &run_id(&run)]).exit_code, 0);
    fs::write(room.handout("S03"), "nothing").expect("written");
    machines[0].play(&["--handout", &room.handout("S03")], "").assert_fails(2, &["not a handout of a class"]);
    room.teacher.run(&["class", "show", "nowhere"]).assert_fails(2, &["contains no class"]);
}

#[test]
fn commands_find_listed_runs_of_participants() {
    let machine = Home::new();
    for label in ["P01", "P02"] {
        let lines = "set_prices A=12\nnext naive\nquit\n";
        let played =
            run_with_input(machine.program().args(["--as", label, "play", "--plain", "--days", "28"]), lines);
        assert_eq!(played.exit_code, 0, "{}", played.stderr);
    }
    let [first, second] = ["P01", "P02"].map(|label| run_id(&only_run(&machine, label)));
    let list = machine.run(&["runs", "list"]).stdout;
    assert!(list.contains(&first) && list.contains(&second), "{list}");
    for command in [
        vec!["report", &first],
        vec!["report", &first[..6], "--card"],
        vec!["replay", &first, "--verify"],
        vec!["query", &first, "SELECT 1"],
        vec!["pictures", &first],
        vec!["lab", "compare", &first, &second],
        vec!["runs", "show", &second],
        vec!["runs", "path", &second],
    ] {
        let answer = machine.run(&command);
        assert_eq!(answer.exit_code, 0, "{command:?}: {}", answer.stderr);
    }
    let report_code = |run: &str| machine.run(&["--as", "P01", "report", run]).exit_code;
    assert_eq!(
        (report_code(&first), report_code(&second)),
        (0, 3),
        "a participant finds only their own runs"
    );
}
