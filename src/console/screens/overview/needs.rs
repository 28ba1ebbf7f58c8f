//! Items that need action: rows, links and figures.

use ratatui::layout::Rect;

use super::Overview;
use super::rows::{self, LinkedRow, walk};
use crate::action::Action;
use crate::context::{Figure, Look, ScreenId};
use crate::effect::Effect;
use crate::screens::customers::costs;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_report::needs::{Need, Place, Problem};
use novamind_session::entries_of_weeks;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_worker::company::Company;

/// Items that need action, most urgent first.
pub struct NeedsPane;

impl Pane<Overview> for NeedsPane {
    fn hints(&self, _: &Overview) -> Vec<Action> {
        vec![Action::Open]
    }

    fn figure(&self, overview: &Overview, look: &Look<'_>) -> Option<Figure> {
        look.company.needs.get(overview.need).map(|need| figure_of(need, look.company.seen.day))
    }

    fn act(&self, overview: &mut Overview, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let needs = &look.company.needs;
        if action == Action::Open {
            return needs.get(overview.need).map(way_of).into_iter().collect();
        }
        walk(&mut overview.need, needs.len(), action);
        Vec::new()
    }

    fn click(&self, overview: &mut Overview, row: usize, look: &Look<'_>) -> Vec<Effect> {
        let again = overview.need == row;
        overview.need = row.min(look.company.needs.len().saturating_sub(1));
        if again { self.act(overview, Action::Open, look) } else { Vec::new() }
    }

    fn border(&self, _: &Overview, _: Rect, look: &Look<'_>) -> Border {
        let needs = &look.company.needs;
        let urgent = needs.iter().filter(|need| need.urgent).count();
        let note = if urgent > 0 { format!("{urgent} now · {} in all", needs.len()) } else { String::new() };
        Border { title: "Action needed".to_owned(), note, ..Border::default() }
    }

    fn draw(&self, overview: &Overview, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        if look.company.needs.is_empty() {
            let text = match look.company.seen.ended {
                Some(_) => "The run is over. You can still read and query it.",
                // Items whose tool is locked are hidden, so an empty list does not mean that nothing needs
                // action.
                None if look.company.running_lesson().is_some_and(|own| own.tools.is_some()) => {
                    "Nothing is listed here. Your task says what to do."
                }
                None => "Nothing needs action. Start the next week with n.",
            };
            canvas.text(seat.area, text, Role::Dim);
        }
        rows::draw(canvas, seat, &rows_of(look.company), overview.need);
    }
}

fn rows_of(company: &Company) -> Vec<LinkedRow> {
    company.needs.iter().map(|need| LinkedRow::to(screen_of(need), need.in_words(), need.urgent)).collect()
}

/// Returns the height of the pane with its border, limited to `most`.
pub fn height(company: &Company, width: u16, most: u16) -> u16 {
    let room = width.saturating_sub(2);
    let lines: usize = rows_of(company).iter().map(|row| row.lines(room).len()).sum();
    (lines.max(1) as u16 + 2).min(most.max(4))
}

/// Returns the screen for an item.
pub fn screen_of(need: &Need) -> ScreenId {
    match &need.place {
        Place::Call(..) => ScreenId::Tools,
        Place::Thread(_) => ScreenId::Inbox,
        Place::Group(_) => ScreenId::Customers,
        Place::Books => ScreenId::Cash,
    }
}

/// Opens the form, thread or group of an item.
pub fn way_of(need: &Need) -> Effect {
    match &need.place {
        Place::Call(tool, arguments) => Effect::Prefill { tool: *tool, arguments: arguments.clone() },
        Place::Thread(number) => Effect::ShowThread(*number),
        Place::Group(group) => Effect::ShowGroup(ScreenId::Customers, *group),
        Place::Books => Effect::Show(ScreenId::Cash),
    }
}

/// Returns the figure of an item, with a query for its rows.
pub fn figure_of(need: &Need, day: u32) -> Figure {
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
    let (term, sql) = match need.problem {
        Problem::Runway => {
            let week = day.div_ceil(7);
            let weeks = entries_of_weeks(week.saturating_sub(3).max(1), week);
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
        Problem::NoSales(group) => ("conversion", Some(leads_of(group.id()))),
        Problem::Unwanted(group) => ("delivered-quality", Some(leads_of(group.id()))),
        Problem::LeadCost(channel, group) => ("cost-per-lead", Some(costs::statement(channel, group))),
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
    Figure { title: need.text.clone(), term, sql, why: None }.of_week(quantity_of(need), day.div_ceil(7))
}

/// Returns the weekly figure of an item.
fn quantity_of(need: &Need) -> Option<WeekQuantity> {
    match need.problem {
        Problem::Runway => WeekQuantity::of_company(WeekFigure::CashChange),
        Problem::NoLeads => WeekQuantity::of_company(WeekFigure::Leads),
        Problem::NoSales(group) => WeekQuantity::of_group(WeekFigure::Conversion, group),
        Problem::Overload | Problem::Capacity => WeekQuantity::of_company(WeekFigure::OverloadPeak),
        Problem::Outages => WeekQuantity::of_company(WeekFigure::Outage),
        Problem::Backlog => WeekQuantity::of_company(WeekFigure::OpenIssues),
        Problem::Churn(group) => WeekQuantity::of_group(WeekFigure::Churn, group),
        Problem::Threads
        | Problem::NoPrice
        | Problem::NoQuota
        | Problem::Unwanted(_)
        | Problem::LeadCost(..)
        | Problem::Margin => None,
    }
}
