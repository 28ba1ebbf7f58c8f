//! The pane of items that need action: its rows, links and figures.

use ratatui::layout::Rect;

use super::Overview;
use super::linked_rows::{self, LinkedRow, move_selection};
use crate::action::Action;
use crate::context::{Figure, ScreenContext, ScreenId};
use crate::effect::Effect;
use crate::screens::customers::costs;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_report::action_items::{ActionItem, ActionTarget, Problem, describe_no_items};
use novamind_session::ledger_weeks_condition_sql;
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;

/// Pane with the items that need action, the most urgent first.
pub struct ActionItemsPane;

impl Pane<Overview> for ActionItemsPane {
    fn hints(&self, _: &Overview) -> Vec<Action> {
        vec![Action::Open]
    }

    fn figure(&self, overview: &Overview, context: &ScreenContext<'_>) -> Option<Figure> {
        context.company.action_items.get(overview.selected_need).map(|need| item_figure(need, context.company.observation.day))
    }

    fn handle_action(&self, overview: &mut Overview, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let needs = &context.company.action_items;
        if action == Action::Open {
            return needs.get(overview.selected_need).map(item_effect).into_iter().collect();
        }
        move_selection(&mut overview.selected_need, needs.len(), action);
        Vec::new()
    }

    fn handle_click(&self, overview: &mut Overview, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        let again = overview.selected_need == row;
        overview.selected_need = row.min(context.company.action_items.len().saturating_sub(1));
        if again { self.handle_action(overview, Action::Open, context) } else { Vec::new() }
    }

    fn border(&self, _: &Overview, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let needs = &context.company.action_items;
        let urgent = needs.iter().filter(|need| need.is_urgent).count();
        let note = if urgent > 0 { format!("{urgent} urgent of {}", needs.len()) } else { String::new() };
        PaneBorder { title: "Action needed".to_owned(), note, ..PaneBorder::default() }
    }

    fn draw(&self, overview: &Overview, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        if context.company.action_items.is_empty() {
            let lines = wrap(&empty_text(context.company), placement.area.width.into());
            for (row, line) in row_rects(placement.area).zip(lines) {
                canvas.draw_text(row, &line, Role::Dim);
            }
        }
        linked_rows::draw(canvas, placement, &item_rows(context.company), overview.selected_need);
    }
}

fn empty_text(company: &DisplayedCompany) -> String {
    if company.observation.ended.is_some() {
        return "The run is over. You can still read and query it.".to_owned();
    }
    // Items whose tool is locked are hidden, so an empty list does not mean that nothing needs action.
    if company.running_lesson().is_some_and(|lesson_status| lesson_status.tools.is_some()) {
        return "No action items. The task of the lesson states the next step.".to_owned();
    }
    let checked = describe_no_items(company.weeks.last(), company.observation.runway_weeks);
    format!("{checked} Start the next week with n.")
}

fn item_rows(company: &DisplayedCompany) -> Vec<LinkedRow> {
    company.action_items.iter().map(|need| LinkedRow::new(item_screen(need), need.describe(), need.is_urgent)).collect()
}

/// Returns the height of the pane with its border, limited to `most`.
pub fn pane_height(company: &DisplayedCompany, width: u16, most: u16) -> u16 {
    let room = width.saturating_sub(2);
    let lines: usize = match company.action_items.is_empty() {
        true => wrap(&empty_text(company), room.into()).len(),
        false => item_rows(company).iter().map(|row| row.lines(room).len()).sum(),
    };
    (lines.max(1) as u16 + 2).min(most.max(4))
}

/// Returns the screen on which the user can act on an item.
pub fn item_screen(need: &ActionItem) -> ScreenId {
    match &need.target {
        ActionTarget::Call(..) => ScreenId::Tools,
        ActionTarget::Thread(_) => ScreenId::Inbox,
        ActionTarget::Group(_) => ScreenId::Customers,
        ActionTarget::Ledger => ScreenId::Cash,
    }
}

/// Returns the effect that opens the form, thread or group of an item.
pub fn item_effect(need: &ActionItem) -> Effect {
    match &need.target {
        ActionTarget::Call(tool, arguments) => Effect::Prefill { tool: *tool, arguments: arguments.clone() },
        ActionTarget::Thread(number) => Effect::ShowThread(*number),
        ActionTarget::Group(group) => Effect::ShowGroup(ScreenId::Customers, *group),
        ActionTarget::Ledger => Effect::Show(ScreenId::Cash),
    }
}

/// Returns the figure of an item, with a query for its source rows.
pub fn item_figure(need: &ActionItem, day: u32) -> Figure {
    let from = day.saturating_sub(6);
    let days = |columns: &str| {
        format!("SELECT {columns}\nFROM service_day\nWHERE day BETWEEN {from} AND {day}\nORDER BY day")
    };
    let leads_of = |group: &str| {
        format!(
            "SELECT c.customer_id, c.created_day, c.acquisition_source, s.plan, s.status, s.listed_price\nFROM customers c\n\
             LEFT JOIN subscriptions s ON s.customer_id = c.customer_id\nWHERE c.group_id = '{group}' AND c.created_day \
             BETWEEN {from} AND {day}"
        )
    };
    let group_ads = |group: &str| {
        format!(
            "SELECT (day + 6) / 7 AS week, channel_id, sum(leads_generated) AS leads, sum(spend) AS spend\n\
             FROM ad_channel_leads\nWHERE group_id = '{group}'\nGROUP BY 1, 2\nORDER BY 1 DESC, 2"
        )
    };
    let (term, sql) = match need.problem {
        Problem::Runway => {
            let week = day.div_ceil(7);
            let weeks = ledger_weeks_condition_sql(week.saturating_sub(3).max(1), week);
            (
                "runway",
                Some(format!(
                    "SELECT category, sum(amount) AS dollars, sum(amount) / 4 AS dollars_a_week\nFROM ledger\nWHERE {weeks}\n\
                     GROUP BY 1\nORDER BY 2"
                )),
            )
        }
        Problem::Threads => (
            "thread",
            Some(format!(
                "SELECT customer_id, thread_type, max(turn_number) AS turn, day, sender, seat_count\n\
                 FROM enterprise_turns\nGROUP BY thread_id\n\
                 HAVING sender <> 'agent' AND closed = 0 AND day >= {from}\nORDER BY seat_count DESC"
            )),
        ),
        Problem::NoPrice => ("set_prices", None),
        Problem::NoQuota => ("set_usage_quotas", None),
        Problem::NoLeads => ("lead", None),
        Problem::NoSales(group) | Problem::ConversionFall(group) => {
            ("conversion", Some(leads_of(group.id())))
        }
        Problem::NoRequests(group) => ("delivered-quality", Some(leads_of(group.id()))),
        Problem::NoAdResults(group) => ("cost-per-lead", Some(group_ads(group.id()))),
        Problem::LeadCost(channel, group) => ("cost-per-lead", Some(costs::cost_query(channel, group))),
        Problem::Margin => ("gross-margin", None),
        Problem::Overload | Problem::Capacity => {
            ("overload", Some(days("day, total_usage_units, capacity_units, capacity_tier")))
        }
        Problem::Outages => ("outage", Some(days("day, downtime_minutes, p95_ms, error_rate"))),
        Problem::Backlog => ("issue", Some(days("day, total_usage_units, downtime_minutes"))),
        Problem::Churn(group) => (
            "churn",
            Some(format!(
                "SELECT s.customer_id, s.plan, s.listed_price, s.start_day, s.end_day\nFROM subscriptions s\n\
                 JOIN customers c ON c.customer_id = s.customer_id\nWHERE c.group_id = '{group}' AND s.status = 'cancelled' \
                 AND s.end_day BETWEEN {from} AND {day}"
            )),
        ),
    };
    Figure { title: need.text.trim_end_matches('.').to_owned(), term, sql, week_quantity: None }.with_week_quantity(item_quantity(need), day.div_ceil(7))
}

/// Returns the weekly quantity that an item is about.
fn item_quantity(need: &ActionItem) -> Option<WeekQuantity> {
    match need.problem {
        Problem::Runway => WeekQuantity::for_company(WeekFigure::CashChange),
        Problem::NoLeads => WeekQuantity::for_company(WeekFigure::Leads),
        Problem::NoSales(group) | Problem::ConversionFall(group) => {
            WeekQuantity::for_group(WeekFigure::Conversion, group)
        }
        Problem::Overload | Problem::Capacity => WeekQuantity::for_company(WeekFigure::OverloadPeak),
        Problem::Outages => WeekQuantity::for_company(WeekFigure::Outage),
        Problem::Backlog => WeekQuantity::for_company(WeekFigure::OpenIssues),
        Problem::Churn(group) => WeekQuantity::for_group(WeekFigure::Churn, group),
        Problem::Threads
        | Problem::NoPrice
        | Problem::NoQuota
        | Problem::NoRequests(_)
        | Problem::NoAdResults(_)
        | Problem::LeadCost(..)
        | Problem::Margin => None,
    }
}
