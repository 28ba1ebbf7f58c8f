//! A class and its newest collection, which are read from the folder of the class.

use std::path::Path;
use std::sync::Arc;

use super::class_file::Class;
use super::collection::ClassCollection;
use novamind_record::error::RunError;
use novamind_record::lesson::Lesson;

/// A class with its lesson and its newest collection.
#[derive(Debug, Clone, PartialEq)]
pub struct CollectedClass {
    /// Lesson or run of the class, and its students.
    pub class: Class,
    /// The lesson of the class; `None` if a run was handed out.
    pub lesson: Option<Arc<Lesson>>,
    /// The newest collection of submissions.
    pub collection: ClassCollection,
}

impl CollectedClass {
    /// Reads class, lesson and collection from a folder.
    ///
    /// # Errors
    /// Returns an error if the folder contains no class or no collection, or if a file is damaged.
    pub fn read(folder: &Path) -> Result<CollectedClass, RunError> {
        let class = Class::read(folder)?;
        let lesson = class.stored_lesson(folder)?;
        Ok(CollectedClass { class, lesson, collection: ClassCollection::read(folder)? })
    }
}
