//! Layout of every screen and every dialog in windows of many sizes.

use std::collections::{BTreeMap, BTreeSet};

use novamind::tui::glyphs::Glyphs;
use novamind::tui::theme::{Role, Theme};
use ratatui::buffer::Buffer;

use super::harness::Console;

/// Keys that open each screen and dialog of the console, and keys that close it.
pub const PLACES: [(&str, &str); 42] = [
    ("1", ""),
    ("1 z", "z"),
    ("2", ""),
    ("2 tab z", "z shift-tab"),
    ("3", ""),
    ("3 enter", "esc"),
    ("3 enter z", "z esc"),
    ("3 tab", "shift-tab"),
    ("4", ""),
    ("4 tab", ""),
    ("4 tab z", "z"),
    ("5", ""),
    ("5 p", "esc"),
    ("5 p 'draft'", "esc"),
    ("6", ""),
    ("6 tab", ""),
    ("7", ""),
    ("7 tab", ""),
    ("7 tab tab z", "z"),
    ("8", ""),
    ("8 enter", "esc"),
    ("8 / 'ads' enter enter", "esc esc"),
    ("9", "esc"),
    ("9 i 'SELECT*FROM(ledger)' f5", "esc"),
    ("9 tab tab", "esc"),
    ("0", ""),
    ("0 tab", ""),
    ("0 tab tab", ""),
    ("1 :", "esc"),
    (": 'set'", "esc"),
    ("?", "esc"),
    ("? / 'a' enter", "esc esc"),
    ("n", "esc"),
    ("n enter", "esc"),
    ("n enter enter", "esc"),
    ("w", "esc"),
    ("d", "esc"),
    ("c", "esc"),
    ("1 f", "esc"),
    ("1 g", "esc"),
    ("1 ; b", "esc"),
    ("1 ; b a", "esc esc"),
];

/// Widths at which layouts change, and the neighboring widths.
const WIDTHS: [u16; 30] = [
    0, 1, 2, 59, 60, 61, 69, 70, 79, 80, 81, 89, 90, 99, 100, 101, 103, 104, 109, 110, 111, 119, 120, 121,
    139, 140, 159, 160, 200, 400,
];
const HEIGHTS: [u16; 20] = [0, 1, 2, 15, 16, 17, 19, 20, 23, 24, 25, 29, 30, 31, 39, 40, 41, 59, 60, 120];

/// Returns a console in a run of five weeks, with data on every screen.
fn console_in_played_run(runs: &std::path::Path) -> Console {
    super::company::copy_played_run("companies.toml", 3, 35, runs);
    Console::in_latest_run(runs, (120, 40))
}

/// Returns one ninth of all pairs of a width and a height, spread over all widths and heights.
fn boundary_sizes() -> impl Iterator<Item = (u16, u16)> {
    let all = WIDTHS.into_iter().enumerate().flat_map(|(across, width)| {
        HEIGHTS.into_iter().enumerate().map(move |(down, height)| (across + down, (width, height)))
    });
    all.filter(|(at, _)| at % 9 == 0).map(|(_, size)| size)
}

/// Sizes of windows in which no word is truncated.
const ROOMY_SIZES: [(u16, u16); 3] = [(160, 50), (220, 60), (400, 120)];

/// Complete words, and words at the edge of a pane, which can be truncated.
#[derive(Default)]
struct ScreenWords {
    whole: BTreeSet<String>,
    at_edges: BTreeMap<String, String>,
}

impl ScreenWords {
    /// Collects the words of a screen. If `roomy` is set, all words are complete.
    fn read_screen(&mut self, screen: &str, width: u16, roomy: bool, place: &str) {
        for line in screen.lines() {
            let mut begin = 0;
            let characters: Vec<char> = line.chars().collect();
            while begin < characters.len() {
                if !characters[begin].is_alphabetic() {
                    begin += 1;
                    continue;
                }
                let end = (begin..characters.len()).find(|at| !characters[*at].is_alphabetic());
                let end = end.unwrap_or(characters.len());
                let word: String = characters[begin..end].iter().collect();
                let border = characters.get(end).is_some_and(|next| "│┃║▐▌█".contains(*next));
                if roomy || !(border || end == usize::from(width)) {
                    self.whole.insert(word);
                } else if word.len() > 2 {
                    self.at_edges.entry(word).or_insert_with(|| format!("{place}: {line}"));
                }
                begin = end;
            }
        }
    }

    /// Returns the words at an edge that are not complete on any screen.
    fn truncated_words(&self) -> Vec<&String> {
        self.at_edges.iter().filter(|(word, _)| !self.whole.contains(*word)).map(|(_, line)| line).collect()
    }
}

/// Draws every screen and dialog in windows of the given sizes. Asserts that restoring the size restores the screen,
/// and that no word is truncated.
fn check_sizes(console: &mut Console, sizes: &mut dyn FnMut() -> Vec<(u16, u16)>) {
    let mut words = ScreenWords::default();
    for (open, close) in PLACES {
        console.size = (120, 40);
        console.press(open);
        let before = console.screen();
        // A dialog covers words of the screen below, which does not count as truncation.
        let alone = !close.contains("esc");
        for size in ROOMY_SIZES {
            console.size = size;
            words.read_screen(&console.screen(), size.0, true, open);
        }
        for size in sizes() {
            console.size = size;
            let drawn = console.screen();
            if alone && size.0 >= 60 && size.1 >= 16 {
                words.read_screen(&drawn, size.0, false, &format!("{open} at {size:?}"));
            }
            if (size.0 < 60 || size.1 < 16) && size.0 > 20 && size.1 > 0 {
                assert!(drawn.contains("NovaMind needs 60"), "{open} at {size:?}: {drawn}");
            }
        }
        console.size = (120, 40);
        assert_eq!(console.screen(), before, "{open}");
        console.press(close);
    }
    let cut = words.truncated_words();
    assert!(cut.is_empty(), "{} words are truncated, for example\n{cut:#?}", cut.len());
}

#[test]
fn layout_boundaries_do_not_panic_and_restore_the_screen() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_played_run(runs.path());
    check_sizes(&mut console, &mut || boundary_sizes().collect());
}

/// Keys of the screens whose panes are focused with tab. Each pane is drawn in its normal size and zoomed.
const SCREENS: [&str; 8] = ["1", "2", "3", "4", "5", "6", "7", "0"];
const PANE_SIZES: [(u16, u16); 7] = [(0, 0), (3, 200), (60, 16), (69, 30), (110, 37), (200, 57), (300, 17)];

#[test]
fn panes_are_drawn_with_and_without_data() {
    let runs = tempfile::tempdir().expect("a folder");
    let (new, led) = (runs.path().join("new"), runs.path().join("led"));
    for mut console in [Console::in_new_run(&new, (120, 40)), console_in_played_run(&led)] {
        for screen in SCREENS {
            console.press(&format!("esc esc {screen}"));
            for _ in 0..6 {
                draw_in(&mut console, &PANE_SIZES);
                console.press("z");
                let alone = console.screen();
                let is_alone = alone.matches('┏').count() == 1 && !alone.contains("┌ ");
                assert!(is_alone, "the focused pane fills the screen:\n{alone}");
                draw_in(&mut console, &PANE_SIZES);
                console.press("z tab");
            }
        }
    }
}

/// Draws the screen in windows of the given sizes. The size of the console does not change.
fn draw_in(console: &mut Console, sizes: &[(u16, u16)]) {
    let initial_size = console.size;
    for size in sizes {
        console.size = *size;
        console.screen();
    }
    console.size = initial_size;
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn soak_any_size_does_not_panic() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_played_run(runs.path());
    check_sizes(&mut console, &mut || {
        let all = (0..=200).flat_map(|width| (0..=60).map(move |height| (width, height)));
        // Half of all pairs of a width and a height.
        all.filter(|(width, height)| (width + height) % 2 == 0).collect()
    });
}

#[test]
fn start_menu_fits_every_window() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), (80, 24));
    for keys in ["", "n"] {
        console.press(keys);
        let before = console.screen();
        let mut words = ScreenWords::default();
        for (size, roomy) in
            ROOMY_SIZES.map(|size| (size, true)).into_iter().chain(boundary_sizes().map(|size| (size, false)))
        {
            console.size = size;
            let drawn = console.screen();
            if size.0 >= 60 && size.1 >= 16 {
                words.read_screen(&drawn, size.0, roomy, &format!("menu {keys} at {size:?}"));
            }
        }
        console.size = (80, 24);
        assert_eq!(console.screen(), before);
        assert!(words.truncated_words().is_empty(), "{:#?}", words.truncated_words());
    }
}

/// Sizes of windows in which every title, heading and label is complete.
const LABEL_SIZES: [(u16, u16); 4] = [(60, 16), (80, 24), (100, 30), (120, 40)];

/// Returns the rows in which a title, a heading or a label in a border ends with an ellipsis. The theme of the tests
/// gives titles and headings styles that no other text has.
fn cut_labels(buffer: &Buffer, theme: &Theme) -> Vec<String> {
    let is_cut = |x: u16, y: u16| {
        let cell = &buffer[(x, y)];
        let has_role = |role| {
            let style = theme.style(role);
            style.fg == Some(cell.fg) && cell.modifier.contains(style.add_modifier)
        };
        let in_border = || {
            let mut next = (x + 1..=x + 2).rev().filter_map(|x| buffer.cell((x, y)));
            next.next().is_some_and(|cell| "─━┐┓┘┛".contains(cell.symbol()))
        };
        cell.symbol() == "…" && (has_role(Role::Title) || has_role(Role::Header) || in_border())
    };
    let row = |y| (0..buffer.area.width).map(|x| buffer[(x, y)].symbol()).collect::<String>();
    (0..buffer.area.height)
        .filter(|y| (0..buffer.area.width).any(|x| is_cut(x, *y)))
        .map(|y| row(y).trim_end().to_owned())
        // After the first key of a sequence, the ellipsis represents the next key.
        .filter(|row| !row.contains("┏ g … "))
        .collect()
}

#[test]
fn no_title_heading_or_label_is_cut() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_played_run(runs.path());
    let mut cut = BTreeSet::new();
    for (open, close) in PLACES {
        console.press(open);
        for size in LABEL_SIZES {
            console.size = size;
            let buffer = console.draw();
            let rows = cut_labels(&buffer, &console.app.theme);
            cut.extend(rows.into_iter().map(|row| format!("{open} at {size:?}: {row}")));
        }
        console.size = (120, 40);
        console.press(close);
    }
    assert!(cut.is_empty(), "{} labels are cut:\n{cut:#?}", cut.len());
}

#[test]
fn ascii_mode_draws_only_ascii() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_played_run(runs.path());
    console.app.glyphs = Glyphs::Ascii;
    for (open, close) in PLACES {
        console.press(open);
        let screen = console.screen();
        assert!(screen.is_ascii(), "{open}:\n{screen}");
        console.press(close);
    }
}

#[test]
fn smallest_window_names_the_current_screen() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_played_run(runs.path());
    console.size = (60, 16);
    for (key, title) in [("1", "Overview"), ("5", "Social"), ("6", "Inbox"), ("8", "Tools"), ("0", "Journal")]
    {
        console.press(key);
        let screen = console.screen();
        let tabs = screen.lines().nth(1).expect("tabs");
        assert!(tabs.contains(&format!(" {key} {title}")), "{tabs}");
    }
}

#[test]
fn footer_message_is_separated_from_keys() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_in_played_run(runs.path());
    let message = "charts use blocks";
    console.press("; d");
    let mut shared_width_count = 0;
    for width in 60..140 {
        console.size = (width, 20);
        let screen = console.screen();
        let line = screen.lines().last().expect("a last line").to_owned();
        let (before, _) = line.split_once(message).unwrap_or_else(|| panic!("{line}"));
        assert!(before.is_empty() || before.ends_with("  "), "{line}");
        shared_width_count += u32::from(!before.trim().is_empty());
    }
    assert!(shared_width_count > 40, "the keys and the message share the line: {shared_width_count}");
}
