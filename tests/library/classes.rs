//! A class of thirty students, which is created, played on thirty machines, collected and shown.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use novamind::course::{
    Class, ClassCollection, ClassFinding, CollectionInput, Handout, HandoutSource, Lesson, RunVerdict,
    retry_step, submit_guess,
};
use novamind::record::folder::configuration::Configuration;
use novamind::record::folder::manifest_check::read_manifest;
use novamind::record::trajectory::record::Via;
use novamind::report::class::{
    ClassDisplayOptions, ClassView, class_to_html, class_to_text, column_descriptions, rows,
};
use novamind::rules::calls_for_waiting_threads;
use novamind::session::{Access, Export, NewRun, SealKey, Session, Storage, lesson_step};
use serde_json::json;
use tempfile::TempDir;

use crate::support::forging::forge_lines;

struct TestClass {
    place: TempDir,
    class: Class,
}

impl TestClass {
    fn new(what: &HandoutSource, students: u32) -> TestClass {
        let place = tempfile::tempdir().expect("a folder");
        let class = Class::create(&place.path().join("class"), what, students).expect("a class");
        TestClass { place, class }
    }

    fn folder(&self) -> PathBuf {
        self.place.path().join("class")
    }

    fn handout(&self, label: &str) -> PathBuf {
        self.folder().join(format!("{label}.nm"))
    }

    fn machine(&self, name: &str) -> PathBuf {
        self.place.path().join("machines").join(name)
    }

    /// Opens a handout on a separate machine and returns the folder of its run.
    fn open_handout(&self, label: &str, machine: &str) -> PathBuf {
        let runs = self.machine(machine);
        let run = Handout::read(&self.handout(label)).expect("a handout").ensure_run(&runs).expect("a run");
        runs.join("participants").join(label).join(run)
    }

    /// Plays a handout with a price on a separate machine and returns the folder of its run.
    fn play(&self, label: &str, machine: &str, price: f64, weeks: u32) -> PathBuf {
        let folder = self.open_handout(label, machine);
        play_weeks(&folder, price, weeks);
        folder
    }

    fn collect(&self, places: &[PathBuf]) -> ClassCollection {
        let folder = self.folder();
        let sources = CollectionInput { class: &self.class, folder: &folder, places };
        ClassCollection::collect(&sources, calls_for_waiting_threads, &mut |_, _| {}).expect("collected")
    }
}

fn play_weeks(folder: &Path, price: f64, weeks: u32) {
    let mut session = Session::open(folder, Access::Write, true).expect("it opens");
    session
        .call("set_prices", &json!({"A": price, "B": price * 2.5, "C": price * 6.25}), Via::Script)
        .expect("prices");
    for _ in 0..weeks {
        let awaits = |session: &Session| {
            lesson_step(session).is_some_and(|step| session.lesson().is_some_and(|it| it.awaits_guess(step)))
        };
        if awaits(&session) {
            submit_guess(&mut session, if price < 20.0 { 2.0 } else { 1.0 }).expect("a guess");
        }
        let forecasts = session.company().naive_forecasts();
        session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    }
}

fn lesson() -> HandoutSource {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/three-weeks.toml");
    HandoutSource::Lesson(Arc::new(Lesson::from_file(&path).expect("a lesson")))
}

/// Forges lines of a run. Removes the database and the snapshot, which store the position in the original trajectory.
fn forge_run(folder: &Path, change: impl Fn(usize, &mut serde_json::Value)) {
    forge_lines(folder, change);
    let kept = ["run.toml", "trajectory.jsonl", "lesson.toml", "lesson.md"];
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        if !kept.contains(&entry.file_name().to_string_lossy().as_ref()) {
            fs::remove_file(entry.path()).expect("removed");
        }
    }
}

/// Exports a run as an archive and removes the run.
fn export_and_remove_run(folder: &Path, archive: &Path) {
    let parent = archive.parent().expect("a folder");
    fs::create_dir_all(parent).expect("a folder");
    let export = Export::prepare(folder, parent, &SealKey::default()).expect("it is whole");
    export.write(archive, false, None).expect("written");
    drop(export);
    fs::remove_dir_all(folder).expect("removed");
}

fn replace_in_file(path: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(path).expect("a text");
    assert!(text.contains(from), "{from} in {}", path.display());
    fs::write(path, text.replacen(from, to, 1)).expect("written");
}

#[test]
fn class_of_thirty_is_collected_completely() {
    let school = TestClass::new(&lesson(), 30);
    let (altered, forged, twice, missing, open) = ("S05", "S06", "S07", "S08", "S09");
    for (number, student) in school.class.students.iter().enumerate() {
        let label = student.label.as_str();
        let price = 8.0 + 1.5 * number as f64;
        let machine = format!("machine-{label}");
        match label {
            "S08" => {}
            "S09" => drop(school.play(label, &machine, price, 2)),
            "S07" => {
                school.play(label, &machine, price, 3);
                school.play(label, "machine-two", 40.0, 3);
            }
            _ => {
                let folder = school.play(label, &machine, price, 3);
                match label {
                    // Changes a figure without updating the checksum of its line.
                    "S05" => replace_in_file(
                        &folder.join("trajectory.jsonl"),
                        "\"event\":\"goal\"",
                        "\"event\":\"hint\"",
                    ),
                    // Improves the result of a goal, with recomputed checksums and hash chain.
                    "S06" => forge_run(&folder, |_, line| {
                        if line["event"] == "goal" {
                            line["value"] = json!(99_999.0);
                            line["met"] = json!(true);
                        }
                    }),
                    _ if number % 3 == 0 => {
                        let archive = school.machine("archives").join(format!("{label}.tar.gz"));
                        export_and_remove_run(&folder, &archive);
                    }
                    _ => {}
                }
            }
        }
    }
    // A duplicate of a run does not count as a second run.
    let again = school.machine("archives").join("copy-of-S01.tar.gz");
    fs::copy(school.machine("archives").join("S01.tar.gz"), &again).expect("copied");
    // Runs on a machine that do not belong to the class are ignored.
    let other = Storage::Runs(school.machine("machine-S02"));
    drop(Session::create(
        NewRun { storage: other, days: Some(28), ..NewRun::default() },
        &Configuration::bundled(),
    ));

    let collection = school.collect(&[school.place.path().join("machines")]);
    let mut found: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for finding in &collection.findings {
        let kind = match finding {
            ClassFinding::Unreadable { problem, .. } => {
                assert!(problem.contains("line "), "{problem}");
                "unreadable"
            }
            ClassFinding::Altered { problem, .. } => {
                assert!(problem.contains("the event has 99999 for step 2"), "{problem}");
                "altered"
            }
            ClassFinding::Conflicting { paths, .. } => {
                assert_eq!(paths.len(), 2);
                "twice"
            }
            ClassFinding::Missing { .. } => "missing",
            ClassFinding::NotFinished { parts, .. } => {
                assert_eq!(*parts, [1]);
                "open"
            }
            other => panic!("{other:?}"),
        };
        found.entry(finding.label().expect("a label")).or_default().push(kind);
    }
    let expected: BTreeMap<&str, Vec<&str>> = [
        (altered, vec!["unreadable"]),
        (forged, vec!["altered"]),
        (twice, vec!["twice"]),
        (missing, vec!["missing"]),
        (open, vec!["open"]),
    ]
    .into();
    assert_eq!(found, expected);
    assert_eq!((collection.superseded, collection.others), (1, 1));
    let of = |verdict| collection.runs.iter().filter(|run| run.verdict == verdict).count();
    assert_eq!(of(RunVerdict::Finished), 25);
    assert_eq!(
        (of(RunVerdict::Conflicting), of(RunVerdict::NotFinished), of(RunVerdict::Altered)),
        (2, 1, 1)
    );
    assert_eq!(ClassCollection::read(&school.folder()).expect("kept"), collection);
    check_tables(&school, &collection);
}

fn check_tables(school: &TestClass, collection: &ClassCollection) {
    let lesson = school.class.stored_lesson(&school.folder()).expect("kept");
    let view = |display_options| ClassView {
        class: &school.class,
        lesson: lesson.as_ref(),
        collection,
        display: display_options,
    };
    let plain = view(ClassDisplayOptions::default());
    let table = rows(&plain);
    assert_eq!(table.len(), collection.runs.len() + 1);
    let column = |name: &str| table[0].iter().position(|cell| cell == name).expect(name);
    let first = table.iter().find(|row| row[0] == "S01").expect("a row");
    assert_eq!(
        first[column("of_good")],
        "1",
        "S01 plays like the reference play: {first:?} {:?}",
        collection.references
    );
    assert_eq!(
        (first[column("goals_reached")].as_str(), first[column("verdict")].as_str()),
        ("1", "finished")
    );
    assert_eq!((first[column("guesses_right")].as_str(), first[column("pitfalls")].as_str()), ("1", ""));
    let last = table.iter().find(|row| row[0] == "S30").expect("a row");
    assert_eq!((last[column("goals_reached")].as_str(), last[column("pitfalls")].as_str()), ("0", "dear"));
    let explained: Vec<String> =
        column_descriptions(&plain).into_iter().skip(1).map(|row| row[0].clone()).collect();
    assert_eq!(explained, table[0], "every column has a description");

    let text = class_to_text(&plain);
    let ranking: Vec<&str> = text.lines().filter(|line| line.contains('%') && line.contains("/1")).collect();
    assert_eq!(ranking.len(), 25, "{text}");
    assert!(ranking[0].contains("S01") && ranking[0].contains("100%"), "{text}");
    for part in
        ["price A across, cash up", "Most common pitfall: dear, by ", "Will a higher price", "! S05: "]
    {
        assert!(text.contains(part), "{part} in {text}");
    }
    let hidden =
        class_to_text(&view(ClassDisplayOptions { hides_names: true, ..ClassDisplayOptions::default() }));
    assert!(hidden.contains("no. 25") && !hidden.contains("S0") && !hidden.contains("S1"), "{hidden}");
    let page = class_to_html(&view(ClassDisplayOptions {
        highlighted_student: Some("S12".to_owned()),
        ..ClassDisplayOptions::default()
    }));
    for foreign in ["<script", "http://", "https://", "src=", "href=", "url(", "@import"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    assert_eq!(page.matches("<polyline class=\"curve c").count(), 25);
    assert_eq!(page.matches("checked=\"checked\"").count(), 1);
    let page =
        class_to_html(&view(ClassDisplayOptions { hides_names: true, ..ClassDisplayOptions::default() }));
    assert!(!page.contains("S01") && page.contains("no. 1"), "the page contains no label");
    let wrong =
        view(ClassDisplayOptions { figure: Some("subscriber".to_owned()), ..ClassDisplayOptions::default() })
            .check();
    assert!(wrong.expect_err("no such figure").contains("subscribers"));
}

#[test]
fn modified_handout_is_rejected() {
    let school = TestClass::new(&lesson(), 1);
    let path = school.handout("S01");
    let whole = fs::read_to_string(&path).expect("a handout");
    let seven = whole.replacen("label = \"S01\"", "label = \"S02\"", 1);
    let easy = whole.replacen("relative = 0.9", "relative = 0.1", 1);
    let lines = whole.replace('\n', "\r\n");
    for text in [seven.as_str(), &easy, &lines, &whole[..whole.len() - 20], &format!("{whole}\n"), ""] {
        assert_ne!(text, whole);
        fs::write(&path, text).expect("written");
        let error = Handout::read(&path).expect_err("it is refused").to_string();
        assert!(error.contains("S01.nm") && error.contains("Ask for the handout again"), "{error}");
    }
    fs::write(&path, whole.replacen("format = 1", "format = 9", 1)).expect("written");
    assert!(Handout::read(&path).expect_err("a later format").to_string().contains("a later version"));
    fs::write(&path, [0xff, 0xfe]).expect("written");
    assert!(Handout::read(&path).is_err());
    let collection = school.collect(&[school.folder()]);
    assert!(collection.findings.contains(&ClassFinding::AlteredHandout { label: "S01".to_owned() }));
}

#[test]
fn handout_resumes_its_run_and_retries_keep_its_stamp() {
    let school = TestClass::new(&lesson(), 2);
    let folder = school.open_handout("S02", "one");
    assert_eq!(folder.file_name().expect("a name").to_string_lossy(), school.class.students[1].run);
    let manifest = read_manifest(&folder).expect("a manifest");
    assert_eq!(manifest.participant.as_deref(), Some("S02"));
    play_weeks(&folder, 40.0, 3);
    assert_eq!(school.open_handout("S02", "one"), folder, "the finished run is shown");
    let first = Session::open(&folder, Access::Write, true).expect("it opens");
    let session = retry_step(&first, 0).expect("a try");
    drop(first);
    let id = session.manifest().id.clone();
    drop(session);
    let path = school.open_handout("S02", "one");
    assert_eq!(path, folder.with_file_name(&id), "the open attempt continues");
    play_weeks(&path, 8.0, 3);
    let collection = school.collect(&[school.machine("one")]);
    assert_eq!(collection.runs.iter().filter(|run| run.verdict == RunVerdict::Finished).count(), 2);
    assert_eq!(collection.runs.iter().map(|run| run.evidence.tries).max(), Some(2));
    assert_eq!(collection.findings, [ClassFinding::Missing { label: "S01".to_owned() }]);

    // A handout with an easier lesson and a new seal: the runs have a different lesson digest.
    let easier = Session::open(&path, Access::Read, false).expect("it opens").manifest().id.clone();
    forge_run(&path, |at, line| {
        if at == 0 {
            line["lesson"]["digest"] = json!("0".repeat(64));
        }
    });
    let label = "S02".to_owned();
    let other = school.collect(std::slice::from_ref(&path)).findings;
    assert!(other.contains(&ClassFinding::OtherLesson { label, run: easier }), "{other:?}");
    forge_run(&path, |at, line| {
        if at == 0 {
            line["lesson"]["digest"] = json!(school.class.lesson.as_ref().expect("a lesson").digest);
            line["lesson"]["part"] = json!(0);
        }
    });
    let other = school.collect(std::slice::from_ref(&path)).findings;
    assert!(matches!(&other[..], [ClassFinding::Missing { .. }, ClassFinding::Altered { .. }]), "{other:?}");

    // The run belongs to the handout of another student, and its first line is changed to the player's label.
    forge_run(&folder, |at, line| {
        if at == 0 {
            line["participant"] = json!("S01");
        }
    });
    let collection = school.collect(std::slice::from_ref(&folder));
    let of = Some("S02".to_owned());
    let label = "S01".to_owned();
    let run = school.class.students[1].run.clone();
    assert!(
        collection.findings.contains(&ClassFinding::OtherHandout { label, run, of }),
        "{:?}",
        collection.findings
    );
}

#[test]
fn handout_of_a_run_has_separate_labels_and_names() {
    let teacher = tempfile::tempdir().expect("a folder");
    let storage = Storage::Runs(teacher.path().to_owned());
    let new = NewRun { storage, days: Some(70), seed: Some(5), ..NewRun::default() };
    let session = Session::create(new, &Configuration::bundled()).expect("a run");
    let folder = session.folder().expect("a folder").to_owned();
    drop(session);
    play_weeks(&folder, 12.0, 2);
    let school = TestClass::new(&HandoutSource::Run(folder), 3);
    let [first, second] =
        [("S01", 8.0), ("S02", 30.0)].map(|(label, price)| school.play(label, label, price, 3));
    assert_ne!(first.file_name(), second.file_name());
    let played = Session::open(&first, Access::Read, true).expect("it opens");
    assert_eq!((played.day(), played.manifest().seed), (35, 5));
    drop(played);
    let collection = school.collect(&[school.place.path().join("machines")]);
    assert_eq!(
        ClassCollection::read(&school.folder()).expect("kept"),
        collection,
        "quotas without limits are not numbers"
    );
    let verdicts: Vec<RunVerdict> = collection.runs.iter().map(|run| run.verdict).collect();
    assert_eq!(verdicts, [RunVerdict::NotFinished, RunVerdict::NotFinished]);
    assert!(collection.findings.contains(&ClassFinding::Missing { label: "S03".to_owned() }));
    let display_options = ClassDisplayOptions::default();
    let view =
        ClassView { class: &school.class, lesson: None, collection: &collection, display: display_options };
    let text = class_to_text(&view);
    assert!(text.contains("Ranked by cash on the last day that every run has reached"), "{text}");

    let refused = Class::create(&school.folder(), &lesson(), 3).expect_err("the class is there").to_string();
    assert!(refused.contains("choose another folder"), "{refused}");
}
