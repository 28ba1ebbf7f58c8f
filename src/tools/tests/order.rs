//! Where a call is wrong in two ways, the check that comes first in the tool answers.

use serde_json::json;

use super::Company;

#[test]
fn a_project_that_is_running_comes_before_the_money_it_would_take() {
    let mut company = Company::new();
    company.call("start_research_project", json!({"tier": 2}));
    company.world.finance.cash = 1.0;
    for (tier, code) in [(0, "rd_tier_unknown"), (2, "rd_in_progress"), (1, "insufficient_funds")] {
        assert_eq!(company.refused("start_research_project", json!({"tier": tier})).0, code, "tier {tier}");
    }
}
