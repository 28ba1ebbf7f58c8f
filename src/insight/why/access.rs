//! Who may see causes. They are simulated with the hidden state, so they tell of it.

use super::quantity::WeekQuantity;
use novamind_record::folder::manifest::Manifest;
use novamind_record::mode::Mode;
use novamind_tools::Refusal;
use novamind_world::identifiers::Group;

/// How finely the inputs of the world are told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sight {
    /// The market is one cause: what moves it is hidden.
    Market,
    /// Every input for itself.
    All,
}

/// What may be seen of a run.
///
/// # Errors
/// `not_in_this_mode` for an unfinished baseline run, and for one of which its study shows no results.
pub(crate) fn sight(manifest: &Manifest, ended: bool) -> Result<Sight, Refusal> {
    match (manifest.mode, ended) {
        (Mode::Baseline, true) if manifest.session_rules().hides_results() => Err(Refusal::new(
            "not_in_this_mode",
            "the study of this run shows no results of it to its player",
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

/// Refuses a figure that no screen shows while the run goes on.
///
/// # Errors
/// `not_in_this_mode`.
pub(super) fn refuse_hidden(quantity: WeekQuantity, sight: Sight) -> Result<(), Refusal> {
    if sight == Sight::All || !quantity.is_hidden() {
        return Ok(());
    }
    let message = format!(
        "{} is hidden while the run goes on; why explains it in debug runs and in runs that are over",
        quantity.name()
    );
    Err(Refusal::at("figure", "not_in_this_mode", message))
}

/// A player has no figures of a group that was not known.
pub(super) fn unknown_group(group: Group, week: u32) -> Refusal {
    let message = format!("{group} was not known in week {week}; choose a group that was");
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
