//! Weeks of a group: customers, leads, sign-ups and cancellations.

use ratatui::layout::{Constraint, Layout, Rect};

use super::columns::flow_statement;
use super::model::{self, CustomerFacts, Flow};
use super::steps::{moved, show_rows};
use super::{Customers, CustomersPane};
use crate::action::Action;
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat, draw_framed};
use novamind_base::notation::{compact, grouped};
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_tui::canvas::Canvas;
use novamind_tui::text::{arrow, count};
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::{note_room, summary, zero_if_near};
use novamind_tui::widgets::{Axis, Line, Plot, Side, Unit};

/// Selectable flows with their terms and figures.
const FLOWS: [(&str, &str, WeekFigure); 3] = [
    ("leads", "lead", WeekFigure::Leads),
    ("new customers", "conversion", WeekFigure::NewSubscribers),
    ("cancellations", "churn", WeekFigure::Cancellations),
];

pub struct WeeksPane;

impl WeeksPane {
    fn week(&self, customers: &Customers, look: &Look<'_>) -> u32 {
        look.company.seen.week.saturating_sub(customers.opened.back)
    }
}

impl Pane<Customers> for WeeksPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::FocusNext, Action::Close]
    }

    fn figure(&self, customers: &Customers, look: &Look<'_>) -> Option<Figure> {
        let (group, week) = (customers.group(look.company)?, self.week(customers, look));
        let flow = customers.opened.flow;
        let (name, term, figure) = FLOWS[flow];
        let sql = Some(flow_statement(flow, group, week));
        let own = Figure { title: format!("{name} of {group} in week {week}"), term, sql, why: None };
        Some(own.of_week(WeekQuantity::of_group(figure, group), week))
    }

    fn act(&self, customers: &mut Customers, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let most = model::WEEKS.min(look.company.seen.week).saturating_sub(1);
        let opened = &mut customers.opened;
        match action {
            Action::Open => return show_rows(self.figure(customers, look)),
            Action::Left => opened.back = (opened.back + 1).min(most),
            Action::Right => opened.back = opened.back.saturating_sub(1),
            action => opened.flow = moved(opened.flow, FLOWS.len() - 1, action),
        }
        Vec::new()
    }

    fn border(&self, customers: &Customers, area: Rect, look: &Look<'_>) -> Border {
        let title = "By week";
        let label = |action| look.keys.label(action).unwrap_or_default();
        let [left, right] = [Action::Left, Action::Right].map(label);
        let [up, down] = [Action::Up, Action::Down].map(label);
        let note = customers.group(look.company).map_or(String::new(), |group| {
            // Without the focus the pane summarizes all flows of the last week.
            let focused = customers.is_on(CustomersPane::Weeks);
            let (week, flow) = match focused {
                true => (self.week(customers, look), customers.opened.flow),
                false => (look.company.seen.week, usize::MAX),
            };
            flow_words(&customers.market.of(group), week, flow, note_room(area, title))
        });
        let keys = format!("{left} {right} another week · {up} {down} another figure");
        Border { title: title.to_owned(), note, keys, ..Border::default() }
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let Some(group) = customers.group(look.company) else { return };
        let own = customers.market.of(group);
        let week = look.company.seen.week;
        let trend = |figure: fn(&Flow) -> f64| points(own.trend(week, figure));
        let lines = [
            Line::through(trend(|flow| flow.leads), Role::Series(2)).named("leads"),
            Line::through(trend(|flow| flow.signed), Role::Good).named("new"),
            Line {
                scattered: true,
                ..Line::through(trend(|flow| flow.cancelled), Role::Bad).named("cancelled")
            },
        ];
        let mark = seat.focused.then(|| f64::from(self.week(customers, look)));
        plot(canvas, seat.area, &lines, mark, &[0.0]);
    }

    fn show(&self, customers: &Customers, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let [stock, flows] =
            Layout::vertical([Constraint::Percentage(50), Constraint::Min(0)]).areas(seat.area);
        self.draw_stock(customers, canvas, Seat { area: stock, ..seat }, look);
        draw_framed(self, customers, canvas, Seat { area: flows, ..seat }, look);
    }
}

impl WeeksPane {
    fn draw_stock(&self, customers: &Customers, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let Some(group) = customers.group(look.company) else { return };
        let held = points(customers.market.of(group).stock(look.company.seen.week));
        let values: Vec<f64> = held.iter().map(|point| point.1).collect();
        let title = format!("{group} {}", if group.is_enterprise() { "companies" } else { "subscribers" });
        let words = summary(&values, &|value| grouped(value, 0), note_room(seat.area, &title));
        let inside = canvas.pane(seat.area, &title, &words, false);
        let mark = seat.focused.then(|| f64::from(self.week(customers, look)));
        let lines = [Line::through(held, Role::Series(0))];
        plot(canvas, inside, &lines, mark, zero_if_near(values.iter().copied()));
    }
}

fn points(values: Vec<(u32, f64)>) -> Vec<(f64, f64)> {
    values.iter().map(|(at, value)| (f64::from(*at), *value)).collect()
}

fn plot(canvas: &mut Canvas<'_>, area: Rect, lines: &[Line], mark: Option<f64>, holds: &[f64]) {
    let x = Axis { write: &|week| format!("wk {week:.0}"), holds: &[] };
    let y = Side { unit: Unit::Number, holds };
    Plot { lines, band: None, mark, x: &x, y: &y }.draw(canvas, area);
}

/// Describes a week: the selected flow with its change, or all flows.
fn flow_words(facts: &CustomerFacts, week: u32, flow: usize, room: usize) -> String {
    let (now, before) = (facts.week(week), facts.week(week.saturating_sub(1)));
    let of = |own: &Flow| [own.leads, own.signed, own.cancelled];
    let whole = |value: f64| grouped(value, 0);
    if let Some((name, ..)) = FLOWS.get(flow) {
        let (now, before) = (of(&now)[flow], of(&before)[flow]);
        return format!(
            "week {week}: {} {name} {}",
            whole(now),
            arrow(now - before, &whole((now - before).abs()))
        );
    }
    let full = format!(
        "{} · {} new · {} cancelled",
        count(now.leads, "lead"),
        whole(now.signed),
        whole(now.cancelled)
    );
    if full.len() <= room { full } else { format!("+{} -{}", compact(now.signed), compact(now.cancelled)) }
}
