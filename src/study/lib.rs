//! Studies with people: the protocol, a participant's steps through it, collection of the runs, and the audit.

mod assignment;
mod audit;
mod code;
mod definition;
mod due;
mod gather;
mod keys;
mod questions;
mod remarks;
mod sittings;
mod tombstone;
mod visit;
mod visit_log;

pub use assignment::{ASSIGNMENT_FILE, Assignment, Place};
pub use audit::{Audit, AuditFinding, AuditKind, RunFacts, audit};
pub use code::CodeCheck;
pub use definition::{CodeDigest, PracticeOffer, Protocol, STUDY_FILE, SeedPlan, Study};
pub use due::DueQuestion;
pub use gather::{CollectNote, FoundRun, FoundVisit, Gathered, gather, missing_places};
pub use keys::{
    LAB_KEY_FILE, LAB_PUBLIC_KEY_FILE, SEAL_KEY_FILE, lab_key_of, lab_public_key_of, make_keys, seal_key_of,
};
pub use novamind_record::folder::configuration::CONSENT_FILE;
pub use questions::{Form, Moment, Question, Questionnaire};
pub use remarks::{REMARKS, Remark, remarks, write_remark};
pub use sittings::{Sitting, SittingState, sittings};
pub use visit::{DECLINED, NextStep, Visit};
pub use visit_log::{
    VISITS, VisitEvent, VisitLine, VisitSummary, has_come, record_refused_code, visits, visits_of,
};
