//! Wording of posts and comments (docs/mechanics/market/social/texts.md).
//!
//! Each post has a recorded reason, which the grammars turn into text. A post contains only what its author
//! can know: causes, opinions, prices and plans, but no hidden numbers. The wording uses a separate random stream and
//! does not affect the world.

mod comments;
mod customers;
pub mod names;
mod press;
mod repetition;
mod wording;

use serde::{Deserialize, Serialize};

use repetition::RecentPosts;

use super::judge::Judgement;
use novamind_world::events::{Post, PostSubject};
use novamind_world::params::Params;
use novamind_world::random::{Part, Streams};

/// A writer of posts that remembers the recent posts to avoid repetition. Posts must be written in order.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct PostWriter {
    recent: RecentPosts,
}

impl PostWriter {
    /// Returns the text of a post. For a comment, `judgement` is the reaction of the commenting group to the player's
    /// post.
    pub fn write(
        &mut self,
        post: &Post,
        judgement: Option<&Judgement>,
        params: &Params,
        streams: &Streams,
    ) -> String {
        let mut stream = streams.open(Part::Voice, [u64::from(post.post)]);
        let mut choose = |count: usize| stream.index(count);
        match (post.matter, post.author) {
            (PostSubject::Opinion(opinion), Some(author)) => {
                let context = customers::context(&author, &opinion, post.sentiment, params);
                let text = self.recent.pick_freshest(|| customers::draft_post(&context, &mut choose));
                if customers::writes_in_lowercase(&author) { text.to_lowercase() } else { text }
            }
            (PostSubject::Reading(reading), _) => {
                self.recent.pick_freshest(|| press::write_reading_post(&reading, &mut choose))
            }
            (PostSubject::Economy { trend, pmi, perspective }, _) => {
                self.recent.pick_freshest(|| press::write_economy_post(trend, pmi, perspective, &mut choose))
            }
            (PostSubject::CompetitorEvent { name, perspective, severity, estimate }, _) => {
                let names = &params.competitor.competitor_names;
                let name = names.get(usize::from(name)).map_or("A rival", String::as_str);
                self.recent.pick_freshest(|| {
                    press::write_competitor_post(name, perspective, severity, estimate, &mut choose)
                })
            }
            (PostSubject::Comment { group, effect, .. }, _) => {
                self.recent.pick_freshest(|| comments::write_comment(group, effect, judgement, &mut choose))
            }
            // This case cannot occur, because an opinion always has an author.
            (PostSubject::Opinion(_), None) => String::new(),
        }
    }
}

#[cfg(test)]
mod tests;
