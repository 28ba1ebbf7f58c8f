//! The runs folder on the session thread: listing, opening, ending and deleting runs.

use std::path::Path;
use std::sync::Arc;

use super::open_run::day_reporter;
use super::{ActiveRun, SessionThread};
use crate::company::DisplayedCompany;
use crate::message::{OpenFallback, Response};
use crate::question::{Question, Reply};
use novamind_record::error::RunError;
use novamind_record::folder::preview::{RunPreview, read_preview};
use novamind_record::folder::runs::{
    RunSummary, all_run_folders, delete_run, find_run, find_run_to_read, list_runs,
};
use novamind_record::trajectory::record::DetachCause;
use novamind_rules::calls_for_waiting_threads;
use novamind_session::{Access, NewRun, SealKey, Session, Storage, abandon_run, recover};
use novamind_tools::Rejection;

/// A question for the preview of a run in the run list.
#[derive(Debug, Clone)]
pub struct PreviewQuestion {
    /// ID of the selected run.
    pub id: String,
}

impl Question for PreviewQuestion {
    type Answer = RunPreview;
    type Progress = ();

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let found = thread
            .lists_all_participants
            .then(|| find_run_to_read(&thread.runs_folder, &self.id).ok())
            .flatten();
        let runs = found.as_deref().and_then(Path::parent).unwrap_or(&thread.runs_folder);
        let to_rejection = |error: RunError| Rejection::new("not_readable", error.to_string());
        reply.answer(read_preview(runs, &self.id).map_err(to_rejection));
    }
}

impl SessionThread {
    pub(super) fn list_runs(&self, done: Option<Result<String, String>>) {
        self.send_response(Response::Runs(done, self.read_run_list().map_err(|error| error.to_string())));
    }

    /// Lists the runs in the runs folder. For experimenters, lists the runs of all participants.
    fn read_run_list(&self) -> Result<Vec<RunSummary>, RunError> {
        if !self.lists_all_participants {
            return list_runs(&self.runs_folder);
        }
        let mut all = Vec::new();
        for folder in all_run_folders(&self.runs_folder) {
            all.extend(list_runs(&folder)?);
        }
        all.sort_by(|one, other| other.played.cmp(&one.played).then_with(|| one.id.cmp(&other.id)));
        Ok(all)
    }

    pub(super) fn end_run(&self, id: &str) {
        self.report_folder_change(
            abandon_run(&self.runs_folder, id),
            format!("run {id} has been ended; you can still open it"),
        );
    }

    pub(super) fn delete_run(&self, id: &str) {
        self.report_folder_change(delete_run(&self.runs_folder, id), format!("run {id} has been deleted"));
    }

    fn report_folder_change(&self, done: Result<(), RunError>, words: String) {
        self.list_runs(Some(done.map(|()| words).map_err(|error| error.to_string())));
    }

    /// Creates a run in the runs folder and opens it. Each call in the run is synced before it is confirmed.
    pub(super) fn create_run(&mut self, new: NewRun) {
        let storage = Storage::Runs(self.runs_folder.clone());
        let new = NewRun { storage, projection: true, sync_calls: true, ..new };
        let created = new.check_baseline(&self.configuration);
        let mut report_day = day_reporter(&self.messages);
        let made = created
            .and_then(|()| Session::create_with_progress(new.clone(), &self.configuration, &mut report_day));
        match made {
            Err(RunError::ConsentNeeded(text)) => {
                self.send_response(Response::NotOpened(
                    text.text,
                    Some(OpenFallback::AskConsent(Box::new(new))),
                ));
            }
            made => self.show_opened_run(made, "", None),
        }
    }

    pub(super) fn open_run(&mut self, id: &str, access: Access) {
        let found = match access {
            Access::Write => find_run(&self.runs_folder, id),
            Access::Read => find_run_to_read(&self.runs_folder, id),
        };
        // The session for inspections may hold the lock of the requested run, so close this session first.
        self.inspection_run = None;
        let opened = found.and_then(|folder| {
            self.reject_study_session(&folder, access)?;
            match access {
                Access::Write => Session::open_to_play(&folder, &self.configuration),
                Access::Read => Session::open_to_read(&folder, true),
            }
        });
        if opened.is_ok() {
            // Ignore errors: all confirmed actions are on the disk; only database rows can be missing.
            let _ = self.detach(DetachCause::Quit);
        }
        self.show_opened_run(opened, id, None);
    }

    /// Rejects playing a run that belongs to a participant: only the participant may continue it, under the study's
    /// protocol.
    fn reject_study_session(&self, folder: &Path, access: Access) -> Result<(), RunError> {
        let is_elsewhere = folder.parent() != Some(self.runs_folder.as_path());
        if self.lists_all_participants && access == Access::Write && is_elsewhere {
            return Err(RunError::InvalidRequest(
                "only the participant can continue this run; replay the run instead".to_owned(),
            ));
        }
        Ok(())
    }

    pub(super) fn recover_run(&mut self, id: &str) {
        let rescued =
            find_run_to_read(&self.runs_folder, id).and_then(|folder| recover(&folder, &SealKey::default()));
        let opened = rescued.and_then(|found| {
            let remark = format!(
                "run {} has lines 1 to {} of run {id}, which is unchanged; {}",
                found.run, found.lines, found.problem
            );
            Session::open(&self.runs_folder.join(&found.run), Access::Write, true)
                .map(|session| (session, remark))
        });
        match opened {
            Ok((session, remark)) => self.show_opened_run(Ok(session), "", Some(remark)),
            Err(problem) => self.show_opened_run(Err(problem), "", None),
        }
    }

    /// Shows an opened run with a remark. If opening failed, reports the error and a fallback.
    pub(super) fn show_opened_run(
        &mut self,
        opened: Result<Session, RunError>,
        id: &str,
        remark: Option<String>,
    ) {
        let mut session = match opened {
            Ok(session) => session,
            Err(problem) => {
                let instead = match &problem {
                    RunError::InUse { id, .. } | RunError::NotWritable { id, .. } => {
                        Some(OpenFallback::Watch(id.clone()))
                    }
                    RunError::Damaged { .. } if !id.is_empty() => Some(OpenFallback::Recover(id.to_owned())),
                    _ => None,
                };
                return self.send_response(Response::NotOpened(problem.to_string(), instead));
            }
        };
        session.set_rule_evaluator(calls_for_waiting_threads);
        self.queries.connect(&session);
        (self.repair_at, self.inspection_run) = (None, None);
        let mut company = DisplayedCompany::from_session_with_lesson(&mut session, None);
        company.remarks.extend(remark);
        let company = Arc::new(company);
        self.last_company = Some(company.clone());
        (self.active_run, self.next_week_at) = (Some(ActiveRun::Live(Box::new(session))), None);
        self.report_due_questions();
        self.send_response(Response::Opened(company));
    }
}
