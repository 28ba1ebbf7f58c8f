//! Sessions of a run: open, act, query, advance, record, resume and replay. Only this crate changes the world of a run.
//!
//! A call is first planned, which changes nothing. Then the line of the call is written, and then the world changes.
//! Applying a planned call never fails. Therefore memory is never ahead of the trajectory, and a run can always be
//! rebuilt from `run.toml` and `trajectory.jsonl`.

pub mod archive;
mod company;
mod create;
mod database;
mod figures;
mod inspection;
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
    Export, ImportOutcome, LabKey, LabPublicKey, Seal, TemporaryFolder, import_run, is_archive_name,
    is_run_id, read_seal_key, write_seal_key,
};
pub use company::hidden_state::HiddenState;
pub use company::idempotency::IdempotentResponse;
pub use company::reports::{DayReport, WeekResult};
#[cfg(feature = "server")]
pub use create::baseline::baseline_terms;
pub use create::lesson_entry::LessonOptions;
pub use create::{NewRun, Storage, StudyOptions};
pub use database::{
    RunDatabase, query_rejection, rows_to_json, unreadable_record_rejection, with_hidden_table_hint,
};
pub use figures::attendance::{
    Attendance, AttendedWeek, FAST_WEEK_SECONDS, MIN_BREAK_SECONDS, SESSION_BREAK_SECONDS, TimeSpan,
    TimeSpent, TimeUse,
};
pub use figures::changes::{Decisions, SettingChange};
pub use figures::dashboard::DeliveredQuality;
pub use figures::estimates::{Estimates, true_value_range};
pub use figures::groups::{GroupWeek, PaidLeads, PlanRevenue};
pub use figures::journal::JournalEntry;
pub use figures::outlook::{
    AdvertisingChange, BillingCalendar, CommittedCosts, ErrorIntervals, ExpectedFlows, ForecastError,
    GrowthStage, Level, MAX_RUNWAY_DAYS, Outlook, Runway, StageInterval,
};
pub use figures::scored_forecast::{
    ForecastScore, IntervalPosition, ScoredForecast, cash_at_week_end, submitted_forecasts,
};
pub use figures::session_count::SessionCount;
pub use figures::setting::{Audience, SettingId, setting_values};
pub use figures::week::{
    Forecasts, LEDGER_WEEK_SQL, describe_naive_share, ledger_weeks_condition_sql, week_of_day,
};
pub use inspection::access::{InspectionPermit, ObservedDays};
pub use inspection::run_replay::RunReplay;
#[cfg(all(any(test, feature = "test-kit"), feature = "server"))]
pub use model_voice::stub::{StubBehavior, StubModel};
pub use novamind_voice::EnterpriseNames;
pub use novamind_voice::model::settings::{ModelSettings, RecordedModelSettings};
pub use novamind_world::customers::drift::Expectation;
pub use novamind_world::enterprise::OfferResponse;
pub use novamind_world::events::{Category, EndCause, Severity, Source};
pub use novamind_world::fault::Fault;
pub use novamind_world::identifiers;
pub use novamind_world::market::competitors::CompetitorEvent;
pub use novamind_world::market::surges::Surge;
pub use novamind_world::params::{HorizonRule, Interface as Generation};
pub use novamind_world::reputation::{ReputationCause, Spillover, SpilloverEffect};
pub use novamind_world::settings::{CoreSettings, Settings};
pub use permission::{INSPECTION_REJECTED, can_inspect};
pub use play::drafts::{DraftFile, DraftTexts};
pub use play::extension::Extension;
pub use play::idempotent::{WeekRequest, request_id};
pub use play::lesson::judging::measure;
pub use play::lesson::progress::{lesson_step, weeks_passed};
pub use play::lesson::reference::{PartPlay, play_part, play_part_with_hooks};
pub use play::open::{Access, abandon_run};
pub use play::tool_call::Preview;
pub use play::undo::undone_call_lines;
pub use play::{RuleEvaluator, Session};
pub use playback::Playback;
pub use playback::position::{Chapter, PlaybackPosition, SeekResult, SeekTarget};
pub use playback::record_view::RecordView;
pub use python::PYTHON_DISABLED_MESSAGE;
#[cfg(unix)]
pub use python::confinement::{ScriptRestriction, restrict_scripts};
pub use recording::RunLog;
pub use recording::activity::{ActivityLog, IDLE_TIMEOUT, Interface, TIME_LIMIT_RATIONALE};
pub use recording::folders::new_run_id;
pub use recording::idle_watch::IdleWatch;
pub use recording::machine::Machine;
pub use recording::recorder::read_afterwards;
pub use recording::session_clock::TimeLeft;
pub use resume::branch::create_lesson_branch;
pub use resume::branch::{branch_not_saved_rejection, create_branch_files};
pub use resume::external_read::record_external_read;
pub use resume::origin::{Origin, read_origin};
pub use resume::rebuild::{open_database_file, rebuild_database};
pub use resume::recovery::{RecoveredRun, recover};
pub use resume::staged_branch::StagedBranch;
pub use resume::verify::{Verification, verify, verify_sealed};
pub use snapshot::integrity::Integrity;
pub use snapshot::sealing::SealKey;
pub use view::debug_parameters::{ChangedParameter, ChangedParameters, DebugParameters};
pub use view::identical_plans::IdenticalPlans;
pub use view::observation::{Observation, WaitingThread};
pub use view::research_outlook::{LateProject, ResearchMeans, ResearchOutlook, ResearchSpread};
pub use view::tool_limits::{CapacityTier, ModelTier, RunningStudy, StudyLevel, ToolLimits};
pub use view::{CompanyView, best_starting_channel};

/// Types and functions that simulate the days of a recorded run. Only `novamind-insight` imports this module; that
/// crate checks who may see the results.
pub mod engine {
    pub use crate::company::facts_chain::StateHash;
    pub use crate::company::feed::Feed;
    pub use crate::company::overrides::{
        Overrides, ParameterChange, ParameterConflict, UpdatedParams, json_to_value,
        parameter_not_allowed_rejection, require_debug_mode, unknown_parameter_rejection, value_to_json,
    };
    pub use crate::company::simulation::Simulation;
    pub use crate::database::{EntryWriter, RunDatabase};
    pub use crate::figures::capacity_by_usage::UsageCapacityRule;
    pub use crate::figures::changes::setting_changes;
    pub use crate::figures::groups::{add_day_to_week, mean_satisfaction, measure_group};
}
