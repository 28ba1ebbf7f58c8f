//! Pictures of every screen with realistic companies: the first week, a crisis in week 30, a large company in week 45.
//! The pictures in `snapshots/` have the usual window size. Small and large windows are checked for truncated words
//! and empty halves. `cargo insta review` shows the effect of a change.

use novamind::record::mode::Mode;
use novamind::session::SeekTarget;
use novamind::tui::theme::Theme;
use ratatui::buffer::Buffer;

use super::company::copy_played_run;
use super::harness::Console;
use super::picture_checks::{min_half_coverage, needlessly_truncated_lines};
use super::replay::{console_in_replay, played_run};

/// Window sizes: smallest supported, usual and large.
const SIZES: [(u16, u16); 3] = [(80, 24), (120, 40), (200, 60)];

/// Themes of the pictures. The text must be the same in all themes.
const THEMES: [&str; 2] = ["dark", "light"];

/// Names of the pictures, keys that open the screen or dialog, and keys that return.
const PLACES: [(&str, &str, &str); 15] = [
    ("overview", "1", ""),
    ("cash", "2", ""),
    ("customers", "3", ""),
    ("customers-group", "3 enter", "esc"),
    ("product", "4", ""),
    ("social", "5", ""),
    ("inbox", "6", ""),
    ("market", "7", ""),
    ("tools", "8", ""),
    ("tools-form", "8 enter", "esc"),
    ("sql", "9", "esc"),
    ("journal", "0", ""),
    ("week-report", "1 w", "esc"),
    ("palette", "1 :", "esc"),
    ("next-week", "1 n enter 'because' enter f", "esc esc"),
];

/// Compares the pictures of all `PLACES` of a run with the snapshots.
fn check_pictures(name: &str, policy: &str, seed: u64, until: u32) {
    let runs = tempfile::tempdir().expect("a folder");
    copy_played_run(policy, seed, until, runs.path());
    let mut console = Console::in_latest_run(runs.path(), SIZES[1]);
    let mut complaints = Vec::new();
    let has_much_data = until > 300;
    for (place, keys, back) in PLACES {
        console.press(keys);
        let picture = picture_text(&mut console, place, has_much_data, &mut complaints);
        insta::assert_snapshot!(format!("{name}-{place}"), picture);
        console.size = SIZES[1];
        console.press(back);
    }
    assert!(complaints.is_empty(), "{name}:\n{}", complaints.join("\n"));
}

/// Minimum share of non-empty cells in every half of a large window.
const MIN_NON_EMPTY_SHARE: f64 = 0.04;

/// Returns the layout problems of a picture. Empty halves are a problem only if `has_much_data` is set, because only a company
/// with much data fills both halves.
fn layout_problems(place: &str, size: (u16, u16), has_much_data: bool, letters: &str) -> Vec<String> {
    let cut = needlessly_truncated_lines(letters);
    let mut found: Vec<String> = cut
        .into_iter()
        .map(|line| format!("{place} at {size:?}: truncated next to free space: {line}"))
        .collect();
    let ink = min_half_coverage(letters, size.0.into());
    if has_much_data && size.0 >= 120 && ink < MIN_NON_EMPTY_SHARE {
        found.push(format!("{place} at {size:?}: a half is empty ({ink:.3}):\n{letters}"));
    }
    found
}

fn picture_text(console: &mut Console, place: &str, has_much_data: bool, found: &mut Vec<String>) -> String {
    let mut text = String::new();
    for size in SIZES {
        console.size = size;
        let mut letters: Option<String> = None;
        for theme in THEMES {
            console.app.theme = Theme::bundled(theme).expect("a theme");
            let buffer = console.draw();
            let drawn_text = buffer_text(&buffer);
            if let Some(before) = &letters {
                assert_eq!(*before, drawn_text, "the theme {theme} changes the text");
            } else {
                found.extend(layout_problems(place, size, has_much_data, &drawn_text));
                if size == SIZES[1] {
                    text.clone_from(&drawn_text);
                }
            }
            letters = Some(drawn_text);
        }
    }
    text
}

fn buffer_text(buffer: &Buffer) -> String {
    let row = |y| (0..buffer.area.width).map(|x| buffer[(x, y)].symbol()).collect::<String>();
    (0..buffer.area.height).map(|y| row(y).trim_end().to_owned() + "\n").collect()
}

#[test]
fn first_week_matches_snapshots() {
    check_pictures("week-1", "opening.toml", 42, 7);
}

#[test]
fn crisis_in_week_30_matches_snapshots() {
    check_pictures("week-30", "crisis.toml", 42, 210);
}

#[test]
fn large_company_in_week_45_matches_snapshots() {
    check_pictures("week-45", "crowd.toml", 42, 315);
}

/// Names of the pictures of a replay, keys that open the screen or dialog, and keys that return.
const REPLAY_PLACES: [(&str, &str, &str); 6] = [
    ("overview", "1", ""),
    ("cash", "2", ""),
    ("tools-form", "8 enter", "esc"),
    ("half-a-week", "1 ) ) )", "<"),
    ("seek", "#", "esc"),
    ("take-over", "T", "esc"),
];

#[test]
fn replay_matches_snapshots() {
    let runs = tempfile::tempdir().expect("a folder");
    drop(played_run(runs.path(), Mode::Sandbox, 12));
    let mut console = console_in_replay(runs.path(), SIZES[1], SeekTarget::Week(7));
    let mut complaints = Vec::new();
    for (place, keys, back) in REPLAY_PLACES {
        console.press(keys);
        let picture = picture_text(&mut console, place, false, &mut complaints);
        insta::assert_snapshot!(format!("replay-{place}"), picture);
        console.size = SIZES[1];
        console.press(back);
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

/// Elements that explain figures or change decisions, in a company whose price changed in week 4: names, keys that open
/// the element, and keys that return.
const EXPLANATIONS: [(&str, &str, &str); 9] = [
    ("fit-curve", "3 enter", "esc"),
    ("price-form", ": 'set_prices' enter enter", "esc esc"),
    ("column-chooser", "3 C", "esc"),
    ("why", "2 ; w", "esc"),
    ("what-if", "; b", "esc"),
    ("sql-edit", "9 i 'SELECT' ", "esc"),
    ("key-without-effect", "2 K", ""),
    ("outlook", "2 tab", ""),
    ("curve", "; v", "esc"),
];

#[test]
fn explanations_match_snapshots_at_four_sizes() {
    let runs = tempfile::tempdir().expect("a folder");
    drop(played_run(runs.path(), Mode::Sandbox, 6));
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    let mut complaints = Vec::new();
    for (place, keys, back) in EXPLANATIONS {
        console.press(keys);
        let pictures = super::picture_checks::SIZES.map(|size| {
            console.size = size;
            let picture = console.screen();
            complaints.extend(
                needlessly_truncated_lines(&picture)
                    .into_iter()
                    .map(|line| format!("{place} at {size:?}: {line}")),
            );
            picture
        });
        insta::assert_snapshot!(format!("explained-{place}"), pictures.join("\n"));
        console.size = (120, 40);
        console.press(back);
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
