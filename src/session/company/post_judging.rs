//! Judgements of the player's posts by the built-in judge, or from recorded scores of a language model.

use super::simulation::Simulation;
use crate::database::EntryWriter;
use novamind_record::trajectory::record::JudgedPost;
use novamind_voice::judge::{self, JudgeContext, Judgement, Lexicon, SubmittedPost};
use novamind_world::identifiers::Group;
use novamind_world::market::social::own_posts::OwnPost;
use novamind_world::market::social::reach::{self, PostReactions};
use novamind_world::params::PostJudge;

impl Simulation {
    /// Judges the player's posts of earlier days that are not judged yet.
    pub fn judge_own_posts(&mut self, entries: EntryWriter<'_>) {
        if self.params.fidelity.post_judge == PostJudge::None {
            return;
        }
        let own_posts = &self.world.market.social.own;
        if own_posts.iter().all(|post| post.effects.is_some()) {
            return;
        }
        let lexicon = Lexicon::bundled();
        let judge_context = JudgeContext::from_world(&self.world, &self.params, lexicon);
        let known: Vec<Group> = Group::all().filter(|group| self.world.market.is_known(*group)).collect();
        let mut verdicts = Vec::new();
        self.feed.judgements.resize(own_posts.len(), Vec::new());
        for (at, post) in own_posts.iter().enumerate().filter(|(_, post)| post.effects.is_none()) {
            let submission = SubmittedPost {
                content: &post.content,
                day: post.day,
                original: post.reply_to.and_then(|post| self.feed.original_post(post)),
                earlier: own_posts[..at].iter().map(|post| (post.day, post.content.as_str())).collect(),
            };
            let judgements = judge::judge_post(&submission, known.iter().copied(), &judge_context, lexicon);
            let judgements = self.recorded_scores.apply_to(post, judgements);
            let effects = judgements.iter().map(|judgement| (judgement.group, judgement.effect)).collect();
            verdicts.push(PostReactions { post: at as u32 + 1, effects });
            self.feed.judgements[at] = judgements;
        }
        let (world, facts, params, streams) = self.parts_between_days(entries);
        reach::apply_reactions(&mut world.market.social, &world.customers, &verdicts, params, streams, facts);
    }
}

/// Recorded scores of posts. A post is identified by its day, its text and the post to which it replies, because post
/// numbers differ in branches.
#[derive(Debug, Clone, Default)]
pub(crate) struct RecordedScores(Vec<JudgedPost>);

impl RecordedScores {
    pub(crate) fn add(&mut self, judged: JudgedPost) {
        self.0.push(judged);
    }

    fn latest(&self, post: &OwnPost) -> Option<&JudgedPost> {
        self.0.iter().rev().find(|judged| scores_match_post(judged, post))
    }

    pub(crate) fn covers(&self, post: &OwnPost, groups: &[Group]) -> bool {
        self.latest(post).is_some_and(|judged| {
            groups.iter().all(|group| judged.scores.iter().any(|score| score.group == *group))
        })
    }

    /// Replaces scores of the built-in judge with recorded scores and returns the judgements of a post.
    pub(crate) fn apply_to(&self, post: &OwnPost, judgements: Vec<Judgement>) -> Vec<Judgement> {
        let Some(judged) = self.latest(post) else { return judgements };
        let scored =
            |judgement: Judgement| match judged.scores.iter().find(|score| score.group == judgement.group) {
                Some(score) => judgement.with_model_score(score),
                None => judgement,
            };
        judgements.into_iter().map(scored).collect()
    }
}

pub(crate) fn scores_match_post(judged: &JudgedPost, post: &OwnPost) -> bool {
    judged.posted == post.day && judged.reply_to == post.reply_to && judged.content == post.content
}
