//! A cache for the analysis of the most recently used record. The next question about the same record reuses the
//! simulations of the analysis.

use std::path::{Path, PathBuf};

use novamind_tools::Rejection;

/// An analysis of the record of a run.
pub trait RecordAnalysis: Sized {
    /// Opens the current record of the run in a folder.
    ///
    /// # Errors
    /// Returns a rejection if the analysis is not permitted or the record cannot be read.
    fn open(folder: &Path) -> Result<Self, Rejection>;

    /// Reads events that were recorded since the last call.
    ///
    /// # Errors
    /// Same errors as [`RecordAnalysis::open`].
    fn refresh(&mut self) -> Result<(), Rejection>;
}

/// The analysis of the most recently used record.
pub struct AnalysisCache<T>(Option<(PathBuf, T)>);

impl<T> Default for AnalysisCache<T> {
    fn default() -> AnalysisCache<T> {
        AnalysisCache(None)
    }
}

impl<T: RecordAnalysis> AnalysisCache<T> {
    /// Returns the analysis of the run in a folder, updated with all recorded events.
    ///
    /// # Errors
    /// Same errors as [`RecordAnalysis::open`]; the cache is then empty.
    pub fn get_or_open(&mut self, folder: PathBuf) -> Result<&mut T, Rejection> {
        let kept = match self.0.take().filter(|(known, _)| *known == folder) {
            Some((folder, mut made)) => {
                made.refresh()?;
                (folder, made)
            }
            None => {
                let made = T::open(&folder)?;
                (folder, made)
            }
        };
        Ok(&mut self.0.insert(kept).1)
    }
}
