//! Forecasts and outcomes: a curve with the 95 % intervals, and a table.

use ratatui::layout::{Constraint, Layout, Rect};
use unicode_width::UnicodeWidthStr;

use super::Cash;
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{percent, short_dollars};
use novamind_session::{ScoredForecast, IntervalPosition, submitted_forecasts};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::note_width;
use novamind_tui::widgets::{XAxis, Band, TableCell, TableColumn, Curve, Plot, YAxis, Table, AxisUnit};
use novamind_worker::company::DisplayedCompany;

pub struct ForecastsPane;

impl Pane<Cash> for ForecastsPane {
    fn hints(&self, _: &Cash) -> Vec<Action> {
        vec![Action::Left, Action::Right, Action::Open]
    }

    fn figure(&self, cash: &Cash, _: &ScreenContext<'_>) -> Option<Figure> {
        cash.forecasts.figure()
    }

    fn handle_action(&self, cash: &mut Cash, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return vec![Effect::Execute(Action::Journal)];
        }
        cash.forecasts.handle_action(action, context.page_rows);
        Vec::new()
    }

    fn handle_click(&self, cash: &mut Cash, row: usize, _: &ScreenContext<'_>) -> Vec<Effect> {
        cash.forecasts.table.select_visible_row(row);
        Vec::new()
    }

    fn border(&self, cash: &Cash, area: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let label = |action| context.keys.label(action).unwrap_or_default();
        let horizons = format!("{} {} other horizons", label(Action::Left), label(Action::Right));
        let weeks = cash.forecasts.horizon() / 7;
        let title = format!("Forecasts {weeks} week{} ahead", if weeks == 1 { "" } else { "s" });
        // Only a note that fits completely is shown.
        let room = note_width(area, &title);
        let scores = cash.forecasts.score_texts(context.company);
        let note = scores.into_iter().find(|note| note.width() <= room).unwrap_or_default();
        PaneBorder {
            title,
            note,
            keys: format!("{horizons} · {} journal", label(Action::Open)),
            ..PaneBorder::default()
        }
    }

    fn draw(&self, cash: &Cash, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let (outlook, inside) = (&cash.forecasts, placement.area);
        if outlook.forecasts.is_empty() {
            let text = format!(
                "No forecasts yet. You make them before each week ({}).",
                context.hint(Action::NextWeek)
            );
            canvas.draw_text(inside, &text, Role::Dim);
            return;
        }
        let list = if inside.height >= 13 { (inside.height / 3).max(5) } else { inside.height };
        let [above, below] = Layout::vertical([Constraint::Min(0), Constraint::Length(list)]).areas(inside);
        outlook.draw_curve(canvas, above, context.company);
        outlook.table.draw(canvas, below, placement.focused, placement.index);
    }
}

#[derive(Default)]
pub struct ForecastsState {
    forecasts: Vec<ScoredForecast>,
    horizons: Vec<u32>,
    horizon: usize,
    table: Table,
}

impl ForecastsState {
    pub fn update(&mut self, company: &DisplayedCompany) {
        self.forecasts = submitted_forecasts(&company.journal, &company.weeks);
        self.horizons = company.forecast_scores.iter().map(|score| score.horizon_days).collect();
        self.rebuild_table();
    }

    fn horizon(&self) -> u32 {
        self.horizons.get(self.horizon).copied().unwrap_or(7)
    }

    /// Returns the forecasts with the displayed horizon, in the order of submission.
    fn forecasts_of_horizon(&self) -> impl DoubleEndedIterator<Item = &ScoredForecast> {
        let horizon = self.horizon();
        self.forecasts.iter().filter(move |filed| filed.forecast.horizon_days == horizon)
    }

    fn rebuild_table(&mut self) {
        let columns = vec![
            TableColumn::numeric("day"),
            TableColumn::numeric("low"),
            TableColumn::numeric("point"),
            TableColumn::numeric("high"),
            TableColumn::numeric("actual"),
            TableColumn::numeric("error"),
            TableColumn::text("95 %"),
        ];
        let rows = self.forecasts_in_table_order().map(forecast_row).collect();
        self.table.set_columns_and_rows(columns, rows);
    }

    fn handle_action(&mut self, action: Action, page: u16) {
        let last = self.horizons.len().saturating_sub(1);
        match action {
            Action::Left => self.horizon = self.horizon.saturating_sub(1),
            Action::Right => self.horizon = (self.horizon + 1).min(last),
            Action::Sort | Action::Filter => return,
            action => {
                self.table.handle_action(action, page);
                return;
            }
        }
        self.rebuild_table();
        self.table.handle_action(Action::First, page);
    }

    /// Returns the forecasts in table order: due forecasts, the newest first, followed by open forecasts.
    fn forecasts_in_table_order(&self) -> impl Iterator<Item = &ScoredForecast> {
        let known = self.forecasts_of_horizon().filter(|one| one.outcome.is_some()).rev();
        known.chain(self.forecasts_of_horizon().filter(|one| one.outcome.is_none()))
    }

    /// Returns the selected forecast as a figure, with a query for its source rows.
    fn figure(&self) -> Option<Figure> {
        let filed = self.forecasts_in_table_order().nth(self.table.selected()?)?;
        let sql = format!(
            "SELECT p.*, (SELECT sum(amount) FROM ledger WHERE day <= p.submit_day + p.horizon_days) AS cash\n\
             FROM predictions p\nWHERE submit_day = {} AND horizon_days = {}",
            filed.day, filed.forecast.horizon_days
        );
        let title = format!("forecast of day {} for day {}", filed.day, filed.due_day());
        Some(Figure { title, term: "forecast", sql: Some(sql), week_quantity: None })
    }

    /// Returns descriptions of the scores at the displayed horizon, the longest first.
    fn score_texts(&self, company: &DisplayedCompany) -> Vec<String> {
        match company.forecast_scores.get(self.horizon).filter(|score| score.scored > 0) {
            Some(score) if !company.can_show_forecast_scores() => vec![format!("{} came due", score.scored)],
            Some(score) => {
                let (inside, forecast_error) =
                    (format!("{} of {} in range", score.covered, score.scored), percent(score.mean_error, 1));
                vec![format!("{inside} · mean error {forecast_error}"), format!("{inside} · error {forecast_error}"), inside]
            }
            None => vec!["no forecast due".to_owned()],
        }
    }

    fn draw_curve(&self, canvas: &mut Canvas<'_>, area: Rect, company: &DisplayedCompany) {
        // Open forecasts with long horizons are omitted, because they would compress the past.
        let until = f64::from(company.observation.day) * 1.15 + 14.0;
        let near = || self.forecasts_of_horizon().filter(|filed| f64::from(filed.due_day()) <= until);
        let day = |filed: &ScoredForecast| f64::from(filed.due_day());
        let band = Band {
            bounds: near().map(|filed| (day(filed), filed.forecast.lower, filed.forecast.upper)).collect(),
            name: "95 %",
        };
        let points = near().map(|filed| (day(filed), filed.forecast.point)).collect();
        let cash: Vec<(f64, f64)> =
            company.cash_by_day.iter().enumerate().map(|(day, cash)| (day as f64, *cash)).collect();
        let lines = [
            Curve { is_scatter: true, ..Curve::from_points(points, Role::Series(1)).with_name("expected") },
            Curve::from_points(cash, Role::Series(0)).with_name("cash"),
        ];
        let plot = Plot {
            curves: &lines,
            band: Some(&band),
            marked_x: None,
            x: &XAxis { format: &|day| format!("day {day:.0}"), required_values: &[0.0] },
            y: &YAxis { unit: AxisUnit::Dollars, required_values: &[] },
        };
        plot.draw(canvas, area);
    }
}

fn forecast_row(filed: &ScoredForecast) -> Vec<TableCell> {
    let amount = |value: f64| TableCell::from_number(value, short_dollars(value));
    let (outcome, forecast_error) = match (filed.outcome, filed.relative_error(), filed.describe_error()) {
        (Some(outcome), Some(forecast_error), Some(shown)) => {
            (amount(outcome).with_role(Role::Strong), TableCell::from_number(forecast_error, shown))
        }
        _ => (TableCell::from_text("–").with_role(Role::Dim), TableCell::from_text("–").with_role(Role::Dim)),
    };
    let verdict = match filed.interval_position() {
        Some(IntervalPosition::Inside) => TableCell::from_text("inside").with_role(Role::Good),
        Some(IntervalPosition::Above) => TableCell::from_text("▲ above").with_role(Role::Bad),
        Some(IntervalPosition::Below) => TableCell::from_text("▼ below").with_role(Role::Bad),
        None => TableCell::from_text("open").with_role(Role::Dim),
    };
    vec![
        TableCell::from_number(f64::from(filed.due_day()), filed.due_day().to_string()),
        amount(filed.forecast.lower).with_role(Role::Dim),
        amount(filed.forecast.point),
        amount(filed.forecast.upper).with_role(Role::Dim),
        outcome,
        forecast_error,
        verdict,
    ]
}
