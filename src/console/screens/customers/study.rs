//! Estimates of the group's market study.

use ratatui::layout::Rect;

use super::Customers;
use super::steps::{moved, show_rows};
use crate::action::Action;
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::market::model::level_of;
use crate::screens::market::report;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::percent;
use novamind_tui::canvas::Canvas;

pub struct StudyPane;

impl Pane<Customers> for StudyPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::FocusNext, Action::Close]
    }

    fn figure(&self, customers: &Customers, look: &Look<'_>) -> Option<Figure> {
        let title = format!("market study of {}", customers.group(look.company)?);
        Some(Figure { title, term: "info-level", sql: None, why: None })
    }

    fn act(&self, customers: &mut Customers, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let Some(group) = customers.group(look.company) else { return Vec::new() };
        if action == Action::Open {
            return show_rows(self.figure(customers, look));
        }
        let last = report::lines(look.company, group).len().saturating_sub(1);
        customers.opened.line = moved(customers.opened.line, last, action);
        Vec::new()
    }

    fn border(&self, customers: &Customers, _: Rect, look: &Look<'_>) -> Border {
        customers.group(look.company).map_or_else(Border::default, |group| {
            let level = level_of(look.company, group);
            let noise = look.company.terms.level(level).map_or(0.0, |level| level.noise);
            let note = format!(
                "study level {level} · ±{} · {}",
                percent(noise, 0),
                report::studied(look.company, group)
            );
            Border { title: format!("Study of {group}"), note, ..Border::default() }
        })
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        if let Some(group) = customers.group(look.company) {
            report::draw_estimates(canvas, seat.area, look.company, group, customers.opened.line);
        }
    }
}
