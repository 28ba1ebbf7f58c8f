//! Reports as terminal text. Wide tables are first narrowed, then wrapped, then split into panels.

use unicode_width::UnicodeWidthStr;

use super::{Column, ColumnKind, LabReport, LabTable};
use novamind_base::formatting::escape_control_characters;

const COLUMN_GAP: usize = 2;
/// Minimum width of a text column.
const MIN_TEXT_WIDTH: usize = 12;
const GRAPH_ROWS: usize = 16;

impl LabReport {
    /// Formats the report as text. Lines have at most `width` columns (at least 40).
    pub fn to_text(&self, width: usize) -> String {
        let width = width.max(40);
        let mut parts = vec![wrap_text(&self.title, width).join("\n")];
        parts.extend(
            self.tables
                .iter()
                .filter(|lab_table| !lab_table.is_machine_readable_only)
                .map(|table| table.to_text(width)),
        );
        parts.extend(self.graphs.iter().map(|graph| graph.to_text(width, GRAPH_ROWS)));
        let apart = self.tables.iter().filter(|table| table.is_machine_readable_only);
        let how = |table: &LabTable| format!("{}: --csv --table {}", table.caption, table.name);
        parts.extend(apart.flat_map(|table| wrap_text(&how(table), width)));
        let notes: Vec<String> = self.notes.iter().flat_map(|note| wrap_text(note, width)).collect();
        parts.push(notes.join("\n"));
        let parts: Vec<&str> =
            parts.iter().map(|part| part.trim_end()).filter(|part| !part.is_empty()).collect();
        escape_control_characters(&(parts.join("\n\n") + "\n")).into_owned()
    }
}

impl LabTable {
    /// Formats the table as text. Lines have at most `width` columns.
    fn to_text(&self, width: usize) -> String {
        let full = TextLayout::new(self, false);
        let sheet = if full.fits(width) { full } else { TextLayout::new(self, true).narrow_columns(width) };
        // If the row names do not fit into every panel, numbers identify the rows.
        let is_nameless = sheet.column_panels(width).len() > 1
            && sheet.row_name_columns(width) < sheet.count_identifying_columns();
        let numbers = Column::text("number", "#");
        let columns: Vec<Column> = std::iter::once(numbers).chain(self.columns.iter().cloned()).collect();
        let sheet = if is_nameless { sheet.with_row_numbers(&columns) } else { sheet };
        let mut text = wrap_text(&self.caption, width).join("\n");
        if !text.is_empty() {
            text.push('\n');
        }
        let parts: Vec<String> =
            sheet.column_panels(width).iter().map(|panel| sheet.format_panel(panel)).collect();
        text + &parts.join("\n")
    }
}

/// A table layout: formatted cells and column widths.
struct TextLayout<'a> {
    columns: &'a [Column],
    cells: Vec<Vec<String>>,
    /// Number of rows before the summary rows.
    rows: usize,
    widths: Vec<usize>,
}

impl<'a> TextLayout<'a> {
    fn new(table: &'a LabTable, is_short: bool) -> TextLayout<'a> {
        let write = |row: &Vec<super::CellValue>| {
            let pairs = row.iter().zip(&table.columns);
            pairs.map(|(cell, column)| cell.format(column.measure(), is_short)).collect()
        };
        let cells: Vec<Vec<String>> = table.rows.iter().chain(&table.summary).map(write).collect();
        let width = |(at, column): (usize, &Column)| {
            let number =
                cells.iter().filter_map(|row| row.get(at)).map(|cell| cell.width()).max().unwrap_or(0);
            number.max(longest_word(&column.heading))
        };
        let widths = table.columns.iter().enumerate().map(width).collect();
        TextLayout { columns: &table.columns, cells, rows: table.rows.len(), widths }
    }

    fn total_width(&self) -> usize {
        self.widths.iter().sum::<usize>() + COLUMN_GAP * self.widths.len().saturating_sub(1)
    }

    fn fits(&self, width: usize) -> bool {
        self.total_width() <= width
    }

    /// Narrows the widest text columns until the table fits. If the table cannot fit, narrows only the
    /// columns that name the rows, so that every other column fits next to them.
    fn narrow_columns(mut self, width: usize) -> TextLayout<'a> {
        let min = |at: usize| match self.columns[at].kind {
            ColumnKind::Text => self.widths[at].min(MIN_TEXT_WIDTH),
            ColumnKind::Number(_) | ColumnKind::Interval(_) | ColumnKind::Sparkline => self.widths[at],
        };
        let gaps = COLUMN_GAP * self.widths.len().saturating_sub(1);
        let has_room = (0..self.columns.len()).map(min).sum::<usize>() + gaps <= width;
        let (among, reserved) = match has_room {
            true => (self.columns.len(), 0),
            false => (
                self.count_identifying_columns(),
                self.widest_column_from(self.count_identifying_columns()) + COLUMN_GAP,
            ),
        };
        while self.width_of_first(among) - COLUMN_GAP.min(self.width_of_first(among)) + reserved > width {
            let words = (0..among).filter(|at| self.columns[*at].kind == ColumnKind::Text);
            let Some(widest) =
                words.filter(|at| self.widths[*at] > MIN_TEXT_WIDTH).max_by_key(|at| self.widths[*at])
            else {
                break;
            };
            self.widths[widest] -= 1;
        }
        self.widths.iter_mut().for_each(|number| *number = (*number).min(width));
        self
    }

    fn with_row_numbers<'b>(self, columns: &'b [Column]) -> TextLayout<'b> {
        let rows = self.rows;
        let numbered = |(at, cells): (usize, Vec<String>)| {
            let number = if at < rows { (at + 1).to_string() } else { String::new() };
            std::iter::once(number).chain(cells).collect()
        };
        let cells: Vec<Vec<String>> = self.cells.into_iter().enumerate().map(numbered).collect();
        let width = rows.to_string().len();
        let widths = std::iter::once(width).chain(self.widths).collect();
        TextLayout { columns, cells, rows, widths }
    }

    /// Returns how many leading text columns are needed to identify each row. Returns 1 if not even all of
    /// them together identify each row.
    fn count_identifying_columns(&self) -> usize {
        let is_words =
            |at: &usize| self.columns.get(*at).is_some_and(|column| column.kind == ColumnKind::Text);
        let words = (0..self.columns.len()).take_while(is_words).count();
        let tells_apart = |count: &usize| {
            let mut names: Vec<&[String]> = self.cells.iter().filter_map(|row| row.get(..*count)).collect();
            names.sort_unstable();
            names.windows(2).all(|pair| pair[0] != pair[1])
        };
        (1..=words).find(tells_apart).unwrap_or(1)
    }

    /// Returns the number of leading columns that name a row in each panel. Returns 1 if these columns leave no room
    /// for another column.
    fn row_name_columns(&self, width: usize) -> usize {
        let telling = self.count_identifying_columns();
        if self.width_of_first(telling) + self.widest_column_from(telling) <= width { telling } else { 1 }
    }

    /// Returns the width of the widest column, starting with column `first`.
    fn widest_column_from(&self, first: usize) -> usize {
        self.widths.iter().skip(first).copied().max().unwrap_or(0)
    }

    /// Returns the total width of the first `count` columns, including gaps.
    fn width_of_first(&self, count: usize) -> usize {
        self.widths.iter().take(count).map(|number| number + COLUMN_GAP).sum()
    }

    /// Splits the columns into panels. Each panel repeats the row names.
    fn column_panels(&self, width: usize) -> Vec<Vec<usize>> {
        let mut panels: Vec<Vec<usize>> = vec![Vec::new()];
        let mut taken = 0;
        let names = self.row_name_columns(width);
        for at in 0..self.columns.len() {
            let needed = self.widths[at] + if taken > 0 { COLUMN_GAP } else { 0 };
            let first = self.width_of_first(names);
            let is_full = !panels.last().is_none_or(Vec::is_empty) && taken + needed > width;
            if is_full && at >= names && first + self.widths[at] <= width {
                panels.push((0..names).chain([at]).collect());
                taken = first + self.widths[at];
            } else if is_full {
                panels.push(vec![at]);
                taken = self.widths[at];
            } else {
                panels.last_mut().into_iter().for_each(|panel| panel.push(at));
                taken += needed;
            }
        }
        panels
    }

    fn format_panel(&self, panel: &[usize]) -> String {
        let heads: Vec<Vec<String>> =
            panel.iter().map(|at| wrap_text(&self.columns[*at].heading, self.widths[*at])).collect();
        let height = heads.iter().map(Vec::len).max().unwrap_or(0);
        // Headings are bottom-aligned above the horizontal line.
        let heads: Vec<Vec<String>> = heads
            .into_iter()
            .map(|texts| [vec![String::new(); height - texts.len()], texts].concat())
            .collect();
        let mut text = self.format_rows(panel, &heads);
        let across =
            panel.iter().map(|at| self.widths[*at] + COLUMN_GAP).sum::<usize>().saturating_sub(COLUMN_GAP);
        let rule = "─".repeat(across) + "\n";
        text += &rule;
        for (at, row) in self.cells.iter().enumerate() {
            if at == self.rows {
                text += &rule;
            }
            let cell = |at: &usize| wrap_text(row.get(*at).map_or("", String::as_str), self.widths[*at]);
            text += &self.format_rows(panel, &panel.iter().map(cell).collect::<Vec<_>>());
        }
        text
    }

    /// Formats a row whose cells can have several lines.
    fn format_rows(&self, panel: &[usize], cells: &[Vec<String>]) -> String {
        let mut text = String::new();
        for line in 0..cells.iter().map(Vec::len).max().unwrap_or(0) {
            let mut whole = String::new();
            for (at, cell) in panel.iter().zip(cells) {
                let (cell_text, width) = (cell.get(line).map_or("", String::as_str), self.widths[*at]);
                let blank = " ".repeat(width.saturating_sub(cell_text.width()));
                whole += &match self.columns[*at].kind {
                    ColumnKind::Text | ColumnKind::Sparkline => format!("{cell_text}{blank}"),
                    ColumnKind::Number(_) | ColumnKind::Interval(_) => format!("{blank}{cell_text}"),
                };
                whole += &" ".repeat(COLUMN_GAP);
            }
            text += whole.trim_end();
            text.push('\n');
        }
        text
    }
}

fn longest_word(text: &str) -> usize {
    text.split(' ').map(UnicodeWidthStr::width).max().unwrap_or(0)
}

/// Wraps a text at spaces. A word that is too long is broken after a punctuation character, or anywhere if it
/// contains no punctuation. Returns no lines for an empty text.
pub(super) fn wrap_text(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut().filter(|line| line.width() + 1 + word.width() <= width) {
            Some(line) => *line += &format!(" {word}"),
            None => lines.extend(split_word(word, width)),
        }
    }
    lines
}

fn split_word(word: &str, width: usize) -> Vec<String> {
    let mut pieces = vec![String::new()];
    for part in word.split_inclusive(['_', '.', '/', '-', ',']) {
        let has_room = |piece: &String| piece.width() + part.width() <= width;
        match pieces.last_mut().filter(|piece| has_room(piece)) {
            Some(piece) => *piece += part,
            None if part.width() <= width => pieces.push(part.to_owned()),
            None => push_chars(part, width, &mut pieces),
        }
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces
}

/// Appends characters to the last piece. Starts a new piece when the last piece is full.
fn push_chars(part: &str, width: usize, pieces: &mut Vec<String>) {
    for letter in part.chars() {
        let mut bytes = [0; 4];
        let letter: &str = letter.encode_utf8(&mut bytes);
        match pieces.last_mut().filter(|piece| piece.width() + letter.width() <= width || piece.is_empty()) {
            Some(piece) => *piece += letter,
            None => pieces.push(letter.to_owned()),
        }
    }
}
