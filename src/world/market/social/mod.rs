//! Social media: posts of customers, the press, and the player's posts (docs/mechanics/market/social/README.md).
//!
//! Posts that the player did not write only inform the player and do not affect the world. The player's posts affect
//! leads after the judge of the `voice` crate has determined the reaction of each group ([`reach::apply_reactions`]).

pub mod author_selection;
pub mod chronicle;
pub mod engagement;
pub mod opinions;
pub mod own_posts;
pub mod press;
pub mod reach;
pub mod sentiment;
pub mod weights;

use crate::canonical::canonical;
use crate::events::{Engagement, Facts, Post, PostAuthor, PostSubject, Sentiment};
use crate::settings::Settings;
use chronicle::Chronicle;
use own_posts::OwnPost;

/// The state of social media.
#[derive(Debug, Clone, PartialEq)]
pub struct Social {
    /// Number of the next post that the player does not write.
    pub next_post: u32,
    /// Posts of the player. Post n is at index n - 1.
    pub own: Vec<OwnPost>,
    /// Day of the next round of posts about the economy; `None` before the first day.
    pub next_round: Option<u32>,
    /// Record of the company's recent days.
    pub chronicle: Chronicle,
}

canonical! { Social { next_post, own, next_round, chronicle } }

impl Social {
    /// Returns the state of social media on day 0.
    pub fn initial(settings: &Settings) -> Social {
        Social { next_post: 1, own: Vec::new(), next_round: None, chronicle: Chronicle::initial(settings) }
    }

    /// Returns whether a post with this number exists. Posts of the player have separate numbers.
    pub fn has_post(&self, post: u32) -> bool {
        (1..self.next_post).contains(&post)
    }

    /// Publishes a post that the player did not write and returns the number of the post.
    pub fn publish(
        &mut self,
        author: Option<PostAuthor>,
        sentiment: Sentiment,
        engagement: Engagement,
        matter: PostSubject,
        facts: &mut Facts,
    ) -> u32 {
        let post = self.next_post;
        self.next_post += 1;
        facts.posts.push(Post { post, author, sentiment, engagement, matter });
        post
    }
}
