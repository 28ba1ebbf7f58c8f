//! Measurement of user activity for the record: view times of screens and dialogs, typing statistics, and presence.

mod presence;
mod stopwatch;
mod typing;

pub use presence::PresenceWatch;
pub use stopwatch::{Stopwatch, millis};
pub use typing::{CELL_SEPARATOR, EditSource, TypingLog};
