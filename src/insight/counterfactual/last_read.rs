//! The record that was asked about last, so that the next question about it begins with what was simulated for this one.

use std::path::{Path, PathBuf};

use novamind_tools::Refusal;

/// What answers questions about a record.
pub trait OfRecord: Sized {
    /// Of the run in a folder, as far as it is recorded now.
    ///
    /// # Errors
    /// The record may not be asked about, or cannot be read.
    fn read(folder: &Path) -> Result<Self, Refusal>;

    /// Takes in what has been recorded since.
    ///
    /// # Errors
    /// As [`OfRecord::read`].
    fn renew(&mut self) -> Result<(), Refusal>;
}

/// What was made of a record that was asked about last.
pub struct LastRead<T>(Option<(PathBuf, T)>);

impl<T> Default for LastRead<T> {
    fn default() -> LastRead<T> {
        LastRead(None)
    }
}

impl<T: OfRecord> LastRead<T> {
    /// What is made of the run in a folder, as far as it is recorded now.
    ///
    /// # Errors
    /// Those of reading it; then nothing is kept.
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
