//! The language model of a run. The model scores the player's posts on the next day and rewords posts at the end of a
//! week. The module also replays recorded responses, and connects the model to a reopened run.

use std::path::Path;

use super::Session;
use super::open::Access;
use crate::company::post_judging::scores_match_post;
use crate::model_voice::client::{ModelClient, ModelReply};
use novamind_database::ProjectionEntry;
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::trajectory::record::{
    FailedModelRequest, JudgedPost, ModelTask, RewordedPost, RewordedPosts, VoiceAnswer,
};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::PublicPost;
use novamind_voice::model::ModelPrompt;
use novamind_voice::model::scoring::{self, ModelScore, PostToScore};
use novamind_voice::model::settings::ModelSettings;
use novamind_voice::model::wording::{self, BuiltInPost, MAX_POSTS_PER_WEEK};
use novamind_world::identifiers::Group;
use novamind_world::params::PostJudge;

impl Session {
    /// Requests scores for the player's posts that are judged next and have no recorded scores. If the scores cannot
    /// be recorded, the built-in judge is used.
    pub(super) fn score_pending_posts(&mut self) {
        let is_judged = self.simulation.params.fidelity.post_judge != PostJudge::None;
        let can_ask = self.voice.client.is_some() || !self.voice.inherited_scores.is_empty();
        if !self.log.is_written() || !is_judged || !can_ask {
            return;
        }
        for at in self.unscored_posts() {
            let Some(judged) = self.inherited_scores(at).or_else(|| self.request_scores(at)) else {
                continue;
            };
            let record = Record::Voice(VoiceAnswer::Scores(judged.clone()));
            if self.append(&record, Durability::Synced).is_ok() {
                self.simulation.recorded_scores.add(judged);
            }
        }
    }

    fn known_groups(&self) -> Vec<Group> {
        Group::all().filter(|group| self.simulation.world.market.is_known(*group)).collect()
    }

    /// Returns the indices of the player's posts that are not judged and have no recorded scores.
    fn unscored_posts(&self) -> Vec<usize> {
        let (known, simulation) = (self.known_groups(), &self.simulation);
        let posts = simulation.world.market.social.own.iter().enumerate();
        posts
            .filter(|(_, post)| post.effects.is_none() && !simulation.recorded_scores.covers(post, &known))
            .map(|(at, _)| at)
            .collect()
    }

    /// Sets the recorded scores of another run, whose posts this run publishes again.
    pub fn set_inherited_scores(&mut self, judged: Vec<JudgedPost>) {
        self.voice.inherited_scores = judged;
    }

    fn inherited_scores(&self, at: usize) -> Option<JudgedPost> {
        let post = self.simulation.world.market.social.own.get(at)?;
        let judged_post =
            self.voice.inherited_scores.iter().rev().find(|judged| scores_match_post(judged, post))?;
        Some(JudgedPost { post: at as u32 + 1, took_ms: 0.0, ..judged_post.clone() })
    }

    fn request_scores(&mut self, at: usize) -> Option<JudgedPost> {
        if !self.voice.client.as_ref()?.settings.judge {
            return None;
        }
        let known = self.known_groups();
        let prompt = self.scoring_prompt(at, &known)?;
        let client = self.voice.client.as_mut()?;
        let ModelReply { answer, took_ms } =
            client.request(&prompt, |answer| scoring::parse_response(answer, &known));
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
                self.record_failure(ModelTask::Scores, problem, took_ms);
                None
            }
        }
    }

    fn scoring_prompt(&self, at: usize, known: &[Group]) -> Option<ModelPrompt> {
        let own_posts = &self.simulation.world.market.social.own;
        let (post, posts) = (own_posts.get(at)?, &self.simulation.feed.posts);
        let shown = |number: u32| Some(posts.get((number as usize).checked_sub(1)?)?.content.as_str());
        let who = |group: &Group| (*group, self.simulation.params.group(*group).description.as_str());
        Some(scoring::prompt(&PostToScore {
            content: &post.content,
            day: post.day,
            original: post.reply_to.and_then(shown),
            earlier: own_posts[..at].iter().map(|post| (post.day, post.content.as_str())).collect(),
            groups: known.iter().map(who).collect(),
        }))
    }

    fn record_failure(&mut self, model_task: ModelTask, problem: String, took_ms: f64) {
        self.record_event(Record::Voice(VoiceAnswer::Failed(FailedModelRequest {
            asked: model_task,
            problem,
            took_ms,
        })));
    }

    /// Requests new texts for the newest posts after a day. If the response is not usable, the posts keep their texts.
    pub(super) fn reword_posts_after(&mut self, day: u32) {
        let Some(client) = self.voice.client.as_mut().filter(|client| client.settings.words) else {
            return;
        };
        let feed = &self.simulation.feed.posts;
        let newest = feed.iter().rev().take_while(|post| post.day > day && !post.content.is_empty());
        let newest: Vec<&PublicPost> = newest.take(MAX_POSTS_PER_WEEK).collect();
        if newest.is_empty() {
            return;
        }
        let built_in: Vec<BuiltInPost<'_>> = newest.iter().map(|post| to_built_in_post(post)).collect();
        let prompt = wording::prompt(&built_in);
        let ModelReply { answer, took_ms } =
            client.request(&prompt, |answer| wording::parse_response(answer, &built_in));
        match answer {
            Ok(texts) => {
                let numbers = newest.iter().map(|post| post.post);
                let posts = numbers.zip(texts).map(|(post, text)| RewordedPost { post, text }).collect();
                let worded = RewordedPosts { posts, took_ms };
                let record = Record::Voice(VoiceAnswer::Words(worded.clone()));
                if self.append(&record, Durability::Synced).is_ok() {
                    self.apply_rewordings(&worded.posts);
                }
            }
            Err(problem) => self.record_failure(ModelTask::Words, problem, took_ms),
        }
    }

    fn apply_rewordings(&mut self, posts: &[RewordedPost]) {
        for RewordedPost { post, text } in posts {
            self.simulation.feed.replace_text(*post, text);
        }
        let rewordings =
            || posts.iter().map(|worded_post| (worded_post.post, worded_post.text.clone())).collect();
        self.database
            .entry_writer()
            .send(|| ProjectionEntry { rewordings: rewordings(), ..ProjectionEntry::default() });
    }

    /// Applies a `voice` line during a replay.
    ///
    /// # Errors
    /// The line is not valid: the run has no language model, or its model cannot have produced the line.
    pub(crate) fn replay_voice(&mut self, voice_answer: &VoiceAnswer) -> Result<(), String> {
        let Some(model) = &self.manifest.voice else {
            return Err("the run has no language model: the line was inserted".to_owned());
        };
        match voice_answer {
            VoiceAnswer::Scores(judged) => {
                let fits =
                    model.judge && judged.scores.iter().all(|score: &ModelScore| score.check().is_ok());
                if !fits {
                    return Err("the language model of this run cannot have returned these scores".to_owned());
                }
                self.simulation.recorded_scores.add(judged.clone());
            }
            VoiceAnswer::Words(worded) => {
                let feed = &self.simulation.feed;
                let is_there = |post: u32| post > 0 && post as usize <= feed.posts.len();
                let mut posts = worded.posts.iter();
                let fits = posts.all(|worded_post| {
                    is_there(worded_post.post) && wording::check(&worded_post.text).is_ok()
                });
                if !(model.words && fits) {
                    return Err("the language model of this run cannot have returned these texts".to_owned());
                }
                self.apply_rewordings(&worded.posts);
                self.commit_projection();
            }
            VoiceAnswer::Failed(_) => {}
        }
        Ok(())
    }

    /// Opens a run for play, and connects its language model if the configuration names that model.
    ///
    /// # Errors
    /// The same errors as [`Session::open`].
    pub fn open_to_play(folder: &Path, configuration: &Configuration) -> Result<Session, RunError> {
        let mut session = Session::open(folder, Access::Write, true)?;
        session.connect_model(configuration.voice.as_ref());
        Ok(session)
    }

    /// Connects the language model of the run. If the connection fails, adds a remark and uses the built-in voice.
    pub fn connect_model(&mut self, named: Option<&ModelSettings>) {
        if self.history.ended.is_some() || !self.log.is_written() {
            return;
        }
        let problem = match (&self.manifest.voice, named) {
            (None, None) => return,
            (None, Some(_)) => {
                self.remarks.push(
                    "This run started with the built-in voice and continues to use it: --voice is ignored."
                        .to_owned(),
                );
                return;
            }
            (Some(_), None) => "to use this model, name its settings file with --voice".to_owned(),
            (Some(model), Some(named)) if named.recorded_settings() != *model => {
                format!("--voice names a different model: {}", named.recorded_settings().describe())
            }
            (Some(_), Some(named)) => match ModelClient::new(named) {
                Ok(client) => {
                    self.voice.client = Some(client);
                    return;
                }
                Err(problem) => problem,
            },
        };
        let model = self.manifest.voice.as_ref().map(|model| model.describe()).unwrap_or_default();
        self.remarks.push(format!(
            "In this run, {model}. From now on, the built-in voice is used ({problem}). Existing texts and scores are kept."
        ));
    }

    /// Returns the settings of the connected language model.
    pub fn model_settings(&self) -> Option<&ModelSettings> {
        self.voice.client.as_ref().map(|client| &client.settings)
    }
}

fn to_built_in_post(post: &PublicPost) -> BuiltInPost<'_> {
    BuiltInPost { text: &post.content, group: post.written_by, profile: post.profile.as_deref() }
}
