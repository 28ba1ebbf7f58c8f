use super::*;
use crate::experiment::{ExperimentResults, test_kit};
use crate::policy::Policy;

/// Plays a policy against competitor settings.
fn play_arms(
    policy: &Policy,
    settings: &[CompetitorSetting],
    (days, until): (u32, u32),
) -> ExperimentResults {
    let mut arms = competitor_arms(policy, settings, days);
    arms.iter_mut().for_each(|arm| arm.spec.stop_after_day = Some(until));
    test_kit::play_arms(arms, 1..=2)
}

#[test]
fn copying_hurts_shared_and_draining_hurts_targeted_development() {
    let (shared, targeted) =
        (shared_development_probe().expect("a probe"), targeted_development_probe().expect("a probe"));
    let at = |results: &ExperimentResults, arm: usize| {
        results.figures_of_arm(arm, |run| f64::from(run.subscribers))
    };
    let pick = |all: &[CompetitorSetting], names: &[&str]| -> Vec<CompetitorSetting> {
        names
            .iter()
            .map(|name| {
                *all.iter().find(|competitor_setting| competitor_setting.name == *name).expect("a setting")
            })
            .collect()
    };
    let copy = play_arms(&shared, &pick(&COPY_SETTINGS, &["off", "default", "hard"]), (500, 105));
    for seed in 0..2 {
        let [off, default, hard] = [0, 1, 2].map(|arm| at(&copy, arm)[seed]);
        assert!(off > default && default >= hard, "{off} {default} {hard}");
    }
    // If all development is targeted, default and hard competitors have the same effect. The drained share does have
    // an effect.
    let drain = play_arms(
        &targeted,
        &pick(&DRAIN_SETTINGS, &["no drain", "default", "hard", "drain to 0.2"]),
        (500, 105),
    );
    assert_eq!(at(&drain, 1), at(&drain, 2));
    let cash = |arm: usize| drain.figures_of_arm(arm, |run| run.cash);
    assert_eq!(cash(1), cash(2));
    assert!(at(&drain, 0)[0] > at(&drain, 3)[0], "{:?} {:?}", at(&drain, 0), at(&drain, 3));
}

#[test]
fn first_50_days_have_no_competitors_or_drift() {
    let rivals: Vec<CompetitorSetting> = COPY_SETTINGS
        .into_iter()
        .filter(|competitor_setting| ["off", "default", "hard"].contains(&competitor_setting.name))
        .collect();
    let probe = shared_development_probe().expect("a probe");
    let results = play_arms(&probe, &rivals, (SHORT_DAYS, SHORT_DAYS));
    let cash = |arm: usize| results.figures_of_arm(arm, |run| run.cash);
    assert!(cash(0) == cash(1) && cash(1) == cash(2));
    let short = [ShortRun { name: "the probe", settings: &rivals, results: &results }];
    let axis = AblationAxis {
        name: "copy",
        caption: "the probe".to_owned(),
        policy: "probe",
        settings: &rivals,
        results: &results,
    };
    let exhibit = ablation_report(&[axis], &short, 49);
    let runs = exhibit.table("runs").expect("every run").to_csv_rows();
    assert_eq!(runs.len(), 1 + 2 * 3 * 2, "axis and short runs, three settings, two seeds");
    assert_eq!(runs[1][..4], ["copy", "probe", "off", "1"]);
    assert_eq!(runs[12][..4], ["short", "the probe", "hard", "2"]);
    assert_eq!(runs[1][7], results.by_arm[0][0].cash.to_string());
    let text = exhibit.to_text(100);
    assert!(
        text.contains("neither competitors nor drift") && text.contains("identical for 2 of 2"),
        "{text}"
    );
    let named: Vec<&str> = short_run_policies().expect("policies").iter().map(|(name, _)| *name).collect();
    assert_eq!(named, ["the paper's baseline", "ads from day 0"]);
}

#[test]
fn rebased_arms_keep_their_competitors() {
    let configuration = novamind_record::folder::configuration::Configuration::bundled();
    let arms = competitor_arms(&shared_development_probe().expect("a probe"), &DRAIN_SETTINGS, 500);
    let arms = rebase_arms(arms, "release-2", &configuration).expect("arms");
    let scenario = configuration.load_scenario("release-2").expect("a scenario");
    let params = |name: &str| {
        let arm = arms.iter().find(|arm| arm.name == name).expect("an arm");
        assert_eq!(arm.spec.scenario.as_deref(), Some("release-2"));
        configuration.load_parameters(&scenario, &arm.spec.overrides, true).expect("parameters")
    };
    assert_eq!(params("default"), configuration.load_parameters(&scenario, &[], true).expect("parameters"));
    assert!(params("off").competitor.competitor_events_disabled);
    assert_eq!(params("hard").competitor.competitor_feedback_u_max, 0.8);
    assert_eq!(params("drain to 0.2").competitor.competitor_segment_drain_u_max, 0.2);
}
