//! The form of the selected tool: description, values, check of the call, and earlier calls.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;
use ratatui::text::Line as TextLine;

use super::form::Form;
use super::grid::{draw_sheet, form_lines};
use super::outcome::{Detail, OutcomeLines, outcome_lines};
use super::sheet::Block;
use super::{Tools, ToolsPane, figure};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_tools::{Numbers, Spec, ToolId, When, describe};
use novamind_tui::canvas::{Canvas, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Editor;

pub struct FormPane;

impl Pane<Tools> for FormPane {
    fn scopes(&self, tools: &Tools) -> Vec<Scope> {
        match tools.seen_form() {
            Some(form) if form.writing().is_some() => vec![Scope::Editor, Scope::Form],
            Some(form) if form.is_typing() => vec![Scope::Field, Scope::Form],
            _ => vec![Scope::Form, Scope::List],
        }
    }

    fn takes_numbers(&self, tools: &Tools) -> bool {
        tools.seen_form().is_some_and(Form::takes_numbers)
    }

    fn hints(&self, tools: &Tools) -> Vec<Action> {
        match tools.seen_form() {
            Some(form) if form.writing().is_some() => vec![Action::Apply, Action::LeaveEditor],
            Some(form) if form.is_typing() => {
                vec![Action::CommitDown, Action::CommitNext, Action::Apply, Action::Discard]
            }
            _ => vec![
                Action::EditCell,
                Action::Apply,
                Action::SameDown,
                Action::ResetForm,
                Action::CopyCall,
                Action::SaveCalls,
                Action::Close,
                Action::ClearCell,
            ],
        }
    }

    fn figure(&self, tools: &Tools, _: &Look<'_>) -> Option<Figure> {
        let cell = tools.seen_form().and_then(figure::of_cell);
        cell.or_else(|| tools.here().map(figure::of_tool))
    }

    fn act(&self, tools: &mut Tools, action: Action, look: &Look<'_>) -> Vec<Effect> {
        match action {
            Action::Close => {
                tools.focus = ToolsPane::List;
                return Vec::new();
            }
            Action::EditCell if tools.elsewhere().is_some() => {
                tools.focus = ToolsPane::List;
                return tools.elsewhere().into_iter().collect();
            }
            Action::SaveCalls => {
                let calls = tools.calls(look.company);
                return vec![Effect::Write("calls.txt".to_owned(), calls.into_bytes())];
            }
            _ => {}
        }
        tools.form(look.company).map_or(Vec::new(), |form| form.act(action, look.company))
    }

    fn key(&self, tools: &mut Tools, key: &KeyEvent, look: &Look<'_>) -> Vec<Effect> {
        tools.form(look.company).map_or(Vec::new(), |form| form.key(key))
    }

    fn paste(&self, tools: &mut Tools, text: &str, look: &Look<'_>) -> Vec<Effect> {
        tools.form(look.company).map_or(Vec::new(), |form| form.paste(text))
    }

    fn click(&self, tools: &mut Tools, row: usize, look: &Look<'_>) -> Vec<Effect> {
        let Some(form) = tools.form(look.company).filter(|form| !form.is_typing()) else { return Vec::new() };
        let place = form.sheet.places().nth(row);
        if place == Some(form.at) {
            return form.act(Action::EditCell, look.company);
        }
        form.at = place.unwrap_or(form.at);
        Vec::new()
    }

    fn border(&self, tools: &Tools, _: Rect, look: &Look<'_>) -> Border {
        match (tools.here(), tools.seen_form()) {
            (Some(spec), Some(form)) => Border {
                title: format!("{} · {} · {}", spec.name(), spec.module.id(), spec.code),
                note: when(spec).to_owned(),
                keys: keys(form, look),
                keys_always: true,
            },
            (spec, _) => {
                let title = spec.map_or("Form", |spec| spec.name()).to_owned();
                Border { title, ..Border::default() }
            }
        }
    }

    fn draw(&self, tools: &Tools, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let Some(form) = tools.seen_form() else { return };
        let inside = Rect { x: seat.area.x + 1, width: seat.area.width.saturating_sub(2), ..seat.area };
        if let Some(editor) = form.writing() {
            return draw_code(editor, canvas, inside, seat.focused);
        }
        let Laid { head, outcome, gap } = lay_out(tools, form, inside, look);
        let lines = form_lines(form);
        let below = draw_head(&head, canvas, inside);
        // A dense form keeps the edited values visible; otherwise up to half of the rows are for the outcome.
        let kept = if gap == 0 { 0 } else { outcome.lines.len().min(below.height as usize / 2) };
        let room = below.height.saturating_sub(kept as u16);
        let sheet = Rect { height: (lines.len() as u16).min(room), ..below };
        draw_sheet(form, &tools.leads, &lines, canvas, sheet, seat.focused);
        let rest = under(below, sheet.height + gap.min(sheet.height));
        let used = draw_outcome(&outcome.lines, canvas, rest, look);
        let below = under(rest, used + 1);
        let used = draw_earlier(&form.earlier, canvas, below);
        draw_manual(form.spec, canvas, under(below, used), look);
    }
}

fn draw_code(editor: &Editor, canvas: &mut Canvas<'_>, area: Rect, focused: bool) {
    let (row, _) = editor.cursor();
    let words = format!("code, line {} of {}", row + 1, editor.lines().len());
    canvas.text(Rect { height: area.height.min(1), ..area }, &words, Role::Header);
    editor.draw(canvas, under(area, 1), focused, "SQL, or Python that starts with #");
}

/// Returns the area below its first rows.
fn under(area: Rect, rows: u16) -> Rect {
    let rows = rows.min(area.height);
    Rect { y: area.y + rows, height: area.height - rows, ..area }
}

/// Width from which the short margins have a line per plan.
const BRIEF: usize = 36;

struct Laid {
    /// Description and cost of the tool, with a blank row if it fits.
    head: Vec<(String, Role)>,
    outcome: OutcomeLines,
    /// Blank rows below the values.
    gap: u16,
}

/// Chooses the normal layout if the margins fit, otherwise a denser one with as much of the description as
/// fits.
fn lay_out(tools: &Tools, form: &Form, area: Rect, look: &Look<'_>) -> Laid {
    let (width, values) = (area.width as usize, form_lines(form).len());
    let lines = |text: &str, role: Role| wrapped(text, width).into_iter().map(move |line| (line, role));
    let has = look.company.has_tool(form.spec.id);
    let locked = if has { "" } else { "Not in this lesson. " };
    let summary: Vec<_> = lines(&format!("{locked}{}.", form.spec.summary), Role::Strong).collect();
    let terms = terms(form.spec, &look.company.numbers, look.company.seen.day);
    let terms: Vec<_> = summary.iter().cloned().chain(lines(&terms, Role::Text)).collect();
    let blank: Vec<_> = terms.iter().cloned().chain([(String::new(), Role::Text)]).collect();
    let told = |detail| outcome_lines(form, &tools.leads, &tools.sales, look, (width, detail));
    // Keep a row for the note that text is cut.
    let fits = |head: &[(String, Role)], gap: usize, outcome: &OutcomeLines| {
        head.len() + values + gap + outcome.needed < area.height as usize && !outcome.is_cut(width)
    };
    let usual = told(Detail::Usual);
    if usual.needed == 0 || width < BRIEF || fits(&blank, 1, &usual) {
        return Laid { head: blank, outcome: usual, gap: 1 };
    }
    let dense = told(Detail::Dense);
    let outcome = if fits(&summary, 0, &dense) { dense } else { told(Detail::Brief) };
    let head = [blank, terms, summary].into_iter().find(|head| fits(head, 0, &outcome)).unwrap_or_default();
    Laid { head, outcome, gap: 0 }
}

fn draw_head(head: &[(String, Role)], canvas: &mut Canvas<'_>, area: Rect) -> Rect {
    let lines: Vec<TextLine<'_>> =
        head.iter().map(|(text, role)| TextLine::from(canvas.span(text.as_str(), *role))).collect();
    canvas.lines(area, &lines);
    under(area, head.len() as u16)
}

/// Draws the check of the call and the answer; returns the number of rows.
fn draw_outcome(lines: &[(String, Role)], canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) -> u16 {
    let mut shown: Vec<TextLine<'_>> =
        lines.iter().map(|(text, role)| TextLine::from(canvas.span(text.as_str(), *role))).collect();
    // The manual has the complete text.
    if shown.len() > area.height as usize && area.height > 0 {
        shown.truncate(area.height as usize - 1);
        let explain = look.keys.label(Action::Explain).unwrap_or_default();
        let more = format!("… {explain} in the list of tools shows the rest");
        shown.push(TextLine::from(canvas.span(more, Role::Dim)));
    }
    canvas.lines(area, &shown);
    shown.len() as u16
}

/// Draws earlier calls if they fit; returns the number of rows, including a blank one.
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

/// Draws the manual of the tool in large windows.
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
        false if form.writing().is_some() => look.hints(&[Action::Apply, Action::LeaveEditor]),
        false if form.is_typing() => look.hints(&[Action::CommitDown, Action::Apply, Action::Discard]),
        false => format!(
            "{} {} · {} · {} · {} · {}",
            look.hint(Action::EditCell),
            form.sheet.blocks.get(form.at.block).map_or("the value", Block::edited),
            look.hint(Action::Apply),
            look.hint(Action::ResetForm),
            look.hint(Action::CopyCall),
            look.hint(Action::SaveCalls)
        ),
    }
}

fn when(spec: &Spec) -> &'static str {
    match spec.when {
        When::NextDay => "takes effect tomorrow",
        When::NextBilling => "takes effect with the next bill",
        When::Now => "takes effect at once",
        When::AtCompletion => "takes effect on completion",
        When::CustomerReply => "takes effect when the customer answers",
        When::Never => "read-only",
    }
}

/// Returns the cost and effect date of any call of the tool.
fn terms(spec: &Spec, numbers: &Numbers, today: u32) -> String {
    let from = match spec.when {
        When::NextDay => format!(" Takes effect on day {}.", today + 1),
        When::NextBilling => format!(" From day {}, with each customer's next bill.", today + 1),
        When::Now if spec.kind.acts() => format!(" Takes effect at once, on day {today}."),
        _ => String::new(),
    };
    format!("Costs {}.{from}", numbers.fill(spec.cost))
}
