//! Cost of a lead and of a first bill by channel and group. The last four weeks are compared with the cheapest earlier
//! four weeks.

use ratatui::layout::Rect;

use super::Customers;
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{dollars_and_cents, dollars, grouped_number};
use novamind_report::lead_costs::{AdResults, LeadCost};
use novamind_session::identifiers::{Channel, Group};
use novamind_tools::ToolId;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{TableCell, TableColumn, Table};
use novamind_worker::company::DisplayedCompany;

/// Pane with the costs of each pair of channel and group that has advertising.
pub struct CostsPane;

impl Pane<Customers> for CostsPane {
    fn table<'a>(&self, customers: &'a Customers) -> Option<&'a Table> {
        Some(&customers.costs)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("customers.lead-costs")
    }

    fn table_mut<'a>(&self, customers: &'a mut Customers) -> Option<&'a mut Table> {
        Some(&mut customers.costs)
    }

    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::Sort, Action::Filter]
    }

    fn figure(&self, customers: &Customers, context: &ScreenContext<'_>) -> Option<Figure> {
        let pair = selected(customers, context.company)?;
        let (channel, group) = (pair.channel, pair.group);
        let title = format!("cost of leads of {group} through {}", channel.id());
        Some(Figure { title, term: "cost-per-lead", sql: Some(cost_query(channel, group)), week_quantity: None })
    }

    fn handle_action(&self, customers: &mut Customers, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return vec![Effect::ShowTool(ToolId::SetTargetedAdSpend)];
        }
        customers.costs.handle_action(action, context.page_rows);
        Vec::new()
    }

    fn border(&self, customers: &Customers, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let note = match customers.costs.summary() {
            note if note.is_empty() => "last 4 weeks · cheapest earlier 4 weeks".to_owned(),
            note => note,
        };
        let keys = context.hints(&[Action::Open, Action::Sort, Action::Filter]);
        PaneBorder { title: "Cost per lead".to_owned(), note, keys, ..PaneBorder::default() }
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        if customers.costs.rows().is_empty() {
            canvas.draw_text(placement.area, "No ads in the last 4 weeks", Role::Dim);
            return;
        }
        customers.costs.draw(canvas, placement.area, placement.focused, placement.index);
    }
}

fn selected<'a>(customers: &Customers, company: &'a DisplayedCompany) -> Option<&'a LeadCost> {
    company.lead_costs.get(customers.costs.selected()?)
}

/// Returns the columns of the cost table.
pub fn columns() -> Vec<TableColumn> {
    let words = ["channel", "group"].map(TableColumn::text);
    let numbers = ["leads", "spend", "$/lead", "was", "$/first bill", "was"].map(TableColumn::numeric);
    words.into_iter().chain(numbers).collect()
}

/// Returns the table row of a channel and group.
pub fn cost_row(pair: &LeadCost) -> Vec<TableCell> {
    let each = |value: Option<f64>| match value {
        Some(value) => TableCell::from_number(value, dollars_and_cents(value)),
        None => TableCell::from_text("–").with_role(Role::Dim),
    };
    let before = |figure: fn(&AdResults) -> Option<f64>| each(pair.cheapest.as_ref().and_then(figure));
    let now = each(pair.recent.cost_per_lead());
    vec![
        TableCell::from_text(pair.channel.id()),
        TableCell::from_text(pair.group.id()).with_role(Role::Strong),
        TableCell::from_number(f64::from(pair.recent.leads), grouped_number(f64::from(pair.recent.leads), 0)),
        TableCell::from_number(pair.recent.spend, dollars(pair.recent.spend)),
        if pair.cost_rise().is_some() { now.with_role(Role::Bad) } else { now },
        before(AdResults::cost_per_lead),
        each(pair.recent.cost_per_bill()),
        before(AdResults::cost_per_bill),
    ]
}

/// Returns a query for the leads, spending and first bills of a channel and group by week.
pub fn cost_query(channel: Channel, group: Group) -> String {
    let channel = channel.id();
    // An individual pays on the first day, an enterprise on its next billing day.
    let billed = match group.is_enterprise() {
        true => {
            "'Subscription payment from customer ' || c.customer_id IN\n            \
             (SELECT note FROM ledger WHERE category = 'subscription_payment')"
        }
        false => "s.status IN ('subscribed', 'cancelled')",
    };
    format!(
        "WITH bills AS (\n    SELECT (c.created_day + 6) / 7 AS week, count(*) AS first_bills\n    FROM customers c\n    \
         CROSS JOIN subscriptions s\n    WHERE c.group_id = '{group}' AND c.acquisition_source = '{channel}'\n        \
         AND s.customer_id = c.customer_id\n        AND {billed}\n    GROUP BY 1\n)\nSELECT (day + 6) / 7 AS week, \
         sum(leads_generated) AS leads, sum(spend) AS spend,\n    round(sum(spend) / nullif(sum(leads_generated), 0), 2) AS \
         dollars_per_lead, b.first_bills,\n    round(sum(spend) / b.first_bills, 2) AS dollars_per_first_bill\n\
         FROM ad_channel_leads\nLEFT JOIN bills b ON b.week = (day + 6) / 7\nWHERE channel_id = '{channel}' AND group_id = \
         '{group}'\nGROUP BY 1\nORDER BY 1 DESC"
    )
}
