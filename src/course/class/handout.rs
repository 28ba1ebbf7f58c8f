//! Handouts: files that students use to start a lesson or continue a run (docs/formats/class.md#handout).

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use novamind_record::error::RunError;
use novamind_record::files::{create_folder, write_atomically};
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest_check::ManifestCheck;
use novamind_record::folder::runs::{list_runs, participant_folder};
use novamind_record::lesson::Lesson;
use novamind_record::mode::Mode;
use novamind_record::stamp::{HandoutOptions, HandoutStamp};
use novamind_session::{LessonOptions, NewRun, Session, Storage, is_run_id};
use novamind_world::params::ParameterSource;

pub(super) const HANDOUT_FORMAT: u32 = 1;

pub(super) const HANDOUT_EXTENSION: &str = ".nm";

/// The file that one student uses to start a lesson or continue a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Handout {
    /// Label of the student who receives the handout.
    pub label: String,
    /// The class, and the name of the run that the handout creates.
    pub stamp: HandoutStamp,
    /// The lesson or run that was handed out.
    pub content: HandoutContent,
}

/// The content of a handout.
#[derive(Debug, Clone, PartialEq)]
pub enum HandoutContent {
    /// A lesson, which starts with its first part.
    Lesson(Arc<Lesson>),
    /// A run that the student continues.
    Run(HandoutRunFiles),
}

/// The files of a run that a student continues.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandoutRunFiles {
    /// Content of the file `run.toml`.
    pub manifest: String,
    /// Content of the file `trajectory.jsonl`.
    pub trajectory: String,
}

#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct HandoutFile {
    format: u32,
    program: String,
    class: String,
    label: String,
    run: String,
    /// Hash of the handout file, computed while this field is empty.
    seal: String,
    lesson: Option<HandoutLesson>,
    past: Option<HandoutRunFiles>,
}

#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct HandoutLesson {
    name: String,
    plan: String,
    texts: String,
}

impl HandoutFile {
    fn to_toml(&self) -> String {
        toml::to_string(self).expect("a handout contains plain values")
    }

    fn with_seal(self) -> HandoutFile {
        let bare = HandoutFile { seal: String::new(), ..self.clone() };
        HandoutFile { seal: blake3::hash(bare.to_toml().as_bytes()).to_hex().to_string(), ..self }
    }
}

impl Handout {
    /// Reads a handout from a file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, was altered after it was handed out, or has a later format.
    pub fn read(path: &Path) -> Result<Handout, RunError> {
        let refused = |problem: &str| {
            RunError::InvalidRequest(format!(
                "{}: {problem}. No run was created or changed. Ask for the handout again, or copy it again without opening it \
                 in an editor",
                path.display()
            ))
        };
        let bytes = std::fs::read(path).map_err(RunError::io(path))?;
        let text = String::from_utf8(bytes).map_err(|_| refused("this is not a handout of a class"))?;
        let format = text.parse::<toml::Table>().ok().and_then(|table| table.get("format")?.as_integer());
        if let Some(format) = format.filter(|format| *format > i64::from(HANDOUT_FORMAT)) {
            return Err(refused(&format!(
                "the handout has format {format}, but this program reads format {HANDOUT_FORMAT}. Use a later version of the program"
            )));
        }
        let altered = "this handout was altered or truncated: its seal does not match its content";
        let file: HandoutFile = toml::from_str(&text).map_err(|_| match text.starts_with("format = ") {
            true => refused(altered),
            false => refused("this is not a handout of a class"),
        })?;
        if file.clone().with_seal().to_toml() != text {
            return Err(refused(altered));
        }
        if !is_run_id(&file.run)
            || !is_run_id(&file.class)
            || participant_folder(Path::new(""), &file.label).is_err()
        {
            return Err(refused("the label, the class or the name of the run is invalid"));
        }
        let stamp = HandoutStamp { class: file.class, run: file.run };
        let content = match (file.lesson, file.past) {
            (Some(handout_lesson), None) => {
                let source = ParameterSource { name: path.display().to_string(), text: handout_lesson.plan };
                HandoutContent::Lesson(Arc::new(Lesson::from_texts(
                    &handout_lesson.name,
                    source,
                    handout_lesson.texts,
                )?))
            }
            (None, Some(past)) => HandoutContent::Run(past),
            _ => return Err(refused("a handout must contain either a lesson or a run")),
        };
        Ok(Handout { label: file.label, stamp, content })
    }

    /// Writes the handout to a folder and returns its seal.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be written.
    pub(super) fn write(&self, folder: &Path) -> Result<String, RunError> {
        let (lesson, past) = match &self.content {
            HandoutContent::Lesson(lesson) => {
                let (plan, texts) = lesson.sources();
                let (plan, texts) = (plan.to_owned(), texts.to_owned());
                (Some(HandoutLesson { name: lesson.name.clone(), plan, texts }), None)
            }
            HandoutContent::Run(past) => (None, Some(past.clone())),
        };
        let file = HandoutFile {
            format: HANDOUT_FORMAT,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            class: self.stamp.class.clone(),
            label: self.label.clone(),
            run: self.stamp.run.clone(),
            seal: String::new(),
            lesson,
            past,
        };
        let file = file.with_seal();
        write_atomically(
            &folder.join(format!("{}{HANDOUT_EXTENSION}", self.label)),
            file.to_toml().as_bytes(),
        )?;
        Ok(file.seal)
    }

    /// Returns the seal of a handout file, or `None` if the file is not a valid handout.
    pub(super) fn read_seal(path: &Path) -> Option<String> {
        Handout::read(path).ok()?;
        toml::from_str::<HandoutFile>(&std::fs::read_to_string(path).ok()?).ok().map(|file| file.seal)
    }

    /// Creates the run of this handout in the student's folder below `base`, if the run does not exist. Returns the
    /// name of the run to continue: the newest unfinished run of the handout, otherwise its newest run.
    ///
    /// # Errors
    /// Returns an error if a run of this name exists but did not start from this handout, or if the run
    /// cannot be created.
    pub fn ensure_run(&self, base: &Path) -> Result<String, RunError> {
        let runs = participant_folder(base, &self.label).map_err(RunError::InvalidRequest)?;
        if let Some(run) = self.latest_run(&runs)? {
            return Ok(run);
        }
        let folder = runs.join(&self.stamp.run);
        // If the program ended before it wrote the first event, the folder contains none of these files and can be
        // reused.
        if ["run.toml", "trajectory.jsonl"].iter().any(|file| folder.join(file).exists()) {
            return Err(RunError::AlreadyExists(format!(
                "{} exists but does not belong to this handout. Nothing was changed. Move the folder away and open the handout \
                 again",
                folder.display()
            )));
        }
        match &self.content {
            HandoutContent::Lesson(lesson) => self.start_lesson(lesson, runs)?,
            HandoutContent::Run(past) => self.write_run_files(past, &folder)?,
        }
        Ok(self.stamp.run.clone())
    }

    fn latest_run(&self, runs: &Path) -> Result<Option<String>, RunError> {
        let is_own = |id: &str| {
            ManifestCheck::read(&runs.join(id))
                .is_ok_and(|manifest_check| manifest_check.manifest.handout.as_ref() == Some(&self.stamp))
        };
        let run_summaries: Vec<_> = list_runs(runs)?.into_iter().filter(|run| is_own(&run.id)).collect();
        let open = run_summaries.iter().find(|run| run.ended.is_none() && run.problem.is_none());
        Ok(open.or(run_summaries.first()).map(|run| run.id.clone()))
    }

    fn start_lesson(&self, lesson: &Arc<Lesson>, runs: PathBuf) -> Result<(), RunError> {
        let new = NewRun {
            mode: Mode::Lesson,
            participant: Some(self.label.clone()),
            lesson: Some(LessonOptions { lesson: lesson.clone(), part: 0, is_judged: true }),
            handout: Some(HandoutOptions::for_first_run(self.stamp.clone())),
            storage: Storage::Runs(runs),
            ..NewRun::default()
        };
        Session::create(new, &Configuration::bundled()).map(|_| ())
    }

    fn write_run_files(&self, past: &HandoutRunFiles, folder: &Path) -> Result<(), RunError> {
        create_folder(folder)?;
        let written = write_atomically(&folder.join("run.toml"), past.manifest.as_bytes())
            .and_then(|()| write_atomically(&folder.join("trajectory.jsonl"), past.trajectory.as_bytes()))
            .and_then(|()| Manifest::read(folder))
            .and_then(|manifest| match manifest.handout.as_ref() == Some(&self.stamp) {
                true => Ok(()),
                false => Err(RunError::InvalidRequest(
                    "the manifest in the handout has the stamp of a different handout".to_owned(),
                )),
            });
        if written.is_err() {
            let _ = std::fs::remove_dir_all(folder);
        }
        written
    }
}
