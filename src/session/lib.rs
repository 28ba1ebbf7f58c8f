//! A run: open, act, query, advance, record, resume, replay. This crate is the only way to change a world.
//!
//! A call is planned without effect, then its line is written, then the world changes. Applying a planned call cannot
//! fail. So memory is never ahead of the trajectory, the trajectory is never ahead of what was confirmed, and a run
//! can always be rebuilt from `run.toml` and `trajectory.jsonl`.

pub mod archive;
mod company;
mod create;
mod database;
mod figures;
mod inside;
mod model_voice;
mod permission;
mod play;
mod playback;
mod python;
#[cfg(test)]
mod record_tests;
mod recording;
mod resume;
mod snapshot;
mod view;

pub use archive::{
    Export, Imported, LabKey, LabPublicKey, Seal, Workshop, import_run, is_archive_name, is_run_name,
    read_seal_key, write_seal_key,
};
pub use company::reports::{DayReport, Week};
pub use company::xray::Xray;
#[cfg(feature = "server")]
pub use create::baseline::baseline_terms;
pub use create::lesson_entry::LessonEntry;
pub use create::{NewRun, Storage, StudyEntry};
pub use database::{RunDatabase, not_readable, query_refusal, rows_as_json, with_the_way_to_hidden_tables};
pub use figures::attendance::{
    Attendance, AttendedTime, AttendedWeek, Attention, BREAK_SECONDS, FAST_WEEK_SECONDS, TimeSpent,
};
pub use figures::changes::{Change, Decisions};
pub use figures::dashboard::DeliveredQuality;
pub use figures::estimates::{Estimates, truth_behind};
pub use figures::groups::{GroupWeek, PaidLeads};
pub use figures::journal::JournalEntry;
pub use figures::naive::{Bands, Coverage, Hindcast, Stage, hindcasts};
pub use figures::pace::Pace;
pub use figures::scored_forecast::{ForecastScore, ScoredForecast, Verdict, filed_forecasts};
pub use figures::setting::{Audience, SettingId, setting_values};
pub use figures::sitting_count::SittingCount;
pub use figures::week::{Forecasts, WEEK_OF_ENTRY, entries_of_weeks, naively, week_of};
pub use inside::look::{Look, WatchedDays};
pub use inside::shadow::Shadow;
#[cfg(all(any(test, feature = "test-kit"), feature = "server"))]
pub use model_voice::stub::{Manner, Stub};
pub use novamind_voice::CompanyNames;
pub use novamind_voice::model::settings::{ModelSettings, ModelStamp};
pub use novamind_world::customers::drift::Expectation;
pub use novamind_world::enterprise::Answer as CompanyAnswer;
pub use novamind_world::events::{Category, EndCause, Severity, Source};
pub use novamind_world::fault::Fault;
pub use novamind_world::identifiers;
pub use novamind_world::market::competitors::Event as RivalEvent;
pub use novamind_world::market::surges::Surge;
pub use novamind_world::reputation::{ReputationCause, Spill, SpillOver};
pub use novamind_world::settings::{CoreSettings, Settings};
pub use permission::{REFUSED_LOOK, may_look_inside};
pub use play::act::Preview;
pub use play::companion::Companion;
pub use play::drafts::{Drafts, UnsentTexts};
pub use play::lesson::conduct::{lesson_step, weeks_passed};
pub use play::lesson::judging::measure;
pub use play::lesson::reference::{PartPlay, play_part, play_part_watched};
pub use play::once::WeekRequest;
pub use play::open::{Access, end_run};
pub use play::undo::undone_calls;
pub use play::{AnswersCompanies, Session};
pub use playback::Playback;
pub use playback::position::{Chapter, Goal, PlaybackPosition, SeekResult};
pub use playback::record_view::RecordView;
pub use python::PYTHON_NOT_RUN;
pub use recording::RunLog;
pub use recording::activity::{ActivityLog, IDLE_AFTER, Interface, TIME_LIMIT};
pub use recording::folders::new_id;
pub use recording::machine::Machine;
pub use recording::personal_clock::TimeLeft;
pub use recording::recorder::lines_afterwards;
pub use resume::branch::branch_of_lesson;
pub use resume::branch::{not_saved, write_past};
pub use resume::look::record_look;
pub use resume::rebuild::{connection_to_file, rebuild_database};
pub use resume::recorded::{Origin, read as read_recorded};
pub use resume::rescue::{Rescued, rescue};
pub use resume::unnamed::UnnamedBranch;
pub use resume::verify::{Verification, verify, verify_sealed};
pub use snapshot::integrity::Integrity;
pub use snapshot::sealing::SealKey;
pub use view::alike_plans::AlikePlans;
pub use view::debug_parameters::{ChangedParameter, ChangedParameters, DebugParameters};
pub use view::observe::{Observation, WaitingThread};
pub use view::research_outlook::{LateProject, ResearchMeans, ResearchOutlook, ResearchSpread};
pub use view::tool_limits::{CapacityTier, ModelTier, RunningStudy, StudyLevel, ToolLimits};
pub use view::{CompanyView, best_starting_channel};

/// Types and functions that simulate the days of a recorded run. Only `novamind-insight` imports them; it checks who
/// may see the results.
pub mod engine {
    pub use crate::company::facts_chain::StateHash;
    pub use crate::company::feed::Feed;
    pub use crate::company::overrides::{
        Overrides, ParameterChange, Taken, Unfit, json_of_value, not_allowed, refuse_outside_debug, unknown,
        value_of_json,
    };
    pub use crate::company::simulation::Simulation;
    pub use crate::database::{Entries, RunDatabase};
    pub use crate::figures::capacity_by_usage::UsageRule;
    pub use crate::figures::changes::changes;
    pub use crate::figures::groups::{count as count_groups, measured_group, mood_of};
}
