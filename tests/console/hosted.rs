//! The console of a hosted session: it starts at the participant's next step, offers nothing that leaves the session,
//! and ends after the participant's last page.

use novamind::record::folder::configuration::Configuration;
use novamind::record::trajectory::record::{Activity, PresenceEvent};
use novamind::record::trajectory::{Record, Trajectory};
use novamind::worker::message::{Message, Response};

use super::harness::Console;
use super::participant_sessions::StudyHome;

/// Keys from the consent text to the first week.
const TO_FIRST_WEEK: &str = "end y enter 4 enter enter";
const SAVED: &str = "Everything is saved. You can close this window.";

fn open_hosted(lab: &StudyHome, label: &str) -> Console {
    lab.open_hosted_console(label, Configuration::bundled(), (100, 30))
}

#[test]
fn hosted_session_runs_from_the_next_step_to_the_end_of_the_program() {
    let lab = StudyHome::without_week_questions();
    let mut console = open_hosted(&lab, "P01");
    console.assert_shows("Paragraph 1 of what is recorded.");
    console.press(TO_FIRST_WEEK);
    console.advance_week();
    console.press("esc q");
    console.assert_shows(SAVED);
    console.assert_shows("open your link again");
    assert_eq!(console.exit, None, "the page is shown before the program exits");
    console.press("enter");
    assert_eq!(console.exit, Some((0, Some(SAVED.to_owned()))));
    drop(console);

    let mut console = open_hosted(&lab, "P01");
    // The run opens at the same place.
    console.assert_shows("wk 1/2");
    console.advance_week();
    console.press("'words' tab enter");
    console.assert_shows("Thank you for taking part");
    assert!(!console.screen().contains("next participant"), "{}", console.screen());
    console.press("enter");
    assert_eq!(console.exit, Some((0, Some(SAVED.to_owned()))));
}

#[test]
fn hosted_participant_can_withdraw_until_after_the_end() {
    let lab = StudyHome::without_week_questions();
    let mut console = open_hosted(&lab, "P02");
    console.press("W y 'withdraw' enter");
    console.assert_shows("You have withdrawn");
    drop(console);
    let mut console = open_hosted(&lab, "P01");
    console.press(TO_FIRST_WEEK);
    console.advance_week();
    console.press("esc");
    console.advance_week();
    console.press("'words' tab enter");
    console.assert_shows("Thank you for taking part");
    console.press("W y 'withdraw' enter");
    console.assert_shows("You have withdrawn");
    console.assert_shows(SAVED);
    assert_eq!(lab.participant_runs("P01").len(), 0);
}

#[test]
fn hosted_session_has_no_label_page_menu_or_experimenter() {
    let lab = StudyHome::without_week_questions();
    let mut console = open_hosted(&lab, "P01");
    for keys in ["ctrl-e", "n ctrl-e"] {
        console.press(keys);
        let screen = console.screen();
        assert!(!screen.contains("experimenter's code") && !screen.contains("New run"), "{keys}\n{screen}");
    }
    // The page after a declined consent ends the program, not the participant's session.
    console.assert_shows("You did not agree");
    console.press("enter");
    assert!(console.exit.is_some());
    let console = &mut open_hosted(&lab, "P9");
    console.assert_shows("P9 is not a label of this study");
    console.press("q enter");
    assert_eq!(console.exit.as_ref().map(|(code, _)| *code), Some(0));
}

#[test]
fn hosted_session_hides_unavailable_commands_and_writes_no_file() {
    let lab = StudyHome::without_week_questions();
    let mut console = open_hosted(&lab, "P01");
    console.press(TO_FIRST_WEEK);
    for absent in ["write the report", "start menu", "x-ray", "experimenter", "what if"] {
        console.press(&format!(": '{}'", absent.replace(' ', "' _ '")));
        let screen = console.screen();
        let is_command = |line: &str| line.contains("command ") && line.contains(absent);
        assert!(!screen.lines().any(is_command), "{absent}\n{screen}");
        console.press("esc");
    }
    let run = lab.participant_runs("P01").remove(0);
    let names = |run: &std::path::Path| {
        let entries = std::fs::read_dir(run).expect("a folder").flatten();
        let mut names: Vec<String> =
            entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort_unstable();
        names
    };
    let before = names(&run);
    // Query results, the calls of a week, the notes in an editor, and a saved query.
    console.press("9 i 'SELECT' _ '4711' f5 esc e c j m");
    console.press("esc esc 8 enter Y esc esc : 'calls' _ 'to' esc");
    console.press("9 i 'x' ctrl-g ctrl-s esc 0 e ctrl-g f8 esc");
    assert_eq!((names(&run), console.editor_document.is_none()), (before, true));
}

#[test]
fn hosted_messages_contain_no_path() {
    let lab = StudyHome::without_week_questions();
    let mut console = open_hosted(&lab, "P01");
    console.press(TO_FIRST_WEEK);
    let place = lab.runs().display().to_string();
    for response in [
        Response::Crashed("panic".to_owned()),
        Response::RecordLost(format!("{place}/trajectory.jsonl was removed")),
    ] {
        console.app.handle_message(Message::Response(response));
        console.dispatch_orders();
        let (code, text) = console.exit.take().expect("the program exits");
        let text = text.unwrap_or_default();
        assert!(code != 0 && !text.contains('/'), "{text}");
    }
}

#[test]
fn closed_window_is_recorded_as_away() {
    let lab = StudyHome::without_week_questions();
    let mut console = open_hosted(&lab, "P01");
    console.press(TO_FIRST_WEEK);
    console.app.handle_message(Message::Signal(1));
    console.wait_until_idle().expect("the run closes");
    assert_eq!(console.exit.as_ref().map(|(code, _)| *code), Some(129));
    drop(console);
    let run = lab.participant_runs("P01").remove(0);
    let trajectory = Trajectory::read(&run.join("trajectory.jsonl")).expect("it reads");
    let last = trajectory.lines.iter().rev().find_map(|line| match &line.record {
        Record::Activity(Activity::Session(presence)) => Some((presence.event, presence.cause)),
        _ => None,
    });
    use novamind::record::trajectory::record::DetachCause;
    assert_eq!(last, Some((PresenceEvent::Closed, Some(DetachCause::Hangup))));
}

#[test]
fn participant_can_withdraw_at_the_label_page() {
    let lab = StudyHome::without_week_questions();
    let mut console = lab.open_console_with(Configuration::bundled(), (100, 30));
    console.press(&format!("'P01' enter {TO_FIRST_WEEK}"));
    assert_eq!(lab.participant_runs("P01").len(), 1);
    console.press("q enter 'withdraw' enter");
    console.assert_shows("whose runs of this study are to be erased");
    console.press("'P9' enter");
    console.assert_shows("P9 is not a label");
    console.press("'P01' enter");
    console.assert_shows("permanently erases");
    console.press("y 'withdraw' enter");
    console.assert_shows("You have withdrawn");
    assert_eq!(lab.participant_runs("P01").len(), 0);
}

#[test]
fn wrong_codes_delay_the_next_check() {
    let lab = StudyHome::new();
    let mut console = lab.open_console_with(Configuration::bundled(), (100, 30));
    console.press("ctrl-e");
    for _ in 0..8 {
        console.press("ctrl-u 'guess' enter");
    }
    console.assert_shows("too many wrong codes");
    console.press("ctrl-u 'open' _ 'sesame' enter");
    console.assert_shows("too many wrong codes: the code was not checked. Try again in");
}
