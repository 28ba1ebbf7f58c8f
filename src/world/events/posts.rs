//! Facts about posts as codes and numbers; the `voice` crate writes the text.

use super::economy::{Reading, Trend};
use crate::canonical::{Canonical, CanonicalHasher, CanonicalReader, Restore, canonical, canonical_codes};
use crate::customers::persona::PersonaPicks;
use crate::events::ThreadKind;
use crate::identifiers::{Group, Plan};

canonical! {
    Post { post, author, sentiment, engagement, matter }
    Engagement { likes, shares, virality }
    PostAuthor { customer, group, n, persona, company }
    Opinion { cause, troubles, theme, days_subscribed, plan, price, seats, waiting_days, downtime_minutes }
    Troubles { overload, outage, issue, quota }
    OwnPostMade { post, content, reply_to }
    OwnPostSeen { post, views, comments }
}
canonical_codes! {
    Sentiment { Positive, Neutral, Negative }
    Theme { Price, Quality, Rivals, Service, Support, Limits, Ads, Progress, Habit }
    Severity { Minor, Moderate, Major, Transformative }
}

/// A post by anyone except the player.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Post {
    /// Running number.
    pub post: u32,
    /// The author, or `None` for the market observer.
    pub author: Option<PostAuthor>,
    /// Its tone.
    pub sentiment: Sentiment,
    /// Engagement, hidden from the player.
    pub engagement: Engagement,
    /// The subject.
    pub matter: PostSubject,
}

/// Tone of a post.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Sentiment {
    /// Praise.
    Positive,
    /// Neither positive nor negative.
    Neutral,
    /// Complaint.
    Negative,
}

/// Engagement of a post; hidden, and without effect on the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Engagement {
    /// Likes.
    pub likes: u32,
    /// Shares.
    pub shares: u32,
    /// 0..=1.
    pub virality: f64,
}

/// A customer as an author.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PostAuthor {
    /// Customer number.
    pub customer: u32,
    /// Group.
    pub group: Group,
    /// Running number within the group.
    pub n: u32,
    /// Profile attributes.
    pub persona: PersonaPicks,
    /// Whole seats of an enterprise, 0 for individuals.
    pub company: u32,
}

/// The subject of a post.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PostSubject {
    /// A customer's experience with the product.
    Opinion(Opinion),
    /// A reading of the economy was published.
    Reading(Reading),
    /// The state of the economy.
    Economy {
        /// Label of today's index.
        trend: Trend,
        /// Today's index.
        pmi: f64,
        /// Number of the point of view.
        perspective: u8,
    },
    /// An event of a competitor.
    CompetitorEvent {
        /// Number of the competitor.
        name: u8,
        /// Number of the point of view.
        perspective: u8,
        /// Estimated severity.
        severity: Severity,
        /// Estimated gain in quality.
        estimate: f64,
    },
    /// A comment on a post of the player.
    Comment {
        /// The player's post.
        own_post: u32,
        /// Group that the comment speaks for.
        group: Group,
        /// Reaction of that group to the post, -1..=1.
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
    /// Why the post is written.
    pub cause: PostCause,
    /// Problems of this customer today.
    pub troubles: Troubles,
    /// The theme that matters most to the customer.
    pub theme: Theme,
    /// Days subscribed.
    pub days_subscribed: u32,
    /// Plan; `None` after an enterprise is lost.
    pub plan: Option<Plan>,
    /// Price in force, dollars a month and seat.
    pub price: f64,
    /// Whole seats.
    pub seats: u32,
    /// Days an issue of this customer has been open.
    pub waiting_days: u32,
    /// Minutes the service was down today.
    pub downtime_minutes: u32,
}

/// The reason for a post, the first that applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PostCause {
    /// The service was slow.
    Overload,
    /// The service was down.
    Outage,
    /// A support issue is open.
    Issue,
    /// The quota did not cover the demand.
    Quota,
    /// Satisfaction rose.
    Improved,
    /// Satisfaction fell.
    Declined,
    /// No particular reason.
    General,
    /// No plan was worth its price.
    Cancelled,
    /// An enterprise left after a negotiation.
    Lost {
        /// How the negotiation started.
        thread: ThreadKind,
        /// Whether the player did not answer; otherwise the enterprise fell silent.
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

/// Problems of a customer today.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Troubles {
    /// The service was slow.
    pub overload: bool,
    /// The service was down.
    pub outage: bool,
    /// A support issue is open.
    pub issue: bool,
    /// The quota did not cover the demand.
    pub quota: bool,
}

impl Troubles {
    /// Returns the number of problems.
    #[inline]
    pub fn count(&self) -> u32 {
        [self.overload, self.outage, self.issue, self.quota].into_iter().map(u32::from).sum()
    }
}

/// What matters to a customer: what an unhappy one lacks, or what a happy one values.
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
    /// The quota.
    Limits,
    /// Ads inside the product.
    Ads,
    /// Recent improvements.
    Progress,
    /// Familiarity with the product.
    Habit,
}

/// A post of the player.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnPostMade {
    /// Running number.
    pub post: u32,
    /// Its text.
    pub content: String,
    /// Number of the post that it replies to.
    pub reply_to: Option<u32>,
}

/// A post of the player that was seen and judged.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OwnPostSeen {
    /// Number of the post.
    pub post: u32,
    /// How often it was seen.
    pub views: u64,
    /// Numbers of the comments.
    pub comments: Vec<u32>,
}

/// Severity of an event as the press sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Below 0.03.
    Minor,
    /// Below 0.10.
    Moderate,
    /// Below 0.20.
    Major,
    /// Above.
    Transformative,
}

impl Severity {
    /// Identifier as used in posts and tables.
    pub fn id(self) -> &'static str {
        ["minor", "moderate", "major", "transformative"][self as usize]
    }
}
