//! One run: open, act, query, advance, record, resume, replay. The only door to a world.
//!
//! Plan, log, apply: a call is planned without effect, its line is on the disk, and only then the world
//! changes; applying cannot fail. So memory is never ahead of the trajectory, the trajectory never ahead of
//! what was confirmed, and a run can always be rebuilt from `run.toml` and `trajectory.jsonl`.

pub mod archive;
mod ask;
mod audit;
mod class;
mod counterfactual;
mod create;
mod curve;
mod figures;
mod lesson;
mod model_voice;
mod play;
mod playback;
mod python;
#[cfg(test)]
mod record_tests;
mod resume;
mod same_world;
mod state;
mod study;
mod whatif;
mod why;
mod xray;

pub use archive::{Export, Imported, LabKey, LabPublicKey, Seal, import_run};
pub use ask::{connection_to_file, query_refusal, rows_as_json, with_the_way_to_hidden_tables};
pub use audit::{Audit, AuditFinding, AuditKind, RunFacts, audit};
pub use class::class_file::{Class, ToHandOut};
pub use class::collected_class::CollectedClass;
pub use class::collecting::{ClassCollection, ClassSources};
pub use class::evidence::{ClassRun, Evidence, RunVerdict, StepEvidence};
pub use class::finding::ClassFinding;
pub use class::handout::Handout;
pub use class::reference::{ClassReference, ranked_goal, share_of_good};
pub use counterfactual::last_read::{LastRead, OfRecord};
pub use counterfactual::one_each::unless_stopped;
pub use counterfactual::script::{PastCall, PastDecision};
#[cfg(feature = "server")]
pub use create::baseline::baseline_terms;
pub use create::{NewRun, Storage, StudyEntry};
pub use curve::access::CurveLook;
pub use curve::example::example_curve;
pub use curve::explorer::{
    CurveBasis, CurveExplorer, CurveOutcome, CurvePoint, Expected, PlanPoint, SAMPLED_LEADS, true_curve_of,
};
pub use figures::alike_plans::AlikePlans;
pub use figures::attendance::{Attendance, AttendedTime, Attention, BREAK_SECONDS, TimeSpent};
pub use figures::attended_week::{AttendedWeek, FAST_WEEK_SECONDS};
pub use figures::best_channels::best_starting_channel;
pub use figures::booked::Booked;
pub use figures::changes::{Change, Decisions};
pub use figures::churn::churn_of_last_week;
pub use figures::dashboard::DeliveredQuality;
pub use figures::estimates::Estimates;
pub use figures::groups::{GroupWeek, PaidLeads};
pub use figures::journal::JournalEntry;
pub use figures::naive::{Bands, Coverage, Hindcast, Stage, hindcasts};
pub use figures::observe::{Observation, WaitingThread};
pub use figures::pace::Pace;
pub use figures::research_outlook::{LateProject, ResearchMeans, ResearchOutlook, ResearchSpread};
pub use figures::scored_forecast::{ForecastScore, ScoredForecast, Verdict, filed_forecasts};
pub use figures::setting::{Audience, SettingId};
pub use figures::sitting_count::SittingCount;
pub use figures::tool_limits::{CapacityTier, ModelTier, RunningStudy, StudyLevel, ToolLimits};
pub use figures::truth::truth_behind;
pub use figures::week::{Forecasts, WEEK_OF_ENTRY, WeekFigures, entries_of_weeks, naively, week_of};
pub use lesson::conduct::LessonEntry;
pub use lesson::debrief::{
    Debrief, DebriefStep, DecisionComparison, DecisionEffect, FirstDifference, JudgedFigure, PartingEffect,
    PlayedPart, ReferenceCurve,
};
pub use lesson::decisions::{DecisionContrast, PartedDecision, SettingContrast};
pub use lesson::definition::{
    CapacityMover, ForecastsAsked, GoalBound, Guess, GuessForm, LessonAccess, LessonGoal, LessonPart,
    LessonPlan, LessonStep, MEASURED_SEEDS, MeasuredFigure, Pitfall, PitfallBound, RationaleAsked,
    ReferencePlay, ScheduledCalls,
};
pub use lesson::lesson_call::LessonCall;
pub use lesson::lesson_file::Lesson;
pub use lesson::measurement::{Measurement, NumberSource, Over};
pub use lesson::page::{GoalPage, LessonPage, LessonQuestion};
pub use lesson::reference::{PartPlay, play_part, play_part_telling};
pub use lesson::standing::LessonStanding;
pub use novamind_record::error::RunError;
pub use novamind_record::folder::configuration::{
    Configuration, DEFAULT_SCENARIO, Scenario, check_cash, check_days,
};
pub use novamind_record::folder::consent::{Agreed, Consent, ConsentGiven, ConsentMeans, ConsentText};
pub use novamind_record::folder::derived::{manifest_of, manifest_text};
pub use novamind_record::folder::durable::{folder_of, write_whole};
pub use novamind_record::folder::library::{self, Library};
pub use novamind_record::folder::lock::{SERVER_FILE, is_being_played};
pub use novamind_record::folder::manifest::{FORMAT, Manifest};
pub use novamind_record::folder::mode::Mode;
pub use novamind_record::folder::preview::{RunPreview, run_preview};
pub use novamind_record::folder::runs::{
    RunSummary, all_run_folders, base_of_runs, delete_run, find_run, find_run_to_read, list_runs,
    participant_folder, run_folder,
};
pub use novamind_record::rules::{AtLimit, DraftsKept, FreeText, ResultsShown, SessionRules, TimeLimits};
pub use novamind_record::stamp::{EarlierRun, LessonStamp, StudyStamp};
pub use novamind_record::trajectory::record::{
    Activity, Calculated, Ended, LessonEvent, LessonNote, Parent, QuerySource, Reversal, Via,
};
pub use novamind_record::trajectory::{
    Line, Record, ScriptedClock, Trajectory, end_of, nanoseconds as nanoseconds_of, policy_of,
    policy_rationale, record, steady, written_moment,
};
pub use play::act::Preview;
pub use play::advance::DayReport;
pub use play::afterwards::lines_afterwards;
pub use play::clock::TIME_LIMIT;
pub use play::drafts::UnsentTexts;
pub use play::machine::Machine;
pub use play::once::WeekRequest;
pub use play::parameters::{ChangedParameter, ChangedParameters};
pub use play::personal_clock::TimeLeft;
pub use play::presence::{IDLE_AFTER, Interface};
pub use play::undo::undone_calls;
pub use play::week::Week;
pub use playback::Playback;
pub use playback::position::{Chapter, Goal, PlaybackPosition, SeekResult};
pub use playback::record_view::RecordView;
pub use python::PYTHON_NOT_RUN;
pub use resume::look::record_look;
pub use resume::open::{Access, end_run};
pub use resume::rebuild::rebuild_database;
pub use resume::rescue::{Rescued, rescue};
pub use resume::sealing::SealKey;
pub use resume::verify::{Verification, verify, verify_sealed};
pub use same_world::SameWorld;
pub use state::{AnswersCompanies, Session};
pub use study::assignment::{ASSIGNMENT_FILE, Assignment, Place};
pub use study::code::CodeCheck;
pub use study::definition::{CONSENT_FILE, CodeDigest, PracticeOffer, Protocol, STUDY_FILE, SeedPlan, Study};
pub use study::due::DueQuestion;
pub use study::gather::{CollectNote, FoundRun, FoundVisit, Gathered, gather, missing_places};
pub use study::keys::{
    LAB_KEY_FILE, LAB_PUBLIC_KEY_FILE, SEAL_KEY_FILE, lab_key_of, lab_public_key_of, make_keys, seal_key_of,
};
pub use study::questions::{Form, Moment, Question, Questionnaire};
pub use study::remarks::{REMARKS, Remark, remarks, write_remark};
pub use study::sittings::{Sitting, SittingState, sittings};
pub use study::visit::{DECLINED, NextStep, Visit};
pub use study::visit_log::{
    VISITS, VisitEvent, VisitLine, VisitSummary, has_come, record_refused_code, visits, visits_of,
};
pub use whatif::{
    Adopted, BranchComparison, BranchFigure, BranchFigures, BranchOrigin, DecisionDifference, DecisionEdit,
    FORMS, FirstChange, FutureBand, Futures, Kin, MOST_ALTERNATIVES, OnWhatIfProgress, ParameterDifference,
    WhatIf, branches_of, origin_of, sets_amounts,
};
pub use why::{
    Cause, Causes, Detail, FigureUnit, InputDetail, OnProgress, WeekFigure, WeekQuantity, WeekQuestion, Why,
    WhyPart, WhyProgress,
};

pub use xray::breakpoint::condition::{Condition, Direction, Judged, Relation, WorldEvent};
pub use xray::breakpoint::grammar::ConditionProblem;
pub use xray::breakpoint::list::Breakpoint;
pub use xray::breakpoint::look_back::LookBack;
pub use xray::breakpoint::measure::{Measure, MeasureKind, Quantity};
pub use xray::breakpoint::run::{Hit, RunUntil, TrueBefore};
pub use xray::company_day::{CompanyDay, JudgedPlan};
pub use xray::company_lens::CompanyLens;
pub use xray::customer_diary::{CustomerDay, DayOutcome, FirstDecision, FirstTerms};
pub use xray::customer_lens::CustomerLens;
pub use xray::difference::{CustomerDifference, Difference, RunDifference};
pub use xray::drift_state::{DriftState, GroupDrifted};
pub use xray::hidden_values::{HiddenValues, TrueGroup};
pub use xray::last_day::Xray;
pub use xray::lead_equation::{LeadEquation, LeadFactor};
pub use xray::lens::Lens;
pub use xray::next_draws::{Draw, DrawnPart, Follows, KeyedDraws, MOST_DRAWS, NextDraws};
pub use xray::permission::{REFUSED_LOOK, may_look_inside};
pub use xray::quality_equation::{PlanDelivered, QualityEquation, SharedGains};
pub use xray::reputation_equation::{Departures, LeastChanges, OwnChange, ReputationEquation, Spillover};
pub use xray::rival_state::{NextRivalMove, RivalState};
pub use xray::satisfaction_equation::{MoodTerm, SatisfactionEquation};
pub use xray::weighed::{PlanTerms, Term, TurningTerm, Weighed};
pub use xray::writes::target::WriteTarget;
pub use xray::writes::{WhoWrites, Write, WrittenBy};

pub use novamind_database::{Cell, Interrupt, QueryConnection, QueryError, Rows, Ticket, number_at, text_at};
pub use novamind_tools::{FORECAST_KEYS, Numbers, PublicPost, Refusal, ToolId};
pub use novamind_voice::CompanyNames;
pub use novamind_voice::judge::Judgement;
pub use novamind_voice::model::settings::{ModelSettings, ModelStamp};
pub use novamind_world::enterprise::Answer as CompanyAnswer;
pub use novamind_world::events::{Category, EndCause, Severity, Source};
pub use novamind_world::fault::Fault;
pub use novamind_world::identifiers;
pub use novamind_world::market::competitors::Event as RivalEvent;
pub use novamind_world::market::drift::Expectation;
pub use novamind_world::market::reputation::{ReputationCause, Spill, SpillOver};
pub use novamind_world::market::surges::Surge;
pub use novamind_world::settings::{CoreSettings, Settings};
