//! Whether the world of a session was played or looked at outside it, on the same machine.

use super::machine::RunRecord;
use super::{AuditFinding, AuditKind, Inspection};
use crate::session::folder::manifest::Manifest;
use crate::session::folder::world_log::{EXPERIMENTER, WorldLine};
use crate::session::trajectory::{Line, Trajectory, seconds};

/// What the machine knows of the world of a run.
pub(super) fn of(own: &Inspection<'_>, trajectory: &Trajectory) -> Vec<AuditFinding> {
    let Some(manifest) = &own.run.manifest else { return Vec::new() };
    let over = trajectory.end().map(Line::moment);
    let mut found = listed(own, manifest, trajectory, over);
    found.extend(left(own, manifest, trajectory, over, &found));
    found.extend(untold(own, manifest));
    found
}

/// Number of the line, from 1, that was the last at a moment.
fn line_at(trajectory: &Trajectory, moment: f64) -> Option<u64> {
    trajectory.lines.iter().rev().find(|line| line.moment() <= moment).map(|line| line.seq + 1)
}

/// Worlds of the machine's list.
fn listed(
    own: &Inspection<'_>,
    manifest: &Manifest,
    trajectory: &Trajectory,
    over: Option<f64>,
) -> Vec<AuditFinding> {
    let study = manifest.study.as_ref().map(|stamp| stamp.digest.as_str());
    // A copy of the scenario may have any name: the seed tells.
    let same_world = |line: &&WorldLine| {
        (line.seed..=line.to_seed).contains(&manifest.seed) && !line.by.starts_with(EXPERIMENTER)
    };
    // Sessions of the study are no rehearsal, and what happens once the run is over teaches its player nothing.
    let counts = |line: &&WorldLine| {
        let of_study = line.study.is_some() && line.study.as_deref() == study && line.by.starts_with("play");
        let itself = line.run.as_deref() == Some(manifest.id.as_str());
        !(of_study || itself && line.by.starts_with("replay"))
            && over.is_none_or(|end| seconds(&line.at) < end)
    };
    let lines = own.machine.worlds.lines.iter().filter(same_world).filter(counts);
    lines
        .map(|line| {
            let run = line.run.as_ref().map_or(String::new(), |run| format!(" (run {run})"));
            let scenario = match line.scenario == manifest.scenario {
                true => String::new(),
                false => format!(" in scenario {}", line.scenario),
            };
            let words =
                format!("`{}` opened the seed of this session on the machine{scenario}{run}", line.by);
            own.finding(AuditKind::Rehearsal, line_at(trajectory, seconds(&line.at)), &line.at, words)
        })
        .collect()
}

/// Runs that lie on the machine and are on no list.
fn left(
    own: &Inspection<'_>,
    manifest: &Manifest,
    trajectory: &Trajectory,
    over: Option<f64>,
    known: &[AuditFinding],
) -> Vec<AuditFinding> {
    let study = manifest.study.as_ref().map(|stamp| &stamp.digest);
    let other = |run: &&RunRecord| run.id != own.run.id;
    let runs = own.machine.runs.iter().filter(other).filter_map(|run| Some((run, run.manifest.as_ref()?)));
    runs.filter(|(_, other)| {
        let branched = other.parent.as_ref().is_some_and(|parent| parent.run == manifest.id);
        let same = other.seed == manifest.seed;
        let of_study = other.study.as_ref().map(|stamp| &stamp.digest) == study;
        (branched || same) && !of_study && over.is_none_or(|end| seconds(&other.created) < end)
    })
    .filter(|(run, _)| !known.iter().any(|finding| finding.words.contains(&run.id)))
    .map(|(run, other)| {
        let what = match &other.parent {
            Some(parent) if parent.run == manifest.id => "a branch of this session",
            _ => "a run of the world of this session",
        };
        let words = format!("{what} lies on the machine: run {}, {} mode", run.id, other.mode);
        let line = line_at(trajectory, seconds(&other.created));
        own.finding(AuditKind::Rehearsal, line, &other.created, words)
    })
    .collect()
}

/// Runs of the same person that the first line does not tell.
fn untold(own: &Inspection<'_>, manifest: &Manifest) -> Vec<AuditFinding> {
    let began = seconds(&manifest.created);
    let earlier = own.machine.runs.iter().filter_map(|run| run.manifest.as_ref()).filter(|other| {
        other.participant == manifest.participant
            && other.id != manifest.id
            && other.parent.is_none()
            && seconds(&other.created) < began
            && !manifest.earlier.iter().any(|known| known.run == other.id)
    });
    earlier
        .map(|other| {
            let words =
                format!("run {} of the same person is older, and the first line does not tell it", other.id);
            own.finding(AuditKind::EarlierRuns, Some(1), &manifest.created, words)
        })
        .collect()
}
