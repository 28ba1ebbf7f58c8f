//! A database that cannot be written: a banner is shown until the database is repaired, then the screens request the
//! data again.

use novamind::worker::message::{Message, Response};

use super::harness::Console;

const BANNER: &str = "The database is behind";

#[test]
fn stale_figures_are_marked_until_the_database_is_current() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.advance_week();
    console.press("esc 3");
    let before = console.screen();
    assert!(!before.contains(BANNER) && !before.contains("stale"), "{before}");
    let problem = "database or disk is full".to_owned();
    console.app.handle_message(Message::Response(Response::DatabaseBehind(problem.clone())));
    // The banner is shown on every screen, and outdated panes are marked.
    for (key, marked) in [("3", true), ("2", false), ("4", true), ("9", true)] {
        console.press(key);
        let screen = console.screen();
        assert!(screen.contains(BANNER) && screen.contains(&problem), "{key}:\n{screen}");
        assert_eq!(screen.contains("stale"), marked, "{key}:\n{screen}");
    }
    for (width, height) in [(60, 16), (80, 24), (200, 60)] {
        console.size = (width, height);
        console.assert_shows(BANNER);
    }
    console.size = (120, 40);
    console.app.handle_message(Message::Response(Response::DatabaseCurrent));
    console.dispatch_orders();
    console.wait_until_idle().expect("everything is asked again");
    let after = console.screen();
    assert!(!after.contains(BANNER) && !after.contains("stale"), "{after}");
}
