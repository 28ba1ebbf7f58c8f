//! Merging of the shards of a study. Every shard must be present exactly once and undamaged. The rows are written in
//! the order of the runs.

use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use super::shard::{Shard, ShardHeader};

/// The reasons why shards cannot be merged, with file names.
#[derive(Debug)]
pub struct MergeError(Vec<String>);

impl fmt::Display for MergeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}; nothing was written", self.0.join("; "))
    }
}

impl std::error::Error for MergeError {}

impl MergeError {
    fn single(problem: String) -> MergeError {
        MergeError(vec![problem])
    }
}

/// A complete set of undamaged shards of one study, in order.
#[derive(Debug)]
pub struct ShardSet {
    files: Vec<PathBuf>,
}

impl ShardSet {
    /// Finds the shards in the given files and folders, and checks that they are the complete set of one study.
    ///
    /// # Errors
    /// Fails if a file is not a shard, is damaged or belongs to another study, or if a shard is missing or present
    /// twice.
    pub fn find(places: &[PathBuf]) -> Result<ShardSet, MergeError> {
        let mut problems = Vec::new();
        let (mut found, mut damaged): (Vec<(PathBuf, ShardHeader)>, Vec<ShardHeader>) = Default::default();
        for file in shard_files(places)? {
            match read_and_verify_shard(&file) {
                Ok(ShardState::Intact(head)) => found.push((file, head)),
                Ok(ShardState::Damaged(head)) => {
                    problems.push(format!("{} is damaged: rerun shard {}", file.display(), head.part));
                    damaged.push(head);
                }
                Err(problem) => problems.push(format!("{}: {problem}", file.display())),
            }
        }
        let Some((first, study)) = found.first().cloned() else {
            let nothing =
                "no shards found: write them with `lab study FILE --shard 1/N --out DIR`".to_owned();
            return Err(MergeError(if problems.is_empty() { vec![nothing] } else { problems }));
        };
        let mut by_number: BTreeMap<usize, PathBuf> = BTreeMap::new();
        for (file, head) in found {
            let place = file.display();
            if head.study != study.study {
                problems.push(format!("{place} belongs to the study {}, not to {}", head.study, study.study));
            } else if head.digest != study.digest {
                problems.push(format!(
                    "{place} is from another version of {} than {}: policies, parameters, seeds or program differ",
                    study.study,
                    first.display()
                ));
            } else if head.part.of != study.part.of {
                let other = first.display();
                problems.push(format!("{place} is shard {}, {other} is shard {}", head.part, study.part));
            } else if let Some(duplicate) = by_number.get(&head.part.shard) {
                problems.push(format!("{place} and {} are both shard {}", duplicate.display(), head.part));
            } else {
                by_number.insert(head.part.shard, file);
            }
        }
        let is_there = |shard: &usize| {
            let is_same_shard = |head: &ShardHeader| head.digest == study.digest && head.part.shard == *shard;
            by_number.contains_key(shard) || damaged.iter().any(is_same_shard)
        };
        let name = |shard| ShardHeader::file_name(&study.study, Shard { shard, of: study.part.of });
        let missing: Vec<String> = (1..=study.part.of).filter(|shard| !is_there(shard)).map(name).collect();
        if !missing.is_empty() {
            problems.push(format!("missing: {}", abbreviate_names(&missing)));
        }
        match problems.is_empty() {
            true => Ok(ShardSet { files: by_number.into_values().collect() }),
            false => Err(MergeError(problems)),
        }
    }

    /// Returns the shard files, in the order of the shards.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Writes the header and the rows of all shards, in the order of the runs.
    ///
    /// # Errors
    /// Fails if a file cannot be read or the output cannot be written.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let mut readers = Vec::new();
        for (at, file) in self.files.iter().enumerate() {
            let mut row_reader = RowReader { lines: BufReader::new(File::open(file)?), line: Vec::new() };
            row_reader.read_next()?;
            row_reader.read_next()?;
            if at == 0 {
                out.write_all(&row_reader.line)?;
            }
            row_reader.read_next()?;
            readers.push(row_reader);
        }
        for run in 1.. {
            let count = readers.len();
            let reader = &mut readers[(run - 1) % count];
            let mut has_rows = false;
            while reader.run_number() == Some(run) {
                out.write_all(&reader.line)?;
                reader.read_next()?;
                has_rows = true;
            }
            if !has_rows {
                break;
            }
        }
        let is_left = readers.iter().position(|reader| !reader.line.is_empty());
        is_left.map_or(Ok(()), |at| {
            let problem = format!("{}: its runs are out of order", self.files[at].display());
            Err(io::Error::other(problem))
        })
    }
}

/// Joins the first names and adds the number of the remaining names.
fn abbreviate_names(names: &[String]) -> String {
    const MAX_NAMES: usize = 10;
    match names.len() {
        count if count <= MAX_NAMES => names.join(", "),
        count => format!("{} and {} more", names[..MAX_NAMES].join(", "), count - MAX_NAMES),
    }
}

/// A reader of the rows of a shard.
struct RowReader {
    lines: BufReader<File>,
    /// Current row with its line terminator; empty at the end of the file.
    line: Vec<u8>,
}

impl RowReader {
    fn read_next(&mut self) -> io::Result<()> {
        self.line.clear();
        self.lines.read_until(b'\n', &mut self.line).map(drop)
    }

    fn run_number(&self) -> Option<usize> {
        let cell = self.line.split(|byte| *byte == b',').next()?;
        std::str::from_utf8(cell).ok()?.parse().ok()
    }
}

/// Returns the given files, and the files in the given folders that have the name of a shard.
fn shard_files(places: &[PathBuf]) -> Result<Vec<PathBuf>, MergeError> {
    let mut all = Vec::new();
    for place in places {
        if !place.is_dir() {
            all.push(place.clone());
            continue;
        }
        let entries = std::fs::read_dir(place)
            .map_err(|error| MergeError::single(format!("{}: {error}", place.display())))?;
        let mut paths: Vec<PathBuf> =
            entries.flatten().map(|entry| entry.path()).filter(|path| is_named_as_shard(path)).collect();
        paths.sort_unstable();
        all.extend(paths);
    }
    // A file that is given twice is used once.
    let mut seen = std::collections::BTreeSet::new();
    all.retain(|path| seen.insert(path.canonicalize().unwrap_or_else(|_| path.clone())));
    Ok(all)
}

fn is_named_as_shard(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let numbers = name.strip_suffix(".csv").and_then(|name| name.rsplit_once('.')).map(|parts| parts.1);
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    numbers
        .and_then(|numbers| numbers.split_once("-of-"))
        .is_some_and(|(shard, of)| is_number(shard) && is_number(of))
}

/// The state of a shard file with a valid first line.
enum ShardState {
    /// The rows match the checksum in the first line.
    Intact(ShardHeader),
    /// The rows do not match the checksum in the first line.
    Damaged(ShardHeader),
}

/// Reads the first line of a shard file and compares the rows with the checksum.
fn read_and_verify_shard(file: &Path) -> Result<ShardState, String> {
    if std::fs::metadata(file).is_ok_and(|found| !found.is_file()) {
        return Err("it is not a file".to_owned());
    }
    let mut reader = BufReader::new(File::open(file).map_err(|error| error.to_string())?);
    // The first line of a shard is short. The read is limited, so that a file without line terminators is not
    // read completely.
    let mut line = Vec::new();
    reader.by_ref().take(4096).read_until(b'\n', &mut line).map_err(|error| error.to_string())?;
    let head = std::str::from_utf8(&line).ok().and_then(|line| ShardHeader::parse(line.trim_end()));
    let head = head.ok_or("it is not a shard of a study")?;
    let mut hasher = blake3::Hasher::new();
    io::copy(&mut reader, &mut hasher).map_err(|error| error.to_string())?;
    let is_whole = hasher.finalize().to_hex()[..32] == *head.checksum;
    Ok(if is_whole { ShardState::Intact(head) } else { ShardState::Damaged(head) })
}
