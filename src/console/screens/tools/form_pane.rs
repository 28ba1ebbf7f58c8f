//! The pane with the form of the selected tool: description, values, check of the call, and earlier calls.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;
use ratatui::text::Line as TextLine;

use super::form::ToolForm;
use super::grid::{draw_sheet, form_lines};
use super::outcome::{DetailLevel, OutcomeLines, outcome_lines};
use super::sheet::ArgumentBlock;
use super::{Tools, ToolsPane, figure};
use crate::action::{Action, Scope};
use crate::context::{EditorDocument, Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_tools::{ParameterNumbers, ToolSpec, ToolId, EffectTiming, describe};
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextEditor;

pub struct FormPane;

impl Pane<Tools> for FormPane {
    fn scopes(&self, tools: &Tools) -> Vec<Scope> {
        tools.visible_form().map_or(vec![Scope::Form, Scope::List], ToolForm::scopes)
    }

    fn hints(&self, tools: &Tools) -> Vec<Action> {
        match tools.visible_form() {
            Some(form) if form.code_editor().is_some() => vec![Action::Apply, Action::LeaveEditor],
            Some(form) if form.is_typing() => {
                vec![Action::Commit, Action::CommitNext, Action::Apply, Action::Discard]
            }
            _ => vec![
                Action::EditCell,
                Action::Apply,
                Action::CopyDown,
                Action::ResetForm,
                Action::CopyCall,
                Action::SaveCalls,
                Action::Close,
                Action::ClearCell,
            ],
        }
    }

    fn figure(&self, tools: &Tools, _: &ScreenContext<'_>) -> Option<Figure> {
        let cell = tools.visible_form().and_then(figure::cell_figure);
        cell.or_else(|| tools.selected_tool().map(figure::tool_figure))
    }

    fn handle_action(&self, tools: &mut Tools, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if tools.form(context.company).is_some_and(|form| form.text_page.turn(action)) {
            return Vec::new();
        }
        match action {
            Action::Close => {
                let effects = tools.discard_suggestion(context.company);
                tools.focus = ToolsPane::List;
                return effects;
            }
            Action::EditCell if tools.dedicated_screen_effect().is_some() => {
                tools.focus = ToolsPane::List;
                return tools.dedicated_screen_effect().into_iter().collect();
            }
            Action::SaveCalls => {
                let calls = tools.calls_text(context.company);
                return vec![Effect::Write("calls.txt".to_owned(), calls.into_bytes())];
            }
            _ => {}
        }
        tools.form(context.company).map_or(Vec::new(), |form| form.handle_action(action, context.company))
    }

    fn handle_key(&self, tools: &mut Tools, key: &KeyEvent, context: &ScreenContext<'_>) -> Vec<Effect> {
        tools.form(context.company).map_or(Vec::new(), |form| {
            form.text_page.number = 0;
            form.handle_key(key)
        })
    }

    fn paste(&self, tools: &mut Tools, text: &str, context: &ScreenContext<'_>) -> Vec<Effect> {
        tools.form(context.company).map_or(Vec::new(), |form| form.paste(text))
    }

    fn editor_document(&self, tools: &Tools) -> Option<EditorDocument> {
        tools.visible_form().and_then(ToolForm::code_document)
    }

    fn replace_document(&self, tools: &mut Tools, text: &str) -> Vec<Effect> {
        let form = tools.selected_tool().and_then(|spec| tools.forms.get_mut(&spec.id));
        form.map_or(Vec::new(), |form| form.replace_code(text))
    }

    fn handle_click(&self, tools: &mut Tools, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        let Some(form) = tools.form(context.company).filter(|form| !form.is_typing()) else { return Vec::new() };
        let place = form.sheet.positions().nth(row);
        if place == Some(form.focus) {
            return form.handle_action(Action::EditCell, context.company);
        }
        form.focus = place.unwrap_or(form.focus);
        form.text_page.number = 0;
        Vec::new()
    }

    fn border(&self, tools: &Tools, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        match (tools.selected_tool(), tools.visible_form()) {
            (Some(spec), Some(form)) => PaneBorder {
                title: format!("{} · {} · {}", spec.name(), spec.module.id(), spec.code),
                note: effect_label(spec).to_owned(),
                keys: key_hints(form, context),
                shows_keys_always: true,
            },
            (spec, _) => {
                let title = spec.map_or("Form", |spec| spec.name()).to_owned();
                PaneBorder { title, ..PaneBorder::default() }
            }
        }
    }

    fn draw(&self, tools: &Tools, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let Some(form) = tools.visible_form() else { return };
        let inside = Rect { x: placement.area.x + 1, width: placement.area.width.saturating_sub(2), ..placement.area };
        if let Some(editor) = form.code_editor() {
            return draw_code(editor, canvas, inside, placement.focused);
        }
        if placement.focused && form.text_page.number > 0 {
            return draw_text_page(tools, form, canvas, placement, inside, context);
        }
        let FormLayout { head, outcome, gap, .. } = layout_form(tools, form, inside, context);
        let lines = form_lines(form);
        let below = draw_head(&head, canvas, inside);
        // In a dense layout, the values can use all rows except one. Otherwise, up to half of the rows are reserved for
        // the outcome.
        let kept = outcome.lines.len().min(if gap == 0 { 1 } else { usize::MAX }).min(below.height as usize / 2);
        let room = below.height.saturating_sub(kept as u16);
        let sheet = Rect { height: (lines.len() as u16).min(room), ..below };
        draw_sheet(form, Some(&tools.leads), &lines, canvas, sheet, placement.focused);
        let rest = area_below(below, sheet.height + gap.min(sheet.height));
        let used = draw_outcome(&outcome.lines, canvas, rest, placement.focused, context);
        let below = area_below(rest, used + 1);
        let used = tools.price_curve.draw(form, canvas, below);
        let below = area_below(below, used);
        let used = draw_earlier(&form.earlier_calls, canvas, below);
        let manual = manual_lines(form.spec, inside.width, context);
        let manual_area = area_below(below, used);
        draw_manual(&manual, canvas, manual_area);
        let is_complete = gap > 0
            && usize::from(sheet.height) == lines.len()
            && outcome.lines.len() <= usize::from(rest.height)
            && form.earlier_calls.len() < usize::from(below.height)
            && (manual.len() + 1).max(MIN_MANUAL_ROWS) <= usize::from(manual_area.height);
        form.text_page.last.set(usize::from(!is_complete));
    }
}

/// Draws a page of the complete text of a form, for a window that is too small for it. The pages begin with the first
/// line that the normal view omits.
fn draw_text_page(
    tools: &Tools,
    form: &ToolForm,
    canvas: &mut Canvas<'_>,
    placement: PanePlacement,
    area: Rect,
    context: &ScreenContext<'_>,
) {
    let height = area.height as usize;
    let step = height.saturating_sub(1).max(1);
    let FormLayout { head, complete_head, gap, .. } = layout_form(tools, form, area, context);
    let first = if gap == 0 { head.len().min(step) } else { step };
    let sheet = form_lines(form);
    let below = text_below_values(tools, form, area.width, context);
    let rows = complete_head.len() + sheet.len() + below.len();
    let last_row = rows.saturating_sub(height);
    form.text_page.last.set(1 + last_row.saturating_sub(first).div_ceil(step));
    let number = form.text_page.number.min(form.text_page.last.get());
    let from = (first + (number - 1) * step).min(last_row);
    let shown_head = complete_head.get(from..).unwrap_or_default();
    let rest = draw_head(shown_head, canvas, area);
    let skipped = from.saturating_sub(complete_head.len());
    let shown_sheet = sheet.get(skipped..).unwrap_or_default();
    let shown_sheet = &shown_sheet[..shown_sheet.len().min(rest.height as usize)];
    let values = Rect { height: shown_sheet.len() as u16, ..rest };
    draw_sheet(form, Some(&tools.leads), shown_sheet, canvas, values, true);
    let skipped = skipped.saturating_sub(sheet.len());
    draw_head(below.get(skipped..).unwrap_or_default(), canvas, area_below(rest, values.height));
    canvas.draw_scroll_marks(placement.area, from, rows);
}

/// Returns all text below the values: the outcome in full detail, the earlier calls and the manual.
fn text_below_values(
    tools: &Tools,
    form: &ToolForm,
    width: u16,
    context: &ScreenContext<'_>,
) -> Vec<(String, Role)> {
    let blank = || (String::new(), Role::Text);
    let mut lines = vec![blank()];
    lines.extend(outcome_lines(form, tools, context, (width as usize, DetailLevel::Full)).lines);
    if !form.earlier_calls.is_empty() {
        lines.extend([blank(), ("earlier calls".to_owned(), Role::Header)]);
        let calls = form.earlier_calls.iter().map(earlier_call_text);
        lines.extend(calls.flat_map(|call| wrap(&call, width as usize)).map(|line| (line, Role::Dim)));
    }
    lines.extend([blank(), (MANUAL_HEADING.to_owned(), Role::Header)]);
    lines.extend(manual_lines(form.spec, width, context).into_iter().map(|line| (line, Role::Text)));
    lines
}

const MANUAL_HEADING: &str = "manual";
/// Minimum height of the area for the manual.
const MIN_MANUAL_ROWS: usize = 8;

fn manual_lines(spec: &ToolSpec, width: u16, context: &ScreenContext<'_>) -> Vec<String> {
    wrap(&describe::format_manual(spec, &context.company.numbers), width as usize)
}

fn earlier_call_text((day, arguments): &(u32, String)) -> String {
    format!("day {day:>3}  {arguments}")
}

fn draw_code(editor: &TextEditor, canvas: &mut Canvas<'_>, area: Rect, focused: bool) {
    let (row, _) = editor.cursor();
    let words = format!("code, line {} of {}", row + 1, editor.lines().len());
    canvas.draw_text(Rect { height: area.height.min(1), ..area }, &words, Role::Header);
    editor.draw(canvas, area_below(area, 1), focused, "SQL, or Python if the code starts with #");
}

/// Returns the part of an area below its first `rows` rows.
fn area_below(area: Rect, rows: u16) -> Rect {
    let rows = rows.min(area.height);
    Rect { y: area.y + rows, height: area.height - rows, ..area }
}

/// Minimum width at which the brief margins have one line per plan.
const MIN_BRIEF_WIDTH: usize = 36;

struct FormLayout {
    /// Description and cost of the tool, with a blank row if it fits.
    head: Vec<(String, Role)>,
    /// The complete description and the cost, with a blank row.
    complete_head: Vec<(String, Role)>,
    outcome: OutcomeLines,
    /// Number of blank rows below the values.
    gap: u16,
}

/// Returns the normal layout if the margins fit. Otherwise, returns a denser layout with as much of the description as
/// fits.
fn layout_form(tools: &Tools, form: &ToolForm, area: Rect, context: &ScreenContext<'_>) -> FormLayout {
    let (width, values) = (area.width as usize, form_lines(form).len());
    let lines = |text: &str, role: Role| wrap(text, width).into_iter().map(move |line| (line, role));
    let has = context.company.has_tool(form.spec.id);
    let locked = if has { "" } else { "Not in this lesson. " };
    let summary: Vec<_> = lines(&format!("{locked}{}.", form.spec.summary), Role::Strong).collect();
    let terms = cost_and_effect_text(form.spec, &context.company.numbers, context.company.observation.day);
    let terms: Vec<_> = summary.iter().cloned().chain(lines(&terms, Role::Text)).collect();
    let blank: Vec<_> = terms.iter().cloned().chain([(String::new(), Role::Text)]).collect();
    let outcome_with_detail = |detail| outcome_lines(form, tools, context, (width, detail));
    // One row is reserved for the note that the text is truncated.
    let fits = |head: &[(String, Role)], gap: usize, outcome: &OutcomeLines| {
        head.len() + values + gap + outcome.required_lines < area.height as usize && !outcome.is_truncated(width)
    };
    let usual = outcome_with_detail(DetailLevel::Full);
    if usual.required_lines == 0 || width < MIN_BRIEF_WIDTH || fits(&blank, 1, &usual) {
        return FormLayout { head: blank.clone(), complete_head: blank, outcome: usual, gap: 1 };
    }
    let dense = outcome_with_detail(DetailLevel::Compact);
    let outcome = if fits(&summary, 0, &dense) { dense } else { outcome_with_detail(DetailLevel::Brief) };
    let complete_head = blank.clone();
    let head = [blank, terms, summary].into_iter().find(|head| fits(head, 0, &outcome)).unwrap_or_default();
    FormLayout { head, complete_head, outcome, gap: 0 }
}

fn draw_head(head: &[(String, Role)], canvas: &mut Canvas<'_>, area: Rect) -> Rect {
    let lines: Vec<TextLine<'_>> =
        head.iter().map(|(text, role)| TextLine::from(canvas.span(text.as_str(), *role))).collect();
    canvas.draw_lines(area, &lines);
    area_below(area, head.len() as u16)
}

/// Draws the check of the call and the answer. Returns the number of rows.
fn draw_outcome(
    lines: &[(String, Role)],
    canvas: &mut Canvas<'_>,
    area: Rect,
    focused: bool,
    context: &ScreenContext<'_>,
) -> u16 {
    let mut shown: Vec<TextLine<'_>> =
        lines.iter().map(|(text, role)| TextLine::from(canvas.span(text.as_str(), *role))).collect();
    // If the text is truncated, the last row names the keys that show the rest.
    if shown.len() > area.height as usize && area.height > 0 {
        shown.truncate(area.height as usize - 1);
        let key = |action| context.keys.label(action).unwrap_or_default();
        let more = match focused {
            true => format!("… {} shows the rest", key(Action::PageDown)),
            false => format!("… {} and then {} show the rest", key(Action::Open), key(Action::PageDown)),
        };
        shown.push(TextLine::from(canvas.span(more, Role::Dim)));
    }
    canvas.draw_lines(area, &shown);
    shown.len() as u16
}

/// Draws earlier calls if they fit. Returns the number of rows, including a blank row.
fn draw_earlier(calls: &[(u32, String)], canvas: &mut Canvas<'_>, area: Rect) -> u16 {
    if calls.is_empty() || area.height < 3 {
        return 0;
    }
    let used = (calls.len() as u16 + 2).min(area.height);
    let mut rows = row_rects(area);
    if let Some(row) = rows.next() {
        canvas.draw_text(row, "earlier calls", Role::Header);
    }
    for (row, call) in rows.zip(calls) {
        canvas.draw_text(row, &earlier_call_text(call), Role::Dim);
    }
    used
}

/// Draws the manual of the tool in large windows.
fn draw_manual(lines: &[String], canvas: &mut Canvas<'_>, area: Rect) {
    if usize::from(area.height) < MIN_MANUAL_ROWS {
        return;
    }
    let mut rows = row_rects(area);
    if let Some(row) = rows.next() {
        canvas.draw_text(row, MANUAL_HEADING, Role::Header);
    }
    for (row, line) in rows.zip(lines) {
        canvas.draw_text(row, line, Role::Text);
    }
}

fn key_hints(form: &ToolForm, context: &ScreenContext<'_>) -> String {
    match form.spec.id {
        ToolId::NextWeek => return "n opens the next-week dialog".to_owned(),
        ToolId::Query => return "enter opens the SQL screen".to_owned(),
        _ => {}
    }
    match form.sheet.blocks.is_empty() {
        true => "enter runs the tool".to_owned(),
        false if form.code_editor().is_some() => context.hints(&[Action::Apply, Action::LeaveEditor]),
        false if form.is_typing() => {
            let enter = context.keys.label(Action::Commit).unwrap_or_default();
            format!("{enter} accept, next row · {}", context.hints(&[Action::Apply, Action::Discard]))
        },
        false => format!(
            "{} {} · {}",
            context.hint(Action::EditCell),
            form.sheet.blocks.get(form.focus.block).map_or("the value", ArgumentBlock::kind_label),
            context.hints(&[Action::Apply, Action::ResetForm, Action::CopyCall, Action::SaveCalls])
        ),
    }
}

fn effect_label(spec: &ToolSpec) -> &'static str {
    match spec.effect_timing {
        EffectTiming::NextDay => "takes effect tomorrow",
        EffectTiming::NextBilling => "takes effect with the next bill",
        EffectTiming::Now => "takes effect at once",
        EffectTiming::AtCompletion => "takes effect on completion",
        EffectTiming::CustomerReply => "takes effect when the customer answers",
        EffectTiming::Never => "read-only",
    }
}

/// Describes the cost of a call of the tool and the day on which the call takes effect.
fn cost_and_effect_text(spec: &ToolSpec, numbers: &ParameterNumbers, today: u32) -> String {
    let from = match spec.effect_timing {
        EffectTiming::NextDay => format!(" Takes effect on day {}.", today + 1),
        EffectTiming::NextBilling => format!(" From day {}, with each customer's next bill.", today + 1),
        EffectTiming::Now if spec.kind.changes_company() => format!(" Takes effect at once, on day {today}."),
        _ => String::new(),
    };
    format!("Costs {}.{from}", numbers.substitute(spec.cost))
}
