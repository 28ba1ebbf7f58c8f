//! A class with what was collected of it last, read from its folder.

use std::path::Path;
use std::sync::Arc;

use super::class_file::Class;
use super::collecting::ClassCollection;
use novamind_record::error::RunError;
use novamind_record::lesson::Lesson;

/// A class with what was collected of it last.
#[derive(Debug, Clone, PartialEq)]
pub struct CollectedClass {
    /// What was handed out, and to whom.
    pub class: Class,
    /// The lesson, if that was handed out.
    pub lesson: Option<Arc<Lesson>>,
    /// What came back.
    pub collection: ClassCollection,
}

impl CollectedClass {
    /// Reads what a folder holds.
    ///
    /// # Errors
    /// It holds no class, nothing was collected yet, or a file of it is damaged.
    pub fn read(folder: &Path) -> Result<CollectedClass, RunError> {
        let class = Class::read(folder)?;
        let lesson = class.lesson_kept(folder)?;
        Ok(CollectedClass { class, lesson, collection: ClassCollection::read(folder)? })
    }
}
