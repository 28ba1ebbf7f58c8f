//! Eligibility of a run for the ranking among the published results, for the final page, the menu, reports
//! and the laboratory.

use super::logbook::Logbook;
use super::ranking::published;
use super::words::{dollar_tick, whole};
use novamind_record::folder::configuration::DEFAULT_SCENARIO;
use novamind_record::folder::runs::RunSummary;
use novamind_record::mode::Mode;
use novamind_session::Observation;

/// Last day of the published runs.
pub const PUBLISHED_DAYS: u32 = 500;

/// Seed of the published runs.
pub const PUBLISHED_SEED: u64 = 42;

/// Scenarios with the rules of the published results: any seed, and the seed of the release.
const PUBLISHED_RULES: [&str; 2] = [DEFAULT_SCENARIO, "reference-seed42"];

/// Properties that decide whether a run can be ranked among the published results.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunTerms<'a> {
    /// Last day of the run.
    pub days: u32,
    /// Cash on day 0, dollars.
    pub start_cash: f64,
    /// Scenario.
    pub scenario: &'a str,
    /// The parameters differ, or differed for some days, from those of the bundled scenario of that name.
    pub has_own_parameters: bool,
    /// A language model judges the posts of the player.
    pub judged_by_model: bool,
    /// The run belongs to a lesson.
    pub is_lesson: bool,
    /// The run continues weeks of another run, whose end may be known.
    pub is_branch: bool,
    /// The run was played in debug mode, which shows hidden state. Policies never see hidden state.
    pub showed_hidden_state: bool,
}

impl<'a> RunTerms<'a> {
    /// Returns the terms of an open run.
    pub fn of_observation(seen: &'a Observation) -> RunTerms<'a> {
        RunTerms {
            days: seen.last_day,
            start_cash: seen.starting_cash,
            scenario: &seen.scenario,
            has_own_parameters: seen.has_own_parameters,
            judged_by_model: seen.voice.as_ref().is_some_and(|model| model.judge),
            is_lesson: seen.mode == Mode::Lesson,
            is_branch: seen.is_branch,
            showed_hidden_state: seen.mode == Mode::Debug,
        }
    }

    /// Returns the terms of a run in a list.
    pub fn of_summary(run: &'a RunSummary) -> RunTerms<'a> {
        RunTerms {
            days: run.days,
            start_cash: run.starting_cash,
            scenario: &run.scenario,
            has_own_parameters: run.has_own_parameters,
            judged_by_model: run.judged_by_model,
            is_lesson: run.mode == Some(Mode::Lesson),
            is_branch: run.is_branch,
            showed_hidden_state: run.mode == Some(Mode::Debug) && run.policy.is_none(),
        }
    }

    /// Returns the terms of a run that was read from its record.
    pub fn of_logbook(book: &'a Logbook) -> RunTerms<'a> {
        RunTerms {
            days: book.days,
            start_cash: book.start_cash,
            scenario: &book.scenario,
            has_own_parameters: book.has_own_parameters,
            judged_by_model: book.voice.as_ref().is_some_and(|model| model.judge),
            is_lesson: book.mode == Mode::Lesson,
            is_branch: book.parent.is_some(),
            showed_hidden_state: book.mode == Mode::Debug && book.policy.is_none(),
        }
    }

    /// Returns the reasons not to rank the run; empty if it can be ranked. A different seed is not a reason.
    pub fn obstacles(&self) -> Vec<Obstacle> {
        let mut obstacles = Vec::new();
        if self.is_lesson {
            obstacles.push(Obstacle::Lesson);
        }
        if self.days != PUBLISHED_DAYS {
            obstacles.push(Obstacle::Length(self.days));
        }
        if self.start_cash != published().start_cash {
            obstacles.push(Obstacle::Start(self.start_cash));
        }
        if !PUBLISHED_RULES.contains(&self.scenario) {
            obstacles.push(Obstacle::Scenario(self.scenario.to_owned()));
        }
        if self.has_own_parameters {
            obstacles.push(Obstacle::Parameters);
        }
        if self.judged_by_model {
            obstacles.push(Obstacle::Judge);
        }
        if self.is_branch {
            obstacles.push(Obstacle::Branch);
        }
        if self.showed_hidden_state {
            obstacles.push(Obstacle::Debug);
        }
        obstacles
    }
}

/// A reason not to rank a run among the published ones.
#[derive(Debug, Clone, PartialEq)]
pub enum Obstacle {
    /// The run belongs to a lesson.
    Lesson,
    /// Different number of days.
    Length(u32),
    /// Different starting cash, dollars.
    Start(f64),
    /// Different scenario.
    Scenario(String),
    /// Parameters were changed.
    Parameters,
    /// A language model judges the posts of the player.
    Judge,
    /// The run continues weeks of another run, whose outcome may be known.
    Branch,
    /// The run was played in debug mode, which shows hidden state.
    Debug,
}

impl Obstacle {
    /// Describes the reason: `28 days instead of 500`.
    pub fn in_words(&self) -> String {
        match self {
            Obstacle::Lesson => "part of a lesson".to_owned(),
            Obstacle::Length(days) => {
                format!("{} days instead of {PUBLISHED_DAYS}", whole(f64::from(*days)))
            }
            Obstacle::Start(cash) => {
                format!(
                    "{} at the start instead of {}",
                    dollar_tick(*cash),
                    dollar_tick(published().start_cash)
                )
            }
            Obstacle::Scenario(name) => format!("scenario {name}"),
            Obstacle::Parameters => "changed parameters".to_owned(),
            Obstacle::Judge => "posts judged by a language model".to_owned(),
            Obstacle::Branch => "a branch of another run".to_owned(),
            Obstacle::Debug => "played in debug mode".to_owned(),
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Obstacle::Lesson => "part of a lesson",
            Obstacle::Length(_) => "different length",
            Obstacle::Start(_) => "different starting cash",
            Obstacle::Scenario(_) => "different scenario",
            Obstacle::Parameters => "changed parameters",
            Obstacle::Judge => "posts judged by a language model",
            Obstacle::Branch => "a branch of another run",
            Obstacle::Debug => "played in debug mode",
        }
    }
}

/// Lists reasons in one line.
pub fn obstacles_in_words(obstacles: &[Obstacle]) -> String {
    obstacles.iter().map(Obstacle::in_words).collect::<Vec<_>>().join(", ")
}

/// Returns the number of runs with obstacles, and the reasons: those of a single run, or counts by kind.
/// `None` if no run has any.
pub fn left_out_in_words(runs: &[Vec<Obstacle>]) -> Option<(usize, String)> {
    let left_out: Vec<&Vec<Obstacle>> = runs.iter().filter(|obstacles| !obstacles.is_empty()).collect();
    match left_out.as_slice() {
        [] => None,
        [one] => Some((1, obstacles_in_words(one))),
        several => {
            let mut counted: Vec<(&'static str, usize)> = Vec::new();
            for kind in several.iter().flat_map(|obstacles| obstacles.iter().map(Obstacle::kind)) {
                match counted.iter_mut().find(|(known, _)| *known == kind) {
                    Some((_, count)) => *count += 1,
                    None => counted.push((kind, 1)),
                }
            }
            counted.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
            let reasons: Vec<String> =
                counted.iter().map(|(kind, count)| format!("{kind} ({count})")).collect();
            Some((several.len(), reasons.join(", ")))
        }
    }
}

/// Explains in a sentence why finished runs are not ranked. `None` if all of them are ranked.
pub fn not_ranked_in_words(runs: &[Vec<Obstacle>]) -> Option<String> {
    left_out_in_words(runs).map(|(count, why)| match count {
        1 => format!("One finished run is not ranked: {why}."),
        count => format!("{count} finished runs are not ranked: {why}."),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::folder::configuration::Configuration;
    use novamind_session::{NewRun, Session};

    const COMPARABLE: RunTerms<'static> = RunTerms {
        days: 500,
        start_cash: 1_000_000.0,
        scenario: "default",
        has_own_parameters: false,
        judged_by_model: false,
        is_lesson: false,
        is_branch: false,
        showed_hidden_state: false,
    };

    #[test]
    fn only_a_run_of_the_published_terms_is_ranked() {
        for (terms, reason) in [
            (COMPARABLE, ""),
            (RunTerms { scenario: "reference-seed42", ..COMPARABLE }, ""),
            (RunTerms { scenario: "paper", ..COMPARABLE }, "scenario paper"),
            (RunTerms { scenario: "competitor-off", ..COMPARABLE }, "scenario competitor-off"),
            (RunTerms { days: 28, ..COMPARABLE }, "28 days instead of 500"),
            (RunTerms { start_cash: 2e6, ..COMPARABLE }, "$2M at the start instead of $1M"),
            (RunTerms { has_own_parameters: true, ..COMPARABLE }, "changed parameters"),
            (RunTerms { judged_by_model: true, ..COMPARABLE }, "posts judged by a language model"),
            (RunTerms { is_branch: true, ..COMPARABLE }, "a branch of another run"),
            (RunTerms { showed_hidden_state: true, ..COMPARABLE }, "played in debug mode"),
            (
                RunTerms { is_lesson: true, days: 14, ..COMPARABLE },
                "part of a lesson, 14 days instead of 500",
            ),
        ] {
            assert_eq!(obstacles_in_words(&terms.obstacles()), reason, "{terms:?}");
        }
    }

    #[test]
    fn the_default_run_can_be_ranked_and_every_shipped_scenario_that_counts_exists() {
        for scenario in PUBLISHED_RULES {
            let new = NewRun { scenario: scenario.to_owned(), ..NewRun::default() };
            let seen = Session::create(new, &Configuration::shipped()).expect("a run").company().observe();
            assert_eq!(RunTerms::of_observation(&seen).obstacles(), [], "{scenario}");
        }
    }

    #[test]
    fn reasons_of_several_runs_are_counted() {
        assert_eq!(not_ranked_in_words(&[vec![]]), None);
        let short = vec![Obstacle::Length(28)];
        assert_eq!(
            not_ranked_in_words(&[vec![], short.clone()]).as_deref(),
            Some("One finished run is not ranked: 28 days instead of 500.")
        );
        let other = vec![Obstacle::Length(35), Obstacle::Scenario("short".to_owned())];
        assert_eq!(
            not_ranked_in_words(&[short, other]).as_deref(),
            Some("2 finished runs are not ranked: different length (2), different scenario (1).")
        );
    }
}
