//! Consent of a participant to the text of a baseline session.

use std::path::Path;

use super::{NewRun, Storage};
use novamind_record::consent::Consent;
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::manifest_check::ManifestCheck;
use novamind_record::folder::runs::all_run_folders;

/// Returns the consent for a new baseline run. Uses the agreement in `new`, or the participant's consent to the same
/// text in an earlier run.
///
/// # Errors
/// [`RunError::ConsentNeeded`] with the consent text if the participant has not agreed to it. Other errors if the
/// consent file cannot be read.
pub fn resolve_consent(
    new: &NewRun,
    participant: Option<&str>,
    configuration: &Configuration,
) -> Result<Option<Consent>, RunError> {
    let text = match &new.study {
        // A study defines its consent text, or requires no consent.
        Some(study) => study.consent.clone(),
        None => configuration.load_consent_text()?,
    };
    let Some(text) = text else { return Ok(None) };
    let digest = text.digest();
    if let Some(agreed) = new.agreed.clone() {
        let text = Some(text.text);
        return Ok(Some(Consent { digest, at: agreed.at, given: Some(agreed.given), text }));
    }
    let earlier = match (&new.storage, participant) {
        (Storage::Runs(runs), Some(participant)) => earlier_consent(runs, participant, &digest),
        _ => None,
    };
    earlier.map(Some).ok_or(RunError::ConsentNeeded(text))
}

fn earlier_consent(runs: &Path, participant: &str, digest: &str) -> Option<Consent> {
    let folders = all_run_folders(runs);
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).into_iter().flatten().flatten());
    let manifests = entries.filter_map(|entry| ManifestCheck::read(&entry.path()).ok());
    let manifests = manifests.map(|derived| derived.manifest);
    let of_participant = manifests.filter(|manifest| manifest.participant.as_deref() == Some(participant));
    of_participant
        .filter_map(|manifest| manifest.consent)
        .filter(|consent| consent.digest == digest)
        .min_by(|one, other| one.at.cmp(&other.at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::play::Session;
    use crate::play::open::Access;
    use novamind_record::consent::ConsentDetails;
    use novamind_record::folder::configuration::CONSENT_FILE;
    use novamind_record::mode::Mode;

    fn new(runs: &Path, participant: Option<&str>, agreed: bool, mode: Mode) -> NewRun {
        let agreed = agreed.then(|| ConsentDetails::on_paper().agree_now());
        let storage = Storage::Runs(runs.to_owned());
        let participant = participant.map(str::to_owned);
        NewRun { mode, participant, agreed, storage, days: Some(28), ..NewRun::default() }
    }

    #[test]
    fn participant_consents_once_to_each_text() {
        let place = tempfile::tempdir().expect("a folder");
        let runs = place.path().join("runs");
        std::fs::create_dir(&runs).expect("a folder");
        let configuration = Configuration { folder: Some(place.path().to_owned()), voice: None };
        let start = |participant, agreed, mode| {
            Session::create(new(&runs, participant, agreed, mode), &configuration)
        };
        let consent = |session: Result<Session, RunError>| session.expect("a run").manifest().consent.clone();
        assert_eq!(consent(start(Some("P01"), false, Mode::Baseline)), None, "no text, no consent");
        std::fs::write(place.path().join(CONSENT_FILE), "We keep what you do for a year.").expect("written");
        assert_eq!(
            consent(start(Some("P01"), false, Mode::Sandbox)),
            None,
            "only baseline sessions need consent"
        );
        let count = || std::fs::read_dir(&runs).expect("a folder").count();
        let before = count();
        let error = start(Some("P01"), false, Mode::Baseline).err().expect("no consent was given");
        assert!(
            matches!(&error, RunError::ConsentNeeded(text) if text.text.contains("for a year")),
            "{error}"
        );
        assert!(
            error.to_string().contains("consent.md") && error.to_string().contains("--consent"),
            "{error}"
        );
        assert_eq!(count(), before, "no run is created without consent");

        let given = consent(start(Some("P01"), true, Mode::Baseline)).expect("it was given");
        let again = start(Some("P01"), false, Mode::Baseline).expect("a run");
        assert_eq!(again.manifest().consent.as_ref(), Some(&given), "the earlier consent counts");
        let folder = again.folder().expect("a folder").to_owned();
        drop(again);
        let opened = Session::open(&folder, Access::Write, false).expect("it opens");
        assert_eq!(opened.manifest().consent, Some(given));
        assert!(start(Some("P02"), false, Mode::Baseline).is_err(), "another participant has not agreed");
        assert!(start(None, false, Mode::Baseline).is_err(), "a run without a participant has no consent");
        std::fs::write(place.path().join(CONSENT_FILE), "We keep what you do for two years.")
            .expect("written");
        assert!(start(Some("P01"), false, Mode::Baseline).is_err(), "a new text needs new consent");
    }
}
