//! Tables and lists of all screens: complete numbers, units, marks where rows or columns are left out, and layouts of
//! columns that are remembered.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use novamind::console::app::Stage;
use novamind::console::context::{ScreenContext, ScreenId};
use novamind::record::folder::configuration::Configuration;

use super::company::copy_played_run;
use super::harness::Console;
use super::sizes::PLACES;

/// Window sizes in which no value is cut.
const SIZES: [(u16, u16); 3] = [(60, 16), (80, 24), (100, 30)];

/// Played companies: with enterprises, and with many subscribers.
const COMPANIES: [(&str, u64, u32); 2] = [("companies.toml", 3, 35), ("crowd.toml", 42, 105)];

/// Screens whose panes are visited with tab. The SQL screen is included only in tests that do not type.
const SCREENS: [&str; 9] = ["1", "2", "3", "3 enter", "4", "5", "6", "7", "0"];

fn console_of(company: usize, runs: &Path) -> Console {
    let (policy, seed, until) = COMPANIES[company];
    copy_played_run(policy, seed, until, runs);
    Console::in_latest_run(runs, (80, 24))
}

/// Returns whether an ellipsis in a line is inside or directly next to a number.
fn has_cut_number(line: &str) -> bool {
    line.match_indices('…').any(|(at, sign)| {
        let before = line[..at].trim_end_matches(['k', 'M', 'B', '%', '.', ',']);
        let next = line[at + sign.len()..].chars().next();
        before.ends_with(|letter: char| letter.is_ascii_digit())
            || next.is_some_and(|next| next.is_ascii_digit())
    })
}

#[test]
fn cut_numbers_are_recognized() {
    for line in ["cash $1,5…", "in 12…", "about 45.6k… ", "…19 wk", "12.3%…"] {
        assert!(has_cut_number(line), "{line}");
    }
    for line in ["Price-Sensitive Ind…", "12 weeks …", "reading …", "1 of 3 · …"] {
        assert!(!has_cut_number(line), "{line}");
    }
}

#[test]
fn no_screen_or_dialog_cuts_a_number() {
    let mut cut = BTreeSet::new();
    for company in 0..COMPANIES.len() {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = console_of(company, runs.path());
        for (open, close) in PLACES {
            console.size = (120, 40);
            console.press(open);
            for size in SIZES {
                console.size = size;
                let screen = console.screen();
                cut.extend(
                    screen
                        .lines()
                        .filter(|line| has_cut_number(line))
                        .map(|line| format!("{open} {size:?}: {line}")),
                );
            }
            console.size = (120, 40);
            console.press(close);
        }
    }
    assert!(cut.is_empty(), "{} cut numbers:\n{cut:#?}", cut.len());
}

/// A pane with the focus: its rows between the thick borders, and the characters of its right border.
struct FocusedPane {
    rows: Vec<String>,
    right_border: String,
}

/// Returns the pane with thick borders on a screen.
fn focused_pane(screen: &str) -> Option<FocusedPane> {
    let lines: Vec<Vec<char>> = screen.lines().map(|line| line.chars().collect()).collect();
    let top = lines.iter().position(|line| line.contains(&'┏'))?;
    let left = lines[top].iter().position(|letter| *letter == '┏')?;
    let right = left + lines[top][left..].iter().position(|letter| *letter == '┓')?;
    let inside =
        lines[top + 1..].iter().take_while(|line| line.get(left).is_some_and(|letter| *letter != '┗'));
    let cell = |line: &[char], at: usize| line.get(at).copied().unwrap_or(' ');
    let (mut rows, mut right_border) = (Vec::new(), String::new());
    for line in inside {
        rows.push((left + 1..right).map(|at| cell(line, at)).collect());
        right_border.push(cell(line, right));
    }
    Some(FocusedPane { rows, right_border })
}

#[test]
fn lists_with_hidden_rows_have_marks() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_of(0, runs.path());
    let mut scrolled = 0;
    for size in SIZES {
        console.size = size;
        for screen in ["1", "2", "3", "4", "6", "7", "8", "0"] {
            console.press(&format!("esc esc {screen}"));
            for _ in 0..6 {
                console.press("home");
                let first = focused_pane(&console.screen());
                console.press("end");
                let last = focused_pane(&console.screen());
                if let (Some(first), Some(last)) = (first, last)
                    && first.rows.len() == last.rows.len()
                    && first.right_border.len() > 2
                    // The headings stay, the rows below are other rows.
                    && first.rows.first() == last.rows.first()
                    && first.rows.get(1) != last.rows.get(1)
                    && !first.right_border.contains(' ')
                    // A list that was scrolled to its end fills the pane.
                    && !last.rows.last().is_some_and(|row| row.trim().is_empty())
                {
                    scrolled += 1;
                    let marks = (first.right_border.contains('↓'), last.right_border.contains('↑'));
                    assert_eq!(marks, (true, true), "{screen} at {size:?}:\n{}", console.screen());
                }
                console.press("tab");
            }
        }
    }
    assert!(scrolled >= 5, "lists were scrolled: {scrolled}");
}

/// Returns the positions of the corners of all panes. Thick and thin borders count the same.
fn corners(screen: &str) -> BTreeSet<(usize, usize, char)> {
    let thin = |letter: char| match letter {
        '┏' | '┌' => Some('┌'),
        '┛' | '┘' => Some('┘'),
        _ => None,
    };
    let line = |(y, line): (usize, &str)| {
        line.chars().enumerate().filter_map(|(x, letter)| Some((x, y, thin(letter)?))).collect::<Vec<_>>()
    };
    screen.lines().enumerate().flat_map(line).collect()
}

#[test]
fn moving_the_focus_does_not_move_panes() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_of(0, runs.path());
    for size in [(60, 16), (80, 24), (100, 30), (120, 40), (200, 60)] {
        console.size = size;
        for screen in SCREENS {
            // Below 104 columns, the second page of the Social screen consists of a pane and a chart.
            if screen == "5" && size.0 < 104 {
                continue;
            }
            console.press(&format!("esc esc {screen}"));
            let before = console.screen();
            let Stage::Run(run) = &console.app.stage else { panic!("a run") };
            for _ in 0..run.screens.get(run.screen).pane_count() {
                console.press("tab");
                let after = console.screen();
                // A pane can contain several boxes.
                assert!(
                    corners(&before).is_subset(&corners(&after)),
                    "{screen} at {size:?}:\n{before}\n{after}"
                );
            }
        }
    }
}

/// Figures whose percentages have two decimals, because they are mostly below one percent.
const PRECISE_SHARES: [&str; 1] = ["error rate"];

/// Returns the unit of a cell that contains a single number, and the decimals of the number. Compact numbers such as
/// `12.3k` have three significant digits and no fixed number of decimals.
fn unit_and_decimals(cell: &str) -> Option<(&'static str, usize)> {
    let text = cell.trim_start_matches(['▲', '▼', '!', ' ', '+', '-', '±', '≥']);
    let (text, is_money) = text.strip_prefix('$').map_or((text, false), |amount| (amount, true));
    let end =
        text.find(|letter: char| !letter.is_ascii_digit() && !",.".contains(letter)).unwrap_or(text.len());
    let (number, rest) = text.split_at(end);
    let unit = match (is_money, rest.trim()) {
        (true, "") => "$",
        (false, "%") => "%",
        (false, "pt") => "pt",
        (false, "") => "",
        _ => return None,
    };
    number
        .chars()
        .any(|letter| letter.is_ascii_digit())
        .then(|| (unit, number.split_once('.').map_or(0, |it| it.1.len())))
}

/// Returns whether a heading names a unit.
fn names_a_unit(heading: &str) -> bool {
    [
        "$", "%", "/", "day", "week", "ms", "units", "minutes", "seats", "score", "tier", "required",
        "targeted", "true",
    ]
    .iter()
    .any(|unit| heading.contains(unit))
}

#[test]
fn numbers_of_a_unit_have_one_precision_and_fractions_a_unit() {
    let mut problems = BTreeSet::new();
    let mut tables = BTreeSet::new();
    for company in 0..COMPANIES.len() {
        let runs = tempfile::tempdir().expect("a folder");
        let mut console = console_of(company, runs.path());
        for screen in ["1", "2", "3", "6", "7", "0"] {
            console.press(&format!("esc esc {screen}"));
            for _ in 0..6 {
                let Stage::Run(run) = &console.app.stage else { panic!("a run") };
                let context = ScreenContext { company: &run.company, keys: &console.app.keys, page_rows: 10 };
                if let Some((title, table)) = run.screens.get(run.screen).focused_table(&context) {
                    tables.insert(format!("{:?} {title}", run.screen));
                    check_table(&title, table, &mut problems);
                }
                console.press("tab");
            }
        }
    }
    assert!(tables.len() >= 7, "{tables:?}");
    assert!(problems.is_empty(), "{problems:#?}");
}

fn check_table(title: &str, table: &novamind::tui::widgets::Table, problems: &mut BTreeSet<String>) {
    for (at, column) in table.columns().iter().enumerate() {
        let mut decimals: BTreeMap<&str, (usize, String)> = BTreeMap::new();
        for row in table.rows() {
            let name = row.first().map_or("", |cell| cell.text.as_str());
            let Some(cell) = row.get(at).filter(|cell| cell.number.is_some()) else { continue };
            let Some((unit, number)) = unit_and_decimals(&cell.text) else { continue };
            if PRECISE_SHARES.iter().any(|share| name.starts_with(share)) {
                continue;
            }
            if unit.is_empty() && number > 0 && !names_a_unit(&column.title) && !names_a_unit(name) {
                problems.insert(format!("{title}, {}: {} has no unit", column.title, cell.text));
            }
            let first = decimals.entry(unit).or_insert((number, cell.text.clone()));
            if first.0 != number {
                problems.insert(format!("{title}, {}: {} and {}", column.title, first.1, cell.text));
            }
        }
    }
}

#[test]
fn quality_has_three_decimals_on_every_screen() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_of(0, runs.path());
    let mut seen = 0;
    for place in ["1", "4", "3 enter", "7"] {
        console.size = (200, 60);
        console.press(&format!("esc esc {place}"));
        for line in console.screen().lines() {
            let shown: Vec<&str> = ["required ", "base ", "general +", "delivered quality "]
                .iter()
                .flat_map(|name| line.match_indices(name).map(|(at, name)| &line[at + name.len()..]))
                .collect();
            for text in shown {
                let number: String = text
                    .trim_start()
                    .chars()
                    .take_while(|letter| letter.is_ascii_digit() || *letter == '.')
                    .collect();
                if let Some((_, fraction)) = number.split_once('.') {
                    seen += 1;
                    assert_eq!(fraction.len(), 3, "{line}");
                }
            }
        }
    }
    assert!(seen >= 3, "qualities were shown: {seen}");
}

#[test]
fn week_report_in_the_smallest_window_scrolls_to_its_end() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = console_of(0, runs.path());
    console.size = (60, 16);
    console.press("1 w");
    let first = console.screen();
    assert!(first.contains('↓') && !first.contains("larger window"), "{first}");
    for _ in 0..80 {
        console.press("down");
    }
    let last = console.screen();
    assert!(last.contains('↑') && !last.contains('↓'), "{last}");
    let rows = focused_pane(&last).expect("the report").rows;
    assert!(rows.iter().any(|row| row.contains("Action needed")), "{last}");
    assert!(!rows.last().expect("a row").contains("Action needed"), "a heading without rows:\n{last}");
}

#[test]
fn layout_of_columns_is_remembered() {
    let runs = tempfile::tempdir().expect("a folder");
    let configuration =
        || Configuration { folder: Some(runs.path().join("configuration")), ..Configuration::bundled() };
    let folder = runs.path().join("runs");
    copy_played_run(COMPANIES[0].0, COMPANIES[0].1, COMPANIES[0].2, &folder);
    let open = || {
        let mut console = Console::start_with(configuration(), &folder, (100, 30));
        console.open("latest").expect("the run opens");
        console.press("3");
        console
    };
    let head = |console: &mut Console| {
        let screen = console.screen();
        screen.lines().find(|line| line.contains("group  ")).unwrap_or_else(|| panic!("{screen}")).to_owned()
    };
    let mut console = open();
    assert!(
        head(&mut console).contains("group  name") && head(&mut console).contains("+"),
        "{}",
        console.screen()
    );
    // Hides the kind of the groups and moves their names behind the subscribers.
    console.press("C down down space up J J");
    console.assert_shows("Columns of Groups");
    console.press("esc");
    let changed = head(&mut console);
    assert!(!changed.contains("kind") && changed.contains("group  subs  name"), "{changed}");
    drop(console);
    let mut again = open();
    assert_eq!(head(&mut again), changed, "the layout is saved");
    again.press("C r esc");
    assert!(head(&mut again).contains("group  name"), "{}", again.screen());
    again.press("1 tab tab tab C");
    let screen = again.screen();
    assert!(screen.contains("no columns to arrange") || screen.contains("Columns of"), "{screen}");
    let Stage::Run(run) = &again.app.stage else { panic!("a run") };
    assert_eq!(run.screen, ScreenId::Overview);
}
