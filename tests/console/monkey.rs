//! Random keys: nothing panics, the cursor stays inside, and the run replays to the same state.

use novamind::session::{list_runs, verify};

use super::harness::Console;

const KEYS: [&str; 64] = [
    "1",
    "2",
    "3",
    "4",
    "8",
    "9",
    "0",
    "n",
    "c",
    "u",
    "w",
    "d",
    "tab",
    "shift-tab",
    "enter",
    "enter",
    "esc",
    "esc",
    "up",
    "down",
    "left",
    "right",
    "pageup",
    "pagedown",
    "home",
    "end",
    "/",
    ":",
    "?",
    "s",
    "e",
    "E",
    "y",
    "Y",
    "=",
    "x",
    "a",
    "r",
    "f",
    "b",
    "ctrl-s",
    "f5",
    "ctrl-r",
    "ctrl-o",
    "ctrl-n",
    "ctrl-l",
    "5",
    "7",
    "space",
    "backspace",
    "delete",
    "j",
    "k",
    "h",
    "l",
    "g",
    "G",
    "[",
    "-",
    ".",
    "ctrl-f",
    "ctrl-u",
    "ctrl-w",
    "é",
];

/// A small generator: tests must not depend on a crate's stream of numbers.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % sides
    }
}

#[test]
fn random_keys_break_nothing() {
    for seed in 1..=4 {
        let runs = tempfile::tempdir().expect("a folder");
        let mut dice = Dice(seed);
        let mut console = Console::in_new_run(runs.path(), (80 + 20 * seed as u16, 24 + 8 * seed as u16));
        console.press("8 enter '12' enter '25' enter '55' enter ctrl-s esc 1");
        for step in 0..600 {
            if step % 150 == 149 {
                console.press("esc esc esc esc");
                console.week();
            }
            console.key(KEYS[dice.roll(KEYS.len())]);
            if console.left.is_some() {
                break;
            }
        }
        drop(console);
        for run in list_runs(runs.path()).expect("a list") {
            let verified = verify(&runs.path().join(&run.id)).expect("an intact run");
            assert_eq!(verified.day, run.day);
        }
    }
}
