//! `class.toml`: the lesson or run of a class, and its students (docs/formats/class.md#classtoml).

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::handout::{HANDOUT_EXTENSION, HANDOUT_FORMAT, Handout, HandoutContent};
use super::handout_run::HandoutRun;
use novamind_record::clock::now;
use novamind_record::error::RunError;
use novamind_record::files::{create_folder, write_atomically};
use novamind_record::lesson::Lesson;
use novamind_record::stamp::HandoutStamp;
use novamind_session::new_run_id;

const CLASS_FILE: &str = "class.toml";

const MAX_STUDENTS: u32 = 999;

/// A class: the lesson or run that was handed out, and its students.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Class {
    /// Format version of the file `class.toml`.
    pub format: u32,
    /// Version of the program that created the class.
    pub program: String,
    /// Name of the class: eight hexadecimal digits.
    pub class: String,
    /// Time at which the class was created, in RFC 3339 format.
    pub created: String,
    /// The lesson of the class; `None` if a run was handed out.
    pub lesson: Option<ClassLesson>,
    /// The run that was handed out; `None` if a lesson was handed out.
    pub run: Option<ClassSourceRun>,
    /// Students to whom handouts were written.
    #[serde(rename = "student")]
    pub students: Vec<ClassStudent>,
}

/// Name and digest of the lesson of a class.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassLesson {
    /// Name of the lesson.
    pub name: String,
    /// Digest of the lesson's plan and texts.
    pub digest: String,
}

/// The instructor's run that every student continues.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassSourceRun {
    /// Run ID of the instructor's run.
    pub run: String,
    /// Day up to which the students' runs repeat the instructor's run.
    pub day: u32,
}

/// A student of a class, with the student's handout.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassStudent {
    /// Label of the student, such as `S01`.
    pub label: String,
    /// Name of the run that the handout creates.
    pub run: String,
    /// Seal of the original handout, which shows whether the handout file was changed.
    pub seal: String,
}

/// What the instructor hands out to a new class.
#[derive(Debug, Clone, PartialEq)]
pub enum HandoutSource {
    /// A lesson that every student starts from the beginning.
    Lesson(Arc<Lesson>),
    /// The run in this folder, up to the end of its last week.
    Run(PathBuf),
}

impl Class {
    /// Creates the folder of a class with `class.toml` and a handout for every student.
    ///
    /// # Errors
    /// Returns an error if the folder already contains a class or cannot be written, if `students` is not from 1 to
    /// 999, or if the run cannot be handed out.
    pub fn create(folder: &Path, what: &HandoutSource, students: u32) -> Result<Class, RunError> {
        if !(1..=MAX_STUDENTS).contains(&students) {
            let message = format!("a class needs 1 to {MAX_STUDENTS} students, not {students}");
            return Err(RunError::InvalidRequest(message));
        }
        if folder.join(CLASS_FILE).exists() {
            let message = format!(
                "{} already contains a class; choose another folder. Nothing was changed",
                folder.display()
            );
            return Err(RunError::AlreadyExists(message));
        }
        let past = match what {
            HandoutSource::Lesson(_) => None,
            HandoutSource::Run(run) => Some(HandoutRun::from_folder(run)?),
        };
        create_folder(folder)?;
        let mut class = Class {
            format: HANDOUT_FORMAT,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            class: new_run_id(),
            created: now(),
            lesson: None,
            run: past.as_ref().map(|past| ClassSourceRun { run: past.run_id().to_owned(), day: past.day }),
            students: Vec::new(),
        };
        if let HandoutSource::Lesson(lesson) = what {
            class.lesson = Some(ClassLesson { name: lesson.name.clone(), digest: lesson.digest.clone() });
            lesson.write_to_run(folder)?;
        }
        let width = students.to_string().len().max(2);
        for number in 1..=students {
            let label = format!("S{number:0width$}");
            let stamp = HandoutStamp { class: class.class.clone(), run: new_run_id() };
            let content = match (what, &past) {
                (_, Some(past)) => {
                    HandoutContent::Run(past.branch_files_for_student(&label, &stamp, folder)?)
                }
                (HandoutSource::Lesson(lesson), None) => HandoutContent::Lesson(lesson.clone()),
                (HandoutSource::Run(_), None) => continue,
            };
            let run = stamp.run.clone();
            let seal = Handout { label: label.clone(), stamp, content }.write(folder)?;
            class.students.push(ClassStudent { label, run, seal });
        }
        let text = toml::to_string(&class).expect("a class contains plain values");
        write_atomically(&folder.join(CLASS_FILE), text.as_bytes())?;
        Ok(class)
    }

    /// Reads `class.toml` from the folder of a class.
    ///
    /// # Errors
    /// Returns an error if the folder contains no class, or if `class.toml` is damaged or has a later format.
    pub fn read(folder: &Path) -> Result<Class, RunError> {
        let path = folder.join(CLASS_FILE);
        let text = match std::fs::read_to_string(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Err(RunError::InvalidRequest(format!(
                    "{} contains no class. Create one: `novamind class new LESSON --out {}`",
                    folder.display(),
                    folder.display()
                )));
            }
            read => read.map_err(RunError::io(&path))?,
        };
        let class: Class = toml::from_str(&text).map_err(|error| RunError::Damaged {
            line: error.span().map_or(1, |span| text[..span.start].matches('\n').count() + 1),
            problem: error.message().to_owned(),
            remedy: "Handouts and runs were not changed; restore class.toml from a copy".to_owned(),
            path,
        })?;
        Ok(class)
    }

    /// Reads the copy of the lesson that is stored in the folder of the class. Returns `None` if a run was handed out.
    ///
    /// # Errors
    /// Returns an error if the files of the lesson are missing or invalid, or if they differ from the lesson that was
    /// handed out.
    pub fn stored_lesson(&self, folder: &Path) -> Result<Option<Arc<Lesson>>, RunError> {
        let Some(class_lesson) = &self.lesson else { return Ok(None) };
        let lesson = Lesson::from_run(folder, &class_lesson.name)?;
        if lesson.digest == class_lesson.digest {
            return Ok(Some(Arc::new(lesson)));
        }
        Err(RunError::Damaged {
            path: folder.join("lesson.toml"),
            line: 1,
            problem: format!("the lesson differs from the one that was handed out, {}", class_lesson.name),
            remedy: "Nothing was changed; restore lesson.toml and lesson.md from a copy".to_owned(),
        })
    }

    /// Returns the student with this label.
    pub fn student_by_label(&self, label: &str) -> Option<&ClassStudent> {
        self.students.iter().find(|student| student.label == label)
    }

    /// Returns the labels of students whose handout file no longer has the original content. Ignores missing handouts.
    pub(super) fn altered_handouts(&self, folder: &Path) -> Vec<String> {
        let is_altered = |student: &&ClassStudent| {
            let path = folder.join(format!("{}{HANDOUT_EXTENSION}", student.label));
            path.exists() && Handout::read_seal(&path).as_ref() != Some(&student.seal)
        };
        self.students.iter().filter(is_altered).map(|student| student.label.clone()).collect()
    }
}
