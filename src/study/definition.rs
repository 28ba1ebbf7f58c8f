//! `study.toml`: the protocol of all sessions of a study.
//!
//! A study is a folder: `study.toml`, `consent.md`, `questions/*.toml` and `assignment.csv`. The digest of the protocol is in
//! the first line of every run, so runs of different protocols cannot be mixed up.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::assignment::Assignment;
use super::keys::load_seal_key;
use super::questions::Questionnaire;
use novamind_record::error::RunError;
use novamind_record::folder::configuration::CONSENT_FILE;
use novamind_record::folder::configuration::{DEFAULT_SCENARIO, check_cash, check_days};
use novamind_record::rules::{
    DraftRecording, FreeTextRecording, ResultsDisclosure, SessionRules, TimeLimits,
};
use novamind_record::trajectory::record::Activity;
use novamind_session::SealKey;
use novamind_voice::model::settings::ModelSettings;
use novamind_world::params::ParameterError;

/// Name of the protocol file in the folder of a study.
pub const STUDY_FILE: &str = "study.toml";

/// A study that was read from its folder.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Folder of the study.
    pub folder: PathBuf,
    /// Contents of `study.toml`.
    pub protocol: Protocol,
    /// Text to which participants consent; `None` if the study does not require consent.
    pub consent: Option<String>,
    /// Questionnaires in the order of their files.
    pub questionnaires: Vec<Questionnaire>,
    /// Participants with seeds and conditions; `None` if any label is accepted.
    pub assignment: Option<Assignment>,
    /// BLAKE3 digest of protocol, consent and questions, in hexadecimal digits. The digest does not include the
    /// assignment, because rows may be added to the assignment. Each run records the row of its participant.
    pub digest: String,
    /// Key that seals the snapshots of the study's runs.
    pub seal_key: SealKey,
}

/// Contents of `study.toml`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Protocol {
    /// Name of the study, which consists of letters, digits and hyphens.
    pub name: String,
    /// Title of the study, which is shown to participants.
    pub title: String,
    /// Scenario, length and starting cash of the session.
    #[serde(default)]
    pub world: StudyWorld,
    /// Seeds and conditions of the participants.
    #[serde(default)]
    pub seeds: Seeds,
    /// Practice run before the session.
    #[serde(default)]
    pub practice: Practice,
    /// Display settings for participants.
    #[serde(default)]
    pub session: SessionOptions,
    /// Time limits of weeks, sessions and runs.
    #[serde(default)]
    pub limits: TimeLimits,
    /// What is recorded of the sessions, and in which form.
    #[serde(default)]
    pub record: RecordOptions,
    /// Language model that words the messages of the runs; `None` for the built-in voice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub voice: Option<ModelSettings>,
    /// Settings of earlier versions. They have no effect, and are accepted so that old studies can be read.
    #[serde(default, skip_serializing)]
    integrity: RemovedSettings,
    /// Access of the experimenter to additional functions.
    #[serde(default)]
    pub access: AccessOptions,
}

/// Scenario, length and starting cash of a session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StudyWorld {
    /// Name of a bundled scenario.
    pub scenario: String,
    /// Last day of the session; `None` for the last day of the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub days: Option<u32>,
    /// Cash on day 0, dollars; `None` for the cash of the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cash: Option<f64>,
}

impl Default for StudyWorld {
    fn default() -> Self {
        StudyWorld { scenario: DEFAULT_SCENARIO.to_owned(), days: None, cash: None }
    }
}

/// Seeds and conditions of the participants.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Seeds {
    /// Method of assigning seeds.
    pub plan: SeedPlan,
    /// Seed of all participants if the plan is `one`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// Seeds of a block if the plan is `blocks`. Each block of participants plays all these seeds in random
    /// order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub block: Vec<u64>,
    /// Number of secret seeds if the plan is `secret`. Each block of participants plays all of them in random order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub count: Option<u32>,
    /// Conditions, which are crossed with the seeds of a block. Conditions label and balance participants and do not
    /// change the program.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub conditions: Vec<String>,
    /// Seed of the randomization if the plan is `blocks` or `secret`; `None` for seed 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub draw: Option<u64>,
}

impl Seeds {
    /// Returns the seeds that each block of participants plays, if the protocol contains them.
    pub fn block_seeds(&self) -> Vec<u64> {
        if self.block.is_empty() { self.seed.into_iter().collect() } else { self.block.clone() }
    }

    /// Returns the number of participants in a block: the number of seeds multiplied by the number of conditions.
    pub fn cell_count(&self) -> usize {
        let seeds = self.count.map_or(self.block_seeds().len(), |count| count as usize);
        seeds.max(1) * self.conditions.len().max(1)
    }
}

/// Method of assigning seeds to participants.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SeedPlan {
    /// All participants play the same seed.
    #[default]
    One,
    /// `study assign` randomizes seeds and conditions within blocks.
    Blocks,
    /// The experimenter writes `assignment.csv`.
    Assigned,
    /// `study assign` draws random seeds, which only `assignment.csv` contains, and randomizes them within blocks.
    Secret,
}

/// The practice run, in which participants learn the controls.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Practice {
    /// Whether the practice run is required, optional or omitted.
    pub offer: PracticeOffer,
    /// Name of the bundled scenario of the practice run.
    pub scenario: String,
    /// Seed of the practice run, which must not be a seed of a session.
    pub seed: u64,
    /// Last day of the practice run; `None` for the last day of the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub days: Option<u32>,
}

/// The requirement to play the practice run: required, optional or omitted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PracticeOffer {
    /// Participants must play the practice run to its end.
    Required,
    /// Participants may skip the practice run.
    #[default]
    Optional,
    /// There is no practice run.
    None,
}

impl Default for Practice {
    fn default() -> Self {
        Practice { offer: PracticeOffer::default(), scenario: "practice".to_owned(), seed: 1_618, days: None }
    }
}

/// Display settings for participants.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SessionOptions {
    /// Whether the practice run shows the tour.
    pub tour: bool,
    /// Whether alerts recommend actions.
    pub advice: bool,
    /// Whether participants see the accuracy of their past forecasts during the run.
    pub calibration: bool,
    /// Results that are shown on the final page.
    pub results: ResultsDisclosure,
    /// Whether participants must give a reason when they stop the clock.
    pub pause_reason: bool,
}

impl Default for SessionOptions {
    fn default() -> Self {
        SessionOptions {
            tour: false,
            advice: false,
            calibration: false,
            results: ResultsDisclosure::Own,
            pause_reason: false,
        }
    }
}

/// Settings that determine what is recorded of the sessions, and in which form.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RecordOptions {
    /// Kinds of activity that are not recorded.
    pub leave_out: Vec<String>,
    /// Form in which notes and free-text answers are recorded.
    pub free_text: FreeTextRecording,
    /// Form in which edits of texts are recorded.
    pub drafts: DraftRecording,
}

impl Default for RecordOptions {
    fn default() -> Self {
        RecordOptions {
            leave_out: Vec::new(),
            free_text: FreeTextRecording::Kept,
            drafts: DraftRecording::Lengths,
        }
    }
}

/// Keys of the table `integrity`, which were removed from the program.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RemovedSettings {
    witness: Option<PathBuf>,
    code_words: Option<bool>,
}

/// Access of the experimenter to functions that participants cannot use.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AccessOptions {
    /// Salted digest of the experimenter's code, as `novamind study code` prints it; `None` if the study has no code.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub code: Option<CodeDigest>,
}

/// Salted digest of the experimenter's code: `salt:digest`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct CodeDigest(String);

impl CodeDigest {
    /// Number of hashing rounds. Many rounds slow down guessing.
    const HASH_ROUNDS: u32 = 100_000;

    /// Computes the digest of a code with a salt.
    pub fn from_code(code: &str, salt: &str) -> CodeDigest {
        let mut digest =
            blake3::derive_key("novamind experimenter code", format!("{salt}:{code}").as_bytes());
        for _ in 0..CodeDigest::HASH_ROUNDS {
            digest = *blake3::hash(&digest).as_bytes();
        }
        let digits: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        CodeDigest(format!("{salt}:{digits}"))
    }

    /// Returns whether a code matches the digest.
    pub fn matches(&self, code: &str) -> bool {
        self.0.split_once(':').is_some_and(|(salt, _)| CodeDigest::from_code(code, salt) == *self)
    }

    /// Returns the text `salt:digest` that `study.toml` contains.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Study {
    /// Reads a study from its folder.
    ///
    /// # Errors
    /// Returns an error if a file is missing or invalid. The error names the file, the line, the key and the expected value.
    pub fn load(folder: &Path) -> Result<Study, RunError> {
        let path = folder.join(STUDY_FILE);
        let text = std::fs::read_to_string(&path).map_err(RunError::io(&path))?;
        let protocol = Protocol::parse(&path.display().to_string(), &text)?;
        let consent = read_optional(&folder.join(CONSENT_FILE))?.filter(|text| !text.trim().is_empty());
        let files = read_question_files(folder)?;
        let mut questionnaires = Vec::new();
        for (path, text) in &files {
            questionnaires.push(Questionnaire::parse(path, text)?);
        }
        let assignment = Assignment::read(folder)?;
        if assignment.is_none() && protocol.seeds.plan != SeedPlan::One {
            let problem =
                "this plan needs assignment.csv, which is missing. Create it with `novamind study assign`";
            return Err(
                ParameterError::for_key(&path.display().to_string(), &text, "seeds.plan", problem).into()
            );
        }
        let mut digest = blake3::Hasher::new_derive_key("novamind study protocol");
        let mut take = |name: &str, text: &str| {
            for part in [name, text] {
                digest.update(&(part.len() as u64).to_le_bytes());
                digest.update(part.as_bytes());
            }
        };
        take(STUDY_FILE, &text);
        take(CONSENT_FILE, consent.as_deref().unwrap_or_default());
        for (path, text) in &files {
            take(&path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default(), text);
        }
        let digest = digest.finalize().to_hex().to_string();
        let (folder, seal_key) = (folder.to_owned(), load_seal_key(folder)?);
        Ok(Study { folder, protocol, consent, questionnaires, assignment, digest, seal_key })
    }

    /// Returns the seeds that each block of participants plays. Secret seeds are read from the assignment.
    pub fn block_seeds(&self) -> Vec<u64> {
        match (self.protocol.seeds.plan, &self.assignment) {
            (SeedPlan::Secret, Some(assignment)) => assignment.seeds(),
            _ => self.protocol.seeds.block_seeds(),
        }
    }

    /// Returns a commitment to the secret seeds, or `None` if the plan is another one. The commitment can be published before
    /// the study. Anyone who receives the seeds later can compute it again. It takes long to compute, so it cannot be used
    /// to find the seeds.
    pub fn seed_commitment(&self) -> Option<String> {
        let seeds: Vec<String> = match self.protocol.seeds.plan {
            SeedPlan::Secret => self.block_seeds().iter().map(u64::to_string).collect(),
            _ => return None,
        };
        Some(CodeDigest::from_code(&seeds.join(","), &self.protocol.name).as_str().to_owned())
    }

    /// Returns a warning if a participant who has the program can find a seed of the sessions by trying all small numbers.
    pub fn guessable_seeds_warning(&self) -> Option<String> {
        let assigned = self.assignment.iter().flat_map(|assignment| assignment.seeds());
        let seeds = self.protocol.seeds.block_seeds().into_iter().chain(assigned);
        seeds.min().filter(|seed| *seed < 1 << 32)?;
        Some(
            "a seed of the sessions is below 4,294,967,296: a participant who has the program can try all such seeds, compare \
             their first weeks with the session, and rehearse it. Use [seeds] plan = \"secret\""
                .to_owned(),
        )
    }

    /// Returns the first digits of the study's digest, for messages.
    pub fn short_digest(&self) -> &str {
        shorten_digest(&self.digest)
    }

    /// Returns the rules that apply in the sessions of the study.
    pub fn session_rules(&self) -> SessionRules {
        let Protocol { session, record, limits, .. } = &self.protocol;
        SessionRules {
            advice: session.advice,
            calibration: session.calibration,
            results: session.results,
            free_text: record.free_text,
            drafts: record.drafts,
            unrecorded: record.leave_out.clone(),
            pause_reason: session.pause_reason,
            code_words: None,
            limits: *limits,
        }
    }
}

impl Protocol {
    /// Returns a message for each setting in `study.toml` that was removed from the program, with the reason and the next step.
    pub fn removed_settings(&self) -> Vec<String> {
        let RemovedSettings { witness, code_words } = &self.integrity;
        let keys = [("witness", witness.is_some()), ("code_words", code_words.is_some())];
        let used = keys.into_iter().filter(|(_, is_used)| *is_used);
        used.map(|(key, _)| {
            format!(
                "[integrity] {key} was removed and has no effect: a participant who controls the machine could bypass it. \
                 Runs of this study can still be continued, audited and collected. For a new study, delete the line; \
                 the digest of the protocol changes with it"
            )
        })
        .collect()
    }

    /// Parses the text of `study.toml`. `source` is the name of the file in error messages.
    ///
    /// # Errors
    /// Returns an error that names the first problem, its line and its key.
    pub fn parse(source: &str, text: &str) -> Result<Protocol, ParameterError> {
        let protocol: Protocol =
            toml::from_str(text).map_err(|error| ParameterError::from_toml(source, text, &error))?;
        protocol.check().map_err(|(key, problem)| ParameterError::for_key(source, text, key, problem))?;
        Ok(protocol)
    }

    fn check(&self) -> Result<(), (&'static str, String)> {
        let fits = |name: &str| {
            let letters = name.bytes().all(|letter| letter.is_ascii_alphanumeric() || letter == b'-');
            (1..=40).contains(&name.len()) && letters
        };
        if !fits(&self.name) {
            return Err(("name", "a name must have 1 to 40 letters, digits and hyphens".to_owned()));
        }
        self.world.days.map_or(Ok(()), check_days).map_err(|problem| ("world.days", problem))?;
        self.world.cash.map_or(Ok(()), check_cash).map_err(|problem| ("world.cash", problem))?;
        self.practice.days.map_or(Ok(()), check_days).map_err(|problem| ("practice.days", problem))?;
        match self.seeds.plan {
            SeedPlan::One if self.seeds.seed.is_none() => {
                return Err(("seeds", "plan \"one\" needs seed = N".to_owned()));
            }
            SeedPlan::Blocks if self.seeds.block.is_empty() => {
                return Err(("seeds", "plan \"blocks\" needs block = [seeds]".to_owned()));
            }
            SeedPlan::Secret if self.seeds.count.is_none_or(|count| !(1..=1000).contains(&count)) => {
                return Err(("seeds", "plan \"secret\" needs count = N, from 1 to 1000".to_owned()));
            }
            SeedPlan::Secret if !self.seeds.block_seeds().is_empty() => {
                let problem = "plan \"secret\" draws the seeds itself: leave out seed and block";
                return Err(("seeds", problem.to_owned()));
            }
            plan if plan != SeedPlan::Secret && self.seeds.count.is_some() => {
                return Err(("seeds.count", "only plan \"secret\" has count: leave it out".to_owned()));
            }
            _ => {}
        }
        let session_seeds = self.seeds.seed.iter().chain(&self.seeds.block);
        if self.practice.offer != PracticeOffer::None
            && session_seeds.into_iter().any(|seed| *seed == self.practice.seed)
        {
            let problem = format!(
                "{} is also the seed of a session. Choose another seed for the practice run",
                self.practice.seed
            );
            return Err(("practice.seed", problem));
        }
        let unknown =
            self.record.leave_out.iter().find(|kind| !Activity::OPTIONAL_KINDS.contains(&kind.as_str()));
        if let Some(kind) = unknown {
            let known = Activity::OPTIONAL_KINDS.join(", ");
            return Err((
                "record.leave_out",
                format!("unknown kind of activity {kind}; the kinds are {known}"),
            ));
        }
        const REQUIRED_KINDS: [&str; 5] = ["session", "clock", "limit", "answer", "question"];
        if let Some(kind) = self.record.leave_out.iter().find(|kind| REQUIRED_KINDS.contains(&kind.as_str()))
        {
            return Err((
                "record.leave_out",
                format!("{kind} cannot be left out: times and answers depend on it"),
            ));
        }
        self.voice.as_ref().map_or(Ok(()), ModelSettings::check).map_err(qualify_voice_key)?;
        self.limits.check_warning()?;
        let limits = [self.limits.week_minutes, self.limits.session_minutes, self.limits.study_minutes];
        if limits.contains(&Some(0)) {
            return Err(("limits", "a limit must be at least 1 minute".to_owned()));
        }
        Ok(())
    }
}

/// Returns the first 16 digits of a digest, for messages.
pub(crate) fn shorten_digest(digest: &str) -> &str {
    digest.get(..16).unwrap_or(digest)
}

/// Adds the name of the table `voice` to the key of a problem.
fn qualify_voice_key((key, problem): (&'static str, String)) -> (&'static str, String) {
    let key = match key {
        "endpoint" => "voice.endpoint",
        "model" => "voice.model",
        "key_variable" => "voice.key_variable",
        "seconds_a_week" => "voice.seconds_a_week",
        "words" => "voice.words",
        _ => "voice",
    };
    (key, problem)
}

fn read_optional(path: &Path) -> Result<Option<String>, RunError> {
    match std::fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(RunError::Io { path: path.to_owned(), error }),
    }
}

/// Reads the question files, sorted by name.
fn read_question_files(folder: &Path) -> Result<Vec<(PathBuf, String)>, RunError> {
    let questions = folder.join("questions");
    let entries = match std::fs::read_dir(&questions) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(RunError::Io { path: questions, error }),
    };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort_unstable();
    let read = |path: PathBuf| match std::fs::read_to_string(&path) {
        Ok(text) => Ok((path, text)),
        Err(error) => Err(RunError::Io { path, error }),
    };
    paths.into_iter().map(read).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn protocol_digest_depends_on_its_text() {
        let folder = tempfile::tempdir().expect("a folder");
        let read = |text: &str| {
            std::fs::write(folder.path().join(STUDY_FILE), text).expect("written");
            Study::load(folder.path()).expect("a study")
        };
        let text = "name = \"pilot\"\ntitle = \"A company\"\n[seeds]\nseed = 7\n";
        let plain = read(text);
        // Runs record the protocol digest, so the digest must be the same in every version of the program.
        assert_eq!(plain.digest, "9c6e07e6aa3cdcbd5263b75c588fa133f240e81f2c415b579128125f39ce69a1");
        assert!(plain.protocol.removed_settings().is_empty());
        // A file with removed settings keeps its digest and its rules.
        let old = read(&format!("{text}[integrity]\nwitness = \"/mnt/lab\"\ncode_words = true\n"));
        assert_eq!(old.digest, "9ae42916627507b38d81028fd909f77262e5aad500f01ac8d7a77a6eecbcec06");
        assert_eq!((old.session_rules(), old.protocol.removed_settings().len()), (plain.session_rules(), 2));
    }
}
