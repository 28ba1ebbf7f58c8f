//! Automatic checks of the layout: truncated words next to free space, and empty halves.

use super::harness::Console;

/// Window sizes: minimum, smallest supported, usual and large.
pub const SIZES: [(u16, u16); 4] = [(60, 16), (80, 24), (120, 40), (200, 60)];

/// Returns the screen in a window of the usual size. Draws the screen in windows of all `SIZES` and adds words that
/// are truncated next to free space to `complaints`. The size of the console does not change.
pub fn snapshot_text(console: &mut Console, complaints: &mut Vec<String>) -> String {
    let initial_size = console.size;
    let mut usual = String::new();
    for size in SIZES {
        console.size = size;
        let letters = console.screen();
        complaints
            .extend(needlessly_truncated_lines(&letters).into_iter().map(|line| format!("{size:?}: {line}")));
        if size == (120, 40) {
            usual = letters;
        }
    }
    console.size = initial_size;
    usual
}

/// Minimum number of spaces after a truncated word that count as free space instead of a gap between columns.
const MIN_FREE_SPACES: usize = 4;
/// Width of the longest numbers in texts.
const LONGEST_NUMBER: usize = 8;

/// Returns the lines that contain a word that is truncated although free space follows up to the next border.
pub fn needlessly_truncated_lines(screen: &str) -> Vec<String> {
    let is_needlessly_truncated = |line: &&str| {
        line.match_indices('…').any(|(at, sign)| {
            // An ellipsis after a complete sentence does not replace a part of a word.
            if line[..at].ends_with(". ") {
                return false;
            }
            let behind = &line[at + sign.len()..];
            let blanks = behind.chars().take_while(|letter| *letter == ' ').count();
            let next = behind.chars().nth(blanks);
            // Numbers are never cut, so a line that ends between words has space for a part of a number.
            let is_between_words = line[..at].ends_with(' ');
            let least = if is_between_words { MIN_FREE_SPACES + LONGEST_NUMBER } else { MIN_FREE_SPACES };
            blanks >= least && matches!(next, Some('│' | '┃') | None) && next.is_some()
        })
    };
    screen.lines().filter(is_needlessly_truncated).map(str::to_owned).collect()
}

/// Returns the share of non-empty cells in the emptiest half of the screen: left, right, upper or lower half. Borders
/// do not count.
pub fn min_half_coverage(screen: &str, width: usize) -> f64 {
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
        let characters: Vec<char> = cells.filter(|(x, y, _)| of(*x, *y)).map(|(_, _, cell)| cell).collect();
        characters.iter().filter(|cell| is_non_empty_cell(**cell)).count() as f64
            / characters.len().max(1) as f64
    };
    let halves: [&dyn Fn(usize, usize) -> bool; 4] =
        [&|x, _| x < columns_half, &|x, _| x >= columns_half, &|_, y| y < rows_half, &|_, y| y >= rows_half];
    halves.into_iter().map(share).fold(1.0, f64::min)
}

fn is_non_empty_cell(cell: char) -> bool {
    !" \u{2800}─│┌┐└┘├┤┬┴┼━┃┏┓┗┛".contains(cell)
}

#[test]
fn truncation_is_reported_only_with_free_space() {
    assert_eq!(needlessly_truncated_lines("│ a long na…        │"), ["│ a long na…        │"]);
    assert!(needlessly_truncated_lines("│ A sentence. …      │").is_empty());
    assert!(
        needlessly_truncated_lines("│ a long na…  12 │\n│ a long name…│\n at the end of the line…")
            .is_empty()
    );
}

#[test]
fn min_half_coverage_finds_an_empty_half() {
    let half = "xxxxx     \n".repeat(4);
    assert!(min_half_coverage(&half, 10) < 1e-9);
    assert!(min_half_coverage(&"x x x x x \n".repeat(4), 10) > 0.39);
}
