//! Questions of pages that the session thread answers itself or passes to a background thread.

use std::path::Path;
use std::sync::Arc;

use serde_json::Value;

use super::{ActiveRun, SessionThread};
use crate::question::{Question, Reply};
use novamind_insight::{CurveExplorer, CurveInspection, HiddenValues, Inspect, RelatedRun, related_runs};
use novamind_report::opponents::{OpponentResults, PlayOpponentsFn};
use novamind_session::Preview;
use novamind_session::identifiers::Group;
use novamind_tools::{Rejection, ToolId};

/// A question for the preview of a tool call. The preview describes the effects of the call without executing it.
#[derive(Debug, Clone)]
pub struct PreviewCallQuestion {
    /// Tool whose call is previewed.
    pub tool: ToolId,
    /// Arguments of the previewed call.
    pub arguments: Value,
}

impl Question for PreviewCallQuestion {
    type Answer = Preview;
    type Progress = ();

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        if let Some(preview) = thread.with_run(|run| run.session.preview_call(self.tool, &self.arguments)) {
            reply.answer(preview);
        }
    }
}

/// A question for the participation curve of a group: the true curve if inspections are permitted, otherwise the
/// estimated curve.
#[derive(Debug, Clone)]
pub struct CurveQuestion(pub Group);

impl Question for CurveQuestion {
    type Answer = CurveExplorer;
    type Progress = ();

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let found = thread.participation_curve(self.0);
        thread.report_record_loss();
        reply.answer(found);
    }
}

/// A question for the curve of a group as market studies estimate it. For panes that show the curve automatically: the
/// answer reveals no hidden state and is not recorded.
#[derive(Debug, Clone)]
pub struct EstimatedCurveQuestion(pub Group);

impl Question for EstimatedCurveQuestion {
    type Answer = CurveExplorer;
    type Progress = ();

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let Some(run) = &mut thread.active_run else { return };
        reply.answer(CurveExplorer::from_estimates(run.session(), self.0));
    }
}

/// A question for the hidden true values of a day.
#[derive(Debug, Clone)]
pub struct HiddenValuesQuestion {
    /// Day whose true values are requested.
    pub day: u32,
}

impl Question for HiddenValuesQuestion {
    type Answer = Arc<HiddenValues>;
    type Progress = ();

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let session = thread.inspection_session(false);
        let found = session.and_then(|session| session.inspect().hidden_values(Some(self.day)));
        thread.report_record_loss();
        reply.answer(found.map(Arc::new));
    }
}

/// A question for the runs that are related to the open run. The answer is empty in studies and for runs outside the
/// runs folder.
#[derive(Debug, Clone)]
pub struct RelatedRunsQuestion;

impl Question for RelatedRunsQuestion {
    type Answer = Vec<RelatedRun>;
    type Progress = ();

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let Some(session) = thread.active_run.as_mut().map(ActiveRun::session) else { return };
        let id = session.manifest().id.clone();
        let is_among_runs = session.folder().and_then(Path::parent) == Some(thread.runs_folder.as_path());
        if thread.study.is_some() || session.manifest().study.is_some() || !is_among_runs {
            return reply.answer(Ok(Vec::new()));
        }
        let runs = thread.runs_folder.clone();
        reply.answer_on_thread(move |_| Ok(Some(related_runs(&runs, &id))));
    }
}

/// A question for the results of strong policies on the scenario and seed of the open run. Contains the function that
/// simulates the policies.
#[derive(Debug, Clone)]
pub struct OpponentsQuestion(pub PlayOpponentsFn);

impl Question for OpponentsQuestion {
    type Answer = OpponentResults;
    type Progress = ();

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let Some(open) = &mut thread.active_run else { return };
        let missing = || Rejection::new("not_possible", "not possible: a run in memory has no record");
        let folder = open.session().folder().map(Path::to_owned).ok_or_else(missing);
        let configuration = thread.configuration.clone();
        reply.answer_on_thread(move |reply| {
            (self.0)(&folder?, &configuration, &|| reply.check_still_awaited().is_continue())
        });
    }
}

impl SessionThread {
    /// Returns the participation curve of a group on the displayed day. If the curve is the true one, the inspection is
    /// recorded in the run, even if a playback of the run is open.
    fn participation_curve(&mut self, group: Group) -> Result<CurveExplorer, Rejection> {
        let none_open = || Rejection::new("not_possible", "no run is open");
        let (is_allowed, day) = match self.active_run.as_ref().ok_or_else(none_open)? {
            ActiveRun::Live(session) => (session.check_inspection().is_ok(), session.day()),
            ActiveRun::Playback(playback) => (playback.can_inspect(), playback.session().day()),
        };
        let inspection = match is_allowed {
            true => Some(CurveInspection::record(self.inspection_session(false)?, group, day)?),
            false => None,
        };
        let session = self.active_run.as_mut().ok_or_else(none_open)?.session();
        match inspection {
            Some(curve_inspection) => Ok(CurveExplorer::from_true_values(session, &curve_inspection)),
            None => CurveExplorer::from_estimates(session, group),
        }
    }
}
