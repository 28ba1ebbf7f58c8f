//! What the person has before them and does with it, as the record of the run tells it: how long a screen and a dialog
//! were open, how a text came to be, whether somebody is there.

mod presence;
mod stopwatch;
mod typing;

pub use presence::PresenceWatch;
pub use stopwatch::{Stopwatch, ms};
pub use typing::{BETWEEN_CELLS, Edit, Typing};
