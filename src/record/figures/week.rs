//! Figures of a week that are visible to the player.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::category_totals::CategoryTotals;
use novamind_base::formatting::json_number;
use novamind_world::events::{
    Category, DayFigures, Facts, LedgerEntry, Notice, Sender, SubscriptionEnded, SubscriptionStatus,
};
use novamind_world::params::Params;

/// Figures of a complete week, or of the simulated days of an incomplete week.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct WeekFigures {
    /// Last simulated day of the week.
    pub day: u32,
    /// Number of simulated days in the week.
    pub days_run: u32,
    /// Cash after the last simulated day, dollars.
    pub cash: f64,
    /// Cash change over the simulated days, dollars.
    pub cash_change: f64,
    /// Active subscriptions of individuals.
    pub individual_subscribers: u32,
    /// Number of seats of active enterprises.
    pub enterprise_seats: u32,
    /// Active subscribers with an open issue.
    pub open_issues: u32,
    /// Number of new issues.
    pub issues_opened: u32,
    /// Usage of all subscribers, in units.
    pub usage: u64,
    /// Number of individual leads.
    pub new_individual_leads: u32,
    /// Number of enterprise leads that opened a thread.
    pub new_enterprise_leads: u32,
    /// Number of individuals who signed up.
    pub new_individual_subscribers: u32,
    /// Seats of enterprises with a new contract.
    pub new_enterprise_seats: u32,
    /// Number of cancellations by individuals.
    pub cancellations: u32,
    /// Number of switches to higher-priced plans.
    pub upgrades: u32,
    /// Number of switches to lower-priced plans.
    pub downgrades: u32,
    /// Number of enterprises that cancelled.
    pub companies_lost: u32,
    /// Seats of the enterprises that cancelled.
    pub seats_lost: u32,
    /// Usage of the busiest day, in units.
    pub busiest_day: u64,
    /// Highest daily overload in the week.
    pub overload_peak: f64,
    /// Total outage time in the week, in minutes.
    pub downtime_minutes: u32,
    /// Whether an outage occurred on any day of the week.
    pub outage: bool,
    /// Highest daily 95th-percentile latency in the week, in milliseconds.
    pub p95_ms_peak: f64,
    /// Highest daily error rate in the week.
    pub error_rate_peak: f64,
    /// Ledger totals by category since the end of the previous week.
    pub booked: CategoryTotals,
    /// Payments of subscribers, dollars.
    pub payments: f64,
    /// Running costs, dollars.
    pub costs: f64,
    /// Monthly recurring revenue after the last simulated day, dollars.
    pub recurring_revenue: f64,
    /// Number of new threads.
    pub threads_opened: u32,
    /// Seats of the enterprises in new threads.
    pub thread_seats: u32,
    /// Number of replies by enterprises in threads.
    #[serde(default)]
    pub replies: u32,
    /// Number of completed R&D projects and market studies.
    #[serde(default)]
    pub research_finished: u32,
}

impl WeekFigures {
    /// Returns individual signups as a share of individual leads, 0 to 1, or NaN if there were no leads.
    pub fn conversion(&self) -> f64 {
        match self.new_individual_leads {
            0 => f64::NAN,
            leads => f64::from(self.new_individual_subscribers) / f64::from(leads),
        }
    }

    /// Adds a simulated day: its figures, its facts, and the ledger entries of calls before that day.
    pub fn add_simulated_day(
        &mut self,
        figures: &DayFigures,
        facts: &Facts,
        called: &[LedgerEntry],
        params: &Params,
    ) {
        self.add_day_figures(figures);
        let leads = f64::from(figures.new_leads) * params.leads.lead_acquisition_cost;
        self.booked.add(Category::LeadAcquisitionCost, -leads);
        self.booked.add(Category::SubscriptionPayment, figures.payments_received);
        for entry in called.iter().chain(&facts.ledger) {
            self.booked.add(entry.category, entry.amount);
        }
        for turn in facts.turns.iter().filter(|turn| turn.number == 0) {
            self.threads_opened += 1;
            self.thread_seats += turn.seats;
        }
        self.issues_opened += facts.issues_opened.len() as u32;
        let replies = facts.turns.iter().filter(|turn| turn.sender == Sender::Customer);
        self.replies += replies.filter(|turn| turn.number > 0).count() as u32;
        let finished = |notice: &&Notice| {
            matches!(notice, Notice::ResearchComplete { .. } | Notice::StudyComplete { .. })
        };
        self.research_finished += facts.notices.iter().filter(finished).count() as u32;
        let left = |ending: &&SubscriptionEnded| {
            ending.group.is_enterprise() && ending.status == SubscriptionStatus::Cancelled
        };
        for ending in facts.endings.iter().filter(left) {
            self.companies_lost += 1;
            self.seats_lost += ending.seats;
        }
    }

    /// Adds the figures of a day. Flows are summed, peaks keep the maximum, and stocks take the value of the added day.
    pub fn add_day_figures(&mut self, day: &DayFigures) {
        self.day = day.day;
        self.days_run += 1;
        self.cash = day.cash;
        self.individual_subscribers = day.individual_subscribers;
        self.enterprise_seats = day.enterprise_seats;
        self.recurring_revenue = day.mrr;
        self.usage += day.total_usage;
        self.busiest_day = self.busiest_day.max(day.total_usage);
        self.new_individual_leads += day.new_individual_leads;
        self.new_enterprise_leads += day.new_enterprise_leads;
        self.new_individual_subscribers += day.new_individual_subscribers;
        self.new_enterprise_seats += day.new_enterprise_seats;
        self.cancellations += day.cancellations;
        self.upgrades += day.upgrades;
        self.downgrades += day.downgrades;
        self.payments += day.payments_received;
        self.costs += day.total_costs;
        self.downtime_minutes += day.downtime_minutes;
        self.outage |= day.outage;
        self.overload_peak = self.overload_peak.max(day.overload);
        self.p95_ms_peak = self.p95_ms_peak.max(day.p95_ms);
        self.error_rate_peak = self.error_rate_peak.max(day.error_rate);
    }

    /// Returns the figures of the week by key, for `week` lines and JSON output.
    pub fn to_json(&self) -> Map<String, Value> {
        let figures = json!({
            "cash": json_number(self.cash),
            "individual_subscribers": self.individual_subscribers,
            "enterprise_seats": self.enterprise_seats,
            "open_issues": self.open_issues,
            "usage": self.usage,
            "new_individual_leads": self.new_individual_leads,
            "new_enterprise_leads": self.new_enterprise_leads,
            "new_individual_subscribers": self.new_individual_subscribers,
            "new_enterprise_seats": self.new_enterprise_seats,
            "cancellations": self.cancellations,
            "upgrades": self.upgrades,
            "downgrades": self.downgrades,
            "overload_peak": json_number(self.overload_peak),
            "downtime_minutes": self.downtime_minutes,
            "p95_ms_peak": json_number(self.p95_ms_peak),
            "error_rate_peak": json_number(self.error_rate_peak),
            "payments": json_number(self.payments),
            "costs": json_number(self.costs),
            "recurring_revenue": json_number(self.recurring_revenue),
        });
        match figures {
            Value::Object(map) => map,
            _ => Map::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn week_figures_sum_usage_and_keep_peaks() {
        let mut week = WeekFigures::default();
        for day in 1..=7u32 {
            let outage = day == 3;
            week.add_day_figures(&DayFigures {
                day,
                total_usage: u64::from(day) * 10,
                outage,
                downtime_minutes: if outage { 30 } else { 0 },
                overload: if day == 5 { 0.4 } else { 0.1 },
                ..DayFigures::default()
            });
        }
        assert_eq!(
            (week.usage, week.outage, week.downtime_minutes, week.overload_peak),
            (280, true, 30, 0.4)
        );
        assert_eq!((week.day, week.days_run), (7, 7));
    }
}
