//! Chart of cash by day, with the last forecasts as a fan.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::Overview;
use super::figures::{self, METRICS};
use crate::action::Action;
use crate::context::{Figure, ScreenContext, ScreenId};
use crate::effect::Effect;
use crate::forecast_fan;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{dollars, short_dollars};
use novamind_report::cash_before_purchases;
use novamind_tui::canvas::Canvas;
use novamind_tui::text::format_change;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::note_width;
use novamind_tui::widgets::{XAxis, Curve, YAxis, AxisUnit, draw_chart};

pub struct CashCurvePane;

impl Pane<Overview> for CashCurvePane {
    fn hints(&self, _: &Overview) -> Vec<Action> {
        vec![Action::Open]
    }

    fn figure(&self, _: &Overview, context: &ScreenContext<'_>) -> Option<Figure> {
        Some(figures::figure(&METRICS[0], 0, context.company))
    }

    fn handle_action(&self, _: &mut Overview, action: Action, _: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open { vec![Effect::Show(ScreenId::Cash)] } else { Vec::new() }
    }

    fn border(&self, _: &Overview, area: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let (title, company) = ("Cash", context.company);
        let change = company.observation.cash_change;
        let moved = format_change(change, &short_dollars(change.abs()));
        let now = dollars(company.observation.cash);
        let forecast = company.last_forecasts().map(|(day, _)| format!(" · forecast of day {day}"));
        // The change ends with the week, and purchases on the same day are not part of it.
        let (least, more) = match cash_before_purchases(&company.observation) {
            Some(before) => (format!("{now} now"), format!(" · {} {moved} at week's end", short_dollars(before))),
            None => (format!("{now} {moved}"), forecast.map_or(String::new(), |forecast| format!(" in a week{forecast}"))),
        };
        let full = format!("{least}{more}");
        let note = if full.width() <= note_width(area, title) { full } else { least };
        PaneBorder { title: title.to_owned(), note, ..PaneBorder::default() }
    }

    fn draw(&self, _: &Overview, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let company = context.company;
        match company.last_forecasts() {
            Some((filed, forecasts)) => {
                forecast_fan::draw_fan(canvas, placement.area, company, filed, &forecast_fan::within_fan_horizon(company, forecasts));
            }
            None => {
                let lines = [Curve::from_values(&company.cash_by_day, Role::Series(0))];
                let x = XAxis { format: &|day| format!("day {day:.0}"), required_values: &[] };
                draw_chart(canvas, placement.area, &lines, &x, &YAxis { unit: AxisUnit::Dollars, required_values: &[] });
            }
        }
    }
}
