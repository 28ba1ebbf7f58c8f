//! How list and form look.

use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::Line as TextLine;
use serde_json::Value;

use super::form::Form;
use super::reference::reference;
use super::sheet::{Block, Place, Slot};
use super::{Look, Tools};
use crate::console::action::Action;
use crate::console::canvas::{Align, Canvas, Click, rows_of};
use crate::console::text::{number, wrapped};
use crate::console::theme::Role;
use crate::console::widgets::table::first_row;
use crate::notation::{dollars, signed_dollars};
use crate::tools::{Module, Spec};

/// Width of the names of rows.
const NAME: u16 = 19;

/// Width of a cell of a block: many columns have to share the window.
fn cell_width(block: &Block) -> u16 {
    if block.columns.len() > 1 { 9 } else { 12 }
}

pub(super) fn draw(tools: &Tools, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    let narrow = area.width < 100;
    let list = if narrow && tools.focus == 1 {
        0
    } else if narrow {
        34
    } else {
        32
    };
    let [left, right] = Layout::horizontal([Constraint::Length(list), Constraint::Min(0)]).areas(area);
    if list > 0 {
        draw_list(tools, canvas, left, look);
    }
    let Some(spec) = tools.here() else {
        canvas.pane(right, "Form", "", tools.focus == 1);
        return;
    };
    match tools.forms.get(spec.name) {
        Some(form) => draw_form(form, canvas, right, look, tools.focus == 1),
        None => {
            canvas.pane(right, spec.name, "", tools.focus == 1);
        }
    }
}

fn draw_list(tools: &Tools, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    let focused = tools.focus == 0;
    canvas.click(area, Click::Pane(0));
    let note =
        if tools.filter.is_empty() { look.hint(Action::Filter) } else { format!("\"{}\"", tools.filter) };
    let inside = canvas.pane(area, "Tools", &note, focused);
    let shown = tools.shown();
    // Lines of the list: heads of modules and tools with their place.
    let mut lines: Vec<(Option<usize>, &str)> = Vec::new();
    for module in Module::ALL {
        let own = shown.iter().enumerate().filter(|(_, spec)| spec.module == module);
        let own: Vec<(Option<usize>, &str)> = own.map(|(at, spec)| (Some(at), spec.name)).collect();
        if !own.is_empty() {
            lines.push((None, module.id()));
            lines.extend(own);
        }
    }
    if lines.is_empty() {
        let text = format!("no tool is called like that: {}", look.hint(Action::Close));
        canvas.text(inside, &text, Role::Dim);
    }
    let field = u16::from(tools.typing.is_some());
    let list = Rect { height: inside.height.saturating_sub(field), ..inside };
    if focused {
        canvas.page = list.height.max(1);
    }
    let selected = lines.iter().position(|line| line.0 == Some(tools.selected)).unwrap_or(0);
    let from = first_row(selected, list.height as usize, lines.len());
    for (row, (place, text)) in rows_of(list).zip(lines.into_iter().skip(from)) {
        let Some(place) = place else {
            canvas.text(row, text, Role::Header);
            continue;
        };
        let here = place == tools.selected;
        let role = match here {
            true if focused => Role::Selection,
            true => Role::SelectionIdle,
            false => Role::Text,
        };
        let draft =
            tools.forms.get(text).is_some_and(|form| form.sheet.is_changed() && form.spec.kind.acts());
        canvas.clear(row, if here { role } else { Role::Text });
        canvas.text(row, &format!("  {text}{}", if draft { " *" } else { "" }), role);
        canvas.click(row, Click::Row(0, place));
    }
    if let Some(field) = &tools.typing {
        let row = Rect { y: inside.bottom().saturating_sub(1), height: 1, ..inside };
        canvas.text(row, "/", Role::Key);
        field.draw(canvas, Rect { x: row.x + 1, width: row.width.saturating_sub(1), ..row });
    }
}

fn draw_form(form: &Form, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>, focused: bool) {
    let spec = form.spec;
    canvas.click(area, Click::Pane(1));
    let title = format!("{} · {}", spec.name, spec.module.id());
    let inside = canvas.pane(area, &title, when(spec), focused);
    let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
    let summary = wrapped(&format!("{}.", spec.summary), inside.width as usize);
    let head: Vec<TextLine<'_>> =
        summary.iter().map(|line| TextLine::from(canvas.span(line.as_str(), Role::Strong))).collect();
    canvas.lines(inside, &head);
    let top = (head.len() as u16 + 1).min(inside.height);
    let below = Rect { y: inside.y + top, height: inside.height - top, ..inside };
    let lines = form_lines(form);
    let wanted = lines.len() as u16;
    let outcome = outcome_lines(form, look, inside.width as usize);
    let room = below.height.saturating_sub(outcome.len().min(below.height as usize / 2) as u16);
    let sheet = Rect { height: wanted.min(room), ..below };
    draw_sheet(form, &lines, canvas, sheet, focused);
    let rest_from = (sheet.height + u16::from(sheet.height > 0)).min(below.height);
    let rest = Rect { y: below.y + rest_from, height: below.height - rest_from, ..below };
    let shown: Vec<TextLine<'_>> =
        outcome.iter().map(|(text, role)| TextLine::from(canvas.span(text.as_str(), *role))).collect();
    canvas.lines(rest, &shown);
    canvas.pane_keys(area, &keys(form, look));
}

fn keys(form: &Form, look: &Look<'_>) -> String {
    match form.spec.name {
        "next_week" => return "n opens the dialog before a week".to_owned(),
        "query" => return "enter opens the SQL screen".to_owned(),
        _ => {}
    }
    match form.sheet.blocks.is_empty() {
        true => "enter asks".to_owned(),
        false => format!(
            "type {} · {} · {} · {}",
            if form.sheet.blocks.iter().all(Block::is_text) { "a list as JSON" } else { "a number" },
            look.hint(Action::Apply),
            look.hint(Action::ResetForm),
            look.hint(Action::CopyCall)
        ),
    }
}

fn when(spec: &Spec) -> &'static str {
    match spec.when {
        crate::tools::When::NextDay => "acts from tomorrow",
        crate::tools::When::NextBilling => "acts on each next bill",
        crate::tools::When::Now => "acts at once",
        crate::tools::When::AtCompletion => "acts when it is done",
        crate::tools::When::CustomerReply => "acts when the customer answers",
        crate::tools::When::Never => "reads",
    }
}

/// A line of the form.
enum FormLine {
    /// Name of an argument with the names of its columns.
    Head(usize),
    /// A row of a block.
    Row(usize, usize),
    /// Where a customer is added.
    Add(usize),
    /// Sums of a block.
    Total(usize),
}

fn form_lines(form: &Form) -> Vec<FormLine> {
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
        }
    }
    lines
}

fn draw_sheet(form: &Form, lines: &[FormLine], canvas: &mut Canvas<'_>, area: Rect, focused: bool) {
    let is_here = |line: &FormLine| match line {
        FormLine::Row(block, row) => (*block, *row) == (form.at.block, form.at.row),
        FormLine::Add(block) => form.at_adding_row() == Some(*block),
        FormLine::Head(_) | FormLine::Total(_) => false,
    };
    let here = lines.iter().position(is_here).unwrap_or(0);
    let from = first_row(here, area.height as usize, lines.len());
    for (row, line) in rows_of(area).zip(lines.iter().skip(from)) {
        match line {
            FormLine::Head(at) => draw_head(form, *at, canvas, row),
            FormLine::Row(at, index) => draw_row(form, *at, *index, canvas, row, focused),
            FormLine::Add(at) => draw_add(form, *at, canvas, row, focused),
            FormLine::Total(at) => draw_total(form, *at, canvas, row),
        }
    }
}

/// Columns of a block that fit beside the names, so that the focused one is seen.
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
        canvas.text(row, &format!("{:<19}{:>11} {:>11}", "", "new", "now"), Role::Header);
        return;
    }
    if block.is_text() {
        let words = format!("{}: {}", block.argument.name, block.argument.kind.words());
        canvas.text(row, &words, Role::Header);
        return;
    }
    let name = format!("{} ({})", block.argument.name, block.argument.unit);
    if block.columns.len() == 1 {
        canvas.text(row, &format!("{name}: {}", block.argument.doc), Role::Header);
        return;
    }
    let shown = columns_shown(form, at, row.width);
    canvas.text(Rect { width: NAME.min(row.width), ..row }, &name, Role::Header);
    for (place, column) in shown.clone().enumerate() {
        canvas.aligned(cell_area(block, row, place), &block.columns[column], Role::Header, Align::Right);
    }
    let mark = if shown.end < block.columns.len() { "more ›" } else { "total" };
    canvas.aligned(cell_area(block, row, shown.len()), mark, Role::Header, Align::Right);
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
    for (place, column) in shown.clone().enumerate() {
        let own = Place { block: at, row: index, column };
        draw_cell(form, own, canvas, cell_area(block, row, place), here && column == form.at.column);
    }
    let after = cell_area(block, row, shown.len());
    if block.columns.len() > 1 {
        let sum: f64 = block.slots[index].iter().filter_map(|slot| slot.value().ok().flatten()).sum();
        canvas.aligned(after, &number(sum), Role::Dim, Align::Right);
        return;
    }
    let slot = &block.slots[index][0];
    canvas.aligned(after, &slot.current.map_or("–".to_owned(), number), Role::Dim, Align::Right);
    let x = after.right() + 2;
    let doc = Rect { x, width: row.right().saturating_sub(x), ..row };
    if block.is_scalar() {
        let words = format!("{}, {} · {}", block.argument.unit, block.range().words(), block.argument.doc);
        canvas.text(doc, &words, Role::Dim);
    }
}

/// A line of text takes the whole row.
fn draw_text(form: &Form, at: usize, canvas: &mut Canvas<'_>, row: Rect, here: bool) {
    let place = Place { block: at, row: 0, column: 0 };
    let Some(slot) = form.sheet.slot(place) else { return };
    if let Some(count) = form.sheet.places().position(|own| own == place) {
        canvas.click(row, Click::Row(1, count));
    }
    if let Some(field) = slot.draft.as_ref().filter(|_| here && form.typing.is_some()) {
        return field.draw(canvas, row);
    }
    let text = slot.text();
    let role = match (here, text.is_empty()) {
        (true, _) => Role::Selection,
        (false, true) => Role::Dim,
        (false, false) => Role::Changed,
    };
    canvas.clear(row, if here { Role::Selection } else { Role::Text });
    canvas.text(row, if text.is_empty() { "·" } else { &text }, role);
}

fn draw_cell(form: &Form, place: Place, canvas: &mut Canvas<'_>, area: Rect, here: bool) {
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

fn is_wrong(form: &Form, block: &Block, slot: &Slot, place: Place) -> bool {
    let outside = match slot.value() {
        Err(()) => true,
        Ok(Some(value)) if slot.is_changed() => !block.range().holds(value),
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
        return field.draw(canvas, cell_area(block, row, 0));
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
    let (place, now) = if many { (shown.len(), None) } else { (0, Some(block.total_now())) };
    canvas.aligned(cell_area(block, row, place), &number(block.total()), Role::Strong, Align::Right);
    if let Some(now) = now {
        canvas.aligned(cell_area(block, row, 1), &number(now), Role::Dim, Align::Right);
    }
}

/// What stands below the values: what the call would do, the call itself, the effect, what helps, the answer.
fn outcome_lines(form: &Form, look: &Look<'_>, width: usize) -> Vec<(String, Role)> {
    let mut lines: Vec<(String, Role)> = Vec::new();
    let mut paragraph = |text: &str, role: Role| {
        lines.extend(wrapped(text, width).into_iter().map(|line| (line, role)));
    };
    match &form.preview {
        Some(Ok(preview)) => {
            let mut parts = Vec::new();
            if preview.cost_now > 0.0 {
                parts.push(format!("costs {} at once", dollars(preview.cost_now)));
            }
            if preview.cost_per_day != 0.0 {
                parts.push(format!("{} a day", signed_dollars(preview.cost_per_day)));
            }
            if let Some(day) = preview.effect_day {
                parts.push(format!("from day {day}"));
            }
            if !parts.is_empty() {
                paragraph(&format!("→ {}", parts.join(" · ")), Role::Strong);
            }
        }
        Some(Err(refusal)) => paragraph(&format!("! {}", refusal.message), Role::Bad),
        None => {}
    }
    if form.sheet.is_changed() || !form.spec.kind.acts() {
        paragraph(&format!("≡ {}", form.call()), Role::Dim);
    }
    if let Some(answer) = &form.answer
        && !form.sheet.is_changed()
    {
        answer_lines(answer, &mut paragraph);
    }
    let helps = reference(form.spec.name, look.company);
    if !helps.is_empty() {
        paragraph(" ", Role::Text);
        for (at, line) in helps.iter().enumerate() {
            let role = if at == 0 { Role::Header } else { Role::Text };
            lines.push((line.clone(), role));
        }
    }
    let mut about = |text: &str| {
        if !text.is_empty() {
            lines.push((String::new(), Role::Text));
            lines.extend(wrapped(text, width).into_iter().map(|line| (line, Role::Dim)));
        }
    };
    about(form.spec.effect);
    about(&format!("Costs {}.", form.spec.cost));
    lines
}

fn answer_lines(answer: &Result<Value, crate::session::Refusal>, paragraph: &mut impl FnMut(&str, Role)) {
    match answer {
        Ok(value) => {
            paragraph("✓ answered", Role::Good);
            for line in readable(value, 0) {
                paragraph(&line, Role::Text);
            }
        }
        Err(refusal) => paragraph(&format!("! {}: {}", refusal.code, refusal.message), Role::Bad),
    }
}

/// An answer as indented lines: flat objects in one line each.
fn readable(value: &Value, depth: usize) -> Vec<String> {
    let indent = "  ".repeat(depth + 1);
    let flat = |value: &Value| !matches!(value, Value::Object(_) | Value::Array(_));
    let word = |value: &Value| match value {
        Value::String(text) => text.clone(),
        Value::Number(figure) => figure.as_f64().map_or(figure.to_string(), |figure| {
            if figure.fract() == 0.0 { number(figure) } else { figure.to_string() }
        }),
        Value::Null => "–".to_owned(),
        other => other.to_string(),
    };
    let pairs = |map: &serde_json::Map<String, Value>| {
        map.iter().map(|(name, value)| format!("{name} {}", word(value))).collect::<Vec<_>>().join(" · ")
    };
    match value {
        Value::Object(map) if map.is_empty() => vec![format!("{indent}none")],
        Value::Object(map) if map.values().all(flat) => vec![format!("{indent}{}", pairs(map))],
        Value::Object(map) => map
            .iter()
            .flat_map(|(name, inner)| match inner {
                inner if flat(inner) => vec![format!("{indent}{name} {}", word(inner))],
                Value::Object(fields) if !fields.is_empty() && fields.values().all(flat) => {
                    vec![format!("{indent}{name}: {}", pairs(fields))]
                }
                inner => {
                    std::iter::once(format!("{indent}{name}")).chain(readable(inner, depth + 1)).collect()
                }
            })
            .collect(),
        Value::Array(items) => items.iter().flat_map(|item| readable(item, depth)).collect(),
        other => vec![format!("{indent}{}", word(other))],
    }
}
