//! What needs the person: a diagnosis of the company from what a player may see, ranked by the money at risk.
//!
//! Every need says what is wrong with which object and by how much, and leads to where it is mended: a call whose
//! arguments are proposed, a thread, a group, the books. Where a proposal follows from a formula that the tools
//! document, the need names its amount. In a baseline run nothing is proposed: its player gets no advice.

mod advertising;
mod money;
mod people;
mod selling;
mod service;
#[cfg(test)]
mod tests;

use serde_json::Value;

use novamind_record::figures::WeekFigures;
use novamind_session::identifiers::{ByGroup, Channel, Group};
use novamind_session::{
    CoreSettings, Decisions, DeliveredQuality, Estimates, GroupWeek, Observation, Session, ToolLimits,
};
use novamind_tools::ToolId;

/// What is wrong. Of two needs with the same money at risk the one that stands first here comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Problem {
    /// Cash will not last.
    Runway,
    /// Companies wait for an answer.
    Threads,
    /// No plan has a price.
    NoPrice,
    /// Plans with a price have a quota of 0.
    NoQuota,
    /// Nobody hears of the company.
    NoLeads,
    /// Leads of a group come and do not sign.
    NoSales(Group),
    /// Individuals on a plan cost more than they pay.
    Margin,
    /// Usage went above capacity.
    Overload,
    /// The service was down.
    Outages,
    /// Subscribers wait for support.
    Backlog,
    /// A group is leaving.
    Churn(Group),
    /// Companies of a group find no plan good enough at any price.
    Unwanted(Group),
    /// Leads of a group have become dear in a channel.
    LeadCost(Channel, Group),
    /// Usage will soon be above capacity.
    Capacity,
}

impl Problem {
    /// Word for programs.
    pub fn id(self) -> &'static str {
        match self {
            Problem::Runway => "runway",
            Problem::Threads => "threads",
            Problem::NoPrice => "no_price",
            Problem::NoQuota => "no_quota",
            Problem::NoLeads => "no_leads",
            Problem::NoSales(_) => "no_sales",
            Problem::Margin => "margin",
            Problem::Overload => "overload",
            Problem::Outages => "outages",
            Problem::Backlog => "backlog",
            Problem::Churn(_) => "churn",
            Problem::Unwanted(_) => "unwanted",
            Problem::LeadCost(..) => "lead_cost",
            Problem::Capacity => "capacity",
        }
    }
}

/// Where a need is looked after.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// The form of a tool, with these arguments proposed.
    Call(ToolId, Value),
    /// The thread of this number.
    Thread(u32),
    /// A group.
    Group(Group),
    /// The books.
    Books,
}

/// Something that needs the person.
#[derive(Debug, Clone, PartialEq)]
pub struct Need {
    /// What is wrong.
    pub problem: Problem,
    /// The same in words, with the amounts.
    pub text: String,
    /// What would mend it; none where nothing is proposed.
    pub proposal: Option<String>,
    /// Where it is looked after.
    pub place: Place,
    /// Dollars of the next four weeks that are at risk.
    pub at_risk: f64,
    /// It costs something not to act before the next week.
    pub urgent: bool,
}

/// What a diagnosis looks at.
struct Situation<'a> {
    seen: Observation,
    settings: CoreSettings,
    /// Advertising, dollars a day: in all, and for each group.
    ads: f64,
    ads_by_group: ByGroup<f64>,
    weeks: &'a [WeekFigures],
    groups: &'a [ByGroup<GroupWeek>],
    decisions: &'a [Decisions],
    quality: Vec<DeliveredQuality>,
    estimates: Vec<Estimates>,
    terms: ToolLimits,
    session: &'a Session,
}

/// Days that money at risk is counted for.
const AHEAD: f64 = 28.0;
/// Share of the money that moves below which nothing is a need.
const SMALL: f64 = 0.01;
/// Days of a month of billing.
const MONTH: f64 = 30.0;

impl<'a> Situation<'a> {
    fn of(session: &'a Session) -> Situation<'a> {
        let settings = session.settings();
        let mut ads_by_group = ByGroup::default();
        for (group, dollars) in settings.targeted_ads.targeted_spend.values().flatten() {
            ads_by_group[*group] += dollars;
        }
        Situation {
            seen: session.company().observe(),
            settings: settings.core,
            ads: settings.targeted_ads.total(),
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

    fn week(&self) -> Option<&WeekFigures> {
        self.weeks.last()
    }

    fn group_week(&self) -> Option<&ByGroup<GroupWeek>> {
        self.groups.last()
    }

    /// Recurring revenue of the next four weeks.
    fn revenue_ahead(&self) -> f64 {
        self.week().map_or(0.0, |week| week.recurring_revenue) * AHEAD / MONTH
    }

    /// What the settings cost in the next four weeks.
    fn commitments_ahead(&self) -> f64 {
        self.seen.pace.committed * AHEAD
    }

    fn individuals(&self) -> impl Iterator<Item = &Estimates> {
        self.estimates.iter().filter(|estimate| !estimate.group.is_enterprise())
    }

    fn estimate(&self, group: Group) -> Option<&Estimates> {
        self.estimates.iter().find(|estimate| estimate.group == group)
    }

    fn quality(&self, group: Group) -> Option<&DeliveredQuality> {
        self.quality.iter().find(|quality| quality.group == group)
    }
}

/// What needs the person now, the most urgent first and of those the costliest; nothing once the run is over.
pub fn needs(session: &Session) -> Vec<Need> {
    if session.ended().is_some() {
        return Vec::new();
    }
    let situation = Situation::of(session);
    let mut found: Vec<Need> = Vec::new();
    found.extend(money::runway(&situation));
    found.extend(people::threads(&situation));
    found.extend(selling::nothing_on_sale(&situation));
    found.extend(selling::no_leads(&situation));
    found.extend(selling::no_sales(&situation));
    found.extend(advertising::unwanted(&situation));
    found.extend(advertising::lead_costs(&situation));
    found.extend(money::margin(&situation));
    found.extend(service::capacity(&situation));
    found.extend(service::outages(&situation));
    found.extend(service::backlog(&situation));
    found.extend(people::churn(&situation));
    let moved = situation.revenue_ahead() + situation.commitments_ahead();
    // Somebody who waits is named, however little they pay.
    found.retain(|need| need.problem == Problem::Threads || need.at_risk >= SMALL * moved);
    // Nobody is sent to a form that the lesson keeps shut.
    let is_locked = |tool: ToolId| session.lesson().is_some_and(|own| !own.has_tool(tool));
    found.retain(|need| !matches!(need.place, Place::Call(tool, _) if is_locked(tool)));
    if !session.rules().advice {
        found.iter_mut().for_each(Need::keep_to_facts);
    }
    found.sort_by(|left, right| {
        let order = (!left.urgent).cmp(&!right.urgent);
        order.then(right.at_risk.total_cmp(&left.at_risk)).then(left.problem.cmp(&right.problem))
    });
    found
}

impl Need {
    /// Takes the advice out.
    fn keep_to_facts(&mut self) {
        self.proposal = None;
        if let Place::Call(_, arguments) = &mut self.place {
            *arguments = Value::Null;
        }
    }

    /// What is wrong and what would mend it.
    pub fn in_words(&self) -> String {
        match &self.proposal {
            Some(proposal) => format!("{}; {proposal}", self.text),
            None => self.text.clone(),
        }
    }
}

/// An amount rounded up to two digits, for proposals that name a round figure.
fn rounded_up(value: f64) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    let unit = libm::pow(10.0, libm::log10(value).floor() - 1.0);
    (value / unit).ceil() * unit
}
