//! The runs folder on the session thread: listing, opening, ending and deleting runs.

use std::path::Path;
use std::sync::Arc;

use super::run::tell_days;
use super::{Open, SessionThread};
use crate::asking::{Question, Reply};
use crate::company::Company;
use crate::message::{Instead, News};
use novamind_record::error::RunError;
use novamind_record::folder::preview::{RunPreview, run_preview};
use novamind_record::folder::runs::{
    RunSummary, all_run_folders, delete_run, find_run, find_run_to_read, list_runs,
};
use novamind_record::trajectory::record::LeavingCause;
use novamind_rules::answers_to_companies;
use novamind_session::{Access, NewRun, SealKey, Session, Storage, end_run, rescue};
use novamind_tools::Refusal;

/// Asks for a preview of a run.
#[derive(Debug, Clone)]
pub struct PreviewQuestion {
    /// Id of the run.
    pub id: String,
}

impl Question for PreviewQuestion {
    type Answer = RunPreview;
    type Progress = ();

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let found = thread.lists_everybody.then(|| find_run_to_read(&thread.runs, &self.id).ok()).flatten();
        let runs = found.as_deref().and_then(Path::parent).unwrap_or(&thread.runs);
        let told = |error: RunError| Refusal::new("not_readable", error.to_string());
        reply.answer(run_preview(runs, &self.id).map_err(told));
    }
}

impl SessionThread {
    pub(super) fn list_runs(&self, done: Option<Result<String, String>>) {
        self.say(News::Runs(done, self.listed().map_err(|error| error.to_string())));
    }

    /// Lists the runs of the folder; for experimenters, those of all participants.
    fn listed(&self) -> Result<Vec<RunSummary>, RunError> {
        if !self.lists_everybody {
            return list_runs(&self.runs);
        }
        let mut all = Vec::new();
        for folder in all_run_folders(&self.runs) {
            all.extend(list_runs(&folder)?);
        }
        all.sort_by(|one, other| other.played.cmp(&one.played).then_with(|| one.id.cmp(&other.id)));
        Ok(all)
    }

    pub(super) fn end_run(&self, id: &str) {
        self.say_kept(end_run(&self.runs, id), format!("run {id} has been ended; you can still open it"));
    }

    pub(super) fn delete_run(&self, id: &str) {
        self.say_kept(delete_run(&self.runs, id), format!("run {id} has been deleted"));
    }

    fn say_kept(&self, done: Result<(), RunError>, words: String) {
        self.list_runs(Some(done.map(|()| words).map_err(|error| error.to_string())));
    }

    /// Creates a run in the folder. Its calls are synced to disk before they are confirmed.
    pub(super) fn create(&mut self, new: NewRun) {
        let storage = Storage::Runs(self.runs.clone());
        let new = NewRun { storage, projection: true, sync_calls: true, ..new };
        let created = new.check_baseline(&self.configuration);
        let mut tell = tell_days(&self.news);
        let made =
            created.and_then(|()| Session::create_telling(new.clone(), &self.configuration, &mut tell));
        match made {
            Err(RunError::ConsentNeeded(text)) => {
                self.say(News::NotOpened(text.text, Some(Instead::Agree(Box::new(new)))));
            }
            made => self.take(made, "", None),
        }
    }

    pub(super) fn open_run(&mut self, id: &str, access: Access) {
        let found = match access {
            Access::Write => find_run(&self.runs, id),
            Access::Read => find_run_to_read(&self.runs, id),
        };
        // The run that is inspected may be the one to open; its lock is released here.
        self.inside = None;
        let opened = found.and_then(|folder| {
            self.refuse_session_of_study(&folder, access)?;
            match access {
                Access::Write => Session::open_to_play(&folder, &self.configuration),
                Access::Read => Session::open_to_read(&folder, true),
            }
        });
        if opened.is_ok() {
            // All confirmed actions are on disk; only derived rows can be missing.
            let _ = self.put_down(LeavingCause::Quit);
        }
        self.take(opened, id, None);
    }

    /// Only its participant may continue a session of a study, under its protocol.
    fn refuse_session_of_study(&self, folder: &Path, access: Access) -> Result<(), RunError> {
        let is_elsewhere = folder.parent() != Some(self.runs.as_path());
        if self.lists_everybody && access == Access::Write && is_elsewhere {
            return Err(RunError::NotPossible(
                "only its participant can continue this run; replay it instead".to_owned(),
            ));
        }
        Ok(())
    }

    pub(super) fn rescue(&mut self, id: &str) {
        let rescued =
            find_run_to_read(&self.runs, id).and_then(|folder| rescue(&folder, &SealKey::default()));
        let opened = rescued.and_then(|found| {
            let remark = format!(
                "run {} has lines 1 to {} of run {id}, which is unchanged; {}",
                found.run, found.lines, found.problem
            );
            Session::open(&self.runs.join(&found.run), Access::Write, true).map(|session| (session, remark))
        });
        match opened {
            Ok((session, remark)) => self.take(Ok(session), "", Some(remark)),
            Err(problem) => self.take(Err(problem), "", None),
        }
    }

    /// Shows an opened run with a remark. If opening failed, reports the error and a fallback.
    pub(super) fn take(&mut self, opened: Result<Session, RunError>, id: &str, remark: Option<String>) {
        let mut session = match opened {
            Ok(session) => session,
            Err(problem) => {
                let instead = match &problem {
                    RunError::InUse { id, .. } | RunError::NotWritable { id, .. } => {
                        Some(Instead::Watch(id.clone()))
                    }
                    RunError::Damaged { .. } if !id.is_empty() => Some(Instead::Rescue(id.to_owned())),
                    _ => None,
                };
                return self.say(News::NotOpened(problem.to_string(), instead));
            }
        };
        session.answer_companies_by(answers_to_companies);
        self.queries.connect(&session);
        (self.mending, self.inside) = (None, None);
        let mut company = Company::in_lesson(&mut session, None);
        company.remarks.extend(remark);
        let company = Arc::new(company);
        self.company = Some(company.clone());
        (self.open, self.due) = (Some(Open::Played(Box::new(session))), None);
        self.tell_due();
        self.say(News::Opened(company));
    }
}
