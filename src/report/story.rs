//! Data of a run report: result, course, decisions and behavior.

use super::books::Books;
use super::chapters::{Chapter, chapters};
use super::highlights::{Highlight, highlights};
use super::measures::Measures;
use super::ranking::{Standing, standing};
use super::turn::{Cost, costs, turned};
use novamind_insight::{BranchOrigin, origin_of};
use novamind_record::figures::WeekFigures;
use novamind_record::rules::{ResultsShown, SessionRules};
use novamind_record::trajectory::record::Ended;
use novamind_session::{Observation, ScoredForecast, Session, filed_forecasts};

#[derive(Debug, Clone, PartialEq)]
pub struct Ruin {
    /// Day on which cash fell below zero.
    pub day: u32,
    /// Costs by kind, highest first.
    pub costs: Vec<Cost>,
    /// Sentences about the turning points.
    pub turned: Vec<String>,
}

/// Data of a run report.
#[derive(Debug, Clone, PartialEq)]
pub struct Story {
    /// Current state of the run.
    pub seen: Observation,
    /// Program version that recorded it.
    pub version: String,
    /// Cash on day 0, dollars.
    pub start_cash: f64,
    /// Cash at the end of each day, day 0 first.
    pub cash_by_day: Vec<f64>,
    /// Figures of every week.
    pub weeks: Vec<WeekFigures>,
    /// Comparison with the published results.
    pub standing: Standing,
    /// Every forecast, in the order of filing.
    pub filed: Vec<ScoredForecast>,
    /// Data from the run's tables.
    pub books: Books,
    /// Decisions by chapter.
    pub chapters: Vec<Chapter>,
    /// Notable days.
    pub highlights: Vec<Highlight>,
    /// Behavior measures.
    pub measures: Measures,
    /// Analysis of the bankruptcy, if there was one.
    pub ruin: Option<Ruin>,
    /// Rules of the session.
    pub rules: SessionRules,
    /// Origin of the run if it is a branch.
    pub origin: Option<BranchOrigin>,
}

impl Story {
    /// Collects the data of a run so far. Queries the database, so do not call it on the drawing thread.
    pub fn of(session: &Session) -> Story {
        let seen = session.company().observe();
        let start_cash = session.manifest().cash;
        let (weeks, journal) = (session.weeks(), session.journal());
        let books = Books::of(session);
        let ruin = (seen.ended == Some(Ended::Bankruptcy)).then(|| Ruin {
            day: seen.day,
            costs: costs(&books.totals()),
            turned: turned(weeks),
        });
        let measures = Measures::of(session, &books.channels);
        Story {
            version: session.manifest().version.clone(),
            start_cash,
            cash_by_day: session.cash_by_day().to_vec(),
            weeks: weeks.to_vec(),
            standing: standing(seen.score, &seen),
            filed: filed_forecasts(journal, session.cash_by_day()),
            chapters: chapters(session.company().decisions(), journal, start_cash),
            highlights: highlights(weeks, session.cash_by_day(), &books.outages, seen.ended),
            measures,
            ruin,
            rules: session.rules(),
            origin: session.folder().and_then(origin_of),
            books,
            seen,
        }
    }

    /// Returns whether published results are shown. If the study excludes them from the session, they are shown after
    /// its end.
    pub fn shows_published(&self) -> bool {
        self.rules.results == ResultsShown::Published || self.seen.ended.is_some()
    }

    /// Returns whether scores of the player's forecasts are shown, under the same condition.
    pub fn shows_calibration(&self) -> bool {
        self.rules.calibration || self.seen.ended.is_some()
    }

    /// Summarizes the result in one sentence.
    pub fn headline(&self) -> String {
        use super::words::money;
        let day = self.seen.day;
        match self.seen.ended {
            Some(Ended::Horizon) => format!("Day {day}. You end with {}.", money(self.seen.cash)),
            Some(Ended::Bankruptcy) => format!("Day {day}. The company is bankrupt; the score is $0."),
            Some(Ended::Abandoned) => {
                format!("Day {day}. The run was abandoned with {}; it has no score.", money(self.seen.cash))
            }
            Some(Ended::Lesson) => format!("Day {day}. The lesson ends with {}.", money(self.seen.cash)),
            None => format!("Day {day} of {}. Cash is {}.", self.seen.last_day, money(self.seen.cash)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit;

    #[test]
    fn a_finished_run_has_a_score_a_rank_and_its_measures() {
        let story = Story::of(&test_kit::finished());
        assert!(story.headline().starts_with("Day 35. You end with $"), "{}", story.headline());
        assert!(story.seen.score.is_some());
        assert_eq!(
            (story.standing.rank, story.standing.in_words().as_str()),
            (None, "not ranked: 35 days instead of 500")
        );
        assert_eq!(story.measures.survival_days, 35);
        assert_eq!(story.filed.len(), 5 * 4);
        assert_eq!(story.filed.iter().filter(|filed| filed.outcome.is_some()).count(), 5 + 2);
        assert!(story.measures.channels.as_ref().is_some_and(|skill| skill.groups[0].tried == 2));
        assert_eq!(story.measures.targeted_development, Some(6000.0 / 6200.0));
        assert_eq!(story.ruin, None);
    }

    #[test]
    fn a_ruined_run_tells_what_its_money_went_to() {
        let story = Story::of(&test_kit::ruined());
        let ruin = story.ruin.as_ref().expect("a bankruptcy");
        assert_eq!((ruin.day, story.measures.survival_days), (story.seen.day, story.seen.day));
        assert_eq!(ruin.costs[0].name, "development and R&D");
        let shares: f64 = ruin.costs.iter().map(|cost| cost.share).sum();
        assert!((shares - 1.0).abs() < 1e-9 && !ruin.turned.is_empty());
        assert!(story.headline().contains("bankrupt"));
        assert_eq!(story.highlights.last().map(|last| last.text.as_str()), Some("bankrupt"));
    }

    #[test]
    fn a_run_that_goes_on_or_has_not_begun_has_a_story_too() {
        let begun = Story::of(&test_kit::played(0));
        assert!(
            begun.chapters.is_empty() && begun.measures.channels.is_none() && begun.highlights.is_empty()
        );
        let running = Story::of(&test_kit::played(2));
        assert_eq!((running.standing.rank, running.ruin.is_none()), (None, true));
        assert!(running.headline().starts_with("Day 14 of 200. Cash is $"));
    }
}
