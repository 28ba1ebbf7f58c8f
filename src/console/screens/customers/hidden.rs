//! True values of groups in the table, if the x-ray is open.

use novamind_base::notation::grouped;
use novamind_insight::TrueGroup;
use novamind_session::identifiers::Group;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Cell;
use novamind_worker::company::Company;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrueValue {
    Satisfaction,
    Reputation,
    Leads,
    Market,
}

impl TrueValue {
    /// Returns the name in titles, such as `true satisfaction`.
    pub fn title(self) -> &'static str {
        match self {
            TrueValue::Satisfaction => "true satisfaction",
            TrueValue::Reputation => "true reputation",
            TrueValue::Leads => "true expected leads",
            TrueValue::Market => "true market cap",
        }
    }

    pub fn cell(self, group: Group, company: &Company) -> Cell {
        let value = company.hidden.as_ref().and_then(|hidden| self.of(&hidden.groups[group]));
        let cell = match value {
            Some((value, text)) => Cell::number(value, text),
            None => Cell::words("–"),
        };
        cell.role(Role::Changed)
    }

    fn of(self, own: &TrueGroup) -> Option<(f64, String)> {
        match self {
            TrueValue::Satisfaction => own.satisfaction.map(|value| (value, grouped(value, 3))),
            TrueValue::Reputation => Some((own.reputation, grouped(own.reputation, 3))),
            TrueValue::Leads => own.is_known.then(|| (own.expected_leads, grouped(own.expected_leads, 1))),
            TrueValue::Market => Some(match own.market_cap {
                cap if cap > 0.0 => (cap, grouped(cap, 0)),
                _ => (f64::INFINITY, "no limit".to_owned()),
            }),
        }
    }
}
