//! The snapshot file, `snapshot.bin`: the complete state at one line of the trajectory, so that a long run opens
//! quickly.
//!
//! A snapshot is used only if it is intact, if this version wrote it for this run and these parameters, and if its
//! line is in the trajectory. Otherwise, the run is simulated from its start, which takes longer
//! (docs/formats/snapshot.md).
//!
//! The file consists of a title line, an envelope and sealed canonical bytes. The sealed bytes contain the header as
//! JSON, the history as deflated JSON, and the numbers of world and session.

use std::borrow::Cow;
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use serde::{Deserialize, Serialize};

use super::sealing::{Envelope, RunKeys, SealKey};
use crate::company::facts_chain::FactsChain;
use crate::company::feed::Feed;
use crate::company::history::History;
use crate::company::idempotency::IdempotentResponses;
use crate::company::irrevocable::IrrevocableAction;
use crate::company::overrides::Overrides;
use crate::company::reports::WeekResult;
use crate::company::simulation::Simulation;
use crate::company::week_actions::{UndoStep, WeekActions};
use crate::figures::changes::Decisions;
use crate::figures::journal::JournalEntry;
use novamind_database::ProjectionPosition;
use novamind_record::figures::WeekFigures;
use novamind_record::files::{open_regular_file, read_regular_file};
use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::record::{CalculationOutput, RequestId, RunEndReason};
use novamind_record::trajectory::{Line, Record, first_line_hash};
use novamind_tools::Notebook;
use novamind_world::canonical::{Canonical, CanonicalHasher, CanonicalReader, Restore, canonical_bytes};
use novamind_world::params::Params;

const TITLE: &[u8] = b"novamind snapshot 6\n";
/// Byte after the title if the snapshot can be unsealed without the secret of a study.
const RUN_KEY_MARK: u8 = b'r';
const STUDY_KEY_MARK: u8 = b's';
const TRAJECTORY_FILE: &str = "trajectory.jsonl";
pub(crate) const SNAPSHOT_FILE: &str = "snapshot.bin";
/// Initial buffer capacity per subscriber. Columns and the facts of a day need about 190 bytes. Unused capacity is
/// cheap, but a buffer that is too small has to be copied.
const BYTES_PER_SUBSCRIBER: usize = 320;
pub(crate) const SNAPSHOT_INTERVAL_WEEKS: usize = 4;

/// The header of a snapshot, which identifies its state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Header {
    /// Version of the program that wrote the snapshot.
    version: String,
    run: String,
    parameters_digest: String,
    seq: u64,
    line_hash: String,
    state_hash: String,
    /// Digest of the database file at this line, if the run was closed properly.
    database: Option<String>,
}

/// The stored history of a session. The values are borrowed for writing and owned after reading.
#[derive(Serialize, Deserialize)]
struct StoredHistory<'a> {
    weeks: Cow<'a, [WeekFigures]>,
    running_week: Cow<'a, WeekFigures>,
    decisions: Cow<'a, [Decisions]>,
    notices: Cow<'a, [(u32, String)]>,
    feed: Cow<'a, Feed>,
    done: Cow<'a, [IrrevocableAction]>,
    journal: Cow<'a, [JournalEntry]>,
    asked: Cow<'a, [String]>,
    notebook: Cow<'a, Notebook>,
    calculated: Cow<'a, [CalculationOutput]>,
    #[serde(default)]
    last_dashboard: Option<Cow<'a, str>>,
    facts_chain: (String, bool),
    ended: Option<RunEndReason>,
    /// Responses to requests for weeks that have a request id.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    answered_weeks: Vec<(RequestId, WeekResult)>,
}

impl StoredHistory<'_> {
    /// Compresses the history, because a journal with thousands of offers is repetitive.
    fn compress(&self) -> Vec<u8> {
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
        let written = encoder.write_all(&serde_json::to_vec(self).unwrap_or_default());
        written.and_then(|()| encoder.finish()).unwrap_or_default()
    }

    fn decompress(bytes: &[u8]) -> Option<StoredHistory<'static>> {
        let mut text = String::new();
        DeflateDecoder::new(bytes).read_to_string(&mut text).ok()?;
        serde_json::from_str(&text).ok()
    }

    fn is_before_first_day(&self) -> bool {
        self.weeks.is_empty() && self.running_week.days_run == 0
    }
}

pub(crate) struct Snapshot {
    header: Header,
    /// Content of the file: title, envelope and the unsealed bytes.
    file: Vec<u8>,
    history_offset: usize,
}

pub(crate) struct RestoredSession {
    pub(crate) simulation: Simulation,
    pub(crate) history: History,
    pub(crate) notebook: Notebook,
}

impl Snapshot {
    /// Reads and unseals the snapshot in a run folder. Returns `None` if the file does not exist.
    ///
    /// # Errors
    /// The file cannot be used; returns a description of the problem.
    pub(crate) fn read(folder: &Path, key: &SealKey) -> Result<Option<Snapshot>, &'static str> {
        let mut file = match read_regular_file(&folder.join(SNAPSHOT_FILE)) {
            Ok(file) => file,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(_) => return Err("cannot be read"),
        };
        let sealed = unseal_file(&mut file, folder, key)?;
        let mut reader = CanonicalReader::new(&file[sealed..]);
        let header: Option<String> = reader.read();
        let header = header.and_then(|text| serde_json::from_str(&text).ok()).ok_or("has another version")?;
        let notes_at = file.len() - reader.remaining();
        Ok(Some(Snapshot { header, file, history_offset: notes_at }))
    }

    pub(crate) fn position(&self) -> ProjectionPosition {
        ProjectionPosition { seq: self.header.seq, line_hash: self.header.line_hash.clone() }
    }

    /// Returns the digest of the database file at this line, if the run was closed properly.
    pub(crate) fn database(&self) -> Option<&str> {
        self.header.database.as_deref()
    }

    /// Writes the snapshot again with a new digest of the database, which was rebuilt up to the same line.
    pub(crate) fn certify_database(mut self, place: &SnapshotTarget, database: Option<String>) {
        let header = Header { database, ..self.header };
        place.write(&header, &mut self.file[self.history_offset..]);
    }

    pub(crate) fn belongs_to(&self, run: &str) -> bool {
        self.header.run == run
    }

    /// Returns whether this version wrote the snapshot with these parameters.
    pub(crate) fn is_compatible(&self, manifest: &Manifest) -> bool {
        self.header.version == env!("CARGO_PKG_VERSION")
            && self.header.parameters_digest == manifest.parameters_digest
    }

    /// Restores the state of a run that started with `params` and has these lines. The restored state includes
    /// history and notebook. Returns `None` if the state does not match its hash.
    pub(crate) fn restore_session(
        &self,
        manifest: &Manifest,
        params: &Arc<Params>,
        lines: &[Line],
    ) -> Option<RestoredSession> {
        let mut reader = CanonicalReader::new(&self.file[self.history_offset..]);
        let stored_history = StoredHistory::decompress(&reader.read::<Vec<u8>>()?)?;
        // Snapshots of earlier builds do not contain the dashboard, which cannot be rebuilt from a later state.
        if stored_history.last_dashboard.is_none() && !stored_history.is_before_first_day() {
            return None;
        }
        let chain = blake3::Hash::from_hex(&stored_history.facts_chain.0).ok()?;
        let past = (reader.read()?, reader.read()?);
        let mut simulation = Simulation::from_state(manifest, params.clone(), past);
        let seen = lines.get(..=self.header.seq as usize)?;
        (simulation.params, simulation.overrides) = Overrides::replay(params, seen, simulation.world.day)?;
        simulation.trace = reader.read()?;
        simulation.facts_chain = FactsChain::from_hash(chain, stored_history.facts_chain.1);
        simulation.feed = stored_history.feed.into_owned();
        let mut first_answers = IdempotentResponses::from_weeks(stored_history.answered_weeks);
        for line in seen {
            if let Record::Call(call) = &line.record {
                first_answers.record_call(call);
            }
        }
        let history = History {
            cash_by_day: reader.read()?,
            group_weeks: reader.read()?,
            current_groups: reader.read()?,
            call_ledger: reader.read()?,
            week_actions: WeekActions {
                settings: reader.read()?,
                undo: reader.read()?,
                redo: reader.read()?,
                irrevocable_actions: stored_history.done.into_owned(),
            },
            weeks: stored_history.weeks.into_owned(),
            current_week: stored_history.running_week.into_owned(),
            decisions: stored_history.decisions.into_owned(),
            notices: stored_history.notices.into_owned(),
            journal: stored_history.journal.into_owned(),
            query_history: stored_history.asked.into_owned(),
            calculation_outputs: stored_history.calculated.into_owned(),
            last_dashboard: stored_history.last_dashboard.map(Cow::into_owned),
            ended: stored_history.ended,
            idempotent_responses: first_answers,
        };
        let same = reader.remaining() == 0 && simulation.state_hash().0 == self.header.state_hash;
        same.then(|| RestoredSession { simulation, history, notebook: stored_history.notebook.into_owned() })
    }
}

impl Canonical for UndoStep {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        self.seq.feed(hasher);
        self.tool.name().to_owned().feed(hasher);
        self.restored_settings.feed(hasher);
    }
}

impl Restore for UndoStep {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        let (seq, tool): (u64, String) = reader.read()?;
        Some(UndoStep { seq, tool: tool.parse().ok()?, restored_settings: reader.read()? })
    }
}

pub(crate) struct SnapshotSource<'a> {
    pub(crate) manifest: &'a Manifest,
    pub(crate) simulation: &'a Simulation,
    pub(crate) history: &'a History,
    pub(crate) notebook: &'a Notebook,
    pub(crate) position: ProjectionPosition,
}

impl SnapshotSource<'_> {
    /// Returns a function that writes the snapshot. The argument of the function is the digest of the database file,
    /// if known. The state is copied immediately, so the function can run on another thread while the company changes.
    pub(crate) fn writer(
        &self,
        state_hash: String,
        place: SnapshotTarget,
    ) -> impl FnOnce(Option<String>) + Send + 'static {
        let (header, mut state) = (self.header(state_hash), self.state_bytes());
        move |database| place.write(&Header { database, ..header }, &mut state)
    }

    fn header(&self, state_hash: String) -> Header {
        Header {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            run: self.manifest.id.clone(),
            parameters_digest: self.manifest.parameters_digest.clone(),
            seq: self.position.seq,
            line_hash: self.position.line_hash.clone(),
            state_hash,
            database: None,
        }
    }

    fn state_bytes(&self) -> Vec<u8> {
        let SnapshotSource { simulation, history, notebook, .. } = self;
        let chain = &simulation.facts_chain;
        let stored_history = StoredHistory {
            weeks: Cow::Borrowed(&history.weeks),
            running_week: Cow::Borrowed(&history.current_week),
            decisions: Cow::Borrowed(&history.decisions),
            notices: Cow::Borrowed(&history.notices),
            feed: Cow::Borrowed(&simulation.feed),
            done: Cow::Borrowed(&history.week_actions.irrevocable_actions),
            journal: Cow::Borrowed(&history.journal),
            asked: Cow::Borrowed(&history.query_history),
            notebook: Cow::Borrowed(*notebook),
            calculated: Cow::Borrowed(&history.calculation_outputs),
            last_dashboard: history.last_dashboard.as_deref().map(Cow::Borrowed),
            facts_chain: (chain.hash().to_hex().to_string(), chain.is_closed()),
            ended: history.ended,
            answered_weeks: history.idempotent_responses.recorded_weeks(),
        };
        let rows: u32 = simulation.world.customers.active_by_group().iter().sum();
        let mut bytes = CanonicalHasher::collector(rows as usize * BYTES_PER_SUBSCRIBER);
        stored_history.compress().feed(&mut bytes);
        simulation.world.feed(&mut bytes);
        simulation.facts.feed(&mut bytes);
        simulation.trace.feed(&mut bytes);
        history.cash_by_day.feed(&mut bytes);
        history.group_weeks.feed(&mut bytes);
        history.current_groups.feed(&mut bytes);
        history.call_ledger.feed(&mut bytes);
        history.week_actions.settings.feed(&mut bytes);
        history.week_actions.undo.feed(&mut bytes);
        history.week_actions.redo.feed(&mut bytes);
        bytes.into_bytes()
    }
}

/// Unseals a file in place. Returns the offset of the unsealed bytes.
fn unseal_file(file: &mut [u8], folder: &Path, key: &SealKey) -> Result<usize, &'static str> {
    let rest = file.strip_prefix(TITLE).ok_or("has another version or is damaged")?;
    let (&of, rest) = rest.split_first().ok_or("is truncated")?;
    let (envelope, _) = rest.split_first_chunk().ok_or("is truncated")?;
    let envelope = Envelope::from_bytes(envelope);
    if of == STUDY_KEY_MARK && !key.has_secret() {
        return Err("is sealed with the key of a study");
    }
    let seal_key = if of == RUN_KEY_MARK { &SealKey::default() } else { key };
    let first = first_line_hash(&folder.join(TRAJECTORY_FILE)).ok_or("belongs to a missing trajectory")?;
    let at = TITLE.len() + 1 + Envelope::LENGTH_BYTES;
    seal_key
        .derive_run_keys(&first)
        .open(&envelope, &mut file[at..])
        .then_some(at)
        .ok_or("is damaged or belongs to another run")
}

/// The path of a snapshot, and the keys that seal the snapshot.
pub(crate) struct SnapshotTarget {
    path: PathBuf,
    key_mark: u8,
    /// Keys of the run; `None` if the trajectory is missing. If there are no keys, no snapshot is written.
    keys: Option<RunKeys>,
}

impl SnapshotTarget {
    pub(crate) fn new(folder: &Path, key: &SealKey) -> SnapshotTarget {
        let keys = first_line_hash(&folder.join(TRAJECTORY_FILE)).map(|first| key.derive_run_keys(&first));
        let of = if key.has_secret() { STUDY_KEY_MARK } else { RUN_KEY_MARK };
        SnapshotTarget { path: folder.join(SNAPSHOT_FILE), key_mark: of, keys }
    }

    /// Returns whether a program with this key may replace the snapshot in a folder. A snapshot that is sealed with
    /// the secret of a study is replaced only with that secret.
    pub(crate) fn may_write(folder: &Path, key: &SealKey) -> bool {
        let mut begin = [0; TITLE.len() + 1];
        let read =
            open_regular_file(&folder.join(SNAPSHOT_FILE)).and_then(|mut file| file.read_exact(&mut begin));
        key.has_secret() || read.is_err() || begin[TITLE.len()] != STUDY_KEY_MARK
    }

    /// Seals the state in place and replaces the snapshot file. Does not sync the file: after a power cut, the tag
    /// shows whether the file is intact.
    fn write(&self, header: &Header, state: &mut [u8]) {
        let Some(keys) = &self.keys else { return };
        let mut header = canonical_bytes(&serde_json::to_string(header).unwrap_or_default());
        let envelope = keys.seal(&mut header, state).to_bytes();
        let draft = self.path.with_extension("draft");
        // Write the pieces separately to avoid another copy of a large state in memory.
        let pieces = [TITLE, &[self.key_mark], &envelope, &header, state];
        let written = File::create(&draft)
            .and_then(|mut file| pieces.iter().try_for_each(|piece| file.write_all(piece)))
            .and_then(|()| std::fs::rename(&draft, &self.path));
        if written.is_err() {
            // Remove a partial file, which would use space on a full disk.
            let _ = std::fs::remove_file(&draft);
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn read_rejects_devices() {
        let folder = tempfile::tempdir().expect("a folder");
        std::os::unix::fs::symlink("/dev/zero", folder.path().join(SNAPSHOT_FILE)).expect("a link");
        let found = Snapshot::read(folder.path(), &SealKey::default());
        assert_eq!(found.err(), Some("cannot be read"));
    }
}
