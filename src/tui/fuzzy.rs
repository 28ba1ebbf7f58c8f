//! Fuzzy search: finds entries by parts of their names, the best match first.

use nucleo_matcher::pattern::{CaseMatching, Normalization, Pattern};
use nucleo_matcher::{Config, Matcher, Utf32Str};
use ratatui::layout::Rect;
use unicode_segmentation::UnicodeSegmentation;
use unicode_width::UnicodeWidthStr;

use super::canvas::Canvas;
use super::theme::Role;

/// A match: the index of the entry, and the positions of the matched letters in the entry's title.
pub type FuzzyMatch = (usize, Vec<u32>);

/// Returns the matching entries, the best first. Matches in titles rank higher than matches in explanations. If the
/// search text is empty, returns all entries in their original order.
pub fn find<'a>(typed: &str, all: impl Iterator<Item = (&'a str, &'a str)>) -> Vec<FuzzyMatch> {
    let pattern = Pattern::parse(typed, CaseMatching::Smart, Normalization::Smart);
    let mut matcher = Matcher::new(Config::DEFAULT);
    let mut scored: Vec<(u32, usize, Vec<u32>)> = Vec::new();
    let mut characters = Vec::new();
    for (at, (title, doc)) in all.enumerate() {
        let mut places = Vec::new();
        let title = Utf32Str::new(title, &mut characters);
        if let Some(score) = pattern.indices(title, &mut matcher, &mut places) {
            scored.push((score * 2 + 1, at, places));
        } else if let Some(score) = pattern.score(Utf32Str::new(doc, &mut characters), &mut matcher) {
            scored.push((score, at, Vec::new()));
        }
    }
    scored.sort_by(|left, right| right.0.cmp(&left.0).then(left.1.cmp(&right.1)));
    scored.into_iter().map(|(_, at, places)| (at, places)).collect()
}

/// Draws the title of an entry with highlighted matched letters.
pub fn draw_title(canvas: &mut Canvas<'_>, area: Rect, title: &str, letters: &[u32], roles: [Role; 2]) {
    canvas.draw_text(area, title, roles[0]);
    // A truncated title ends with an ellipsis in the last column.
    let cut = title.width() > area.width as usize;
    let room = area.width.saturating_sub(u16::from(cut));
    let mut column = 0;
    for (at, letter) in title.graphemes(true).enumerate() {
        let width = letter.width() as u16;
        if column + width > room {
            break;
        }
        if letters.contains(&(at as u32)) {
            canvas.draw_text(Rect { x: area.x + column, width, ..area }, letter, roles[1]);
        }
        column += width;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn title_matches_rank_before_explanation_matches() {
        let all = [("cash by week", "nothing"), ("nothing", "cash by week"), ("crash", "x"), ("zero", "y")];
        let found = find("cash", all.into_iter());
        let order: Vec<usize> = found.iter().map(|(at, _)| *at).collect();
        assert_eq!(order, [0, 2, 1]);
        assert_eq!(found[0].1, [0, 1, 2, 3]);
        assert_eq!(find("", all.into_iter()).len(), 4);
        assert!(find("qqq", all.into_iter()).is_empty());
    }
}
