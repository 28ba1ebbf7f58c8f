//! Draws the feed: day headings, authors and wrapped texts, with the selected post visible.

use unicode_width::UnicodeWidthStr;

use super::feed::{Post, PostKind};
use crate::screens::panes::PanePlacement;
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

struct FeedRow {
    text: String,
    role: Role,
    post_index: Option<usize>,
}

/// Draws posts with their days and authors. `selected` is an index of `posts`.
pub fn draw(canvas: &mut Canvas<'_>, placement: PanePlacement, posts: &[&Post], selected: usize) {
    let (area, focused) = (placement.area, placement.focused);
    if area.is_empty() {
        return;
    }
    let width = area.width as usize;
    let rows = rows_around_selection(posts, selected, width, area.height as usize);
    let mut seen: Vec<usize> = rows.iter().filter_map(|row| row.post_index).collect();
    seen.dedup();
    if focused {
        canvas.page_rows = (seen.len() as u16).max(1);
    }
    for (row, line) in row_rects(area).zip(&rows) {
        let here = line.post_index == Some(selected);
        let role = match (here, focused) {
            (true, true) => Role::Selection,
            (true, false) => Role::InactiveSelection,
            (false, _) => line.role,
        };
        if here {
            canvas.clear(row, role);
        }
        canvas.draw_text(row, &line.text, role);
        if let Some(place) = line.post_index {
            canvas.register_click(row, Click::Row(placement.index, place));
        }
    }
}

/// Returns the rows around the selected post. Posts outside the window are not wrapped.
fn rows_around_selection(posts: &[&Post], selected: usize, width: usize, height: usize) -> Vec<FeedRow> {
    let Some(last) = posts.len().checked_sub(1) else { return Vec::new() };
    let selected = selected.min(last);
    // At most half of the window is above the selected post, unless too few posts follow it.
    let mut blocks: Vec<Vec<FeedRow>> = vec![rows_of_post(posts, selected, width)];
    let mut below = blocks[0].len();
    let mut next = selected + 1;
    let mut rest = Vec::new();
    while below < height && next <= last {
        let feed_rows = rows_of_post(posts, next, width);
        below += feed_rows.len();
        rest.push(feed_rows);
        next += 1;
    }
    let room = (height / 2).max(height.saturating_sub(below));
    let (mut above, mut first) = (0, selected);
    while first > 0 {
        let rows = rows_of_post(posts, first - 1, width);
        if above + rows.len() > room {
            break;
        }
        above += rows.len();
        blocks.insert(0, rows);
        first -= 1;
    }
    blocks.into_iter().chain(rest).flatten().take(height).collect()
}

fn rows_of_post(posts: &[&Post], place: usize, width: usize) -> Vec<FeedRow> {
    let post = posts[place];
    let before = place.checked_sub(1).map(|before| posts[before]);
    let mut rows = Vec::new();
    let comment = post.kind == PostKind::Comments;
    let same_thread = |before: &Post| match before.kind {
        PostKind::Own => Some(before.number) == post.answered_post,
        PostKind::Comments => before.answered_post == post.answered_post,
        _ => false,
    };
    let follows_its_thread = comment && before.is_some_and(same_thread);
    if before.is_none_or(|before| before.day != post.day && !follows_its_thread) {
        let words = format!("── day {} · week {} ", post.day, post.week());
        let line = "─".repeat(width.saturating_sub(words.width()));
        rows.push(FeedRow { text: words + &line, role: Role::Header, post_index: None });
    }
    let (indent, mark) = if comment { ("    ", "  ↳ ") } else { ("  ", "") };
    let role = match post.kind {
        PostKind::Own => Role::Strong,
        PostKind::Press => Role::Title,
        PostKind::Customers | PostKind::Public | PostKind::Comments => Role::Dim,
    };
    rows.push(FeedRow { text: format!("{mark}{}", post.heading()), role, post_index: Some(place) });
    let lines = wrap(&post.text, width.saturating_sub(indent.len()));
    let text =
        |line: String| FeedRow { text: format!("{indent}{line}"), role: Role::Text, post_index: Some(place) };
    rows.extend(lines.into_iter().map(text));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    fn post(number: u32) -> Post {
        Post {
            kind: PostKind::Customers,
            number,
            day: number * 7,
            author: "Ann · S1".to_owned(),
            text: "Words that need more than one line of this window".to_owned(),
            answered_post: None,
            views: 0,
            comments: 0,
        }
    }

    #[test]
    fn selected_post_is_always_visible() {
        let posts: Vec<Post> = (1..40).map(post).collect();
        let posts: Vec<&Post> = posts.iter().collect();
        for selected in [0, 1, 20, 37, 38, 99] {
            for height in [2, 5, 9, 30] {
                let rows = rows_around_selection(&posts, selected, 24, height);
                assert!(rows.iter().any(|row| row.post_index == Some(selected.min(38))), "{selected} in {height}");
                assert!(rows.len() <= height);
            }
        }
        assert_eq!(rows_around_selection(&posts, 38, 24, 30).len(), 30 / 5 * 5, "the end fills the window");
        assert!(rows_around_selection(&[], 3, 24, 9).is_empty());
    }
}
