//! The lessons that a person has: the shipped ones, and those of the configuration folder.

use std::path::PathBuf;

use super::lesson_file::Lesson;
use crate::error::RunError;
use crate::folder::configuration::Configuration;
use novamind_world::params::ParameterSource;

impl Configuration {
    /// The file of a lesson of this person's own; none where there is no folder of configuration.
    pub fn own_lesson(&self, name: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join("lessons").join(format!("{name}.toml")))
    }

    /// Names of all lessons: the shipped ones in the order of the course, then this person's.
    pub fn lessons(&self) -> Vec<String> {
        let mut names: Vec<String> =
            novamind_assets::lessons().into_iter().map(|(name, _)| name.to_owned()).collect();
        let own: Vec<String> = self.names("lessons").into_iter().filter(|own| !names.contains(own)).collect();
        names.extend(own);
        names
    }

    /// A lesson; this person's file goes before the shipped one.
    ///
    /// # Errors
    /// There is none of this name, or one of its files is wrong.
    pub fn lesson(&self, name: &str) -> Result<Lesson, RunError> {
        if let Some(plan) = self.file(format!("lessons/{name}.toml"))? {
            let texts = self.file(format!("lessons/{name}.md"))?.map(|texts| texts.text).unwrap_or_default();
            return Ok(Lesson::read(name, plan, texts, false)?);
        }
        let found = novamind_assets::lessons().into_iter().find(|(shipped, _)| *shipped == name);
        let Some((_, plan)) = found else {
            return Err(RunError::NoLesson { name: name.to_owned(), known: self.lessons().join(", ") });
        };
        let plan = ParameterSource { name: format!("configs/lessons/{name}.toml"), text: plan.to_owned() };
        let texts = novamind_assets::lesson_texts(name).unwrap_or_default().to_owned();
        Ok(Lesson::read(name, plan, texts, true)?)
    }
}
