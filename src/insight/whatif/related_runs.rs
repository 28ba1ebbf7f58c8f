//! The tree of related runs. Each branch is listed with its first week, the first decision that differs from its
//! parent, and its current state.

use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use novamind_record::folder::manifest_check::read_manifest;
use novamind_record::folder::runs::{RunSummary, list_runs, run_folder};
use novamind_record::trajectory::record::Parent;
use novamind_record::trajectory::{Line, Record, Trajectory};
use novamind_session::week_of_day;

/// A run in the tree of related runs.
#[derive(Debug, Clone)]
pub struct RelatedRun {
    /// Summary of the run.
    pub run: RunSummary,
    /// Number of branches between the run and the root; 0 for the root.
    pub depth: usize,
    /// First week of the branch, counted from 1; `None` for the root.
    pub branched_in_week: Option<u32>,
    /// First decision that only the branch or only its parent made.
    pub first_change: Option<FirstChange>,
}

/// The parent of a branch, and the first difference between branch and parent.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct BranchOrigin {
    /// ID of the parent run.
    pub run: String,
    /// First week of the branch, counted from 1.
    pub week: u32,
    /// First decision that only the branch or only its parent made; `None` if there is no such decision or the parent
    /// cannot be read.
    pub first_change: Option<FirstChange>,
}

/// The first decision that differs between a branch and its parent.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FirstChange {
    /// Decision day of the change.
    pub day: u32,
    /// Name of the tool or parameter.
    pub what: String,
    /// Whether the parent made the decision and the branch did not.
    pub is_left_out: bool,
}

/// Returns the origin of the run in a folder, or `None` if the run is not a branch or cannot be read.
pub fn branch_origin(folder: &Path) -> Option<BranchOrigin> {
    let parent = read_manifest(folder).ok()?.parent?;
    let (week, first_change) = branch_week_and_change(folder, &parent)?;
    Some(BranchOrigin { run: parent.run, week, first_change })
}

/// Returns the week in which a run branched from its parent, and the first decision that only one of the two runs made.
fn branch_week_and_change(folder: &Path, parent: &Parent) -> Option<(u32, Option<FirstChange>)> {
    let lines = |folder: &Path| Some(Trajectory::read(&folder.join("trajectory.jsonl")).ok()?.lines);
    let branch_lines = lines(folder)?;
    let at = branch_lines.iter().position(|line| matches!(line.record, Record::Branch(_)))?;
    let week = week_of_day(branch_lines[at].day) + 1;
    let parents = lines(&folder.with_file_name(&parent.run));
    let change =
        parents.and_then(|parents| first_changed_decision(&branch_lines[at..], &parents, parent.seq));
    Some((week, change))
}

/// Returns the first decision that only the branch or only its parent made on a day, up to the last day that both runs
/// have reached.
fn first_changed_decision(lines: &[Line], parents: &[Line], left_at: u64) -> Option<FirstChange> {
    let one = |line: &Line| parse_decision(line).map(|(what, how)| (line.day, what.to_owned(), how));
    let branch_decisions: Vec<_> = lines.iter().filter_map(one).collect();
    let parent_decisions: Vec<_> = parents.iter().filter(|line| line.seq > left_at).filter_map(one).collect();
    let until = lines.last()?.day;
    let of = |(day, what, _): &(u32, String, Value), is_left_out| FirstChange {
        day: *day,
        what: what.clone(),
        is_left_out,
    };
    let new = branch_decisions.iter().find(|one| !parent_decisions.contains(one)).map(|one| of(one, false));
    // The branch can still make decisions on its current day, so this day is not compared.
    let left_out = parent_decisions
        .iter()
        .find(|one| one.0 < until && !branch_decisions.contains(one))
        .map(|one| of(one, true));
    match (new, left_out) {
        (Some(new), Some(left_out)) if left_out.day < new.day => Some(left_out),
        (new, left_out) => new.or(left_out),
    }
}

/// Returns the decision that an event records: a tool with its arguments or a parameter with its value.
fn parse_decision(line: &Line) -> Option<(&str, Value)> {
    if let Record::Override(setting) = &line.record {
        return Some((&setting.key, setting.new.clone()));
    }
    let (call, _) = line.record.accepted_call()?;
    call.tool.tool_id()?.spec().kind.changes_company().then(|| (call.tool.name(), call.args.clone()))
}

/// Returns the tree that contains a run, in pre-order from the root. Unreadable runs are omitted.
pub fn related_runs(runs: &Path, id: &str) -> Vec<RelatedRun> {
    // A copied folder contains a run that is already listed.
    let once = list_runs(runs).into_iter().flatten().filter(|run| run.copy_of.is_none());
    let all: Vec<RunNode> = once.filter_map(|run| read_node(runs, run)).collect();
    let parent_of = |id: &str| {
        let run_node = all.iter().find(|node| node.run.id == id)?;
        let parent = run_node.parent.as_ref()?;
        all.iter().any(|node| node.run.id == parent.run).then(|| parent.run.clone())
    };
    let mut root = id.to_owned();
    // Limits the chain of parents, because damaged files could contain a cycle.
    for _ in 0..all.len() {
        match parent_of(&root) {
            Some(parent) => root = parent,
            None => break,
        }
    }
    let mut tree = Vec::new();
    append_subtree(runs, &all, &root, 0, &mut tree);
    tree
}

struct RunNode {
    run: RunSummary,
    parent: Option<Parent>,
}

fn read_node(runs: &Path, run: RunSummary) -> Option<RunNode> {
    let manifest = read_manifest(&run_folder(runs, &run.id)).ok()?;
    Some(RunNode { run, parent: manifest.parent })
}

fn append_subtree(runs: &Path, all: &[RunNode], id: &str, depth: usize, tree: &mut Vec<RelatedRun>) {
    let Some(run_node) = all.iter().find(|node| node.run.id == id) else { return };
    if tree.iter().any(|known| known.run.id == id) {
        return;
    }
    let lines = run_node
        .parent
        .as_ref()
        .and_then(|parent| branch_week_and_change(&run_folder(runs, &run_node.run.id), parent));
    let (left_in_week, first_change) = lines.map_or((None, None), |(week, change)| (Some(week), change));
    tree.push(RelatedRun { run: run_node.run.clone(), depth, branched_in_week: left_in_week, first_change });
    let mut branches: Vec<&RunNode> =
        all.iter().filter(|node| node.parent.as_ref().is_some_and(|parent| parent.run == id)).collect();
    branches.sort_by(|one, other| one.run.created.cmp(&other.run.created));
    for branch in branches {
        append_subtree(runs, all, &branch.run.id, depth + 1, tree);
    }
}
