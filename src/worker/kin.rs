//! The tree of branches in which the run stands, read on a thread of its own: the run goes on meanwhile.

use std::path::Path;

use super::answering::answer_on_thread;
use super::{Open, SessionThread};
use crate::message::News;
use novamind_insight::branches_of;

impl SessionThread {
    /// Reads the tree of branches. It is empty where other runs are nobody's business here: in sessions of a study, and where
    /// the record does not lie among the runs that can be opened.
    pub(super) fn read_kin(&self) {
        let session = match &self.open {
            Some(Open::Played(session)) => Some(session.as_ref()),
            Some(Open::Replayed(playback)) => Some(playback.session()),
            None => None,
        };
        let Some(session) = session else { return self.say(News::Kin(String::new(), Ok(Vec::new()))) };
        let id = session.manifest().id.clone();
        let is_among_runs = session.folder().and_then(Path::parent) == Some(self.runs.as_path());
        if self.desk.is_some() || session.manifest().study.is_some() || !is_among_runs {
            return self.say(News::Kin(id, Ok(Vec::new())));
        }
        let (news, runs) = (self.news.clone(), self.runs.clone());
        let run = id.clone();
        answer_on_thread(news, move || Ok(Some(branches_of(&runs, &run))), |tree| News::Kin(id, tree));
    }
}
