//! Asking the model: how readers take a post of the player, on the day after it; and the posts of a week in other words, at
//! its end.

use super::scores::is_of;
use super::speaker::Reply;
use crate::state::Session;
use novamind_database::Entry;
use novamind_record::trajectory::record::{
    AskedOfModel, FailedAnswer, JudgedPost, VoiceAnswer, WordedPost, WordedPosts,
};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::PublicPost;
use novamind_voice::model::ModelPrompt;
use novamind_voice::model::scoring::{self, PostForReaders};
use novamind_voice::model::wording::{self, BuiltInPost, MOST_POSTS};
use novamind_world::identifiers::Group;
use novamind_world::params::PostJudge;

impl Session {
    /// Asks for scores of the player's posts that are judged next and have none on record. What is not on the disk afterwards
    /// was never said: then the built-in judge judges.
    pub(crate) fn ask_readers(&mut self) {
        let is_judged = self.simulation.params.fidelity.post_judge != PostJudge::None;
        let can_ask = self.voice.speaker.is_some() || !self.voice.inherited.is_empty();
        if self.recorder.is_none() || !is_judged || !can_ask {
            return;
        }
        for at in self.unscored_posts() {
            let Some(judged) = self.inherited_scores(at).or_else(|| self.scores_of_model(at)) else {
                continue;
            };
            let record = Record::Voice(VoiceAnswer::Scores(judged.clone()));
            if self.append(&record, Durability::Synced).is_ok() {
                self.simulation.scores.take_in(judged);
            }
        }
    }

    fn known_groups(&self) -> Vec<Group> {
        Group::all().filter(|group| self.simulation.world.market.is_known(*group)).collect()
    }

    /// Positions of the player's posts that nobody has judged and of which no score is on record.
    fn unscored_posts(&self) -> Vec<usize> {
        let (known, simulation) = (self.known_groups(), &self.simulation);
        let own = simulation.world.market.social.own.iter().enumerate();
        own.filter(|(_, post)| post.effects.is_none() && !simulation.scores.cover(post, &known))
            .map(|(at, _)| at)
            .collect()
    }

    /// Uses recorded scores for posts that are published again.
    pub fn inherit_scores(&mut self, judged: Vec<JudgedPost>) {
        self.voice.inherited = judged;
    }

    fn inherited_scores(&self, at: usize) -> Option<JudgedPost> {
        let post = self.simulation.world.market.social.own.get(at)?;
        let said = self.voice.inherited.iter().rev().find(|judged| is_of(judged, post))?;
        Some(JudgedPost { post: at as u32 + 1, took_ms: 0.0, ..said.clone() })
    }

    fn scores_of_model(&mut self, at: usize) -> Option<JudgedPost> {
        if !self.voice.speaker.as_ref()?.settings.judge {
            return None;
        }
        let known = self.known_groups();
        let prompt = self.prompt_for_readers(at, &known)?;
        let speaker = self.voice.speaker.as_mut()?;
        let Reply { answer, took_ms } = speaker.ask(&prompt, |answer| scoring::read(answer, &known));
        let post = self.simulation.world.market.social.own.get(at)?;
        match answer {
            Ok(scores) => Some(JudgedPost {
                post: at as u32 + 1,
                posted: post.day,
                content: post.content.clone(),
                reply_to: post.reply_to,
                scores,
                took_ms,
            }),
            Err(problem) => {
                self.note_failure(AskedOfModel::Scores, problem, took_ms);
                None
            }
        }
    }

    fn prompt_for_readers(&self, at: usize, known: &[Group]) -> Option<ModelPrompt> {
        let own = &self.simulation.world.market.social.own;
        let (post, posts) = (own.get(at)?, &self.simulation.feed.posts);
        let shown = |number: u32| Some(posts.get((number as usize).checked_sub(1)?)?.content.as_str());
        let who = |group: &Group| (*group, self.simulation.params.group(*group).description.as_str());
        Some(scoring::prompt(&PostForReaders {
            content: &post.content,
            day: post.day,
            original: post.reply_to.and_then(shown),
            earlier: own[..at].iter().map(|post| (post.day, post.content.as_str())).collect(),
            groups: known.iter().map(who).collect(),
        }))
    }

    fn note_failure(&mut self, asked: AskedOfModel, problem: String, took_ms: f64) {
        self.note(Record::Voice(VoiceAnswer::Failed(FailedAnswer { asked, problem, took_ms })));
    }

    /// Asks for the newest posts after a day in other words. Without an answer all of them keep the words they have.
    pub(crate) fn word_days_after(&mut self, day: u32) {
        let Some(speaker) = self.voice.speaker.as_mut().filter(|speaker| speaker.settings.words) else {
            return;
        };
        let feed = &self.simulation.feed.posts;
        let newest = feed.iter().rev().take_while(|post| post.day > day && !post.content.is_empty());
        let newest: Vec<&PublicPost> = newest.take(MOST_POSTS).collect();
        if newest.is_empty() {
            return;
        }
        let built_in: Vec<BuiltInPost<'_>> = newest.iter().map(|post| as_built_in(post)).collect();
        let prompt = wording::prompt(&built_in);
        let Reply { answer, took_ms } = speaker.ask(&prompt, |answer| wording::read(answer, &built_in));
        match answer {
            Ok(texts) => {
                let numbers = newest.iter().map(|post| post.post);
                let posts = numbers.zip(texts).map(|(post, text)| WordedPost { post, text }).collect();
                let worded = WordedPosts { posts, took_ms };
                let record = Record::Voice(VoiceAnswer::Words(worded.clone()));
                if self.append(&record, Durability::Synced).is_ok() {
                    self.take_words(&worded.posts);
                }
            }
            Err(problem) => self.note_failure(AskedOfModel::Words, problem, took_ms),
        }
    }

    /// Shows posts in these words from now on.
    pub(super) fn take_words(&mut self, posts: &[WordedPost]) {
        for WordedPost { post, text } in posts {
            self.simulation.feed.reword(*post, text);
        }
        let rewordings = || posts.iter().map(|own| (own.post, own.text.clone())).collect();
        self.projection.entries().write(|| Entry { rewordings: rewordings(), ..Entry::default() });
    }
}

fn as_built_in(post: &PublicPost) -> BuiltInPost<'_> {
    BuiltInPost { text: &post.content, group: post.written_by, profile: post.profile.as_deref() }
}
