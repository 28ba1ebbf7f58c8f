//! Tools for budgets, advertising, in-app advertising, first-bill discounts and posts.

mod post_social_media;
mod set_ads_strength;
mod set_daily_spend;
mod set_lead_promotion;
mod set_targeted_ad_spend;

pub use post_social_media::PostSocialMedia;
pub use set_ads_strength::SetAdsStrength;
pub use set_daily_spend::SetDailySpend;
pub use set_lead_promotion::SetLeadPromotion;
pub use set_targeted_ad_spend::SetTargetedAdSpend;

use super::arguments::AmountRule;
use super::spec::NumberRange;

/// Requirement for the amounts of daily budgets.
pub(super) const BUDGET_RULE: AmountRule = AmountRule {
    code: "amount_invalid",
    requirement: "must be a number of at least zero, in dollars a day",
    range: NumberRange::AT_LEAST_ZERO,
};
