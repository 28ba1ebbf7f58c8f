//! Preparation and supervision of a study: the commands `check`, `assign`, `watch` and `protocol`.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use crate::support::home::{Home, ProgramOutput, run_with_input};

/// The home of a machine with a study of four weeks, without questions and practice.
struct StudyHome(Home);

impl StudyHome {
    fn new() -> StudyHome {
        let lab = StudyHome(Home::new());
        assert_eq!(lab.0.run(&["study", "new", &lab.folder()]).exit_code, 0);
        lab.edit("# days = 84 ", "days = 28 #");
        lab.edit("offer = \"required\"", "offer = \"none\"");
        for questions in ["1-before", "2-effort", "3-end"] {
            fs::remove_file(lab.path(&format!("pilot/questions/{questions}.toml"))).expect("gone");
        }
        lab
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.0.path().join(name)
    }

    fn folder(&self) -> String {
        self.path("pilot").display().to_string()
    }

    fn edit(&self, from: &str, to: &str) {
        let path = self.path("pilot/study.toml");
        let text = fs::read_to_string(&path).expect("a protocol");
        assert!(text.contains(from), "{from}");
        fs::write(path, text.replace(from, to)).expect("written");
    }

    fn run(&self, command: &str, options: &[&str]) -> ProgramOutput {
        self.0.run(&[&["study", command, &self.folder()], options].concat())
    }

    fn play_session(&self, machine: &str, lines: &str) -> ProgramOutput {
        let mut program = self.0.program();
        program.env("NOVAMIND_RUNS", self.path(machine));
        run_with_input(program.args(["--study", &self.folder()]), lines)
    }

    fn assignment(&self) -> String {
        fs::read_to_string(self.path("pilot/assignment.csv")).expect("an assignment")
    }
}

#[test]
fn removed_settings_are_reported_and_ignored() {
    let lab = StudyHome::new();
    let clean = lab.run("check", &[]).stdout;
    assert!(!clean.contains("removed"), "{clean}");
    lab.edit("[access]", "[integrity]\nwitness = \"share\"\ncode_words = true\n\n[access]");
    fs::create_dir(lab.path("pilot/share")).expect("a folder");
    let checked = lab.run("check", &[]);
    assert_eq!(checked.exit_code, 0, "{}{}", checked.stdout, checked.stderr);
    for key in ["witness", "code_words"] {
        let words = format!("note  settings    [integrity] {key} was removed and has no effect");
        assert!(checked.stdout.contains(&words), "{}", checked.stdout);
    }
    let visit = lab.play_session("m1", "P1\nyes\nnext \"a\" naive\nquit\n");
    assert!(visit.exit_code == 0 && !visit.stdout.contains("code:"), "{}{}", visit.stdout, visit.stderr);
    assert_eq!(lab.path("pilot/share").read_dir().expect("a folder").count(), 0);
    let audited = lab.run("audit", &[&lab.path("m1").display().to_string()]);
    assert_eq!(audited.exit_code, 0, "{}{}", audited.stdout, audited.stderr);
    assert!(audited.stderr.contains("[integrity] witness was removed"), "{}", audited.stderr);
    // A key that never existed is still rejected.
    lab.edit("code_words = true", "code_word = true");
    lab.run("check", &[]).assert_fails(3, &["study.toml", "code_word"]);
}

#[test]
fn check_reports_impossible_designs() {
    let lab = StudyHome::new();
    let questionnaire = |weeks: &str| {
        let text = format!(
            "title = \"Week\"\nwhen = \"weeks\"\nweeks = [{weeks}]\n[[question]]\nid = \"a\"\ntext = \"How?\"\nform = \"text\"\n"
        );
        fs::write(lab.path("pilot/questions/week.toml"), text).expect("written");
    };
    questionnaire("2, 9");
    let output = lab.run("check", &[]);
    assert_eq!(output.exit_code, 0, "{}", output.stderr);
    for words in [
        "ok    world       scenario default\n",
        "note  questions   questions/week.toml is due after week 9: a session has 4 weeks",
        "note  forecasts   forecasts that come due in 4 weeks: 4 for 7 days ahead, 1 for 28 days ahead, 0 for 84",
    ] {
        assert!(output.stdout.contains(words), "{words} is missing in\n{}", output.stdout);
    }
    questionnaire("9");
    let output = lab.run("check", &[]);
    assert!(
        output.exit_code == 1 && output.stdout.contains("WRONG questions   questions/week.toml is due"),
        "{}",
        output.stdout
    );
    questionnaire("2");
    lab.edit("# week_minutes = 20", "week_minutes = 2");
    lab.edit("# warning_minutes = 2", "warning_minutes = 2");
    lab.run("check", &[])
        .assert_fails(3, &["limits.warning_minutes", "week_minutes = 2 would be shown from the start"]);
    lab.edit("warning_minutes = 2", "warning_minutes = 1");
    lab.edit("offer = \"none\"", "offer = \"optional\"");
    let output = lab.run("check", &[]).stdout;
    assert!(output.contains("scenario default, practice scenario practice\n"), "{output}");
}

#[test]
fn assign_add_keeps_existing_rows() {
    let lab = StudyHome::new();
    lab.edit(
        "plan = \"one\" ",
        "plan = \"blocks\"\nblock = [11, 12, 13]\nconditions = [\"A\", \"B\"]\ndraw = 5 ",
    );
    lab.run("assign", &["--add", "3"]).assert_fails(2, &["no assignment yet"]);
    lab.run("assign", &["--participants", "8", "--draw", "6"]).assert_fails(2, &["draw = 5"]);
    let made = lab.run("assign", &["--participants", "8"]);
    assert!(made.stdout.contains("the last block has 2 of 6 cells; with 12 participants"), "{}", made.stdout);
    let text = lab.run("check", &[]).stdout;
    assert!(text.contains("8 labels in blocks of 6: the last block has 2 of 6 cells"), "{text}");
    let first = lab.assignment();
    lab.run("assign", &["--participants", "12"]).assert_fails(1, &["--add N"]);
    let added = lab.run("assign", &["--add", "4"]);
    assert!(
        added.exit_code == 0 && added.stdout.contains("12 participants"),
        "{}{}",
        added.stdout,
        added.stderr
    );
    let second = lab.assignment();
    assert!(second.starts_with(&first) && second.contains("\nP12,"), "{second}");
    let mut cells: Vec<&str> =
        second.lines().skip(7).map(|line| line.split_once(',').expect("a label").1).collect();
    cells.iter_mut().for_each(|cell| *cell = cell.rsplit_once(',').expect("an order").0);
    cells.sort_unstable();
    assert_eq!(cells, ["A,11", "A,12", "A,13", "B,11", "B,12", "B,13"]);
    // Rows that were edited by hand are kept, and the file does not change.
    let by_hand = second.replacen(",A,", ",C,", 1);
    fs::write(lab.path("pilot/assignment.csv"), &by_hand).expect("written");
    lab.run("assign", &["--add", "1"]).assert_fails(1, &["were not drawn with seed 5", "by hand"]);
    assert_eq!(lab.assignment(), by_hand);
}

#[test]
fn remark_is_stored_next_to_the_runs() {
    let lab = StudyHome::new();
    assert_eq!(lab.run("assign", &["--participants", "3"]).exit_code, 0);
    lab.play_session("m1", "P01\nyes\nquit\n");
    lab.play_session("m2", "P02\nyes\nquit\n");
    let machines = [lab.path("m1").display().to_string(), lab.path("m2").display().to_string()];
    let note =
        |label: &str, text: &str| lab.run("watch", &[&machines[0], &machines[1], "--note", label, text]);
    let program_output = note("P02", "came late");
    assert!(
        program_output.stdout.contains("recorded a note for P02 in")
            && program_output.stdout.contains("m2/remarks.jsonl"),
        "{}",
        program_output.stdout
    );
    assert!(note("P01", "asked what a lead is").stdout.contains("m1/remarks.jsonl"));
    assert_eq!(note("P03", "has not come").exit_code, 0, "a label of the assignment");
    assert_eq!(note("P02", "left early").exit_code, 0);
    note("P99", "who is it?").assert_fails(2, &["P99 is not a label of this study", "Nothing was recorded"]);
    let shown = lab.run("watch", &[&machines[0], &machines[1], "--once"]).stdout;
    let texts = ["came late", "asked what a lead is", "has not come", "left early"];
    let places: Vec<usize> = texts.iter().map(|text| shown.find(text).expect(text)).collect();
    assert!(places.is_sorted(), "by time\n{shown}");
}

#[test]
fn protocol_lists_randomization_and_limits() {
    let lab = StudyHome::new();
    lab.edit(
        "plan = \"one\" ",
        "plan = \"blocks\"\nblock = [11, 12]\nconditions = [\"A\", \"B\"]\ndraw = 5 ",
    );
    lab.edit("# week_minutes = 20", "week_minutes = 20");
    lab.edit("# warning_minutes = 2", "warning_minutes = 3");
    lab.edit("at_limit = \"remind\"", "at_limit = \"naive\"");
    lab.edit("offer = \"none\"", "offer = \"optional\"");
    assert_eq!(lab.run("assign", &["--participants", "4"]).exit_code, 0);
    let bare = lab.run("protocol", &[]).stdout;
    assert!(bare.contains("There is no lab key"), "{bare}");
    let made = lab.run("key", &[]).stdout;
    let fingerprint = made.lines().find_map(|line| line.strip_prefix("fingerprint ")).expect("one");
    let digest = blake3::hash(lab.assignment().as_bytes()).to_hex().to_string();
    let text = lab.run("protocol", &[]).stdout;
    for words in [
        format!("signed by the lab key {fingerprint}"),
        format!(
            "4 labels are assigned (in blocks of 4, drawn with seed 5, BLAKE3 hash of assignment.csv {digest})"
        ),
        "Conditions: A, B. They label and balance participants. The program is the same".to_owned(),
        "The practice uses the same rules".to_owned(),
        "| The practice starts with the tour (console) | yes |".to_owned(),
        "| Minutes per week of the company | 20 |".to_owned(),
        "| Minutes per session | no limit |".to_owned(),
        "warned | 3 |".to_owned(),
        "week limit: the week is filed with naive forecasts".to_owned(),
        "if no other follows within 60 s".to_owned(),
        "no; the week report and the Cash and Journal screens".to_owned(),
    ] {
        assert!(text.contains(&words), "{words} is missing in\n{text}");
    }
    fs::write(lab.path("pilot/assignment.csv"), lab.assignment().replacen(",A,", ",B,", 1)).expect("written");
    assert!(
        lab.run("protocol", &[]).stdout.contains("not as `novamind study assign` draws them with seed 5")
    );
}

#[test]
fn secret_seeds_are_drawn_once_and_kept_by_added_participants() {
    let lab = StudyHome::new();
    lab.edit("plan = \"one\"", "plan = \"secret\"\nconditions = [\"A\", \"B\"] #");
    lab.edit("seed = 2_718\n", "count = 2\n");
    lab.run("assign", &["--participants", "3"]).assert_fails(2, &["assign at least 4 participants"]);
    assert_eq!(lab.run("assign", &["--participants", "4"]).exit_code, 0);
    let first = lab.assignment();
    let seeds = |text: &str| -> BTreeSet<u64> {
        let seed = |line: &str| line.split(',').nth(2).expect("a seed").parse().expect("a number");
        text.lines().skip(1).map(seed).collect()
    };
    assert_eq!(seeds(&first).len(), 2);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let file = fs::metadata(lab.path("pilot/assignment.csv")).expect("a file");
        assert_eq!(file.permissions().mode() & 0o777, 0o600);
    }
    assert!(seeds(&first).iter().all(|seed| (1 << 32..1 << 63).contains(seed)), "{first}");
    assert_eq!(lab.run("assign", &["--add", "5"]).exit_code, 0);
    let added = lab.assignment();
    assert!(added.starts_with(&first) && seeds(&added) == seeds(&first), "{first}\n{added}");
    let protocol = lab.run("protocol", &[]).stdout;
    assert!(
        protocol.contains("plays 2 secret seeds in random order. Commitment to the seeds: pilot:"),
        "{protocol}"
    );
    assert!(seeds(&first).iter().all(|seed| !protocol.contains(&seed.to_string())), "{protocol}");
    // Another draw has other seeds, and so another commitment.
    fs::remove_file(lab.path("pilot/assignment.csv")).expect("removed");
    assert_eq!(lab.run("assign", &["--participants", "4"]).exit_code, 0);
    assert!(seeds(&lab.assignment()).is_disjoint(&seeds(&first)));
    lab.edit("count = 2", "count = 2\nseed = 7");
    lab.run("check", &[]).assert_fails(3, &["leave out seed and block"]);
}

#[test]
fn small_seeds_of_a_hosted_study_are_noted() {
    let lab = StudyHome::new();
    assert!(!lab.run("check", &[]).stdout.contains("below 4,294,967,296"));
    fs::create_dir(lab.path("pilot/host")).expect("a folder");
    let checked = lab.run("check", &[]);
    assert!(
        checked.stdout.contains("note  seeds       a seed of the sessions is below 4,294,967,296"),
        "{}",
        checked.stdout
    );
    lab.edit("seed = 2_718", "seed = 4_294_967_296");
    assert!(!lab.run("check", &[]).stdout.contains("below 4,294,967,296"));
}
