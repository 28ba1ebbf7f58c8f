//! Texts for the spillover of reputation between groups: a heat map and a table.

use super::reputation::{describe_dropped_spillovers, format_small};
use super::{clean_up_numbers, indented_table};
use novamind_insight::Spillover;
use novamind_session::SpilloverEffect;
use novamind_session::identifiers::Group;

/// Marks of a heat map, from the smallest to the largest spillover.
pub const HEAT_MARKS: [&str; 4] = ["░", "▒", "▓", "█"];

/// The spillovers of a day. Rows are source groups, and columns are target groups.
#[derive(Debug, Clone, PartialEq)]
pub struct SpilloverMap {
    /// Heading of the map, with the day.
    pub heading: String,
    /// Target groups, one per column.
    pub targets: Vec<Group>,
    /// Rows of the map, one per source group.
    pub rows: Vec<SpilloverRow>,
    /// Notes below the map, such as those on dropped changes.
    pub notes: Vec<String>,
}

/// Effects of one source group on all target groups.
#[derive(Debug, Clone, PartialEq)]
pub struct SpilloverRow {
    /// Group whose reputation change spreads to other groups.
    pub from: Group,
    /// Change of the source group's reputation that does not come from other groups, as text.
    pub own_change: String,
    /// Effects on the target groups, in the order of the columns.
    pub cells: Vec<SpilloverCell>,
}

/// Effect of a source group on a target group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SpilloverCell {
    /// The source group has no influence on the target group.
    NoWeight,
    /// The effect was below the threshold and was dropped.
    Dropped,
    /// Change of the target group's reputation, and the index of its mark in [`HEAT_MARKS`].
    Applied(f64, usize),
}

impl SpilloverMap {
    /// Creates the map from the spillovers of a day.
    pub fn new(spillover: &Spillover) -> SpilloverMap {
        let Spillover { day, known_groups: known, spillovers: spills, .. } = spillover;
        let heading = format!("changes of reputation on day {day}: rows are sources, columns are targets");
        let sources: Vec<Group> =
            known.iter().copied().filter(|group| spillover.contributions[*group].subscribers > 0).collect();
        let spillover_effects: Vec<&SpilloverEffect> = spills.iter().filter(|spill| spill.counts).collect();
        let largest = spillover_effects.iter().map(|spill| spill.change.abs()).fold(0.0, f64::max);
        let is_target = |target: &Group| spillover_effects.iter().any(|spill| spill.to == *target);
        let targets: Vec<Group> = match sources.is_empty() {
            true => Vec::new(),
            false => known.iter().copied().filter(is_target).collect(),
        };
        let cell = |from: Group, to: Group| match spillover.spillover_between(from, to) {
            Some(spill) if spill.counts => SpilloverCell::Applied(spill.change, heat_level(&spill, largest)),
            Some(_) => SpilloverCell::Dropped,
            None => SpilloverCell::NoWeight,
        };
        let row = |from: &Group| SpilloverRow {
            from: *from,
            own_change: format_requested_change(spillover, *from),
            cells: targets.iter().map(|to| cell(*from, *to)).collect(),
        };
        let rows = sources.iter().map(row).collect();
        SpilloverMap {
            heading,
            rows,
            notes: notes(spillover, &sources, spillover_effects.is_empty()),
            targets,
        }
    }
}

impl SpilloverCell {
    /// Formats the cell as a mark and the change of reputation.
    pub fn describe(self) -> String {
        match self {
            SpilloverCell::NoWeight => "·".to_owned(),
            SpilloverCell::Dropped => "dropped".to_owned(),
            SpilloverCell::Applied(change, mark) => format!("{} {change:+.6}", HEAT_MARKS[mark]),
        }
    }
}

fn format_requested_change(spillover: &Spillover, from: Group) -> String {
    let change = &spillover.contributions[from];
    match change.is_applied {
        true => format!("{:+.6}", change.requested_change),
        false => format!("{:+.6} dropped", change.requested_change),
    }
}

fn heat_level(spill: &SpilloverEffect, largest: f64) -> usize {
    let share = if largest > 0.0 { spill.change.abs() / largest } else { 0.0 };
    ((share * HEAT_MARKS.len() as f64).ceil() as usize).clamp(1, HEAT_MARKS.len()) - 1
}

fn notes(spillover: &Spillover, sources: &[Group], is_silent: bool) -> Vec<String> {
    if sources.is_empty() {
        return vec!["  no group has subscribers".to_owned()];
    }
    let mut lines = Vec::new();
    if is_silent {
        lines.push("  no spillover".to_owned());
    }
    let small_own: Vec<&str> = sources
        .iter()
        .filter(|group| !spillover.contributions[**group].is_applied)
        .map(|group| group.id())
        .collect();
    if !small_own.is_empty() {
        lines.push(format!(
            "  own changes of {} below {}: dropped",
            small_own.join(", "),
            format_small(spillover.thresholds.subscriber_contribution)
        ));
    }
    let dropped: Vec<&SpilloverEffect> = spillover.spillovers.iter().filter(|spill| !spill.counts).collect();
    lines.extend(describe_dropped_spillovers(&dropped, &spillover.thresholds));
    lines
}

/// Returns the spillovers of a day as a text table.
pub fn describe_spillover(spillover: &Spillover) -> Vec<String> {
    let SpilloverMap { heading, targets, rows, notes } = SpilloverMap::new(spillover);
    let mut lines = vec![heading];
    if !rows.is_empty() {
        let mut head = vec!["from", "own change"];
        head.extend(targets.iter().map(|group| group.id()));
        let row = |row: &SpilloverRow| {
            let cells = row.cells.iter().map(|cell| cell.describe());
            [row.from.to_string(), row.own_change.clone()].into_iter().chain(cells).collect()
        };
        lines.extend(indented_table(&head, &rows.iter().map(row).collect::<Vec<Vec<String>>>()));
    }
    lines.extend(notes);
    clean_up_numbers(lines)
}
