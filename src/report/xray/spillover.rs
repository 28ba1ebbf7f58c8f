//! Text for spillover of reputation between groups: a heat map and a table.

use super::reputation::{dropped_in_words, small};
use super::{settled, table};
use novamind_insight::Spillover;
use novamind_session::Spill;
use novamind_session::identifiers::Group;

/// Marks of a heat map, from the smallest share of the largest spillover to the largest.
pub const HEAT: [&str; 4] = ["░", "▒", "▓", "█"];

/// The spillover of a day: rows are sources, columns are targets.
#[derive(Debug, Clone, PartialEq)]
pub struct SpillMap {
    /// Heading.
    pub heading: String,
    /// Columns: target groups.
    pub targets: Vec<Group>,
    /// Rows: source groups.
    pub rows: Vec<SpillRow>,
    /// Dropped changes and other notes.
    pub notes: Vec<String>,
}

/// Effects of a source group.
#[derive(Debug, Clone, PartialEq)]
pub struct SpillRow {
    /// Source group.
    pub from: Group,
    /// Change of its own reputation.
    pub own: String,
    /// Effect on each target.
    pub cells: Vec<SpillCell>,
}

/// Effect of a group on another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SpillCell {
    /// The source has no weight for the target.
    NoWeight,
    /// The effect was too small and was dropped.
    Dropped,
    /// Change of the target's reputation, and the index of its mark in [`HEAT`].
    Heard(f64, usize),
}

impl SpillMap {
    /// Returns the map of a day.
    pub fn of(own: &Spillover) -> SpillMap {
        let Spillover { day, known, spills, .. } = own;
        let heading = format!("changes of reputation on day {day}: rows are sources, columns are targets");
        let sources: Vec<Group> =
            known.iter().copied().filter(|group| own.own[*group].subscribers > 0).collect();
        let heard: Vec<&Spill> = spills.iter().filter(|spill| spill.counts).collect();
        let largest = heard.iter().map(|spill| spill.change.abs()).fold(0.0, f64::max);
        let is_target = |target: &Group| heard.iter().any(|spill| spill.to == *target);
        let targets: Vec<Group> = match sources.is_empty() {
            true => Vec::new(),
            false => known.iter().copied().filter(is_target).collect(),
        };
        let cell = |from: Group, to: Group| match own.between(from, to) {
            Some(spill) if spill.counts => SpillCell::Heard(spill.change, heat(&spill, largest)),
            Some(_) => SpillCell::Dropped,
            None => SpillCell::NoWeight,
        };
        let row = |from: &Group| SpillRow {
            from: *from,
            own: called(own, *from),
            cells: targets.iter().map(|to| cell(*from, *to)).collect(),
        };
        let rows = sources.iter().map(row).collect();
        SpillMap { heading, rows, notes: notes(own, &sources, heard.is_empty()), targets }
    }
}

impl SpillCell {
    /// Formats the cell: a mark and the change.
    pub fn in_words(self) -> String {
        match self {
            SpillCell::NoWeight => "·".to_owned(),
            SpillCell::Dropped => "dropped".to_owned(),
            SpillCell::Heard(change, mark) => format!("{} {change:+.6}", HEAT[mark]),
        }
    }
}

fn called(own: &Spillover, from: Group) -> String {
    let change = &own.own[from];
    match change.counts {
        true => format!("{:+.6}", change.called),
        false => format!("{:+.6} dropped", change.called),
    }
}

fn heat(spill: &Spill, largest: f64) -> usize {
    let share = if largest > 0.0 { spill.change.abs() / largest } else { 0.0 };
    ((share * HEAT.len() as f64).ceil() as usize).clamp(1, HEAT.len()) - 1
}

fn notes(own: &Spillover, sources: &[Group], is_silent: bool) -> Vec<String> {
    if sources.is_empty() {
        return vec!["  no group has subscribers".to_owned()];
    }
    let mut lines = Vec::new();
    if is_silent {
        lines.push("  no spillover".to_owned());
    }
    let small_own: Vec<&str> =
        sources.iter().filter(|group| !own.own[**group].counts).map(|group| group.id()).collect();
    if !small_own.is_empty() {
        lines.push(format!(
            "  own changes of {} below {}: dropped",
            small_own.join(", "),
            small(own.least.own)
        ));
    }
    let dropped: Vec<&Spill> = own.spills.iter().filter(|spill| !spill.counts).collect();
    lines.extend(dropped_in_words(&dropped, &own.least));
    lines
}

/// Returns the spillover of a day as a table in text.
pub fn spillover_in_words(own: &Spillover) -> Vec<String> {
    let SpillMap { heading, targets, rows, notes } = SpillMap::of(own);
    let mut lines = vec![heading];
    if !rows.is_empty() {
        let mut head = vec!["from", "own change"];
        head.extend(targets.iter().map(|group| group.id()));
        let row = |row: &SpillRow| {
            let cells = row.cells.iter().map(|cell| cell.in_words());
            [row.from.to_string(), row.own.clone()].into_iter().chain(cells).collect()
        };
        lines.extend(table(&head, &rows.iter().map(row).collect::<Vec<Vec<String>>>()));
    }
    lines.extend(notes);
    settled(lines)
}
