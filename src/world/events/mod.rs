//! Facts of a day: what happened, as plain data, for whoever records it.
//!
//! Mechanisms push facts; `database` turns them into rows and `voice` some of them into words. A fact holds
//! codes and numbers, never a text, and nothing in it is read back by the world. Order within a list is the
//! order in which things happened.

mod company;
mod customers;
mod economy;
mod figures;
mod money;
mod posts;
mod research;
mod threads;

pub use company::{LossCause, Notice, Reaction, ResearchChange, ServiceDay};
pub use customers::{
    AdsRevenueRow, Arrival, ChannelLeads, EndCause, IssueOpened, Source, SubscriptionEnded,
    SubscriptionOpened, SubscriptionStatus, TermsChanged, UsageRows,
};
pub use economy::{Phase, Reading, Trend};
pub use figures::DayFigures;
pub use money::{Category, LedgerEntry, LedgerNote, Payment};
pub use posts::{
    Cause, Engagement, Matter, Opinion, OwnPostMade, OwnPostSeen, Post, PostAuthor, Sentiment, Severity,
    Theme, Troubles,
};
pub use research::{Attempt, Knowledge, Project, Snapshot, Study};
pub use threads::{DealClosed, Offering, Sender, ThreadKind, ThreadTurn, TurnContent};

use super::canonical::canonical;
use super::identifiers::Group;
use super::settings::SettingsChange;

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
    /// Attempts to find a group.
    pub attempts: Vec<Attempt>,
    /// Groups whose knowledge changed, as it is now.
    pub knowledge: Vec<(Group, Knowledge)>,
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
    /// Deals with companies.
    pub deals: Vec<DealClosed>,
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
    /// What others wrote on social media, in the order of their numbers.
    pub posts: Vec<Post>,
    /// What the player wrote there.
    pub own_posts: Vec<OwnPostMade>,
    /// Posts of the player that were read and judged.
    pub own_posts_seen: Vec<OwnPostSeen>,
    /// Notifications.
    pub notices: Vec<Notice>,
}

canonical! {
    Facts {
        day, settings, usage, service, research, attempts, knowledge, readings, issues_resolved, issues_aged, issues_opened, endings,
        changes, turns, deals, channel_leads, arrivals, openings, payments, ledger, ads_revenue, posts,
        own_posts, own_posts_seen, notices,
    }
}

impl Facts {
    /// Forgets everything and starts a day, keeping the memory.
    pub fn begin(&mut self, day: u32) {
        let Facts {
            day: own_day,
            settings,
            usage,
            service,
            research,
            attempts,
            knowledge,
            readings,
            issues_resolved,
            issues_aged,
            issues_opened,
            endings,
            changes,
            turns,
            deals,
            channel_leads,
            arrivals,
            openings,
            payments,
            ledger,
            ads_revenue,
            posts,
            own_posts,
            own_posts_seen,
            notices,
        } = self;
        *own_day = day;
        (*service, *issues_aged) = (None, false);
        settings.clear();
        usage.clear();
        research.clear();
        attempts.clear();
        knowledge.clear();
        readings.clear();
        issues_resolved.clear();
        issues_opened.clear();
        endings.clear();
        changes.clear();
        turns.clear();
        deals.clear();
        channel_leads.clear();
        arrivals.clear();
        openings.clear();
        payments.clear();
        ledger.clear();
        ads_revenue.clear();
        posts.clear();
        own_posts.clear();
        own_posts_seen.clear();
        notices.clear();
    }
}
