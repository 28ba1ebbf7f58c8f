//! Helpers for lessons that a test defines.

use std::path::Path;
use std::sync::Arc;

use novamind::course::Lesson;
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Via;
use novamind::session::{LessonOptions, NewRun, Session, Storage};
use novamind::tools::Rejection;

/// Writes a plan to a file with the name of the lesson, and reads the lesson from the file.
pub fn write_lesson(folder: &Path, name: &str, plan: &str) -> Result<Lesson, String> {
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, plan).expect("a file");
    std::fs::write(folder.join(format!("{name}.md")), "## Debrief\n\nSo it goes.\n").expect("a file");
    Lesson::from_file(&path).map_err(|error| error.to_string())
}

/// Writes a lesson and starts its first part.
pub fn begin_lesson(folder: &Path, name: &str, plan: &str) -> Session {
    let lesson = Arc::new(write_lesson(folder, name, plan).expect("a lesson"));
    let new = NewRun {
        mode: Mode::Lesson,
        lesson: Some(LessonOptions { lesson, part: 0, is_judged: true }),
        storage: Storage::Runs(folder.join("runs")),
        ..NewRun::default()
    };
    Session::create(new, &Configuration::bundled()).expect("the lesson begins")
}

/// Runs a week without a rationale, with naive forecasts.
pub fn advance_lesson_week(session: &mut Session) -> Result<(), Rejection> {
    let forecasts = session.company().naive_forecasts();
    session.advance("", &forecasts, Via::Plain, &mut |_| {}).map(|_| ())
}

/// Returns the code of a rejection.
pub fn rejection_code(result: Result<impl Sized, Rejection>) -> &'static str {
    result.err().map_or("accepted", |refusal| refusal.code)
}
