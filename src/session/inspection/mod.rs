//! The only access to hidden state: recorded inspections and replays of a run.
//!
//! Every function that shows hidden state needs an [`InspectionPermit`](access::InspectionPermit). A permit exists
//! only after the inspection was permitted and recorded.

pub(crate) mod access;
pub(crate) mod run_replay;
