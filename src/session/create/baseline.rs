//! Conditions for baseline runs outside of studies: a participant label, one of the baseline scenarios, and the default
//! days and cash, so that results can be compared.

use super::{NewRun, Storage};
use novamind_base::formatting::{dollars, grouped_number};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::{Configuration, DEFAULT_SCENARIO};
use novamind_record::folder::runs::participant_of_folder;
use novamind_record::mode::Mode;

/// Scenarios of baseline runs outside of studies: both generations of the released simulator.
const BASELINE_SCENARIOS: [&str; 2] = [DEFAULT_SCENARIO, "release-2"];

impl NewRun {
    /// Checks that a baseline run has a participant label, one of the baseline scenarios, and the default days and
    /// cash. Runs of studies and other modes are not restricted.
    ///
    /// # Errors
    /// [`RunError::InvalidRequest`] with the next step if the run does not meet these conditions; another error if the
    /// scenario cannot be read.
    pub fn check_baseline(&self, configuration: &Configuration) -> Result<(), RunError> {
        if self.mode != Mode::Baseline || self.study.is_some() {
            return Ok(());
        }
        let of_folder = match &self.storage {
            Storage::Runs(runs) => participant_of_folder(runs),
            Storage::Memory => None,
        };
        let label = self.participant.clone().or(of_folder);
        if label.is_none_or(|label| label.trim().is_empty()) {
            return Err(RunError::InvalidRequest(
                "a baseline run needs a participant: enter a label with --as or --participant, or in the Participant \
                 field of the form. Nothing was recorded"
                    .to_owned(),
            ));
        }
        let other = self.deviating_terms(configuration)?;
        if other.is_empty() {
            return Ok(());
        }
        Err(RunError::InvalidRequest(format!(
            "a baseline run needs {}, so that results can be compared; {} can be set only in a study or in another mode. \
             Nothing was recorded",
            baseline_terms(configuration)?,
            other.join(", ")
        )))
    }

    /// Describes each term of the run (scenario, days, cash) that differs from the terms of baseline runs.
    ///
    /// # Errors
    /// The scenario cannot be read.
    pub fn deviating_terms(&self, configuration: &Configuration) -> Result<Vec<String>, RunError> {
        let (days, cash) =
            configuration.days_and_cash(&configuration.load_scenario(DEFAULT_SCENARIO)?, false)?;
        let other = [
            (!BASELINE_SCENARIOS.contains(&self.scenario.as_str()))
                .then(|| format!("scenario {}", self.scenario)),
            self.days.filter(|number| *number != days).map(format_days),
            self.cash.filter(|value| *value != cash).map(dollars),
        ];
        Ok(other.into_iter().flatten().collect())
    }
}

/// Describes the scenario, days and cash of baseline runs outside of studies.
///
/// # Errors
/// The scenario cannot be read.
pub fn baseline_terms(configuration: &Configuration) -> Result<String, RunError> {
    let (days, cash) = configuration.days_and_cash(&configuration.load_scenario(DEFAULT_SCENARIO)?, false)?;
    let scenarios = BASELINE_SCENARIOS.join(" or ");
    Ok(format!("scenario {scenarios}, {} and {}", format_days(days), dollars(cash)))
}

fn format_days(days: u32) -> String {
    format!("{} days", grouped_number(f64::from(days), 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rejection_text(new: &NewRun) -> Option<String> {
        new.check_baseline(&Configuration::bundled()).err().map(|error| error.to_string())
    }

    #[test]
    fn baseline_run_requires_label_and_default_terms() {
        let base = NewRun { mode: Mode::Baseline, participant: Some("P01".to_owned()), ..NewRun::default() };
        let named = NewRun { days: Some(500), cash: Some(1_000_000.0), seed: Some(7), ..base.clone() };
        assert_eq!((rejection_text(&base), rejection_text(&named)), (None, None));
        let release_2 = NewRun { scenario: "release-2".to_owned(), ..base.clone() };
        assert_eq!(rejection_text(&release_2), None, "both generations have baseline runs");
        let runs = std::path::PathBuf::from("runs/participants/P01");
        let of_folder = NewRun { participant: None, storage: Storage::Runs(runs), ..base.clone() };
        assert_eq!(rejection_text(&of_folder), None);
        for (new, part) in [
            (NewRun { participant: None, ..base.clone() }, "--participant"),
            (NewRun { participant: Some(" ".to_owned()), ..base.clone() }, "--participant"),
            (NewRun { days: Some(28), ..base.clone() }, "28 days can be set only in a study"),
            (NewRun { cash: Some(2e6), ..base.clone() }, "$2,000,000 can be set only in a study"),
            (
                NewRun { scenario: "paper".to_owned(), ..base.clone() },
                "scenario paper can be set only in a study",
            ),
        ] {
            let words = rejection_text(&new).expect(part);
            assert!(words.contains(part), "{words}");
            assert_eq!(
                rejection_text(&NewRun { mode: Mode::Sandbox, ..new }),
                None,
                "other modes are not restricted"
            );
        }
    }
}
