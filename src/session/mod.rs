//! One run: open, act, query, advance, record, resume, replay. The only door to a world.
//!
//! Plan, log, apply: a call is planned without effect, its line is on the disk, and only then the world
//! changes; applying cannot fail. So memory is never ahead of the trajectory, the trajectory never ahead of
//! what was confirmed, and a run can always be rebuilt from `run.toml` and `trajectory.jsonl`.

mod act;
mod advance;
mod aftermath;
mod agreement;
pub mod archive;
mod ask;
mod booked;
mod branch;
mod changes;
mod configuration;
mod consent;
mod course;
mod create;
mod dashboard;
mod error;
mod estimates;
mod facts_chain;
mod feed;
mod groups;
mod journal;
mod judging;
pub mod library;
mod manifest;
mod memo;
mod mend;
mod mode;
mod notices;
mod observe;
mod office;
mod open;
mod pace;
mod place;
mod playback;
mod rebuild;
mod record_view;
mod recording;
mod rescue;
mod runs;
mod scored_forecast;
mod scripts;
mod setting;
mod snapshot;
mod state;
mod terms;
mod this_week;
mod trajectory;
mod undo;
mod verify;
mod week;
mod witness;
mod xray;

#[cfg(test)]
mod power_cut_tests;

pub use act::Preview;
pub use advance::{DayReport, Week};
pub use archive::{Export, Imported, Seal, import_run};
pub use ask::{desk_of_file, rows_as_json};
pub use booked::Booked;
pub use changes::{Change, Decisions};
pub use configuration::{Configuration, DEFAULT_SCENARIO, Scenario};
pub use consent::{Consent, ConsentText};
pub use course::{RunCourse, run_course};
pub use create::{NewRun, Storage};
pub use dashboard::DeliveredQuality;
pub use error::RunError;
pub use estimates::Estimates;
pub use groups::GroupWeek;
pub use journal::JournalEntry;
pub use library::Library;
pub use manifest::{FORMAT, Manifest};
pub use mode::Mode;
pub use observe::{Observation, WaitingThread};
pub use office::Calculated;
pub use open::Access;
pub use pace::Pace;
pub use place::{Chapter, Goal, Place, Went};
pub use playback::Playback;
pub use rebuild::rebuild_database;
pub use record_view::RecordView;
pub use rescue::{Rescued, rescue};
pub use runs::{
    RunSummary, all_run_folders, delete_run, end_run, find_run, find_run_to_read, list_runs,
    participant_folder, run_folder,
};
pub use scored_forecast::{ForecastScore, ScoredForecast, Verdict, filed_forecasts};
pub use setting::{Audience, SettingId};
pub use state::Session;
pub use terms::{CapacityTier, ModelTier, RunningStudy, StudyLevel, Terms};
pub use trajectory::record::{Ended, Parent, Reversal, Via};
pub use trajectory::{Line, Record, Trajectory, record, seconds as moment_of};
pub use undo::undone_calls;
pub use verify::{Verification, verify};
pub use week::{Forecasts, WEEK_OF_ENTRY, WeekFigures, entries_of_weeks, naively, week_of};
pub use xray::Xray;

pub use crate::database::{Cell, Desk, Interrupt, QueryError, Rows, Ticket, number_at, text_at};
pub use crate::tools::{Numbers, PublicPost, Refusal, ToolId};
pub use crate::voice::judge::Judgement;
pub use crate::world::events::Category;
pub use crate::world::settings::{CoreSettings, Settings};
