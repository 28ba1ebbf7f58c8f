//! The tables of a study without what tells who took part: other labels and names of runs, times since the start of each
//! run, no texts that people wrote, machines under other names.
//!
//! Everything follows from a secret that the experimenter keeps, so tables that are collected later fit. Each run names the
//! hash of the last hash of its sealed original: whoever has the original can show that it is the one.

use std::collections::{BTreeMap, BTreeSet};

use super::tables::{Heading, headings};

/// A table by its name: rows, the names of the columns first.
pub type NamedTable = (String, Vec<Vec<String>>);

/// What becomes of texts that people wrote.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Texts {
    /// Nothing is left of them.
    Dropped,
    /// Their lengths are left.
    Masked,
}

/// Old and new names of a run: for the experimenter alone.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Link {
    /// Label of the participant.
    pub participant: String,
    /// Their new label.
    pub new_participant: String,
    /// Run.
    pub run: String,
    /// Its new name.
    pub new_run: String,
    /// Hash of the last line of the original.
    pub last_hash: String,
    /// Hash of that, as the anonymised table has it.
    pub original: String,
}

/// The columns of the table of links.
pub const LINKS: [&str; 6] = ["participant", "new_participant", "run", "new_run", "last_hash", "original"];

/// Columns that are left out: they tell a person apart by what others know.
const LEFT_OUT: [(&str, &str); 3] = [("runs", "assigned_order"), ("runs", "problem"), ("notes", "digest")];

/// Makes tables anonymous with a secret.
pub struct Anonymiser {
    secret: [u8; 32],
    texts: Texts,
    /// When each run began, nanoseconds since 1970.
    began: BTreeMap<String, i64>,
}

impl Anonymiser {
    /// One with a secret of the experimenter.
    pub fn new(secret: [u8; 32], texts: Texts) -> Anonymiser {
        Anonymiser { secret, texts, began: BTreeMap::new() }
    }

    /// The tables of an export or a collection without what tells who took part, and the links to the originals.
    ///
    /// # Errors
    /// A table or column is missing, or two names would become one.
    pub fn anonymise(&mut self, tables: &[NamedTable]) -> Result<(Vec<NamedTable>, Vec<Link>), String> {
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
            self.began.insert(row[run].clone(), crate::session::nanoseconds_of(&row[created]));
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
            return Err("two names would become one: take another secret".to_owned());
        }
        let mut made = Vec::new();
        let mut described = vec![["table", "column", "unit", "meaning"].map(str::to_owned).to_vec()];
        for (name, columns) in headings() {
            let kept: Vec<Heading> =
                columns.into_iter().filter(|own| !LEFT_OUT.contains(&(name, own.name))).collect();
            described.extend(kept.iter().map(|own| described_column(name, own)));
            made.push((name.to_owned(), self.table(name, &kept, all(name)?)?));
        }
        made.push(("columns".to_owned(), described));
        Ok((made, links))
    }

    fn table(
        &self,
        name: &str,
        columns: &[Heading],
        rows: &[Vec<String>],
    ) -> Result<Vec<Vec<String>>, String> {
        let places = columns.iter().map(|own| place(rows, own.name)).collect::<Result<Vec<_>, _>>()?;
        let mut made = vec![columns.iter().map(|own| new_name(own).to_owned()).collect()];
        for row in &rows[1..] {
            let known: BTreeMap<&str, &str> =
                rows[0].iter().map(String::as_str).zip(row.iter().map(String::as_str)).collect();
            if !self.began.contains_key(known["run"]) {
                // A run that could not be read tells nothing but its name.
                continue;
            }
            let cells = columns.iter().zip(&places);
            made.push(cells.map(|(column, at)| self.cell(name, column, &row[*at], &known)).collect());
        }
        Ok(made)
    }

    fn cell(&self, table: &str, column: &Heading, cell: &str, row: &BTreeMap<&str, &str>) -> String {
        let kind = row.get("kind").copied().unwrap_or_default();
        match (table, column.name) {
            _ if cell.is_empty() => String::new(),
            (_, "participant") => self.label(cell),
            (_, "run" | "parent") => self.run(cell),
            ("events", "which") if kind == "branch" => self.run(cell),
            ("events", "which") if matches!(kind, "note" | "memo") => String::new(),
            ("runs", "last_hash") => original(cell),
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
        let passed = crate::session::nanoseconds_of(at) - self.began.get(run).copied().unwrap_or(0);
        format!("{}", (passed as f64 / 1e6).round() / 1e3 + 0.0)
    }

    /// Machines and starts of them get other names.
    fn detail(&self, detail: &str) -> String {
        let part = |part: &str| match part.split_once('=') {
            Some((name @ ("machine" | "boot"), value)) => format!("{name}={}", self.keyed(name, value, 16)),
            // It counts from when the machine was started.
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

/// Whether an event is a call whose arguments hold no words of a person: a setting or a purchase that was accepted.
fn is_setting(row: &BTreeMap<&str, &str>) -> bool {
    let of = |name: &str| row.get(name).copied().unwrap_or_default();
    let begins = ["set_", "start_research", "research_"].iter().any(|begin| of("what").starts_with(begin));
    of("kind") == "call" && of("value") == "accepted" && begins
}

/// What stands for the sealed original: the hash of its last hash.
fn original(last_hash: &str) -> String {
    blake3::hash(last_hash.as_bytes()).to_hex().to_string()
}

fn new_name(column: &Heading) -> &'static str {
    if column.name == "last_hash" { "original" } else { column.name }
}

fn described_column(table: &str, column: &Heading) -> Vec<String> {
    let (unit, meaning) = match (column.unit, column.name) {
        ("RFC 3339", _) => ("seconds", format!("{}, as seconds since the run began", column.meaning)),
        (unit, "last_hash") => {
            (unit, "BLAKE3 hash of the last hash of the sealed original, as text".to_owned())
        }
        (unit, _) => (unit, column.meaning.to_owned()),
    };
    vec![table.to_owned(), new_name(column).to_owned(), unit.to_owned(), meaning]
}

/// Where a column stands.
fn place(rows: &[Vec<String>], name: &str) -> Result<usize, String> {
    let found = rows.first().and_then(|head| head.iter().position(|own| own == name));
    found.ok_or_else(|| format!("the column {name} is missing: collect the study again with this version"))
}
