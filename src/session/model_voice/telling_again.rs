//! What a model said, taken from the record: nobody is asked again.

use crate::state::Session;
use novamind_record::trajectory::record::VoiceAnswer;
use novamind_voice::model::scoring::ModelScore;
use novamind_voice::model::wording;

impl Session {
    /// Applies a `voice` line again.
    ///
    /// # Errors
    /// The run has no model that could have said it, or none could have.
    pub(crate) fn replay_voice(&mut self, said: &VoiceAnswer) -> Result<(), String> {
        let Some(model) = &self.manifest.voice else {
            return Err("the run has no language model: the line was put in".to_owned());
        };
        match said {
            VoiceAnswer::Scores(judged) => {
                let fits =
                    model.judge && judged.scores.iter().all(|score: &ModelScore| score.check().is_ok());
                if !fits {
                    return Err("no language model of this run can have given these scores".to_owned());
                }
                self.simulation.scores.take_in(judged.clone());
            }
            VoiceAnswer::Words(worded) => {
                let feed = &self.simulation.feed;
                let is_there = |post: u32| post > 0 && post as usize <= feed.posts.len();
                let mut posts = worded.posts.iter();
                let fits = posts.all(|own| is_there(own.post) && wording::check(&own.text).is_ok());
                if !(model.words && fits) {
                    return Err("no language model of this run can have said these words".to_owned());
                }
                self.take_words(&worded.posts);
                self.commit_projection();
            }
            VoiceAnswer::Failed(_) => {}
        }
        Ok(())
    }
}
