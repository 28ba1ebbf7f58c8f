//! True values of groups in the table of groups. A key shows and hides true values.

use novamind_base::formatting::grouped_number;
use novamind_insight::TrueGroupValues;
use novamind_session::identifiers::Group;
use novamind_tui::theme::Role;
use novamind_tui::widgets::TableCell;
use novamind_worker::company::DisplayedCompany;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrueValue {
    Satisfaction,
    Reputation,
    Leads,
    Market,
}

impl TrueValue {
    /// Returns the name of the value for titles, for example `true satisfaction`.
    pub fn title(self) -> &'static str {
        match self {
            TrueValue::Satisfaction => "true satisfaction",
            TrueValue::Reputation => "true reputation",
            TrueValue::Leads => "true expected leads",
            TrueValue::Market => "true market cap",
        }
    }

    pub fn cell(self, group: Group, company: &DisplayedCompany) -> TableCell {
        let value = company.hidden_values.as_ref().and_then(|hidden| self.value_and_text(&hidden.groups[group]));
        let cell = match value {
            Some((value, text)) => TableCell::from_number(value, text),
            None => TableCell::from_text("–"),
        };
        cell.with_role(Role::Changed)
    }

    fn value_and_text(self, group_values: &TrueGroupValues) -> Option<(f64, String)> {
        match self {
            TrueValue::Satisfaction => group_values.satisfaction.map(|value| (value, grouped_number(value, 3))),
            TrueValue::Reputation => Some((group_values.reputation, grouped_number(group_values.reputation, 3))),
            TrueValue::Leads => group_values.is_known.then(|| (group_values.expected_leads, grouped_number(group_values.expected_leads, 1))),
            TrueValue::Market => Some(match group_values.market_cap {
                cap if cap > 0.0 => (cap, grouped_number(cap, 0)),
                _ => (f64::INFINITY, "no limit".to_owned()),
            }),
        }
    }
}
