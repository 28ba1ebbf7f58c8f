//! Masks for values that differ in every execution of a test. All other text is compared unchanged.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Length of a time without fractional seconds: `2026-11-27T13:30:46`.
const TIME_LENGTH: usize = 19;

/// Fields of new lines in `trajectory.jsonl`, `afterwards.jsonl` and `visits.jsonl` whose values depend on the machine
/// or the time.
const LINE_FIELDS: [&str; 10] =
    ["prev", "sum", "machine", "boot", "monotonic_ms", "for_ms", "read_ms", "took_ms", "stood_ms", "used_ms"];

/// Masks for the folder of the test, for times that no recorded run contains, and for IDs of new runs and classes.
#[derive(Default)]
pub struct Masks {
    place: String,
    seconds: BTreeSet<String>,
    ids: BTreeSet<String>,
    new_ids: BTreeMap<String, String>,
    /// Keys whose values are masked, in JSON and TOML.
    pub keys: Vec<String>,
}

impl Masks {
    pub fn new(place: &Path) -> Masks {
        let place = place.display().to_string();
        Masks { place, ..Masks::default() }
    }

    /// Excludes the times in a text from masking.
    pub fn exclude_times(&mut self, text: &str) {
        self.seconds.extend(find_times(text).map(|(_, moment)| moment[..TIME_LENGTH].to_owned()));
    }

    /// Excludes an ID from masking.
    pub fn exclude_id(&mut self, id: &str) {
        self.ids.insert(id.to_owned());
    }

    /// Masks the IDs of new runs below a folder, starting with the oldest run.
    pub fn mask_new_ids(&mut self, below: &Path) {
        let mut new = Vec::new();
        self.collect_new_runs(below, &mut new);
        new.sort();
        for (_, id) in new {
            self.mask_id(&id);
        }
    }

    /// Collects the creation time and the ID of each new run below a folder.
    fn collect_new_runs(&self, below: &Path, found: &mut Vec<(String, String)>) {
        for folder in fs::read_dir(below).into_iter().flatten().flatten().map(|entry| entry.path()) {
            let id = folder.file_name().expect("a name").to_string_lossy().into_owned();
            match fs::read_to_string(folder.join("run.toml")) {
                Ok(_) if self.ids.contains(&id) => {}
                Ok(manifest) => {
                    let created = manifest.lines().find(|line| line.starts_with("created = "));
                    found.push((created.unwrap_or_default().to_owned(), id));
                }
                Err(_) if folder.is_dir() => self.collect_new_runs(&folder, found),
                Err(_) => {}
            }
        }
    }

    /// Masks the IDs of a class and of the runs of its handouts, if the file exists.
    pub fn mask_class_ids(&mut self, file: &Path) {
        let Ok(text) = fs::read_to_string(file) else { return };
        let class: toml::Table = text.parse().expect("a class");
        let students = class["student"].as_array().expect("students").iter().map(|student| &student["run"]);
        let ids = std::iter::once(&class["class"]).chain(students).filter_map(toml::Value::as_str);
        for id in ids.filter(|id| !self.ids.contains(*id)).collect::<Vec<_>>() {
            self.mask_id(id);
        }
    }

    /// Masks an ID as `RUN1`, `RUN2` and so on.
    pub fn mask_id(&mut self, id: &str) {
        let next = format!("RUN{}", self.new_ids.len() + 1);
        self.new_ids.entry(id.to_owned()).or_insert(next);
    }

    /// Returns a text with all masks applied.
    pub fn apply(&self, text: &str) -> String {
        let text = text.replace(&self.place, "HOME");
        let text = self.new_ids.iter().fold(text, |text, (id, mask)| text.replace(id, mask));
        let text = self.mask_times(&text);
        let text = self.keys.iter().fold(text, |text, key| {
            remove_values(remove_values(text, &format!("\"{key}\":")), &format!("\n{key} = "))
        });
        // Recorded lines are not masked. A line is new only if its time is masked.
        let lines = text.split_inclusive('\n');
        lines
            .map(
                |line| if line.contains("\"at\":\"NOW\"") { mask_line_fields(line) } else { line.to_owned() },
            )
            .collect()
    }

    fn mask_times(&self, text: &str) -> String {
        let (mut masked, mut done) = (String::new(), 0);
        for (at, moment) in
            find_times(text).filter(|(_, moment)| !self.seconds.contains(&moment[..TIME_LENGTH]))
        {
            masked.push_str(&text[done..at]);
            masked.push_str("NOW");
            done = at + moment.len();
        }
        masked.push_str(&text[done..]);
        masked
    }
}

/// Returns the RFC 3339 times in a text with their positions.
fn find_times(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let starts = text.match_indices('T').filter_map(|(at, _)| at.checked_sub("0000-00-00".len()));
    starts.filter_map(|at| Some((at, time_at_start(text.get(at..)?)?)))
}

/// Returns the RFC 3339 time at the start of a text, or `None` if the text does not start with a time.
fn time_at_start(text: &str) -> Option<&str> {
    let bytes = text.as_bytes();
    let pattern = b"0000-00-00T00:00:00";
    let fits = |(byte, form): (&u8, &u8)| if *form == b'0' { byte.is_ascii_digit() } else { byte == form };
    if bytes.len() < TIME_LENGTH || !bytes.iter().zip(pattern).all(fits) {
        return None;
    }
    let more = bytes[TIME_LENGTH..].iter().take_while(|byte| byte.is_ascii_digit() || **byte == b'.').count();
    let zone = bytes.get(TIME_LENGTH + more).is_some_and(|byte| *byte == b'Z');
    text.get(..TIME_LENGTH + more + usize::from(zone))
}

/// Returns a new line of a record without the values of `LINE_FIELDS`.
fn mask_line_fields(line: &str) -> String {
    LINE_FIELDS.iter().fold(line.to_owned(), |line, field| remove_values(line, &format!("\"{field}\":")))
}

/// Removes the values of a key from JSON and TOML text.
fn remove_values(mut text: String, key: &str) -> String {
    let mut from = 0;
    while let Some(at) = text[from..].find(key).map(|at| from + at + key.len()) {
        let end = text[at..].find([',', '}', '\n']).map_or(text.len(), |end| at + end);
        text.replace_range(at..end, "MASKED");
        from = at;
    }
    text
}
