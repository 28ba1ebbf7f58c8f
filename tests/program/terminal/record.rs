//! Every end of a session is recorded, and typed text is kept.

use std::path::{Path, PathBuf};

use novamind::record::trajectory::record::{Activity, DetachCause, PresenceEvent};
use novamind::record::trajectory::{Record, Trajectory};

use super::pty::Terminal;

fn only_run(runs: &Path) -> PathBuf {
    let folders = std::fs::read_dir(runs).expect("a folder").flatten().map(|entry| entry.path());
    folders.into_iter().find(|folder| folder.join("run.toml").exists()).expect("a run")
}

/// Returns the presence events of the run, with the cause of each end of a session.
fn presence_events(runs: &Path) -> Vec<(PresenceEvent, Option<DetachCause>)> {
    let lines = Trajectory::read(&only_run(runs).join("trajectory.jsonl")).expect("it reads").lines;
    let of = |record: &Record| match record {
        Record::Activity(Activity::Session(presence)) => Some((presence.event, presence.cause)),
        _ => None,
    };
    lines.iter().filter_map(|line| of(&line.record)).collect()
}

#[test]
fn typed_text_survives_a_kill_of_the_console() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new", "--seed", "4"], (100, 30));
    terminal.wait_for("day 0/500");
    terminal.type_keys("n");
    terminal.wait_for("[1 review]");
    terminal.type_keys("\rwe wait for leads");
    let drafts = only_run(runs.path()).join("drafts.json");
    terminal.wait_until_true("the text is kept", || {
        std::fs::read_to_string(&drafts).is_ok_and(|text| text.contains("we wait for leads"))
    });
    terminal.signal("-KILL");
    terminal.wait_for_killed();
    let mut terminal = Terminal::start(runs.path(), &["--run", "latest"], (100, 30));
    terminal.wait_for("Unsent when");
    terminal.wait_for("we wait for leads");
    terminal.type_keys("\r");
    terminal.wait_until_gone("Unsent when");
    terminal.type_keys("n\r");
    terminal.wait_for("we wait for leads");
    terminal.signal("-TERM");
    terminal.wait_for_end();
    assert!(drafts.exists(), "after a signal it stays for the next session");
}

#[test]
fn session_ends_are_recorded_with_their_cause() {
    for (arguments, signal, cause) in [
        (&["--new", "--seed", "4"][..], "-TERM", DetachCause::Signal),
        (&["--new", "--seed", "4"], "-HUP", DetachCause::Hangup),
        (&["--new", "--seed", "4", "--plain"], "-TERM", DetachCause::Signal),
        (&["--new", "--seed", "4", "--plain"], "-HUP", DetachCause::Hangup),
        (&["--new", "--seed", "4", "--plain"], "-INT", DetachCause::Signal),
    ] {
        let runs = tempfile::tempdir().expect("a folder");
        let mut terminal = Terminal::start(runs.path(), arguments, (100, 30));
        terminal.wait_for(if arguments.contains(&"--plain") { "day 0>" } else { "day 0/500" });
        terminal.signal(signal);
        let (code, _) = terminal.wait_for_end();
        assert!(code > 128, "{arguments:?} {signal}: {code}");
        let events = presence_events(runs.path());
        assert_eq!(events.first(), Some(&(PresenceEvent::Opened, None)), "{arguments:?} {signal}");
        assert_eq!(events.last(), Some(&(PresenceEvent::Closed, Some(cause))), "{arguments:?} {signal}");
    }
}

#[test]
fn suspension_of_the_console_is_recorded() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new", "--seed", "4"], (100, 30));
    terminal.wait_for("day 0/500");
    terminal.signal("-TSTP");
    terminal.wait_until_stopped();
    terminal.signal("-CONT");
    terminal.wait_until_raw();
    terminal.type_keys("\x03");
    terminal.wait_for_end();
    let events: Vec<PresenceEvent> =
        presence_events(runs.path()).into_iter().map(|(event, _)| event).collect();
    use PresenceEvent::{Closed, Opened, Resumed, Suspended};
    assert_eq!(events, [Opened, Suspended, Resumed, Closed]);
}
