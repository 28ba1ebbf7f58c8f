//! Studies with people: the protocol, the steps of a participant, the collection of runs, and the audit.

mod assignment;
mod audit;
mod code;
mod collection;
mod definition;
mod due_questions;
mod keys;
mod participant_session;
mod questions;
mod remarks;
mod session_status;
mod visit_log;
mod withdrawal;

pub use assignment::{ASSIGNMENT_FILE, Assignment, AssignmentRow};
pub use audit::{AuditFinding, AuditReport, FindingKind, RunFacts, audit_study};
pub use code::{CodeCheck, CodeOutcome, MIN_CODE_CHARACTERS};
pub use collection::{CollectNote, CollectedRuns, FoundRun, FoundVisit, collect_runs, missing_participants};
pub use definition::{CodeDigest, PracticeOffer, Protocol, STUDY_FILE, SeedPlan, Study};
pub use due_questions::DueQuestion;
pub use keys::{
    LAB_KEY_FILE, LAB_PUBLIC_KEY_FILE, SEAL_KEY_FILE, create_missing_keys, load_lab_key, load_lab_public_key,
    load_seal_key,
};
pub use novamind_record::folder::configuration::CONSENT_FILE;
pub use participant_session::{
    CLOSE_WINDOW_NOTICE, DECLINED_NOTICE, NextStep, ParticipantSession, RETURN_LATER_NOTICE,
};
pub use questions::{AnswerFormat, Occasion, Question, Questionnaire};
pub use remarks::{REMARKS_FILE, Remark, read_remarks, write_remark};
pub use session_status::{SessionState, SessionStatus, session_statuses};
pub use visit_log::{
    VISITS_FILE, VisitEvent, VisitLine, VisitSummary, has_visited, read_study_visits, read_visits,
};
