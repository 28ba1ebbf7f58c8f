//! How list and form look.

use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::Line as TextLine;

use super::form::Form;
use super::grid::{draw_sheet, form_lines};
use super::outcome::{Leads, outcome_lines};
use super::sheet::Block;
use super::{Look, Tools};
use crate::console::action::Action;
use crate::console::canvas::{Align, Canvas, Click, fit, rows_of};
use crate::console::text::wrapped;
use crate::console::theme::Role;
use crate::console::widgets::table::first_row;
use crate::tools::{Module, Numbers, Spec, ToolId, When, describe};

pub(super) fn draw(tools: &Tools, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    let narrow = area.width < 100;
    let list = match tools.focus {
        0 if canvas.zoomed => area.width,
        1 if canvas.zoomed || narrow => 0,
        _ if narrow => 34,
        _ if area.width < 112 => 32,
        // The longest name, its code, and what is between them.
        _ => 37,
    };
    let [left, right] = Layout::horizontal([Constraint::Length(list), Constraint::Min(0)]).areas(area);
    if list > 0 {
        draw_list(tools, canvas, left, look);
    }
    let Some(spec) = tools.here() else {
        canvas.pane(right, "Form", "", tools.focus == 1);
        return;
    };
    match tools.forms.get(&spec.id) {
        Some(form) if right.width > 0 => draw_form(form, &tools.leads, canvas, right, look, tools.focus == 1),
        Some(_) => {}
        None => {
            canvas.pane(right, spec.name(), "", tools.focus == 1);
        }
    }
}

fn draw_list(tools: &Tools, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    let focused = tools.focus == 0;
    canvas.click(area, Click::Pane(0));
    let note = match tools.unsent().len() {
        _ if !tools.filter.is_empty() => format!("\"{}\"", tools.filter),
        0 => look.hint(Action::Filter),
        1 => "* 1 draft".to_owned(),
        drafts => format!("* {drafts} drafts"),
    };
    let inside = canvas.pane(area, "Tools", &note, focused);
    let shown = tools.shown();
    // Lines of the list: heads of modules and tools with their place.
    let mut lines: Vec<(Option<(usize, &Spec)>, &str)> = Vec::new();
    for module in Module::ALL {
        let own = shown.iter().enumerate().filter(|(_, spec)| spec.module == module);
        let own: Vec<_> = own.map(|(at, spec)| (Some((at, *spec)), spec.name())).collect();
        if !own.is_empty() {
            lines.push((None, module.id()));
            lines.extend(own);
        }
    }
    if lines.is_empty() {
        let text = format!("no matching tool: {}", look.hint(Action::Close));
        canvas.text(inside, &text, Role::Dim);
    }
    let field = u16::from(tools.typing.is_some());
    let list = Rect { height: inside.height.saturating_sub(field), ..inside };
    if focused {
        canvas.page = list.height.max(1);
    }
    let is_here = |line: &(Option<(usize, &Spec)>, &str)| line.0.is_some_and(|own| own.0 == tools.selected);
    let selected = lines.iter().position(is_here).unwrap_or(0);
    let from = first_row(selected, list.height as usize, lines.len());
    for (row, (place, text)) in rows_of(list).zip(lines.into_iter().skip(from)) {
        let Some((place, spec)) = place else {
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
            tools.forms.get(&spec.id).is_some_and(|form| form.sheet.is_changed() && form.spec.kind.acts());
        canvas.clear(row, if here { role } else { Role::Text });
        let names = row.width.saturating_sub(9) as usize;
        let mark = if draft { '*' } else { ' ' };
        canvas.text(row, &format!(" {mark}{:<names$}", fit(text, names)), role);
        canvas.aligned(Rect { width: row.width.saturating_sub(1), ..row }, spec.code, role, Align::Right);
        canvas.click(row, Click::Row(0, place));
    }
    if let Some(field) = &tools.typing {
        let row = Rect { y: inside.bottom().saturating_sub(1), height: 1, ..inside };
        canvas.text(row, "/", Role::Key);
        field.draw(canvas, Rect { x: row.x + 1, width: row.width.saturating_sub(1), ..row });
    }
}

fn draw_form(
    form: &Form,
    leads: &Leads,
    canvas: &mut Canvas<'_>,
    area: Rect,
    look: &Look<'_>,
    focused: bool,
) {
    let spec = form.spec;
    canvas.click(area, Click::Pane(1));
    let title = format!("{} · {} · {}", spec.name(), spec.module.id(), spec.code);
    let inside = canvas.pane(area, &title, when(spec), focused);
    let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
    let summary = wrapped(&format!("{}.", spec.summary), inside.width as usize);
    let mut head: Vec<TextLine<'_>> =
        summary.iter().map(|line| TextLine::from(canvas.span(line.as_str(), Role::Strong))).collect();
    let terms = wrapped(&terms(spec, &look.company.numbers, look.company.seen.day), inside.width as usize);
    head.extend(terms.iter().map(|line| TextLine::from(canvas.span(line.as_str(), Role::Text))));
    canvas.lines(inside, &head);
    let top = (head.len() as u16 + 1).min(inside.height);
    let below = Rect { y: inside.y + top, height: inside.height - top, ..inside };
    let lines = form_lines(form);
    let wanted = lines.len() as u16;
    let outcome = outcome_lines(form, leads, look, inside.width as usize);
    let room = below.height.saturating_sub(outcome.len().min(below.height as usize / 2) as u16);
    let sheet = Rect { height: wanted.min(room), ..below };
    draw_sheet(form, leads, &lines, canvas, sheet, focused);
    let rest_from = (sheet.height + u16::from(sheet.height > 0)).min(below.height);
    let rest = Rect { y: below.y + rest_from, height: below.height - rest_from, ..below };
    let mut shown: Vec<TextLine<'_>> =
        outcome.iter().map(|(text, role)| TextLine::from(canvas.span(text.as_str(), *role))).collect();
    // What has no room here stands in the manual.
    if shown.len() > rest.height as usize && rest.height > 0 {
        shown.truncate(rest.height as usize - 1);
        let more = format!(
            "… {} in the list of tools explains the rest",
            look.keys.label(Action::Explain).unwrap_or_default()
        );
        shown.push(TextLine::from(canvas.span(more, Role::Dim)));
    }
    canvas.lines(rest, &shown);
    let used = (shown.len() as u16 + 1).min(rest.height);
    let below = Rect { y: rest.y + used, height: rest.height - used, ..rest };
    let used = draw_earlier(&form.earlier, canvas, below);
    draw_manual(spec, canvas, Rect { y: below.y + used, height: below.height - used, ..below }, look);
    canvas.pane_keys(area, &keys(form, look));
}

/// How the tool was used before, where there is room for it; returns the rows taken, with a blank one.
fn draw_earlier(calls: &[(u32, String)], canvas: &mut Canvas<'_>, area: Rect) -> u16 {
    if calls.is_empty() || area.height < 3 {
        return 0;
    }
    let used = (calls.len() as u16 + 2).min(area.height);
    let mut rows = rows_of(area);
    if let Some(row) = rows.next() {
        canvas.text(row, "earlier in this run", Role::Header);
    }
    for (row, (day, arguments)) in rows.zip(calls) {
        canvas.text(row, &format!("day {day:>3}  {arguments}"), Role::Dim);
    }
    used
}

/// The manual of the tool, in large windows.
fn draw_manual(spec: &Spec, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    if area.height < 8 {
        return;
    }
    let mut rows = rows_of(area);
    if let Some(row) = rows.next() {
        canvas.text(row, "manual", Role::Header);
    }
    for (row, line) in rows.zip(wrapped(&describe::manual(spec, &look.company.numbers), area.width as usize))
    {
        canvas.text(row, &line, Role::Text);
    }
}

fn keys(form: &Form, look: &Look<'_>) -> String {
    match form.spec.id {
        ToolId::NextWeek => return "n opens the next-week dialog".to_owned(),
        ToolId::Query => return "enter opens the SQL screen".to_owned(),
        _ => {}
    }
    match form.sheet.blocks.is_empty() {
        true => "enter runs it".to_owned(),
        false if form.is_typing() => look.hints(&[Action::CommitDown, Action::Apply, Action::Discard]),
        false => format!(
            "{} {} · {} · {} · {} · {}",
            look.hint(Action::EditCell),
            if form.sheet.blocks.iter().all(Block::is_text) { "the list (JSON)" } else { "the value" },
            look.hint(Action::Apply),
            look.hint(Action::ResetForm),
            look.hint(Action::CopyCall),
            look.hint(Action::SaveCalls)
        ),
    }
}

fn when(spec: &Spec) -> &'static str {
    match spec.when {
        When::NextDay => "acts from tomorrow",
        When::NextBilling => "acts on each next bill",
        When::Now => "acts at once",
        When::AtCompletion => "acts when it is done",
        When::CustomerReply => "acts when the customer answers",
        When::Never => "reads",
    }
}

/// Cost and effect date of any call of the tool, before anything is typed.
fn terms(spec: &Spec, numbers: &Numbers, today: u32) -> String {
    let from = match spec.when {
        When::NextDay => format!(" Acts from day {}.", today + 1),
        When::NextBilling => format!(" From day {} on, each customer with the next bill.", today + 1),
        When::Now if spec.kind.acts() => format!(" Acts at once, on day {today}."),
        _ => String::new(),
    };
    format!("Costs {}.{from}", numbers.fill(spec.cost))
}
