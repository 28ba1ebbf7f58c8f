//! A loaded lesson: its plan and its texts.

use std::path::Path;
use std::sync::Arc;

use super::definition::{GuessForm, LessonPlan, MeasuredFigure};
use super::measurement::NumberSource;
use super::validation::find_defect;
use crate::error::RunError;
use crate::figures::FigureUnit;
use crate::files::write_atomically;
use crate::folder::configuration::Configuration;
use novamind_base::formatting::{dollars_and_cents, grouped_number, percent, short_dollars};
use novamind_world::params::{ParameterError, ParameterSource};

/// File name of the lesson plan in a run folder.
pub const PLAN_FILE: &str = "lesson.toml";
/// File name of the lesson texts in a run folder.
pub const TEXTS_FILE: &str = "lesson.md";

/// A lesson with its plan, debrief and instructor notes.
#[derive(Debug, Clone, PartialEq)]
pub struct Lesson {
    /// Name of the lesson files, without the extension.
    pub name: String,
    /// Definition of parts, goals, pitfalls and reference plays.
    pub plan: LessonPlan,
    /// Debrief for students, in Markdown; `{name}` is a placeholder for a measured figure.
    pub debrief: String,
    /// Notes for instructors, in Markdown.
    pub instructor_notes: String,
    /// BLAKE3 digest of the plan and the texts, in hexadecimal digits.
    pub digest: String,
    /// Whether the lesson is bundled with the program.
    pub is_bundled: bool,
    plan_text: String,
    texts: String,
}

impl Lesson {
    /// Reads a lesson by name. A file in the configuration folder takes precedence over the bundled file.
    ///
    /// # Errors
    /// The lesson does not exist, or one of its files is invalid.
    pub fn load(name: &str, configuration: &Configuration) -> Result<Lesson, RunError> {
        if let Some(plan) = configuration.read_file(format!("lessons/{name}.toml"))? {
            let texts = configuration
                .read_file(format!("lessons/{name}.md"))?
                .map(|texts| texts.text)
                .unwrap_or_default();
            return Ok(Lesson::parse(name, plan, texts, false)?);
        }
        let found = novamind_assets::lessons().into_iter().find(|(bundled, _)| *bundled == name);
        let Some((_, plan)) = found else {
            return Err(RunError::UnknownLesson {
                name: name.to_owned(),
                known: configuration.lesson_names().join(", "),
            });
        };
        let plan = ParameterSource { name: format!("configs/lessons/{name}.toml"), text: plan.to_owned() };
        let texts = novamind_assets::lesson_texts(name).unwrap_or_default().to_owned();
        Ok(Lesson::parse(name, plan, texts, true)?)
    }

    /// Parses a lesson from its plan and its Markdown texts.
    ///
    /// # Errors
    /// The lesson is invalid; the error names the file, line and key of the first defect.
    pub(super) fn parse(
        name: &str,
        plan: ParameterSource,
        texts: String,
        bundled: bool,
    ) -> Result<Lesson, ParameterError> {
        let read: LessonPlan = toml::from_str(&plan.text)
            .map_err(|error| ParameterError::from_toml(&plan.name, &plan.text, &error))?;
        let mut hasher = blake3::Hasher::new();
        hasher.update(plan.text.as_bytes()).update(b"\0").update(texts.as_bytes());
        let lesson = Lesson {
            name: name.to_owned(),
            debrief: extract_section(&texts, "Debrief"),
            instructor_notes: extract_section(&texts, "For the teacher"),
            digest: hasher.finalize().to_hex().to_string(),
            is_bundled: bundled,
            plan: read,
            plan_text: plan.text,
            texts,
        };
        match find_defect(&lesson) {
            None => Ok(lesson),
            Some(found) => Err(ParameterError {
                source: plan.name,
                line: lesson.plan_text.lines().position(|line| line.contains(&found.place)).map(|at| at + 1),
                key: found.key.to_owned(),
                problem: found.problem,
            }),
        }
    }

    /// Reads a lesson from a plan file and the `.md` file of the same name.
    ///
    /// # Errors
    /// The plan file cannot be read, or one of the files is invalid.
    pub fn from_file(path: &Path) -> Result<Lesson, RunError> {
        let text = std::fs::read_to_string(path).map_err(RunError::io(path))?;
        let texts = std::fs::read_to_string(path.with_extension("md")).unwrap_or_default();
        let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(Lesson::parse(&name, ParameterSource { name: path.display().to_string(), text }, texts, false)?)
    }

    /// Reads the copy of the lesson in a run folder.
    ///
    /// # Errors
    /// A file is missing or invalid.
    pub fn from_run(folder: &Path, name: &str) -> Result<Lesson, RunError> {
        let text = |file| {
            let path = folder.join(file);
            std::fs::read_to_string(&path).map_err(RunError::io(&path))
        };
        let source =
            ParameterSource { name: folder.join(PLAN_FILE).display().to_string(), text: text(PLAN_FILE)? };
        Ok(Lesson::parse(name, source, text(TEXTS_FILE)?, false)?)
    }

    /// Parses a lesson from a plan and texts in memory.
    ///
    /// # Errors
    /// The lesson is invalid; the error names the line and key of the first defect.
    pub fn from_texts(name: &str, plan: ParameterSource, texts: String) -> Result<Lesson, RunError> {
        Ok(Lesson::parse(name, plan, texts, false)?)
    }

    /// Returns the unparsed plan and the unparsed texts.
    pub fn sources(&self) -> (&str, &str) {
        (&self.plan_text, &self.texts)
    }

    /// Writes an editable copy of the lesson: the plan to `path`, the texts to the `.md` file of the same name. Never
    /// replaces an existing file.
    ///
    /// # Errors
    /// One of the files already exists or cannot be written.
    pub fn copy_to(&self, path: &Path) -> Result<(), RunError> {
        use std::io::Write;
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(RunError::io(folder))?;
        }
        let written = |path: &Path, text: &str| {
            let opened = std::fs::File::create_new(path);
            opened.and_then(|mut file| file.write_all(text.as_bytes())).map_err(RunError::io(path))
        };
        written(path, &self.plan_text)?;
        written(&path.with_extension("md"), &self.texts)
    }

    /// Writes the lesson to a run folder, so that goals of the run can be checked on any machine.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn write_to_run(&self, folder: &Path) -> Result<(), RunError> {
        write_atomically(&folder.join(PLAN_FILE), self.plan_text.as_bytes())?;
        write_atomically(&folder.join(TEXTS_FILE), self.texts.as_bytes())
    }

    /// Returns a copy of the lesson in which the figure's part has the scenario and parameters of the figure.
    pub fn with_figure_parameters(self: &Arc<Lesson>, figure: &MeasuredFigure) -> Arc<Lesson> {
        if figure.scenario.is_none() && figure.parameters.is_empty() {
            return self.clone();
        }
        let mut other = Lesson::clone(self);
        if let Some(part) = other.plan.parts.get_mut(figure.part) {
            if let Some(scenario) = &figure.scenario {
                part.scenario.clone_from(scenario);
            }
            part.parameters.extend(figure.parameters.clone());
        }
        Arc::new(other)
    }

    /// Returns whether a goal, guess or pitfall is measured by an SQL statement.
    pub fn needs_database(&self) -> bool {
        let steps = self.plan.parts.iter().flat_map(|part| &part.steps);
        let goals = steps.clone().flat_map(|step| step.goals.iter().map(|goal| &goal.measurement));
        let guesses = steps.filter_map(|step| match &step.guess.as_ref()?.form {
            GuessForm::Number { outcome, .. } => Some(outcome),
            GuessForm::Choice { .. } => None,
        });
        let pitfalls = self.plan.pitfalls.iter().map(|pitfall| &pitfall.measurement);
        goals.chain(guesses).chain(pitfalls).any(|measurement| measurement.needs_database())
    }

    /// Replaces the placeholders of measured figures in a text with formatted values.
    pub fn fill_figures(&self, text: &str) -> String {
        let written = |text: String, measured_figure: &MeasuredFigure| {
            text.replace(&format!("{{{}}}", measured_figure.name), &measured_figure.formatted_value())
        };
        self.plan.measured.iter().fold(text.to_owned(), written)
    }
}

impl MeasuredFigure {
    /// Returns the stated value as formatted text.
    pub fn formatted_value(&self) -> String {
        self.format_value(self.value)
    }

    /// Formats a value in the unit of this figure.
    pub fn format_value(&self, value: f64) -> String {
        match &self.measurement.source {
            NumberSource::Cash => short_dollars(value),
            NumberSource::Figure(figure) => match figure.unit() {
                FigureUnit::Dollars => short_dollars(value),
                FigureUnit::Share | FigureUnit::PreciseShare => percent(value, 0),
                FigureUnit::Count | FigureUnit::Level => grouped_number(value, 0),
            },
            NumberSource::Sql(_) if self.unit == "$" && value.abs() < 1000.0 => dollars_and_cents(value),
            NumberSource::Sql(_) if self.unit == "$" => short_dollars(value),
            NumberSource::Sql(_) if self.unit == "%" => percent(value, 0),
            NumberSource::Sql(_) if self.unit == "day" => grouped_number(value, 0),
            NumberSource::Sql(_) => grouped_number(value, if value.fract() == 0.0 { 0 } else { 2 }),
        }
    }
}

fn extract_section(texts: &str, heading: &str) -> String {
    let mut lines =
        texts.lines().skip_while(|line| line.trim() != format!("## {heading}")).skip(1).peekable();
    let mut section = Vec::new();
    while let Some(line) = lines.next_if(|line| !line.starts_with("## ")) {
        section.push(line);
    }
    section.join("\n").trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extract_section_finds_headings() {
        let texts = "# A\n\n## Debrief\n\nOne.\n\nTwo.\n\n## For the teacher\nThree.\n";
        assert_eq!(extract_section(texts, "Debrief"), "One.\n\nTwo.");
        assert_eq!(extract_section(texts, "For the teacher"), "Three.");
        assert_eq!(extract_section(texts, "Nothing"), "");
    }
}
