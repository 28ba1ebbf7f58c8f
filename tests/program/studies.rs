//! Studies with people, from the view of experimenter and participants.

use std::fs;
use std::path::PathBuf;

use novamind::record::trajectory::record::Activity;
use novamind::record::trajectory::{Record, Trajectory};
use novamind::session::lines_afterwards;
use novamind::study::{VisitEvent, visits};

use crate::support::home::{Home, Said, id, said};

/// A study of five weeks with questions, with its own machine.
struct Lab(Home);

impl Lab {
    fn new() -> Lab {
        let lab = Lab(Home::new());
        let made = lab.0.run(&["study", "new", &lab.folder()]);
        assert_eq!(made.code, 0, "{}", made.err);
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
        assert_eq!(made.code, 0, "{}", made.err);
    }

    fn visit(&self, lines: &str) -> Said {
        said(self.0.program().args(["--study", &self.folder()]), lines)
    }

    fn only_run(&self, label: &str) -> PathBuf {
        let folders =
            fs::read_dir(self.0.runs().join("participants").join(label)).expect("a folder").flatten();
        let mut runs: Vec<PathBuf> = folders.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
        assert_eq!(runs.len(), 1);
        runs.remove(0)
    }

    fn events(&self) -> Vec<(String, VisitEvent)> {
        let lines = visits(&self.0.runs().join("visits.jsonl"));
        lines.into_iter().map(|line| (line.label, line.event)).collect()
    }
}

const WEEKS: &str = "next \"a\" naive\nnext \"b\" naive\nnext \"c\" naive\nnext \"d\" naive\n";

/// Returns questionnaire, occasion, question and value of every answer of a run.
fn answers(run: &std::path::Path) -> Vec<String> {
    let trajectory = Trajectory::read(&run.join("trajectory.jsonl")).expect("it reads");
    let after = lines_afterwards(run, &trajectory).expect("it reads");
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
fn a_participant_is_led_from_the_label_to_the_thanks() {
    let lab = Lab::new();
    lab.assign();
    let script = format!("P9\nP01\nwhat?\nyes\n8\n5\nset_prices A=9 B=19\n{WEEKS}4\n2\nquit\n");
    let first = lab.visit(&script);
    assert_eq!(first.code, 0, "{}", first.err);
    for part in
        ["P9 is not a label of this study", "Taking part", "type a number from 1 to 7", "ok set_prices"]
    {
        assert!(first.out.contains(part), "{part} is missing in\n{}", first.out);
    }
    assert!(!first.out.contains("seed"), "participants do not learn the seed");
    // The command that continues can be typed as shown, and contains neither label nor code.
    let again = format!("To continue, run `novamind --study {}` and give the same label.", lab.folder());
    assert!(first.out.contains(&again), "{again} is missing in\n{}", first.out);
    // They return, end the run, and answer the remaining questions.
    let second = lab.visit("P01\nnext \"e\" naive\nI tried to grow.\n1, 3\n");
    for part in ["run ended: horizon", "What did you try to do", "Thank you"] {
        assert!(second.out.contains(part), "{part} is missing in\n{}", second.out);
    }
    assert!(!second.out.contains("Taking part"), "consent is asked for once");
    let run = lab.only_run("P01");
    assert_eq!(
        answers(&run),
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
    let stamp = start.study.as_ref().expect("a study");
    assert_eq!((stamp.refused_labels, stamp.order, stamp.practice), (1, Some(1), false));
    assert!(
        start
            .consent
            .as_ref()
            .is_some_and(|consent| consent.text.as_ref().is_some_and(|text| text.contains("Taking part")))
    );
    assert!(start.rules.as_ref().is_some_and(|rules| !rules.advice && rules.code_words.is_none()));
    let third = lab.visit("P01\n");
    assert!(third.out.contains("Thank you"), "{}", third.out);
    let seen = lab.events();
    assert_eq!(seen[0], ("P9".to_owned(), VisitEvent::LabelRefused));
    assert_eq!(seen.iter().filter(|(_, event)| *event == VisitEvent::Finished).count(), 2);
    assert_eq!(lab.0.run(&["replay", &id(&run), "--verify", "--as", "P01"]).code, 0);
}

#[test]
fn who_declines_or_withdraws_leaves_no_run() {
    let lab = Lab::new();
    lab.assign();
    let declined = lab.visit("P02\nno\n");
    assert!(declined.code == 0 && declined.out.contains("Kept: your label"), "{}", declined.out);
    let withdrew =
        lab.visit(&format!("P03\nyes\n1\n{WEEKS}1\n2\nwithdraw\nno\nstatus\nwithdraw\nwithdraw\n"));
    assert!(
        withdrew.out.contains("subscribers 0") && withdrew.out.contains("Erased: your runs with everything"),
        "{}",
        withdrew.out
    );
    assert!(!withdrew.out.contains("saved run"), "{}", withdrew.out);
    let left: Vec<String> = fs::read_dir(lab.0.runs().join("participants/P03"))
        .expect("a folder")
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    assert_eq!(left, ["withdrawn.toml"]);
    assert!(lab.visit("P03\n").out.contains("You have withdrawn"));
    assert!(!lab.0.runs().join("participants/P02").exists());
    // Both are counted and in the table of visits.
    let counted = "2 came: 1 declined, 1 withdrew, 0 finished, 0 neither · refused: 0 labels, 0 codes";
    for command in ["watch", "audit"] {
        let said = lab.0.run(&["study", command, &lab.folder()]);
        assert!(said.out.contains(counted), "{}", said.out);
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
    assert!(collected.out.contains(counted), "{}{}", collected.out, collected.err);
    let visits = fs::read_to_string(out.join("visits.csv")).expect("a table");
    let told: Vec<String> =
        visits.lines().map(|line| line.splitn(3, ',').take(2).collect::<Vec<_>>().join(" ")).collect();
    assert_eq!(
        told,
        ["participant event", "P02 came", "P02 consent_declined", "P03 came", "P03 withdrew", "P03 came"]
    );
}

#[test]
fn at_every_prompt_and_question_one_can_leave_or_withdraw() {
    let lab = Lab::new();
    lab.assign();
    lab.edit("offer = \"none\"", "offer = \"optional\"");
    assert_eq!(lab.visit("quit\n").code, 0);
    let read = lab.visit("P01\nmaybe\nquit\n");
    assert!(read.out.contains("\"maybe\" is neither yes nor no"), "{}", read.out);
    assert!(read.out.contains("You have left.") && !read.out.contains("Type practice"), "{}", read.out);
    let passed = lab.visit("P01\nyes\nperhaps\nskip\nabc\n300\nquit\n");
    for part in
        ["neither practice nor skip", "The session begins.", "quit leaves, withdraw erases", "To continue"]
    {
        assert!(passed.out.contains(part), "{part} is missing in\n{}", passed.out);
    }
    let back = lab.visit(&format!("P01\n9\n2\nhelp\nhelp branch\n{WEEKS}quit\n"));
    for part in
        ["The session continues before its first week.", "withdraw                 erase", "week 4 done"]
    {
        assert!(back.out.contains(part), "{part} is missing in\n{}", back.out);
    }
    let refused =
        ["branch WEEK", "step [DAYS]", "xray VIEW", "lens CUSTOMER", "set KEY", "The session begins"];
    assert_eq!(refused.map(|part| back.out.contains(part)), [false; 6], "{}", back.out);
    assert!(lab.visit("P01\nquit\n").out.contains("The session continues after week 4."));
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
        let withdrew = lab.visit(&format!("{label}\n{lines}"));
        assert!(withdrew.out.contains("You have withdrawn"), "{}", withdrew.out);
        assert!(lab.events().contains(&(label.to_owned(), VisitEvent::Withdrew)));
    }
}

#[test]
fn in_a_study_nothing_else_opens_without_the_code() {
    let lab = Lab::new();
    let code = said(lab.0.program().args(["study", "code"]), "open sesame\n");
    let line = code.out.lines().find(|line| line.starts_with("code = ")).expect("a line");
    lab.edit("# code = \"…\"", line);
    let with = |options: &[&str]| lab.0.run(&[&["--study", &lab.folder()], options].concat());
    for command in
        [&["runs"][..], &["run", "--policy", "baseline"], &["scenario", "show", "default"], &["tools"]]
    {
        with(command).fails(2, &["experimenter's code"]);
        with(&[&["--code", "guess"], command].concat()).fails(2, &["experimenter's code"]);
    }
    assert_eq!(with(&["--code", "open sesame", "runs"]).code, 0);
    // Each wrong code is recorded as a line, without the code.
    let list = fs::read_to_string(lab.0.runs().join("visits.jsonl")).expect("a list");
    assert_eq!(
        (lab.events(), list.contains("guess")),
        (vec![(String::new(), VisitEvent::CodeRefused); 4], false)
    );
    with(&["play", "--plain", "--seed", "3"]).fails(2, &["protocol"]);
    // A participant who started under one protocol cannot continue under another.
    lab.visit("P1\nyes\n3\nquit\n");
    lab.edit("advice = false", "advice = true ");
    assert!(lab.visit("P1\n").out.contains("the study was changed after P1 started"));
}

#[test]
fn a_practice_shows_no_results_to_any_command_without_the_code() {
    let lab = Lab::new();
    lab.edit("offer = \"none\"", "offer = \"required\"");
    let code = said(lab.0.program().args(["study", "code"]), "open sesame\n");
    let line = code.out.lines().find(|line| line.starts_with("code = ")).expect("a line");
    lab.edit("# code = \"…\"", line);
    let begun = lab.visit("P1\nyes\nnext \"a\" naive\nquit\n");
    assert!(begun.out.contains("week 1 done"), "{}", begun.out);
    let practice = id(&lab.only_run("P1"));
    let as_participant = |command: &[&str]| lab.0.run(&[command, &[&practice, "--as", "P1"]].concat());
    as_participant(&["play", "--plain", "--run"]).fails(2, &["continue it with `novamind --study DIR`"]);
    as_participant(&["report"]).fails(2, &["hides its results"]);
    // The other three weeks end it, and the session starts.
    let over = lab.visit("P1\nnext \"b\" naive\nnext \"c\" naive\nnext \"d\" naive\nquit\n");
    assert!(over.out.contains("Before you begin"), "{}", over.out);
    for command in [&["play", "--plain", "--run"][..], &["report"], &["report", "--session"], &["pictures"]] {
        as_participant(command).fails(2, &["hides its results"]);
    }
    let with_code = ["--study", &lab.folder(), "--code", "open sesame", "report", &practice, "--as", "P1"];
    let report = lab.0.run(&with_code);
    assert_eq!(report.code, 0, "{}", report.err);
}

#[test]
fn wrong_protocols_are_named_with_line_and_key() {
    let lab = Lab::new();
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
        lab.0.run(&["study", "check", &lab.folder()]).fails(3, &parts);
    }
    let same =
        good.replace("offer = \"none\"", "offer = \"optional\"").replace("seed = 1_618", "seed = 2_718");
    fs::write(lab.0.0.path().join("pilot/study.toml"), same).expect("written");
    lab.0.run(&["study", "check", &lab.folder()]).fails(3, &["practice.seed", "also the seed of a session"]);
    fs::write(lab.0.0.path().join("pilot/study.toml"), &good).expect("written");
    let checked = lab.0.run(&["study", "check", &lab.folder()]);
    assert!(checked.out.contains("digest") && checked.out.contains("ok    clock"), "{}", checked.out);
    lab.assign();
    lab.0.run(&["study", "assign", &lab.folder(), "--participants", "3"]).fails(1, &["exists"]);
    lab.0.run(&["study", "new", &lab.folder()]).fails(1, &["already a study"]);
}

#[test]
fn an_experimenter_watches_and_notes() {
    let lab = Lab::new();
    lab.assign();
    lab.visit(&format!("P01\nyes\n3\n{WEEKS}2\n2\nquit\n"));
    lab.visit("P02\nyes\n3\n");
    let watch = |options: &[&str]| lab.0.run(&[&["study", "watch", &lab.folder()], options].concat());
    let shown = watch(&["--once"]).out;
    assert!(shown.contains("0 running · 2 of 3 assigned have begun") && shown.contains("left"), "{shown}");
    assert_eq!(watch(&["--note", "P01", "asked what a lead is"]).code, 0);
    watch(&["--note", "P 01", "no label"]).fails(2, &["participant label"]);
    assert!(watch(&["--once"]).out.contains("P01: asked what a lead is"));
    // A participant plays, and the program is killed.
    let mut child = lab.0.program().args(["--study", &lab.folder()]).spawn().expect("it starts");
    use std::io::Write;
    child.stdin.as_mut().expect("a pipe").write_all(b"P03\nyes\n3\nset_prices A=3\n").expect("written");
    let state = || {
        let said = watch(&["--json"]).out;
        let lines = said.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).expect("JSON"));
        let own = lines.into_iter().find(|line| line["participant"] == "P03");
        own.map(|line| line["state"].as_str().expect("a state").to_owned())
    };
    while state().as_deref() != Some("plays") {
        std::thread::yield_now();
    }
    child.kill().expect("killed");
    child.wait().expect("it ends");
    assert_eq!(state().as_deref(), Some("stopped"));
}

#[test]
fn the_protocol_tells_every_measure_and_every_rule() {
    let lab = Lab::new();
    lab.assign();
    let said = lab.0.run(&["study", "protocol", &lab.folder()]);
    assert_eq!(said.code, 0, "{}", said.err);
    let digest = lab.0.run(&["study", "check", &lab.folder()]).out;
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
        assert!(said.out.contains(part), "{part} is missing in\n{}", said.out);
    }
    let columns = lab.0.run(&["runs", "--json", "columns"]).out;
    let columns: serde_json::Value = serde_json::from_str(&columns).expect("JSON");
    for (table, columns) in columns.as_object().expect("tables") {
        assert!(said.out.contains(&format!("### {table}")), "{table}");
        for column in columns.as_array().expect("columns") {
            let name = column["name"].as_str().expect("a name");
            assert!(said.out.contains(&format!("| {name} |")), "{name}");
        }
    }
}

#[test]
fn the_end_shows_what_the_protocol_says_and_no_more() {
    for (results, shows) in [("none", false), ("own", true), ("published", true)] {
        let lab = Lab::new();
        lab.edit("results = \"own\"", &format!("results = \"{results}\""));
        for json in [false, true] {
            let label = if json { "P02" } else { "P01" };
            let visit = |lines: &str| {
                let mut program = lab.0.program();
                program.args(["--study", &lab.folder()]).args(json.then_some("--json"));
                said(&mut program, lines)
            };
            visit(&format!("{label}\nyes\n5\n{WEEKS}4\n2\nquit\n"));
            let end = visit(&format!("{label}\nnext \"e\" naive\n"));
            assert_eq!(end.code, 0, "{}", end.err);
            // The start of the session shows the company as of the last week.
            let (_, after) = match json {
                true => end.out.split_once('\n').expect("the greeting"),
                false if shows => end.out.split_at(end.out.find("run ended").expect("the end is reported")),
                false => end.out.split_at(end.out.find("the run is over").expect("the end is reported")),
            };
            let told = after.contains("horizon") && (json || after.contains("score"));
            assert_eq!(told, shows, "{results}:\n{after}");
            if !shows {
                let after = after.split_once("\"ok\"").map_or(after, |(_, answer)| answer);
                let told = ["score", "horizon", "dashboard", "cash", "$"].map(|word| after.contains(word));
                assert_eq!(told, [false; 5], "{after}");
                assert!(!end.out.contains("day 35 ·") || json, "{}", end.out);
            }
            // A participant who returns to the questions does not see it either.
            let again = visit(&format!("{label}\n"));
            assert_eq!(again.out.contains('$'), shows, "{results}:\n{}", again.out);
        }
    }
}

#[test]
fn the_keys_of_a_study_seal_snapshots_and_sign_archives() {
    let lab = Lab::new();
    lab.assign();
    let made = lab.0.run(&["study", "key", &lab.folder()]);
    assert!(made.code == 0 && made.out.contains("fingerprint"), "{}{}", made.out, made.err);
    let fingerprint =
        made.out.lines().find_map(|line| line.strip_prefix("fingerprint ")).expect("one").to_owned();
    let folder = PathBuf::from(lab.folder());
    #[cfg(unix)]
    for name in ["lab.key", "seal.key"] {
        use std::os::unix::fs::PermissionsExt;
        let mode = fs::metadata(folder.join(name)).expect("a file").permissions().mode();
        assert_eq!(mode & 0o777, 0o600, "{name}");
    }
    let again = lab.0.run(&["study", "key", &lab.folder()]);
    assert!(again.out.contains("nothing was written") && again.out.contains(&fingerprint), "{}", again.out);
    assert_eq!(lab.visit(&format!("P01\nyes\n5\n{WEEKS}4\n2\nquit\n")).code, 0);
    let run = lab.only_run("P01");
    let sealed_by = || fs::read(run.join("snapshot.bin")).expect("a snapshot")["novamind snapshot 6\n".len()];
    assert_eq!(sealed_by(), b's');
    let second = lab.visit("P01\nquit\n");
    assert!(!second.out.contains("snapshot"), "{}", second.out);
    // Without the key nothing is lost: the run is simulated from its lines.
    let aside = folder.join("aside");
    fs::rename(folder.join("seal.key"), &aside).expect("moved");
    let without = lab.visit("P01\nset_prices A=7\nquit\n");
    assert!(without.out.contains("sealed with the key of a study") && without.out.contains("ok set_prices"));
    fs::rename(&aside, folder.join("seal.key")).expect("moved");
    let damaged = fs::read(folder.join("seal.key")).expect("a key");
    fs::write(folder.join("seal.key"), "no key").expect("written");
    lab.0.run(&["--study", &lab.folder()]).fails(2, &["seal.key is not a key of this kind"]);
    fs::write(folder.join("seal.key"), damaged).expect("written");
    assert_eq!(lab.visit("P01\nquit\n").code, 0);
    assert_eq!(sealed_by(), b's');
    // In the folder of the study every export and collection is signed.
    let out = lab.0.0.path().join("p01.tar.gz").display().to_string();
    let export = |file: &str, place: &std::path::Path| {
        said(lab.0.program().current_dir(place).args(["runs", "export", &id(&run), "--out", file]), "")
    };
    let signed = export(&out, &folder);
    assert!(
        signed.out.contains(&format!("signed by the lab key {fingerprint}")),
        "{}{}",
        signed.out,
        signed.err
    );
    let collect = |sources: &[&str], out: &str| {
        let (data, study) = (lab.0.0.path().join(out).display().to_string(), lab.folder());
        let all = [&["study", "collect"], sources, &["--out", &data, "--protocol", &study]].concat();
        lab.0.run(&all)
    };
    let collected = collect(&[&out], "data");
    assert!(collected.out.contains(&format!("signed by the lab key {fingerprint}")), "{}", collected.out);
    assert!(!collected.out.contains("not signed"), "{}", collected.out);
    let bare = lab.0.0.path().join("bare.tar.gz").display().to_string();
    assert_eq!(export(&bare, lab.0.0.path()).code, 0);
    let noted = collect(&[&bare], "data-2");
    assert!(noted.code == 1 && noted.out.contains("not signed: "), "{}", noted.out);
    // The audit checks the signatures of archives in the given folders.
    let of_folder = |name: &str| {
        let place = lab.0.0.path().join(name).display().to_string();
        lab.0.run(&["study", "audit", &lab.folder(), &place])
    };
    let archives = of_folder("data").out;
    assert!(archives.contains("nothing examined") && !archives.contains("not signed"), "{archives}");
    fs::create_dir(lab.0.0.path().join("loose")).expect("a folder");
    fs::copy(&bare, lab.0.0.path().join("loose/p01.tar.gz")).expect("copied");
    let loose = of_folder("loose");
    assert!(loose.code == 1 && loose.out.contains("archive not signed"), "{}", loose.out);
    let audited = lab.0.run(&["study", "audit", &lab.folder()]);
    assert!(audited.out.contains("No findings"), "{}", audited.out);
}
