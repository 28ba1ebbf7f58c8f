//! What was done between two weeks, counted.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use novamind_record::trajectory::record::{Activity, DialogOutcome, DraftOutcome};
use novamind_session::TimeSpent;

/// What was done between two weeks.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Effort {
    /// Where the time went.
    #[serde(flatten)]
    pub time: TimeSpent,
    /// Times of more than ten minutes in which nobody played.
    pub breaks: u32,
    /// Calls that were accepted.
    pub calls: u32,
    /// Calls that were refused.
    pub refused: u32,
    /// Calls that took back another.
    pub undone: u32,
    /// Accepted calls by tool.
    pub tools: BTreeMap<String, u32>,
    /// SQL queries.
    pub queries: u32,
    /// Queries that were refused or failed.
    pub queries_failed: u32,
    /// Views of screens.
    pub views: u32,
    /// Active seconds on each screen.
    #[serde(serialize_with = "active_seconds")]
    pub screens: BTreeMap<String, TimeSpent>,
    /// Objects that were opened.
    pub selects: u32,
    /// Dialogs whose question was confirmed.
    pub dialogs_confirmed: u32,
    /// Dialogs that were left.
    pub dialogs_cancelled: u32,
    /// Terms that were explained.
    pub helps: u32,
    /// Texts that were edited and left behind.
    pub drafts_left: u32,
    /// Characters that were typed into texts.
    pub typed: u64,
    /// Characters that were deleted from them.
    pub deleted: u64,
    /// Characters that came from the clipboard.
    pub pasted: u64,
    /// Changes of the notes.
    pub memos: u32,
}

impl Effort {
    /// Counts something that a person did besides acting.
    pub(super) fn count(&mut self, activity: &Activity) {
        match activity {
            Activity::View(_) => self.views += 1,
            Activity::Select(_) => self.selects += 1,
            Activity::Dialog(dialog) => match dialog.outcome {
                DialogOutcome::Confirmed => self.dialogs_confirmed += 1,
                DialogOutcome::Cancelled => self.dialogs_cancelled += 1,
            },
            Activity::Help(_) => self.helps += 1,
            Activity::Draft(draft) => {
                self.drafts_left += u32::from(draft.outcome == DraftOutcome::Left);
                self.typed += draft.typed;
                self.deleted += draft.deleted;
                self.pasted += draft.pasted;
            }
            Activity::Session(_)
            | Activity::Clock(_)
            | Activity::Limit(_)
            | Activity::Question(_)
            | Activity::Answer(_)
            | Activity::Lesson(_)
            | Activity::Look(_)
            | Activity::Xray(_) => {}
        }
    }

    /// Adds what was done before another week.
    pub(super) fn add(&mut self, other: &Effort) {
        self.time += other.time;
        self.breaks += other.breaks;
        self.calls += other.calls;
        self.refused += other.refused;
        self.undone += other.undone;
        self.queries += other.queries;
        self.queries_failed += other.queries_failed;
        self.views += other.views;
        self.selects += other.selects;
        self.dialogs_confirmed += other.dialogs_confirmed;
        self.dialogs_cancelled += other.dialogs_cancelled;
        self.helps += other.helps;
        self.drafts_left += other.drafts_left;
        self.typed += other.typed;
        self.deleted += other.deleted;
        self.pasted += other.pasted;
        self.memos += other.memos;
        for (tool, count) in &other.tools {
            *self.tools.entry(tool.clone()).or_default() += count;
        }
        for (screen, time) in &other.screens {
            *self.screens.entry(screen.clone()).or_default() += *time;
        }
    }
}

fn active_seconds<S: Serializer>(
    screens: &BTreeMap<String, TimeSpent>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(screens.iter().map(|(screen, time)| (screen, time.active_seconds())))
}
