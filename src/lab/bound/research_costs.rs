//! Costs of discovering and studying the groups.

use super::assumptions::BoundAssumptions;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;

/// Returns the expected cost of market research until every group is discovered, dollars.
pub fn market_research_cost(params: &Params) -> f64 {
    let unknown = Group::all().filter(|group| !group.is_initially_known()).count() as f64;
    let research = &params.market_research;
    unknown * research.discovery_cost_level_1 / research.market_research_discover_prob
}

/// Returns the cost of the market studies of all discovered groups, dollars.
pub fn group_research_cost(premises: &BoundAssumptions, params: &Params) -> f64 {
    let found = Group::all().filter(|group| !group.is_initially_known()).count() as f64;
    found * params.study_level(premises.study_level).cost
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_groups_need_67_attempts_and_20_studies() {
        let params = Params::bundled();
        assert!((market_research_cost(&params) - 20.0 * 25_000.0 / 0.3).abs() < 1e-6);
        assert_eq!(group_research_cost(&BoundAssumptions::from_paper(3.0), &params), 1_200_000.0);
    }
}
