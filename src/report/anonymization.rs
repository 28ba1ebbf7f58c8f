//! Anonymized tables of a study. Labels, runs and machines are renamed, times are relative to the start of each run,
//! and texts written by people are removed or masked.
//!
//! New names are derived from a secret that the experimenter keeps, so that tables collected later have the same names.
//! For each run, the table of runs contains a hash of the last hash in the sealed original. Anyone who has an original
//! can therefore prove which run it belongs to.

use std::collections::{BTreeMap, BTreeSet};

use super::tables::{ColumnHeading, table_headings};

/// A table's name and rows; the first row is the header.
pub type NamedTable = (String, Vec<Vec<String>>);

/// What happens to texts written by people.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextHandling {
    /// Removes texts written by people.
    Dropped,
    /// Replaces each text with its length in characters.
    Masked,
}

/// Old and new names of a run, for the experimenter only.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunLink {
    /// Original label of the participant.
    pub participant: String,
    /// New label of the participant.
    pub new_participant: String,
    /// Original ID of the run.
    pub run: String,
    /// New ID of the run.
    pub new_run: String,
    /// Hash of the last line of the original trajectory.
    pub last_hash: String,
    /// Hash of `last_hash`, as shown in the anonymized table.
    pub original: String,
}

/// Column names of the table that links runs to their originals.
pub const LINK_COLUMNS: [&str; 6] =
    ["participant", "new_participant", "run", "new_run", "last_hash", "original"];

// Columns that could identify a participant to someone who knows this person.
const IDENTIFYING_COLUMNS: [(&str, &str); 4] =
    [("runs", "assigned_order"), ("runs", "problem"), ("notes", "digest"), ("visits", "folder")];

// Columns that describe the design of a session. A rare combination of their values can identify a participant.
const DESIGN_COLUMNS: [&str; 2] = ["seed", "condition"];

/// Columns that join the tables, so they cannot be omitted.
const REQUIRED_COLUMNS: [&str; 2] = ["run", "participant"];

/// Anonymized tables, and the links to the original runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AnonymizedTables {
    /// All tables of the input, with new names and without identifying columns.
    pub tables: Vec<NamedTable>,
    /// Old and new name of every run, for the experimenter only.
    pub links: Vec<RunLink>,
    /// The smallest group of sessions with the same seed and condition: its size, and these values. Ignores omitted
    /// columns. `None` if both columns are omitted or there is no session.
    pub smallest_group: Option<(usize, String)>,
}

/// Replaces identifying values with names that are derived from a secret.
pub struct Anonymizer {
    secret: [u8; 32],
    texts: TextHandling,
    /// Columns to omit in addition to `IDENTIFYING_COLUMNS`.
    omitted_columns: Vec<String>,
    /// Start of each run, in nanoseconds since the Unix epoch.
    run_starts: BTreeMap<String, i64>,
    /// First use of each label, in nanoseconds since the Unix epoch.
    first_visits: BTreeMap<String, i64>,
}

impl Anonymizer {
    /// Returns an anonymizer that omits the columns `without` from every table, in addition to `IDENTIFYING_COLUMNS`.
    pub fn new(secret: [u8; 32], texts: TextHandling, without: Vec<String>) -> Anonymizer {
        Anonymizer {
            secret,
            texts,
            omitted_columns: without,
            run_starts: BTreeMap::new(),
            first_visits: BTreeMap::new(),
        }
    }

    /// Returns the anonymized tables of an export or a collection, and the links to the originals.
    ///
    /// # Errors
    /// Returns an error if a table or column is missing, or if two names would get the same new name.
    pub fn anonymize(&mut self, tables: &[NamedTable]) -> Result<AnonymizedTables, String> {
        let all = |name: &str| {
            let found = tables.iter().find(|(text, _)| text == name).map(|(_, rows)| rows.as_slice());
            found.filter(|rows| !rows.is_empty()).ok_or_else(|| format!("the table {name}.csv is missing"))
        };
        let runs = all("runs")?;
        let [run, participant, created, last] =
            ["run", "participant", "created", "last_hash"].map(|name| column_index(runs, name));
        let (run, participant, created, last) = (run?, participant?, created?, last?);
        let mut links = Vec::new();
        for row in runs.iter().skip(1).filter(|row| !row[created].is_empty()) {
            self.run_starts
                .insert(row[run].clone(), novamind_record::clock::parse_nanoseconds(&row[created]));
            links.push(RunLink {
                participant: row[participant].clone(),
                new_participant: self.new_label(&row[participant]),
                run: row[run].clone(),
                new_run: self.new_run_name(&row[run]),
                last_hash: row[last].clone(),
                original: original_hash(&row[last]),
            });
        }
        let distinct = |of: fn(&RunLink) -> &String| links.iter().map(of).collect::<BTreeSet<_>>().len();
        if distinct(|link| &link.participant) != distinct(|link| &link.new_participant)
            || distinct(|link| &link.run) != distinct(|link| &link.new_run)
        {
            return Err("two names would become the same; use a different secret".to_owned());
        }
        links.sort_by(|one: &RunLink, other| {
            (&one.new_participant, &one.new_run).cmp(&(&other.new_participant, &other.new_run))
        });
        self.record_first_visits(all("visits")?)?;
        let mut made = Vec::new();
        let mut described = vec![["table", "column", "unit", "meaning"].map(str::to_owned).to_vec()];
        for (name, columns) in table_headings() {
            let kept: Vec<ColumnHeading> = columns
                .into_iter()
                .filter(|column_heading| !self.is_omitted(name, &column_heading.name))
                .collect();
            described.extend(kept.iter().map(|heading| column_description(name, heading)));
            made.push((name.to_owned(), self.anonymize_table(name, &kept, all(name)?)?));
        }
        made.push(("columns".to_owned(), described));
        let smallest_group = self.smallest_group(runs)?;
        Ok(AnonymizedTables { tables: made, links, smallest_group })
    }

    fn is_omitted(&self, table: &str, column: &str) -> bool {
        IDENTIFYING_COLUMNS.contains(&(table, column))
            || self.omitted_columns.iter().any(|text| text == column)
    }

    /// Checks that the columns to omit exist and are not needed to join tables.
    ///
    /// # Errors
    /// Returns an error that names the first column that does not exist or joins tables.
    pub fn check_omitted_columns(&self) -> Result<(), String> {
        let known = |name: &str| {
            table_headings().iter().any(|(_, column_headings)| {
                column_headings.iter().any(|column_heading| column_heading.name == *name)
            })
        };
        for name in &self.omitted_columns {
            if REQUIRED_COLUMNS.contains(&name.as_str()) {
                return Err(format!("{name} cannot be left out: it joins the tables"));
            }
            if !known(name) {
                return Err(format!("no table has a column {name}; `novamind runs columns` lists them"));
            }
        }
        Ok(())
    }

    fn record_first_visits(&mut self, rows: &[Vec<String>]) -> Result<(), String> {
        let (label, at) = (column_index(rows, "participant")?, column_index(rows, "at")?);
        for row in rows.iter().skip(1).filter(|row| !row[label].is_empty()) {
            let moment = novamind_record::clock::parse_nanoseconds(&row[at]);
            self.first_visits
                .entry(row[label].clone())
                .and_modify(|number| *number = moment.min(*number))
                .or_insert(moment);
        }
        Ok(())
    }

    fn smallest_group(&self, runs: &[Vec<String>]) -> Result<Option<(usize, String)>, String> {
        let left: Vec<&str> =
            DESIGN_COLUMNS.into_iter().filter(|name| !self.is_omitted("runs", name)).collect();
        if left.is_empty() {
            return Ok(None);
        }
        let places = left.iter().map(|name| column_index(runs, name)).collect::<Result<Vec<_>, _>>()?;
        let (created, practice) = (column_index(runs, "created")?, column_index(runs, "practice")?);
        let mut groups: BTreeMap<String, usize> = BTreeMap::new();
        for row in runs.iter().skip(1).filter(|row| !row[created].is_empty() && row[practice] != "1") {
            let values = left.iter().zip(&places).map(|(name, at)| format!("{name} {}", row[*at]));
            *groups.entry(values.collect::<Vec<_>>().join(", ")).or_default() += 1;
        }
        Ok(groups.into_iter().map(|(values, size)| (size, values)).min())
    }

    fn anonymize_table(
        &self,
        name: &str,
        columns: &[ColumnHeading],
        rows: &[Vec<String>],
    ) -> Result<Vec<Vec<String>>, String> {
        let places = columns
            .iter()
            .map(|column_heading| column_index(rows, &column_heading.name))
            .collect::<Result<Vec<_>, _>>()?;
        let mut made = Vec::new();
        for row in &rows[1..] {
            let known: BTreeMap<&str, &str> =
                rows[0].iter().map(String::as_str).zip(row.iter().map(String::as_str)).collect();
            if known.get("run").is_some_and(|run| !self.run_starts.contains_key(*run)) {
                // Rows of runs that could not be read are omitted.
                continue;
            }
            let cells = columns.iter().zip(&places);
            let cells = cells.map(|(column, at)| self.anonymize_cell(name, column, &row[*at], &known));
            let of = |name: &str| known.get(name).copied().unwrap_or_default();
            made.push(((self.new_label(of("participant")), self.new_run_name(of("run"))), cells.collect()));
        }
        // Rows are sorted by new label and run, because the original order shows when participants played. Within a
        // run, the order is kept.
        made.sort_by(|one: &((String, String), Vec<String>), other| one.0.cmp(&other.0));
        let head = columns.iter().map(|heading| anonymized_column_name(heading).to_owned()).collect();
        Ok(std::iter::once(head).chain(made.into_iter().map(|(_, row)| row)).collect())
    }

    fn anonymize_cell(
        &self,
        table: &str,
        column: &ColumnHeading,
        cell: &str,
        row: &BTreeMap<&str, &str>,
    ) -> String {
        let kind = row.get("kind").copied().unwrap_or_default();
        match (table, &*column.name) {
            _ if cell.is_empty() => String::new(),
            (_, "participant") => self.new_label(cell),
            (_, "run" | "parent") => self.new_run_name(cell),
            ("events", "which") if kind == "branch" => self.new_run_name(cell),
            ("events", "which") if matches!(kind, "note" | "memo") => String::new(),
            ("runs", "last_hash") => original_hash(cell),
            ("visits", "at") => seconds_between(self.first_visits.get(row["participant"]), cell),
            ("visits", "machine") => self.keyed_name("machine", cell, 16),
            ("events", "value") if kind == "start" && self.is_omitted("runs", "seed") => String::new(),
            _ if column.unit == "RFC 3339" => self.seconds_since_run_start(row["run"], cell),
            ("events", "detail") => self.anonymize_detail(cell),
            ("events", "text") if kind == "question" || is_setting(row) => cell.to_owned(),
            ("events", "text") | ("notes", "text") => self.mask_text(cell),
            ("events", "value") if kind == "answer" && cell.parse::<f64>().is_err() => self.mask_text(cell),
            ("answers", "value") if row["form"] == "text" => self.mask_text(cell),
            ("queries", "sql") if row["via"] == "library" => cell.to_owned(),
            ("queries", "sql" | "message") => self.mask_text(cell),
            _ => cell.to_owned(),
        }
    }

    fn mask_text(&self, text: &str) -> String {
        match self.texts {
            TextHandling::Dropped => String::new(),
            TextHandling::Masked => format!("[{} characters]", text.chars().count()),
        }
    }

    fn seconds_since_run_start(&self, run: &str, at: &str) -> String {
        seconds_between(self.run_starts.get(run), at)
    }

    fn anonymize_detail(&self, detail: &str) -> String {
        let part = |part: &str| match part.split_once('=') {
            Some((name @ ("machine" | "boot"), value)) => {
                format!("{name}={}", self.keyed_name(name, value, 16))
            }
            // The value would show when the computer was started.
            Some(("monotonic_ms", _)) => "monotonic_ms=".to_owned(),
            _ => part.to_owned(),
        };
        detail.split(';').map(part).collect::<Vec<_>>().join(";")
    }

    fn new_label(&self, label: &str) -> String {
        if label.is_empty() { String::new() } else { format!("A{}", self.keyed_name("label", label, 8)) }
    }

    fn new_run_name(&self, run: &str) -> String {
        self.keyed_name("run", run, 8)
    }

    fn keyed_name(&self, what: &str, name: &str, digits: usize) -> String {
        let hash = blake3::keyed_hash(&self.secret, format!("{what}\n{name}").as_bytes());
        hash.to_hex()[..digits].to_owned()
    }
}

/// Returns whether an event is an accepted setting or purchase. The arguments of such an event contain no free text.
fn is_setting(row: &BTreeMap<&str, &str>) -> bool {
    let of = |name: &str| row.get(name).copied().unwrap_or_default();
    let begins = ["set_", "start_research", "research_"].iter().any(|begin| of("what").starts_with(begin));
    of("kind") == "call" && of("value") == "accepted" && begins
}

/// Returns the number of seconds from `began` to `at` as text. `began` is in nanoseconds since the Unix epoch. Returns
/// an empty text if `began` is `None`.
fn seconds_between(began: Option<&i64>, at: &str) -> String {
    began.map_or(String::new(), |began| {
        let passed = novamind_record::clock::parse_nanoseconds(at) - began;
        format!("{}", (passed as f64 / 1e6).round() / 1e3 + 0.0)
    })
}

fn original_hash(last_hash: &str) -> String {
    blake3::hash(last_hash.as_bytes()).to_hex().to_string()
}

fn anonymized_column_name(column: &ColumnHeading) -> &str {
    if column.name == "last_hash" { "original" } else { &column.name }
}

fn column_description(table: &str, column: &ColumnHeading) -> Vec<String> {
    let (unit, meaning) = match (column.unit, &*column.name) {
        ("RFC 3339", _) if table == "visits" => {
            ("seconds", format!("{}, as seconds since the first use of the label", column.meaning))
        }
        ("RFC 3339", _) => ("seconds", format!("{}, as seconds since the run began", column.meaning)),
        (unit, "last_hash") => {
            (unit, "BLAKE3 hash of the last hash of the sealed original, as text".to_owned())
        }
        (unit, _) => (unit, column.meaning.to_owned()),
    };
    vec![table.to_owned(), anonymized_column_name(column).to_owned(), unit.to_owned(), meaning]
}

fn column_index(rows: &[Vec<String>], name: &str) -> Result<usize, String> {
    let found = rows.first().and_then(|head| head.iter().position(|text| text == name));
    found.ok_or_else(|| format!("the column {name} is missing: use this version to collect the study again"))
}
