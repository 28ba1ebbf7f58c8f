//! Draws the current and new values of a form, with one line per value or matrix row, and sums.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::form::ToolForm;
use super::outcome::ChannelLeads;
use super::sheet::{ArgumentBlock, CellPosition, EditableCell};
use novamind_tui::canvas::{Align, Canvas, Click, first_visible_row, row_rects};
use novamind_tui::text::{first_fitting, format_number};
use novamind_tui::theme::Role;

const NAME_WIDTH: u16 = 19;

/// Width of the additional column with the leads of each channel.
const CHANNEL_LEADS_WIDTH: u16 = 20;

/// Returns the width of a cell. Blocks with several columns have narrower cells.
fn cell_width(block: &ArgumentBlock) -> u16 {
    if block.columns.len() > 1 { 9 } else { 12 }
}

pub(super) enum FormLine {
    /// Line with the name of an argument and its column headings.
    Head(usize),
    Row(usize, usize),
    /// Line in which the user adds a customer.
    Add(usize),
    /// Line with the sums of a block.
    Total(usize),
    /// Line with the current sums of a changed matrix, below its new sums.
    CurrentTotal(usize),
}

pub(super) fn form_lines(form: &ToolForm) -> Vec<FormLine> {
    let mut lines = Vec::new();
    for (at, block) in form.sheet.blocks.iter().enumerate() {
        let first = at == 0 || !form.sheet.blocks[at - 1].is_scalar();
        if !block.is_scalar() || first {
            lines.push(FormLine::Head(at));
        }
        lines.extend((0..block.rows.len()).map(|row| FormLine::Row(at, row)));
        if block.accepts_new_rows() {
            lines.push(FormLine::Add(at));
        }
        if !block.is_scalar() && !block.shows_deal_prices() && block.rows.len() > 1 {
            lines.push(FormLine::Total(at));
            if block.columns.len() > 1 && block.is_changed() {
                lines.push(FormLine::CurrentTotal(at));
            }
        }
    }
    lines
}

/// Draws as many lines as fit, including the focused line.
pub(super) fn draw_sheet(
    form: &ToolForm,
    leads: Option<&ChannelLeads>,
    lines: &[FormLine],
    canvas: &mut Canvas<'_>,
    area: Rect,
    focused: bool,
) {
    let side = leads.map_or(Rect { width: 0, ..area }, |leads| side_area(form, leads, area));
    let area = if side.width > 0 { Rect { width: side.x - area.x, ..area } } else { area };
    let is_here = |line: &FormLine| match line {
        FormLine::Row(block, row) => (*block, *row) == (form.focus.block, form.focus.row),
        FormLine::Add(block) => form.add_row_block() == Some(*block),
        FormLine::Head(_) | FormLine::Total(_) | FormLine::CurrentTotal(_) => false,
    };
    let here = lines.iter().position(is_here).unwrap_or(0);
    let from = canvas.scroll_to_row(area, here, lines.len());
    for (row, line) in row_rects(area).zip(lines.iter().skip(from)) {
        match line {
            FormLine::Head(at) => draw_head(form, *at, canvas, row),
            FormLine::Row(at, index) => draw_row(form, *at, *index, canvas, row, focused),
            FormLine::Add(at) => draw_add(form, *at, canvas, row, focused),
            FormLine::Total(at) => draw_total(form, *at, canvas, row),
            FormLine::CurrentTotal(at) => draw_current_total(form, *at, canvas, row),
        }
        if let Some(leads) = leads.filter(|_| side.width > 0) {
            draw_side(form, leads, line, canvas, Rect { y: row.y, height: 1, ..side });
        }
    }
}

/// Returns the area for the leads of each channel, next to the matrix.
fn side_area(form: &ToolForm, leads: &ChannelLeads, area: Rect) -> Rect {
    let none = Rect { width: 0, ..area };
    let Some(block) = form.sheet.blocks.iter().find(|block| leads.applies_to(block)) else { return none };
    let matrix = NAME_WIDTH + (block.columns.len() as u16 + 1) * cell_width(block);
    if area.width < (matrix + CHANNEL_LEADS_WIDTH).min(130) {
        return none;
    }
    Rect { x: area.x + matrix.min(area.width - CHANNEL_LEADS_WIDTH), width: CHANNEL_LEADS_WIDTH, ..area }
}

fn draw_side(form: &ToolForm, leads: &ChannelLeads, line: &FormLine, canvas: &mut Canvas<'_>, row: Rect) {
    match line {
        FormLine::Head(_) => canvas.draw_text(row, " leads/$1k (yours)", Role::Header),
        FormLine::Row(at, index) => {
            let words = leads.best_groups(&form.sheet.blocks[*at].rows[*index]);
            canvas.draw_text(row, &format!(" {}", words.unwrap_or("–".to_owned())), Role::Dim);
        }
        _ => {}
    }
}

/// Returns the columns of a block that fit, including the focused column.
fn visible_columns(form: &ToolForm, at: usize, width: u16) -> std::ops::Range<usize> {
    let block = &form.sheet.blocks[at];
    let cell = cell_width(block);
    let totals = if block.columns.len() > 1 { cell } else { 0 };
    let room = (width.saturating_sub(NAME_WIDTH + totals) / cell).max(1) as usize;
    let focus = if form.focus.block == at { form.focus.column } else { 0 };
    let from = first_visible_row(focus, room, block.columns.len());
    from..(from + room).min(block.columns.len())
}

fn cell_area(block: &ArgumentBlock, row: Rect, place: usize) -> Rect {
    let cell = cell_width(block);
    Rect { x: row.x + NAME_WIDTH + place as u16 * cell, width: cell - 1, ..row }.intersection(row)
}

fn draw_head(form: &ToolForm, at: usize, canvas: &mut Canvas<'_>, row: Rect) {
    let block = &form.sheet.blocks[at];
    if block.is_scalar() {
        for (place, heading) in ["now", "new"].into_iter().enumerate() {
            canvas.draw_aligned(cell_area(block, row, place), heading, Role::Header, Align::Right);
        }
        return;
    }
    if block.is_text() {
        let words = format!("{}: {}", block.argument.name, block.argument.kind.describe());
        canvas.draw_text(row, &words, Role::Header);
        return;
    }
    let name = format!("{} ({})", block.argument.name, block.argument.unit);
    if block.columns.len() == 1 {
        canvas.draw_text(row, &format!("{name}: {}", block.doc), Role::Header);
        return;
    }
    let shown = visible_columns(form, at, row.width);
    // The title of the form names the argument, so a narrow column shows only its unit.
    let name = first_fitting([name, block.argument.unit.to_owned()], NAME_WIDTH.into());
    canvas.draw_text(Rect { width: NAME_WIDTH.min(row.width), ..row }, &name, Role::Header);
    for (place, column) in shown.clone().enumerate() {
        canvas.draw_aligned(cell_area(block, row, place), &block.columns[column], Role::Header, Align::Right);
    }
    canvas.draw_aligned(cell_area(block, row, shown.len()), "total", Role::Header, Align::Right);
    // Signs indicate that further columns do not fit.
    let between =
        |place: usize| Rect { x: row.x + NAME_WIDTH + place as u16 * cell_width(block) - 1, width: 1, ..row };
    if shown.start > 0 {
        canvas.draw_text(between(0).intersection(row), "‹", Role::Key);
    }
    if shown.end < block.columns.len() {
        canvas.draw_text(between(shown.len()).intersection(row), "›", Role::Key);
    }
}

fn draw_row(form: &ToolForm, at: usize, index: usize, canvas: &mut Canvas<'_>, row: Rect, focused: bool) {
    let block = &form.sheet.blocks[at];
    let here = focused && (at, index) == (form.focus.block, form.focus.row);
    if block.is_text() {
        return draw_text(form, at, canvas, row, here);
    }
    canvas.draw_text(
        Rect { width: NAME_WIDTH.min(row.width), ..row },
        &block.rows[index],
        if here { Role::Strong } else { Role::Text },
    );
    let shown = visible_columns(form, at, row.width);
    let many = block.columns.len() > 1;
    for (place, column) in shown.clone().enumerate() {
        let cell_position = CellPosition { block: at, row: index, column };
        let area = cell_area(block, row, if many { place } else { 1 });
        draw_cell(form, cell_position, canvas, area, here && column == form.focus.column);
    }
    if many {
        let after = cell_area(block, row, shown.len());
        let sum: f64 = block.cells[index].iter().filter_map(|slot| slot.value().ok().flatten()).sum();
        canvas.draw_aligned(after, &format_number(sum), Role::Dim, Align::Right);
        return;
    }
    let slot = &block.cells[index][0];
    let before = cell_area(block, row, 0);
    canvas.draw_aligned(before, &slot.current.map_or("–".to_owned(), format_number), Role::Dim, Align::Right);
    if slot.is_changed() {
        canvas.draw_text(Rect { x: before.right(), width: 1, ..row }.intersection(row), "→", Role::Changed);
    }
    let x = cell_area(block, row, 1).right() + 2;
    let doc = Rect { x, width: row.right().saturating_sub(x), ..row };
    if block.is_scalar() {
        let short = format!("{}, {}", block.argument.unit, block.range().describe());
        let brief = block.doc.split("; ").next().unwrap_or_default();
        // The longest wording that fits is used.
        let words = [format!("{short} · {}", block.doc), format!("{short} · {brief}")];
        let fitting = words.into_iter().find(|words| words.width() <= usize::from(doc.width));
        canvas.draw_text(doc, &fitting.unwrap_or(short), Role::Text);
    }
}

/// Draws a text argument, which uses the complete row.
fn draw_text(form: &ToolForm, at: usize, canvas: &mut Canvas<'_>, row: Rect, here: bool) {
    let place = CellPosition { block: at, row: 0, column: 0 };
    let Some(slot) = form.sheet.cell(place) else { return };
    if let Some(count) = form.sheet.positions().position(|cell_position| cell_position == place) {
        canvas.register_click(row, Click::Row(1, count));
    }
    if let Some(field) = slot.draft.as_ref().filter(|_| here && form.draft_before_edit.is_some()) {
        return field.draw(canvas, row);
    }
    let text = first_line_label(&slot.text());
    let role = match (here, text.is_empty()) {
        (true, _) => Role::Selection,
        (false, true) => Role::Dim,
        (false, false) => Role::Changed,
    };
    canvas.clear(row, if here { Role::Selection } else { Role::Text });
    canvas.draw_text(row, if text.is_empty() { "·" } else { &text }, role);
}

/// Formats a text in one line: its first line, and the number of lines if there are several.
fn first_line_label(text: &str) -> String {
    match text.split_once('\n') {
        None => text.to_owned(),
        Some((first, _)) => format!("{first} … {} lines", text.lines().count()),
    }
}

fn draw_cell(form: &ToolForm, place: CellPosition, canvas: &mut Canvas<'_>, area: Rect, here: bool) {
    let Some(slot) = form.sheet.cell(place) else { return };
    let block = &form.sheet.blocks[place.block];
    if let Some(count) = form.sheet.positions().position(|cell_position| cell_position == place) {
        canvas.register_click(area, Click::Row(1, count));
    }
    if here
        && form.draft_before_edit.is_some()
        && let Some(field) = &slot.draft
    {
        field.draw(canvas, area);
        return;
    }
    let wrong = is_invalid(form, block, slot, place);
    let role = match (here, wrong, slot.is_changed()) {
        (true, ..) => Role::Selection,
        (false, true, _) => Role::Bad,
        (false, false, true) => Role::Changed,
        (false, false, false) => Role::Text,
    };
    canvas.clear(area, if here { Role::Selection } else { Role::Text });
    let shown = match slot.value() {
        Ok(Some(value)) => format_number(value),
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
    canvas.draw_aligned(area, &format!("{shown}{mark}"), role, Align::Right);
}

fn is_invalid(form: &ToolForm, block: &ArgumentBlock, slot: &EditableCell, place: CellPosition) -> bool {
    let outside = match slot.value() {
        Err(()) => true,
        Ok(Some(value)) if slot.is_changed() => {
            let range = block.range();
            !(range.contains(value) && range.is_within_limit(value))
        }
        Ok(_) => false,
    };
    let blamed = match &form.preview {
        Some(Err(refusal)) => refusal.field.as_deref() == Some(&block.path(place.row, place.column)),
        _ => false,
    };
    outside || blamed
}

fn draw_add(form: &ToolForm, at: usize, canvas: &mut Canvas<'_>, row: Rect, focused: bool) {
    let here = focused && form.add_row_block() == Some(at);
    let block = &form.sheet.blocks[at];
    if let Some((adding, field)) = &form.new_customer
        && *adding == at
    {
        canvas.draw_text(row, "customer number", Role::Text);
        return field.draw(canvas, cell_area(block, row, 1));
    }
    let role = if here { Role::Selection } else { Role::Dim };
    canvas.draw_text(Rect { width: NAME_WIDTH.min(row.width), ..row }, "+ a customer", role);
}

fn draw_total(form: &ToolForm, at: usize, canvas: &mut Canvas<'_>, row: Rect) {
    let block = &form.sheet.blocks[at];
    canvas.draw_text(Rect { width: NAME_WIDTH.min(row.width), ..row }, "total", Role::Dim);
    let shown = visible_columns(form, at, row.width);
    let many = block.columns.len() > 1;
    if many {
        for (place, column) in shown.clone().enumerate() {
            let sum: f64 = block.cells.iter().filter_map(|line| line[column].value().ok().flatten()).sum();
            canvas.draw_aligned(cell_area(block, row, place), &format_number(sum), Role::Dim, Align::Right);
        }
    }
    let place = if many { shown.len() } else { 1 };
    canvas.draw_aligned(cell_area(block, row, place), &format_number(block.total()), Role::Strong, Align::Right);
    if !many {
        canvas.draw_aligned(cell_area(block, row, 0), &format_number(block.current_total()), Role::Dim, Align::Right);
    }
}

/// Draws the current sums of a matrix and the changes of the sums.
fn draw_current_total(form: &ToolForm, at: usize, canvas: &mut Canvas<'_>, row: Rect) {
    let block = &form.sheet.blocks[at];
    let change = block.total() - block.current_total();
    let sign = if change < 0.0 { '-' } else { '+' };
    canvas.draw_text(
        Rect { width: NAME_WIDTH.min(row.width), ..row },
        &format!("was ({sign}{})", format_number(change.abs())),
        Role::Dim,
    );
    let shown = visible_columns(form, at, row.width);
    for (place, column) in shown.clone().enumerate() {
        let sum: f64 = block.cells.iter().filter_map(|line| line[column].current).sum();
        canvas.draw_aligned(cell_area(block, row, place), &format_number(sum), Role::Dim, Align::Right);
    }
    canvas.draw_aligned(cell_area(block, row, shown.len()), &format_number(block.current_total()), Role::Dim, Align::Right);
}
