//! Anonymized tables of a study: new labels and run names, times relative to the start of each run, no texts written
//! by people, and renamed machines.
//!
//! All new names derive from a secret that the experimenter keeps, so tables collected later are consistent. Each run
//! contains the hash of its sealed original's last hash. Anyone who has the original can prove that it belongs to the
//! run.

use std::collections::{BTreeMap, BTreeSet};

use super::tables::{Heading, headings};

/// A table's name and rows; the first row is the header.
pub type NamedTable = (String, Vec<Vec<String>>);

/// Treatment of texts written by people.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Texts {
    /// Removes them.
    Dropped,
    /// Replaces them with their length in characters.
    Masked,
}

/// Old and new names of a run, for the experimenter only.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Link {
    /// Label of the participant.
    pub participant: String,
    /// Their new label.
    pub new_participant: String,
    /// Run ID.
    pub run: String,
    /// New run ID.
    pub new_run: String,
    /// Hash of the last line of the original.
    pub last_hash: String,
    /// Hash of `last_hash`, as in the anonymized table.
    pub original: String,
}

/// Column names of the table of links.
pub const LINKS: [&str; 6] = ["participant", "new_participant", "run", "new_run", "last_hash", "original"];

// People who know a participant could identify them by these columns.
const LEFT_OUT: [(&str, &str); 4] =
    [("runs", "assigned_order"), ("runs", "problem"), ("notes", "digest"), ("visits", "folder")];

// Columns that describe a session's design. Rare combinations can identify a participant.
const DESIGN: [&str; 2] = ["seed", "condition"];

/// Columns that join the tables.
const NEEDED: [&str; 2] = ["run", "participant"];

/// The result of anonymization.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Anonymous {
    /// The tables.
    pub tables: Vec<NamedTable>,
    /// The links to the originals.
    pub links: Vec<Link>,
    /// Size and shared values of the smallest group of sessions with the same seed and condition, as far as
    /// these columns are kept.
    /// `None` if neither is kept or no session exists.
    pub smallest_group: Option<(usize, String)>,
}

/// Replaces identifying values, keyed by a secret.
pub struct Anonymiser {
    secret: [u8; 32],
    texts: Texts,
    /// Columns to omit in addition to `LEFT_OUT`.
    without: Vec<String>,
    /// Start of each run, in nanoseconds since 1970.
    began: BTreeMap<String, i64>,
    /// First use of each label, in nanoseconds since 1970.
    came: BTreeMap<String, i64>,
}

impl Anonymiser {
    /// Returns an anonymizer that also omits the columns `without` from every table.
    pub fn new(secret: [u8; 32], texts: Texts, without: Vec<String>) -> Anonymiser {
        Anonymiser { secret, texts, without, began: BTreeMap::new(), came: BTreeMap::new() }
    }

    /// Returns the anonymized tables of an export or a collection, and the links to the originals.
    ///
    /// # Errors
    /// Returns an error if a table or column is missing, or if two names would become the same.
    pub fn anonymise(&mut self, tables: &[NamedTable]) -> Result<Anonymous, String> {
        let all = |name: &str| {
            let found = tables.iter().find(|(own, _)| own == name).map(|(_, rows)| rows.as_slice());
            found.filter(|rows| !rows.is_empty()).ok_or_else(|| format!("the table {name}.csv is missing"))
        };
        let runs = all("runs")?;
        let [run, participant, created, last] =
            ["run", "participant", "created", "last_hash"].map(|name| place(runs, name));
        let (run, participant, created, last) = (run?, participant?, created?, last?);
        let mut links = Vec::new();
        for row in runs.iter().skip(1).filter(|row| !row[created].is_empty()) {
            self.began.insert(row[run].clone(), novamind_record::clock::nanoseconds(&row[created]));
            links.push(Link {
                participant: row[participant].clone(),
                new_participant: self.label(&row[participant]),
                run: row[run].clone(),
                new_run: self.run(&row[run]),
                last_hash: row[last].clone(),
                original: original(&row[last]),
            });
        }
        let distinct = |of: fn(&Link) -> &String| links.iter().map(of).collect::<BTreeSet<_>>().len();
        if distinct(|link| &link.participant) != distinct(|link| &link.new_participant)
            || distinct(|link| &link.run) != distinct(|link| &link.new_run)
        {
            return Err("two names would become the same; use a different secret".to_owned());
        }
        links.sort_by(|one: &Link, other| {
            (&one.new_participant, &one.new_run).cmp(&(&other.new_participant, &other.new_run))
        });
        self.note_visits(all("visits")?)?;
        let mut made = Vec::new();
        let mut described = vec![["table", "column", "unit", "meaning"].map(str::to_owned).to_vec()];
        for (name, columns) in headings() {
            let kept: Vec<Heading> =
                columns.into_iter().filter(|own| !self.leaves_out(name, &own.name)).collect();
            described.extend(kept.iter().map(|own| described_column(name, own)));
            made.push((name.to_owned(), self.table(name, &kept, all(name)?)?));
        }
        made.push(("columns".to_owned(), described));
        let smallest_group = self.smallest_group(runs)?;
        Ok(Anonymous { tables: made, links, smallest_group })
    }

    fn leaves_out(&self, table: &str, column: &str) -> bool {
        LEFT_OUT.contains(&(table, column)) || self.without.iter().any(|own| own == column)
    }

    /// Checks that the columns to omit exist and that no table needs them.
    ///
    /// # Errors
    /// Names the first column that does not exist or that joins the tables.
    pub fn check_left_out(&self) -> Result<(), String> {
        let known = |name: &str| headings().iter().any(|(_, own)| own.iter().any(|own| own.name == *name));
        for name in &self.without {
            if NEEDED.contains(&name.as_str()) {
                return Err(format!("{name} cannot be left out: it joins the tables"));
            }
            if !known(name) {
                return Err(format!("no table has a column {name}; `novamind runs columns` lists them"));
            }
        }
        Ok(())
    }

    fn note_visits(&mut self, rows: &[Vec<String>]) -> Result<(), String> {
        let (label, at) = (place(rows, "participant")?, place(rows, "at")?);
        for row in rows.iter().skip(1).filter(|row| !row[label].is_empty()) {
            let moment = novamind_record::clock::nanoseconds(&row[at]);
            self.came.entry(row[label].clone()).and_modify(|own| *own = moment.min(*own)).or_insert(moment);
        }
        Ok(())
    }

    fn smallest_group(&self, runs: &[Vec<String>]) -> Result<Option<(usize, String)>, String> {
        let left: Vec<&str> = DESIGN.into_iter().filter(|name| !self.leaves_out("runs", name)).collect();
        if left.is_empty() {
            return Ok(None);
        }
        let places = left.iter().map(|name| place(runs, name)).collect::<Result<Vec<_>, _>>()?;
        let (created, practice) = (place(runs, "created")?, place(runs, "practice")?);
        let mut groups: BTreeMap<String, usize> = BTreeMap::new();
        for row in runs.iter().skip(1).filter(|row| !row[created].is_empty() && row[practice] != "1") {
            let values = left.iter().zip(&places).map(|(name, at)| format!("{name} {}", row[*at]));
            *groups.entry(values.collect::<Vec<_>>().join(", ")).or_default() += 1;
        }
        Ok(groups.into_iter().map(|(values, size)| (size, values)).min())
    }

    fn table(
        &self,
        name: &str,
        columns: &[Heading],
        rows: &[Vec<String>],
    ) -> Result<Vec<Vec<String>>, String> {
        let places = columns.iter().map(|own| place(rows, &own.name)).collect::<Result<Vec<_>, _>>()?;
        let mut made = Vec::new();
        for row in &rows[1..] {
            let known: BTreeMap<&str, &str> =
                rows[0].iter().map(String::as_str).zip(row.iter().map(String::as_str)).collect();
            if known.get("run").is_some_and(|run| !self.began.contains_key(*run)) {
                // A run that could not be read has only a name.
                continue;
            }
            let cells = columns.iter().zip(&places);
            let cells = cells.map(|(column, at)| self.cell(name, column, &row[*at], &known));
            let of = |name: &str| known.get(name).copied().unwrap_or_default();
            made.push(((self.label(of("participant")), self.run(of("run"))), cells.collect()));
        }
        // The original order reveals when participants came. Lines within a run keep theirs.
        made.sort_by(|one: &((String, String), Vec<String>), other| one.0.cmp(&other.0));
        let head = columns.iter().map(|own| new_name(own).to_owned()).collect();
        Ok(std::iter::once(head).chain(made.into_iter().map(|(_, row)| row)).collect())
    }

    fn cell(&self, table: &str, column: &Heading, cell: &str, row: &BTreeMap<&str, &str>) -> String {
        let kind = row.get("kind").copied().unwrap_or_default();
        match (table, &*column.name) {
            _ if cell.is_empty() => String::new(),
            (_, "participant") => self.label(cell),
            (_, "run" | "parent") => self.run(cell),
            ("events", "which") if kind == "branch" => self.run(cell),
            ("events", "which") if matches!(kind, "note" | "memo") => String::new(),
            ("runs", "last_hash") => original(cell),
            ("visits", "at") => since(self.came.get(row["participant"]), cell),
            ("visits", "machine") => self.keyed("machine", cell, 16),
            ("events", "value") if kind == "start" && self.leaves_out("runs", "seed") => String::new(),
            _ if column.unit == "RFC 3339" => self.since_start(row["run"], cell),
            ("events", "detail") => self.detail(cell),
            ("events", "text") if kind == "question" || is_setting(row) => cell.to_owned(),
            ("events", "text") | ("notes", "text") => self.text(cell),
            ("events", "value") if kind == "answer" && cell.parse::<f64>().is_err() => self.text(cell),
            ("answers", "value") if row["form"] == "text" => self.text(cell),
            ("queries", "sql") if row["via"] == "library" => cell.to_owned(),
            ("queries", "sql" | "message") => self.text(cell),
            _ => cell.to_owned(),
        }
    }

    fn text(&self, text: &str) -> String {
        match self.texts {
            Texts::Dropped => String::new(),
            Texts::Masked => format!("[{} characters]", text.chars().count()),
        }
    }

    fn since_start(&self, run: &str, at: &str) -> String {
        since(self.began.get(run), at)
    }

    fn detail(&self, detail: &str) -> String {
        let part = |part: &str| match part.split_once('=') {
            Some((name @ ("machine" | "boot"), value)) => format!("{name}={}", self.keyed(name, value, 16)),
            // It counts from the start of the machine.
            Some(("monotonic_ms", _)) => "monotonic_ms=".to_owned(),
            _ => part.to_owned(),
        };
        detail.split(';').map(part).collect::<Vec<_>>().join(";")
    }

    fn label(&self, label: &str) -> String {
        if label.is_empty() { String::new() } else { format!("A{}", self.keyed("label", label, 8)) }
    }

    fn run(&self, run: &str) -> String {
        self.keyed("run", run, 8)
    }

    fn keyed(&self, what: &str, name: &str, digits: usize) -> String {
        let hash = blake3::keyed_hash(&self.secret, format!("{what}\n{name}").as_bytes());
        hash.to_hex()[..digits].to_owned()
    }
}

/// Returns whether an event is an accepted setting or purchase, whose arguments contain no free text.
fn is_setting(row: &BTreeMap<&str, &str>) -> bool {
    let of = |name: &str| row.get(name).copied().unwrap_or_default();
    let begins = ["set_", "start_research", "research_"].iter().any(|begin| of("what").starts_with(begin));
    of("kind") == "call" && of("value") == "accepted" && begins
}

/// Returns the seconds from `began`, in nanoseconds since 1970, to `at`; empty if `began` is `None`.
fn since(began: Option<&i64>, at: &str) -> String {
    began.map_or(String::new(), |began| {
        let passed = novamind_record::clock::nanoseconds(at) - began;
        format!("{}", (passed as f64 / 1e6).round() / 1e3 + 0.0)
    })
}

fn original(last_hash: &str) -> String {
    blake3::hash(last_hash.as_bytes()).to_hex().to_string()
}

fn new_name(column: &Heading) -> &str {
    if column.name == "last_hash" { "original" } else { &column.name }
}

fn described_column(table: &str, column: &Heading) -> Vec<String> {
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
    vec![table.to_owned(), new_name(column).to_owned(), unit.to_owned(), meaning]
}

fn place(rows: &[Vec<String>], name: &str) -> Result<usize, String> {
    let found = rows.first().and_then(|head| head.iter().position(|own| own == name));
    found.ok_or_else(|| format!("the column {name} is missing: use this version to collect the study again"))
}
