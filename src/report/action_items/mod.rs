//! Problems of the company that need action, diagnosed from visible data and ranked by the money at risk.
//!
//! Every action item states the object, the problem and the amount. The item links to a form with proposed arguments, a
//! thread, a group or the ledger. An amount is proposed only if it follows from a formula in the documentation of the
//! tools. Baseline runs receive no proposals.

mod advertising;
mod cash;
mod conversion;
mod offer_changes;
#[cfg(test)]
mod property_tests;
mod retention;
mod selling;
mod service;
#[cfg(test)]
mod tests;

use serde_json::Value;

use crate::formatting::{format_money, pluralize};
use novamind_record::figures::WeekFigures;
use novamind_session::identifiers::{ByGroup, Channel, Group};
use novamind_session::{
    CoreSettings, Decisions, DeliveredQuality, Estimates, GroupWeek, Observation, Session, ToolLimits,
};
use novamind_tools::ToolId;

/// Kind of problem. If two problems have the same money at risk, the earlier variant is listed first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Problem {
    /// Cash will be used up within a few weeks.
    Runway,
    /// Threads with enterprises end within a week unless the player answers.
    Threads,
    /// No plan has a price.
    NoPrice,
    /// Plans that have a price have a quota of 0.
    NoQuota,
    /// No channel brings leads.
    NoLeads,
    /// Leads of a group do not sign up.
    NoSales(Group),
    /// The conversion of a group fell by more than chance can explain.
    ConversionFall(Group),
    /// The subscribers of a plan cost more than they pay.
    Margin,
    /// Usage exceeded capacity in the last week.
    Overload,
    /// The service had outages in the last week.
    Outages,
    /// Subscribers are waiting for support.
    Backlog,
    /// More subscribers of a group cancelled than chance can explain.
    Churn(Group),
    /// Enterprises of a group find no plan with sufficient quality.
    NoRequests(Group),
    /// Ads for a group have brought no signup, or no request for an offer, in several weeks.
    NoAdResults(Group),
    /// Leads of a group in a channel have become expensive.
    LeadCost(Channel, Group),
    /// Usage will soon exceed capacity.
    Capacity,
}

impl Problem {
    /// Returns the ID of the problem for programs.
    pub fn id(self) -> &'static str {
        match self {
            Problem::Runway => "runway",
            Problem::Threads => "threads",
            Problem::NoPrice => "no_price",
            Problem::NoQuota => "no_quota",
            Problem::NoLeads => "no_leads",
            Problem::NoSales(_) => "no_sales",
            Problem::ConversionFall(_) => "conversion_fall",
            Problem::Margin => "margin",
            Problem::Overload => "overload",
            Problem::Outages => "outages",
            Problem::Backlog => "backlog",
            Problem::Churn(_) => "churn",
            Problem::NoRequests(_) => "unwanted",
            Problem::NoAdResults(_) => "no_ad_results",
            Problem::LeadCost(..) => "lead_cost",
            Problem::Capacity => "capacity",
        }
    }
}

/// Where the player can solve a problem.
#[derive(Debug, Clone, PartialEq)]
pub enum ActionTarget {
    /// The form of a tool, filled with these arguments.
    Call(ToolId, Value),
    /// The thread with this number, where the player can answer.
    Thread(u32),
    /// The page of a group, which shows its requirements.
    Group(Group),
    /// The ledger, which shows all income and costs.
    Ledger,
}

/// A problem that needs action.
#[derive(Debug, Clone, PartialEq)]
pub struct ActionItem {
    /// Which problem it is, and for which group or channel.
    pub problem: Problem,
    /// Sentences that describe the problem and its amounts.
    pub text: String,
    /// Sentences that propose a solution; `None` if nothing is proposed.
    pub proposal: Option<String>,
    /// Where the player can solve the problem.
    pub target: ActionTarget,
    /// Money at risk over the next four weeks, dollars.
    pub at_risk: f64,
    /// Whether the company loses money if the player waits another week.
    pub is_urgent: bool,
}

struct DiagnosisContext<'a> {
    observation: Observation,
    settings: CoreSettings,
    /// Total advertising budget, dollars per day.
    daily_ad_spend: f64,
    ads_by_group: ByGroup<f64>,
    weeks: &'a [WeekFigures],
    groups: &'a [ByGroup<GroupWeek>],
    decisions: &'a [Decisions],
    quality: Vec<DeliveredQuality>,
    estimates: Vec<Estimates>,
    terms: ToolLimits,
    session: &'a Session,
}

/// Number of days for which money at risk is computed.
const RISK_DAYS: f64 = 28.0;
/// Minimum money at risk for a report, as a share of upcoming revenue plus upcoming costs.
const MIN_RISK_SHARE: f64 = 0.01;
const DAYS_PER_MONTH: f64 = 30.0;
/// Largest deviation of a weekly figure that is attributed to chance, in standard errors. A normally distributed error
/// exceeds three standard errors in one direction once in 740 weeks. A company with ten groups therefore has a false
/// report about once in 74 weeks.
const MAX_CHANCE: f64 = 3.0;

impl<'a> DiagnosisContext<'a> {
    fn new(session: &'a Session) -> DiagnosisContext<'a> {
        let settings = session.settings();
        let mut ads_by_group = ByGroup::default();
        for (group, dollars) in settings.targeted_ads.targeted_spend.values().flatten() {
            ads_by_group[*group] += dollars;
        }
        DiagnosisContext {
            observation: session.company().observe(),
            settings: settings.core,
            daily_ad_spend: settings.targeted_ads.total(),
            ads_by_group,
            weeks: session.weeks(),
            groups: session.company().group_weeks(),
            decisions: session.company().decisions(),
            quality: session.company().delivered_quality(),
            estimates: session.company().estimates(),
            terms: session.company().tool_limits(),
            session,
        }
    }

    fn last_week(&self) -> Option<&WeekFigures> {
        self.weeks.last()
    }

    fn last_group_week(&self) -> Option<&ByGroup<GroupWeek>> {
        self.groups.last()
    }

    /// Returns the recurring revenue expected over the next four weeks, dollars.
    fn upcoming_revenue(&self) -> f64 {
        self.last_week().map_or(0.0, |week| week.recurring_revenue) * RISK_DAYS / DAYS_PER_MONTH
    }

    /// Returns the cost of the current settings over the next four weeks, dollars.
    fn upcoming_costs(&self) -> f64 {
        self.observation.committed * RISK_DAYS
    }

    fn individuals(&self) -> impl Iterator<Item = &Estimates> {
        self.estimates.iter().filter(|estimate| !estimate.group.is_enterprise())
    }

    fn group_estimates(&self, group: Group) -> Option<&Estimates> {
        self.estimates.iter().find(|estimate| estimate.group == group)
    }

    fn group_quality(&self, group: Group) -> Option<&DeliveredQuality> {
        self.quality.iter().find(|quality| quality.group == group)
    }
}

/// Returns the problems that need action: urgent problems first, then by money at risk. Returns an empty list if the
/// run has ended.
pub fn action_items(session: &Session) -> Vec<ActionItem> {
    if session.ended().is_some() {
        return Vec::new();
    }
    let situation = DiagnosisContext::new(session);
    let mut found: Vec<ActionItem> = Vec::new();
    found.extend(cash::diagnose_runway(&situation));
    found.extend(retention::expiring_threads(&situation));
    found.extend(selling::missing_offers(&situation));
    found.extend(selling::missing_leads(&situation));
    found.extend(selling::groups_without_sales(&situation));
    found.extend(conversion::conversion_falls(&situation));
    found.extend(advertising::groups_without_requests(&situation));
    // Other items name the reason why leads do not sign up, or request no offer.
    let is_explained = |group: Group| {
        let of_group = |item: &ActionItem| matches!(item.problem, Problem::NoSales(other) | Problem::NoRequests(other) if other == group);
        found.iter().any(of_group)
    };
    let mut fruitless = advertising::ads_without_results(&situation);
    fruitless.retain(|item| !matches!(item.problem, Problem::NoAdResults(group) if is_explained(group)));
    found.extend(fruitless);
    found.extend(advertising::rising_lead_costs(&situation));
    found.extend(cash::unprofitable_plans(&situation));
    found.extend(service::diagnose_capacity(&situation));
    found.extend(service::diagnose_outages(&situation));
    found.extend(service::diagnose_backlog(&situation));
    found.extend(retention::churn_waves(&situation));
    let moved = situation.upcoming_revenue() + situation.upcoming_costs();
    // Waiting threads and unprofitable plans are reported even if little money is at risk: an unanswered thread ends,
    // and the loss of a plan grows with its sales.
    let is_always_reported = |problem: Problem| matches!(problem, Problem::Threads | Problem::Margin);
    found.retain(|need| is_always_reported(need.problem) || need.at_risk >= MIN_RISK_SHARE * moved);
    // Problems that link to a tool that the lesson has locked are not reported.
    let is_locked =
        |tool: ToolId| session.lesson().is_some_and(|lesson_progress| !lesson_progress.has_tool(tool));
    found.retain(|need| !matches!(need.target, ActionTarget::Call(tool, _) if is_locked(tool)));
    if !session.rules().advice {
        found.iter_mut().for_each(ActionItem::remove_proposals);
    }
    found.sort_by(|left, right| {
        let order = (!left.is_urgent).cmp(&!right.is_urgent);
        order.then(right.at_risk.total_cmp(&left.at_risk)).then(left.problem.cmp(&right.problem))
    });
    found
}

/// Describes the result if there are no action items. States the loss of the last week, because no rule reports a loss
/// that cash covers for a long time.
pub fn describe_no_items(last_week: Option<&WeekFigures>, runway_weeks: Option<f64>) -> String {
    let none = "No rule found a problem.";
    let Some(week) = last_week.filter(|week| week.cash_change < 0.0) else { return none.to_owned() };
    let lasts = runway_weeks.map_or(String::new(), |weeks| {
        format!(" Cash is expected to last {}.", pluralize(weeks as u32, "week"))
    });
    format!(
        "{none} Cash fell by {} last week: payments {}, running costs {}.{lasts}",
        format_money(-week.cash_change),
        format_money(week.payments),
        format_money(week.costs)
    )
}

impl ActionItem {
    fn remove_proposals(&mut self) {
        self.proposal = None;
        if let ActionTarget::Call(_, arguments) = &mut self.target {
            *arguments = Value::Null;
        }
    }

    /// Describes the problem and the proposed solution.
    pub fn describe(&self) -> String {
        match &self.proposal {
            Some(proposal) => format!("{} {proposal}", self.text),
            None => self.text.clone(),
        }
    }
}

/// Rounds an amount up to two significant digits, so that proposals contain round numbers.
fn round_up_to_two_digits(value: f64) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    let unit = libm::pow(10.0, libm::log10(value).floor() - 1.0);
    (value / unit).ceil() * unit
}
