//! Automatic checks of the layout: truncated words next to free space, and empty halves.

use super::harness::Console;

/// Window sizes: the minimum, the smallest supported, a usual one, a large one.
pub const SIZES: [(u16, u16); 4] = [(60, 16), (80, 24), (120, 40), (200, 60)];

/// Returns the screen in the usual window. Adds words truncated next to free space, in windows of all these sizes, to
/// `complaints`. The size of the console does not change.
pub fn picture(console: &mut Console, complaints: &mut Vec<String>) -> String {
    let own = console.size;
    let mut usual = String::new();
    for size in SIZES {
        console.size = size;
        let letters = console.screen();
        complaints.extend(cut_with_room(&letters).into_iter().map(|line| format!("{size:?}: {line}")));
        if size == (120, 40) {
            usual = letters;
        }
    }
    console.size = own;
    usual
}

/// Spaces after a truncated word that count as free space rather than a column gap.
const GAP: usize = 4;

/// Returns the lines with a word truncated next to free space, up to the next border.
pub fn cut_with_room(screen: &str) -> Vec<String> {
    let wasteful = |line: &&str| {
        line.match_indices('…').any(|(at, sign)| {
            let behind = &line[at + sign.len()..];
            let blanks = behind.chars().take_while(|letter| *letter == ' ').count();
            let next = behind.chars().nth(blanks);
            blanks >= GAP && matches!(next, Some('│' | '┃') | None) && next.is_some()
        })
    };
    screen.lines().filter(wasteful).map(str::to_owned).collect()
}

/// Returns the share of non-empty cells in the emptiest half, horizontally or vertically, without borders.
pub fn emptiest_half(screen: &str, width: usize) -> f64 {
    let rows: Vec<Vec<char>> = screen
        .lines()
        .map(|line| {
            let mut cells: Vec<char> = line.chars().collect();
            cells.resize(width, ' ');
            cells
        })
        .collect();
    let (rows_half, columns_half) = (rows.len() / 2, width / 2);
    let share = |of: &dyn Fn(usize, usize) -> bool| {
        let cells = rows
            .iter()
            .enumerate()
            .flat_map(|(y, row)| row.iter().enumerate().map(move |(x, cell)| (x, y, *cell)));
        let own: Vec<char> = cells.filter(|(x, y, _)| of(*x, *y)).map(|(_, _, cell)| cell).collect();
        own.iter().filter(|cell| is_ink(**cell)).count() as f64 / own.len().max(1) as f64
    };
    let halves: [&dyn Fn(usize, usize) -> bool; 4] =
        [&|x, _| x < columns_half, &|x, _| x >= columns_half, &|_, y| y < rows_half, &|_, y| y >= rows_half];
    halves.into_iter().map(share).fold(1.0, f64::min)
}

fn is_ink(cell: char) -> bool {
    !" \u{2800}─│┌┐└┘├┤┬┴┼━┃┏┓┗┛".contains(cell)
}

#[test]
fn a_cut_word_before_room_is_found_and_one_before_a_column_is_not() {
    assert_eq!(cut_with_room("│ a long na…        │"), ["│ a long na…        │"]);
    assert!(cut_with_room("│ a long na…  12 │\n│ a long name…│\n at the end of the line…").is_empty());
}

#[test]
fn an_empty_half_is_seen() {
    let half = "xxxxx     \n".repeat(4);
    assert!(emptiest_half(&half, 10) < 1e-9);
    assert!(emptiest_half(&"x x x x x \n".repeat(4), 10) > 0.39);
}
