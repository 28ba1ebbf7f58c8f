//! Permissions for causes, which reveal hidden state because it is part of their simulation.

use super::quantity::WeekQuantity;
use novamind_record::folder::manifest::Manifest;
use novamind_record::mode::Mode;
use novamind_tools::Refusal;
use novamind_world::identifiers::Group;

/// The level of detail of world inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sight {
    /// The market is a single cause, because its inputs are hidden.
    Market,
    /// Every input is a separate cause.
    All,
}

/// Returns the level of detail that a run permits.
///
/// # Errors
/// `not_in_this_mode` for an unfinished baseline run, and for a run whose study shows no results.
pub(crate) fn sight(manifest: &Manifest, ended: bool) -> Result<Sight, Refusal> {
    match (manifest.mode, ended) {
        (Mode::Baseline, true) if manifest.session_rules().hides_results() => Err(Refusal::new(
            "not_in_this_mode",
            "the study of this run does not show results to participants",
        )),
        (_, true) | (Mode::Debug, _) => Ok(Sight::All),
        (Mode::Sandbox | Mode::Lesson, false) => Ok(Sight::Market),
        (Mode::Baseline, false) => Err(Refusal::new(
            "not_in_this_mode",
            "why and what-if simulate the company again, which agents cannot do either: not in an unfinished \
             baseline run",
        )),
    }
}

/// Rejects a figure that is hidden in unfinished runs.
///
/// # Errors
/// `not_in_this_mode`.
pub(super) fn refuse_hidden(quantity: WeekQuantity, sight: Sight) -> Result<(), Refusal> {
    if sight == Sight::All || !quantity.is_hidden() {
        return Ok(());
    }
    let message = format!(
        "{} is hidden in unfinished runs; why explains it in debug runs and finished runs",
        quantity.name()
    );
    Err(Refusal::at("figure", "not_in_this_mode", message))
}

/// Returns the rejection for a group that the player did not know.
pub(super) fn unknown_group(group: Group, week: u32) -> Refusal {
    let message = format!("{group} was not discovered in week {week}; choose a discovered group");
    Refusal::at("figure", "unknown_group", message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::rules::{ResultsShown, SessionRules};
    use novamind_record::stamp::StudyStamp;
    use novamind_session::{NewRun, Session};

    #[test]
    fn an_ended_baseline_tells_its_causes_unless_its_study_shows_no_results_of_it() {
        let new = NewRun { mode: Mode::Baseline, days: Some(28), ..NewRun::default() };
        let session = Session::create(new, &Configuration::shipped()).expect("a run");
        let mut manifest = session.manifest().clone();
        assert_eq!(sight(&manifest, true), Ok(Sight::All));
        for (practice, results) in [(true, ResultsShown::Own), (false, ResultsShown::None)] {
            manifest.study = Some(StudyStamp::pilot(practice));
            manifest.rules = Some(SessionRules { results, ..SessionRules::of_mode(Mode::Baseline) });
            assert_eq!(sight(&manifest, true).map_err(|refusal| refusal.code), Err("not_in_this_mode"));
        }
        manifest.rules.as_mut().expect("rules").results = ResultsShown::Own;
        assert_eq!(sight(&manifest, true), Ok(Sight::All));
    }
}
