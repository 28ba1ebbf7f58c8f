//! The tree of branches of a run: where each left, what was changed first, where it stands now.

use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use crate::session::figures::week::week_of;
use crate::session::folder::derived::manifest_of;
use crate::session::folder::runs::{RunSummary, list_runs, run_folder};
use crate::session::trajectory::record::{Call, Parent};
use crate::session::trajectory::{Line, Record, Trajectory};
use crate::tools::ToolId;

/// A run in the tree.
#[derive(Debug, Clone)]
pub struct Kin {
    /// The run as it stands.
    pub run: RunSummary,
    /// How many branches lie between it and the run at the root: 0 for that one.
    pub depth: usize,
    /// Week at whose start it left its parent; none for the root.
    pub left_in_week: Option<u32>,
    /// The first call that was made in it and not in its parent at that place; none if there is none.
    pub first_change: Option<(u32, ToolId)>,
}

/// Where a branch came from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct BranchOrigin {
    /// The run that it left.
    pub run: String,
    /// Week at whose start it left.
    pub week: u32,
    /// Day, and tool or parameter, of the first call or setting that its parent did not make there; none if there is none, or
    /// if the parent cannot be read.
    pub first_change: Option<(u32, String)>,
}

/// Where the run in a folder came from; none if it is no branch, or cannot be read.
pub fn origin_of(folder: &Path) -> Option<BranchOrigin> {
    let parent = manifest_of(folder).ok()?.parent?;
    let lines = |folder: &Path| Some(Trajectory::read(&folder.join("trajectory.jsonl")).ok()?.lines);
    let own = lines(folder)?;
    let at = own.iter().position(|line| matches!(line.record, Record::Branch(_)))?;
    let first_change = lines(&folder.with_file_name(&parent.run)).and_then(|parents| {
        let made = |line: &Line| {
            let decided = decision(line)?;
            let is_parents = |other: &&Line| other.day == line.day && other.seq > parent.seq;
            let is_known =
                parents.iter().filter(is_parents).any(|other| decision(other).as_ref() == Some(&decided));
            (!is_known).then(|| (line.day, decided.0.to_owned()))
        };
        own[at..].iter().find_map(made)
    });
    Some(BranchOrigin { run: parent.run, week: week_of(own[at].day) + 1, first_change })
}

/// What a line decides: tool or parameter, with arguments or value.
fn decision(line: &Line) -> Option<(&str, Value)> {
    if let Record::Override(setting) = &line.record {
        return Some((&setting.key, setting.new.clone()));
    }
    let (call, _) = line.record.accepted_call()?;
    call.tool.spec().kind.acts().then(|| (call.tool.name(), call.args.clone()))
}

/// The tree in which a run of a folder of runs stands, its root first, each run before its branches. Runs that cannot be read
/// are left out.
pub fn branches_of(runs: &Path, id: &str) -> Vec<Kin> {
    // A copy of a folder is the same run once more.
    let once = list_runs(runs).into_iter().flatten().filter(|run| run.copy_of.is_none());
    let all: Vec<Node> = once.filter_map(|run| node(runs, run)).collect();
    let parent_of = |id: &str| {
        let own = all.iter().find(|node| node.run.id == id)?;
        let parent = own.parent.as_ref()?;
        all.iter().any(|node| node.run.id == parent.run).then(|| parent.run.clone())
    };
    let mut root = id.to_owned();
    // A chain of parents is no longer than there are runs, whatever the files say.
    for _ in 0..all.len() {
        match parent_of(&root) {
            Some(parent) => root = parent,
            None => break,
        }
    }
    let mut tree = Vec::new();
    grow(runs, &all, &root, 0, &mut tree);
    tree
}

struct Node {
    run: RunSummary,
    parent: Option<Parent>,
}

fn node(runs: &Path, run: RunSummary) -> Option<Node> {
    let manifest = manifest_of(&run_folder(runs, &run.id)).ok()?;
    Some(Node { run, parent: manifest.parent })
}

fn grow(runs: &Path, all: &[Node], id: &str, depth: usize, tree: &mut Vec<Kin>) {
    let Some(own) = all.iter().find(|node| node.run.id == id) else { return };
    if tree.iter().any(|known| known.run.id == id) {
        return;
    }
    let lines = own.parent.as_ref().and_then(|parent| left(runs, &own.run.id, parent));
    let (left_in_week, first_change) = lines.map_or((None, None), |(week, change)| (Some(week), change));
    tree.push(Kin { run: own.run.clone(), depth, left_in_week, first_change });
    let mut branches: Vec<&Node> =
        all.iter().filter(|node| node.parent.as_ref().is_some_and(|parent| parent.run == id)).collect();
    branches.sort_by(|one, other| one.run.created.cmp(&other.run.created));
    for branch in branches {
        grow(runs, all, &branch.run.id, depth + 1, tree);
    }
}

/// Week in which a branch left, and the day and tool of its first call that its parent did not make on that day.
fn left(runs: &Path, id: &str, parent: &Parent) -> Option<(u32, Option<(u32, ToolId)>)> {
    let read = |id: &str| Trajectory::read(&run_folder(runs, id).join("trajectory.jsonl")).ok();
    let (trajectory, parents) = (read(id)?, read(&parent.run)?);
    let is_parents = |day: u32, own: &Call| {
        let later = parents.lines.iter().filter(|line| line.day == day && line.seq > parent.seq);
        later
            .filter_map(|line| line.record.accepted_call())
            .any(|(call, _)| (call.tool, &call.args) == (own.tool, &own.args))
    };
    let at = trajectory.lines.iter().position(|line| matches!(line.record, Record::Branch(_)))?;
    let own = trajectory.lines[at..].iter().find_map(|line| {
        let (call, _) = line.record.accepted_call()?;
        let is_own = call.tool.spec().kind.acts() && !is_parents(line.day, call);
        is_own.then_some((line.day, call.tool))
    });
    Some((week_of(trajectory.lines[at].day) + 1, own))
}
