//! Cash by day with the last forecasts as a fan.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::Overview;
use super::figures::{self, METRICS};
use crate::action::Action;
use crate::context::{Figure, Look, ScreenId};
use crate::effect::Effect;
use crate::fan;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::{dollars, short_dollars};
use novamind_tui::canvas::Canvas;
use novamind_tui::text::arrow;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::note_room;
use novamind_tui::widgets::{Axis, Line, Side, Unit, chart};

pub struct CashCurvePane;

impl Pane<Overview> for CashCurvePane {
    fn hints(&self, _: &Overview) -> Vec<Action> {
        vec![Action::Open]
    }

    fn figure(&self, _: &Overview, look: &Look<'_>) -> Option<Figure> {
        Some(figures::figure(&METRICS[0], 0, look.company))
    }

    fn act(&self, _: &mut Overview, action: Action, _: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open { vec![Effect::Show(ScreenId::Cash)] } else { Vec::new() }
    }

    fn border(&self, _: &Overview, area: Rect, look: &Look<'_>) -> Border {
        let (title, company) = ("Cash", look.company);
        let change = company.seen.cash_change;
        let moved = format!("{} {}", dollars(company.seen.cash), arrow(change, &short_dollars(change.abs())));
        let full = match company.last_forecasts() {
            Some((day, _)) => format!("{moved} in a week · forecast of day {day}"),
            None => moved.clone(),
        };
        let note = if full.width() <= note_room(area, title) { full } else { moved };
        Border { title: title.to_owned(), note, ..Border::default() }
    }

    fn draw(&self, _: &Overview, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let company = look.company;
        match company.last_forecasts() {
            Some((filed, forecasts)) => {
                fan::draw_fan(canvas, seat.area, company, filed, &fan::near(company, forecasts));
            }
            None => {
                let lines = [Line::of(&company.cash_by_day, Role::Series(0))];
                let x = Axis { write: &|day| format!("day {day:.0}"), holds: &[] };
                chart(canvas, seat.area, &lines, &x, &Side { unit: Unit::Dollars, holds: &[] });
            }
        }
    }
}
