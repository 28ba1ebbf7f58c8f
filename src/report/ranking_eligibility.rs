//! Decides whether a run can be ranked among the published results. Used by the final page, the menu, reports and the
//! laboratory.

use super::formatting::{format_dollar_tick, format_whole};
use super::logbook::Logbook;
use super::ranking::published_results;
use novamind_record::folder::configuration::DEFAULT_SCENARIO;
use novamind_record::folder::runs::RunSummary;
use novamind_record::mode::Mode;
use novamind_session::{Generation, HorizonRule, Observation};

/// Day for which the cash of published runs is known.
pub const PUBLISHED_DAYS: u32 = 500;

/// Last day of most published runs, because the programs of the agents play only whole weeks. The cash on this day
/// counts as the cash of [`PUBLISHED_DAYS`].
pub const PUBLISHED_WHOLE_WEEKS: u32 = 497;

/// Seed of the published runs.
pub const PUBLISHED_SEED: u64 = 42;

/// Scenarios with unchanged rules: the default scenario for any seed, the scenario of the published seed, and the
/// scenario of release 2.
const COMPARABLE_SCENARIOS: [&str; 3] = [DEFAULT_SCENARIO, "reference-seed42", "release-2"];

/// Properties that decide whether a run can be ranked among the published results.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RankingCriteria<'a> {
    /// Planned last day of the run.
    pub days: u32,
    /// Cash on day 0, dollars.
    pub start_cash: f64,
    /// Rule that derived the last day.
    pub horizon_rule: HorizonRule,
    /// Generation of the released simulator whose rules the run has.
    pub generation: Generation,
    /// Name of the scenario. Runs can be ranked only in scenarios with unchanged rules.
    pub scenario: &'a str,
    /// Whether the parameters differ from the bundled scenario of the same name, or did on some days.
    pub has_changed_parameters: bool,
    /// Whether a language model judges the posts of the player.
    pub judged_by_model: bool,
    /// Whether the run belongs to a lesson.
    pub is_lesson: bool,
    /// Whether the run is a branch. The player may know how the parent run ended.
    pub is_branch: bool,
    /// Whether a person played the run in debug mode, which shows hidden state. Policies cannot read hidden state, so
    /// this is `false` for them.
    pub showed_hidden_state: bool,
}

impl<'a> RankingCriteria<'a> {
    /// Returns the ranking criteria of an open run.
    pub fn from_observation(seen: &'a Observation) -> RankingCriteria<'a> {
        RankingCriteria {
            days: seen.last_day,
            horizon_rule: seen.horizon_rule,
            generation: seen.generation,
            start_cash: seen.starting_cash,
            scenario: &seen.scenario,
            has_changed_parameters: seen.has_own_parameters,
            judged_by_model: seen.voice.as_ref().is_some_and(|model| model.judge),
            is_lesson: seen.mode == Mode::Lesson,
            is_branch: seen.is_branch,
            showed_hidden_state: seen.mode == Mode::Debug,
        }
    }

    /// Returns the ranking criteria of a run from its summary in a list.
    pub fn from_summary(run: &'a RunSummary) -> RankingCriteria<'a> {
        RankingCriteria {
            days: run.days,
            horizon_rule: run.horizon_rule,
            generation: run.generation,
            start_cash: run.starting_cash,
            scenario: &run.scenario,
            has_changed_parameters: run.has_own_parameters,
            judged_by_model: run.judged_by_model,
            is_lesson: run.mode == Some(Mode::Lesson),
            is_branch: run.is_branch,
            showed_hidden_state: run.mode == Some(Mode::Debug) && run.policy.is_none(),
        }
    }

    /// Returns the ranking criteria of a run from its logbook.
    pub fn from_logbook(book: &'a Logbook) -> RankingCriteria<'a> {
        RankingCriteria {
            days: book.days,
            horizon_rule: book.horizon_rule,
            generation: book.generation,
            start_cash: book.start_cash,
            scenario: &book.scenario,
            has_changed_parameters: book.has_own_parameters,
            judged_by_model: book.voice.as_ref().is_some_and(|model| model.judge),
            is_lesson: book.mode == Mode::Lesson,
            is_branch: book.parent.is_some(),
            showed_hidden_state: book.mode == Mode::Debug && book.policy.is_none(),
        }
    }

    /// Returns whether the run has the last day and the calendar of competitor events that published runs have.
    fn has_published_length(&self) -> bool {
        match self.days {
            PUBLISHED_DAYS => true,
            // If a run was rounded up to 497 days, its calendar can be scaled by a smaller length.
            PUBLISHED_WHOLE_WEEKS => self.horizon_rule != HorizonRule::WholeWeeksAbove,
            _ => false,
        }
    }

    /// Returns the reasons why the run cannot be ranked; empty if it can be ranked. A different seed is not an
    /// obstacle.
    pub fn obstacles(&self) -> Vec<RankingObstacle> {
        let mut obstacles = Vec::new();
        if self.is_lesson {
            obstacles.push(RankingObstacle::Lesson);
        }
        if published_results().table_of(self.generation).is_none() {
            obstacles.push(RankingObstacle::Generation(self.generation));
        }
        if !self.has_published_length() {
            obstacles.push(RankingObstacle::Length(self.days));
        }
        if self.start_cash != published_results().start_cash {
            obstacles.push(RankingObstacle::StartCash(self.start_cash));
        }
        if !COMPARABLE_SCENARIOS.contains(&self.scenario) {
            obstacles.push(RankingObstacle::Scenario(self.scenario.to_owned()));
        }
        if self.has_changed_parameters {
            obstacles.push(RankingObstacle::Parameters);
        }
        if self.judged_by_model {
            obstacles.push(RankingObstacle::ModelVoice);
        }
        if self.is_branch {
            obstacles.push(RankingObstacle::Branch);
        }
        if self.showed_hidden_state {
            obstacles.push(RankingObstacle::Debug);
        }
        obstacles
    }
}

/// A reason why a run cannot be ranked among the published results.
#[derive(Debug, Clone, PartialEq)]
pub enum RankingObstacle {
    /// The run belongs to a lesson.
    Lesson,
    /// No results of this generation are published.
    Generation(Generation),
    /// The run has this number of days, which is not the length of the published runs.
    Length(u32),
    /// The run started with this cash in dollars, unlike the published runs.
    StartCash(f64),
    /// The rules of the scenario with this name differ from those of the published runs.
    Scenario(String),
    /// Parameters of the scenario were changed.
    Parameters,
    /// A language model judges the posts of the player.
    ModelVoice,
    /// The run is a branch. The player may know how the parent run ended.
    Branch,
    /// The run was played in debug mode, which shows hidden state.
    Debug,
}

impl RankingObstacle {
    /// Describes why the run cannot be ranked: `28 days instead of 500`.
    pub fn describe(&self) -> String {
        match self {
            RankingObstacle::Lesson => "part of a lesson".to_owned(),
            RankingObstacle::Generation(generation) => {
                format!("no results of {} in the published tables", generation.name())
            }
            RankingObstacle::Length(days) => {
                format!("{} days instead of {PUBLISHED_DAYS}", format_whole(f64::from(*days)))
            }
            RankingObstacle::StartCash(cash) => {
                format!(
                    "{} at the start instead of {}",
                    format_dollar_tick(*cash),
                    format_dollar_tick(published_results().start_cash)
                )
            }
            RankingObstacle::Scenario(name) => format!("scenario {name}"),
            RankingObstacle::Parameters => "changed parameters".to_owned(),
            RankingObstacle::ModelVoice => "posts judged by a language model".to_owned(),
            RankingObstacle::Branch => "a branch of another run".to_owned(),
            RankingObstacle::Debug => "played in debug mode".to_owned(),
        }
    }

    fn plural_description(&self) -> &'static str {
        match self {
            RankingObstacle::Lesson => "part of a lesson",
            RankingObstacle::Generation(_) => "no results of their generation in the published tables",
            RankingObstacle::Length(_) => "different length",
            RankingObstacle::StartCash(_) => "different starting cash",
            RankingObstacle::Scenario(_) => "different scenario",
            RankingObstacle::Parameters => "changed parameters",
            RankingObstacle::ModelVoice => "posts judged by a language model",
            RankingObstacle::Branch => "a branch of another run",
            RankingObstacle::Debug => "played in debug mode",
        }
    }
}

/// Lists the reasons in one line.
pub fn describe_obstacles(obstacles: &[RankingObstacle]) -> String {
    obstacles.iter().map(RankingObstacle::describe).collect::<Vec<_>>().join(", ")
}

/// Returns the number of runs with obstacles, and a text about the obstacles. For a single run, the text lists them.
/// For several runs, it counts them by kind. Returns `None` if no run has an obstacle.
pub fn describe_unranked_runs(runs: &[Vec<RankingObstacle>]) -> Option<(usize, String)> {
    let left_out: Vec<&Vec<RankingObstacle>> =
        runs.iter().filter(|obstacles| !obstacles.is_empty()).collect();
    match left_out.as_slice() {
        [] => None,
        [one] => Some((1, describe_obstacles(one))),
        several => {
            let mut counted: Vec<(&'static str, usize)> = Vec::new();
            for kind in
                several.iter().flat_map(|obstacles| obstacles.iter().map(RankingObstacle::plural_description))
            {
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

/// Explains in a sentence why finished runs are not ranked. Returns `None` if all finished runs are ranked.
pub fn explain_unranked_runs(runs: &[Vec<RankingObstacle>]) -> Option<String> {
    describe_unranked_runs(runs).map(|(count, why)| match count {
        1 => format!("One finished run is not ranked: {why}."),
        count => format!("{count} finished runs are not ranked: {why}."),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::folder::configuration::Configuration;
    use novamind_session::{NewRun, Session};

    const COMPARABLE_RUN: RankingCriteria<'static> = RankingCriteria {
        days: 500,
        horizon_rule: HorizonRule::Exact,
        generation: Generation::Release1,
        start_cash: 1_000_000.0,
        scenario: "default",
        has_changed_parameters: false,
        judged_by_model: false,
        is_lesson: false,
        is_branch: false,
        showed_hidden_state: false,
    };

    #[test]
    fn only_runs_with_published_conditions_are_ranked() {
        for (terms, reason) in [
            (COMPARABLE_RUN, ""),
            (RankingCriteria { scenario: "reference-seed42", ..COMPARABLE_RUN }, ""),
            (RankingCriteria { scenario: "paper", ..COMPARABLE_RUN }, "scenario paper"),
            (RankingCriteria { scenario: "competitor-off", ..COMPARABLE_RUN }, "scenario competitor-off"),
            (RankingCriteria { days: 28, ..COMPARABLE_RUN }, "28 days instead of 500"),
            (RankingCriteria { days: 497, ..COMPARABLE_RUN }, ""),
            (RankingCriteria { days: 497, horizon_rule: HorizonRule::WholeWeeksBelow, ..COMPARABLE_RUN }, ""),
            (
                RankingCriteria { days: 497, horizon_rule: HorizonRule::WholeWeeksAbove, ..COMPARABLE_RUN },
                "497 days instead of 500",
            ),
            (
                RankingCriteria { days: 504, horizon_rule: HorizonRule::WholeWeeksAbove, ..COMPARABLE_RUN },
                "504 days instead of 500",
            ),
            (
                RankingCriteria { scenario: "release-2", generation: Generation::Release2, ..COMPARABLE_RUN },
                "no results of release 2 in the published tables",
            ),
            (RankingCriteria { start_cash: 2e6, ..COMPARABLE_RUN }, "$2M at the start instead of $1M"),
            (RankingCriteria { has_changed_parameters: true, ..COMPARABLE_RUN }, "changed parameters"),
            (RankingCriteria { judged_by_model: true, ..COMPARABLE_RUN }, "posts judged by a language model"),
            (RankingCriteria { is_branch: true, ..COMPARABLE_RUN }, "a branch of another run"),
            (RankingCriteria { showed_hidden_state: true, ..COMPARABLE_RUN }, "played in debug mode"),
            (
                RankingCriteria { is_lesson: true, days: 14, ..COMPARABLE_RUN },
                "part of a lesson, 14 days instead of 500",
            ),
        ] {
            assert_eq!(describe_obstacles(&terms.obstacles()), reason, "{terms:?}");
        }
    }

    #[test]
    fn default_run_is_ranked_and_comparable_scenarios_exist() {
        for scenario in COMPARABLE_SCENARIOS {
            let new = NewRun { scenario: scenario.to_owned(), ..NewRun::default() };
            let seen = Session::create(new, &Configuration::bundled()).expect("a run").company().observe();
            let obstacles = RankingCriteria::from_observation(&seen).obstacles();
            let expected = match seen.generation {
                Generation::Release1 => vec![],
                // The only obstacle is the lack of published results.
                Generation::Release2 => vec![RankingObstacle::Generation(Generation::Release2)],
            };
            assert_eq!(obstacles, expected, "{scenario}");
        }
    }

    #[test]
    fn obstacles_of_several_runs_are_counted() {
        assert_eq!(explain_unranked_runs(&[vec![]]), None);
        let short = vec![RankingObstacle::Length(28)];
        assert_eq!(
            explain_unranked_runs(&[vec![], short.clone()]).as_deref(),
            Some("One finished run is not ranked: 28 days instead of 500.")
        );
        let other = vec![RankingObstacle::Length(35), RankingObstacle::Scenario("short".to_owned())];
        assert_eq!(
            explain_unranked_runs(&[short, other]).as_deref(),
            Some("2 finished runs are not ranked: different length (2), different scenario (1).")
        );
    }
}
