//! Estimates of the group's market study.

use ratatui::layout::Rect;

use super::Customers;
use super::selection::show_rows_effect;
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::market::model::study_level;
use crate::screens::market::report;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::percent;
use novamind_tui::canvas::Canvas;

pub struct StudyPane;

impl Pane<Customers> for StudyPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::FocusNext, Action::Close]
    }

    fn figure(&self, customers: &Customers, context: &ScreenContext<'_>) -> Option<Figure> {
        let title = format!("market study of {}", customers.group(context.company)?);
        Some(Figure { title, term: "info-level", sql: None, week_quantity: None })
    }

    fn handle_action(&self, customers: &mut Customers, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return show_rows_effect(self.figure(customers, context));
        }
        customers.group_state.study_scroll.handle_action(action, context.page_rows.into());
        Vec::new()
    }

    fn border(&self, customers: &Customers, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        customers.group(context.company).map_or_else(PaneBorder::default, |group| {
            let level = study_level(context.company, group);
            let noise = context.company.tool_limits.study_level(level).map_or(0.0, |level| level.noise);
            let note = format!(
                "study level {level} · noise ±{} · {}",
                percent(noise, 0),
                report::study_date_text(context.company, group)
            );
            PaneBorder { title: format!("Study of {group}"), note, ..PaneBorder::default() }
        })
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        if let Some(group) = customers.group(context.company) {
            if placement.focused {
                canvas.page_rows = placement.area.height.max(1);
            }
            let scroll = &customers.group_state.study_scroll;
            report::draw_estimates(canvas, placement.area, context.company, group, scroll);
        }
    }
}
