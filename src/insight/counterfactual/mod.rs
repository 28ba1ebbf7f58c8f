//! What would have been: days of a run simulated again, in memory, with something changed and the same luck.
//!
//! Streams of chance are named by what they are for, so whatever an edit does not touch draws what it drew. No database, no
//! trajectory, no notices: a [`KeptState`](kept_state::KeptState) of the run, the [`Move`](script::Move)s that follow it, some
//! [`Edits`](edits::Edits), and the figures that come out.

pub(crate) mod branch;
pub(crate) mod companies;
pub(crate) mod edits;
pub(crate) mod kept_state;
pub(crate) mod last_read;
pub(crate) mod one_each;
pub(crate) mod past;
pub(crate) mod script;
#[cfg(test)]
pub(crate) mod test_kit;
#[cfg(test)]
mod tests;
