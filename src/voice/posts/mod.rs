//! Wording of posts and comments (docs/mechanics/market/social/texts.md).
//!
//! Facts contain the reason for a post; grammars turn it into text. A post is true for its author and
//! contains only what a person could know: causes and opinions, prices and plans, never hidden numbers. The
//! wording uses its own random stream and does not affect the world.

mod comments;
mod customers;
mod fresh;
pub mod names;
mod press;
mod words;

use serde::{Deserialize, Serialize};

use fresh::Recent;

use super::judge::Judgement;
use novamind_world::events::{Matter, Post};
use novamind_world::params::Params;
use novamind_world::random::{Part, Streams};

/// Writes posts in order and remembers recent ones to avoid repetition.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Writer {
    recent: Recent,
}

impl Writer {
    /// Returns the text of a post; for comments, `judgement` is the reaction of the comment's group to the
    /// player's post.
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
            (Matter::Opinion(opinion), Some(author)) => {
                let context = customers::context(&author, &opinion, post.sentiment, params);
                let text = self.recent.freshest(|| customers::draft(&context, &mut choose));
                if customers::without_capitals(&author) { text.to_lowercase() } else { text }
            }
            (Matter::Reading(reading), _) => {
                self.recent.freshest(|| press::about_reading(&reading, &mut choose))
            }
            (Matter::Economy { trend, pmi, perspective }, _) => {
                self.recent.freshest(|| press::about_economy(trend, pmi, perspective, &mut choose))
            }
            (Matter::Rival { name, perspective, severity, estimate }, _) => {
                let names = &params.competitor.competitor_names;
                let name = names.get(usize::from(name)).map_or("A rival", String::as_str);
                self.recent
                    .freshest(|| press::about_rival(name, perspective, severity, estimate, &mut choose))
            }
            (Matter::Comment { group, effect, .. }, _) => {
                self.recent.freshest(|| comments::about_own_post(group, effect, judgement, &mut choose))
            }
            // An opinion always has an author.
            (Matter::Opinion(_), None) => String::new(),
        }
    }
}

#[cfg(test)]
mod tests;
