//! The debrief of a lesson: cash compared with the reference play and the pitfall play, differing decisions, and
//! guesses.

use std::sync::Arc;

use ratatui::layout::Rect;

use super::lesson::start_part;
use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use crate::lesson::{draw_lines, retry_step};
use novamind_course::Debrief;
use novamind_record::figures::FigureUnit;
use novamind_report::debrief::{debrief_paragraphs, headline};
use novamind_report::{debrief_to_html, debrief_to_markdown, pluralize};
use novamind_tools::Rejection;
use novamind_tui::canvas::{Align, Canvas, centered_rect};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{AxisUnit, Curve, ScrollState, XAxis, YAxis, draw_chart};

const MAX_PAGE_WIDTH: u16 = 160;
const MIN_SIZE_FOR_SIDE_CURVES: (u16, u16) = (104, 20);

/// The debrief page.
#[derive(Default)]
pub struct DebriefPage {
    debrief: Option<Arc<Result<Debrief, Rejection>>>,
    scroll: ScrollState,
}

impl DebriefPage {
    /// Opens the page. If the debrief was already computed, the page shows it.
    pub fn new(found: Option<Arc<Result<Debrief, Rejection>>>) -> DebriefPage {
        DebriefPage { debrief: found, ..DebriefPage::default() }
    }

    fn successful_debrief(&self) -> Option<&Debrief> {
        self.debrief.as_ref()?.as_ref().as_ref().ok()
    }

    fn write_debrief(&self) -> DialogResponse {
        let Some(debrief) = self.successful_debrief() else {
            return DialogResponse::stay_with(vec![Effect::ShowError(
                "the debrief is still being computed".to_owned(),
            )]);
        };
        let files =
            [("debrief.md", debrief_to_markdown(debrief)), ("debrief.html", debrief_to_html(debrief))];
        DialogResponse::stay_with(
            files.map(|(name, text)| Effect::Write(name.to_owned(), text.into_bytes())).to_vec(),
        )
    }
}

const DEBRIEF_ACTIONS: [Action; 6] = [
    Action::ToMenu,
    Action::TryAgain,
    Action::NextPart,
    Action::Opponents,
    Action::WriteRunReport,
    Action::StayInRun,
];

impl Dialog for DebriefPage {
    fn record_name(&self) -> String {
        "debrief".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::FinalPage, Scope::List, Scope::Lesson]
    }

    fn hints(&self) -> Vec<Action> {
        DEBRIEF_ACTIONS.to_vec()
    }

    fn hints_in_context(&self, context: &ScreenContext<'_>) -> Vec<Action> {
        let page = context.company.lesson.as_ref();
        let is_there = |action: &Action| match action {
            Action::NextPart => page.is_some_and(|page| page.next_part.is_some()),
            Action::Opponents => page.is_some_and(|page| page.has_opponents),
            _ => true,
        };
        DEBRIEF_ACTIONS.into_iter().filter(is_there).collect()
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        let page = context.company.lesson.as_ref();
        match action {
            Action::ToMenu => return DialogResponse::confirm_with(vec![Effect::Execute(Action::LeaveRun)]),
            Action::StayInRun | Action::Close => return DialogResponse::close(),
            Action::WriteRunReport => return self.write_debrief(),
            Action::Opponents => return DialogResponse::stay_with(vec![Effect::ShowOpponents]),
            Action::TryAgain => {
                return DialogResponse::stay_with(
                    page.map(|page| Effect::TryStepAgain(retry_step(page))).into_iter().collect(),
                );
            }
            Action::NextPart => {
                if let Some(part) = page.and_then(|page| page.next_part) {
                    return start_part(part);
                }
                let text = "this was the last part of the lesson".to_owned();
                return DialogResponse::stay_with(vec![Effect::ShowError(text)]);
            }
            other => {
                self.scroll.handle_action(other, context.page_rows as usize);
            }
        }
        DialogResponse::stay()
    }

    fn set_debrief(&mut self, found: &Arc<Result<Debrief, Rejection>>) {
        self.debrief = Some(found.clone());
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let dialog_area = centered_rect(area, MAX_PAGE_WIDTH.min(area.width), 50.min(area.height));
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, "Debrief", "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        canvas.draw_pane_keys(dialog_area, &context.hints(&self.hints_in_context(context)));
        let debrief = match self.debrief.as_ref().map(|found| found.as_ref().as_ref()) {
            None => {
                return canvas.draw_text(
                    inside,
                    "simulating the reference play and the pitfall play …",
                    Role::Warning,
                );
            }
            Some(Err(rejection)) => return canvas.draw_text(inside, &rejection.message, Role::Bad),
            Some(Ok(debrief)) => debrief,
        };
        let is_wide =
            inside.width >= MIN_SIZE_FOR_SIDE_CURVES.0 && inside.height >= MIN_SIZE_FOR_SIDE_CURVES.1;
        let (words, curves) = if is_wide {
            let left = inside.width * 11 / 20;
            let right = Rect { x: inside.x + left + 2, width: inside.width - left - 2, ..inside };
            (Rect { width: left, ..inside }, right)
        } else {
            let above = (inside.height * 2 / 5).max(4).min(inside.height);
            let below = Rect { y: inside.y + above, height: inside.height - above, ..inside };
            (below, Rect { height: above, ..inside })
        };
        draw_curves(canvas, curves, debrief);
        let lines = debrief_lines(debrief, words.width as usize);
        let last = lines.len().saturating_sub(words.height as usize);
        let from = self.scroll.scroll_rows(canvas, words, lines.len());
        canvas.page_rows = words.height.max(1);
        draw_lines(canvas, words, &lines, from);
        if from < last {
            let key = context.keys.label(Action::Down).unwrap_or_default();
            let more = format!(" {key}: {} more ", pluralize((last - from) as u32, "line"));
            let above = Rect {
                x: dialog_area.x + 2,
                width: dialog_area.width.saturating_sub(4),
                height: 1,
                ..dialog_area
            };
            canvas.draw_aligned(above, &more, Role::Key, Align::Right);
        }
    }
}

fn debrief_lines(debrief: &Debrief, width: usize) -> Vec<(String, Role)> {
    let heading = headline(debrief);
    let paragraphs = debrief_paragraphs(debrief).into_iter().enumerate().flat_map(|(at, text)| {
        let role = match at {
            0 => Role::Title,
            _ if text == heading => Role::Strong,
            _ => Role::Text,
        };
        let lines = if text.is_empty() { vec![String::new()] } else { wrap(&text, width) };
        lines.into_iter().map(move |line| (line, role))
    });
    paragraphs.collect()
}

/// Draws the curves of the figure by which the part is judged.
fn draw_curves(canvas: &mut Canvas<'_>, area: Rect, debrief: &Debrief) {
    let Some(judged) = &debrief.judged_by else { return draw_cash_curves(canvas, area, debrief) };
    let curve = |values: &[(u32, f64)], role, name| {
        let decided = values.iter().filter(|(day, _)| *day >= debrief.first_day);
        Curve::from_points(decided.map(|(day, value)| (f64::from(*day), *value)).collect(), role)
            .with_name(name)
    };
    let mut lines = Vec::new();
    lines.extend(
        judged.bad_play.as_ref().map(|cash_by_day| curve(cash_by_day, Role::Series(1), "pitfall play")),
    );
    lines.extend(
        judged.reference.as_ref().map(|cash_by_day| curve(cash_by_day, Role::Series(2), "reference")),
    );
    lines.push(curve(&judged.actual, Role::Series(0), "you"));
    let unit = match judged.figure.unit() {
        FigureUnit::Dollars => AxisUnit::Dollars,
        _ => AxisUnit::Number,
    };
    draw_daily_curves(canvas, area, &lines, unit);
}

fn draw_daily_curves(canvas: &mut Canvas<'_>, area: Rect, lines: &[Curve], unit: AxisUnit) {
    let write = |day: f64| format!("day {day:.0}");
    draw_chart(
        canvas,
        area,
        lines,
        &XAxis { format: &write, required_values: &[] },
        &YAxis { unit, required_values: &[] },
    );
}

fn draw_cash_curves(canvas: &mut Canvas<'_>, area: Rect, debrief: &Debrief) {
    let from = debrief.first_day as usize;
    let curve = |cash: &[f64], role, name| {
        let points = cash.iter().enumerate().skip(from).map(|(day, cash)| (day as f64, *cash)).collect();
        Curve::from_points(points, role).with_name(name)
    };
    let mut lines = Vec::new();
    lines.extend(
        debrief
            .bad_play
            .as_ref()
            .map(|reference_curve| curve(&reference_curve.cash_by_day, Role::Series(1), "pitfall play")),
    );
    lines.extend(
        debrief
            .reference
            .as_ref()
            .map(|reference| curve(&reference.cash_by_day, Role::Series(2), "reference")),
    );
    lines.push(curve(&debrief.cash_by_day, Role::Series(0), "you"));
    draw_daily_curves(canvas, area, &lines, AxisUnit::Dollars);
}
