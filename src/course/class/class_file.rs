//! `class.toml`: what was handed out, and to whom (docs/formats/class.md#classtoml).

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::handed_run::HandedPast;
use super::handout::{ENDING, HANDOUT_FORMAT, HandedOut, Handout};
use novamind_record::clock::now;
use novamind_record::error::RunError;
use novamind_record::files::{create_folder, write_whole};
use novamind_record::lesson::Lesson;
use novamind_record::stamp::HandoutStamp;
use novamind_session::new_id;

/// Name of the file in the folder of the class.
const CLASS_FILE: &str = "class.toml";

/// Most students of a class.
const MOST_STUDENTS: u32 = 999;

/// A class: what was handed out, and to whom.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Class {
    /// Format of the file.
    pub format: u32,
    /// Version of the program that made it.
    pub program: String,
    /// Name of the class: eight hexadecimal digits.
    pub class: String,
    /// When it was made, RFC 3339.
    pub created: String,
    /// The lesson, if that was handed out.
    pub lesson: Option<ClassLesson>,
    /// The run, if that was handed out.
    pub run: Option<ClassPast>,
    /// The students.
    #[serde(rename = "student")]
    pub students: Vec<ClassStudent>,
}

/// The lesson of a class.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassLesson {
    /// Name of the lesson.
    pub name: String,
    /// Digest of its plan and texts.
    pub digest: String,
}

/// The run whose past every student begins with.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassPast {
    /// Name of the run.
    pub run: String,
    /// Its last day.
    pub day: u32,
}

/// A student.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassStudent {
    /// Label.
    pub label: String,
    /// The run that their hand-out begins.
    pub run: String,
    /// Seal of their hand-out.
    pub seal: String,
}

/// What is to be handed out.
#[derive(Debug, Clone, PartialEq)]
pub enum ToHandOut {
    /// A lesson.
    Lesson(Arc<Lesson>),
    /// The run in a folder, up to the end of its last week.
    Run(PathBuf),
}

impl Class {
    /// Makes a class: its folder, `class.toml` and a hand-out for every student.
    ///
    /// # Errors
    /// The folder holds a class already, or cannot be written; the number of students is not from 1 to
    /// 999; the run cannot be handed out.
    pub fn create(folder: &Path, what: &ToHandOut, students: u32) -> Result<Class, RunError> {
        if !(1..=MOST_STUDENTS).contains(&students) {
            let message = format!("a class has from 1 to {MOST_STUDENTS} students, not {students}");
            return Err(RunError::NotPossible(message));
        }
        if folder.join(CLASS_FILE).exists() {
            let message = format!(
                "{} holds a class already: name another folder. Nothing was changed",
                folder.display()
            );
            return Err(RunError::Exists(message));
        }
        let past = match what {
            ToHandOut::Lesson(_) => None,
            ToHandOut::Run(run) => Some(HandedPast::of(run)?),
        };
        create_folder(folder)?;
        let mut class = Class {
            format: HANDOUT_FORMAT,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            class: new_id(),
            created: now(),
            lesson: None,
            run: past.as_ref().map(|past| ClassPast { run: past.run().to_owned(), day: past.day }),
            students: Vec::new(),
        };
        if let ToHandOut::Lesson(lesson) = what {
            class.lesson = Some(ClassLesson { name: lesson.name.clone(), digest: lesson.digest.clone() });
            lesson.keep_with(folder)?;
        }
        let width = students.to_string().len().max(2);
        for number in 1..=students {
            let label = format!("S{number:0width$}");
            let stamp = HandoutStamp { class: class.class.clone(), run: new_id() };
            let content = match (what, &past) {
                (_, Some(past)) => HandedOut::Run(past.handed_to(&label, &stamp, folder)?),
                (ToHandOut::Lesson(lesson), None) => HandedOut::Lesson(lesson.clone()),
                (ToHandOut::Run(_), None) => continue,
            };
            let run = stamp.run.clone();
            let seal = Handout { label: label.clone(), stamp, content }.write(folder)?;
            class.students.push(ClassStudent { label, run, seal });
        }
        let text = toml::to_string(&class).expect("a class holds plain values");
        write_whole(&folder.join(CLASS_FILE), text.as_bytes())?;
        Ok(class)
    }

    /// Reads the class of a folder.
    ///
    /// # Errors
    /// There is none, or its file is damaged or of a later format.
    pub fn read(folder: &Path) -> Result<Class, RunError> {
        let path = folder.join(CLASS_FILE);
        let text = match std::fs::read_to_string(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Err(RunError::NotPossible(format!(
                    "{} holds no class: `novamind class new LESSON --out {}` makes one",
                    folder.display(),
                    folder.display()
                )));
            }
            read => read.map_err(RunError::io(&path))?,
        };
        let class: Class = toml::from_str(&text).map_err(|error| RunError::Damaged {
            line: error.span().map_or(1, |span| text[..span.start].matches('\n').count() + 1),
            problem: error.message().to_owned(),
            safe: "Hand-outs and runs were not touched; restore class.toml from a copy".to_owned(),
            path,
        })?;
        Ok(class)
    }

    /// The lesson that was handed out, as it is kept with the class; none where a run was.
    ///
    /// # Errors
    /// Its files are missing, wrong, or not those that were handed out.
    pub fn lesson_kept(&self, folder: &Path) -> Result<Option<Arc<Lesson>>, RunError> {
        let Some(own) = &self.lesson else { return Ok(None) };
        let lesson = Lesson::of_run(folder, &own.name)?;
        if lesson.digest == own.digest {
            return Ok(Some(Arc::new(lesson)));
        }
        Err(RunError::Damaged {
            path: folder.join("lesson.toml"),
            line: 1,
            problem: format!("the lesson is not the one that was handed out, {}", own.name),
            safe: "Nothing was changed; restore lesson.toml and lesson.md from a copy".to_owned(),
        })
    }

    /// A student by their label.
    pub fn student(&self, label: &str) -> Option<&ClassStudent> {
        self.students.iter().find(|student| student.label == label)
    }

    /// Labels whose hand-outs in the folder are not those that were handed out; those that are gone are not among them.
    pub(super) fn altered_handouts(&self, folder: &Path) -> Vec<String> {
        let is_altered = |student: &&ClassStudent| {
            let path = folder.join(format!("{}{ENDING}", student.label));
            path.exists() && Handout::seal_of(&path).as_ref() != Some(&student.seal)
        };
        self.students.iter().filter(is_altered).map(|student| student.label.clone()).collect()
    }
}
