//! Fuzzy search: finds entries from parts of their names and returns the best matches first.

use nucleo_matcher::pattern::{CaseMatching, Normalization, Pattern};
use nucleo_matcher::{Config, Matcher, Utf32Str};
use ratatui::layout::Rect;
use unicode_segmentation::UnicodeSegmentation;
use unicode_width::UnicodeWidthStr;

use super::canvas::Canvas;
use super::theme::Role;

/// A match: the index of the entry, and the positions of the matched letters in its title.
pub type FuzzyMatch = (usize, Vec<u32>);

/// Returns the matching entries, best match first. Matches in titles rank higher than matches in explanations. If the
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

/// Draws the title of an entry and highlights the matched letters. If the matched letters do not fit, omits the
/// beginning of the title.
pub fn draw_title(canvas: &mut Canvas<'_>, area: Rect, title: &str, letters: &[u32], roles: [Role; 2]) {
    let graphemes: Vec<&str> = title.graphemes(true).collect();
    let from = first_shown_grapheme(&graphemes, letters, area.width as usize);
    let shown = match from {
        0 => title.to_owned(),
        from => format!("…{}", graphemes[from..].concat()),
    };
    canvas.draw_text(area, &shown, roles[0]);
    // A truncated title ends with an ellipsis in the last column.
    let cut = shown.width() > area.width as usize;
    let room = area.width.saturating_sub(u16::from(cut));
    let mut column = u16::from(from > 0);
    for (at, letter) in graphemes.iter().enumerate().skip(from) {
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

/// Returns the first grapheme to show, so that the last matched letter is visible and there is room for an ellipsis at
/// each end.
fn first_shown_grapheme(graphemes: &[&str], letters: &[u32], width: usize) -> usize {
    let columns =
        |range: std::ops::Range<usize>| graphemes[range].iter().map(|letter| letter.width()).sum::<usize>();
    let last = letters.iter().max().map_or(0, |last| (*last as usize + 1).min(graphemes.len()));
    let after = usize::from(last < graphemes.len());
    if columns(0..graphemes.len()) <= width || columns(0..last) + after <= width {
        return 0;
    }
    (0..last).find(|from| 1 + columns(*from..last) + after <= width).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matched_letters_of_a_long_title_are_visible() {
        let theme = crate::theme::Theme::bundled("mono").expect("a theme");
        let shown = |typed: &str| {
            let title = "Cancelled subscribers and their issues";
            let letters = find(typed, std::iter::once((title, ""))).remove(0).1;
            let mut buffer = ratatui::buffer::Buffer::empty(Rect::new(0, 0, 24, 1));
            let area = buffer.area;
            draw_title(&mut Canvas::new(&mut buffer, &theme), area, title, &letters, [Role::Text, Role::Key]);
            (0..24).map(|x| buffer[(x, 0)].symbol()).collect::<String>()
        };
        assert_eq!(shown("their issues"), "…ribers and their issues");
        assert_eq!(shown("subscribers"), "Cancelled subscribers a…");
        assert_eq!(shown("their"), "… subscribers and their…");
    }

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
