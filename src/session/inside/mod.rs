//! The only access to hidden state: who may inspect a run, the record of each look, and what a look shows.
//!
//! Every function that shows hidden state needs a [`Look`](look::Look). A look exists only after it was permitted and recorded.

pub(crate) mod companion;
pub(crate) mod last_day;
pub(crate) mod look;
pub(crate) mod permission;
pub(crate) mod shadow;
