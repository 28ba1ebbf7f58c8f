//! Forecasts and outcomes: a curve with the 95 % intervals, and a table.

use ratatui::layout::{Constraint, Layout, Rect};
use unicode_width::UnicodeWidthStr;

use super::Cash;
use crate::action::Action;
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::{percent, short_dollars};
use novamind_session::{ScoredForecast, Verdict, filed_forecasts};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::note_room;
use novamind_tui::widgets::{Axis, Band, Cell, Column, Line, Plot, Side, Table, Unit};
use novamind_worker::company::Company;

pub struct ForecastsPane;

impl Pane<Cash> for ForecastsPane {
    fn hints(&self, _: &Cash) -> Vec<Action> {
        vec![Action::Left, Action::Right, Action::Open]
    }

    fn figure(&self, cash: &Cash, _: &Look<'_>) -> Option<Figure> {
        cash.outlook.figure()
    }

    fn act(&self, cash: &mut Cash, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return vec![Effect::Do(Action::Journal)];
        }
        cash.outlook.act(action, look.page);
        Vec::new()
    }

    fn click(&self, cash: &mut Cash, row: usize, _: &Look<'_>) -> Vec<Effect> {
        cash.outlook.table.select_place(row);
        Vec::new()
    }

    fn border(&self, cash: &Cash, area: Rect, look: &Look<'_>) -> Border {
        let label = |action| look.keys.label(action).unwrap_or_default();
        let horizons = format!("{} {} other horizons", label(Action::Left), label(Action::Right));
        let weeks = cash.outlook.horizon() / 7;
        let title = format!("Forecasts {weeks} week{} ahead", if weeks == 1 { "" } else { "s" });
        // Do not show a figure that is cut off.
        let room = note_room(area, &title);
        let scores = cash.outlook.scores(look.company);
        let note = scores.into_iter().find(|note| note.width() <= room).unwrap_or_default();
        Border {
            title,
            note,
            keys: format!("{horizons} · {} journal", label(Action::Open)),
            ..Border::default()
        }
    }

    fn draw(&self, cash: &Cash, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let (outlook, inside) = (&cash.outlook, seat.area);
        if outlook.all.is_empty() {
            let text = format!(
                "No forecasts yet. You file four before each week ({}).",
                look.hint(Action::NextWeek)
            );
            canvas.text(inside, &text, Role::Dim);
            return;
        }
        let list = if inside.height >= 13 { (inside.height / 3).max(5) } else { inside.height };
        let [above, below] = Layout::vertical([Constraint::Min(0), Constraint::Length(list)]).areas(inside);
        outlook.draw_curve(canvas, above, look.company);
        outlook.table.draw(canvas, below, seat.focused, seat.number);
    }
}

#[derive(Default)]
pub struct Outlook {
    all: Vec<ScoredForecast>,
    horizons: Vec<u32>,
    horizon: usize,
    table: Table,
}

impl Outlook {
    pub fn renew(&mut self, company: &Company) {
        self.all = filed_forecasts(&company.journal, &company.cash_by_day);
        self.horizons = company.scores.iter().map(|score| score.horizon_days).collect();
        self.refresh();
    }

    fn horizon(&self) -> u32 {
        self.horizons.get(self.horizon).copied().unwrap_or(7)
    }

    /// Returns the forecasts of the shown horizon, in order of filing.
    fn shown(&self) -> impl DoubleEndedIterator<Item = &ScoredForecast> {
        let horizon = self.horizon();
        self.all.iter().filter(move |filed| filed.forecast.horizon_days == horizon)
    }

    fn refresh(&mut self) {
        let columns = vec![
            Column::numbers("day"),
            Column::numbers("low"),
            Column::numbers("point"),
            Column::numbers("high"),
            Column::numbers("actual"),
            Column::numbers("error"),
            Column::words("95 %"),
        ];
        let rows = self.listed().map(row_of).collect();
        self.table.set(columns, rows);
    }

    fn act(&mut self, action: Action, page: u16) {
        let last = self.horizons.len().saturating_sub(1);
        match action {
            Action::Left => self.horizon = self.horizon.saturating_sub(1),
            Action::Right => self.horizon = (self.horizon + 1).min(last),
            Action::Sort | Action::Filter => return,
            action => {
                self.table.act(action, page);
                return;
            }
        }
        self.refresh();
        self.table.act(Action::First, page);
    }

    /// Returns the forecasts in table order: due forecasts, newest first, then open ones.
    fn listed(&self) -> impl Iterator<Item = &ScoredForecast> {
        let known = self.shown().filter(|one| one.outcome.is_some()).rev();
        known.chain(self.shown().filter(|one| one.outcome.is_none()))
    }

    /// Returns the selected forecast, with a query for its rows.
    fn figure(&self) -> Option<Figure> {
        let filed = self.listed().nth(self.table.selected()?)?;
        let sql = format!(
            "SELECT p.*, (SELECT sum(amount) FROM ledger WHERE day <= p.submit_day + p.horizon_days) AS cash\n\
             FROM predictions p\nWHERE submit_day = {} AND horizon_days = {}",
            filed.day, filed.forecast.horizon_days
        );
        let title = format!("forecast of day {} for day {}", filed.day, filed.due());
        Some(Figure { title, term: "forecast", sql: Some(sql), why: None })
    }

    /// Returns the results of the horizon, longest wording first.
    fn scores(&self, company: &Company) -> Vec<String> {
        match company.scores.get(self.horizon).filter(|score| score.scored > 0) {
            Some(score) if !company.shows_calibration() => vec![format!("{} came due", score.scored)],
            Some(score) => {
                let (inside, miss) =
                    (format!("{} of {} inside", score.covered, score.scored), percent(score.mean_error, 1));
                vec![format!("{inside} · mean error {miss}"), format!("{inside} · error {miss}"), inside]
            }
            None => vec!["none due yet".to_owned()],
        }
    }

    fn draw_curve(&self, canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
        // Open forecasts of long horizons would compress the past.
        let until = f64::from(company.seen.day) * 1.15 + 14.0;
        let near = || self.shown().filter(|filed| f64::from(filed.due()) <= until);
        let day = |filed: &ScoredForecast| f64::from(filed.due());
        let band = Band {
            ends: near().map(|filed| (day(filed), filed.forecast.lower, filed.forecast.upper)).collect(),
            name: "95 %",
        };
        let points = near().map(|filed| (day(filed), filed.forecast.point)).collect();
        let cash: Vec<(f64, f64)> =
            company.cash_by_day.iter().enumerate().map(|(day, cash)| (day as f64, *cash)).collect();
        let lines = [
            Line { scattered: true, ..Line::through(points, Role::Series(1)).named("expected") },
            Line::through(cash, Role::Series(0)).named("cash"),
        ];
        let plot = Plot {
            lines: &lines,
            band: Some(&band),
            mark: None,
            x: &Axis { write: &|day| format!("day {day:.0}"), holds: &[0.0] },
            y: &Side { unit: Unit::Dollars, holds: &[] },
        };
        plot.draw(canvas, area);
    }
}

fn row_of(filed: &ScoredForecast) -> Vec<Cell> {
    let amount = |value: f64| Cell::number(value, short_dollars(value));
    let (outcome, miss) = match (filed.outcome, filed.error(), filed.miss_in_words()) {
        (Some(outcome), Some(miss), Some(shown)) => {
            (amount(outcome).role(Role::Strong), Cell::number(miss, shown))
        }
        _ => (Cell::words("–").role(Role::Dim), Cell::words("–").role(Role::Dim)),
    };
    let verdict = match filed.verdict() {
        Some(Verdict::Inside) => Cell::words("inside").role(Role::Good),
        Some(Verdict::Above) => Cell::words("▲ above").role(Role::Bad),
        Some(Verdict::Below) => Cell::words("▼ below").role(Role::Bad),
        None => Cell::words("open").role(Role::Dim),
    };
    vec![
        Cell::number(f64::from(filed.due()), filed.due().to_string()),
        amount(filed.forecast.lower).role(Role::Dim),
        amount(filed.forecast.point),
        amount(filed.forecast.upper).role(Role::Dim),
        outcome,
        miss,
        verdict,
    ]
}
