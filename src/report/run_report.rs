//! Data of a run report: result, figures by week, decisions and behavior measures.

use super::bankruptcy::{CostShare, cost_shares, describe_turning_points};
use super::database_figures::DatabaseFigures;
use super::decision_periods::{DecisionPeriod, decision_periods};
use super::highlights::{Highlight, highlights};
use super::measures::BehaviorMeasures;
use super::ranking::{Ranking, rank_score};
use novamind_insight::{BranchOrigin, branch_origin};
use novamind_record::figures::WeekFigures;
use novamind_record::rules::{ResultsDisclosure, SessionRules};
use novamind_record::trajectory::record::RunEndReason;
use novamind_session::{Observation, ScoredForecast, Session, submitted_forecasts};

#[derive(Debug, Clone, PartialEq)]
pub struct Bankruptcy {
    /// Day on which cash fell below zero.
    pub day: u32,
    /// Costs by kind, highest first.
    pub costs: Vec<CostShare>,
    /// Sentences that describe the turning points of the run.
    pub turning_points: Vec<String>,
}

/// The data that a run report is formatted from.
#[derive(Debug, Clone, PartialEq)]
pub struct RunReport {
    /// State of the run on its current day.
    pub observation: Observation,
    /// Version of the program that recorded the run.
    pub version: String,
    /// Cash on day 0, dollars.
    pub start_cash: f64,
    /// Cash in dollars at the end of each day, day 0 first.
    pub cash_by_day: Vec<f64>,
    /// Figures of every simulated week.
    pub weeks: Vec<WeekFigures>,
    /// Ranking of the run among the published results.
    pub ranking: Ranking,
    /// Every filed forecast, in the order of filing.
    pub forecasts: Vec<ScoredForecast>,
    /// Data from the tables and the ledger of the run.
    pub database: DatabaseFigures,
    /// What the player decided, by decision period.
    pub decision_periods: Vec<DecisionPeriod>,
    /// Notable days of the run, sorted by day.
    pub highlights: Vec<Highlight>,
    /// Behavior measures of the run.
    pub measures: BehaviorMeasures,
    /// Analysis of the bankruptcy; `None` if the company is not bankrupt.
    pub bankruptcy: Option<Bankruptcy>,
    /// Session rules, which can hide results and scores.
    pub rules: SessionRules,
    /// Parent run and first different decision of a branch; `None` for other runs.
    pub origin: Option<BranchOrigin>,
}

impl RunReport {
    /// Collects the data of a run up to the current day. Queries the database, so it must not be called on the thread
    /// that draws the screen.
    pub fn from_session(session: &Session) -> RunReport {
        let seen = session.company().observe();
        let start_cash = session.manifest().cash;
        let (weeks, journal) = (session.weeks(), session.journal());
        let figures = DatabaseFigures::load(session);
        let bankruptcy = (seen.ended == Some(RunEndReason::Bankruptcy)).then(|| Bankruptcy {
            day: seen.day,
            costs: cost_shares(&figures.totals_by_category()),
            turning_points: describe_turning_points(weeks),
        });
        let measures = BehaviorMeasures::from_session(session, &figures.channels);
        RunReport {
            version: session.manifest().version.clone(),
            start_cash,
            cash_by_day: session.cash_by_day().to_vec(),
            weeks: weeks.to_vec(),
            ranking: rank_score(seen.score, &seen),
            forecasts: submitted_forecasts(journal, weeks),
            decision_periods: decision_periods(session.company().decisions(), journal, start_cash),
            highlights: highlights(weeks, session.cash_by_day(), &figures.outages, seen.ended),
            measures,
            bankruptcy,
            rules: session.rules(),
            origin: session.folder().and_then(branch_origin),
            database: figures,
            observation: seen,
        }
    }

    /// Returns whether published results are shown. A study can hide them until the session has ended.
    pub fn shows_published_results(&self) -> bool {
        self.rules.results == ResultsDisclosure::Published || self.observation.ended.is_some()
    }

    /// Returns whether scores of the player's forecasts are shown. A study can hide them until the session has ended.
    pub fn shows_forecast_scores(&self) -> bool {
        self.rules.calibration || self.observation.ended.is_some()
    }

    /// Summarizes the result of the run in one sentence.
    pub fn headline(&self) -> String {
        use super::formatting::format_money;
        let day = self.observation.day;
        match self.observation.ended {
            Some(RunEndReason::Horizon) => {
                format!("Day {day}. You end with {}.", format_money(self.observation.cash))
            }
            Some(RunEndReason::Bankruptcy) => format!("Day {day}. The company is bankrupt; the score is $0."),
            Some(RunEndReason::Abandoned) => {
                format!(
                    "Day {day}. The run was abandoned with {}; it has no score.",
                    format_money(self.observation.cash)
                )
            }
            Some(RunEndReason::Lesson) => {
                format!("Day {day}. The lesson ends with {}.", format_money(self.observation.cash))
            }
            None => format!(
                "Day {day} of {}. Cash is {}.",
                self.observation.last_day,
                format_money(self.observation.cash)
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit;

    #[test]
    fn finished_run_has_score_rank_and_measures() {
        let report = RunReport::from_session(&test_kit::finished_run());
        assert!(report.headline().starts_with("Day 35. You end with $"), "{}", report.headline());
        assert!(report.observation.score.is_some());
        assert_eq!(
            (report.ranking.rank, report.ranking.describe().as_str()),
            (None, "not ranked: 35 days instead of 500")
        );
        assert_eq!(report.measures.survival_days, 35);
        assert_eq!(report.forecasts.len(), 5 * 4);
        assert_eq!(report.forecasts.iter().filter(|filed| filed.outcome.is_some()).count(), 5 + 2);
        assert!(report.measures.channels.as_ref().is_some_and(|skill| skill.groups[0].tried == 2));
        assert_eq!(report.measures.targeted_development, Some(6000.0 / 6200.0));
        assert_eq!(report.bankruptcy, None);
    }

    #[test]
    fn bankrupt_run_lists_costs() {
        let report = RunReport::from_session(&test_kit::bankrupt_run());
        let bankruptcy = report.bankruptcy.as_ref().expect("a bankruptcy");
        assert_eq!(
            (bankruptcy.day, report.measures.survival_days),
            (report.observation.day, report.observation.day)
        );
        assert_eq!(bankruptcy.costs[0].name, "development and R&D");
        let shares: f64 = bankruptcy.costs.iter().map(|cost| cost.share).sum();
        assert!((shares - 1.0).abs() < 1e-9 && !bankruptcy.turning_points.is_empty());
        assert!(report.headline().contains("bankrupt"));
        assert_eq!(report.highlights.last().map(|last| last.text.as_str()), Some("bankrupt"));
    }

    #[test]
    fn unfinished_run_has_a_report() {
        let started = RunReport::from_session(&test_kit::play_weeks(0));
        assert!(
            started.decision_periods.is_empty()
                && started.measures.channels.is_none()
                && started.highlights.is_empty()
        );
        let running = RunReport::from_session(&test_kit::play_weeks(2));
        assert_eq!((running.ranking.rank, running.bankruptcy.is_none()), (None, true));
        assert!(running.headline().starts_with("Day 14 of 200. Cash is $"));
    }
}
