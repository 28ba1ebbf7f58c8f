//! Costs of improving the product: general development and R&D.

use super::assumptions::BoundAssumptions;
use novamind_world::params::Params;

/// Returns the cost of general development over the account's days, dollars.
pub fn global_development_cost(premises: &BoundAssumptions) -> f64 {
    premises.global_development * f64::from(premises.days)
}

/// Returns the cost of the R&D projects, dollars.
pub fn research_cost(premises: &BoundAssumptions, params: &Params) -> f64 {
    (1..=premises.research_tiers).map(|tier| f64::from(params.research_tier(tier).cost)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn improvement_costs_equal_published_figures() {
        let (premises, params) = (BoundAssumptions::from_paper(3.0), Params::bundled());
        assert_eq!(research_cost(&premises, &params), 9_166_667.0);
        assert_eq!(global_development_cost(&premises), 19_880_000.0);
    }
}
