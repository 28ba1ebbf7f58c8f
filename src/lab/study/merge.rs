//! Shards put together again: all of one study, each once, none damaged, their rows in the order of the runs.

use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use super::shard::{Shard, ShardHead};

/// Why shards cannot be put together: everything that is wrong, with the names of the files.
#[derive(Debug)]
pub struct MergeError(Vec<String>);

impl fmt::Display for MergeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}; nothing was written", self.0.join("; "))
    }
}

impl std::error::Error for MergeError {}

impl MergeError {
    fn one(problem: String) -> MergeError {
        MergeError(vec![problem])
    }
}

/// The shards of a study, in their order: all of them, each whole.
#[derive(Debug)]
pub struct Shards {
    files: Vec<PathBuf>,
}

impl Shards {
    /// Finds the shards among files and in folders, and checks that they belong together.
    ///
    /// # Errors
    /// A file is no shard, is damaged, or of another study; a shard is there twice or is missing.
    pub fn of(places: &[PathBuf]) -> Result<Shards, MergeError> {
        let mut problems = Vec::new();
        let (mut found, mut damaged): (Vec<(PathBuf, ShardHead)>, Vec<ShardHead>) = Default::default();
        for file in files(places)? {
            match read(&file) {
                Ok(ReadShard::Whole(head)) => found.push((file, head)),
                Ok(ReadShard::Damaged(head)) => {
                    problems.push(format!("{} is damaged: play shard {} again", file.display(), head.part));
                    damaged.push(head);
                }
                Err(problem) => problems.push(format!("{}: {problem}", file.display())),
            }
        }
        let Some((first, study)) = found.first().cloned() else {
            let nothing = "there is no shard: `lab study FILE --shard 1/N --out DIR` writes one".to_owned();
            return Err(MergeError(if problems.is_empty() { vec![nothing] } else { problems }));
        };
        let mut by_number: BTreeMap<usize, PathBuf> = BTreeMap::new();
        for (file, head) in found {
            let place = file.display();
            if head.study != study.study {
                problems.push(format!("{place} belongs to the study {}, not to {}", head.study, study.study));
            } else if head.digest != study.digest {
                problems.push(format!(
                    "{place} is another {} than {}: its policies, parameters, seeds or program differ",
                    study.study,
                    first.display()
                ));
            } else if head.part.of != study.part.of {
                let other = first.display();
                problems.push(format!("{place} is shard {}, {other} is shard {}", head.part, study.part));
            } else if let Some(twin) = by_number.get(&head.part.shard) {
                problems.push(format!("{place} and {} are both shard {}", twin.display(), head.part));
            } else {
                by_number.insert(head.part.shard, file);
            }
        }
        let is_there = |shard: &usize| {
            let own = |head: &ShardHead| head.digest == study.digest && head.part.shard == *shard;
            by_number.contains_key(shard) || damaged.iter().any(own)
        };
        let name = |shard| ShardHead::file_name(&study.study, Shard { shard, of: study.part.of });
        let missing: Vec<String> = (1..=study.part.of).filter(|shard| !is_there(shard)).map(name).collect();
        if !missing.is_empty() {
            problems.push(format!("missing: {}", in_short(&missing)));
        }
        match problems.is_empty() {
            true => Ok(Shards { files: by_number.into_values().collect() }),
            false => Err(MergeError(problems)),
        }
    }

    /// The files, in the order of their shards.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Writes the rows of all shards under the names of their columns, run by run.
    ///
    /// # Errors
    /// A file can no longer be read, or what is written to fails.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let mut readers = Vec::new();
        for (at, file) in self.files.iter().enumerate() {
            let mut own = RowReader { lines: BufReader::new(File::open(file)?), line: Vec::new() };
            own.next()?;
            own.next()?;
            if at == 0 {
                out.write_all(&own.line)?;
            }
            own.next()?;
            readers.push(own);
        }
        for run in 1.. {
            let count = readers.len();
            let own = &mut readers[(run - 1) % count];
            let mut has_rows = false;
            while own.run() == Some(run) {
                out.write_all(&own.line)?;
                own.next()?;
                has_rows = true;
            }
            if !has_rows {
                break;
            }
        }
        let is_left = readers.iter().position(|own| !own.line.is_empty());
        is_left.map_or(Ok(()), |at| {
            let problem = format!("{}: its runs are not in their order", self.files[at].display());
            Err(io::Error::other(problem))
        })
    }
}

/// The first of many names.
fn in_short(names: &[String]) -> String {
    const SHOWN: usize = 10;
    match names.len() {
        count if count <= SHOWN => names.join(", "),
        count => format!("{} and {} more", names[..SHOWN].join(", "), count - SHOWN),
    }
}

/// Rows of a shard, one after the other.
struct RowReader {
    lines: BufReader<File>,
    /// The row, with its end; empty behind the last one.
    line: Vec<u8>,
}

impl RowReader {
    fn next(&mut self) -> io::Result<()> {
        self.line.clear();
        self.lines.read_until(b'\n', &mut self.line).map(drop)
    }

    /// The number of the row's run.
    fn run(&self) -> Option<usize> {
        let cell = self.line.split(|byte| *byte == b',').next()?;
        std::str::from_utf8(cell).ok()?.parse().ok()
    }
}

/// Files as they are named, and those in folders that are named as shards are.
fn files(places: &[PathBuf]) -> Result<Vec<PathBuf>, MergeError> {
    let mut all = Vec::new();
    for place in places {
        if !place.is_dir() {
            all.push(place.clone());
            continue;
        }
        let entries = std::fs::read_dir(place)
            .map_err(|error| MergeError::one(format!("{}: {error}", place.display())))?;
        let mut own: Vec<PathBuf> =
            entries.flatten().map(|entry| entry.path()).filter(|path| is_named_as_shard(path)).collect();
        own.sort_unstable();
        all.extend(own);
    }
    // The same file under two of the given names is one file.
    let mut seen = std::collections::BTreeSet::new();
    all.retain(|path| seen.insert(path.canonicalize().unwrap_or_else(|_| path.clone())));
    Ok(all)
}

fn is_named_as_shard(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let numbers = name.strip_suffix(".csv").and_then(|name| name.rsplit_once('.')).map(|parts| parts.1);
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    numbers
        .and_then(|own| own.split_once("-of-"))
        .is_some_and(|(shard, of)| is_number(shard) && is_number(of))
}

/// A shard whose first line was read.
enum ReadShard {
    /// Its rows are what the line says.
    Whole(ShardHead),
    /// They are not.
    Damaged(ShardHead),
}

/// The head of a shard, and whether the rest is what it says.
fn read(file: &Path) -> Result<ReadShard, String> {
    if std::fs::metadata(file).is_ok_and(|found| !found.is_file()) {
        return Err("it is no file".to_owned());
    }
    let mut reader = BufReader::new(File::open(file).map_err(|error| error.to_string())?);
    // A first line is short: a file without line ends is no shard.
    let mut line = Vec::new();
    reader.by_ref().take(4096).read_until(b'\n', &mut line).map_err(|error| error.to_string())?;
    let head = std::str::from_utf8(&line).ok().and_then(|line| ShardHead::of_line(line.trim_end()));
    let head = head.ok_or("it is no shard of a study")?;
    let mut hasher = blake3::Hasher::new();
    io::copy(&mut reader, &mut hasher).map_err(|error| error.to_string())?;
    let is_whole = hasher.finalize().to_hex()[..32] == *head.checksum;
    Ok(if is_whole { ReadShard::Whole(head) } else { ReadShard::Damaged(head) })
}
