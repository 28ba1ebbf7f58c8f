//! The database of a run as its session sees it: entries go to a writer in the background, statements to a connection.

use std::path::Path;
use std::sync::Arc;

use novamind_database::{
    Entry, Location, Position, ProjectionError, Projector, QueryConnection, Scope, copy_for_other_programs,
    query_connection,
};
use novamind_record::error::RunError;
use novamind_tools::Refusal;
use novamind_world::events::Facts;

/// The rows that follow from what has happened. A run that is played without a database has none: then nothing is
/// written, and statements are refused.
#[derive(Default)]
pub struct Projection {
    projector: Option<Projector>,
    /// The database of a run that has ended, as it stands on the disk: nothing is written any more.
    finished: Option<Location>,
    /// For statements of this thread; opened with the first of them.
    connection: Option<QueryConnection>,
}

impl Projection {
    /// A projection with this writer, if it has one.
    pub(crate) fn of(projector: Option<Projector>) -> Projection {
        Projection { projector, ..Projection::default() }
    }

    /// A projection of a run that has ended: statements go to the database on the disk.
    pub(crate) fn finished(location: Location) -> Projection {
        Projection { finished: Some(location), ..Projection::default() }
    }

    /// Where entries go.
    pub fn entries(&self) -> Entries<'_> {
        Entries(self.projector.as_ref())
    }

    /// Makes everything handed over visible, as of a line.
    pub(crate) fn commit(&self, position: &Position) {
        if let Some(projector) = &self.projector {
            projector.commit(position.clone());
        }
    }

    /// Waits until everything committed is in the database.
    pub(crate) fn wait(&self) -> Result<(), ProjectionError> {
        self.projector.as_ref().map_or(Ok(()), Projector::wait)
    }

    /// Does something once everything handed over so far is written, with the digest of the file if it is asked for; at
    /// once where there is no database.
    pub(crate) fn then(&self, digest: bool, work: impl FnOnce(Option<String>) + Send + 'static) {
        match &self.projector {
            Some(projector) => projector.then(digest, work),
            None => work(None),
        }
    }

    /// What keeps the database from being written.
    pub(crate) fn failure(&self) -> Option<ProjectionError> {
        self.projector.as_ref()?.failure()
    }

    /// A connection of its own, for another thread.
    pub(crate) fn open_connection(&self, scope: Scope) -> Result<QueryConnection, Refusal> {
        let connection = match (&self.projector, &self.finished) {
            (Some(projector), _) => projector.connection(scope),
            (None, Some(location)) => query_connection(location, scope).map(|(connection, _)| connection),
            (None, None) => return Err(Refusal::new("sql_error", "this run is played without a database")),
        };
        connection.map_err(|error| Refusal::new("sql_error", error.to_string()))
    }

    /// The connection of this thread.
    pub(crate) fn connection(&mut self) -> Result<&QueryConnection, Refusal> {
        let connection = match self.connection.take() {
            Some(connection) => connection,
            None => self.open_connection(Scope::Visible)?,
        };
        Ok(self.connection.insert(connection))
    }

    /// Writes the rows into a new file that any SQLite tool can open.
    pub(crate) fn copy_to(&self, file: &Path) -> Result<(), RunError> {
        match (&self.projector, &self.finished) {
            (Some(projector), _) => Ok(projector.copy_for_other_programs(file)?),
            (None, Some(location)) => Ok(copy_for_other_programs(location, file)?),
            (None, None) => Err(RunError::NotPossible("this run is played without a database".to_owned())),
        }
    }

    /// Bounds the pages that the database may take beyond those it has.
    #[cfg(test)]
    pub(crate) fn bound_pages(&self, more: Option<u32>) {
        self.projector.as_ref().expect("a database").bound_pages(more);
    }
}

/// Where entries go, for whatever thread makes them.
#[derive(Clone, Copy)]
pub struct Entries<'a>(Option<&'a Projector>);

impl Entries<'_> {
    /// Hands an entry over; it is made only if there is a database.
    pub(crate) fn write(self, entry: impl FnOnce() -> Entry) {
        if let Some(projector) = self.0 {
            projector.write(entry());
        }
    }

    /// Facts that the writer has done with, to be filled again.
    pub(crate) fn spare_facts(self) -> Option<Arc<Facts>> {
        self.0?.spare_facts()
    }
}
