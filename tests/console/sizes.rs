//! Every screen at every size.

use super::harness::Console;

/// Keys that lead to every place of the console, each followed by what closes it.
const PLACES: [(&str, &str); 20] = [
    ("1", ""),
    ("2", ""),
    ("3", ""),
    ("4", ""),
    ("5", ""),
    ("5 p", "esc"),
    ("6", ""),
    ("7", ""),
    ("7 tab", ""),
    ("8", ""),
    ("8 enter", "esc"),
    ("9", "esc"),
    ("0", ""),
    (":", "esc"),
    ("?", "esc"),
    ("n", "esc"),
    ("n enter", "esc"),
    ("w", "esc"),
    ("d", "esc"),
    ("c", "esc"),
];

fn sizes() -> impl Iterator<Item = (u16, u16)> {
    let small = (0..=62).step_by(3).flat_map(|width| (0..=20).step_by(2).map(move |height| (width, height)));
    small.chain([
        (60, 16),
        (61, 17),
        (79, 23),
        (80, 24),
        (81, 25),
        (103, 30),
        (104, 31),
        (120, 40),
        (200, 60),
        (400, 120),
    ])
}

#[test]
fn nothing_breaks_at_any_size_and_growing_brings_the_screen_back() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), (80, 24));
    let menu = console.screen();
    for size in sizes() {
        console.size = size;
        console.draw();
    }
    console.size = (80, 24);
    assert_eq!(console.screen(), menu);
    console.press("n");
    for size in sizes() {
        console.size = size;
        console.draw();
    }
    console.size = (80, 24);
    console.press("enter");
    console.week();
    console.press("esc");
    for (open, close) in PLACES {
        console.press(open);
        let before = console.screen();
        for size in sizes() {
            console.size = size;
            let drawn = console.screen();
            if (size.0 < 60 || size.1 < 16) && size.0 > 20 && size.1 > 0 {
                assert!(drawn.contains("NovaMind needs 60"), "{open} at {size:?}: {drawn}");
            }
        }
        console.size = (80, 24);
        assert_eq!(console.screen(), before, "{open}");
        console.press(close);
    }
}

#[test]
fn ascii_is_all_that_is_drawn_with_ascii() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.week();
    console.press("esc");
    console.app.ascii = true;
    for (open, close) in PLACES {
        console.press(open);
        let screen = console.screen();
        assert!(screen.is_ascii(), "{open}:\n{screen}");
        console.press(close);
    }
}
