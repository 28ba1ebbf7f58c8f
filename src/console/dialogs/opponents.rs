//! Comparison of a finished run with strong policies on the same scenario and seed.

use ratatui::layout::Rect;
use ratatui::text::Line as TextLine;

use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use novamind_base::formatting::dollars;
use novamind_record::trajectory::record::RunEndReason;
use novamind_report::opponents::{OpponentResult, OpponentResults, PlayOpponentsFn};
use novamind_tools::Rejection;
use novamind_tui::canvas::{Canvas, centered_rect};
use novamind_tui::text::{first_fitting, wrap};
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::page_questions::OpponentsQuestion;
use novamind_worker::question::{OutgoingQuestion, Pending};

const PAGE_SIZE: (u16, u16) = (96, 16);
/// Width of the mark, the name and the score before the bars, in columns.
const NAME_COLUMNS: usize = 38;

/// The page that ranks a finished run among opponents.
#[derive(Default)]
pub struct OpponentsPage {
    result: Option<Result<OpponentResults, Rejection>>,
    asked: Pending<OpponentsQuestion>,
}

impl OpponentsPage {
    /// Requests the results of the opponents, which `play` simulates.
    pub fn new(play: PlayOpponentsFn) -> (OpponentsPage, OutgoingQuestion) {
        let (pending, ask) = Pending::with_question(OpponentsQuestion(play));
        (OpponentsPage { result: None, asked: pending }, ask)
    }
}

impl Dialog for OpponentsPage {
    fn record_name(&self) -> String {
        "opponents".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Dialog, Scope::List]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Cancel]
    }

    fn handle_action(&mut self, action: Action, _: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::Cancel | Action::Close | Action::Open => DialogResponse::close(),
            _ => DialogResponse::stay(),
        }
    }

    fn take_answers(&mut self) {
        if let Some((_, found)) = self.asked.try_take() {
            self.result = Some(found);
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let dialog_area = centered_rect(area, PAGE_SIZE.0.min(area.width), PAGE_SIZE.1.min(area.height));
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, "Opponents", "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        canvas.draw_pane_keys(dialog_area, &context.hints(&self.hints()));
        let width = inside.width as usize;
        let (role, text) = match &self.result {
            None => (Role::Warning, "simulating the strong policies from day 0 …".to_owned()),
            Some(Err(rejection)) => (Role::Bad, rejection.message.clone()),
            Some(Ok(opponents)) => (Role::Dim, opponents.describe()),
        };
        let mut lines: Vec<TextLine<'_>> =
            wrap(&text, width).into_iter().map(|line| TextLine::from(canvas.span(line, role))).collect();
        if let Some(Ok(opponents)) = &self.result {
            lines.push(TextLine::default());
            lines.extend(rank_results(canvas, context.company, opponents, width));
        }
        canvas.draw_lines(inside, &lines);
    }
}

/// Ranks the policies, and the run if the run has a score.
fn rank_results<'a>(
    canvas: &Canvas<'_>,
    company: &DisplayedCompany,
    opponents: &OpponentResults,
    width: usize,
) -> Vec<TextLine<'a>> {
    let seen = &company.observation;
    let player_result = match seen.ended {
        Some(RunEndReason::Bankruptcy) => Some((0.0, format!("bankrupt on day {}", seen.day))),
        Some(RunEndReason::Horizon | RunEndReason::Lesson) => Some((seen.cash, dollars(seen.cash))),
        Some(RunEndReason::Abandoned) | None => None,
    };
    let policy = |one: &OpponentResult| (one.policy.clone(), one.score(), one.describe(), false);
    let mut rows: Vec<_> = opponents.policies.iter().map(policy).collect();
    if let Some((score, result_text)) = player_result {
        rows.insert(opponents.count_ahead_of(score), ("You".to_owned(), score, result_text, true));
    }
    let max = rows.iter().map(|row| row.1).fold(1.0, f64::max);
    let room = width.saturating_sub(NAME_COLUMNS) as f64;
    let line = |(name, score, result_text, is_own): (String, f64, String, bool)| {
        let role = if is_own { Role::Good } else { Role::Text };
        let bar = "█".repeat((score.max(0.0) / max * room).round() as usize);
        let mark = if is_own { "▌ " } else { "  " };
        let result_text = first_fitting([result_text], width.saturating_sub(22));
        TextLine::from(vec![
            canvas.span(format!("{mark}{name:<20}"), role),
            canvas.span(format!("{result_text:>14}  "), role),
            canvas.span(bar, if is_own { Role::Good } else { Role::Series(0) }),
        ])
    };
    rows.into_iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dialogs::dialog_text;
    use novamind_report::test_kit;

    fn page(found: Result<OpponentResults, Rejection>) -> OpponentsPage {
        OpponentsPage { result: Some(found), ..OpponentsPage::default() }
    }

    fn opponent(policy: &str, cash: f64, is_bankrupt: bool) -> OpponentResult {
        OpponentResult { policy: policy.to_owned(), day: 35, cash, is_bankrupt, stopped: None }
    }

    #[test]
    fn run_is_ranked_among_its_opponents() {
        let company = DisplayedCompany::from_session(&test_kit::finished_run());
        let value = company.observation.cash;
        let policies = vec![
            opponent("ads-first", value * 2.0, false),
            opponent("baseline", value / 2.0, false),
            opponent("harvest-late", -12.0, true),
        ];
        let page = page(Ok(OpponentResults { day: 35, policies }));
        for (width, height) in [(60, 14), (80, 22), (120, 38)] {
            let text = dialog_text(&page, &company, width, height);
            let at = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part} is missing:\n{text}"));
            assert!(at("ads-first") < at("▌ You") && at("▌ You") < at("baseline"), "{text}");
            assert!(at(&dollars(value)) > 0 && at("bankrupt on day 35") > at("harvest-late"), "{text}");
        }
    }

    #[test]
    fn waiting_and_rejection_are_drawn_at_every_size() {
        let company = DisplayedCompany::from_session(&test_kit::bankrupt_run());
        let waits = OpponentsPage::default();
        assert!(dialog_text(&waits, &company, 60, 14).contains("simulating the strong policies"));
        let refused = page(Err(Rejection::new("not_possible", "parameters were set")));
        assert!(dialog_text(&refused, &company, 60, 14).contains("parameters were set"));
        for (width, height) in
            (0..130).step_by(26).flat_map(|width| (0..44).step_by(8).map(move |height| (width, height)))
        {
            dialog_text(&waits, &company, width, height);
            dialog_text(&refused, &company, width, height);
        }
    }
}
