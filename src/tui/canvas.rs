//! The drawing surface: the cells of a frame, clickable areas, and the cursor.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::Style;
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, BorderType, Widget};
use unicode_segmentation::UnicodeSegmentation;
use unicode_width::UnicodeWidthStr;

use super::theme::{Role, Theme};

/// A command number. The application defines which command it stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CommandId(pub u16);

/// What a click on an area does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Click {
    /// Executes a command.
    Command(CommandId),
    /// Focuses a pane, given by its number on the screen.
    Pane(usize),
    /// Selects a row of a pane, given by the numbers of the pane and the row.
    Row(usize, usize),
}

/// A frame that is being drawn.
pub struct Canvas<'a> {
    /// Cells into which the frame is drawn.
    pub buffer: &'a mut Buffer,
    /// Theme that defines the style of each role.
    pub theme: &'a Theme,
    /// Clickable areas of the frame. Later areas cover earlier areas.
    pub clicks: Vec<(Rect, Click)>,
    /// Position of the cursor, if the cursor is visible.
    pub cursor: Option<Position>,
    /// Number of rows that the focused list shows, for paging.
    pub page_rows: u16,
    /// Whether the focused pane fills the screen, so that other panes are not drawn.
    pub zoomed: bool,
    /// Whether the data is outdated. The border of every pane indicates this.
    pub stale: bool,
    /// Text that is shown instead of a chart if there is no data.
    pub empty_chart_text: &'static str,
    /// Characters for drawing curves.
    pub marker: Marker,
    /// Breadcrumbs, which are shown before the title of the focused pane.
    pub breadcrumbs: Vec<String>,
}

/// Horizontal alignment of text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Left-aligned text.
    Left,
    /// Right-aligned text.
    Right,
}

impl<'a> Canvas<'a> {
    /// Returns a canvas that draws into a buffer.
    pub fn new(buffer: &'a mut Buffer, theme: &'a Theme) -> Canvas<'a> {
        Canvas {
            buffer,
            theme,
            clicks: Vec::new(),
            cursor: None,
            page_rows: 10,
            zoomed: false,
            stale: false,
            empty_chart_text: "no data",
            marker: Marker::Braille,
            breadcrumbs: Vec::new(),
        }
    }

    /// Returns the area of the complete canvas.
    pub fn area(&self) -> Rect {
        self.buffer.area
    }

    /// Returns the style of a role.
    pub fn style(&self, role: Role) -> Style {
        self.theme.style(role)
    }

    /// Returns a span of text with the style of a role.
    pub fn span<'t>(&self, text: impl Into<std::borrow::Cow<'t, str>>, role: Role) -> Span<'t> {
        Span::styled(text, self.style(role))
    }

    /// Fills an area with spaces in the style of a role.
    pub fn clear(&mut self, area: Rect, role: Role) {
        let area = area.intersection(self.buffer.area);
        ratatui::widgets::Clear.render(area, self.buffer);
        self.buffer.set_style(area, self.style(role));
    }

    /// Draws text in one row. Text that does not fit ends with an ellipsis.
    pub fn draw_text(&mut self, area: Rect, text: &str, role: Role) {
        self.draw_aligned(area, text, role, Align::Left);
    }

    /// Draws aligned text in one row. Text that does not fit ends with an ellipsis.
    pub fn draw_aligned(&mut self, area: Rect, text: &str, role: Role, align: Align) {
        if area.is_empty() {
            return;
        }
        let shown = truncate_to_width(text, area.width as usize);
        let room = area.width as usize - shown.width();
        let x = area.x + if align == Align::Right { room as u16 } else { 0 };
        let style = self.style(role);
        if self.buffer.area.contains(Position::new(x, area.y)) {
            self.buffer.set_stringn(x, area.y, shown, area.width as usize, style);
        }
    }

    /// Draws spans in one row. Text that does not fit ends with an ellipsis.
    pub fn draw_line(&mut self, area: Rect, line: &Line<'_>) {
        let area = Rect { height: area.height.min(1), ..area }.intersection(self.buffer.area);
        if area.is_empty() {
            return;
        }
        self.buffer.set_line(area.x, area.y, line, area.width);
        // Trailing spaces only align columns, so they may be cut without an ellipsis.
        let text: String = line.spans.iter().map(|span| span.content.as_ref()).collect();
        if text.trim_end().width() > area.width as usize {
            let kept = truncate_to_width(&text, area.width as usize).width().max(1) as u16;
            self.buffer[(area.x + kept - 1, area.y)].set_symbol("…");
            for x in area.x + kept..area.right() {
                self.buffer[(x, area.y)].set_symbol(" ");
            }
        }
    }

    /// Draws lines below each other. Lines that are too wide end with an ellipsis, and lines below the area are
    /// omitted.
    pub fn draw_lines(&mut self, area: Rect, lines: &[Line<'_>]) {
        for (row, line) in row_rects(area).zip(lines) {
            self.draw_line(row, line);
        }
    }

    /// Draws the border of a pane and returns the area inside. The upper border has the title at its left end and the
    /// note at its right end.
    pub fn draw_pane_frame(&mut self, area: Rect, title: &str, note: &str, focused: bool) -> Rect {
        // The line style shows the focus even without color.
        let (kind, role) =
            if focused { (BorderType::Thick, Role::Focus) } else { (BorderType::Plain, Role::Border) };
        let mut block = Block::bordered().border_type(kind).border_style(self.style(role));
        let room = (area.width as usize).saturating_sub(4);
        let note = match (self.stale, note) {
            (false, note) => note.to_owned(),
            (true, "") => "stale".to_owned(),
            (true, note) => format!("stale · {note}"),
        };
        let way = if focused && !title.is_empty() { self.breadcrumbs.as_slice() } else { &[] };
        let in_room = |room: usize| breadcrumb_prefix(way, title, room);
        // The last breadcrumb has priority over the note.
        let path = Some(in_room(room.saturating_sub(note.width() + 6)))
            .filter(|path| !path.is_empty())
            .unwrap_or_else(|| in_room(room.saturating_sub(2)));
        let title = fitting_title(title, room.saturating_sub(path.width() + 2));
        if !title.is_empty() && room > 0 {
            let before =
                self.span(if path.is_empty() { " ".to_owned() } else { format!(" {path}") }, Role::Dim);
            block = block.title(Line::from(vec![before, self.span(format!("{title} "), Role::Title)]));
        }
        let left = path.width() + title.width() + 3;
        let note = fitting_items(&note, room.saturating_sub(left + 2));
        if !note.is_empty() {
            block = block.title(Line::from(self.span(format!(" {note} "), Role::Dim)).right_aligned());
        }
        let inside = block.inner(area);
        block.render(area.intersection(self.buffer.area), self.buffer);
        inside
    }

    /// Draws key labels into the lower border of a pane.
    pub fn draw_pane_keys(&mut self, area: Rect, text: &str) {
        if area.height < 2 || area.width < 6 {
            return;
        }
        let row = Rect { x: area.x + 2, y: area.bottom() - 1, width: area.width - 4, height: 1 };
        let shown = fitting_items(text, row.width.saturating_sub(2) as usize);
        if shown.is_empty() {
            return;
        }
        let shown = format!(" {shown} ");
        let width = shown.width() as u16;
        self.draw_text(Rect { width: width.min(row.width), ..row }, &shown, Role::Text);
    }

    /// Returns the first visible row of a list, chosen so that the selected row is near the middle. Also draws the
    /// marks of [`Canvas::draw_scroll_marks`].
    pub fn scroll_to_row(&mut self, list: Rect, selected: usize, rows: usize) -> usize {
        let from = first_visible_row(selected, list.height as usize, rows);
        self.draw_scroll_marks(list, from, rows);
        from
    }

    /// Draws an arrow at the right border of a list for rows that are not visible above, and another for those below.
    pub fn draw_scroll_marks(&mut self, list: Rect, first: usize, rows: usize) {
        if list.is_empty() {
            return;
        }
        let marks = [(first > 0, list.y, "↑"), (rows > first + list.height as usize, list.bottom() - 1, "↓")];
        for (_, y, mark) in marks.into_iter().filter(|(is_cut, ..)| *is_cut) {
            self.draw_mark_beside(Rect { y, height: 1, ..list }, mark);
        }
    }

    /// Draws arrows in the headings of a matrix if columns to the left or to the right are not visible. `names` is the
    /// width of the first column, which is always visible.
    pub fn draw_column_marks(&mut self, head: Rect, names: u16, before: bool, after: bool) {
        if before && names < head.width {
            self.draw_text(Rect { x: head.x + names, width: 1, ..head }, "←", Role::Key);
        }
        if after && !head.is_empty() {
            self.draw_mark_beside(head, "→");
        }
    }

    /// Draws a mark to the right of a row, on the border or in a gap. If the row has neither, the mark covers its last
    /// cell.
    fn draw_mark_beside(&mut self, row: Rect, mark: &str) {
        let style = self.style(Role::Key);
        let right_of_row = Position::new(row.right(), row.y);
        let is_free = self.buffer.cell(right_of_row).is_some_and(|cell| " │┃".contains(cell.symbol()));
        let place = if is_free { right_of_row } else { Position::new(row.right() - 1, row.y) };
        if let Some(cell) = self.buffer.cell_mut(place) {
            cell.set_symbol(mark).set_style(style);
        }
    }

    /// Draws the position of a pane among the panes that share its area (`pane 2 of 3`), if the lower border has space.
    pub fn draw_stack_mark(&mut self, area: Rect, at: usize, panes: usize) {
        let mark = format!(" pane {} of {panes} ", at + 1);
        let width = mark.width() as u16;
        if area.width < width + 4 || area.height < 2 {
            return;
        }
        let place = Rect { x: area.right() - width - 1, y: area.bottom() - 1, width, height: 1 };
        let is_border = |x| self.buffer.cell((x, place.y)).is_some_and(|cell| "─━".contains(cell.symbol()));
        if (place.left()..place.right()).all(is_border) {
            self.draw_text(place, &mark, Role::Dim);
        }
    }

    /// Makes an area clickable.
    pub fn register_click(&mut self, area: Rect, click: Click) {
        self.clicks.push((area, click));
    }
}

/// Formats the breadcrumbs before a title: `Customers › S2 › `. If the width is too small, omits breadcrumbs, starting
/// with the first. Also omits the last breadcrumb if the title contains it.
fn breadcrumb_prefix(path: &[String], title: &str, room: usize) -> String {
    let is_in_title = path.last().is_some_and(|last| title.split(' ').any(|word| word == last));
    let path = &path[..path.len() - usize::from(is_in_title)];
    let words = |from: usize| {
        let cut = if from > 0 { "… › " } else { "" };
        path[from..].iter().fold(cut.to_owned(), |text, place| text + place + " › ")
    };
    let fits = |text: &String| text.width() + title.width() <= room;
    (0..path.len()).map(words).find(fits).unwrap_or_default()
}

/// Returns the first items of a list of keys or notes that fit into a width. No item is cut.
fn fitting_items(text: &str, width: usize) -> String {
    let mut shown = String::new();
    for key in text.split(" · ") {
        let longer = if shown.is_empty() { key.to_owned() } else { format!("{shown} · {key}") };
        if longer.width() > width {
            break;
        }
        shown = longer;
    }
    shown
}

/// Shortens a title to a width by omitting its last items. Only the first item is cut if it does not fit.
fn fitting_title(title: &str, width: usize) -> String {
    match fitting_items(title, width) {
        items if items.is_empty() => truncate_to_width(title, width),
        items => items,
    }
}

/// Returns the rows of an area. Each row is one cell high.
pub fn row_rects(area: Rect) -> impl Iterator<Item = Rect> {
    (area.top()..area.bottom()).map(move |y| Rect { y, height: 1, ..area })
}

/// Returns the first visible row, chosen so that the selected row is near the middle.
pub fn first_visible_row(selected: usize, height: usize, rows: usize) -> usize {
    selected.saturating_sub(height / 2).min(rows.saturating_sub(height))
}

/// Truncates text to a width, between graphemes, and adds an ellipsis. A number is shown completely or not at all, so
/// that its first digits are not mistaken for a smaller number.
pub fn truncate_to_width(text: &str, width: usize) -> String {
    if text.width() <= width && !text.contains(|letter: char| letter.is_control()) {
        return text.to_owned();
    }
    let mut fitted = String::new();
    let mut used = 0;
    let clean =
        |piece: &str| if piece.chars().any(char::is_control) { " ".to_owned() } else { piece.to_owned() };
    let pieces: Vec<String> = text.graphemes(true).map(clean).collect();
    let whole: usize = pieces.iter().map(|piece| piece.width()).sum();
    let room = if whole <= width { width } else { width.saturating_sub(1) };
    for piece in &pieces {
        if used + piece.width() > room {
            break;
        }
        used += piece.width();
        fitted.push_str(piece);
    }
    if whole > width && width > 0 {
        fitted.truncate(without_last_number(&fitted).len());
        fitted.push('…');
    }
    fitted
}

/// Returns the text without the number at its end, because this number may be incomplete.
fn without_last_number(text: &str) -> &str {
    let digits = text.trim_end_matches(['k', 'M', 'B', '%', '.', ',', '$', '+', '-', '±']);
    if !digits.ends_with(|letter: char| letter.is_ascii_digit()) {
        return text.trim_end_matches(['$', '+', '±']);
    }
    digits.trim_end_matches(|letter: char| letter.is_ascii_digit() || ".,$+-±−#".contains(letter))
}

/// Returns a rectangle in the middle of an area, limited to the size of the area.
pub fn centered_rect(area: Rect, width: u16, height: u16) -> Rect {
    let (width, height) = (width.min(area.width), height.min(area.height));
    Rect { x: area.x + (area.width - width) / 2, y: area.y + (area.height - height) / 2, width, height }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn breadcrumbs_drop_distant_places_first() {
        let path = ["Overview", "Customers", "S2"].map(str::to_owned);
        assert_eq!(breadcrumb_prefix(&path, "Go to", 60), "Overview › Customers › S2 › ");
        assert_eq!(breadcrumb_prefix(&path, "Go to", 25), "… › S2 › ");
        assert_eq!(breadcrumb_prefix(&path, "Fit of S2", 60), "Overview › Customers › ");
        assert_eq!(breadcrumb_prefix(&path, "Fit of S2", 12), "");
        assert_eq!(breadcrumb_prefix(&[], "Fit of S2", 60), "");
    }

    #[test]
    fn pane_keys_are_never_truncated() {
        assert_eq!(fitting_items("y yes · esc close · ? help", 17), "y yes · esc close");
        assert_eq!(fitting_items("y yes · esc close · ? help", 16), "y yes");
        assert_eq!(fitting_items("enter begins it", 8), "");
    }

    #[test]
    fn titles_and_notes_omit_items_that_do_not_fit() {
        let theme = Theme::bundled("mono").expect("a theme");
        let border = |title: &str, note: &str, width| {
            let mut buffer = Buffer::empty(Rect::new(0, 0, width, 2));
            let area = buffer.area;
            Canvas::new(&mut buffer, &theme).draw_pane_frame(area, title, note, false);
            (0..width).map(|x| buffer[(x, 0)].symbol()).collect::<String>()
        };
        assert_eq!(border("prices · PRC", "from tomorrow", 34), "┌ prices · PRC ─── from tomorrow ┐");
        assert_eq!(border("prices · PRC", "from tomorrow", 33), "┌ prices · PRC ─────────────────┐");
        assert_eq!(border("prices · PRC", "from tomorrow", 15), "┌ prices ─────┐");
        assert_eq!(border("prices · PRC", "", 10), "┌ pri… ──┐");
    }

    #[test]
    fn text_is_truncated_between_graphemes() {
        assert_eq!(truncate_to_width("abcdef", 6), "abcdef");
        assert_eq!(truncate_to_width("abcdef", 4), "abc…");
        assert_eq!(truncate_to_width("日本語", 4), "日…");
        assert_eq!(truncate_to_width("日本語", 5), "日本…");
        assert_eq!(truncate_to_width("a\nb\tc", 9), "a b c");
        assert_eq!(truncate_to_width("abc", 0), "");
        assert_eq!(truncate_to_width("abc", 1), "…");
    }

    #[test]
    fn numbers_are_complete_or_omitted() {
        assert_eq!(truncate_to_width("cash $1,234,567 now", 12), "cash …");
        assert_eq!(truncate_to_width("12 weeks $1.34M to", 15), "12 weeks …");
        assert_eq!(truncate_to_width("0.3 to 12.5% a day", 13), "0.3 to …");
        assert_eq!(truncate_to_width("weeks 3 and 4", 9), "weeks 3 …");
        assert_eq!(truncate_to_width("123456", 4), "…");
    }

    #[test]
    fn lines_are_truncated_like_text() {
        let theme = Theme::bundled("mono").expect("a theme");
        for (text, shown) in [("cash $1,234,567 now", "cash …      "), ("plain long text", "plain long …")]
        {
            let mut buffer = Buffer::empty(Rect::new(0, 0, 12, 1));
            let area = buffer.area;
            Canvas::new(&mut buffer, &theme).draw_line(area, &Line::from(text));
            assert_eq!((0..12).map(|x| buffer[(x, 0)].symbol()).collect::<String>(), shown);
        }
    }

    #[test]
    fn scroll_marks_show_rows_above_and_below() {
        let theme = Theme::bundled("mono").expect("a theme");
        let marks = |selected, rows, width| {
            let mut buffer = Buffer::empty(Rect::new(0, 0, 5, 4));
            let list = Rect::new(0, 0, width, 4);
            let from = Canvas::new(&mut buffer, &theme).scroll_to_row(list, selected, rows);
            (from, buffer[(4, 0)].symbol().to_owned() + buffer[(4, 3)].symbol())
        };
        assert_eq!(marks(0, 4, 4), (0, "  ".to_owned()));
        assert_eq!(marks(0, 5, 4), (0, " ↓".to_owned()));
        assert_eq!(marks(9, 20, 4), (7, "↑↓".to_owned()));
        assert_eq!(marks(19, 20, 5), (16, "↑ ".to_owned()), "without a border");
    }
}
