//! Facts about posts, as codes and numbers. The `voice` crate writes the text.

use super::economy::{Reading, Trend};
use crate::canonical::{Canonical, CanonicalHasher, CanonicalReader, Restore, canonical, canonical_codes};
use crate::customers::persona::PersonaPicks;
use crate::events::ThreadKind;
use crate::identifiers::{Group, Plan};

canonical! {
    Post { post, author, sentiment, engagement, matter }
    Engagement { likes, shares, virality }
    PostAuthor { customer, group, n, persona, enterprise_seats }
    Opinion { cause, customer_problems, theme, days_subscribed, plan, price, seats, waiting_days, downtime_minutes }
    CustomerProblems { overload, outage, issue, quota }
    OwnPostPublished { post, content, reply_to }
    OwnPostSeen { post, views, comments }
}
canonical_codes! {
    Sentiment { Positive, Neutral, Negative }
    Theme { Price, Quality, Rivals, Service, Support, Limits, Ads, Progress, Habit }
    Severity { Minor, Moderate, Major, Transformative }
}

/// A post that the player did not write.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Post {
    /// Number of the post among the posts that the player did not write, from 1.
    pub post: u32,
    /// Author of the post, or `None` for the market observer.
    pub author: Option<PostAuthor>,
    /// Tone of the post.
    pub sentiment: Sentiment,
    /// Engagement of the post, hidden from the player.
    pub engagement: Engagement,
    /// What the post is about, with the values for its text.
    pub matter: PostSubject,
}

/// Tone of a post.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Sentiment {
    /// Positive tone, such as praise.
    Positive,
    /// Neutral tone.
    Neutral,
    /// Negative tone, such as a complaint.
    Negative,
}

/// Engagement of a post, which is hidden from the player and has no effect on the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Engagement {
    /// Number of likes.
    pub likes: u32,
    /// Number of shares.
    pub shares: u32,
    /// Virality score, 0..=1.
    pub virality: f64,
}

/// A customer who writes a post.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PostAuthor {
    /// Customer number, unique across all groups.
    pub customer: u32,
    /// Group of the customer.
    pub group: Group,
    /// Sequence number of the customer within the group.
    pub n: u32,
    /// Profile attributes of the customer.
    pub persona: PersonaPicks,
    /// Whole seats of an enterprise; 0 for individuals.
    pub enterprise_seats: u32,
}

/// The subject of a post.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PostSubject {
    /// A customer's experience with the product.
    Opinion(Opinion),
    /// The publication of a PMI reading.
    Reading(Reading),
    /// The current state of the economy.
    Economy {
        /// Trend label of today's PMI.
        trend: Trend,
        /// Today's PMI.
        pmi: f64,
        /// Number of the perspective from which the author writes.
        perspective: u8,
    },
    /// A competitor's gain in quality, as the press estimates it.
    CompetitorEvent {
        /// Index of the competitor's name in the parameter `competitor_names`.
        name: u8,
        /// Number of the perspective from which the author writes.
        perspective: u8,
        /// Severity that the press estimates for the event.
        severity: Severity,
        /// Gain in quality that the press estimates for the event.
        estimate: f64,
    },
    /// A comment on a post of the player.
    Comment {
        /// Number of the player's post.
        own_post: u32,
        /// Group whose reaction the comment expresses.
        group: Group,
        /// Reaction of the group to the post, -1..=1.
        effect: f64,
    },
}

impl Canonical for PostSubject {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        match *self {
            PostSubject::Opinion(opinion) => (0u8, opinion).feed(hasher),
            PostSubject::Reading(reading) => (1u8, reading).feed(hasher),
            PostSubject::Economy { trend, pmi, perspective } => {
                (2u8, ((trend, pmi), perspective)).feed(hasher)
            }
            PostSubject::CompetitorEvent { name, perspective, severity, estimate } => {
                (3u8, ((name, perspective), (severity, estimate))).feed(hasher)
            }
            PostSubject::Comment { own_post, group, effect } => {
                (4u8, ((own_post, group), effect)).feed(hasher)
            }
        }
    }
}

impl Restore for PostSubject {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        Some(match reader.read::<u8>()? {
            0 => PostSubject::Opinion(reader.read()?),
            1 => PostSubject::Reading(reader.read()?),
            2 => {
                let ((trend, pmi), perspective) = reader.read()?;
                PostSubject::Economy { trend, pmi, perspective }
            }
            3 => {
                let ((name, perspective), (severity, estimate)) = reader.read()?;
                PostSubject::CompetitorEvent { name, perspective, severity, estimate }
            }
            4 => {
                let ((own_post, group), effect) = reader.read()?;
                PostSubject::Comment { own_post, group, effect }
            }
            _ => return None,
        })
    }
}

/// The experience that a customer writes about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opinion {
    /// Reason why the customer writes the post.
    pub cause: PostCause,
    /// Problems that the customer has today.
    pub customer_problems: CustomerProblems,
    /// The theme that matters most to the customer.
    pub theme: Theme,
    /// Days since the subscription started.
    pub days_subscribed: u32,
    /// Plan of the customer; `None` for a lost enterprise.
    pub plan: Option<Plan>,
    /// Current price, dollars per seat per month.
    pub price: f64,
    /// Number of whole seats.
    pub seats: u32,
    /// Number of days for which the customer's issue has been open.
    pub waiting_days: u32,
    /// Downtime of the service today, in minutes.
    pub downtime_minutes: u32,
}

/// The reason for a post. If several reasons apply, the first one is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PostCause {
    /// The service was slow because of overload.
    Overload,
    /// The service was down.
    Outage,
    /// A support issue of the customer is open.
    Issue,
    /// The quota was below the customer's demand.
    Quota,
    /// The customer's satisfaction rose.
    Improved,
    /// The customer's satisfaction fell.
    Declined,
    /// No particular reason applies.
    General,
    /// The customer cancelled because no plan was worth its price.
    Cancelled,
    /// The enterprise left after a negotiation.
    Lost {
        /// Kind of the negotiation's thread.
        thread: ThreadKind,
        /// True if the player did not answer; false if the enterprise did not reply.
        unanswered: bool,
    },
}

impl Canonical for PostCause {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        let code = match self {
            PostCause::Overload => 0u8,
            PostCause::Outage => 1,
            PostCause::Issue => 2,
            PostCause::Quota => 3,
            PostCause::Improved => 4,
            PostCause::Declined => 5,
            PostCause::General => 6,
            PostCause::Cancelled => 7,
            PostCause::Lost { .. } => 8,
        };
        code.feed(hasher);
        if let PostCause::Lost { thread, unanswered } = self {
            (*thread, *unanswered).feed(hasher);
        }
    }
}

impl Restore for PostCause {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        Some(match reader.read::<u8>()? {
            0 => PostCause::Overload,
            1 => PostCause::Outage,
            2 => PostCause::Issue,
            3 => PostCause::Quota,
            4 => PostCause::Improved,
            5 => PostCause::Declined,
            6 => PostCause::General,
            7 => PostCause::Cancelled,
            8 => {
                let (thread, unanswered) = reader.read()?;
                PostCause::Lost { thread, unanswered }
            }
            _ => return None,
        })
    }
}

/// Problems that a customer has today.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CustomerProblems {
    /// Whether the service was slow.
    pub overload: bool,
    /// Whether the service was down.
    pub outage: bool,
    /// Whether a support issue of the customer is open.
    pub issue: bool,
    /// Whether the quota was below the demand.
    pub quota: bool,
}

impl CustomerProblems {
    /// Returns the number of problems that are present.
    #[inline]
    pub fn count(&self) -> u32 {
        [self.overload, self.outage, self.issue, self.quota].into_iter().map(u32::from).sum()
    }
}

/// The aspect of the product that a dissatisfied customer criticizes or a satisfied customer praises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Theme {
    /// Price and value for money.
    Price,
    /// Quality of the answers.
    Quality,
    /// Offers of competitors.
    Rivals,
    /// Availability and speed.
    Service,
    /// Treatment by support.
    Support,
    /// The usage quota.
    Limits,
    /// In-app advertising.
    Ads,
    /// Recent improvements.
    Progress,
    /// Familiarity with the product.
    Habit,
}

/// A post that the player published.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnPostPublished {
    /// Number of the post among the player's posts, from 1.
    pub post: u32,
    /// Text of the post.
    pub content: String,
    /// Number of the post to which the player replies; `None` if the post is not a reply.
    pub reply_to: Option<u32>,
}

/// A post of the player that was seen and judged.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnPostSeen {
    /// Number of the post among the player's posts, from 1.
    pub post: u32,
    /// Number of views of the post.
    pub views: u64,
    /// Numbers of the comments on the post, among the posts that the player did not write.
    pub comments: Vec<u32>,
}

/// Severity that the press reports for a competitor event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Gain in quality below 0.03.
    Minor,
    /// Gain in quality from 0.03, below 0.10.
    Moderate,
    /// Gain in quality from 0.10, below 0.20.
    Major,
    /// Gain in quality of 0.20 or more.
    Transformative,
}

impl Severity {
    /// Returns the identifier that posts and tables use for the severity.
    pub fn id(self) -> &'static str {
        ["minor", "moderate", "major", "transformative"][self as usize]
    }
}
