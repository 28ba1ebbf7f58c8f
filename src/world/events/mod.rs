//! Facts of a day: plain data about its events, for recording.
//!
//! Mechanisms append facts; `database` turns them into rows and `voice` turns some of them into text. A fact contains
//! codes and numbers but no text, except for the text of the player's posts. The simulation never reads facts. Lists
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
    CustomerProblems, Engagement, Opinion, OwnPostPublished, OwnPostSeen, Post, PostAuthor, PostCause,
    PostSubject, Sentiment, Severity, Theme,
};
pub use research::{Attempt, Knowledge, Project, Snapshot, Study};
pub use threads::{DealClosed, Offering, Sender, ThreadKind, ThreadTurn, TurnContent};

use super::canonical::canonical;
use super::identifiers::Group;
use super::settings::SettingsChange;

/// All facts about one day, or about the tool calls after that day.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Facts {
    /// Day to which all facts belong.
    pub day: u32,
    /// Changed families of settings, with all their new values.
    pub settings: Vec<SettingsChange>,
    /// Usage of all active subscriptions, in several parts.
    pub usage: Vec<UsageRows>,
    /// Service health of the day.
    pub service: Option<ServiceDay>,
    /// R&D projects that were started or completed.
    pub research: Vec<ResearchChange>,
    /// Attempts to discover a group.
    pub attempts: Vec<Attempt>,
    /// Groups about which the player's knowledge changed, with the new knowledge.
    pub knowledge: Vec<(Group, Knowledge)>,
    /// PMI readings that were published.
    pub readings: Vec<Reading>,
    /// Numbers of the issues that were resolved.
    pub issues_resolved: Vec<u32>,
    /// Whether open issues aged by one day.
    pub issues_aged: bool,
    /// Issues that were opened.
    pub issues_opened: Vec<IssueOpened>,
    /// Subscriptions that ended.
    pub endings: Vec<SubscriptionEnded>,
    /// Subscriptions with changed terms. The last change of a subscription applies.
    pub changes: Vec<TermsChanged>,
    /// Turns that were added to threads.
    pub turns: Vec<ThreadTurn>,
    /// Deals that enterprises accepted.
    pub deals: Vec<DealClosed>,
    /// Leads by paid channel and group.
    pub channel_leads: Vec<ChannelLeads>,
    /// Customers who arrived.
    pub arrivals: Vec<Arrival>,
    /// New subscriptions, in the order of subscription numbers.
    pub openings: Vec<SubscriptionOpened>,
    /// Payments of subscribers.
    pub payments: Vec<Payment>,
    /// Cash movements other than payments of subscribers.
    pub ledger: Vec<LedgerEntry>,
    /// Ad revenue from each subscriber.
    pub ads_revenue: Vec<AdsRevenueRow>,
    /// Posts that the player did not write, in ascending order of post number.
    pub posts: Vec<Post>,
    /// Posts that the player published.
    pub own_posts: Vec<OwnPostPublished>,
    /// Posts of the player that were seen and judged.
    pub own_posts_seen: Vec<OwnPostSeen>,
    /// Notifications for the inbox.
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
    /// Clears all facts and sets the day. Keeps the allocated memory.
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
