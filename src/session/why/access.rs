//! Who may see causes. They are simulated with the hidden state, so they tell of it.

use crate::session::folder::manifest::Manifest;
use crate::session::folder::mode::Mode;
use crate::session::study::rules::ResultsShown;
use crate::tools::Refusal;

/// How finely the inputs of the world are told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sight {
    /// The market is one cause: what moves it is hidden.
    Market,
    /// Every input for itself.
    All,
}

/// What may be seen of a run.
///
/// # Errors
/// `not_in_this_mode` for an unfinished baseline run, and for one whose study shows no results.
pub(super) fn sight(manifest: &Manifest, ended: bool) -> Result<Sight, Refusal> {
    match (manifest.mode, ended) {
        (Mode::Baseline, true) if manifest.session_rules().results == ResultsShown::None => {
            Err(Refusal::new("not_in_this_mode", "the study of this run shows no results to its players"))
        }
        (_, true) | (Mode::Debug, _) => Ok(Sight::All),
        (Mode::Sandbox | Mode::Lesson, false) => Ok(Sight::Market),
        (Mode::Baseline, false) => Err(Refusal::new(
            "not_in_this_mode",
            "causes are found by simulating the company again, which agents cannot do either: not in an unfinished \
             baseline run",
        )),
    }
}
