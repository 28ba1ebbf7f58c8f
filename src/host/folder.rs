//! The host folder of a study: all files of its hosted sessions.

use std::fs::{DirBuilder, Permissions};
use std::os::unix::fs::{DirBuilderExt, PermissionsExt};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use novamind_record::error::RunError;
use novamind_record::files::{read_if_exists, write_private_atomically};
use novamind_record::folder::configuration::CONSENT_FILE;
use novamind_study::{
    ASSIGNMENT_FILE, Assignment, AssignmentRow, CodeDigest, SEAL_KEY_FILE, STUDY_FILE, Study,
};

use crate::access::Access;
use crate::audit::AuditLog;

/// Name of the host folder in the folder of a study.
pub const HOST_FOLDER: &str = "host";
/// Name of the file that describes the host folder.
const HOST_FILE: &str = "host.toml";
/// Subfolder with one folder per session.
const SESSIONS_FOLDER: &str = "sessions";
/// Name of the folder of questionnaires in the folder of a study.
const QUESTIONS_FOLDER: &str = "questions";

/// The host folder of a study, which only the user of the host can read.
#[derive(Debug, Clone)]
pub struct HostFolder {
    path: PathBuf,
    study: Study,
    rows: Vec<AssignmentRow>,
    description: HostDescription,
    /// Function that reports failures of the audit log to the experimenter.
    report: fn(&str),
}

/// The version of a program that plays sessions.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProgramVersion {
    /// Version of the program.
    pub version: String,
    /// Number of the mechanics.
    pub mechanics: u32,
}

/// Contents of `host.toml`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct HostDescription {
    #[serde(flatten)]
    program: ProgramVersion,
    /// Digest of the study.
    study: String,
    /// Address of the host in links, for example `https://play.example.org`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    url: Option<String>,
    /// Salted digest of the code for the experimenter's page.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    admin_code: Option<CodeDigest>,
}

impl HostFolder {
    /// Creates the host folder of a study, or opens the existing folder and adds the sessions of new participants.
    ///
    /// # Errors
    /// The study has no assignment, a file cannot be read or written, or sessions were started by another version of the
    /// program or with another protocol.
    pub fn open_or_create(study: &Path, program: &ProgramVersion) -> Result<HostFolder, RunError> {
        // Processes of sessions have another working folder, so their paths must be absolute.
        let path = std::fs::canonicalize(study).map_err(RunError::io(study))?;
        let study = Study::load(&path)?;
        let assignment = study.assignment.clone().ok_or_else(|| {
            invalid(format!(
                "hosting needs {ASSIGNMENT_FILE}, which lists the participants. Create it with `novamind study assign {}`",
                study.folder.display()
            ))
        })?;
        let path = study.folder.join(HOST_FOLDER);
        create_private_folder(&path)?;
        create_private_folder(&path.join(SESSIONS_FOLDER))?;
        let description = HostDescription {
            program: program.clone(),
            study: study.digest.clone(),
            url: None,
            admin_code: None,
        };
        let mut folder = HostFolder { path, study, rows: assignment.rows, description, report: |_| {} };
        folder.check_description()?;
        folder.rows.iter().try_for_each(|row| folder.prepare_session(row))?;
        Ok(folder)
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the study.
    pub fn study(&self) -> &Study {
        &self.study
    }

    /// Returns the labels of the participants, in the order of the assignment.
    pub fn labels(&self) -> impl Iterator<Item = &str> {
        self.rows.iter().map(|row| row.label.as_str())
    }

    /// Returns the folder of a session. The label must be a label of the study.
    pub fn session_folder(&self, label: &str) -> PathBuf {
        self.path.join(SESSIONS_FOLDER).join(label)
    }

    /// Returns the folder of runs of a session, which is one machine for the commands of `novamind study`.
    pub fn runs_folder(&self, label: &str) -> PathBuf {
        self.session_folder(label).join("runs")
    }

    /// Compares `host.toml` with the program and the study, and reads its settings. Writes the file if no session has
    /// started.
    fn check_description(&mut self) -> Result<(), RunError> {
        let path = self.path.join(HOST_FILE);
        if let Some(text) = read_if_exists(&path)? {
            let text = String::from_utf8_lossy(&text);
            let found: HostDescription =
                toml::from_str(&text).map_err(|error| invalid(format!("{}: {error}", path.display())))?;
            self.description.url.clone_from(&found.url);
            self.description.admin_code.clone_from(&found.admin_code);
            if found == self.description {
                return Ok(());
            }
            if self.has_started_sessions() {
                return Err(invalid(describe_difference(&found, &self.description, &path)));
            }
        }
        self.write_description()
    }

    fn write_description(&self) -> Result<(), RunError> {
        let text = toml::to_string(&self.description).map_err(|error| invalid(error.to_string()))?;
        write_private_atomically(&self.path.join(HOST_FILE), text.as_bytes())
    }

    /// Saves the address in links or the code of the experimenter's page. `None` keeps the saved value.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save_settings(
        &mut self,
        url: Option<String>,
        admin_code: Option<CodeDigest>,
    ) -> Result<(), RunError> {
        self.description.url = url.or(self.description.url.take());
        self.description.admin_code = admin_code.or(self.description.admin_code.take());
        self.write_description()
    }

    /// Returns the address of the host in links.
    pub fn url(&self) -> Option<&str> {
        self.description.url.as_deref()
    }

    /// Returns the digest of the code for the experimenter's page, or `None` if there is no code.
    pub fn admin_code(&self) -> Option<&CodeDigest> {
        self.description.admin_code.as_ref()
    }

    /// Returns the access of the participants.
    pub fn access(&self) -> Access {
        Access::of_folder(&self.path)
    }

    /// Sets the function that reports failures of the audit log to the experimenter.
    pub fn report_failures(&mut self, report: fn(&str)) {
        self.report = report;
    }

    /// Returns the audit log.
    pub fn audit(&self) -> AuditLog {
        AuditLog::of_folder(&self.path, self.report)
    }

    /// Returns the path of the socket if no other path is given.
    pub fn default_socket(&self) -> PathBuf {
        self.path.join("host.sock")
    }

    fn has_started_sessions(&self) -> bool {
        let sessions = std::fs::read_dir(self.path.join(SESSIONS_FOLDER)).into_iter().flatten().flatten();
        sessions.into_iter().any(|session| has_started(&session.path()))
    }

    /// Creates the folder of a session, with a copy of the study that contains only this participant's row.
    fn prepare_session(&self, row: &AssignmentRow) -> Result<(), RunError> {
        let folder = self.session_folder(&row.label);
        let copy = folder.join("study");
        let assignment = Assignment { rows: vec![row.clone()] }.to_csv();
        if let Some(existing) = read_if_exists(&copy.join(ASSIGNMENT_FILE))?
            && existing != assignment.as_bytes()
            && has_started(&folder)
        {
            return Err(invalid(format!(
                "the row of {} in {ASSIGNMENT_FILE} was changed after the session started: restore the row of {}",
                row.label,
                copy.join(ASSIGNMENT_FILE).display()
            )));
        }
        for path in [&folder, &copy, &copy.join(QUESTIONS_FOLDER), &folder.join("runs"), &folder.join("tmp")]
        {
            create_private_folder(path)?;
        }
        for name in [STUDY_FILE, CONSENT_FILE, SEAL_KEY_FILE] {
            copy_if_exists(&self.study.folder.join(name), &copy.join(name))?;
        }
        for entry in
            std::fs::read_dir(self.study.folder.join(QUESTIONS_FOLDER)).into_iter().flatten().flatten()
        {
            copy_if_exists(&entry.path(), &copy.join(QUESTIONS_FOLDER).join(entry.file_name()))?;
        }
        write_private_atomically(&copy.join(ASSIGNMENT_FILE), assignment.as_bytes())
    }
}

/// Returns whether a session has written to its folder of runs.
fn has_started(session: &Path) -> bool {
    std::fs::read_dir(session.join("runs")).is_ok_and(|mut files| files.next().is_some())
}

fn describe_difference(found: &HostDescription, current: &HostDescription, path: &Path) -> String {
    let (ours, theirs) = (&current.program, &found.program);
    if theirs != ours {
        return format!(
            "the sessions in this host folder were started with novamind {} (mechanics {}), and this program is novamind {} \
             (mechanics {}). Continue them with novamind {0}. {} is unchanged",
            theirs.version,
            theirs.mechanics,
            ours.version,
            ours.mechanics,
            path.display()
        );
    }
    format!(
        "the protocol was changed after sessions started: it had the digest {}, and now has {}. Restore the files of the \
         study, or copy the study without its folder {HOST_FOLDER} and host the copy",
        &found.study[..found.study.len().min(12)],
        &current.study[..12]
    )
}

fn invalid(problem: String) -> RunError {
    RunError::InvalidRequest(problem)
}

/// Creates a folder that only the user can read, if it does not exist. An existing folder gets these permissions.
pub(crate) fn create_private_folder(path: &Path) -> Result<(), RunError> {
    if !path.is_dir() {
        DirBuilder::new().mode(0o700).create(path).map_err(RunError::io(path))?;
    }
    std::fs::set_permissions(path, Permissions::from_mode(0o700)).map_err(RunError::io(path))
}

fn copy_if_exists(from: &Path, to: &Path) -> Result<(), RunError> {
    match read_if_exists(from)? {
        Some(bytes) => write_private_atomically(to, &bytes),
        None => Ok(()),
    }
}
