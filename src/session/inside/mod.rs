//! The one way out of hidden state: who may look inside a run, what a look leaves behind, and what it then sees.
//!
//! Whatever shows hidden state needs a [`Look`](look::Look), which exists only once the look was allowed and recorded.

pub(crate) mod companion;
pub(crate) mod last_day;
pub(crate) mod look;
pub(crate) mod permission;
pub(crate) mod shadow;
