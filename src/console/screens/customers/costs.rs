//! Cost of a lead and of a first bill by channel and group: the last four weeks next to the cheapest earlier
//! four weeks.

use ratatui::layout::Rect;

use super::Customers;
use crate::action::Action;
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::{cents, dollars, grouped};
use novamind_report::lead_costs::{AdSpell, PairCost};
use novamind_session::identifiers::{Channel, Group};
use novamind_tools::ToolId;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Cell, Column, Table};
use novamind_worker::company::Company;

/// Pairs of channel and group with advertising.
pub struct CostsPane;

impl Pane<Customers> for CostsPane {
    fn table<'a>(&self, customers: &'a Customers) -> Option<&'a Table> {
        Some(&customers.costs)
    }

    fn table_mut<'a>(&self, customers: &'a mut Customers) -> Option<&'a mut Table> {
        Some(&mut customers.costs)
    }

    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::Sort, Action::Filter]
    }

    fn figure(&self, customers: &Customers, look: &Look<'_>) -> Option<Figure> {
        let pair = selected(customers, look.company)?;
        let (channel, group) = (pair.channel, pair.group);
        let title = format!("cost of leads of {group} through {}", channel.id());
        Some(Figure { title, term: "cost-per-lead", sql: Some(statement(channel, group)), why: None })
    }

    fn act(&self, customers: &mut Customers, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return vec![Effect::ShowTool(ToolId::SetTargetedAdSpend)];
        }
        customers.costs.act(action, look.page);
        Vec::new()
    }

    fn border(&self, customers: &Customers, _: Rect, look: &Look<'_>) -> Border {
        let note = match customers.costs.note() {
            note if note.is_empty() => "last 4 weeks · cheapest 4 weeks before".to_owned(),
            note => note,
        };
        let keys = look.hints(&[Action::Open, Action::Sort, Action::Filter]);
        Border { title: "Cost per lead".to_owned(), note, keys, ..Border::default() }
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        if customers.costs.rows().is_empty() {
            canvas.text(seat.area, "No ads in the last 4 weeks", Role::Dim);
            return;
        }
        customers.costs.draw(canvas, seat.area, seat.focused, seat.number);
    }
}

fn selected<'a>(customers: &Customers, company: &'a Company) -> Option<&'a PairCost> {
    company.lead_costs.get(customers.costs.selected()?)
}

/// Returns the columns of the table.
pub fn columns() -> Vec<Column> {
    let words = ["channel", "group"].map(Column::words);
    let numbers = ["leads", "spend", "$/lead", "was", "$/first bill", "was"].map(Column::numbers);
    words.into_iter().chain(numbers).collect()
}

/// Returns the row of a pair.
pub fn row_of(pair: &PairCost) -> Vec<Cell> {
    let each = |value: Option<f64>| match value {
        Some(value) => Cell::number(value, cents(value)),
        None => Cell::words("–").role(Role::Dim),
    };
    let before = |figure: fn(&AdSpell) -> Option<f64>| each(pair.cheapest.as_ref().and_then(figure));
    let now = each(pair.recent.per_lead());
    vec![
        Cell::words(pair.channel.id()),
        Cell::words(pair.group.id()).role(Role::Strong),
        Cell::number(f64::from(pair.recent.leads), grouped(f64::from(pair.recent.leads), 0)),
        Cell::number(pair.recent.spend, dollars(pair.recent.spend)),
        if pair.rise().is_some() { now.role(Role::Bad) } else { now },
        before(AdSpell::per_lead),
        each(pair.recent.per_bill()),
        before(AdSpell::per_bill),
    ]
}

/// Selects leads, spend and first bills of a pair by week.
pub fn statement(channel: Channel, group: Group) -> String {
    let channel = channel.id();
    format!(
        "WITH bills AS (\n    SELECT (c.created_day + 6) / 7 AS week, count(*) AS first_bills\n    FROM customers c\n    \
         CROSS JOIN subscriptions s\n    WHERE c.group_id = '{group}' AND c.acquisition_source = '{channel}'\n        \
         AND s.customer_id = c.customer_id AND s.first_billing_done = 1\n    GROUP BY 1\n)\nSELECT (day + 6) / 7 AS week, \
         sum(leads_generated) AS leads, sum(spend) AS spend,\n    round(sum(spend) / nullif(sum(leads_generated), 0), 2) AS \
         dollars_per_lead, b.first_bills,\n    round(sum(spend) / b.first_bills, 2) AS dollars_per_first_bill\n\
         FROM ad_channel_leads\nLEFT JOIN bills b ON b.week = (day + 6) / 7\nWHERE channel_id = '{channel}' AND group_id = \
         '{group}'\nGROUP BY 1\nORDER BY 1 DESC"
    )
}
