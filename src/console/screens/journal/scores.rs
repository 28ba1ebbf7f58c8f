//! Forecast results: by horizon, and individually for the selected horizon.

use ratatui::layout::Rect;

use super::{Journal, JournalPane};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::{percent, short_dollars};
use novamind_session::{ForecastScore, ScoredForecast, filed_forecasts};
use novamind_tui::canvas::{Canvas, Click, rows_of};
use novamind_tui::theme::Role;
use novamind_worker::company::Company;

/// Returns the forecasts of a horizon that are due, newest first.
pub fn outcomes(company: &Company, horizon: u32) -> Vec<ScoredForecast> {
    let mut all = filed_forecasts(&company.journal, &company.cash_by_day);
    all.retain(|filed| filed.forecast.horizon_days == horizon && filed.outcome.is_some());
    all.reverse();
    all
}

pub fn figure(company: &Company, selected: usize) -> Option<Figure> {
    let horizon = company.scores.get(selected)?.horizon_days;
    Some(Figure {
        title: format!("forecasts {} ahead that came due", weeks(horizon)),
        term: "coverage",
        sql: Some(format!(
            "SELECT submit_day, submit_day + horizon_days AS due_day, predicted_lower, predicted_value,\n    \
             predicted_upper\nFROM predictions WHERE horizon_days = {horizon} AND submit_day + horizon_days <= {}\n\
             ORDER BY submit_day DESC",
            company.seen.day
        )),
        why: None,
    })
}

fn weeks(days: u32) -> String {
    format!("{} {}", days / 7, if days == 7 { "week" } else { "weeks" })
}

/// A line per horizon, and the individual forecasts of the selected one.
pub struct ScoresPane;

impl Pane<Journal> for ScoresPane {
    fn scopes(&self, _: &Journal) -> Vec<Scope> {
        vec![Scope::List, Scope::Memo]
    }

    fn hints(&self, _: &Journal) -> Vec<Action> {
        vec![Action::Up, Action::Down, Action::Close]
    }

    fn figure(&self, journal: &Journal, look: &Look<'_>) -> Option<Figure> {
        figure(look.company, journal.horizon)
    }

    fn act(&self, journal: &mut Journal, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let last = look.company.scores.len().saturating_sub(1);
        match action {
            Action::Close => journal.focus = JournalPane::List,
            Action::Up | Action::First => journal.horizon = journal.horizon.saturating_sub(1),
            Action::Down | Action::Last => journal.horizon = (journal.horizon + 1).min(last),
            _ => {}
        }
        Vec::new()
    }

    fn click(&self, journal: &mut Journal, row: usize, look: &Look<'_>) -> Vec<Effect> {
        journal.horizon = row.min(look.company.scores.len().saturating_sub(1));
        Vec::new()
    }

    fn border(&self, _: &Journal, _: Rect, look: &Look<'_>) -> Border {
        let note = if look.company.shows_calibration() { "95 % coverage" } else { "" };
        Border { title: "Forecasts".to_owned(), note: note.to_owned(), ..Border::default() }
    }

    fn draw(&self, journal: &Journal, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let company = look.company;
        let summary = company.shows_calibration();
        let head = match summary {
            true => format!("{:<9}{:>10}{:>8}{:>8}", "", "inside", "error", "width"),
            false => format!("{:<9}{:>10}", "", "came due"),
        };
        let mut rows = rows_of(seat.area);
        if let Some(row) = rows.next() {
            canvas.text(row, &head, Role::Header);
        }
        for ((at, score), row) in company.scores.iter().enumerate().zip(rows.by_ref()) {
            let own = if summary { role_of(score) } else { Role::Text };
            let role = if seat.focused && at == journal.horizon { Role::Selection } else { own };
            let counted = || format!("{:<9}{:>10}", weeks(score.horizon_days), score.scored);
            canvas.clear(row, role);
            canvas.text(row, &if summary { line_of(score) } else { counted() }, role);
            canvas.click(row, Click::Row(seat.number, at));
        }
        if let Some(row) = rows.next() {
            let none = company.scores.iter().all(|score| score.scored == 0);
            let text = match (none, summary) {
                (true, _) => "no forecast is due yet",
                (false, true) => "error, width: share of cash",
                (false, false) => "error: share of cash",
            };
            canvas.text(row, text, Role::Dim);
        }
        let Some(score) = company.scores.get(journal.horizon) else { return };
        let single = outcomes(company, score.horizon_days);
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
                weeks(score.horizon_days)
            );
            canvas.text(row, &head, Role::Header);
        }
        for (row, outcome) in rows.zip(single) {
            let role = if outcome.is_inside() { Role::Text } else { Role::Warning };
            canvas.text(row, &line_of_outcome(&outcome), role);
        }
    }
}

fn line_of_outcome(filed: &ScoredForecast) -> String {
    let miss = filed.miss_in_words().unwrap_or("–".to_owned());
    format!(
        "day {:<5}{:>8}{:>8}{miss:>12} {}",
        filed.due(),
        short_dollars(filed.forecast.point),
        filed.outcome.map_or("–".to_owned(), short_dollars),
        if filed.is_inside() { "inside" } else { "OUTSIDE" }
    )
}

/// Limits the shown error, because near zero cash any error is a large share.
fn limited(share: f64) -> String {
    if share < 10.0 { percent(share, 1) } else { "> 999%".to_owned() }
}

fn line_of(score: &ForecastScore) -> String {
    let horizon = weeks(score.horizon_days);
    if score.scored == 0 {
        return format!("{horizon:<9}{:>10}{:>8}{:>8}", "–", "–", "–");
    }
    let inside = format!("{} of {}", score.covered, score.scored);
    format!("{horizon:<9}{inside:>10}{:>8}{:>8}", limited(score.mean_error), limited(score.mean_sharpness))
}

/// Warns about low coverage if there are at least four forecasts.
fn role_of(score: &ForecastScore) -> Role {
    match score.scored {
        0 => Role::Dim,
        scored if scored >= 4 && f64::from(score.covered) < 0.8 * f64::from(scored) => Role::Warning,
        _ => Role::Text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::played;

    #[test]
    fn single_forecasts_make_up_the_score_of_their_horizon_and_the_rows_of_the_database() {
        let mut session = played(9);
        let company = Company::of(&session);
        for (at, score) in company.scores.iter().enumerate() {
            let single = outcomes(&company, score.horizon_days);
            let inside = single.iter().filter(|outcome| outcome.is_inside()).count();
            assert_eq!((single.len() as u32, inside as u32), (score.scored, score.covered));
            let errors: f64 = single.iter().filter_map(ScoredForecast::error).map(f64::abs).sum();
            assert!((errors / single.len().max(1) as f64 - score.mean_error).abs() < 1e-9);
            let sql = figure(&company, at).and_then(|figure| figure.sql).expect("rows");
            assert_eq!(session.query(&sql).expect("rows").rows.len(), single.len());
        }
        assert!(company.scores[0].scored >= 8);
        assert_eq!(figure(&company, 9), None);
    }
}
