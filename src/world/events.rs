//! Facts of a day: what happened, as plain data, for whoever records it.
//!
//! Mechanisms push facts; `database` turns them into rows and `voice` some of them into words. A fact holds
//! codes and numbers, never a text, and nothing in it is read back by the world. Order within a list is the
//! order in which things happened.

use super::canonical::{canonical, canonical_codes};
use super::customers::persona::PersonaPicks;
use super::identifiers::{Channel, Group, Plan};
use super::market::economy::Reading;
use super::product::research::Project;
use super::settings::{
    AdsStrength, CoreSettings, LeadPromotion, Promotion, TargetedAds, TargetedDevelopment, TargetedOperations,
};

/// Everything that happened on one day, or through the tools after it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Facts {
    /// The day all facts belong to.
    pub day: u32,
    /// Settings that were changed, complete after the change.
    pub settings: Vec<SettingsChange>,
    /// Usage of every active subscription, in pieces.
    pub usage: Vec<UsageRows>,
    /// Service health.
    pub service: Option<ServiceDay>,
    /// R&D projects that started or finished.
    pub research: Vec<ResearchChange>,
    /// Readings of the economy that were published.
    pub readings: Vec<Reading>,
    /// Issues that were solved, by number.
    pub issues_resolved: Vec<u32>,
    /// Whether the open issues aged by a day.
    pub issues_aged: bool,
    /// Issues that were opened.
    pub issues_opened: Vec<IssueOpened>,
    /// Subscriptions that ended.
    pub endings: Vec<SubscriptionEnded>,
    /// Subscriptions whose terms changed; the last one of a subscription holds.
    pub changes: Vec<TermsChanged>,
    /// Turns of enterprise threads.
    pub turns: Vec<ThreadTurn>,
    /// Leads by paid channel and group.
    pub channel_leads: Vec<ChannelLeads>,
    /// New customers.
    pub arrivals: Vec<Arrival>,
    /// New subscriptions, in the order of their numbers.
    pub openings: Vec<SubscriptionOpened>,
    /// Payments of subscribers.
    pub payments: Vec<Payment>,
    /// Other movements of cash.
    pub ledger: Vec<LedgerEntry>,
    /// Subscribers who earned ad revenue.
    pub ads_revenue: Vec<AdsRevenueRow>,
    /// Notifications.
    pub notices: Vec<Notice>,
}

canonical! {
    Facts {
        day, settings, usage, service, research, readings, issues_resolved, issues_aged, issues_opened, endings,
        changes, turns, channel_leads, arrivals, openings, payments, ledger, ads_revenue, notices,
    }
    UsageRows { customers, units }
    ServiceDay { total_usage, overload, outage, downtime_minutes, p95_ms, error_rate, capacity_tier, capacity_units }
    IssueOpened { issue, customer, group }
    SubscriptionEnded { subscription, customer, group, seats, day, status, cause }
    TermsChanged { subscription, customer, plan, listed_price, promotion, effective_price, seats, billed_once }
    ThreadTurn { thread, customer, kind, number, sender, seats }
    ChannelLeads { channel, group, leads, spend }
    Arrival { customer, group, n, source, persona, usage_demand, c_max, seats }
    SubscriptionOpened { subscription, customer, plan, status, listed_price, promotion, effective_price, seats }
    Payment { customer, amount }
    LedgerEntry { category, amount, note }
    AdsRevenueRow { customer, group, strength, revenue }
}
canonical_codes!(Source, SubscriptionStatus, EndCause, ThreadKind, Sender, Category);

impl Facts {
    /// Forgets everything and starts a day, keeping the memory.
    pub fn begin(&mut self, day: u32) {
        let Facts {
            day: own_day,
            settings,
            usage,
            service,
            research,
            readings,
            issues_resolved,
            issues_aged,
            issues_opened,
            endings,
            changes,
            turns,
            channel_leads,
            arrivals,
            openings,
            payments,
            ledger,
            ads_revenue,
            notices,
        } = self;
        *own_day = day;
        (*service, *issues_aged) = (None, false);
        settings.clear();
        usage.clear();
        research.clear();
        readings.clear();
        issues_resolved.clear();
        issues_opened.clear();
        endings.clear();
        changes.clear();
        turns.clear();
        channel_leads.clear();
        arrivals.clear();
        openings.clear();
        payments.clear();
        ledger.clear();
        ads_revenue.clear();
        notices.clear();
    }
}

/// A family of settings after a call of its tool.
#[derive(Debug, Clone, PartialEq)]
pub enum SettingsChange {
    /// A row of `config_history`.
    Core(CoreSettings),
    /// Ongoing discounts.
    Promotion(Promotion),
    /// Lead discounts.
    LeadPromotion(LeadPromotion),
    /// In-app ads.
    AdsStrength(AdsStrength),
    /// Advertising budgets.
    TargetedAds(TargetedAds),
    /// Targeted operations.
    TargetedOperations(TargetedOperations),
    /// Targeted development.
    TargetedDevelopment(TargetedDevelopment),
}

impl SettingsChange {
    /// The family as JSON, with the field names of `config_overrides.settings_json`; none for the core settings,
    /// which have a table of their own.
    pub fn family(&self) -> Option<serde_json::Value> {
        let value = match self {
            SettingsChange::Core(_) => return None,
            SettingsChange::Promotion(value) => serde_json::to_value(value),
            SettingsChange::LeadPromotion(value) => serde_json::to_value(value),
            SettingsChange::AdsStrength(value) => serde_json::to_value(value),
            SettingsChange::TargetedAds(value) => serde_json::to_value(value),
            SettingsChange::TargetedOperations(value) => serde_json::to_value(value),
            SettingsChange::TargetedDevelopment(value) => serde_json::to_value(value),
        };
        Some(value.expect("settings have text keys and finite numbers"))
    }
}

impl super::canonical::Canonical for SettingsChange {
    fn feed(&self, hasher: &mut super::canonical::CanonicalHasher) {
        match self {
            SettingsChange::Core(value) => (0u8, *value).feed(hasher),
            SettingsChange::Promotion(value) => (1u8, value.clone()).feed(hasher),
            SettingsChange::LeadPromotion(value) => (2u8, value.clone()).feed(hasher),
            SettingsChange::AdsStrength(value) => (3u8, value.clone()).feed(hasher),
            SettingsChange::TargetedAds(value) => (4u8, value.clone()).feed(hasher),
            SettingsChange::TargetedOperations(value) => (5u8, value.clone()).feed(hasher),
            SettingsChange::TargetedDevelopment(value) => (6u8, value.clone()).feed(hasher),
        }
    }
}

/// Usage of a run of customers of one group, in ascending order of their numbers.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct UsageRows {
    /// Customer numbers.
    pub customers: Vec<u32>,
    /// Units used by each.
    pub units: Vec<u32>,
}

/// Service health of a day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServiceDay {
    /// Units used by everybody.
    pub total_usage: u64,
    /// Usage above capacity, 0 when there was room.
    pub overload: f64,
    /// Whether there was an outage.
    pub outage: bool,
    /// Its length in minutes: 0, 10, 30 or 90.
    pub downtime_minutes: u32,
    /// Latency in milliseconds.
    pub p95_ms: f64,
    /// Share of failed requests, 0..=1.
    pub error_rate: f64,
    /// Capacity tier in force.
    pub capacity_tier: u8,
    /// Its units a day.
    pub capacity_units: u32,
}

impl ServiceDay {
    /// A day without load or trouble.
    pub fn quiet() -> ServiceDay {
        ServiceDay {
            total_usage: 0,
            overload: 0.0,
            outage: false,
            downtime_minutes: 0,
            p95_ms: 0.0,
            error_rate: 0.0,
            capacity_tier: 0,
            capacity_units: 0,
        }
    }
}

/// An R&D project that started or finished.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ResearchChange {
    /// Paid and begun.
    Started(Project),
    /// Finished today.
    Completed(Project),
}

impl super::canonical::Canonical for ResearchChange {
    fn feed(&self, hasher: &mut super::canonical::CanonicalHasher) {
        match self {
            ResearchChange::Started(project) => (0u8, *project).feed(hasher),
            ResearchChange::Completed(project) => (1u8, *project).feed(hasher),
        }
    }
}

/// A new support issue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IssueOpened {
    /// Running number of the issue.
    pub issue: u32,
    /// Whose.
    pub customer: u32,
    /// The customer's group.
    pub group: Group,
}

/// How a subscription came to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum EndCause {
    /// The payment failed for good.
    Involuntary,
    /// No plan was acceptable, and satisfaction was negative.
    Quality,
    /// No plan was acceptable at its price.
    Price,
    /// A company's lead waited too long for an answer.
    LeadTimeout,
}

/// Status of a subscription.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum SubscriptionStatus {
    /// A company that negotiates.
    Lead,
    /// Active.
    Subscribed,
    /// Ended by the customer.
    Cancelled,
    /// Never became a customer.
    Lost,
}

impl SubscriptionStatus {
    /// Word as the tables write it.
    pub fn id(self) -> &'static str {
        ["lead", "subscribed", "cancelled", "lost"][self as usize]
    }
}

/// A subscription ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SubscriptionEnded {
    /// Subscription number.
    pub subscription: u32,
    /// Customer number.
    pub customer: u32,
    /// The customer's group.
    pub group: Group,
    /// Whole seats.
    pub seats: u32,
    /// End day that is recorded.
    pub day: u32,
    /// Cancelled or lost.
    pub status: SubscriptionStatus,
    /// Why, known to nobody but the simulator.
    pub cause: EndCause,
}

/// Terms of a subscription after a bill, a switch of plan or a deal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TermsChanged {
    /// Subscription number.
    pub subscription: u32,
    /// Customer number.
    pub customer: u32,
    /// Plan.
    pub plan: Plan,
    /// Dollars a month and seat before discounts.
    pub listed_price: f64,
    /// Discount, dollars a month and seat.
    pub promotion: f64,
    /// Dollars a month and seat.
    pub effective_price: f64,
    /// Whole seats.
    pub seats: u32,
    /// Whether the first bill was made.
    pub billed_once: bool,
}

/// How an enterprise thread began.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum ThreadKind {
    /// A company asks for an offer.
    NewLead,
}

impl ThreadKind {
    /// Word as the tables write it.
    pub fn id(self) -> &'static str {
        match self {
            ThreadKind::NewLead => "new_lead",
        }
    }
}

/// Who wrote a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Sender {
    /// The market: opening and closing turns.
    System,
}

impl Sender {
    /// Word as the tables write it.
    pub fn id(self) -> &'static str {
        match self {
            Sender::System => "system",
        }
    }
}

/// One turn of an enterprise thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ThreadTurn {
    /// Running number of the thread.
    pub thread: u32,
    /// The company.
    pub customer: u32,
    /// How the thread began.
    pub kind: ThreadKind,
    /// Number of the turn within the thread, from 0.
    pub number: u32,
    /// Who wrote it.
    pub sender: Sender,
    /// Whole seats.
    pub seats: u32,
}

/// How a customer came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Source {
    /// Paid feeds.
    SocialMedia,
    /// Paid search.
    SearchAds,
    /// The business network.
    Linkedin,
    /// Articles and guides.
    ContentMarketing,
    /// Rewarded recommendations.
    ReferralProgram,
    /// Word of mouth.
    Network,
    /// Of its own accord; foreseen, but it cannot occur.
    Organic,
}

impl Source {
    /// All sources: the channels in channel order, then the two without a price.
    pub const ALL: [Source; 7] = [
        Source::SocialMedia,
        Source::SearchAds,
        Source::Linkedin,
        Source::ContentMarketing,
        Source::ReferralProgram,
        Source::Network,
        Source::Organic,
    ];

    /// The source that is a channel.
    pub fn of_channel(channel: Channel) -> Source {
        Source::ALL[channel.index()]
    }

    /// The channel, if it is one.
    pub fn channel(self) -> Option<Channel> {
        Channel::at(self as usize)
    }

    /// Word as the tables write it.
    pub fn id(self) -> &'static str {
        match self.channel() {
            Some(channel) => channel.id(),
            None if self == Source::Network => "network",
            None => "organic",
        }
    }
}

/// Leads of one paid pair of channel and group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelLeads {
    /// Channel.
    pub channel: Channel,
    /// Group.
    pub group: Group,
    /// Leads that came through it.
    pub leads: u32,
    /// Dollars spent.
    pub spend: f64,
}

/// A new customer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// Customer number.
    pub customer: u32,
    /// Group.
    pub group: Group,
    /// Running number within the group.
    pub n: u32,
    /// How it came.
    pub source: Source,
    /// Picks of its profile.
    pub persona: PersonaPicks,
    /// Mean demand, for the usage label of the profile.
    pub usage_demand: f64,
    /// Budget, for the budget label of the profile.
    pub c_max: f64,
    /// Whole seats.
    pub seats: u32,
}

/// A new subscription record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubscriptionOpened {
    /// Subscription number.
    pub subscription: u32,
    /// Customer number.
    pub customer: u32,
    /// Plan; none while a company negotiates.
    pub plan: Option<Plan>,
    /// Subscribed, lost or lead.
    pub status: SubscriptionStatus,
    /// Dollars a month before discounts.
    pub listed_price: f64,
    /// Discount, dollars a month.
    pub promotion: f64,
    /// Dollars a month.
    pub effective_price: f64,
    /// Whole seats.
    pub seats: u32,
}

/// A payment of a subscriber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Payment {
    /// Who paid.
    pub customer: u32,
    /// Dollars.
    pub amount: f64,
}

/// Category of a movement of cash (chapter 60 §5).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Category {
    /// Seed money.
    InitialFunding,
    /// Cost of a lead.
    LeadAcquisitionCost,
    /// Payment of a subscriber.
    SubscriptionPayment,
    /// Capacity of the day.
    Capacity,
    /// Compute of the day.
    Compute,
    /// Operations of the day.
    Operations,
    /// Development of the day.
    Development,
    /// Advertising of the day.
    Advertising,
    /// In-app ads of the day.
    AdRevenue,
    /// An attempt to find a group.
    MarketResearch,
    /// A study of a group.
    GroupResearch,
    /// An R&D project.
    ResearchProject,
}

impl Category {
    /// All categories.
    pub const ALL: [Category; 12] = [
        Category::InitialFunding,
        Category::LeadAcquisitionCost,
        Category::SubscriptionPayment,
        Category::Capacity,
        Category::Compute,
        Category::Operations,
        Category::Development,
        Category::Advertising,
        Category::AdRevenue,
        Category::MarketResearch,
        Category::GroupResearch,
        Category::ResearchProject,
    ];

    /// Word as the tables write it.
    pub fn id(self) -> &'static str {
        match self {
            Category::InitialFunding => "initial_funding",
            Category::LeadAcquisitionCost => "lead_acquisition_cost",
            Category::SubscriptionPayment => "subscription_payment",
            Category::Capacity => "capacity",
            Category::Compute => "compute",
            Category::Operations => "operations",
            Category::Development => "development",
            Category::Advertising => "advertising",
            Category::AdRevenue => "ad_revenue",
            Category::MarketResearch => "market_research",
            Category::GroupResearch => "group_research",
            Category::ResearchProject => "research_project",
        }
    }
}

/// A movement of cash that is no payment of a subscriber and no lead cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LedgerEntry {
    /// Category.
    pub category: Category,
    /// Dollars; costs are negative.
    pub amount: f64,
    /// What the note says.
    pub note: LedgerNote,
}

/// What the note of a movement says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LedgerNote {
    /// What the category says, for everybody.
    General,
    /// The part aimed at groups, plans or customers.
    Targeted,
    /// Ad revenue from so many active subscribers.
    Subscribers(u32),
    /// An R&D project: tier and number.
    Project(u8, u32),
}

impl super::canonical::Canonical for LedgerNote {
    fn feed(&self, hasher: &mut super::canonical::CanonicalHasher) {
        match *self {
            LedgerNote::General => (0u8, 0u32).feed(hasher),
            LedgerNote::Targeted => (1u8, 0u32).feed(hasher),
            LedgerNote::Subscribers(count) => (2u8, count).feed(hasher),
            LedgerNote::Project(tier, number) => (3u8, (tier, number)).feed(hasher),
        }
    }
}

/// Ad revenue of one subscriber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdsRevenueRow {
    /// Who saw the ads.
    pub customer: u32,
    /// The customer's group.
    pub group: Group,
    /// Effective strength, 0..=1.
    pub strength: f64,
    /// Dollars.
    pub revenue: f64,
}

/// A notification for the inbox; `voice` words it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Notice {
    /// A company asks for an offer.
    EnterpriseLead,
    /// A company got no answer for so many days.
    LeadLostByTimeout {
        /// Days since its last turn.
        days: u32,
    },
    /// An R&D project is finished.
    ResearchComplete {
        /// Tier, 1..=20.
        tier: u8,
        /// Number of the start of the tier.
        number: u32,
    },
    /// A reading of the economy was published.
    EconomyUpdate(Reading),
}

impl Notice {
    /// Type as the tables write it.
    pub fn kind(&self) -> &'static str {
        match self {
            Notice::EnterpriseLead => "large_customer_message",
            Notice::LeadLostByTimeout { .. } => "lead_lost",
            Notice::ResearchComplete { .. } => "research_complete",
            Notice::EconomyUpdate(_) => "macro_economic_update",
        }
    }
}

impl super::canonical::Canonical for Notice {
    fn feed(&self, hasher: &mut super::canonical::CanonicalHasher) {
        match *self {
            Notice::EnterpriseLead => 0u8.feed(hasher),
            Notice::LeadLostByTimeout { days } => (1u8, days).feed(hasher),
            Notice::ResearchComplete { tier, number } => (2u8, (tier, number)).feed(hasher),
            Notice::EconomyUpdate(reading) => (3u8, reading).feed(hasher),
        }
    }
}

/// Figures of a day (chapter 20 §5, day result).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DayFigures {
    /// Day.
    pub day: u32,
    /// Units used.
    pub total_usage: u64,
    /// Usage above capacity.
    pub overload: f64,
    /// Whether there was an outage.
    pub outage: bool,
    /// Minutes of downtime.
    pub downtime_minutes: u32,
    /// Latency in milliseconds.
    pub p95_ms: f64,
    /// Share of failed requests.
    pub error_rate: f64,
    /// All leads, those that came to nothing included.
    pub new_leads: u32,
    /// Leads of individuals.
    pub new_individual_leads: u32,
    /// Leads of companies that opened a thread.
    pub new_enterprise_leads: u32,
    /// Individuals who signed up.
    pub new_individual_subscribers: u32,
    /// Seats of companies that signed today.
    pub new_enterprise_seats: u32,
    /// Cancellations of individuals, involuntary ones included.
    pub cancellations: u32,
    /// Switches to a dearer plan.
    pub upgrades: u32,
    /// Switches to a cheaper plan.
    pub downgrades: u32,
    /// Payments of subscribers, dollars.
    pub payments_received: f64,
    /// Running costs: capacity, compute, operations, development, advertising; dollars.
    pub total_costs: f64,
    /// Cash at the end of the day, dollars.
    pub cash: f64,
    /// Monthly recurring revenue at the end of the day, dollars.
    pub mrr: f64,
    /// Active subscriptions of individuals.
    pub individual_subscribers: u32,
    /// Seats of active companies.
    pub enterprise_seats: u32,
}
