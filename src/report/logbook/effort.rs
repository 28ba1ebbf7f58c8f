//! Counts what a player did between two simulated weeks.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use novamind_record::trajectory::record::{Activity, DialogOutcome, TextEditOutcome};
use novamind_session::TimeSpent;

/// Counts and durations of a player's actions between two simulated weeks.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct PlayerEffort {
    /// Time by class, such as active, idle and away.
    #[serde(flatten)]
    pub time: TimeSpent,
    /// Number of gaps of more than ten minutes in play.
    pub breaks: u32,
    /// Number of accepted tool calls.
    pub calls: u32,
    /// Number of rejected tool calls.
    pub refused: u32,
    /// Number of earlier tool calls that the player undid.
    pub undone: u32,
    /// Number of accepted calls by tool.
    pub tools: BTreeMap<String, u32>,
    /// Number of SQL queries, including failed ones.
    pub queries: u32,
    /// Number of SQL queries that were rejected or failed.
    pub queries_failed: u32,
    /// Number of times that a screen was opened.
    pub views: u32,
    /// Time spent on each screen.
    #[serde(serialize_with = "active_seconds")]
    pub screens: BTreeMap<String, TimeSpent>,
    /// Number of objects that were opened, such as groups and threads.
    pub selects: u32,
    /// Number of dialogs that were confirmed.
    pub dialogs_confirmed: u32,
    /// Number of dialogs that were cancelled.
    pub dialogs_cancelled: u32,
    /// Number of explanations of terms that were opened.
    pub helps: u32,
    /// Number of texts that the player edited but did not submit.
    pub drafts_left: u32,
    /// Number of characters typed into texts.
    pub typed: u64,
    /// Number of characters deleted from texts.
    pub deleted: u64,
    /// Number of characters pasted into texts.
    pub pasted: u64,
    /// Number of times that the player saved the notes.
    pub memos: u32,
}

impl PlayerEffort {
    pub(super) fn add_activity(&mut self, activity: &Activity) {
        match activity {
            Activity::View(_) => self.views += 1,
            Activity::Select(_) => self.selects += 1,
            Activity::Dialog(dialog) => match dialog.outcome {
                DialogOutcome::Confirmed => self.dialogs_confirmed += 1,
                DialogOutcome::Cancelled => self.dialogs_cancelled += 1,
            },
            Activity::Help(_) => self.helps += 1,
            Activity::Draft(draft) => {
                self.drafts_left += u32::from(draft.outcome == TextEditOutcome::Left);
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
            | Activity::ExternalRead(_)
            | Activity::Inspection(_) => {}
        }
    }

    pub(super) fn add(&mut self, other: &PlayerEffort) {
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
