//! Keys: digits show screens outside of edits, an edit has a mode and a cursor, a key without effect gives a reason, the
//! footer can be clicked, and texts can be opened in the user's editor.

use crossterm::event::{Event, KeyModifiers, MouseButton, MouseEvent, MouseEventKind};
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::session::{NewRun, Session, Storage};
use novamind::worker::message::Message;

use super::harness::Console;

/// All places of a run in which text is entered: keys that open the place, and keys that end the edit.
const EDITS: [(&str, &str); 14] = [
    ("8 enter enter", "esc"),
    ("8 esc /", "esc"),
    ("9 i", "esc"),
    ("9 enter", "esc"),
    ("9 ctrl-o", "esc"),
    ("9 i 'SELECT1' ctrl-s", "esc esc"),
    ("9 tab tab /", "esc"),
    ("0 /", "esc"),
    ("0 tab e", "esc"),
    ("5 p", "esc"),
    ("6 R", "esc"),
    (":", "esc"),
    ("n enter", "esc"),
    ("? /", "esc esc"),
];

/// Returns the last line of the window.
fn footer(console: &mut Console) -> String {
    console.screen().lines().last().expect("a footer").to_owned()
}

fn console_in_week_5(runs: &std::path::Path, size: (u16, u16)) -> Console {
    super::company::copy_played_run("companies.toml", 3, 35, runs);
    Console::in_latest_run(runs, size)
}

#[test]
fn edits_have_a_mode_and_a_cursor() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_week_5(runs.path(), (120, 40));
    for (open, close) in EDITS {
        console.press("1");
        console.press(open);
        let screen = console.screen();
        assert!(console.app.is_editing_text(), "{open}: no edit\n{screen}");
        assert!(
            screen.lines().last().is_some_and(|row| row.starts_with(" EDIT ")),
            "{open}: no mode\n{screen}"
        );
        assert!(console.cursor.is_some(), "{open}: no cursor\n{screen}");
        for size in [(60, 16), (80, 24), (200, 60)] {
            console.size = size;
            let screen = console.screen();
            assert!(console.cursor.is_some() && screen.contains(" EDIT "), "{open} at {size:?}:\n{screen}");
        }
        console.size = (120, 40);
        console.press(close);
        let screen = console.screen();
        assert!(
            !console.app.is_editing_text() && !footer(&mut console).contains("EDIT"),
            "{open}:\n{screen}"
        );
        assert!(console.cursor.is_none(), "{open}: a cursor without an edit\n{screen}");
    }
}

#[test]
fn digits_show_screens_from_every_pane() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_week_5(runs.path(), (120, 40));
    for screen in ["1", "2", "3", "4", "5", "6", "7", "8", "8 enter", "9", "0"] {
        for tabs in 0..4 {
            console.press(&format!("esc {screen} {}", "tab ".repeat(tabs)));
            for (digit, name) in [("3", "customers"), ("7", "market"), ("2", "cash")] {
                console.press(digit);
                let shown = console.app.run().expect("a run").screen.record_name();
                assert_eq!(shown, name, "{digit} in pane {tabs} of {screen}:\n{}", console.screen());
                console.press("[");
            }
        }
    }
    console.press("8");
    console.assert_hides("* 1 draft");
}

#[test]
fn leaving_a_screen_ends_the_edit() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    for (edit, back) in
        [("9 i 'SELECT'", "9"), ("0 tab e 'note'", "0"), ("5 p 'post'", "5"), ("8 enter enter '7'", "8")]
    {
        console.press(edit);
        assert!(console.app.is_editing_text(), "{edit}");
        console.press("ctrl-p 'Overview' enter");
        assert_eq!(
            console.app.run().expect("a run").screen.record_name(),
            "overview",
            "{}",
            console.screen()
        );
        console.press(back);
        assert!(!console.app.is_editing_text(), "{edit}:\n{}", console.screen());
    }
    // The texts are kept.
    console.press("9");
    console.assert_shows("SELECT");
    console.press("5");
    console.assert_shows("post");
}

#[test]
fn keys_without_effect_give_a_reason() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (80, 24));
    for (keys, reason) in [
        // No function anywhere on the screen, and a function in another pane.
        ("1 @", "@ has no function here; ? lists the keys"),
        ("1 ; z", "; z has no function here"),
        ("9 >", "> (next result) works in Result"),
        ("1 ctrl-g", "ctrl-g (your editor) works while you edit a text"),
        // Nothing to act on.
        ("7 home up", "there is nothing more in this direction"),
        ("1 esc", "there is nothing to close here"),
        // Dialogs.
        ("d 3", "3 (Customers) works after esc closes this dialog"),
        // Edits.
        ("esc 9 i backspace", "there is no character to delete here"),
        ("left", "the text ends here"),
        ("f9", "f9 does nothing while you type; esc leaves"),
        ("esc 8 enter enter 'x'", "enter a number"),
    ] {
        console.press(keys);
        console.assert_shows(reason);
        // The reason is shown again if the key is pressed again.
        let last = keys.split(' ').next_back().expect("a key");
        if !last.contains('\'') && !keys.contains(';') {
            console.press(last);
            console.assert_shows(reason);
        }
    }
    console.press("esc 1 tab");
    assert!(!footer(&mut console).contains('!'), "a key with an effect needs no reason");
    console.press("esc");
}

#[test]
fn reasons_are_given_in_the_start_menu() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), (80, 24));
    console.press("3");
    console.assert_shows("3 (Customers) works in an open run");
    console.press("@");
    console.assert_shows("@ has no function here");
}

#[test]
fn footer_hints_can_be_clicked() {
    let runs = tempfile::tempdir().expect("a folder");
    for size in [(60, 16), (80, 24), (120, 40), (200, 60)] {
        let mut console = Console::in_new_run(&runs.path().join(size.0.to_string()), size);
        for (keys, hint, shown) in [
            ("8", "open", "set_prices · pricing"),
            ("", "edit", " EDIT "),
            ("esc esc esc 9", "edit", " EDIT "),
            // A hint in edit mode.
            ("'SELECT' _ '41+1'", "run", "42"),
        ] {
            console.press(keys);
            let row = footer(&mut console);
            let column = row.find(hint).map(|at| row[..at].chars().count()).expect(hint);
            let (column, row) = (column as u16, size.1 - 1);
            let kind = MouseEventKind::Down(MouseButton::Left);
            console.send(Event::Mouse(MouseEvent { kind, column, row, modifiers: KeyModifiers::NONE }));
            console.assert_shows(shown);
        }
    }
}

/// Creates a run of a mode and opens it.
fn console_in_mode(runs: &std::path::Path, mode: Mode) -> Console {
    let new = NewRun { mode, seed: Some(5), storage: Storage::Runs(runs.to_owned()), ..NewRun::default() };
    drop(Session::create(new, &Configuration::bundled()).expect("a run"));
    Console::in_latest_run(runs, (120, 40))
}

fn close_editor(console: &mut Console, result: Result<&str, &str>) {
    let result = result.map(str::to_owned).map_err(str::to_owned);
    console.app.handle_message(Message::EditorClosed(result));
    console.wait_until_idle().expect("it is saved");
}

#[test]
fn texts_are_edited_in_another_editor() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_mode(runs.path(), Mode::Sandbox);
    for (keys, extension, returned) in [
        ("0 tab e 'typed'", "md", "notes of two lines\nfrom an editor"),
        ("esc 9 i ctrl-n 'typed'", "sql", "SELECT 6*7 AS x"),
        ("esc 5 p 'typed'", "md", "A post from an editor"),
        ("esc 8 / 'PYX' enter enter enter 'typed'", "sql", "# python\nprint(1)"),
    ] {
        console.press(keys);
        assert!(footer(&mut console).contains("your editor"), "{keys}: {}", console.screen());
        console.press("ctrl-g");
        let document = console.editor_document.take().expect(keys);
        assert_eq!((document.text.as_str(), document.extension), ("typed", extension), "{keys}");
        close_editor(&mut console, Ok(returned));
        for line in returned.lines() {
            console.assert_shows(line);
        }
        console.assert_shows("the text from your editor is in the draft");
    }
    // The notes are a draft until they are saved.
    console.press("esc 0");
    console.assert_shows("draft, unsaved");
    // An editor that fails changes nothing.
    console.press("tab e f8");
    assert!(console.editor_document.take().is_some());
    close_editor(
        &mut console,
        Err("Your editor ended with an error (exit status: 1), so the draft is unchanged."),
    );
    console.assert_shows("exit status: 1");
    console.press("esc");
    console.assert_shows("from an editor");
    // In other text fields, the message names the texts that can be opened.
    console.press("esc n enter ctrl-g");
    assert!(console.editor_document.is_none());
    console.assert_shows("your editor opens notes, posts, SQL and code only");
}

#[test]
fn baseline_runs_reject_other_editors() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_mode(runs.path(), Mode::Baseline);
    for keys in ["0 tab e", "esc 9 i", "esc 5 p"] {
        console.press(keys);
        assert!(!footer(&mut console).contains("your editor"), "{keys}");
        console.press("ctrl-g");
        assert!(console.editor_document.is_none(), "{keys}");
        console.assert_shows("not in a baseline run: your editor is not recorded");
        assert!(console.app.is_editing_text(), "the edit continues");
    }
}
