//! Draws the values of a form: now → new, one line per value or row of a matrix, with sums.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::form::Form;
use super::outcome::Leads;
use super::sheet::{Block, CellPlace, Slot};
use novamind_tui::canvas::{Align, Canvas, Click, rows_of};
use novamind_tui::text::number;
use novamind_tui::theme::Role;
use novamind_tui::widgets::table::first_row;

const NAME: u16 = 19;

/// Width of the column with the results of a channel.
const SIDE: u16 = 20;

/// Returns the width of a cell; blocks with many columns have narrower cells.
fn cell_width(block: &Block) -> u16 {
    if block.columns.len() > 1 { 9 } else { 12 }
}

pub(super) enum FormLine {
    /// Name of an argument with its column headings.
    Head(usize),
    Row(usize, usize),
    /// Input to add a customer.
    Add(usize),
    /// Sums of a block.
    Total(usize),
    /// Current sums, below those of a changed matrix.
    Was(usize),
}

pub(super) fn form_lines(form: &Form) -> Vec<FormLine> {
    let mut lines = Vec::new();
    for (at, block) in form.sheet.blocks.iter().enumerate() {
        let first = at == 0 || !form.sheet.blocks[at - 1].is_scalar();
        if !block.is_scalar() || first {
            lines.push(FormLine::Head(at));
        }
        lines.extend((0..block.rows.len()).map(|row| FormLine::Row(at, row)));
        if block.is_open() {
            lines.push(FormLine::Add(at));
        }
        if !block.is_scalar() && block.rows.len() > 1 {
            lines.push(FormLine::Total(at));
            if block.columns.len() > 1 && block.is_changed() {
                lines.push(FormLine::Was(at));
            }
        }
    }
    lines
}

/// Draws the lines that fit, including the focused one.
pub(super) fn draw_sheet(
    form: &Form,
    leads: &Leads,
    lines: &[FormLine],
    canvas: &mut Canvas<'_>,
    area: Rect,
    focused: bool,
) {
    let side = side_of(form, leads, area);
    let area = if side.width > 0 { Rect { width: side.x - area.x, ..area } } else { area };
    let is_here = |line: &FormLine| match line {
        FormLine::Row(block, row) => (*block, *row) == (form.at.block, form.at.row),
        FormLine::Add(block) => form.at_adding_row() == Some(*block),
        FormLine::Head(_) | FormLine::Total(_) | FormLine::Was(_) => false,
    };
    let here = lines.iter().position(is_here).unwrap_or(0);
    let from = first_row(here, area.height as usize, lines.len());
    for (row, line) in rows_of(area).zip(lines.iter().skip(from)) {
        match line {
            FormLine::Head(at) => draw_head(form, *at, canvas, row),
            FormLine::Row(at, index) => draw_row(form, *at, *index, canvas, row, focused),
            FormLine::Add(at) => draw_add(form, *at, canvas, row, focused),
            FormLine::Total(at) => draw_total(form, *at, canvas, row),
            FormLine::Was(at) => draw_was(form, *at, canvas, row),
        }
        if side.width > 0 {
            draw_side(form, leads, line, canvas, Rect { y: row.y, height: 1, ..side });
        }
    }
}

/// Returns the area for the results of each channel: next to a complete matrix, or in wide windows.
fn side_of(form: &Form, leads: &Leads, area: Rect) -> Rect {
    let none = Rect { width: 0, ..area };
    let Some(block) = form.sheet.blocks.iter().find(|block| leads.is_of(block)) else { return none };
    let matrix = NAME + (block.columns.len() as u16 + 1) * cell_width(block);
    if area.width < (matrix + SIDE).min(130) {
        return none;
    }
    Rect { x: area.x + matrix.min(area.width - SIDE), width: SIDE, ..area }
}

fn draw_side(form: &Form, leads: &Leads, line: &FormLine, canvas: &mut Canvas<'_>, row: Rect) {
    match line {
        FormLine::Head(_) => canvas.text(row, " leads/$1k (yours)", Role::Header),
        FormLine::Row(at, index) => {
            let words = leads.best(&form.sheet.blocks[*at].rows[*index]);
            canvas.text(row, &format!(" {}", words.unwrap_or("–".to_owned())), Role::Dim);
        }
        _ => {}
    }
}

/// Returns the columns of a block that fit, including the focused one.
fn columns_shown(form: &Form, at: usize, width: u16) -> std::ops::Range<usize> {
    let block = &form.sheet.blocks[at];
    let cell = cell_width(block);
    let totals = if block.columns.len() > 1 { cell } else { 0 };
    let room = (width.saturating_sub(NAME + totals) / cell).max(1) as usize;
    let focus = if form.at.block == at { form.at.column } else { 0 };
    let from = first_row(focus, room, block.columns.len());
    from..(from + room).min(block.columns.len())
}

fn cell_area(block: &Block, row: Rect, place: usize) -> Rect {
    let cell = cell_width(block);
    Rect { x: row.x + NAME + place as u16 * cell, width: cell - 1, ..row }.intersection(row)
}

fn draw_head(form: &Form, at: usize, canvas: &mut Canvas<'_>, row: Rect) {
    let block = &form.sheet.blocks[at];
    if block.is_scalar() {
        canvas.text(row, &format!("{:<19}{:>11} {:>11}", "", "now", "new"), Role::Header);
        return;
    }
    if block.is_text() {
        let words = format!("{}: {}", block.argument.name, block.argument.kind.words());
        canvas.text(row, &words, Role::Header);
        return;
    }
    let name = format!("{} ({})", block.argument.name, block.argument.unit);
    if block.columns.len() == 1 {
        canvas.text(row, &format!("{name}: {}", block.doc), Role::Header);
        return;
    }
    let shown = columns_shown(form, at, row.width);
    canvas.text(Rect { width: NAME.min(row.width), ..row }, &name, Role::Header);
    for (place, column) in shown.clone().enumerate() {
        canvas.aligned(cell_area(block, row, place), &block.columns[column], Role::Header, Align::Right);
    }
    canvas.aligned(cell_area(block, row, shown.len()), "total", Role::Header, Align::Right);
    // Signs mark columns that do not fit.
    let between =
        |place: usize| Rect { x: row.x + NAME + place as u16 * cell_width(block) - 1, width: 1, ..row };
    if shown.start > 0 {
        canvas.text(between(0).intersection(row), "‹", Role::Key);
    }
    if shown.end < block.columns.len() {
        canvas.text(between(shown.len()).intersection(row), "›", Role::Key);
    }
}

fn draw_row(form: &Form, at: usize, index: usize, canvas: &mut Canvas<'_>, row: Rect, focused: bool) {
    let block = &form.sheet.blocks[at];
    let here = focused && (at, index) == (form.at.block, form.at.row);
    if block.is_text() {
        return draw_text(form, at, canvas, row, here);
    }
    canvas.text(
        Rect { width: NAME.min(row.width), ..row },
        &block.rows[index],
        if here { Role::Strong } else { Role::Text },
    );
    let shown = columns_shown(form, at, row.width);
    let many = block.columns.len() > 1;
    for (place, column) in shown.clone().enumerate() {
        let own = CellPlace { block: at, row: index, column };
        let area = cell_area(block, row, if many { place } else { 1 });
        draw_cell(form, own, canvas, area, here && column == form.at.column);
    }
    if many {
        let after = cell_area(block, row, shown.len());
        let sum: f64 = block.slots[index].iter().filter_map(|slot| slot.value().ok().flatten()).sum();
        canvas.aligned(after, &number(sum), Role::Dim, Align::Right);
        return;
    }
    let slot = &block.slots[index][0];
    let before = cell_area(block, row, 0);
    canvas.aligned(before, &slot.current.map_or("–".to_owned(), number), Role::Dim, Align::Right);
    if slot.is_changed() {
        canvas.text(Rect { x: before.right(), width: 1, ..row }.intersection(row), "→", Role::Changed);
    }
    let x = cell_area(block, row, 1).right() + 2;
    let doc = Rect { x, width: row.right().saturating_sub(x), ..row };
    if block.is_scalar() {
        let short = format!("{}, {}", block.argument.unit, block.range().words());
        let brief = block.doc.split("; ").next().unwrap_or_default();
        // The longest text that fits.
        let words = [format!("{short} · {}", block.doc), format!("{short} · {brief}")];
        let fitting = words.into_iter().find(|words| words.width() <= usize::from(doc.width));
        canvas.text(doc, &fitting.unwrap_or(short), Role::Text);
    }
}

/// Draws a text line, which takes the whole row.
fn draw_text(form: &Form, at: usize, canvas: &mut Canvas<'_>, row: Rect, here: bool) {
    let place = CellPlace { block: at, row: 0, column: 0 };
    let Some(slot) = form.sheet.slot(place) else { return };
    if let Some(count) = form.sheet.places().position(|own| own == place) {
        canvas.click(row, Click::Row(1, count));
    }
    if let Some(field) = slot.draft.as_ref().filter(|_| here && form.typing.is_some()) {
        return field.draw(canvas, row);
    }
    let text = in_a_line(&slot.text());
    let role = match (here, text.is_empty()) {
        (true, _) => Role::Selection,
        (false, true) => Role::Dim,
        (false, false) => Role::Changed,
    };
    canvas.clear(row, if here { Role::Selection } else { Role::Text });
    canvas.text(row, if text.is_empty() { "·" } else { &text }, role);
}

/// Returns a text in one line: its first line, and the number of lines.
fn in_a_line(text: &str) -> String {
    match text.split_once('\n') {
        None => text.to_owned(),
        Some((first, _)) => format!("{first} … {} lines", text.lines().count()),
    }
}

fn draw_cell(form: &Form, place: CellPlace, canvas: &mut Canvas<'_>, area: Rect, here: bool) {
    let Some(slot) = form.sheet.slot(place) else { return };
    let block = &form.sheet.blocks[place.block];
    if let Some(count) = form.sheet.places().position(|own| own == place) {
        canvas.click(area, Click::Row(1, count));
    }
    if here
        && form.typing.is_some()
        && let Some(field) = &slot.draft
    {
        field.draw(canvas, area);
        return;
    }
    let wrong = is_wrong(form, block, slot, place);
    let role = match (here, wrong, slot.is_changed()) {
        (true, ..) => Role::Selection,
        (false, true, _) => Role::Bad,
        (false, false, true) => Role::Changed,
        (false, false, false) => Role::Text,
    };
    canvas.clear(area, if here { Role::Selection } else { Role::Text });
    let shown = match slot.value() {
        Ok(Some(value)) => number(value),
        Ok(None) => "·".to_owned(),
        Err(()) => slot.text(),
    };
    let mark = if wrong {
        "!"
    } else if slot.is_changed() {
        "*"
    } else {
        ""
    };
    canvas.aligned(area, &format!("{shown}{mark}"), role, Align::Right);
}

fn is_wrong(form: &Form, block: &Block, slot: &Slot, place: CellPlace) -> bool {
    let outside = match slot.value() {
        Err(()) => true,
        Ok(Some(value)) if slot.is_changed() => {
            let range = block.range();
            !(range.holds(value) && range.fits(value))
        }
        Ok(_) => false,
    };
    let blamed = match &form.preview {
        Some(Err(refusal)) => refusal.field.as_deref() == Some(&block.path(place.row, place.column)),
        _ => false,
    };
    outside || blamed
}

fn draw_add(form: &Form, at: usize, canvas: &mut Canvas<'_>, row: Rect, focused: bool) {
    let here = focused && form.at_adding_row() == Some(at);
    let block = &form.sheet.blocks[at];
    if let Some((adding, field)) = &form.adding
        && *adding == at
    {
        canvas.text(row, "customer number", Role::Text);
        return field.draw(canvas, cell_area(block, row, 1));
    }
    let role = if here { Role::Selection } else { Role::Dim };
    canvas.text(Rect { width: NAME.min(row.width), ..row }, "+ a customer", role);
}

fn draw_total(form: &Form, at: usize, canvas: &mut Canvas<'_>, row: Rect) {
    let block = &form.sheet.blocks[at];
    canvas.text(Rect { width: NAME.min(row.width), ..row }, "total", Role::Dim);
    let shown = columns_shown(form, at, row.width);
    let many = block.columns.len() > 1;
    if many {
        for (place, column) in shown.clone().enumerate() {
            let sum: f64 = block.slots.iter().filter_map(|line| line[column].value().ok().flatten()).sum();
            canvas.aligned(cell_area(block, row, place), &number(sum), Role::Dim, Align::Right);
        }
    }
    let place = if many { shown.len() } else { 1 };
    canvas.aligned(cell_area(block, row, place), &number(block.total()), Role::Strong, Align::Right);
    if !many {
        canvas.aligned(cell_area(block, row, 0), &number(block.total_now()), Role::Dim, Align::Right);
    }
}

/// Draws the current sums of a matrix and their change.
fn draw_was(form: &Form, at: usize, canvas: &mut Canvas<'_>, row: Rect) {
    let block = &form.sheet.blocks[at];
    let change = block.total() - block.total_now();
    let sign = if change < 0.0 { '-' } else { '+' };
    canvas.text(
        Rect { width: NAME.min(row.width), ..row },
        &format!("was ({sign}{})", number(change.abs())),
        Role::Dim,
    );
    let shown = columns_shown(form, at, row.width);
    for (place, column) in shown.clone().enumerate() {
        let sum: f64 = block.slots.iter().filter_map(|line| line[column].current).sum();
        canvas.aligned(cell_area(block, row, place), &number(sum), Role::Dim, Align::Right);
    }
    canvas.aligned(cell_area(block, row, shown.len()), &number(block.total_now()), Role::Dim, Align::Right);
}
