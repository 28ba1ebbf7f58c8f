//! `visits.csv`: a row for each line of the lists of visits, of those who have no run too.

use super::column::{Column, columns};
use super::word;
use novamind_study::FoundVisit;

/// The columns.
pub(super) fn columns() -> Vec<Column<FoundVisit>> {
    columns! { visit: FoundVisit;
        "participant", "label", "label as it was typed; empty where a code was refused" => visit.line.label;
        "event", "word", "came, label_refused, consent_declined, passed_practice, withdrew, finished, or code_refused: a word \
         that was not the experimenter's code" => word(&visit.line.event);
        "at", "RFC 3339", "when it happened" => visit.line.at;
        "machine", "hash", "names the machine" => visit.line.machine;
        "folder", "path", "folder of runs in which the list lies" => visit.folder.display().to_string();
        "study_digest", "hash", "BLAKE3 hash of the protocol of the study" => visit.line.study;
    }
}
