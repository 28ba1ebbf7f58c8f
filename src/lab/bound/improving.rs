//! Costs of improving the product: general development and R&D.

use super::premises::Premises;
use novamind_world::params::Params;

/// Returns the cost of general development, dollars.
pub fn global_development(premises: &Premises) -> f64 {
    premises.global_development * f64::from(premises.days)
}

/// Returns the cost of the R&D tiers, dollars.
pub fn research(premises: &Premises, params: &Params) -> f64 {
    (1..=premises.research_tiers).map(|tier| f64::from(params.research(tier).cost)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_tiers_and_daily_development_cost_what_was_published() {
        let (premises, params) = (Premises::of_the_paper(3.0), Params::shipped());
        assert_eq!(research(&premises, &params), 9_166_667.0);
        assert_eq!(global_development(&premises), 19_880_000.0);
    }
}
