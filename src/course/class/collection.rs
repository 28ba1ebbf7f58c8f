//! Collects the submissions of a class: finds its runs in folders and archives, re-simulates them, and assigns them to
//! students.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::class_file::{Class, ClassStudent};
use super::evidence::{ClassRun, Evidence, RunVerdict, examine_record};
use super::finding::ClassFinding;
use super::handout::{HANDOUT_EXTENSION, Handout, HandoutContent};
use super::reference::{ClassReference, play_references};
use novamind_record::error::RunError;
use novamind_record::files::write_atomically;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest_check::ManifestCheck;
use novamind_record::lesson::Lesson;
use novamind_session::{RuleEvaluator, TemporaryFolder};
use novamind_study::{CollectNote, FoundRun, collect_runs};

const COLLECTED_FILE: &str = "collected.json";

/// The submissions of a class, as collected from folders and archives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClassCollection {
    /// Submitted runs, sorted by label and start time.
    pub runs: Vec<ClassRun>,
    /// Results of the reference play on the seeds of the submitted runs.
    pub references: Vec<ClassReference>,
    /// Problems for the instructor to resolve, such as altered or missing runs.
    pub findings: Vec<ClassFinding>,
    /// Number of records that do not count, because they are duplicates or earlier states of a collected run.
    pub superseded: u32,
    /// Number of runs in the searched folders that belong to no student of the class.
    pub others: u32,
}

/// The class to collect, and the places to search.
pub struct CollectionInput<'a> {
    /// Class whose handouts identify the submissions.
    pub class: &'a Class,
    /// Folder with `class.toml` and the handouts.
    pub folder: &'a Path,
    /// Folders that are searched recursively for runs and archives.
    pub places: &'a [PathBuf],
}

impl ClassCollection {
    /// Collects the submissions of a class and stores the collection in the folder of the class. `progress` is called
    /// with the number of processed runs and the total number of runs.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be read or written, or if the reference play of the lesson cannot be
    /// simulated.
    pub fn collect(
        sources: &CollectionInput<'_>,
        answers: RuleEvaluator,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Result<ClassCollection, RunError> {
        let lesson = sources.class.stored_lesson(sources.folder)?;
        let temporary_folder = TemporaryFolder::create_in(sources.folder)?;
        let mut gathered =
            collect_runs(sources.places, temporary_folder.path(), temporary_folder.path(), None);
        for found in gathered.runs.iter_mut().chain(gathered.conflicts.values_mut().flatten()) {
            // The first event takes precedence over `run.toml`, which could have been edited.
            if let Ok(derived) = ManifestCheck::read(&found.folder) {
                found.manifest = derived.manifest;
            }
        }
        let mut returned = CollectionBuilder {
            sources,
            lesson: lesson.as_ref(),
            runs: Vec::new(),
            findings: Vec::new(),
            others: 0,
        };
        let mut superseded = 0;
        for note in gathered.notes {
            match note {
                CollectNote::Unreadable { path, problem } => {
                    let label = returned.find_label_in_path(&path);
                    returned.findings.push(ClassFinding::Unreadable { label, path, problem });
                }
                CollectNote::Superseded { .. } => superseded += 1,
                _ => {}
            }
        }
        let all = gathered.runs.len() + gathered.conflicts.len();
        for (done, found) in gathered.runs.iter().enumerate() {
            progress(done, all);
            returned.add_run(found);
        }
        for (done, records) in gathered.conflicts.values().enumerate() {
            progress(gathered.runs.len() + done, all);
            returned.add_conflicting_records(records);
        }
        returned.add_missing_findings();
        let CollectionBuilder { mut runs, mut findings, others, .. } = returned;
        runs.sort_by(|one, other| {
            (&one.label, &one.created, &one.run).cmp(&(&other.label, &other.created, &other.run))
        });
        findings.sort_by(|one, other| one.label().cmp(&other.label()));
        let references = match &lesson {
            Some(lesson) => play_references(lesson, &runs, answers)?,
            None => Vec::new(),
        };
        let collection = ClassCollection { runs, references, findings, superseded, others };
        let text = serde_json::to_string(&collection).expect("a collection contains plain values");
        write_atomically(&sources.folder.join(COLLECTED_FILE), text.as_bytes())?;
        Ok(collection)
    }

    /// Reads the newest collection from the folder of a class.
    ///
    /// # Errors
    /// Returns an error if no submissions have been collected, or if the file of the collection is damaged.
    pub fn read(folder: &Path) -> Result<ClassCollection, RunError> {
        let path = folder.join(COLLECTED_FILE);
        let collect = format!("`novamind class collect {} PLACES`", folder.display());
        let text = match std::fs::read_to_string(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Err(RunError::InvalidRequest(format!(
                    "nothing was collected in {} yet. Collect first: {collect}",
                    folder.display()
                )));
            }
            read => read.map_err(RunError::io(&path))?,
        };
        serde_json::from_str(&text).map_err(|error| RunError::Damaged {
            line: error.line(),
            problem: error.to_string(),
            remedy: format!("Handouts and runs were not changed; collect again: {collect}"),
            path,
        })
    }
}

struct CollectionBuilder<'a> {
    sources: &'a CollectionInput<'a>,
    lesson: Option<&'a Arc<Lesson>>,
    runs: Vec<ClassRun>,
    findings: Vec<ClassFinding>,
    others: u32,
}

impl CollectionBuilder<'_> {
    /// Returns the student label that a folder of the path has as its name, or that begins the file name.
    fn find_label_in_path(&self, path: &Path) -> Option<String> {
        let begins = |part: &str, label: &str| {
            part.strip_prefix(label)
                .is_some_and(|rest| !rest.starts_with(|letter: char| letter.is_alphanumeric()))
        };
        let parts: Vec<_> = path.iter().rev().map(|part| part.to_string_lossy()).collect();
        let students = || self.sources.class.students.iter().map(|student| &student.label);
        parts.iter().find_map(|part| students().find(|label| begins(part, label))).cloned()
    }

    fn run_label(&self, found: &FoundRun) -> Option<String> {
        found.manifest.participant.clone().or_else(|| self.find_label_in_path(&found.source))
    }

    /// Returns whether a run started from a handout of the class, or from the class's lesson without a handout.
    fn belongs_to_class(&self, manifest: &Manifest) -> bool {
        let class = self.sources.class;
        let has_class_handout = manifest.handout.as_ref().is_some_and(|stamp| stamp.class == class.class);
        let lesson_pair = class.lesson.as_ref().zip(manifest.lesson.as_ref());
        has_class_handout
            || (manifest.handout.is_none()
                && lesson_pair.is_some_and(|(class_lesson, other)| class_lesson.name == other.name))
    }

    fn add_run(&mut self, found: &FoundRun) {
        if !self.belongs_to_class(&found.manifest) {
            self.others += 1;
            return;
        }
        let run = self.examine_run(found);
        self.runs.push(run);
    }

    /// Adds records of one run that contradict each other. If several records are valid, none of them counts,
    /// and all of them are reported.
    fn add_conflicting_records(&mut self, records: &[FoundRun]) {
        let found_runs: Vec<&FoundRun> =
            records.iter().filter(|found| self.belongs_to_class(&found.manifest)).collect();
        let Some(first) = found_runs.first() else {
            self.others += records.len() as u32;
            return;
        };
        let (label, run) = (self.run_label(first).unwrap_or_default(), first.manifest.id.clone());
        let judged: Vec<ClassRun> = found_runs.iter().map(|found| self.examine_run(found)).collect();
        let (good, wrong): (Vec<ClassRun>, Vec<ClassRun>) =
            judged.into_iter().partition(|run| run.is_valid());
        if good.len() > 1 {
            let paths = good.iter().map(|run| run.source.clone()).collect();
            self.findings.push(ClassFinding::Conflicting { label, run, paths });
            self.runs
                .extend(good.into_iter().map(|run| ClassRun { verdict: RunVerdict::Conflicting, ..run }));
        } else {
            self.runs.extend(good);
        }
        self.runs.extend(wrong);
    }

    /// Examines a record and decides whether it counts for the class.
    fn examine_run(&mut self, found: &FoundRun) -> ClassRun {
        let label = self.run_label(found).unwrap_or_default();
        let examined = examine_record(&found.folder, self.lesson);
        let manifest = &found.manifest;
        let id = manifest.id.clone();
        let (verdict, finding) = match (&examined, self.find_mismatch(found, &label)) {
            (Err(error), _) => {
                let problem = describe_problem(error, found);
                (
                    RunVerdict::Altered,
                    Some(ClassFinding::Altered { label: label.clone(), run: id.clone(), problem }),
                )
            }
            (Ok(_), Some((verdict, finding))) => (verdict, Some(finding)),
            (Ok(evidence), None) if evidence.is_over => (RunVerdict::Finished, None),
            (Ok(_), None) => (RunVerdict::NotFinished, None),
        };
        self.findings.extend(finding);
        let part = manifest.lesson.as_ref().map_or(1, |stamp| stamp.part);
        let nothing = |_| Evidence { part, seed: manifest.seed, ..Evidence::default() };
        ClassRun {
            label,
            run: id,
            created: manifest.created.clone(),
            source: found.source.clone(),
            verdict,
            evidence: examined.unwrap_or_else(nothing),
        }
    }

    /// Returns the reason why a valid record does not count, or `None` if the record matches the student's handout.
    fn find_mismatch(&self, found: &FoundRun, label: &str) -> Option<(RunVerdict, ClassFinding)> {
        let (class, manifest) = (self.sources.class, &found.manifest);
        let (label, run) = (label.to_owned(), manifest.id.clone());
        let other_lesson = class.lesson.as_ref().map(|class_lesson| &class_lesson.digest)
            != manifest.lesson.as_ref().map(|lesson_stamp| &lesson_stamp.digest);
        let stamp = manifest.handout.as_ref().filter(|stamp| stamp.class == class.class);
        let owner = stamp.and_then(|stamp| class.students.iter().find(|student| student.run == stamp.run));
        let Some(owner) = owner else {
            let label = Some(label).filter(|label| !label.is_empty());
            return Some((
                RunVerdict::Unknown,
                ClassFinding::Unknown { label, run, path: found.source.clone() },
            ));
        };
        if owner.label != label {
            let of = Some(owner.label.clone());
            return Some((RunVerdict::OtherHandout, ClassFinding::OtherHandout { label, run, of }));
        }
        if other_lesson {
            return Some((RunVerdict::OtherLesson, ClassFinding::OtherLesson { label, run }));
        }
        if class.run.is_some() && !self.starts_with_handout(owner, found) {
            return Some((RunVerdict::OtherHandout, ClassFinding::OtherHandout { label, run, of: None }));
        }
        None
    }

    /// Returns whether a run begins with the past that is recorded in the student's handout. Returns `true` if the
    /// handout is no longer in the folder.
    fn starts_with_handout(&self, student: &ClassStudent, found: &FoundRun) -> bool {
        let path = self.sources.folder.join(format!("{}{HANDOUT_EXTENSION}", student.label));
        let Ok(Handout { content: HandoutContent::Run(past), .. }) = Handout::read(&path) else {
            return true;
        };
        let bytes = std::fs::read(found.folder.join("trajectory.jsonl")).unwrap_or_default();
        found.manifest.id == student.run && bytes.starts_with(past.trajectory.as_bytes())
    }

    fn add_missing_findings(&mut self) {
        let class = self.sources.class;
        let parts: u32 = self.lesson.map_or(1, |lesson| lesson.plan.parts.len() as u32);
        let texts: BTreeSet<String> = self
            .findings
            .iter()
            .filter_map(|class_finding| class_finding.label().map(str::to_owned))
            .collect();
        for student in &class.students {
            let label = student.label.clone();
            let student_runs = || self.runs.iter().filter(|run| run.label == label);
            let is_finished = |part: &u32| {
                student_runs().any(|run| run.evidence.part == *part && run.verdict == RunVerdict::Finished)
            };
            let open: Vec<u32> = (1..=parts).filter(|part| !is_finished(part)).collect();
            let is_whole = student_runs()
                .any(|run| matches!(run.verdict, RunVerdict::Finished | RunVerdict::NotFinished));
            if student_runs().next().is_none() && !texts.contains(&label) {
                self.findings.push(ClassFinding::Missing { label });
            } else if is_whole && !open.is_empty() {
                self.findings.push(ClassFinding::NotFinished { label, parts: open });
            }
        }
        let altered = class.altered_handouts(self.sources.folder).into_iter();
        self.findings.extend(altered.map(|label| ClassFinding::AlteredHandout { label }));
    }
}

impl ClassRun {
    fn is_valid(&self) -> bool {
        matches!(self.verdict, RunVerdict::Finished | RunVerdict::NotFinished)
    }
}

/// Describes an error with the path where the record was found instead of the path of its temporary copy.
fn describe_problem(error: &RunError, found: &FoundRun) -> String {
    match error {
        RunError::Damaged { line, problem, .. } => {
            format!("{}: line {line}: {problem}", found.source.display())
        }
        other => other.to_string(),
    }
}
