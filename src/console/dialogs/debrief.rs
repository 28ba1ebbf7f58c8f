//! The debrief of a lesson: cash compared with the good and the bad play, differing decisions, and guesses.

use std::sync::Arc;

use ratatui::layout::Rect;

use super::lesson::begin_part;
use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use crate::lesson::{draw_lines, step_to_try};
use novamind_course::Debrief;
use novamind_record::figures::FigureUnit;
use novamind_report::debrief::{headline, in_words};
use novamind_report::{count, debrief_as_html, debrief_as_markdown};
use novamind_tools::Refusal;
use novamind_tui::canvas::{Align, Canvas, centered};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Axis, Line, Scroll, Side, Unit, chart};

const WIDEST: u16 = 160;
const BESIDE: (u16, u16) = (104, 20);

/// The debrief page.
#[derive(Default)]
pub struct DebriefPage {
    found: Option<Arc<Result<Debrief, Refusal>>>,
    scroll: Scroll,
}

impl DebriefPage {
    /// Opens the page, with a debrief that was already computed if there is one.
    pub fn of(found: Option<Arc<Result<Debrief, Refusal>>>) -> DebriefPage {
        DebriefPage { found, ..DebriefPage::default() }
    }

    fn debrief(&self) -> Option<&Debrief> {
        self.found.as_ref()?.as_ref().as_ref().ok()
    }

    fn written(&self) -> Outcome {
        let Some(debrief) = self.debrief() else {
            return Outcome::with(vec![Effect::Complain("the debrief is still being computed".to_owned())]);
        };
        let files =
            [("debrief.md", debrief_as_markdown(debrief)), ("debrief.html", debrief_as_html(debrief))];
        Outcome::with(files.map(|(name, text)| Effect::Write(name.to_owned(), text.into_bytes())).to_vec())
    }
}

const KEYS: [Action; 6] = [
    Action::ToMenu,
    Action::TryAgain,
    Action::NextPart,
    Action::Opponents,
    Action::ReportOfRun,
    Action::StayInRun,
];

impl Dialog for DebriefPage {
    fn what(&self) -> String {
        "debrief".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Final, Scope::List, Scope::Lesson]
    }

    fn hints(&self) -> Vec<Action> {
        KEYS.to_vec()
    }

    fn hints_here(&self, look: &Look<'_>) -> Vec<Action> {
        let page = look.company.lesson.as_ref();
        let is_there = |action: &Action| match action {
            Action::NextPart => page.is_some_and(|page| page.next_part.is_some()),
            Action::Opponents => page.is_some_and(|page| page.has_opponents),
            _ => true,
        };
        KEYS.into_iter().filter(is_there).collect()
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        let page = look.company.lesson.as_ref();
        match action {
            Action::ToMenu => return Outcome::close_with(vec![Effect::Do(Action::LeaveRun)]),
            Action::StayInRun | Action::Close => return Outcome::close(),
            Action::ReportOfRun => return self.written(),
            Action::Opponents => return Outcome::with(vec![Effect::ShowOpponents]),
            Action::TryAgain => {
                return Outcome::with(
                    page.map(|page| Effect::TryStepAgain(step_to_try(page))).into_iter().collect(),
                );
            }
            Action::NextPart => {
                if let Some(part) = page.and_then(|page| page.next_part) {
                    return begin_part(part);
                }
                let text = "this was the last part of the lesson".to_owned();
                return Outcome::with(vec![Effect::Complain(text)]);
            }
            other => {
                self.scroll.act(other, look.page as usize);
            }
        }
        Outcome::stay()
    }

    fn take_debrief(&mut self, found: &Arc<Result<Debrief, Refusal>>) {
        self.found = Some(found.clone());
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let own = centered(area, WIDEST.min(area.width), 50.min(area.height));
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, "Debrief", "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        canvas.pane_keys(own, &look.hints(&self.hints_here(look)));
        let debrief = match self.found.as_ref().map(|found| found.as_ref().as_ref()) {
            None => return canvas.text(inside, "simulating the good and the bad play …", Role::Warning),
            Some(Err(refusal)) => return canvas.text(inside, &refusal.message, Role::Bad),
            Some(Ok(debrief)) => debrief,
        };
        let beside = inside.width >= BESIDE.0 && inside.height >= BESIDE.1;
        let (words, curves) = if beside {
            let left = inside.width * 11 / 20;
            let right = Rect { x: inside.x + left + 2, width: inside.width - left - 2, ..inside };
            (Rect { width: left, ..inside }, right)
        } else {
            let above = (inside.height * 2 / 5).max(4).min(inside.height);
            let below = Rect { y: inside.y + above, height: inside.height - above, ..inside };
            (below, Rect { height: above, ..inside })
        };
        draw_curves(canvas, curves, debrief);
        let lines = lines_of(debrief, words.width as usize);
        let last = lines.len().saturating_sub(words.height as usize);
        let from = self.scroll.within(last);
        canvas.page = words.height.max(1);
        draw_lines(canvas, words, &lines, from);
        if from < last {
            let key = look.keys.label(Action::Down).unwrap_or_default();
            let more = format!(" {key}: {} more ", count((last - from) as u32, "line"));
            let above = Rect { x: own.x + 2, width: own.width.saturating_sub(4), height: 1, ..own };
            canvas.aligned(above, &more, Role::Key, Align::Right);
        }
    }
}

fn lines_of(debrief: &Debrief, width: usize) -> Vec<(String, Role)> {
    let said = headline(debrief);
    let paragraphs = in_words(debrief).into_iter().enumerate().flat_map(|(at, text)| {
        let role = match at {
            0 => Role::Title,
            _ if text == said => Role::Strong,
            _ => Role::Text,
        };
        let lines = if text.is_empty() { vec![String::new()] } else { wrapped(&text, width) };
        lines.into_iter().map(move |line| (line, role))
    });
    paragraphs.collect()
}

/// Draws the curves of the figure that decides the part.
fn draw_curves(canvas: &mut Canvas<'_>, area: Rect, debrief: &Debrief) {
    let Some(judged) = &debrief.judged_by else { return draw_cash(canvas, area, debrief) };
    let curve = |values: &[(u32, f64)], role, name| {
        let decided = values.iter().filter(|(day, _)| *day >= debrief.first_day);
        Line::through(decided.map(|(day, value)| (f64::from(*day), *value)).collect(), role).named(name)
    };
    let mut lines = Vec::new();
    lines.extend(judged.bad.as_ref().map(|own| curve(own, Role::Series(1), "bad play")));
    lines.extend(judged.good.as_ref().map(|own| curve(own, Role::Series(2), "good play")));
    lines.push(curve(&judged.own, Role::Series(0), "you"));
    let unit = match judged.figure.unit() {
        FigureUnit::Dollars => Unit::Dollars,
        _ => Unit::Number,
    };
    draw_days(canvas, area, &lines, unit);
}

fn draw_days(canvas: &mut Canvas<'_>, area: Rect, lines: &[Line], unit: Unit) {
    let write = |day: f64| format!("day {day:.0}");
    chart(canvas, area, lines, &Axis { write: &write, holds: &[] }, &Side { unit, holds: &[] });
}

fn draw_cash(canvas: &mut Canvas<'_>, area: Rect, debrief: &Debrief) {
    let from = debrief.first_day as usize;
    let curve = |cash: &[f64], role, name| {
        let points = cash.iter().enumerate().skip(from).map(|(day, cash)| (day as f64, *cash)).collect();
        Line::through(points, role).named(name)
    };
    let mut lines = Vec::new();
    lines.extend(debrief.bad.as_ref().map(|own| curve(&own.cash_by_day, Role::Series(1), "bad play")));
    lines.extend(debrief.good.as_ref().map(|own| curve(&own.cash_by_day, Role::Series(2), "good play")));
    lines.push(curve(&debrief.own, Role::Series(0), "you"));
    draw_days(canvas, area, &lines, Unit::Dollars);
}
