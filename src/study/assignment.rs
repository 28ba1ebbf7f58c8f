//! `assignment.csv`: assigns a condition, a seed and a position to each participant.

use std::collections::BTreeSet;
use std::path::Path;

use novamind_record::error::RunError;
use novamind_record::files::read_if_exists;
use novamind_record::folder::runs::participant_folder;
use novamind_world::params::ParameterError;

/// Name of the assignment file in the folder of a study.
pub const ASSIGNMENT_FILE: &str = "assignment.csv";

/// The assignment of all participants of a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Assignment {
    /// One row per participant, in the order of the file.
    pub rows: Vec<AssignmentRow>,
}

/// The condition, seed and position that are assigned to a participant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AssignmentRow {
    /// Label of the participant.
    pub label: String,
    /// Condition of the participant; `None` if the study has no conditions.
    pub condition: Option<String>,
    /// Seed of the session; `None` if all participants play the same seed.
    pub seed: Option<u64>,
    /// Position of the participant in the assignment, from 1.
    pub order: u32,
}

/// Columns of `assignment.csv`.
const COLUMNS: [&str; 4] = ["label", "condition", "seed", "order"];

impl Assignment {
    /// Reads the assignment in the folder of a study. Returns `None` if the file does not exist.
    ///
    /// # Errors
    /// Returns an error that names the line if a line is invalid or a label occurs twice.
    pub fn read(folder: &Path) -> Result<Option<Assignment>, RunError> {
        let path = folder.join(ASSIGNMENT_FILE);
        let parse = |bytes: Vec<u8>| Assignment::parse(&path.display().to_string(), &bytes);
        Ok(read_if_exists(&path)?.map(parse).transpose()?)
    }

    /// Parses the contents of `assignment.csv`. `source` is the name of the file in error messages.
    ///
    /// # Errors
    /// Returns the errors of [`Assignment::read`] except I/O errors.
    pub fn parse(source: &str, bytes: &[u8]) -> Result<Assignment, ParameterError> {
        let wrong = |line: usize, key: &str, problem: String| ParameterError {
            source: source.to_owned(),
            line: Some(line),
            key: key.to_owned(),
            problem,
        };
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(bytes);
        let header = reader.headers().map_err(|error| wrong(1, "", error.to_string()))?.clone();
        if header.iter().ne(COLUMNS) {
            return Err(wrong(1, "", format!("the first line must be {}", COLUMNS.join(","))));
        }
        let (mut places, mut known) = (Vec::new(), BTreeSet::new());
        for record in reader.records() {
            let line_of = |position: Option<&csv::Position>| position.map_or(1, |at| at.line() as usize);
            let record = record.map_err(|error| wrong(line_of(error.position()), "", error.to_string()))?;
            let line = line_of(record.position());
            let cell = |at: usize| record.get(at).unwrap_or_default();
            let label = cell(0).to_owned();
            participant_folder(Path::new(""), &label).map_err(|problem| wrong(line, "label", problem))?;
            if !known.insert(label.clone()) {
                return Err(wrong(line, "label", format!("{label} occurs twice")));
            }
            let whole = |at: usize| match cell(at) {
                "" => Ok(None),
                text => text
                    .parse::<u64>()
                    .map(Some)
                    .map_err(|_| wrong(line, COLUMNS[at], format!("{text:?} is not a whole number"))),
            };
            let order = whole(3)?.unwrap_or(places.len() as u64 + 1) as u32;
            let condition = Some(cell(1)).filter(|text| !text.is_empty()).map(str::to_owned);
            places.push(AssignmentRow { label, condition, seed: whole(2)?, order });
        }
        Ok(Assignment { rows: places })
    }

    /// Returns the row of the participant with this label.
    pub fn row_for(&self, label: &str) -> Option<&AssignmentRow> {
        self.rows.iter().find(|place| place.label == label)
    }

    /// Returns the seeds of all participants in ascending order, each once.
    pub fn seeds(&self) -> Vec<u64> {
        self.rows.iter().filter_map(|row| row.seed).collect::<BTreeSet<u64>>().into_iter().collect()
    }

    /// Returns the contents of `assignment.csv`.
    pub fn to_csv(&self) -> String {
        let line = |place: &AssignmentRow| {
            let seed = place.seed.map_or(String::new(), |seed| seed.to_string());
            format!(
                "{},{},{seed},{}\n",
                place.label,
                place.condition.as_deref().unwrap_or_default(),
                place.order
            )
        };
        let lines: String = self.rows.iter().map(line).collect();
        format!("{}\n{lines}", COLUMNS.join(","))
    }

    /// Assigns the cells of a design to labels. Each block of participants contains every cell once, in a
    /// random order that depends on the seed `draw`.
    pub fn randomize_in_blocks(
        labels: &[String],
        seeds: &[u64],
        conditions: &[String],
        draw: u64,
    ) -> Assignment {
        let conditions: Vec<Option<String>> = match conditions {
            [] => vec![None],
            some => some.iter().cloned().map(Some).collect(),
        };
        let cell = |condition: &Option<String>| {
            let condition = condition.clone();
            seeds.iter().map(move |seed| (condition.clone(), Some(*seed))).collect::<Vec<_>>()
        };
        let cells: Vec<(Option<String>, Option<u64>)> = conditions.iter().flat_map(cell).collect();
        let places = labels.chunks(cells.len().max(1)).enumerate().flat_map(|(block, labels)| {
            let order = shuffled_indexes(cells.len(), draw, block as u64);
            let cells = &cells;
            labels
                .iter()
                .enumerate()
                .map(move |(at, label)| {
                    let (condition, seed) = cells.get(order[at]).cloned().unwrap_or_default();
                    let order = (block * cells.len() + at + 1) as u32;
                    AssignmentRow { label: label.clone(), condition, seed, order }
                })
                .collect::<Vec<_>>()
        });
        Assignment { rows: places.collect() }
    }
}

/// Returns the numbers below `count` in a random order for a block. The order is derived from a keyed hash,
/// so it is the same on every machine.
fn shuffled_indexes(count: usize, draw: u64, block: u64) -> Vec<usize> {
    let key = |at: usize| {
        let drawn = [draw.to_le_bytes(), block.to_le_bytes(), (at as u64).to_le_bytes()].concat();
        *blake3::hash(&blake3::derive_key("novamind block randomisation", &drawn)).as_bytes()
    };
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|at| key(*at));
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn randomized_assignment_is_balanced_and_round_trips_through_csv() {
        let labels: Vec<String> = (1..=13).map(|number| format!("P{number:02}")).collect();
        let conditions = ["control".to_owned(), "advice".to_owned()];
        let made = Assignment::randomize_in_blocks(&labels, &[3, 5, 8], &conditions, 7);
        assert_eq!(made, Assignment::randomize_in_blocks(&labels, &[3, 5, 8], &conditions, 7));
        assert_ne!(made, Assignment::randomize_in_blocks(&labels, &[3, 5, 8], &conditions, 8));
        for block in made.rows.chunks(6).filter(|block| block.len() == 6) {
            let cells: BTreeSet<_> = block.iter().map(|place| (&place.condition, place.seed)).collect();
            assert_eq!(cells.len(), 6);
        }
        let read = Assignment::parse("assignment.csv", made.to_csv().as_bytes()).expect("it reads");
        assert_eq!(read, made);
        assert_eq!(read.row_for("P13").expect("a place").order, 13);
        assert_eq!(read.row_for("P14"), None);
    }

    #[test]
    fn assignment_parse_errors_name_the_line() {
        for (text, part) in [
            ("label,seed\nP1,3\n", "line 1"),
            ("label,condition,seed,order\nP1,,3,1\nP1,,4,2\n", "line 3"),
            ("label,condition,seed,order\nP1,,three,1\n", "line 2"),
            ("label,condition,seed,order\n../x,,3,1\n", "line 2"),
        ] {
            let error = Assignment::parse("assignment.csv", text.as_bytes()).expect_err(text).to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}
