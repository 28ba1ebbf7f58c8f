//! `visits.csv`: a row for each line of the visit lists, including visitors without a run.

use super::column::{Column, columns};
use super::serialized_name;
use novamind_study::FoundVisit;

pub(super) fn columns() -> Vec<Column<FoundVisit>> {
    columns! { visit: FoundVisit;
        "participant", "label", "label as typed; empty if a code was rejected" => visit.line.label;
        "event", "word", "came, label_refused, consent_declined, passed_practice, withdrew, finished, or code_refused: an entry \
         that was not the experimenter's code" => serialized_name(&visit.line.event);
        "at", "RFC 3339", "time of the event" => visit.line.at;
        "machine", "hash", "identifier of the machine" => visit.line.machine;
        "folder", "path", "runs folder that contains the list" => visit.folder.display().to_string();
        "study_digest", "hash", "BLAKE3 hash of the protocol of the study" => visit.line.study;
    }
}
