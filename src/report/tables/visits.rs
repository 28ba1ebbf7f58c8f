//! `visits.csv`: a row for each line of the lists of visits, of those who have no run too.

use super::{Heading, heading, word};
use novamind_study::FoundVisit;

/// The columns.
pub(super) const HEADINGS: [Heading; 6] = [
    heading("participant", "label", "label as it was typed; empty where a code was refused"),
    heading(
        "event",
        "word",
        "came, label_refused, consent_declined, passed_practice, withdrew, finished, or code_refused: a word that was not the \
         experimenter's code",
    ),
    heading("at", "RFC 3339", "when it happened"),
    heading("machine", "hash", "names the machine"),
    heading("folder", "path", "folder of runs in which the list lies"),
    heading("study_digest", "hash", "BLAKE3 hash of the protocol of the study"),
];

/// The row of a line.
pub(super) fn row(visit: &FoundVisit) -> Vec<String> {
    let line = &visit.line;
    vec![
        line.label.clone(),
        word(&line.event),
        line.at.clone(),
        line.machine.clone(),
        visit.folder.display().to_string(),
        line.study.clone(),
    ]
}
