//! The only access to hidden state: recorded inspections and replays of a run.
//!
//! Every function that shows hidden state needs a [`InspectionPermit`](look::Look), which exists only after it was permitted and
//! recorded.

pub(crate) mod access;
pub(crate) mod run_replay;
