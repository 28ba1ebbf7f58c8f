//! Studies with people: commands of the experimenter and sessions of participants.

use std::fs;
use std::path::PathBuf;

use novamind::record::trajectory::record::Activity;
use novamind::record::trajectory::{Record, Trajectory};
use novamind::session::read_afterwards;
use novamind::study::{VisitEvent, read_visits};

use crate::support::home::{Home, ProgramOutput, run_id, run_with_input};

/// The home of a machine with a study of five weeks and questions.
struct StudyHome(Home);

impl StudyHome {
    fn new() -> StudyHome {
        let lab = StudyHome(Home::new());
        let made = lab.0.run(&["study", "new", &lab.folder()]);
        assert_eq!(made.exit_code, 0, "{}", made.stderr);
        lab.edit("# days = 84 ", "days = 35 #");
        lab.edit("offer = \"required\"", "offer = \"none\"");
        lab
    }

    fn folder(&self) -> String {
        self.0.0.path().join("pilot").display().to_string()
    }

    fn edit(&self, from: &str, to: &str) {
        let path = self.0.0.path().join("pilot/study.toml");
        let text = fs::read_to_string(&path).expect("a protocol");
        assert!(text.contains(from), "{from}");
        fs::write(path, text.replace(from, to)).expect("written");
    }

    fn assign(&self) {
        let made = self.0.run(&["study", "assign", &self.folder(), "--participants", "3"]);
        assert_eq!(made.exit_code, 0, "{}", made.stderr);
    }

    fn play_session(&self, lines: &str) -> ProgramOutput {
        run_with_input(self.0.program().args(["--study", &self.folder()]), lines)
    }

    fn only_run(&self, label: &str) -> PathBuf {
        let folders =
            fs::read_dir(self.0.runs().join("participants").join(label)).expect("a folder").flatten();
        let mut runs: Vec<PathBuf> = folders.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
        assert_eq!(runs.len(), 1);
        runs.remove(0)
    }

    fn recorded_events(&self) -> Vec<(String, VisitEvent)> {
        let lines = read_visits(&self.0.runs().join("visits.jsonl"));
        lines.into_iter().map(|line| (line.label, line.event)).collect()
    }
}

const WEEKS: &str = "next \"a\" naive\nnext \"b\" naive\nnext \"c\" naive\nnext \"d\" naive\n";

/// Returns questionnaire, occasion, question and value of every answer of a run.
fn recorded_answers(run: &std::path::Path) -> Vec<String> {
    let trajectory = Trajectory::read(&run.join("trajectory.jsonl")).expect("it reads");
    let after = read_afterwards(run, &trajectory).expect("it reads");
    let all = trajectory.lines.iter().chain(&after.lines);
    all.filter_map(|line| match &line.record {
        Record::Activity(Activity::Answer(answer)) => {
            Some(format!("{} {} {} {}", line.day, answer.occasion, answer.id, answer.value))
        }
        _ => None,
    })
    .collect()
}

#[test]
fn participant_session_runs_from_label_to_final_page() {
    play_participant_session("default");
}

#[test]
fn participant_session_runs_under_release_2() {
    play_participant_session("release-2");
}

fn play_participant_session(scenario: &str) {
    let lab = StudyHome::new();
    lab.edit("scenario = \"default\"", &format!("scenario = \"{scenario}\""));
    lab.assign();
    let protocol = lab.0.run(&["study", "protocol", &lab.folder()]).stdout;
    assert!(protocol.contains(&format!("Session: scenario {scenario}, 35 days")), "{protocol}");
    let script = format!("P9\nP01\nwhat?\nyes\n8\n5\nset_prices A=9 B=19\n{WEEKS}4\n2\nquit\n");
    let first = lab.play_session(&script);
    assert_eq!(first.exit_code, 0, "{}", first.stderr);
    for part in
        ["P9 is not a label of this study", "Taking part", "type a number from 1 to 7", "ok set_prices"]
    {
        assert!(first.stdout.contains(part), "{part} is missing in\n{}", first.stdout);
    }
    assert!(!first.stdout.contains("seed"), "participants do not learn the seed");
    // The command that continues can be typed as shown, and contains neither label nor code.
    let again = format!("To continue, run `novamind --study {}` and give the same label.", lab.folder());
    assert!(first.stdout.contains(&again), "{again} is missing in\n{}", first.stdout);
    // The participant returns, ends the run and answers the remaining questions.
    let second = lab.play_session("P01\nnext \"e\" naive\nI tried to grow.\n1, 3\n");
    for part in ["run ended: horizon", "What did you try to do", "Thank you"] {
        assert!(second.stdout.contains(part), "{part} is missing in\n{}", second.stdout);
    }
    assert!(!second.stdout.contains("Taking part"), "consent is asked for once");
    let run = lab.only_run("P01");
    assert_eq!(
        recorded_answers(&run),
        [
            "0 before experience 5",
            "28 week 4 effort 4",
            "28 week 4 reading \"second\"",
            "35 end strategy \"I tried to grow.\"",
            "35 end tools [\"the screens\",\"the tools' documentation\"]",
        ]
    );
    let Record::Start(start) =
        &Trajectory::read(&run.join("trajectory.jsonl")).expect("it reads").lines[0].record
    else {
        panic!("the first line")
    };
    assert_eq!(start.scenario, scenario);
    let stamp = start.study.as_ref().expect("a study");
    assert_eq!((stamp.refused_labels, stamp.order, stamp.practice), (1, Some(1), false));
    assert!(
        start
            .consent
            .as_ref()
            .is_some_and(|consent| consent.text.as_ref().is_some_and(|text| text.contains("Taking part")))
    );
    assert!(start.rules.as_ref().is_some_and(|rules| !rules.advice && rules.code_words.is_none()));
    let third = lab.play_session("P01\n");
    assert!(third.stdout.contains("Thank you"), "{}", third.stdout);
    let seen = lab.recorded_events();
    assert_eq!(seen[0], ("P9".to_owned(), VisitEvent::LabelRefused));
    assert_eq!(seen.iter().filter(|(_, event)| *event == VisitEvent::Finished).count(), 2);
    assert_eq!(lab.0.run(&["replay", &run_id(&run), "--verify", "--as", "P01"]).exit_code, 0);
}

#[test]
fn declined_and_withdrawn_participants_leave_no_run() {
    let lab = StudyHome::new();
    lab.assign();
    let declined = lab.play_session("P02\nno\n");
    assert!(declined.exit_code == 0 && declined.stdout.contains("Kept: your label"), "{}", declined.stdout);
    let withdrew =
        lab.play_session(&format!("P03\nyes\n1\n{WEEKS}1\n2\nwithdraw\nno\nstatus\nwithdraw\nwithdraw\n"));
    assert!(
        withdrew.stdout.contains("subscribers 0")
            && withdrew.stdout.contains("Erased: your runs with all your actions"),
        "{}",
        withdrew.stdout
    );
    assert!(!withdrew.stdout.contains("saved run"), "{}", withdrew.stdout);
    let left: Vec<String> = fs::read_dir(lab.0.runs().join("participants/P03"))
        .expect("a folder")
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    assert_eq!(left, ["withdrawn.toml"]);
    assert!(lab.play_session("P03\n").stdout.contains("You have withdrawn"));
    assert!(!lab.0.runs().join("participants/P02").exists());
    // Both participants are counted and appear in the table of visits.
    let counted =
        "2 came: 1 declined, 1 withdrew, 0 finished, 0 in progress or left · rejected: 0 labels, 0 codes";
    for command in ["watch", "audit"] {
        let program_output = lab.0.run(&["study", command, &lab.folder()]);
        assert!(program_output.stdout.contains(counted), "{}", program_output.stdout);
    }
    let (runs, out) = (lab.0.runs().display().to_string(), lab.0.0.path().join("data"));
    let collected = lab.0.run(&[
        "study",
        "collect",
        &runs,
        &runs,
        "--out",
        &out.display().to_string(),
        "--protocol",
        &lab.folder(),
    ]);
    assert!(collected.stdout.contains(counted), "{}{}", collected.stdout, collected.stderr);
    let visits = fs::read_to_string(out.join("visits.csv")).expect("a table");
    let texts: Vec<String> =
        visits.lines().map(|line| line.splitn(3, ',').take(2).collect::<Vec<_>>().join(" ")).collect();
    assert_eq!(
        texts,
        ["participant event", "P02 came", "P02 consent_declined", "P03 came", "P03 withdrew", "P03 came"]
    );
}

#[test]
fn leaving_and_withdrawing_work_at_every_prompt() {
    let lab = StudyHome::new();
    lab.assign();
    lab.edit("offer = \"none\"", "offer = \"optional\"");
    assert_eq!(lab.play_session("quit\n").exit_code, 0);
    let read = lab.play_session("P01\nmaybe\nquit\n");
    assert!(read.stdout.contains("\"maybe\" is neither yes nor no"), "{}", read.stdout);
    assert!(
        read.stdout.contains("You have left.") && !read.stdout.contains("Type practice"),
        "{}",
        read.stdout
    );
    let passed = lab.play_session("P01\nyes\nperhaps\nskip\nabc\n300\nquit\n");
    for part in [
        "neither practice nor skip",
        "The session begins.",
        "quit to leave, withdraw to erase",
        "To continue",
    ] {
        assert!(passed.stdout.contains(part), "{part} is missing in\n{}", passed.stdout);
    }
    let back = lab.play_session(&format!("P01\n9\n2\nhelp\nhelp branch\n{WEEKS}quit\n"));
    for part in
        ["The session continues before its first week.", "withdraw                 erase", "week 4 done"]
    {
        assert!(back.stdout.contains(part), "{part} is missing in\n{}", back.stdout);
    }
    let refused =
        ["branch WEEK", "step [DAYS]", "xray VIEW", "lens CUSTOMER", "set KEY", "The session begins"];
    assert_eq!(refused.map(|part| back.stdout.contains(part)), [false; 6], "{}", back.stdout);
    assert!(lab.play_session("P01\nquit\n").stdout.contains("The session continues after week 4."));
    let trajectory = Trajectory::read(&lab.only_run("P01").join("trajectory.jsonl")).expect("it reads");
    let changes = trajectory.lines.iter().filter_map(|line| match &line.record {
        Record::Activity(Activity::Answer(answer)) => Some(answer.changes),
        _ => None,
    });
    assert_eq!(changes.collect::<Vec<_>>(), [0], "a rejected line is not an answer");
    for (label, lines) in [
        ("P02", "yes\nskip\nwithdraw\nno\nwithdraw\nwithdraw\n"),
        ("P03", "withdraw\nno\nwithdraw\nwithdraw\n"),
    ] {
        let withdrew = lab.play_session(&format!("{label}\n{lines}"));
        assert!(withdrew.stdout.contains("You have withdrawn"), "{}", withdrew.stdout);
        assert!(lab.recorded_events().contains(&(label.to_owned(), VisitEvent::Withdrew)));
    }
}

#[test]
fn other_commands_require_the_experimenter_code() {
    let lab = StudyHome::new();
    let code = run_with_input(lab.0.program().args(["study", "code"]), "open sesame\n");
    let line = code.stdout.lines().find(|line| line.starts_with("code = ")).expect("a line");
    lab.edit("# code = \"…\"", line);
    let with = |options: &[&str]| lab.0.run(&[&["--study", &lab.folder()], options].concat());
    for command in
        [&["runs"][..], &["run", "--policy", "baseline"], &["scenario", "show", "default"], &["tools"]]
    {
        with(command).assert_fails(2, &["experimenter's code"]);
        with(&[&["--code", "guess"], command].concat())
            .assert_fails(2, &["the code is wrong", "experimenter's code"]);
    }
    assert_eq!(with(&["--code", "open sesame", "runs"]).exit_code, 0);
    // Each wrong code is recorded as a line, without the code.
    let list = fs::read_to_string(lab.0.runs().join("visits.jsonl")).expect("a list");
    assert_eq!(
        (lab.recorded_events(), list.contains("guess")),
        (vec![(String::new(), VisitEvent::CodeRefused); 4], false)
    );
    with(&["play", "--plain", "--seed", "3"]).assert_fails(2, &["protocol"]);
    // A participant who started with one version of the protocol cannot continue with another version.
    lab.play_session("P1\nyes\n3\nquit\n");
    lab.edit("advice = false", "advice = true ");
    assert!(lab.play_session("P1\n").stdout.contains("the study was changed after P1 started"));
}

#[test]
fn practice_results_require_the_experimenter_code() {
    let lab = StudyHome::new();
    lab.edit("offer = \"none\"", "offer = \"required\"");
    let code = run_with_input(lab.0.program().args(["study", "code"]), "open sesame\n");
    let line = code.stdout.lines().find(|line| line.starts_with("code = ")).expect("a line");
    lab.edit("# code = \"…\"", line);
    let begun = lab.play_session("P1\nyes\nnext \"a\" naive\nquit\n");
    assert!(begun.stdout.contains("week 1 done"), "{}", begun.stdout);
    let practice = run_id(&lab.only_run("P1"));
    let as_participant = |command: &[&str]| lab.0.run(&[command, &[&practice, "--as", "P1"]].concat());
    as_participant(&["play", "--plain", "--run"])
        .assert_fails(2, &["continue it with `novamind --study DIR`"]);
    as_participant(&["report"]).assert_fails(2, &["hides its results"]);
    // The remaining three weeks end the practice run, and the session starts.
    let over = lab.play_session("P1\nnext \"b\" naive\nnext \"c\" naive\nnext \"d\" naive\nquit\n");
    assert!(over.stdout.contains("Before you begin"), "{}", over.stdout);
    for command in [&["play", "--plain", "--run"][..], &["report"], &["report", "--session"], &["pictures"]] {
        as_participant(command).assert_fails(2, &["hides its results"]);
    }
    let with_code = ["--study", &lab.folder(), "--code", "open sesame", "report", &practice, "--as", "P1"];
    let report = lab.0.run(&with_code);
    assert_eq!(report.exit_code, 0, "{}", report.stderr);
}

#[test]
fn invalid_protocols_are_reported_with_line_and_key() {
    let lab = StudyHome::new();
    let good = fs::read_to_string(lab.0.0.path().join("pilot/study.toml")).expect("a protocol");
    let line = |start: &str| good.lines().position(|line| line.starts_with(start)).expect(start) + 1;
    for (from, to, parts) in [
        ("plan = \"one\"", "plan = \"lots\"", vec![format!("line {}", line("plan")), "blocks".to_owned()]),
        ("leave_out = []", "leave_out = [\"answer\"]", vec!["cannot be left out".to_owned()]),
        ("leave_out = []", "leave_out = [\"vieuw\"]", vec!["unknown kind of activity vieuw".to_owned()]),
        ("title = ", "titel = ", vec!["titel".to_owned()]),
        ("days = 35", "days = 3", vec!["world.days".to_owned(), format!("line {}", line("days"))]),
    ] {
        fs::write(lab.0.0.path().join("pilot/study.toml"), good.replacen(from, to, 1)).expect("written");
        let parts: Vec<&str> = parts.iter().map(String::as_str).collect();
        lab.0.run(&["study", "check", &lab.folder()]).assert_fails(3, &parts);
    }
    let same =
        good.replace("offer = \"none\"", "offer = \"optional\"").replace("seed = 1_618", "seed = 2_718");
    fs::write(lab.0.0.path().join("pilot/study.toml"), same).expect("written");
    lab.0
        .run(&["study", "check", &lab.folder()])
        .assert_fails(3, &["practice.seed", "also the seed of a session"]);
    fs::write(lab.0.0.path().join("pilot/study.toml"), &good).expect("written");
    let checked = lab.0.run(&["study", "check", &lab.folder()]);
    assert!(
        checked.stdout.contains("digest") && checked.stdout.contains("ok    clock"),
        "{}",
        checked.stdout
    );
    lab.assign();
    lab.0.run(&["study", "assign", &lab.folder(), "--participants", "3"]).assert_fails(1, &["exists"]);
    lab.0.run(&["study", "new", &lab.folder()]).assert_fails(1, &["already a study"]);
}

#[test]
fn watch_lists_sessions_and_writes_remarks() {
    let lab = StudyHome::new();
    lab.assign();
    lab.play_session(&format!("P01\nyes\n3\n{WEEKS}2\n2\nquit\n"));
    lab.play_session("P02\nyes\n3\n");
    let watch = |options: &[&str]| lab.0.run(&[&["study", "watch", &lab.folder()], options].concat());
    let shown = watch(&["--once"]).stdout;
    assert!(shown.contains("0 running · 2 of 3 assigned started") && shown.contains("left"), "{shown}");
    assert_eq!(watch(&["--note", "P01", "asked what a lead is"]).exit_code, 0);
    watch(&["--note", "P 01", "no label"]).assert_fails(2, &["participant label"]);
    assert!(watch(&["--once"]).stdout.contains("P01: asked what a lead is"));
    // The program is killed while a participant plays.
    let mut child = lab.0.program().args(["--study", &lab.folder()]).spawn().expect("it starts");
    use std::io::Write;
    child.stdin.as_mut().expect("a pipe").write_all(b"P03\nyes\n3\nset_prices A=3\n").expect("written");
    let state = || {
        let text = watch(&["--json"]).stdout;
        let lines = text.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).expect("JSON"));
        let value = lines.into_iter().find(|line| line["participant"] == "P03");
        value.map(|line| line["state"].as_str().expect("a state").to_owned())
    };
    while state().as_deref() != Some("plays") {
        std::thread::yield_now();
    }
    child.kill().expect("killed");
    child.wait().expect("it ends");
    assert_eq!(state().as_deref(), Some("stopped"));
}

#[test]
fn protocol_lists_every_measure_and_rule() {
    let lab = StudyHome::new();
    lab.assign();
    let program_output = lab.0.run(&["study", "protocol", &lab.folder()]);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    let digest = lab.0.run(&["study", "check", &lab.folder()]).stdout;
    let digest = digest.lines().find_map(|line| line.trim().strip_prefix("digest ")).expect("a digest");
    let parts = [
        digest,
        "35 days",
        "3 labels are assigned",
        "seed 2718",
        "`effort`: How hard",
        "second session",
        "> # Taking part",
    ];
    for part in parts {
        assert!(program_output.stdout.contains(part), "{part} is missing in\n{}", program_output.stdout);
    }
    let columns = lab.0.run(&["runs", "--json", "columns"]).stdout;
    let columns: serde_json::Value = serde_json::from_str(&columns).expect("JSON");
    for (table, columns) in columns.as_object().expect("tables") {
        assert!(program_output.stdout.contains(&format!("### {table}")), "{table}");
        for column in columns.as_array().expect("columns") {
            let name = column["name"].as_str().expect("a name");
            assert!(program_output.stdout.contains(&format!("| {name} |")), "{name}");
        }
    }
}

#[test]
fn final_page_shows_only_permitted_results() {
    for (results, shows) in [("none", false), ("own", true), ("published", true)] {
        let lab = StudyHome::new();
        lab.edit("results = \"own\"", &format!("results = \"{results}\""));
        for json in [false, true] {
            let label = if json { "P02" } else { "P01" };
            let visit = |lines: &str| {
                let mut program = lab.0.program();
                program.args(["--study", &lab.folder()]).args(json.then_some("--json"));
                run_with_input(&mut program, lines)
            };
            visit(&format!("{label}\nyes\n5\n{WEEKS}4\n2\nquit\n"));
            let end = visit(&format!("{label}\nnext \"e\" naive\nI tried to grow.\n1\n"));
            assert_eq!(end.exit_code, 0, "{}", end.stderr);
            // The result follows the last question.
            let asked = end.stdout.find("What did you try to do").expect("the question");
            let result = end.stdout.find("horizon");
            assert!(result.is_none_or(|result| asked < result), "{}", end.stdout);
            // The start of the output shows the company before the last week. Only the text after it reports the end.
            let (_, after) = match json {
                true => end.stdout.split_once('\n').expect("the greeting"),
                false if shows => {
                    end.stdout.split_at(end.stdout.find("run ended").expect("the end is reported"))
                }
                false => {
                    end.stdout.split_at(end.stdout.find("the run is over").expect("the end is reported"))
                }
            };
            let has_result = after.contains("horizon") && (json || after.contains("score"));
            assert_eq!(has_result, shows, "{results}:\n{after}");
            if !shows {
                let after = after.split_once("\"ok\"").map_or(after, |(_, answer)| answer);
                let shown_words =
                    ["score", "horizon", "dashboard", "cash", "$"].map(|word| after.contains(word));
                assert_eq!(shown_words, [false; 5], "{after}");
                assert!(!end.stdout.contains("day 35 ·") || json, "{}", end.stdout);
            }
            // A participant who returns to the questions is shown the result after them, if the study permits it.
            let label = format!("{label}-back");
            visit(&format!("{label}\nyes\n5\n{WEEKS}4\n2\nnext \"e\" naive\n"));
            let unanswered = visit(&format!("{label}\n"));
            assert!(!unanswered.stdout.contains('$'), "{results}:\n{}", unanswered.stdout);
            let answered = visit(&format!("{label}\nI tried to grow.\n1\n"));
            assert_eq!(answered.stdout.contains('$'), shows, "{results}:\n{}", answered.stdout);
        }
    }
}

#[test]
fn study_keys_seal_snapshots_and_sign_archives() {
    let lab = StudyHome::new();
    lab.assign();
    let made = lab.0.run(&["study", "key", &lab.folder()]);
    assert!(made.exit_code == 0 && made.stdout.contains("fingerprint"), "{}{}", made.stdout, made.stderr);
    let fingerprint =
        made.stdout.lines().find_map(|line| line.strip_prefix("fingerprint ")).expect("one").to_owned();
    let folder = PathBuf::from(lab.folder());
    #[cfg(unix)]
    for name in ["lab.key", "seal.key"] {
        use std::os::unix::fs::PermissionsExt;
        let mode = fs::metadata(folder.join(name)).expect("a file").permissions().mode();
        assert_eq!(mode & 0o777, 0o600, "{name}");
    }
    let program_output = lab.0.run(&["study", "key", &lab.folder()]);
    assert!(
        program_output.stdout.contains("nothing was written") && program_output.stdout.contains(&fingerprint),
        "{}",
        program_output.stdout
    );
    assert_eq!(lab.play_session(&format!("P01\nyes\n5\n{WEEKS}4\n2\nquit\n")).exit_code, 0);
    let run = lab.only_run("P01");
    let sealed_by = || fs::read(run.join("snapshot.bin")).expect("a snapshot")["novamind snapshot 6\n".len()];
    assert_eq!(sealed_by(), b's');
    let second = lab.play_session("P01\nquit\n");
    assert!(!second.stdout.contains("snapshot"), "{}", second.stdout);
    // Without the key, no data is lost, because the run is simulated from its lines.
    let aside = folder.join("aside");
    fs::rename(folder.join("seal.key"), &aside).expect("moved");
    let without = lab.play_session("P01\nset_prices A=7\nquit\n");
    assert!(
        without.stdout.contains("sealed with the key of a study") && without.stdout.contains("ok set_prices")
    );
    fs::rename(&aside, folder.join("seal.key")).expect("moved");
    let damaged = fs::read(folder.join("seal.key")).expect("a key");
    fs::write(folder.join("seal.key"), "no key").expect("written");
    lab.0.run(&["--study", &lab.folder()]).assert_fails(2, &["seal.key is not a key file of this kind"]);
    fs::write(folder.join("seal.key"), damaged).expect("written");
    assert_eq!(lab.play_session("P01\nquit\n").exit_code, 0);
    assert_eq!(sealed_by(), b's');
    // With the key in the folder of the study, every export and collection is signed.
    let out = lab.0.0.path().join("p01.tar.gz").display().to_string();
    let export = |file: &str, place: &std::path::Path| {
        run_with_input(
            lab.0.program().current_dir(place).args(["runs", "export", &run_id(&run), "--out", file]),
            "",
        )
    };
    let signed = export(&out, &folder);
    assert!(
        signed.stdout.contains(&format!("signed by the lab key {fingerprint}")),
        "{}{}",
        signed.stdout,
        signed.stderr
    );
    let collect = |sources: &[&str], out: &str| {
        let (data, study) = (lab.0.0.path().join(out).display().to_string(), lab.folder());
        let all = [&["study", "collect"], sources, &["--out", &data, "--protocol", &study]].concat();
        lab.0.run(&all)
    };
    let collected = collect(&[&out], "data");
    assert!(
        collected.stdout.contains(&format!("signed by the lab key {fingerprint}")),
        "{}",
        collected.stdout
    );
    assert!(!collected.stdout.contains("not signed"), "{}", collected.stdout);
    let bare = lab.0.0.path().join("bare.tar.gz").display().to_string();
    assert_eq!(export(&bare, lab.0.0.path()).exit_code, 0);
    let noted = collect(&[&bare], "data-2");
    assert!(noted.exit_code == 1 && noted.stdout.contains("not signed: "), "{}", noted.stdout);
    // The audit checks the signatures of archives in the given folders.
    let of_folder = |name: &str| {
        let place = lab.0.0.path().join(name).display().to_string();
        lab.0.run(&["study", "audit", &lab.folder(), &place])
    };
    let archives = of_folder("data").stdout;
    assert!(archives.contains("nothing examined") && !archives.contains("not signed"), "{archives}");
    fs::create_dir(lab.0.0.path().join("loose")).expect("a folder");
    fs::copy(&bare, lab.0.0.path().join("loose/p01.tar.gz")).expect("copied");
    let loose = of_folder("loose");
    assert!(loose.exit_code == 1 && loose.stdout.contains("archive not signed"), "{}", loose.stdout);
    let audited = lab.0.run(&["study", "audit", &lab.folder()]);
    assert!(audited.stdout.contains("No findings"), "{}", audited.stdout);
}
