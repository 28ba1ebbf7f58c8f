//! Charts of a group by week: customers, leads, signups and cancellations.

use ratatui::layout::{Constraint, Layout, Rect};

use super::columns::flow_statement;
use super::model::{self, GroupFacts, WeekFlow};
use super::selection::{move_index, show_rows_effect};
use super::{Customers, CustomersPane};
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement, draw_framed};
use novamind_base::formatting::{compact_number, grouped_number};
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_tui::canvas::Canvas;
use novamind_tui::text::{format_change, format_count};
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::{note_width, summary, zero_if_near};
use novamind_tui::widgets::{XAxis, Curve, Plot, YAxis, AxisUnit};

/// Selectable flows with their names, glossary terms and weekly figures.
const FLOWS: [(&str, &str, WeekFigure); 3] = [
    ("leads", "lead", WeekFigure::Leads),
    ("new customers", "new-customer", WeekFigure::NewSubscribers),
    ("cancellations", "churn", WeekFigure::Cancellations),
];

pub struct WeeksPane;

impl WeeksPane {
    fn week(&self, customers: &Customers, context: &ScreenContext<'_>) -> u32 {
        context.company.observation.week.saturating_sub(customers.group_state.weeks_back)
    }
}

impl Pane<Customers> for WeeksPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::FocusNext, Action::Close]
    }

    fn figure(&self, customers: &Customers, context: &ScreenContext<'_>) -> Option<Figure> {
        let (group, week) = (customers.group(context.company)?, self.week(customers, context));
        let flow = customers.group_state.flow;
        let (name, term, figure) = FLOWS[flow];
        let sql = Some(flow_statement(flow, group, week));
        let quantity = Figure { title: format!("{name} of {group} in week {week}"), term, sql, week_quantity: None };
        Some(quantity.with_week_quantity(WeekQuantity::for_group(figure, group), week))
    }

    fn handle_action(&self, customers: &mut Customers, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let max = model::CURVE_WEEKS.min(context.company.observation.week).saturating_sub(1);
        let opened = &mut customers.group_state;
        match action {
            Action::Open => return show_rows_effect(self.figure(customers, context)),
            Action::Left => opened.weeks_back = (opened.weeks_back + 1).min(max),
            Action::Right => opened.weeks_back = opened.weeks_back.saturating_sub(1),
            action => opened.flow = move_index(opened.flow, FLOWS.len() - 1, action),
        }
        Vec::new()
    }

    fn border(&self, customers: &Customers, area: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let title = "By week";
        let label = |action| context.keys.label(action).unwrap_or_default();
        let [left, right] = [Action::Left, Action::Right].map(label);
        let [up, down] = [Action::Up, Action::Down].map(label);
        let note = customers.group(context.company).map_or(String::new(), |group| {
            // Without the focus, the pane summarizes all flows of the last week.
            let focused = customers.has_focus(CustomersPane::Weeks);
            let (week, flow) = match focused {
                true => (self.week(customers, context), customers.group_state.flow),
                false => (context.company.observation.week, usize::MAX),
            };
            flow_summary(&customers.data.facts_of_group(group), week, flow, note_width(area, title))
        });
        let keys = format!("{left} {right} another week · {up} {down} another figure");
        PaneBorder { title: title.to_owned(), note, keys, ..PaneBorder::default() }
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let Some(group) = customers.group(context.company) else { return };
        let group_facts = customers.data.facts_of_group(group);
        let week = context.company.observation.week;
        let trend = |figure: fn(&WeekFlow) -> f64| to_curve_points(group_facts.weekly_values(week, figure));
        let lines = [
            Curve::from_points(trend(|flow| flow.leads), Role::Series(2)).with_name("leads"),
            Curve::from_points(trend(|flow| flow.signups), Role::Good).with_name("new"),
            Curve {
                is_scatter: true,
                ..Curve::from_points(trend(|flow| flow.cancellations), Role::Bad).with_name("cancelled")
            },
        ];
        let mark = placement.focused.then(|| f64::from(self.week(customers, context)));
        draw_plot(canvas, placement.area, &lines, mark, &[0.0]);
    }

    fn draw_with_border(&self, customers: &Customers, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let [stock, flows] =
            Layout::vertical([Constraint::Percentage(50), Constraint::Min(0)]).areas(placement.area);
        self.draw_subscriptions(customers, canvas, PanePlacement { area: stock, ..placement }, context);
        draw_framed(self, customers, canvas, PanePlacement { area: flows, ..placement }, context);
    }
}

impl WeeksPane {
    fn draw_subscriptions(&self, customers: &Customers, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let Some(group) = customers.group(context.company) else { return };
        let held = to_curve_points(customers.data.facts_of_group(group).subscriptions_by_week(context.company.observation.week));
        let values: Vec<f64> = held.iter().map(|point| point.1).collect();
        let title = format!("{group} {}", if group.is_enterprise() { "enterprises" } else { "subscribers" });
        let words = summary(&values, &|value| grouped_number(value, 0), note_width(placement.area, &title));
        let inside = canvas.draw_pane_frame(placement.area, &title, &words, false);
        let mark = placement.focused.then(|| f64::from(self.week(customers, context)));
        let lines = [Curve::from_points(held, Role::Series(0))];
        draw_plot(canvas, inside, &lines, mark, zero_if_near(values.iter().copied()));
    }
}

fn to_curve_points(values: Vec<(u32, f64)>) -> Vec<(f64, f64)> {
    values.iter().map(|(at, value)| (f64::from(*at), *value)).collect()
}

fn draw_plot(canvas: &mut Canvas<'_>, area: Rect, lines: &[Curve], mark: Option<f64>, holds: &[f64]) {
    let x = XAxis { format: &|week| format!("wk {week:.0}"), required_values: &[] };
    let y = YAxis { unit: AxisUnit::Number, required_values: holds };
    Plot { curves: lines, band: None, marked_x: mark, x: &x, y: &y }.draw(canvas, area);
}

/// Describes the selected flow of a week with its change, or all flows if they are shown together.
fn flow_summary(facts: &GroupFacts, week: u32, flow: usize, room: usize) -> String {
    let (now, before) = (facts.week(week), facts.week(week.saturating_sub(1)));
    let of = |week_flow: &WeekFlow| [week_flow.leads, week_flow.signups, week_flow.cancellations];
    let whole = |value: f64| grouped_number(value, 0);
    if let Some((name, ..)) = FLOWS.get(flow) {
        let (now, before) = (of(&now)[flow], of(&before)[flow]);
        return format!(
            "week {week}: {} {name} {}",
            whole(now),
            format_change(now - before, &whole((now - before).abs()))
        );
    }
    let full = format!(
        "{} · {} new · {} cancelled",
        format_count(now.leads, "lead"),
        whole(now.signups),
        whole(now.cancellations)
    );
    if full.len() <= room { full } else { format!("+{} -{}", compact_number(now.signups), compact_number(now.cancellations)) }
}
