//! Income and costs: the ledger by category and week, the change in cash, and forecasts.

mod bars;
mod ledger;
mod curve;
mod forecasts;
mod model;
#[cfg(test)]
mod tests;
mod waterfall;

use ratatui::layout::{Constraint, Layout, Rect};
use strum::VariantArray;

use self::ledger::ledger_table;
use self::forecasts::ForecastsState;
use self::model::{WeeklyLedger, CashStep, LedgerSubject, ledger_query, cash_steps};
use super::ScreenState;
use super::panes::{Pane, PaneScreen, draw_pane, draw_stack};
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use novamind_insight::WeekQuantity;
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::Table;
use novamind_worker::company::DisplayedCompany;

/// Panes of the cash screen in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum CashPane {
    /// Amounts of the selected week by category.
    #[default]
    Ledger,
    /// Income and cost bars of all weeks.
    Weeks,
    /// Forecasts and outcomes.
    Forecasts,
    /// Change in cash during the selected week.
    Waterfall,
    /// Curve of cash by day.
    Curve,
}

/// Minimum width for the waterfall and the curve next to the ledger.
const MIN_WIDE_WIDTH: u16 = 176;

/// The cash screen.
#[derive(Default)]
pub struct Cash {
    focus: CashPane,
    ledger: WeeklyLedger,
    /// The selected week, or `None` for the last week.
    selected_week: Option<u32>,
    table: Table,
    subjects: Vec<LedgerSubject>,
    forecasts: ForecastsState,
    selected_step: usize,
}

/// Selection in the ledger panes: a subject, with its first and last week.
type SelectedSubject = (LedgerSubject, (u32, u32));

impl Cash {
    fn week(&self) -> u32 {
        let last = self.ledger.last_week();
        self.selected_week.unwrap_or(last).min(last)
    }

    fn rebuild_table(&mut self) {
        let (columns, subjects, rows) = ledger_table(&self.ledger, self.week());
        if self.subjects.is_empty() {
            self.table = Table::new(Vec::new()).with_cell_selection();
            self.table.set_columns_and_rows(columns, rows);
            self.table.handle_action(Action::Right, 1);
        } else {
            self.table.set_columns_and_rows(columns, rows);
        }
        self.subjects = subjects;
    }

    fn move_week(&mut self, step: i64) {
        let last = self.ledger.last_week();
        let week = (i64::from(self.week()) + step).clamp(1.min(i64::from(last)), i64::from(last)) as u32;
        self.selected_week = (week != last).then_some(week);
        self.rebuild_table();
    }

    /// Handles actions that change the selected week. Returns false for other actions.
    fn handle_week_action(&mut self, action: Action) -> bool {
        match action {
            Action::Left => self.move_week(-1),
            Action::Right => self.move_week(1),
            Action::First => self.move_week(-i64::from(u16::MAX)),
            Action::Last | Action::Close => self.move_week(i64::from(u16::MAX)),
            _ => return false,
        }
        true
    }

    fn subject(&self) -> Option<LedgerSubject> {
        self.table.selected().and_then(|row| self.subjects.get(row)).copied()
    }

    /// Returns the subject of the selected row in the selected week.
    fn selected_subject_in_week(&self) -> Option<SelectedSubject> {
        Some((self.subject()?, (self.week(), self.week())))
    }

    /// Returns the steps from the cash of the previous week to the cash of the selected week.
    fn steps(&self, company: &DisplayedCompany) -> Vec<CashStep> {
        cash_steps(&self.ledger, company, self.week(), usize::MAX)
    }

    fn subject_figure(&self, selected: Option<SelectedSubject>) -> Option<Figure> {
        let (subject, (from, to)) = selected?;
        let weeks = match (from, to) {
            (1, to) if to == self.ledger.open_week() => "the whole run".to_owned(),
            (from, to) if from == to => format!("week {to}"),
            (from, to) => format!("weeks {from} to {to}"),
        };
        let title = format!("{} of {weeks}", subject.name());
        let figure =
            Figure { title, term: subject.term(), sql: Some(ledger_query(&subject, (from, to))), week_quantity: None };
        let quantity = subject.figure().and_then(WeekQuantity::for_company);
        // Only simulated weeks have weekly quantities. Purchases since the last week belong to the next week.
        Some(figure.with_week_quantity(quantity.filter(|_| to <= self.ledger.last_week()), to))
    }
}

fn ledger_rows(selected: Option<SelectedSubject>) -> Vec<Effect> {
    selected.map(|(subject, weeks)| Effect::RunSql(ledger_query(&subject, weeks))).into_iter().collect()
}

fn week_keys(context: &ScreenContext<'_>) -> String {
    let label = |action| context.keys.label(action).unwrap_or_default();
    let keys = format!("{} {} another week", label(Action::Left), label(Action::Right));
    format!("{keys} · {} ledger rows", label(Action::Open))
}

impl ScreenState for Cash {
    fn screen_escape_depth(&self) -> usize {
        usize::from(self.selected_week.is_some())
    }

    fn on_company_change(&mut self, context: &ScreenContext<'_>) {
        self.ledger = WeeklyLedger::from_company(context.company);
        self.rebuild_table();
        self.forecasts.update(context.company);
    }
}

impl PaneScreen for Cash {
    type PaneId = CashPane;

    fn panes(&self) -> &'static [CashPane] {
        CashPane::VARIANTS
    }

    fn pane(name: CashPane) -> &'static dyn Pane<Cash> {
        match name {
            CashPane::Ledger => &ledger::LedgerPane,
            CashPane::Weeks => &bars::BarsPane,
            CashPane::Forecasts => &forecasts::ForecastsPane,
            CashPane::Waterfall => &waterfall::WaterfallPane,
            CashPane::Curve => &curve::CurvePane,
        }
    }

    fn focused_pane(&self) -> CashPane {
        self.focus
    }

    fn set_focused_pane(&mut self, name: CashPane) {
        self.focus = name;
    }

    fn draw_panes(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        if area.width >= 104 && area.height >= 30 {
            return self.draw_large_layout(canvas, area, context);
        }
        let rows = self.table.rows().len() as u16 + 3;
        let upper = rows.min(area.height * 11 / 20);
        let [table, rest] = Layout::vertical([Constraint::Length(upper), Constraint::Min(0)]).areas(area);
        draw_pane(self, CashPane::Ledger, canvas, table, context);
        let stack = [CashPane::Waterfall, CashPane::Curve, CashPane::Weeks, CashPane::Forecasts];
        draw_stack(self, &stack, canvas, rest, context);
    }
}

impl Cash {
    /// Draws the ledger, waterfall and curve above the weeks and forecasts.
    fn draw_large_layout(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let rows = self.table.rows().len() as u16 + 3;
        let [top, below] = Layout::vertical([
            Constraint::Length(rows.clamp(10, area.height - area.height / 2)),
            Constraint::Min(0),
        ])
        .areas(area);
        let halves = |area: Rect, left: u16| {
            Layout::horizontal([Constraint::Length(left), Constraint::Min(0)]).areas::<2>(area)
        };
        let [table, right_area] = halves(top, 82.min(area.width * 2 / 3));
        let [weeks, forecasts] = halves(below, (area.width * 11 / 20).max(60));
        draw_pane(self, CashPane::Ledger, canvas, table, context);
        if area.width >= MIN_WIDE_WIDTH {
            let [steps, curve] = halves(right_area, right_area.width / 2);
            draw_pane(self, CashPane::Waterfall, canvas, steps, context);
            draw_pane(self, CashPane::Curve, canvas, curve, context);
        } else {
            draw_stack(self, &[CashPane::Waterfall, CashPane::Curve], canvas, right_area, context);
        }
        draw_pane(self, CashPane::Weeks, canvas, weeks, context);
        draw_pane(self, CashPane::Forecasts, canvas, forecasts, context);
    }
}
