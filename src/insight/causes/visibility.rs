//! Permissions for explanations, which can reveal hidden state because they re-simulate the run.

use super::question::WeekQuantity;
use novamind_record::folder::manifest::Manifest;
use novamind_record::mode::Mode;
use novamind_tools::Rejection;
use novamind_world::identifiers::Group;

/// The level of detail at which world inputs are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum InputVisibility {
    /// All hidden market inputs are shown as a single cause.
    MarketAsOne,
    /// Every world input is shown as a separate cause.
    EveryInput,
}

/// Returns the level of detail at which world inputs of a run may be shown.
///
/// # Errors
/// `not_in_this_mode` for an unfinished baseline run, and for a run whose study shows no results.
pub(crate) fn input_visibility(manifest: &Manifest, ended: bool) -> Result<InputVisibility, Rejection> {
    match (manifest.mode, ended) {
        (Mode::Baseline, true) if manifest.session_rules().withholds_results() => Err(Rejection::new(
            "not_in_this_mode",
            "the study of this run does not show results to participants",
        )),
        (_, true) | (Mode::Debug, _) => Ok(InputVisibility::EveryInput),
        (Mode::Sandbox | Mode::Lesson, false) => Ok(InputVisibility::MarketAsOne),
        (Mode::Baseline, false) => Err(Rejection::new(
            "not_in_this_mode",
            "\"why\" and \"whatif\" are not available in an unfinished baseline run, because agents cannot re-simulate the company",
        )),
    }
}

/// Rejects a figure that is hidden in unfinished runs.
///
/// # Errors
/// `not_in_this_mode`.
pub(super) fn check_figure_visible(quantity: WeekQuantity, sight: InputVisibility) -> Result<(), Rejection> {
    if sight == InputVisibility::EveryInput || !quantity.is_hidden() {
        return Ok(());
    }
    let message = format!(
        "{} is hidden in unfinished runs; \"why\" explains this figure in debug runs and finished runs",
        quantity.name()
    );
    Err(Rejection::for_field("figure", "not_in_this_mode", message))
}

/// Returns the rejection for a group that the player had not discovered in a week.
pub(super) fn unknown_group_rejection(group: Group, week: u32) -> Rejection {
    let message = format!("{group} was not discovered in week {week}; choose a discovered group");
    Rejection::for_field("figure", "unknown_group", message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::rules::{ResultsDisclosure, SessionRules};
    use novamind_record::stamp::StudyStamp;
    use novamind_session::{NewRun, Session};

    #[test]
    fn finished_baseline_shows_causes_unless_the_study_hides_results() {
        let new = NewRun { mode: Mode::Baseline, days: Some(28), ..NewRun::default() };
        let session = Session::create(new, &Configuration::bundled()).expect("a run");
        let mut manifest = session.manifest().clone();
        assert_eq!(input_visibility(&manifest, true), Ok(InputVisibility::EveryInput));
        for (practice, results) in [(true, ResultsDisclosure::Own), (false, ResultsDisclosure::None)] {
            manifest.study = Some(StudyStamp::pilot_study(practice));
            manifest.rules = Some(SessionRules { results, ..SessionRules::for_mode(Mode::Baseline) });
            assert_eq!(
                input_visibility(&manifest, true).map_err(|rejection| rejection.code),
                Err("not_in_this_mode")
            );
        }
        manifest.rules.as_mut().expect("rules").results = ResultsDisclosure::Own;
        assert_eq!(input_visibility(&manifest, true), Ok(InputVisibility::EveryInput));
    }
}
