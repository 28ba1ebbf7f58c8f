//! The list of all tools.

use super::Tool;
use super::analytics::{GetSocialPosts, SetTargetedDevSpend, SetTargetedOpsSpend};
use super::infrastructure::{GetCostInfo, SetCapacityTier};
use super::marketing::{
    PostSocialMedia, SetAdsStrength, SetDailySpend, SetLeadPromotion, SetTargetedAdSpend,
};
use super::pricing::{SetModelTiers, SetPrices, SetPromotion, SetUsageQuotas};
use super::research::{ListResearchProjects, StartResearchProject};
use super::time::{GetVars, NextWeek, Query};

/// All tools, in the order in which they are shown.
pub static CATALOGUE: [&dyn Tool; 19] = [
    &SetPrices,
    &SetModelTiers,
    &SetUsageQuotas,
    &SetPromotion,
    &SetDailySpend,
    &SetTargetedAdSpend,
    &SetAdsStrength,
    &SetLeadPromotion,
    &PostSocialMedia,
    &GetSocialPosts,
    &SetTargetedOpsSpend,
    &SetTargetedDevSpend,
    &StartResearchProject,
    &ListResearchProjects,
    &SetCapacityTier,
    &GetCostInfo,
    &NextWeek,
    &Query,
    &GetVars,
];

/// The tool with this name; case counts. The module may stand before it: `pricing.set_prices`.
pub fn find(name: &str) -> Option<&'static dyn Tool> {
    CATALOGUE.into_iter().find(|tool| {
        let spec = tool.spec();
        spec.name == name
            || name
                .split_once('.')
                .is_some_and(|(module, rest)| module == spec.module.id() && rest == spec.name)
    })
}

/// Up to three names of tools that look like a name that does not exist.
pub fn nearest(name: &str) -> Vec<&'static str> {
    crate::notation::nearest(name, CATALOGUE.iter().map(|tool| tool.spec().name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tools_are_found_with_and_without_their_module() {
        assert_eq!(find("set_prices").map(|tool| tool.spec().name), Some("set_prices"));
        assert_eq!(find("pricing.set_prices").map(|tool| tool.spec().name), Some("set_prices"));
        assert!(find("marketing.set_prices").is_none());
        assert!(find("Set_Prices").is_none());
        assert_eq!(nearest("set_price")[0], "set_prices");
    }

    #[test]
    fn names_are_unique_and_examples_are_json() {
        let mut names: Vec<&str> = CATALOGUE.iter().map(|tool| tool.spec().name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), CATALOGUE.len());
        for tool in CATALOGUE {
            let example = serde_json::from_str::<serde_json::Value>(tool.spec().example);
            assert!(example.is_ok_and(|value| value.is_object()), "{}", tool.spec().name);
        }
    }
}
