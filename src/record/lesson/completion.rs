//! Checks whether a lesson is over. Hidden state is not shown before the lesson is over, because the next part can have
//! the same random draws.

use std::path::Path;

use super::lesson_file::Lesson;
use crate::folder::manifest::Manifest;
use crate::folder::manifest_check::ManifestCheck;
use crate::folder::runs::read_last_lines;
use crate::stamp::LessonStamp;
use crate::trajectory::Record;

/// Returns whether the last part of a run's lesson is over. The last part may be this run or another run of the
/// participant in the same folder. Returns true for runs without a lesson, and false if the lesson in the run folder
/// has another digest.
pub fn is_lesson_over(folder: Option<&Path>, manifest: &Manifest) -> bool {
    let Some(stamp) = &manifest.lesson else { return true };
    let Some(folder) = folder else { return false };
    let lesson = Lesson::from_run(folder, &stamp.name).ok().filter(|lesson| lesson.digest == stamp.digest);
    let Some(lesson) = lesson else { return false };
    let last = LessonStamp { part: lesson.plan.parts.len() as u32, ..stamp.clone() };
    let is_last =
        |other: &Manifest| other.lesson.as_ref() == Some(&last) && other.participant == manifest.participant;
    if is_last(manifest) && run_has_ended(folder) {
        return true;
    }
    let dir = folder.parent().and_then(|runs| std::fs::read_dir(runs).ok());
    let mut others = dir.into_iter().flatten().flatten().map(|entry| entry.path());
    others.any(|path| {
        ManifestCheck::read(&path).is_ok_and(|derived| is_last(&derived.manifest)) && run_has_ended(&path)
    })
}

/// Returns whether the last lines of a run contain an `end` event.
fn run_has_ended(folder: &Path) -> bool {
    let lines = read_last_lines(&folder.join("trajectory.jsonl")).unwrap_or_default();
    lines.iter().any(|line| matches!(line.record, Record::End(_)))
}
