//! Design problems of a protocol: questions, forecasts and blocks that do not fit the length of a session.

use super::{Outcome, Point};
use crate::record::error::RunError;
use crate::record::folder::configuration::Configuration;
use novamind_study::{Moment, Study};

/// Returns the points of the design: questions, assignment, forecasts.
pub(super) fn points(study: &Study, configuration: &Configuration) -> Vec<Point> {
    let Ok((days, horizons)) = terms(study, configuration) else {
        // An invalid scenario is reported by its own point.
        return Vec::new();
    };
    let mut points: Vec<Point> = questions(study, days.div_ceil(7)).into_iter().collect();
    points.extend(last_block(study).map(|words| Point::new("assignment", Outcome::Note(words))));
    points.push(Point::new("forecasts", forecasts(days, &horizons)));
    points
}

/// Returns the last day of a session and the horizons of its forecasts in days.
fn terms(study: &Study, configuration: &Configuration) -> Result<(u32, Vec<u32>), RunError> {
    let scenario = configuration.scenario(&study.protocol.world.scenario)?;
    let params = configuration.parameters(&scenario, &[], false)?;
    let (days, _) = configuration.terms(&scenario, false)?;
    Ok((study.protocol.world.days.unwrap_or(days), params.limits.prediction_horizons_days.clone()))
}

/// Reports questionnaires that are due after weeks that a session does not have.
fn questions(study: &Study, weeks: u32) -> Option<Point> {
    let (mut never, mut words) = (false, Vec::new());
    for own in study.questionnaires.iter().filter(|own| own.when == Moment::Weeks) {
        let late: Vec<String> = own.weeks.iter().filter(|week| **week > weeks).map(u32::to_string).collect();
        if !late.is_empty() {
            never |= late.len() == own.weeks.len();
            words.push(format!("questions/{}.toml is due after week {}", own.name, late.join(", ")));
        }
    }
    if words.is_empty() {
        return None;
    }
    let words = format!("{}: a session has {weeks} weeks", words.join("; "));
    Some(Point::new("questions", if never { Outcome::Wrong(words) } else { Outcome::Note(words) }))
}

/// Reports a last block of the assignment that does not contain every cell of the design.
fn last_block(study: &Study) -> Option<String> {
    let (places, cells) = (study.assignment.as_ref()?.places.len(), study.protocol.seeds.cells());
    (!study.protocol.seeds.block.is_empty() && !places.is_multiple_of(cells)).then(|| {
        format!(
            "{places} labels in blocks of {cells}: the last block has {} of {cells} cells",
            places % cells
        )
    })
}

/// Returns how many forecasts come due within a session, by horizon.
fn forecasts(days: u32, horizons: &[u32]) -> Outcome {
    let due = |horizon: u32| days.checked_sub(horizon).map_or(0, |last| last / 7 + 1);
    let words: Vec<String> =
        horizons.iter().map(|horizon| format!("{} looking {horizon} days ahead", due(*horizon))).collect();
    let words = format!("of {} weeks' forecasts come due: {}", days.div_ceil(7), words.join(", "));
    if horizons.iter().all(|horizon| due(*horizon) > 0) { Outcome::Fits(words) } else { Outcome::Note(words) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forecasts_that_never_come_due_are_counted() {
        let Outcome::Note(words) = forecasts(28, &[7, 28, 84, 182]) else { panic!("a note") };
        assert_eq!(
            words,
            "of 4 weeks' forecasts come due: 4 looking 7 days ahead, 1 looking 28 days ahead, 0 looking 84 days ahead, 0 \
             looking 182 days ahead"
        );
        assert!(matches!(forecasts(182, &[7, 182]), Outcome::Fits(_)));
        assert!(matches!(forecasts(181, &[7, 182]), Outcome::Note(_)));
    }
}
