//! A class from the command line: handed out, played on several machines, collected, shown; every command finds its runs.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::home::{Home, id, said};

/// A class of three in a folder, and a machine for each student.
struct Classroom {
    teacher: Home,
}

const PLAYED: &str =
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
        assert_eq!(made.code, 0, "{}", made.err);
        assert!(made.out.contains("S01.nm to S03.nm for 3 students"), "{}", made.out);
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
fn a_class_goes_from_hand_outs_to_the_projector() {
    let room = Classroom::new();
    let machines = [Home::new(), Home::new()];
    for (machine, label) in machines.iter().zip(["S01", "S02"]) {
        let played = machine.play(&["--handout", &room.handout(label)], PLAYED);
        assert_eq!(played.code, 0, "{}{}", played.out, played.err);
        assert!(played.out.contains("Three weeks · step 1 of 2"), "{}", played.out);
    }
    let run = only_run(&machines[0], "S01");
    let again = machines[0].play(&["--handout", &room.handout("S01")], "lesson\nquit\n");
    assert!(again.out.contains("The lesson is complete"), "{}", again.out);
    only_run(&machines[0], "S01");
    machines[0]
        .run(&["--as", "S02", "play", "--handout", &room.handout("S01")])
        .fails(2, &["leave out --as S02"]);
    let archive = room.teacher.0.path().join("from-one.tar.gz").display().to_string();
    let exported = machines[0].run(&["runs", "export", &id(&run), "--out", &archive]);
    assert_eq!(exported.code, 0, "{}", exported.err);

    let runs = machines[1].runs().display().to_string();
    let collected = room.teacher.run(&["class", "collect", &room.folder(), &archive, &runs]);
    assert_eq!(collected.code, 1, "a student is missing: {}", collected.err);
    assert!(
        collected.out.contains("runs: 2 finished") && collected.out.contains("! S03: no submission"),
        "{}",
        collected.out
    );
    let table = fs::read_to_string(Path::new(&room.folder()).join("class.csv")).expect("a table");
    assert_eq!(table.lines().count(), 3, "{table}");
    assert!(table.starts_with("label,run,part,seed,day,tries,hints,goals,goals_reached"), "{table}");
    let columns = fs::read_to_string(Path::new(&room.folder()).join("class-columns.csv")).expect("a table");
    assert!(columns.contains("of_good,"), "{columns}");

    let shown = room.teacher.run(&["class", "show", &room.folder(), "--student", "S02"]);
    assert!(
        shown.out.contains("Cash by day: S02 #") && shown.out.contains("100%"),
        "{}{}",
        shown.out,
        shown.err
    );
    room.teacher.run(&["class", "show", &room.folder(), "--student", "S99"]).fails(2, &["no student S99"]);
    let page = room.teacher.0.path().join("class.html").display().to_string();
    let written = room.teacher.run(&["class", "show", &room.folder(), "--hide-names", "--html", &page]);
    assert_eq!(written.code, 0, "{}", written.err);
    assert!(!fs::read_to_string(&page).expect("a page").contains("S0"));

    // An archive of a lesson is complete: importing it is enough to view the run.
    let teacher = &room.teacher;
    assert_eq!(teacher.run(&["runs", "import", &archive]).code, 0);
    assert_eq!(teacher.run(&["report", &id(&run)]).code, 0);
    fs::write(room.handout("S03"), "nothing").expect("written");
    machines[0].play(&["--handout", &room.handout("S03")], "").fails(2, &["not a handout of a class"]);
    room.teacher.run(&["class", "show", "nowhere"]).fails(2, &["contains no class"]);
}

#[test]
fn every_command_finds_the_runs_of_participants_that_the_list_shows() {
    let machine = Home::new();
    for label in ["P01", "P02"] {
        let lines = "set_prices A=12\nnext naive\nquit\n";
        let played = said(machine.program().args(["--as", label, "play", "--plain", "--days", "28"]), lines);
        assert_eq!(played.code, 0, "{}", played.err);
    }
    let [first, second] = ["P01", "P02"].map(|label| id(&only_run(&machine, label)));
    let list = machine.run(&["runs", "list"]).out;
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
        assert_eq!(answer.code, 0, "{command:?}: {}", answer.err);
    }
    let own = |run: &str| machine.run(&["--as", "P01", "report", run]).code;
    assert_eq!((own(&first), own(&second)), (0, 3), "a participant finds only their own runs");
}
