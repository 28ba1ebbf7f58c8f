//! A cache for the analysis of the most recently used record, so that the next question reuses its simulations.

use std::path::{Path, PathBuf};

use novamind_tools::Refusal;

/// An analysis of a record.
pub trait OfRecord: Sized {
    /// Opens the current record of the run in a folder.
    ///
    /// # Errors
    /// Returns a rejection if the analysis is not permitted or the record cannot be read.
    fn read(folder: &Path) -> Result<Self, Refusal>;

    /// Reads new events.
    ///
    /// # Errors
    /// As [`OfRecord::read`].
    fn renew(&mut self) -> Result<(), Refusal>;
}

/// The analysis of the most recently used record.
pub struct LastRead<T>(Option<(PathBuf, T)>);

impl<T> Default for LastRead<T> {
    fn default() -> LastRead<T> {
        LastRead(None)
    }
}

impl<T: OfRecord> LastRead<T> {
    /// Returns the analysis of the run in a folder with all recorded events.
    ///
    /// # Errors
    /// As [`OfRecord::read`]; the cache is then empty.
    pub fn of(&mut self, folder: PathBuf) -> Result<&mut T, Refusal> {
        let kept = match self.0.take().filter(|(known, _)| *known == folder) {
            Some((folder, mut made)) => {
                made.renew()?;
                (folder, made)
            }
            None => {
                let made = T::read(&folder)?;
                (folder, made)
            }
        };
        Ok(&mut self.0.insert(kept).1)
    }
}
