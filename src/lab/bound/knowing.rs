//! Costs of finding and studying the groups.

use super::premises::Premises;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;

/// Returns the mean cost of market research until every group is found, dollars.
pub fn market_research(params: &Params) -> f64 {
    let unknown = Group::all().filter(|group| !group.initially_known()).count() as f64;
    let law = &params.market_research;
    unknown * law.discovery_cost_level_1 / law.market_research_discover_prob
}

/// Returns the cost of a study of every found group, dollars.
pub fn group_research(premises: &Premises, params: &Params) -> f64 {
    let found = Group::all().filter(|group| !group.initially_known()).count() as f64;
    found * params.level(premises.study_level).cost
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_groups_take_sixty_seven_attempts_and_twenty_studies() {
        let params = Params::shipped();
        assert!((market_research(&params) - 20.0 * 25_000.0 / 0.3).abs() < 1e-6);
        assert_eq!(group_research(&Premises::of_the_paper(3.0), &params), 1_200_000.0);
    }
}
