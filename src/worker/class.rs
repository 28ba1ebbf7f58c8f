//! Classes on the session thread: reading a collected class, and opening the handout of a student.

use std::path::{Path, PathBuf};

use super::SessionThread;
use crate::message::News;
use novamind_course::{CollectedClass, Handout};
use novamind_record::error::RunError;
use novamind_record::folder::runs::{base_of_runs, participant_folder};
use novamind_report::class::{ClassView, Shown};
use novamind_session::{Access, Session};

impl SessionThread {
    /// Reads a class. Reports an error if it lacks data for the requested display.
    pub(super) fn read_class(&self, folder: &Path, shown: Shown) {
        let read = CollectedClass::read(&from_home(folder)).map_err(|error| error.to_string());
        let checked = read.and_then(|class| {
            ClassView::of(&class, shown.clone()).check()?;
            Ok((class, shown))
        });
        self.say(News::Class(Box::new(checked)));
    }

    /// Starts or resumes the lesson of a handout. The runs folder becomes that of its student.
    pub(super) fn open_handout(&mut self, path: &Path) {
        let placed = Handout::read(&from_home(path)).and_then(|handout| {
            let (base, whose) = base_of_runs(&self.first_runs);
            if let Some(whose) = whose.filter(|whose| *whose != handout.label) {
                return Err(RunError::NotPossible(format!(
                    "this is the handout of {}, but this folder has the runs of {whose}. Nothing was started",
                    handout.label
                )));
            }
            let run = handout.place(base)?;
            let runs = participant_folder(base, &handout.label).map_err(RunError::NotPossible)?;
            Ok((run, runs, handout.label))
        });
        let (run, runs, label) = match placed {
            Ok(placed) => placed,
            Err(problem) => return self.say(News::NotOpened(problem.to_string(), None)),
        };
        self.runs = runs;
        self.say(News::HandedOut(label));
        let opened = Session::open(&self.runs.join(&run), Access::Write, true);
        self.take(opened, &run, None);
    }
}

fn from_home(path: &Path) -> PathBuf {
    match (path.strip_prefix("~"), std::env::home_dir()) {
        (Ok(rest), Some(home)) => home.join(rest),
        _ => path.to_owned(),
    }
}
