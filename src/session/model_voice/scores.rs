//! What a language model made of the player's posts, as far as the record tells.

use novamind_record::trajectory::record::JudgedPost;
use novamind_voice::judge::Judgement;
use novamind_world::identifiers::Group;
use novamind_world::market::social::own::OwnPost;

/// Scores by post. A post is known by its day, its text and what it answers, so that scores belong to it in a branch, too,
/// where posts have other numbers.
#[derive(Debug, Clone, Default)]
pub(crate) struct RecordedScores(Vec<JudgedPost>);

impl RecordedScores {
    /// Takes in what a line says.
    pub(crate) fn take_in(&mut self, judged: JudgedPost) {
        self.0.push(judged);
    }

    /// What was said of a post last.
    fn of(&self, post: &OwnPost) -> Option<&JudgedPost> {
        self.0.iter().rev().find(|judged| is_of(judged, post))
    }

    /// Whether there is a score of a post for each of these groups.
    pub(super) fn cover(&self, post: &OwnPost, groups: &[Group]) -> bool {
        self.of(post).is_some_and(|judged| {
            groups.iter().all(|group| judged.scores.iter().any(|score| score.group == *group))
        })
    }

    /// Judgements of a post, with the scores that were recorded in place of those of the built-in judge.
    pub(crate) fn over(&self, post: &OwnPost, judgements: Vec<Judgement>) -> Vec<Judgement> {
        let Some(judged) = self.of(post) else { return judgements };
        let scored = |own: Judgement| match judged.scores.iter().find(|score| score.group == own.group) {
            Some(score) => own.scored_by_model(score),
            None => own,
        };
        judgements.into_iter().map(scored).collect()
    }
}

/// Whether something was said of a post.
pub(super) fn is_of(judged: &JudgedPost, post: &OwnPost) -> bool {
    judged.posted == post.day && judged.reply_to == post.reply_to && judged.content == post.content
}
