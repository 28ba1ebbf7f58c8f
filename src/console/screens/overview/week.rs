//! Table of the figures of the week.

use ratatui::layout::Rect;

use super::{Overview, OverviewPane};
use super::figures::{self, METRICS};
use crate::action::Action;
use crate::context::{Figure, ScreenContext, ScreenId};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_session::week_of_day;
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::Table;

pub struct WeekPane;

impl Pane<Overview> for WeekPane {
    fn table<'a>(&self, overview: &'a Overview) -> Option<&'a Table> {
        Some(&overview.week)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("overview.figures")
    }

    fn table_mut<'a>(&self, overview: &'a mut Overview) -> Option<&'a mut Table> {
        Some(&mut overview.week)
    }

    fn hints(&self, _: &Overview) -> Vec<Action> {
        vec![Action::Rows, Action::Sort, Action::Open]
    }

    fn figure(&self, overview: &Overview, context: &ScreenContext<'_>) -> Option<Figure> {
        let metric = METRICS.get(overview.week.selected()?)?;
        Some(figures::figure(metric, overview.week.selected_column(), context.company))
    }

    fn handle_action(&self, overview: &mut Overview, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            let metric = overview.week.selected().and_then(|row| METRICS.get(row));
            return metric.map(|metric| Effect::Show(details_screen(metric.term))).into_iter().collect();
        }
        overview.week.handle_action(action, context.page_rows);
        Vec::new()
    }

    fn border(&self, overview: &Overview, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let selected = overview.week.selected().filter(|_| overview.focus == OverviewPane::Week);
        let scope = selected.and_then(|row| METRICS.get(row)?.scope());
        let note = match overview.week.summary() {
            note if note.is_empty() => match &context.company.observation.last_week {
                Some(week) if scope.is_some() => format!("week {} · {}", week_of_day(week.day), scope.unwrap_or_default()),
                Some(week) => format!("week {} · to day {}", week_of_day(week.day), week.day),
                None => "no week yet".to_owned(),
            },
            note => note,
        };
        PaneBorder { title: "This week".to_owned(), note, ..PaneBorder::default() }
    }

    fn draw(&self, overview: &Overview, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        overview.week.draw(canvas, placement.area, placement.focused, placement.index);
    }
}

/// Returns the screen that shows details of the figure with a glossary term.
fn details_screen(term: &str) -> ScreenId {
    match term {
        "cash" | "payments" | "running-costs" => ScreenId::Cash,
        "enterprise-lead" | "seats" => ScreenId::Inbox,
        "usage" | "overload" | "outage" | "latency" | "error-rate" | "issue" => ScreenId::Product,
        _ => ScreenId::Customers,
    }
}
