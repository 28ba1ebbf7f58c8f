//! The record that was read last, so that the next question about it is answered at once.

use std::path::{Path, PathBuf};

use crate::tools::Refusal;

/// What was made of a record that was asked about last.
pub struct LastRead<T>(Option<(ReadAs, T)>);

/// What was read of a record: its folder, lines as far as a day, and whether the run is over.
type ReadAs = (PathBuf, u32, bool);

impl<T> Default for LastRead<T> {
    fn default() -> LastRead<T> {
        LastRead(None)
    }
}

impl<T> LastRead<T> {
    /// What is made of the run in a folder, as far as a day; it is read unless it was the last one.
    ///
    /// # Errors
    /// Those of reading it; then nothing is kept.
    pub fn of(
        &mut self,
        folder: PathBuf,
        day: u32,
        is_over: bool,
        read: impl FnOnce(&Path) -> Result<T, Refusal>,
    ) -> Result<&mut T, Refusal> {
        let read_as = (folder, day, is_over);
        let kept = match self.0.take().filter(|(known, _)| *known == read_as) {
            Some(kept) => kept,
            None => {
                let made = read(&read_as.0)?;
                (read_as, made)
            }
        };
        Ok(&mut self.0.insert(kept).1)
    }
}
