//! A witness outside the machine: what a trajectory was, told while it was written (docs/formats/witness.md).
//!
//! A chain of hashes shows that a file is whole, not that it is the file that was played: whoever can write it can forge
//! every line anew. So each line's hash is told to a folder that the experimenter chose, usually on another computer, and
//! later the trajectory is compared with what was told.

mod carrier;
mod code_words;
mod compare;
mod queue;
mod record;
mod waiting;

pub use carrier::Witness;
pub use code_words::{code_words, line_of_code};
pub use compare::{Finding, FindingKind, compare};
pub use record::{Told, WitnessRecord, read_witness};
pub(in crate::session) use waiting::waiting_lines;
