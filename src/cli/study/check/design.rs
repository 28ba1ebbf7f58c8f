//! Finds design problems of a protocol: questions and forecasts that do not fit the length of a session, and
//! incomplete blocks.

use super::{CheckItem, CheckOutcome};
use crate::record::error::RunError;
use crate::record::folder::configuration::Configuration;
use novamind_study::{Occasion, SeedPlan, Study};

/// Checks the questionnaires, the assignment and the forecasts of the design.
pub(super) fn check_design(study: &Study, configuration: &Configuration) -> Vec<CheckItem> {
    let Ok((days, horizons)) = days_and_horizons(study, configuration) else {
        // A separate check reports an invalid scenario.
        return Vec::new();
    };
    let mut points: Vec<CheckItem> = check_questionnaires(study, days.div_ceil(7)).into_iter().collect();
    points
        .extend(check_last_block(study).map(|words| CheckItem::new("assignment", CheckOutcome::Note(words))));
    let is_hosted = study.folder.join("host").is_dir();
    let guessable = study.guessable_seeds_warning().filter(|_| is_hosted);
    points.extend(guessable.map(|words| CheckItem::new("seeds", CheckOutcome::Note(words))));
    points.push(CheckItem::new("forecasts", check_forecasts(days, &horizons)));
    points
}

/// Returns the last day of a session and the horizons of its forecasts in days.
fn days_and_horizons(study: &Study, configuration: &Configuration) -> Result<(u32, Vec<u32>), RunError> {
    let scenario = configuration.load_scenario(&study.protocol.world.scenario)?;
    let params = configuration.load_parameters(&scenario, &[], false)?;
    let (days, _) = configuration.days_and_cash(&scenario, false)?;
    let horizon = params.run.horizon(study.protocol.world.days.unwrap_or(days));
    Ok((horizon.last_day, params.limits.prediction_horizons_days.clone()))
}

/// Reports questionnaires that are due after the last week of a session.
fn check_questionnaires(study: &Study, weeks: u32) -> Option<CheckItem> {
    let (mut never, mut words) = (false, Vec::new());
    for questionnaire in
        study.questionnaires.iter().filter(|questionnaire| questionnaire.when == Occasion::Weeks)
    {
        let weeks_after_end: Vec<String> =
            questionnaire.weeks.iter().filter(|week| **week > weeks).map(u32::to_string).collect();
        if !weeks_after_end.is_empty() {
            never |= weeks_after_end.len() == questionnaire.weeks.len();
            words.push(format!(
                "questions/{}.toml is due after week {}",
                questionnaire.name,
                weeks_after_end.join(", ")
            ));
        }
    }
    if words.is_empty() {
        return None;
    }
    let words = format!("{}: a session has {weeks} weeks", words.join("; "));
    Some(CheckItem::new(
        "questions",
        if never { CheckOutcome::Failed(words) } else { CheckOutcome::Note(words) },
    ))
}

/// Reports a last block of the assignment that does not contain every cell of the design.
fn check_last_block(study: &Study) -> Option<String> {
    let (places, cells) = (study.assignment.as_ref()?.rows.len(), study.protocol.seeds.cell_count());
    let has_blocks =
        matches!(study.protocol.seeds.plan, SeedPlan::Secret) || !study.protocol.seeds.block.is_empty();
    (has_blocks && !places.is_multiple_of(cells)).then(|| {
        format!(
            "{places} labels in blocks of {cells}: the last block has {} of {cells} cells",
            places % cells
        )
    })
}

/// Counts the forecasts with a target day in the session, by horizon.
fn check_forecasts(days: u32, horizons: &[u32]) -> CheckOutcome {
    let due = |horizon: u32| days.checked_sub(horizon).map_or(0, |last| last / 7 + 1);
    let words: Vec<String> =
        horizons.iter().map(|horizon| format!("{} for {horizon} days ahead", due(*horizon))).collect();
    let words = format!("forecasts that come due in {} weeks: {}", days.div_ceil(7), words.join(", "));
    if horizons.iter().all(|horizon| due(*horizon) > 0) {
        CheckOutcome::Passed(words)
    } else {
        CheckOutcome::Note(words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn check_forecasts_counts_forecasts_that_come_due() {
        let CheckOutcome::Note(words) = check_forecasts(28, &[7, 28, 84, 182]) else { panic!("a note") };
        assert_eq!(
            words,
            "forecasts that come due in 4 weeks: 4 for 7 days ahead, 1 for 28 days ahead, 0 for 84 days ahead, 0 \
             for 182 days ahead"
        );
        assert!(matches!(check_forecasts(182, &[7, 182]), CheckOutcome::Passed(_)));
        assert!(matches!(check_forecasts(181, &[7, 182]), CheckOutcome::Note(_)));
    }
}
