//! What readers make of the player's posts.

use super::projection::Entries;
use super::simulation::Simulation;
use crate::state::Session;
use novamind_tools::PublicPost;
use novamind_voice::judge::{self, Circumstances, Lexicon, Submission};
use novamind_world::identifiers::Group;
use novamind_world::market::social::reach::{self, Verdict};
use novamind_world::params::PostJudge;

impl Simulation {
    /// Lets the readers judge what the player posted before today.
    pub fn judge_own_posts(&mut self, entries: Entries<'_>) {
        if self.params.fidelity.post_judge == PostJudge::None {
            return;
        }
        let own = &self.world.market.social.own;
        if own.iter().all(|post| post.effects.is_some()) {
            return;
        }
        let lexicon = Lexicon::shipped();
        let circumstances = Circumstances::of(&self.world, &self.params, lexicon);
        let known: Vec<Group> = Group::all().filter(|group| self.world.market.is_known(*group)).collect();
        let mut verdicts = Vec::new();
        self.feed.judgements.resize(own.len(), Vec::new());
        for (at, post) in own.iter().enumerate().filter(|(_, post)| post.effects.is_none()) {
            let submission = Submission {
                content: &post.content,
                day: post.day,
                original: post.reply_to.and_then(|post| self.feed.original(post)),
                earlier: own[..at].iter().map(|post| (post.day, post.content.as_str())).collect(),
            };
            let judgements = judge::judge(&submission, known.iter().copied(), &circumstances, lexicon);
            let judgements = self.scores.over(post, judgements);
            let effects = judgements.iter().map(|own| (own.group, own.effect)).collect();
            verdicts.push(Verdict { post: at as u32 + 1, effects });
            self.feed.judgements[at] = judgements;
        }
        let (world, facts, params, streams) = self.between_days(entries);
        reach::receive(&mut world.market.social, &world.customers, &verdicts, params, streams, facts);
    }
}

impl Session {
    /// Every post of others so far, in the order of their numbers.
    pub fn posts(&self) -> &[PublicPost] {
        &self.simulation.feed.posts
    }
}
