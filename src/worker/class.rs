//! Classes on the session thread: reading a collected class, and opening the handout of a student.

use std::path::{Path, PathBuf};

use super::SessionThread;
use crate::message::Response;
use novamind_course::{CollectedClass, Handout};
use novamind_record::error::RunError;
use novamind_record::folder::runs::{common_runs_folder, participant_folder};
use novamind_report::class::{ClassDisplayOptions, ClassView};
use novamind_session::{Access, Session};

impl SessionThread {
    /// Reads a collected class for display. Reports an error if the requested display needs data that the class does
    /// not have.
    pub(super) fn read_class(&self, folder: &Path, display_options: ClassDisplayOptions) {
        let read = CollectedClass::read(&expand_home(folder)).map_err(|error| error.to_string());
        let checked = read.and_then(|class| {
            ClassView::new(&class, display_options.clone()).check()?;
            Ok((class, display_options))
        });
        self.send_response(Response::ClassRead(Box::new(checked)));
    }

    /// Starts or resumes the lesson of a handout. The student's runs folder becomes the current runs folder.
    pub(super) fn open_handout(&mut self, path: &Path) {
        let placed = Handout::read(&expand_home(path)).and_then(|handout| {
            let (base, whose) = common_runs_folder(&self.initial_runs_folder);
            if let Some(whose) = whose.filter(|whose| *whose != handout.label) {
                return Err(RunError::InvalidRequest(format!(
                    "this is the handout of {}, but this folder has the runs of {whose}. Nothing was started",
                    handout.label
                )));
            }
            let run = handout.ensure_run(base)?;
            let runs = participant_folder(base, &handout.label).map_err(RunError::InvalidRequest)?;
            Ok((run, runs, handout.label))
        });
        let (run, runs, label) = match placed {
            Ok(placed) => placed,
            Err(problem) => return self.send_response(Response::NotOpened(problem.to_string(), None)),
        };
        self.runs_folder = runs;
        self.send_response(Response::HandoutOpened(label));
        let opened = Session::open(&self.runs_folder.join(&run), Access::Write, true);
        self.show_opened_run(opened, &run, None);
    }
}

fn expand_home(path: &Path) -> PathBuf {
    match (path.strip_prefix("~"), std::env::home_dir()) {
        (Ok(rest), Some(home)) => home.join(rest),
        _ => path.to_owned(),
    }
}
