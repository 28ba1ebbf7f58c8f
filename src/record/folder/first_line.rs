//! The first line of a trajectory.

use super::manifest::Manifest;
use crate::trajectory::Record;
use crate::trajectory::record::Start;

/// The first line: what the manifest says.
pub fn start_of(manifest: &Manifest) -> Record {
    let manifest = manifest.clone();
    Record::Start(Box::new(Start {
        format: manifest.format,
        version: manifest.version,
        mechanics: manifest.mechanics,
        run: manifest.id,
        seed: manifest.seed,
        days: manifest.days,
        cash: manifest.cash,
        scenario: manifest.scenario,
        overrides: manifest.parameters,
        fault: manifest.fault,
        parameters_digest: manifest.parameters_digest,
        mode: manifest.mode,
        participant: manifest.participant,
        consent: manifest.consent,
        study: manifest.study,
        lesson: manifest.lesson,
        handout: manifest.handout,
        voice: manifest.voice,
        rules: manifest.rules,
        earlier_runs: manifest.earlier,
        parent: manifest.parent,
        line_sums: true,
    }))
}
