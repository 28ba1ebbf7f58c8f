//! Facts about customers: arrival, terms, usage, departure.

use crate::canonical::{canonical, canonical_codes};
use crate::customers::persona::PersonaPicks;
use crate::identifiers::{Channel, Group, Plan};

canonical! {
    ChannelLeads { channel, group, leads, spend }
    Arrival { customer, group, n, source, persona, usage_demand, c_max, seats }
    SubscriptionOpened { subscription, customer, plan, status, listed_price, promotion, effective_price, seats }
    TermsChanged { subscription, customer, plan, listed_price, promotion, effective_price, seats, billed_once }
    SubscriptionEnded { subscription, customer, group, seats, day, status, cause }
    UsageRows { customers, units }
    IssueOpened { issue, customer, group }
    AdsRevenueRow { customer, group, strength, revenue }
}
canonical_codes! {
    Source { SocialMedia, SearchAds, Linkedin, ContentMarketing, ReferralProgram, Network, Organic }
    SubscriptionStatus { Lead, Subscribed, Cancelled, Lost }
    EndCause { Involuntary, Quality, Price, LeadTimeout, LeadSilent, LeadRejected, ExtendedIssue, QualityChange, QuotaChange, PriceSensitivity }
}

/// How a customer found the company.
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
    /// Without a channel; reserved, does not occur.
    Organic,
}

impl Source {
    /// All sources: the channels in channel order, then the two unpaid ones.
    pub const ALL: [Source; 7] = [
        Source::SocialMedia,
        Source::SearchAds,
        Source::Linkedin,
        Source::ContentMarketing,
        Source::ReferralProgram,
        Source::Network,
        Source::Organic,
    ];

    /// Returns the source of a channel.
    pub fn from_channel(channel: Channel) -> Source {
        Source::ALL[channel.index()]
    }

    /// Returns the channel of a paid source.
    pub fn channel(self) -> Option<Channel> {
        Channel::at(self as usize)
    }

    /// Identifier as stored in tables.
    pub fn id(self) -> &'static str {
        match self.channel() {
            Some(channel) => channel.id(),
            None if self == Source::Network => "network",
            None => "organic",
        }
    }

    /// Name on screens.
    pub fn name(self) -> &'static str {
        match self {
            Source::Network => "word of mouth",
            source => source.id(),
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
    /// Leads of the group that came through the channel.
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
    /// How it found the company.
    pub source: Source,
    /// Profile attributes.
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
    /// Plan; `None` while an enterprise negotiates.
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

/// Status of a subscription.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum SubscriptionStatus {
    /// An enterprise that negotiates.
    Lead,
    /// Active.
    Subscribed,
    /// Ended by the customer.
    Cancelled,
    /// Never became a customer.
    Lost,
}

impl SubscriptionStatus {
    /// Identifier as stored in tables.
    pub fn id(self) -> &'static str {
        ["lead", "subscribed", "cancelled", "lost"][self as usize]
    }
}

/// Terms of a subscription after a bill, a plan switch or a deal.
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
    /// Whether the first bill was issued.
    pub billed_once: bool,
}

/// Why a subscription ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum EndCause {
    /// A payment failed permanently.
    Involuntary,
    /// No plan was acceptable, and satisfaction was negative.
    Quality,
    /// No plan was acceptable at its price.
    Price,
    /// An enterprise lead waited too long for an answer.
    LeadTimeout,
    /// An enterprise lead fell silent.
    LeadSilent,
    /// The player rejected an enterprise lead.
    LeadRejected,
    /// An enterprise left because an issue stayed open for too long.
    ExtendedIssue,
    /// An enterprise left because of low quality.
    QualityChange,
    /// An enterprise left because it needs more than its quota.
    QuotaChange,
    /// An enterprise left because of the price.
    PriceSensitivity,
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
    /// Recorded end day.
    pub day: u32,
    /// Cancelled or lost.
    pub status: SubscriptionStatus,
    /// The cause, known only to the simulator.
    pub cause: EndCause,
}

/// Usage of consecutive customers of one group, in ascending order of their numbers.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct UsageRows {
    /// Customer numbers.
    pub customers: Vec<u32>,
    /// Units used by each.
    pub units: Vec<u32>,
}

/// A new support issue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IssueOpened {
    /// Running number of the issue.
    pub issue: u32,
    /// Number of the customer.
    pub customer: u32,
    /// The customer's group.
    pub group: Group,
}

/// Ad revenue of one subscriber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdsRevenueRow {
    /// Number of the customer who saw the ads.
    pub customer: u32,
    /// The customer's group.
    pub group: Group,
    /// Effective strength, 0..=1.
    pub strength: f64,
    /// Dollars.
    pub revenue: f64,
}
