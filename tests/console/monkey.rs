//! Random keys, clicks, pastes and window sizes. The console never panics, the cursor stays inside the window, drafts
//! are kept, and the run replays to the same state.

use std::path::Path;

use crossterm::event::{Event, KeyModifiers, MouseButton, MouseEvent, MouseEventKind};
use novamind::record::folder::runs::list_runs;
use novamind::session::verify;

use super::harness::Console;
use crate::support::dice::Dice;

/// Keys that are pressed at random. Keys that open a dialog or screen occur more often.
const KEYS: &str = "\
    1 2 3 4 5 6 7 8 9 0 n c u w d f i z tab tab tab shift-tab enter enter enter esc esc esc up down down left \
    right right pageup pagedown home end / : ? ; g g s e E y Y = x a r b p v o t m . , + - ctrl-s f5 f2 ctrl-r \
    ctrl-o ctrl-n ctrl-l ctrl-f ctrl-u ctrl-w ctrl-d ctrl-p space backspace delete j k h l G [ ] é 7 M";

/// Texts that are pasted at random.
const PASTES: [&str; 6] = [
    "12",
    "SELECT count(*) FROM customers",
    "two\nlines\tand a tab",
    "日本語 👩‍👩‍👧 e\u{301}",
    "\u{1b}[31mred\u{0}",
    "",
];

/// Number of random steps of the regular test, over all its runs.
const STEPS: usize = 1_600;

#[test]
fn random_input_does_not_panic() {
    let mut dice = Dice::for_test("monkey");
    for _ in 0..4 {
        play_random_run(&mut dice, STEPS / 4);
    }
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn soak_random_input_does_not_panic() {
    let mut dice = Dice::for_test("monkey");
    for _ in 0..40 {
        play_random_run(&mut dice, 100_000 / 40);
    }
}

/// Plays one run with random input.
fn play_random_run(dice: &mut Dice, steps: usize) {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_open_run(runs.path(), dice);
    for step in 1..=steps {
        if step % 150 == 0 {
            console.press("esc esc esc esc");
            console.advance_week();
        }
        if step % 100 == 0 {
            check_draft_is_kept(&mut console, dice);
        }
        random_step(&mut console, dice);
        if console.exit.is_some() {
            console = reopen(console, runs.path());
        }
    }
    drop(console);
    for run in list_runs(runs.path()).expect("a list") {
        let verified = verify(&runs.path().join(&run.id)).expect("an intact run");
        assert_eq!(verified.day, run.day);
    }
}

/// Opens a run with prices in a window of a random size.
fn console_in_open_run(runs: &Path, dice: &mut Dice) -> Console {
    let mut console = Console::in_new_run(runs, (120, 40));
    console.press("8 enter enter '12' down '25' down '55' enter ctrl-s 1");
    console.size = random_size(dice);
    console
}

/// Closes the console and opens the run again.
fn reopen(console: Console, runs: &Path) -> Console {
    let size = console.size;
    drop(console);
    let mut console = Console::start(runs, size);
    console.press("c");
    if console.app.run().is_none() {
        console.press("n enter");
    }
    console
}

fn random_size(dice: &mut Dice) -> (u16, u16) {
    match dice.roll(4) {
        0 => (dice.roll(80) as u16, dice.roll(30) as u16),
        1 => (80, 24),
        _ => (60 + dice.roll(150) as u16, 16 + dice.roll(50) as u16),
    }
}

fn random_step(console: &mut Console, dice: &mut Dice) {
    match dice.roll(20) {
        0 => console.size = random_size(dice),
        1 => console.send(Event::Paste((*dice.pick(&PASTES)).to_owned())),
        2 | 3 => {
            let event = random_click(console.size, dice);
            console.send(event);
        }
        _ => {
            let keys: Vec<&str> = KEYS.split(' ').collect();
            let key = dice.pick(&keys);
            console.press_key(key);
        }
    }
}

fn random_click((width, height): (u16, u16), dice: &mut Dice) -> Event {
    let kinds = [
        MouseEventKind::Down(MouseButton::Left),
        MouseEventKind::Down(MouseButton::Left),
        MouseEventKind::Down(MouseButton::Right),
        MouseEventKind::Up(MouseButton::Left),
        MouseEventKind::Drag(MouseButton::Left),
        MouseEventKind::ScrollUp,
        MouseEventKind::ScrollDown,
        MouseEventKind::Moved,
    ];
    // Some terminals report positions outside of the window.
    let column = dice.roll(usize::from(width) + 2) as u16;
    let row = dice.roll(usize::from(height) + 2) as u16;
    Event::Mouse(MouseEvent { kind: *dice.pick(&kinds), column, row, modifiers: KeyModifiers::NONE })
}

/// Text fields with drafts: keys that open the field, and keys that return to it.
const DRAFTS: [(&str, &str); 5] = [
    ("9 esc esc i ctrl-n", "9"),
    ("5 esc esc p ctrl-u", "5 esc esc p"),
    ("0 esc esc tab tab e", "0"),
    ("n enter ctrl-u", "n enter"),
    // A filter that is still typed would select a different tool.
    ("8 esc esc esc home enter enter", "8 esc esc home enter"),
];

/// Keys that navigate and change no text.
const NAVIGATION_KEYS: [&str; 16] =
    ["1", "2", "3", "4", "7", "9", "0", "tab", "up", "down", "?", ":", "c", "w", "d", "["];

/// Writes a draft, navigates at random, and checks that the draft has been kept.
fn check_draft_is_kept(console: &mut Console, dice: &mut Dice) {
    // A replay is read-only.
    if console.app.run().is_none_or(|run| !run.company.is_running() || run.playback.is_some()) {
        return;
    }
    let size = std::mem::replace(&mut console.size, (120, 40));
    let (there, again) = *dice.pick(&DRAFTS);
    // Closes all dialogs. A filter that was being typed on a screen may still be open.
    console.press(&format!("{}1 esc esc", "esc ".repeat(30)));
    console.press(there);
    let number = 1_000 + dice.roll(8_999);
    let draft = if there.starts_with('8') { number.to_string() } else { format!("draft{number}") };
    // The draft is a single word, because a single word is not wrapped.
    console.press(&if there.starts_with('8') { format!("'{draft}'") } else { format!("_ '{draft}'") });
    if there.starts_with('8') {
        // Esc discards a rejected number, as described in the footer.
        console.press("enter");
    }
    let written = console.screen();
    assert!(shows_draft(&written, &draft), "{there}: {draft} was not accepted:\n{written}");
    console.press("esc esc esc 1");
    let mut walked = Vec::new();
    for _ in 0..6 {
        let key = *dice.pick(&NAVIGATION_KEYS);
        walked.push(key);
        console.press(key);
        console.press("esc esc");
    }
    console.press("esc esc esc 1");
    console.press(again);
    let found = console.screen();
    assert!(shows_draft(&found, &draft), "{there}: {draft} is lost after {walked:?}:\n{found}");
    console.press("esc esc esc 1");
    console.size = size;
}

/// Returns whether the screen contains the draft. Digits of numbers can be grouped.
fn shows_draft(screen: &str, draft: &str) -> bool {
    screen.contains(draft) || screen.replace(',', "").contains(draft)
}
