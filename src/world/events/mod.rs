//! Facts of a day: what happened, as plain data for recording.
//!
//! Mechanisms append facts; `database` turns them into rows and `voice` turns some of them into text. A fact
//! holds codes and numbers, never text (except for posts of the player), and the world never reads it. Lists
//! are in the order of the events.

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
    Engagement, Opinion, OwnPostMade, OwnPostSeen, Post, PostAuthor, PostCause, PostSubject, Sentiment,
    Severity, Theme, Troubles,
};
pub use research::{Attempt, Knowledge, Project, Snapshot, Study};
pub use threads::{DealClosed, Offering, Sender, ThreadKind, ThreadTurn, TurnContent};

use super::canonical::canonical;
use super::identifiers::Group;
use super::settings::SettingsChange;

/// Everything that happened on one day or in the tool calls after it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Facts {
    /// The day all facts belong to.
    pub day: u32,
    /// Changed settings, complete after the change.
    pub settings: Vec<SettingsChange>,
    /// Usage of every active subscription, in pieces.
    pub usage: Vec<UsageRows>,
    /// Service health.
    pub service: Option<ServiceDay>,
    /// R&D projects that started or finished.
    pub research: Vec<ResearchChange>,
    /// Attempts to discover a group.
    pub attempts: Vec<Attempt>,
    /// Groups with changed knowledge, and their new knowledge.
    pub knowledge: Vec<(Group, Knowledge)>,
    /// Readings of the economy that were published.
    pub readings: Vec<Reading>,
    /// Issues that were solved, by number.
    pub issues_resolved: Vec<u32>,
    /// Whether open issues aged by one day.
    pub issues_aged: bool,
    /// Issues that were opened.
    pub issues_opened: Vec<IssueOpened>,
    /// Subscriptions that ended.
    pub endings: Vec<SubscriptionEnded>,
    /// Subscriptions with changed terms; the last entry of a subscription applies.
    pub changes: Vec<TermsChanged>,
    /// Turns of enterprise threads.
    pub turns: Vec<ThreadTurn>,
    /// Deals with enterprises.
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
    /// Posts of others, in ascending order of their numbers.
    pub posts: Vec<Post>,
    /// Posts of the player.
    pub own_posts: Vec<OwnPostMade>,
    /// Posts of the player that were seen and judged.
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
    /// Clears all facts and starts a day; allocated memory is kept.
    pub fn start_day(&mut self, day: u32) {
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
