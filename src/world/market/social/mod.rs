//! Social media: who is heard, what the press writes, and what the company's own posts do
//! (docs/mechanics/market/social/README.md).
//!
//! Posts of others act on nothing: they are information. The company's own posts act on leads, once the judge of
//! `voice` has said how each group takes them ([`reach::receive`]).

pub mod chronicle;
pub mod crowd;
pub mod engagement;
pub mod opinions;
pub mod own;
pub mod press;
pub mod reach;
pub mod sentiment;
pub mod weights;

use crate::canonical::canonical;
use crate::events::{Engagement, Facts, Matter, Post, PostAuthor, Sentiment};
use crate::settings::Settings;
use chronicle::Chronicle;
use own::OwnPost;

/// What social media remembers.
#[derive(Debug, Clone, PartialEq)]
pub struct Social {
    /// Number of the next post of others.
    pub next_post: u32,
    /// The player's posts.
    pub own: Vec<OwnPost>,
    /// Day of the next round of posts about the economy; none before the first day.
    pub next_round: Option<u32>,
    /// What the public remembers of the company.
    pub chronicle: Chronicle,
}

canonical! { Social { next_post, own, next_round, chronicle } }

impl Social {
    /// Social media on day 0.
    pub fn opening(settings: &Settings) -> Social {
        Social { next_post: 1, own: Vec::new(), next_round: None, chronicle: Chronicle::opening(settings) }
    }

    /// Whether a post of others has this number.
    pub fn has_post(&self, post: u32) -> bool {
        (1..self.next_post).contains(&post)
    }

    /// Records a post of others and returns its number.
    pub fn publish(
        &mut self,
        author: Option<PostAuthor>,
        sentiment: Sentiment,
        engagement: Engagement,
        matter: Matter,
        facts: &mut Facts,
    ) -> u32 {
        let post = self.next_post;
        self.next_post += 1;
        facts.posts.push(Post { post, author, sentiment, engagement, matter });
        post
    }
}
