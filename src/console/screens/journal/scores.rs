//! Forecast scores by horizon, and individual forecasts of the selected horizon.

use ratatui::layout::Rect;

use super::{Journal, JournalPane};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{percent, short_dollars};
use novamind_session::{ForecastScore, ScoredForecast, submitted_forecasts};
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;

/// Returns the due forecasts with a horizon, the newest first.
pub fn due_forecasts(company: &DisplayedCompany, horizon: u32) -> Vec<ScoredForecast> {
    let mut all = submitted_forecasts(&company.journal, &company.weeks);
    all.retain(|filed| filed.forecast.horizon_days == horizon && filed.outcome.is_some());
    all.reverse();
    all
}

pub fn figure(company: &DisplayedCompany, selected: usize) -> Option<Figure> {
    let horizon = company.forecast_scores.get(selected)?.horizon_days;
    Some(Figure {
        title: format!("forecasts {} ahead that came due", format_weeks(horizon)),
        term: "coverage",
        sql: Some(format!(
            "SELECT submit_day, submit_day + horizon_days AS due_day, predicted_lower, predicted_value,\n    \
             predicted_upper\nFROM predictions WHERE horizon_days = {horizon} AND submit_day + horizon_days <= {}\n\
             ORDER BY submit_day DESC",
            company.observation.day
        )),
        week_quantity: None,
    })
}

fn format_weeks(days: u32) -> String {
    format!("{} {}", days / 7, if days == 7 { "week" } else { "weeks" })
}

/// Pane with one line per horizon and the individual forecasts of the selected horizon.
pub struct ScoresPane;

impl Pane<Journal> for ScoresPane {
    fn scopes(&self, _: &Journal) -> Vec<Scope> {
        vec![Scope::List, Scope::Notes]
    }

    fn hints(&self, _: &Journal) -> Vec<Action> {
        vec![Action::Up, Action::Down, Action::Close]
    }

    fn figure(&self, journal: &Journal, context: &ScreenContext<'_>) -> Option<Figure> {
        figure(context.company, journal.horizon)
    }

    fn handle_action(&self, journal: &mut Journal, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let last = context.company.forecast_scores.len().saturating_sub(1);
        match action {
            Action::Close => journal.focus = JournalPane::List,
            Action::Up | Action::First => journal.horizon = journal.horizon.saturating_sub(1),
            Action::Down | Action::Last => journal.horizon = (journal.horizon + 1).min(last),
            _ => {}
        }
        Vec::new()
    }

    fn handle_click(&self, journal: &mut Journal, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        journal.horizon = row.min(context.company.forecast_scores.len().saturating_sub(1));
        Vec::new()
    }

    fn border(&self, _: &Journal, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let note = match context.company.can_show_forecast_scores() {
            true => coverage_text(&context.company.forecast_scores),
            false => String::new(),
        };
        PaneBorder { title: "Forecasts".to_owned(), note, ..PaneBorder::default() }
    }

    fn draw(&self, journal: &Journal, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let company = context.company;
        let summary = company.can_show_forecast_scores();
        let head = match summary {
            true => format!("{:<9}{:>10}{:>8}{:>8}", "", "inside", "error", "width"),
            false => format!("{:<9}{:>10}", "", "came due"),
        };
        let mut rows = row_rects(placement.area);
        if let Some(row) = rows.next() {
            canvas.draw_text(row, &head, Role::Header);
        }
        for ((at, score), row) in company.forecast_scores.iter().enumerate().zip(rows.by_ref()) {
            let usual_role = if summary { score_role(score) } else { Role::Text };
            let role = if placement.focused && at == journal.horizon { Role::Selection } else { usual_role };
            let counted = || format!("{:<9}{:>10}", format_weeks(score.horizon_days), score.scored);
            canvas.clear(row, role);
            canvas.draw_text(row, &if summary { score_line(score) } else { counted() }, role);
            canvas.register_click(row, Click::Row(placement.index, at));
        }
        if let Some(row) = rows.next() {
            let none = company.forecast_scores.iter().all(|score| score.scored == 0);
            let text = match (none, summary) {
                (true, _) => "no forecast is due yet",
                (false, true) => "error and width as shares of cash",
                (false, false) => "error as a share of cash",
            };
            canvas.draw_text(row, text, Role::Dim);
        }
        let Some(score) = company.forecast_scores.get(journal.horizon) else { return };
        let single = due_forecasts(company, score.horizon_days);
        if single.is_empty() {
            return;
        }
        if let Some(row) = rows.next() {
            let head = format!(
                "{:<9}{:>8}{:>8}{:>12} {}",
                "due",
                "point",
                "actual",
                "error",
                format_weeks(score.horizon_days)
            );
            canvas.draw_text(row, &head, Role::Header);
        }
        for (row, outcome) in rows.zip(single) {
            let role = if outcome.is_covered() { Role::Text } else { Role::Warning };
            canvas.draw_text(row, &forecast_line(&outcome), role);
        }
    }
}

/// Describes the measured coverage of all horizons and the intended one: `coverage 90% · aim 95%`.
fn coverage_text(scores: &[ForecastScore]) -> String {
    let (covered, scored) =
        scores.iter().fold((0, 0), |(covered, scored), score| (covered + score.covered, scored + score.scored));
    match scored {
        0 => "aim: 95% coverage".to_owned(),
        scored => format!("coverage {} · aim 95%", percent(f64::from(covered) / f64::from(scored), 0)),
    }
}

fn forecast_line(filed: &ScoredForecast) -> String {
    let miss = filed.describe_error().unwrap_or("–".to_owned());
    format!(
        "day {:<5}{:>8}{:>8}{miss:>12} {}",
        filed.due_day(),
        short_dollars(filed.forecast.point),
        filed.outcome.map_or("–".to_owned(), short_dollars),
        if filed.is_covered() { "inside" } else { "OUTSIDE" }
    )
}

/// Formats an error with an upper limit, because any error is a large share of cash that is near zero.
fn capped_percent(share: f64) -> String {
    if share < 10.0 { percent(share, 1) } else { "> 999%".to_owned() }
}

fn score_line(score: &ForecastScore) -> String {
    let horizon = format_weeks(score.horizon_days);
    if score.scored == 0 {
        return format!("{horizon:<9}{:>10}{:>8}{:>8}", "–", "–", "–");
    }
    let inside = format!("{} of {}", score.covered, score.scored);
    format!("{horizon:<9}{inside:>10}{:>8}{:>8}", capped_percent(score.mean_error), capped_percent(score.mean_sharpness))
}

/// Returns the warning role if the coverage is low and at least four forecasts are scored.
fn score_role(score: &ForecastScore) -> Role {
    match score.scored {
        0 => Role::Dim,
        scored if scored >= 4 && f64::from(score.covered) < 0.8 * f64::from(scored) => Role::Warning,
        _ => Role::Text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::played_session;

    #[test]
    fn horizon_scores_equal_their_forecasts_and_database_rows() {
        let mut session = played_session(9);
        let company = DisplayedCompany::from_session(&session);
        for (at, score) in company.forecast_scores.iter().enumerate() {
            let single = due_forecasts(&company, score.horizon_days);
            let inside = single.iter().filter(|outcome| outcome.is_covered()).count();
            assert_eq!((single.len() as u32, inside as u32), (score.scored, score.covered));
            let errors: f64 = single.iter().filter_map(ScoredForecast::relative_error).map(f64::abs).sum();
            assert!((errors / single.len().max(1) as f64 - score.mean_error).abs() < 1e-9);
            let sql = figure(&company, at).and_then(|figure| figure.sql).expect("rows");
            assert_eq!(session.query(&sql).expect("rows").rows.len(), single.len());
        }
        let scores = &company.forecast_scores;
        let covered: u32 = scores.iter().map(|score| score.covered).sum();
        let scored: u32 = scores.iter().map(|score| score.scored).sum();
        let share = percent(f64::from(covered) / f64::from(scored), 0);
        assert_eq!(coverage_text(scores), format!("coverage {share} · aim 95%"));
        assert_eq!(coverage_text(&[]), "aim: 95% coverage");
        assert!(company.forecast_scores[0].scored >= 8);
        assert_eq!(figure(&company, 9), None);
    }
}
