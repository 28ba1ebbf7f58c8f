//! What would have been: days of a run simulated again, in memory, with something changed and the same luck.
//!
//! Streams of chance are named by what they are for, so whatever an edit does not touch draws what it drew. No database, no
//! trajectory, no notices: a [`KeptState`](kept_state::KeptState) of the run, the [`Move`](script::Move)s that follow it, some
//! [`Edits`](edits::Edits), and the figures that come out.

pub(in crate::session) mod branch;
pub(in crate::session) mod companies;
pub(in crate::session) mod edits;
pub(in crate::session) mod kept_state;
pub(in crate::session) mod last_read;
pub(in crate::session) mod one_each;
pub(in crate::session) mod past;
pub(in crate::session) mod script;
#[cfg(test)]
pub(in crate::session) mod test_kit;
#[cfg(test)]
mod tests;
