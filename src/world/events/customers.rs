//! Facts about customers: arrivals, subscription terms, usage, issues and cancellations.

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

/// The source through which a customer found the company.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Source {
    /// Paid feeds of social networks.
    SocialMedia,
    /// Paid search results.
    SearchAds,
    /// Ads on the business network.
    Linkedin,
    /// Articles and guides by the company.
    ContentMarketing,
    /// Recommendations that the company rewards.
    ReferralProgram,
    /// Word of mouth.
    Network,
    /// No channel. Reserved; does not occur.
    Organic,
}

impl Source {
    /// All sources: the paid channels in channel order, then the two unpaid sources.
    pub const ALL: [Source; 7] = [
        Source::SocialMedia,
        Source::SearchAds,
        Source::Linkedin,
        Source::ContentMarketing,
        Source::ReferralProgram,
        Source::Network,
        Source::Organic,
    ];

    /// Returns the source that corresponds to a channel.
    pub fn from_channel(channel: Channel) -> Source {
        Source::ALL[channel.index()]
    }

    /// Returns the channel of a paid source, or `None` for an unpaid source.
    pub fn channel(self) -> Option<Channel> {
        Channel::at(self as usize)
    }

    /// Returns the identifier that tables use for the source.
    pub fn id(self) -> &'static str {
        match self.channel() {
            Some(channel) => channel.id(),
            None if self == Source::Network => "network",
            None => "organic",
        }
    }

    /// Returns the name that screens show for the source.
    pub fn name(self) -> &'static str {
        match self {
            Source::Network => "word of mouth",
            source => source.id(),
        }
    }
}

/// Leads of one group that arrived through one paid channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelLeads {
    /// Paid channel through which the leads arrived.
    pub channel: Channel,
    /// The group that the ads targeted.
    pub group: Group,
    /// Number of leads of the group that arrived through the channel.
    pub leads: u32,
    /// Dollars spent on the channel for the group.
    pub spend: f64,
}

/// A customer who arrived today.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// Customer number, unique across all groups.
    pub customer: u32,
    /// Group of the customer.
    pub group: Group,
    /// Sequence number of the customer within the group.
    pub n: u32,
    /// Source through which the customer found the company.
    pub source: Source,
    /// Profile attributes of the customer.
    pub persona: PersonaPicks,
    /// Mean demand, from which the usage label of the profile is derived.
    pub usage_demand: f64,
    /// Budget, from which the budget label of the profile is derived.
    pub c_max: f64,
    /// Number of whole seats.
    pub seats: u32,
}

/// A new subscription row, for subscribers and for leads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubscriptionOpened {
    /// Number of the new subscription.
    pub subscription: u32,
    /// Customer number of the subscriber or lead.
    pub customer: u32,
    /// Plan of the subscription; `None` while an enterprise negotiates.
    pub plan: Option<Plan>,
    /// Status of the subscription: subscribed, lost or lead.
    pub status: SubscriptionStatus,
    /// Price before discounts, dollars per month.
    pub listed_price: f64,
    /// Discount, dollars per month.
    pub promotion: f64,
    /// Effective price, dollars per month.
    pub effective_price: f64,
    /// Number of whole seats.
    pub seats: u32,
}

/// Status of a subscription row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum SubscriptionStatus {
    /// Negotiation of an enterprise lead.
    Lead,
    /// Active subscription.
    Subscribed,
    /// Subscription that has ended.
    Cancelled,
    /// Lead that did not subscribe.
    Lost,
}

impl SubscriptionStatus {
    /// Returns the identifier that tables use for the status.
    pub fn id(self) -> &'static str {
        ["lead", "subscribed", "cancelled", "lost"][self as usize]
    }
}

/// New terms of a subscription, after a bill, a plan switch or a deal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TermsChanged {
    /// Number of the subscription whose terms changed.
    pub subscription: u32,
    /// Customer number of the subscriber.
    pub customer: u32,
    /// Plan after the change.
    pub plan: Plan,
    /// Price before discounts, dollars per seat per month.
    pub listed_price: f64,
    /// Discount, dollars per seat per month.
    pub promotion: f64,
    /// Effective price, dollars per seat per month.
    pub effective_price: f64,
    /// Number of whole seats.
    pub seats: u32,
    /// Whether the subscriber has received the first bill.
    pub billed_once: bool,
}

/// Reason why a subscription or a lead ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum EndCause {
    /// Permanent failure of a payment.
    Involuntary,
    /// The individual found no acceptable plan, and satisfaction was negative.
    Quality,
    /// The individual found no acceptable plan, and satisfaction was not negative.
    Price,
    /// An enterprise lead did not receive an answer before the deadline.
    LeadTimeout,
    /// An enterprise lead stopped replying.
    LeadSilent,
    /// The player rejected an enterprise lead.
    LeadRejected,
    /// An enterprise left because an issue stayed open for too long.
    ExtendedIssue,
    /// An enterprise left because of low quality.
    QualityChange,
    /// An enterprise left because its quota was too small.
    QuotaChange,
    /// An enterprise left because of the price.
    PriceSensitivity,
}

/// The end of a subscription or a lead.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SubscriptionEnded {
    /// Number of the subscription that ended.
    pub subscription: u32,
    /// Customer number of the former subscriber or lead.
    pub customer: u32,
    /// Group of the customer.
    pub group: Group,
    /// Number of whole seats.
    pub seats: u32,
    /// Recorded last day of the subscription.
    pub day: u32,
    /// New status of the subscription: cancelled or lost.
    pub status: SubscriptionStatus,
    /// Cause of the end, which is hidden from the player.
    pub cause: EndCause,
}

/// Usage of several customers of one group, in ascending order of customer number.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct UsageRows {
    /// Customer numbers, in ascending order.
    pub customers: Vec<u32>,
    /// Units that each customer used, in the order of `customers`.
    pub units: Vec<u32>,
}

/// A support issue that was opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IssueOpened {
    /// Number of the issue among all issues of the run, from 1.
    pub issue: u32,
    /// Number of the customer who opened the issue.
    pub customer: u32,
    /// Group of the customer.
    pub group: Group,
}

/// Ad revenue from one subscriber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdsRevenueRow {
    /// Number of the customer who saw the ads.
    pub customer: u32,
    /// Group of the customer.
    pub group: Group,
    /// Effective strength of in-app advertising, 0..=1.
    pub strength: f64,
    /// Ad revenue from the customer, dollars.
    pub revenue: f64,
}
