//! A participant of a study at the console, from the label to the final page.

use std::path::{Path, PathBuf};

use novamind::record::consent::ConsentMeans;
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Activity;
use novamind::record::trajectory::{Record, Trajectory};
use novamind::session::{Access, SeekTarget, read_afterwards};
use novamind::study::{CodeDigest, Study, VisitEvent, read_visits};
use novamind::tui::glyphs::Glyphs;
use novamind::worker::request::{RecordSource, Request};

use super::harness::Console;
use novamind::console::app::Settings;

/// A study of two weeks with every kind of question, and its folder.
pub(super) struct StudyHome(tempfile::TempDir);

const PROTOCOL: &str = r#"
name = "pilot"
title = "Two weeks"
[world]
scenario = "short"
days = 14
[seeds]
plan = "one"
seed = 5
[practice]
offer = "none"
[access]
code = "CODE"
"#;

const QUESTIONNAIRE_BEFORE_FIRST_WEEK: &str = r#"
title = "About you"
introduction = "Two questions before you begin."
when = "before"
[[question]]
id = "experience"
text = "How much experience do you have?"
form = "likert"
points = 7
low = "none"
high = "much"
required = true
[[question]]
id = "age"
text = "How old are you?"
form = "number"
min = 18
max = 99
unit = "years"
"#;

const WEEK: &str = r#"
title = "This week"
when = "weeks"
weeks = [1]
[[question]]
id = "check"
text = "Choose the second option."
form = "attention"
options = ["first", "second"]
expected = "second"
required = true
[[question]]
id = "tools"
text = "What helped?"
form = "choice"
options = ["SQL", "forms", "notes"]
several = true
"#;

const END: &str = r#"
title = "The end"
when = "end"
[[question]]
id = "strategy"
text = "What did you try?"
form = "text"
most = 40
required = true
"#;

impl StudyHome {
    pub(super) fn new() -> StudyHome {
        let lab = StudyHome(tempfile::tempdir().expect("a folder"));
        let folder = lab.folder();
        std::fs::create_dir_all(folder.join("questions")).expect("a folder");
        let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("written");
        write("study.toml", &PROTOCOL.replace("CODE", CodeDigest::from_code("open sesame", "salt").as_str()));
        let consent: Vec<String> =
            (1..=40).map(|line| format!("- Paragraph {line} of\n**what** is recorded.")).collect();
        write("consent.md", &consent.join("\n"));
        write("questions/1-before.toml", QUESTIONNAIRE_BEFORE_FIRST_WEEK);
        write("questions/2-week.toml", WEEK);
        write("questions/3-end.toml", END);
        write("assignment.csv", "label,condition,seed,order\nP01,,,1\nP02,,,2\n");
        lab
    }

    /// Returns a study without questions after weeks.
    pub(super) fn without_week_questions() -> StudyHome {
        let lab = StudyHome::new();
        std::fs::remove_file(lab.folder().join("questions/2-week.toml")).expect("removed");
        lab
    }

    /// Returns the console of the hosted session of a participant, at the participant's next step.
    pub(super) fn open_hosted_console(
        &self,
        label: &str,
        configuration: Configuration,
        size: (u16, u16),
    ) -> Console {
        let study = Study::load(&self.folder()).expect("a study");
        let settings = Settings { hosted: true, ..Console::settings(configuration, &self.runs()) };
        let mut console = Console::with_settings(settings, size);
        console.start_hosted_session(study, label).expect("the first page");
        console
    }

    pub(super) fn edit_protocol(&self, from: &str, to: &str) {
        let path = self.folder().join("study.toml");
        let text = std::fs::read_to_string(&path).expect("a protocol");
        assert!(text.contains(from), "{from}");
        std::fs::write(path, text.replace(from, to)).expect("written");
    }

    pub(super) fn folder(&self) -> PathBuf {
        self.0.path().join("pilot")
    }

    pub(super) fn runs(&self) -> PathBuf {
        self.0.path().join("runs")
    }

    fn open_console(&self, size: (u16, u16)) -> Console {
        self.open_console_with(Configuration::bundled(), size)
    }

    pub(super) fn open_console_with(&self, configuration: Configuration, size: (u16, u16)) -> Console {
        let study = Study::load(&self.folder()).expect("a study");
        let mut console = Console::start_with(configuration, &self.runs(), size);
        console.start_study(study).expect("the label page");
        console.assert_shows("Type the label");
        console
    }

    pub(super) fn participant_runs(&self, label: &str) -> Vec<PathBuf> {
        let folders = std::fs::read_dir(self.runs().join("participants").join(label)).into_iter().flatten();
        folders.flatten().map(|entry| entry.path()).filter(|path| path.is_dir()).collect()
    }

    fn recorded_events(&self) -> Vec<(String, VisitEvent)> {
        let lines = read_visits(&self.runs().join("visits.jsonl"));
        lines.into_iter().map(|line| (line.label, line.event)).collect()
    }
}

/// Lists the question events of a run: day, event, occasion, question, answer and changes.
fn recorded_questions(run: &Path) -> Vec<String> {
    let trajectory = Trajectory::read(&run.join("trajectory.jsonl")).expect("it reads");
    let after = read_afterwards(run, &trajectory).expect("it reads");
    let describe = |line: &novamind::record::trajectory::Line| match &line.record {
        Record::Activity(Activity::Question(question_shown)) => {
            Some(format!("{} asked {} {}", line.day, question_shown.occasion, question_shown.id))
        }
        Record::Activity(Activity::Answer(question_answer)) => Some(format!(
            "{} {} {} {} changes {}",
            line.day,
            question_answer.occasion,
            question_answer.id,
            question_answer.value,
            question_answer.changes
        )),
        _ => None,
    };
    trajectory.lines.iter().chain(&after.lines).filter_map(describe).collect()
}

/// Runs a week and leaves its report open.
fn advance_week(console: &mut Console) {
    console.press("n enter 'test' enter f enter");
}

#[test]
fn participant_session_runs_from_label_to_final_page() {
    let lab = StudyHome::new();
    let mut console = lab.open_console((100, 30));
    for wrong in ["'P9'", "'../x'"] {
        console.press(&format!("{wrong} enter"));
        console.assert_shows("! ");
    }
    console.press("'P01' enter");
    console.assert_shows("· Paragraph 1 of what is recorded.");
    console.press("y");
    console.assert_shows("scroll to the end of the text first");
    console.press("pagedown pagedown y");
    console.assert_shows("The session starts now.");
    console.press("enter");
    // The participant must answer two questions before the first week.
    console.assert_shows("question 1 of 2");
    console.press("8 : n enter");
    console.assert_shows("an answer is required");
    console.press("3 right shift-tab enter '17' enter");
    console.assert_shows("a number from 18 to 99");
    console.press("ctrl-u '42' shift-tab 6 enter enter");
    console.assert_shows("runway");
    let screen = console.screen();
    assert!(!screen.contains("question") && !screen.contains("seed"), "{screen}");
    advance_week(&mut console);
    console.assert_shows("Most unusual changes");
    console.press("n");
    console.assert_shows("Choose the second option.");
    console.press("2 enter space down down space enter");
    console.press("q");
    console.assert_shows("To continue later");
    console.press("enter 'P01' enter");
    console.assert_shows("continues where you left off");
    console.press("enter");
    advance_week(&mut console);
    // The result follows the last question.
    console.assert_shows("What did you try?");
    assert!(!console.screen().contains("You end with"), "{}", console.screen());
    console.press("'I_guessed.' tab");
    console.assert_shows("You end with");
    let end = console.screen();
    assert!(!end.contains("published") && !end.contains("replay"), "{end}");
    console.press("enter");
    console.assert_shows("Thank you for taking part");
    console.press("enter");
    console.assert_shows("Type the label");

    let runs = lab.participant_runs("P01");
    assert_eq!(runs.len(), 1);
    assert_eq!(
        recorded_questions(&runs[0]),
        [
            "0 asked before experience",
            "0 asked before age",
            "0 before experience 6 changes 2",
            "0 before age 42.0 changes 0",
            "7 asked week 1 check",
            "7 asked week 1 tools",
            "7 week 1 check \"second\" changes 0",
            "7 week 1 tools [\"SQL\",\"notes\"] changes 0",
            "14 asked end strategy",
            "14 end strategy \"I guessed.\" changes 0",
        ]
    );
    let trajectory = Trajectory::read(&runs[0].join("trajectory.jsonl")).expect("it reads");
    let Record::Start(start) = &trajectory.lines[0].record else { panic!("the first line") };
    let consent_given = start.consent.as_ref().and_then(|consent| consent.given).expect("it was given");
    assert_eq!((consent_given.means, consent_given.scrolled_to_end), (ConsentMeans::Screen, true));
    assert_eq!(start.study.as_ref().map(|study| study.refused_labels), Some(2));
    let seen: Vec<VisitEvent> = lab.recorded_events().into_iter().map(|(_, event)| event).collect();
    use VisitEvent::{Came, Finished, LabelRefused};
    assert_eq!(seen, [LabelRefused, LabelRefused, Came, Came, Finished]);
}

#[test]
fn declined_consent_creates_no_run_and_withdrawal_is_recorded() {
    let lab = StudyHome::new();
    let mut console = lab.open_console((80, 24));
    console.press("'P02' enter n");
    console.assert_shows("You did not agree");
    console.press("enter 'P01' enter end y enter 4 enter enter");
    console.assert_shows("runway");
    assert_eq!(lab.participant_runs("P01").len(), 1);
    // The first confirmation is cancelled by n, the second confirmation by esc.
    for step in ["n", "y 'no' enter esc"] {
        console.press(": 'withdraw' enter");
        console.assert_shows("permanently erases");
        console.press(step);
        console.assert_shows("continues where you left off");
        console.press("enter");
    }
    console.press(": 'withdraw' enter y 'withdraw' enter");
    console.assert_shows("You have withdrawn");
    assert_eq!(lab.participant_runs("P01").len(), 0);
    assert!(lab.runs().join("participants/P01/withdrawn.toml").exists());
    assert!(!lab.runs().join("participants/P02").exists());
    console.press("enter 'P01' enter");
    console.assert_shows("You have withdrawn");
    let seen: Vec<(String, VisitEvent)> = lab.recorded_events();
    assert!(seen.contains(&("P02".to_owned(), VisitEvent::ConsentDeclined)));
    assert!(seen.contains(&("P01".to_owned(), VisitEvent::Withdrew)));
}

#[test]
fn practice_comes_first_and_is_skippable_if_optional() {
    let lab = StudyHome::new();
    lab.edit_protocol(
        "offer = \"none\"",
        "offer = \"optional\"\nscenario = \"short\"\ndays = 7\n[session]\ntour = true",
    );
    let mut console = lab.open_console((100, 30));
    console.press("'P01' enter end y");
    console.assert_shows("First, run a practice company");
    console.press("enter");
    console.assert_shows("PRACTICE");
    console.assert_shows("Tour · 1");
    console.press("f4 n enter 'test' enter f enter");
    console.assert_shows("The practice has ended");
    console.assert_shows("The practice does not count. The session is next.");
    let screen = console.screen();
    for measure in ["$", "lanning", "best channel", "forecast"] {
        assert!(!screen.contains(measure), "{measure}\n{screen}");
    }
    console.press("enter");
    console.assert_shows("The session starts now.");
    console.press("enter");
    console.assert_shows("SESSION");
    assert_eq!(lab.participant_runs("P01").len(), 2);
    drop(console);
    let mut other = lab.open_console((100, 30));
    other.press("'P02' enter end y s");
    other.assert_shows("The session starts now.");
    assert!(lab.recorded_events().contains(&("P02".to_owned(), VisitEvent::PassedPractice)));
}

#[test]
fn other_runs_require_the_experimenter_code() {
    let lab = StudyHome::new();
    let mut console = lab.open_console((100, 30));
    console.press("'P01' enter end y enter 4 enter enter");
    for keys in ["; r", "; t"] {
        console.press(keys);
        let screen = console.screen();
        assert!(
            screen.contains("only your own session") || screen.contains("has no tour"),
            "{keys}\n{screen}"
        );
        console.press("esc");
    }
    for request in [
        Request::ListRuns,
        Request::Create(Box::default()),
        Request::Open("latest".to_owned(), Access::Write),
        Request::Recover("latest".to_owned()),
        Request::DeleteRun("latest".to_owned()),
        Request::EndRun("latest".to_owned()),
        Request::TakeOver(Mode::Sandbox),
        Request::Replay {
            recorded: RecordSource::Run("latest".to_owned()),
            goal: SeekTarget::First,
            follow: false,
        },
    ] {
        console.request(request.clone()).expect("no response is awaited");
        assert!(console.screen().contains("only your own session"), "{request:?}");
    }
    console.press("; q");
    console.assert_shows("To continue later");
    console.press("enter ctrl-e 'guess' enter");
    console.assert_shows("not the experimenter's code");
    assert!(!console.screen().contains("guess"));
    console.press("ctrl-u 'open' _ 'sesame' enter");
    console.assert_shows("New run");
    // The experimenter can list and replay the runs of participants.
    let runs = std::fs::read_dir(lab.runs().join("participants/P01")).expect("a folder").flatten();
    let run = runs.map(|entry| entry.file_name().to_string_lossy().into_owned()).next().expect("a run");
    console.assert_shows(&run);
    assert!(!console.screen().contains("No such file"), "{}", console.screen());
    console.request(Request::Open(run.clone(), Access::Write)).expect("nothing to wait for");
    console.assert_shows("only the participant can continue this run");
    let recorded = RecordSource::Run(run);
    console.request(Request::Replay { recorded, goal: SeekTarget::First, follow: false }).expect("it opens");
    assert!(!console.screen().contains("New run"), "{}", console.screen());
}

#[test]
fn results_page_shows_only_results_that_the_protocol_permits() {
    for (results, shows_score, published) in
        [("none", false, false), ("own", true, false), ("published", true, true)]
    {
        let lab = StudyHome::new();
        lab.edit_protocol("[access]", &format!("[session]\nresults = \"{results}\"\n[access]"));
        lab.edit_protocol("days = 14", "days = 7");
        let mut console = lab.open_console((120, 40));
        console.press("'P01' enter end y enter 4 enter enter n enter 'test' enter f enter");
        assert!(!console.screen().contains("You end with"), "{}", console.screen());
        console.press("2 enter enter 'words' tab");
        let screen = console.screen();
        assert_eq!(screen.contains("You end with"), shows_score, "{screen}");
        assert_eq!(screen.contains('$'), shows_score, "no figure of a result that is not shown:\n{screen}");
        assert_eq!(screen.contains("Rule-based baseline"), published, "{screen}");
        assert!(!screen.contains("seed 5"), "{screen}");
    }
}

#[test]
fn study_pages_fit_every_window() {
    let lab = StudyHome::new();
    lab.edit_protocol("offer = \"none\"", "offer = \"optional\"\nscenario = \"short\"\ndays = 7");
    let mut console = lab.open_console((100, 30));
    let steps = [
        "",
        "ctrl-e",
        "esc 'P9' enter",
        "'P01' enter",
        "end",
        "y",
        "s",
        "enter",
        "4 enter",
        "enter",
        "n enter 'x' enter f enter enter",
        "2 enter",
        "enter",
        "; q",
        "enter 'P01' enter",
        "W",
        "y",
        "esc",
        "enter n enter 'x' enter f enter",
        "'words' tab",
        "enter",
    ];
    for step in steps {
        console.size = (100, 30);
        console.press(step);
        for size in
            [(60, 16), (61, 17), (80, 24), (120, 40), (200, 60), (400, 120), (60, 120), (20, 5), (0, 0)]
        {
            console.size = size;
            let screen = console.screen();
            let roomy = size.0 >= 60 && size.1 >= 16;
            assert!(!roomy || !screen.trim().is_empty(), "{step} at {size:?}");
        }
        for size in [(60, 16), (120, 40)] {
            console.size = size;
            console.app.glyphs = Glyphs::Ascii;
            let screen = console.screen();
            assert!(screen.is_ascii(), "{step}\n{screen}");
            console.app.glyphs = Glyphs::Braille;
        }
    }
    console.size = (100, 30);
    console.assert_shows("Thank you");
}

#[test]
fn question_pages_show_their_keys_in_the_footer() {
    let lab = StudyHome::new();
    for size in [(60, 16), (80, 24)] {
        let mut console = lab.open_console(size);
        console.press(&format!("'P0{}' enter end y", if size.0 == 60 { 1 } else { 2 }));
        console.assert_shows("; p stops the clock");
        console.press("enter");
        console.assert_shows("enter continues · q leaves");
        assert!(!console.screen().contains("a new company"), "{}", console.screen());
        console.press("4 enter 'x'");
        console.assert_shows("! type a number from 18 to 99 (years)");
        console.assert_shows("enter sends the answers · ctrl-c leaves");
        console.assert_shows("shift-tab previous question");
        console.press("'42' enter");
        for _ in 0..2 {
            advance_week(&mut console);
            if !console.screen().contains("What did you try?") {
                console.press("enter 2 enter enter");
            }
        }
        console.assert_shows("tab sends the answers · enter new line · ctrl-c leaves");
        let screen = console.screen();
        assert!(!screen.contains("enter continue") && !screen.contains("min left"), "{screen}");
        console.press("'done' tab enter");
        console.assert_shows("Thank you");
    }
}

#[test]
fn withdrawal_is_possible_at_a_question() {
    let lab = StudyHome::new();
    let mut console = lab.open_console((80, 24));
    console.press("'P01' enter end y enter");
    console.assert_shows("question 1 of 2");
    console.press("W y 'withdraw' enter");
    console.assert_shows("You have withdrawn");
    assert!(lab.participant_runs("P01").is_empty());
}

#[test]
fn palette_finds_pause_by_synonyms() {
    let lab = StudyHome::new();
    let mut console = lab.open_console((80, 24));
    console.press("'P01' enter end y enter 4 enter enter");
    for word in ["pause", "break", "clock"] {
        console.press(&format!(": '{word}' enter"));
        console.assert_shows("The clock is stopped.");
        console.press("enter");
    }
}

#[test]
fn naive_forecasts_are_labeled() {
    let lab = StudyHome::new();
    for (label, size) in [("P01", (60, 16)), ("P02", (80, 24))] {
        let mut console = lab.open_console(size);
        console.press(&format!("'{label}' enter end y enter 4 enter enter n"));
        assert!(!console.screen().contains("fill"), "{}", console.screen());
        console.press("f");
        console.assert_shows("you can fill in forecasts in step 3");
        console.press("enter");
        console.assert_shows("Required, and saved with the run.");
        console.press("'test' enter");
        console.assert_shows("f fills empty cells: billing dates, recent renewals");
        console.press("f");
        let screen = console.screen();
        assert!(screen.contains("marked as naive forecasts") && !screen.contains("back-test"), "{screen}");
        console.press("esc ; q");
    }
}
