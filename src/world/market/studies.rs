//! Market studies of groups, which are paid for immediately and completed some days later
//! (docs/mechanics/market/discovery.md).

use super::Market;
use crate::events::{Facts, Notice, Snapshot, Study};
use crate::identifiers::Group;
use crate::params::{GroupResearch, Params};

/// Returns the default target level of a study: the current level, but at least the lowest target level.
pub fn default_target(level: u8, research: &GroupResearch) -> u8 {
    level.max(research.min_target_level)
}

impl Market {
    /// Returns the running study of a group, or `None` if no study of the group is in progress.
    pub fn running_study(&self, group: Group) -> Option<&Study> {
        self.studies.iter().find(|study| study.group == group)
    }

    /// Returns the study that starts if the player buys a study of a group on `day`.
    pub fn plan_study(&self, group: Group, target: u8, day: u32, params: &Params) -> Study {
        let due_day = day + params.study_level(target).delay_days;
        Study { group, target, before: self.knowledge[group].level, due_day }
    }
}

/// Completes due studies in the order of purchase. Raises the study level and takes a snapshot of this morning's
/// market.
pub fn complete_due_studies(day: u32, market: &mut Market, params: &Params, facts: &mut Facts) {
    let Market { studies, knowledge, drift, .. } = market;
    for study in studies.extract_if(.., |study| study.due_day <= day) {
        let group_knowledge = &mut knowledge[study.group];
        if study.target > group_knowledge.level {
            group_knowledge.level = study.target;
            group_knowledge.last_research_day = Some(day);
        }
        group_knowledge.snapshot = Some(Snapshot::take_snapshot(study.group, day, drift, params));
        facts.knowledge.push((study.group, *group_knowledge));
        facts
            .notices
            .push(Notice::StudyComplete { study, noise: params.study_level(group_knowledge.level).noise });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() < 1e-6, "got {actual}, expected {expected}");
    }

    fn buy_study(market: &mut Market, id: &str, target: u8, day: u32, params: &Params) -> Group {
        let group = Group::parse(id).expect("a group");
        let study = market.plan_study(group, target, day, params);
        market.studies.push(study);
        group
    }

    #[test]
    fn study_snapshot_is_taken_on_the_completion_morning() {
        let params = Params::bundled();
        let (mut market, mut facts) = (Market::initial(&params), Facts::default());
        let s1 = buy_study(&mut market, "S1", 2, 0, &params);
        market.drift.global_quality = 0.12;
        market.drift.quality[s1] = 0.03;
        market.drift.c_max[s1] = 0.5;
        complete_due_studies(2, &mut market, &params, &mut facts);
        assert_eq!(market.knowledge[s1].level, 1);
        complete_due_studies(3, &mut market, &params, &mut facts);
        let snapshot = market.knowledge[s1].snapshot.expect("a snapshot");
        assert_near(snapshot.c_max, 50.5);
        assert_near(snapshot.q_min, 0.25);
        assert_near(snapshot.market_cap, 272_447.123_288);
        assert_eq!((market.knowledge[s1].level, market.knowledge[s1].last_research_day), (2, Some(3)));

        buy_study(&mut market, "S1", 2, 7, &params);
        complete_due_studies(10, &mut market, &params, &mut facts);
        let snapshot = market.knowledge[s1].snapshot.expect("a snapshot");
        assert_near(snapshot.c_max, 50.5);
        assert_near(snapshot.q_min, 0.25);
        assert_near(snapshot.market_cap, 273_490.410_959);
        assert_eq!((market.knowledge[s1].level, market.knowledge[s1].last_research_day), (2, Some(3)));
        assert_eq!(facts.notices.len(), 2);
        assert!(market.studies.is_empty());
    }

    #[test]
    fn study_duration_follows_its_level() {
        let params = Params::bundled();
        let (mut market, mut facts) = (Market::initial(&params), Facts::default());
        for (day, target, due) in [(0, 2, 3), (14, 3, 19), (28, 4, 35), (42, 5, 52)] {
            let s1 = buy_study(&mut market, "S1", target, day, &params);
            assert_eq!(market.running_study(s1).map(|study| study.due_day), Some(due));
            complete_due_studies(due - 1, &mut market, &params, &mut facts);
            assert_eq!(market.knowledge[s1].level, target - 1);
            complete_due_studies(due, &mut market, &params, &mut facts);
            assert_eq!(market.knowledge[s1].level, target);
        }
    }

    #[test]
    fn studies_run_in_parallel_and_can_skip_levels() {
        let params = Params::bundled();
        let (mut market, mut facts) = (Market::initial(&params), Facts::default());
        let s1 = buy_study(&mut market, "S1", 5, 0, &params);
        let e2 = buy_study(&mut market, "E2", 2, 0, &params);
        complete_due_studies(3, &mut market, &params, &mut facts);
        assert_eq!((market.knowledge[s1].level, market.knowledge[e2].level), (1, 2));
        complete_due_studies(10, &mut market, &params, &mut facts);
        assert_eq!(market.knowledge[s1].level, 5);
        assert_eq!(facts.knowledge.iter().map(|(group, _)| group.id()).collect::<Vec<_>>(), ["E2", "S1"]);
        assert_eq!(
            (default_target(1, &params.group_research), default_target(4, &params.group_research)),
            (2, 4)
        );
    }
}
