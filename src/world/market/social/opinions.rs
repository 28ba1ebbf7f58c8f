//! Opinions of subscribers: the weight of a subscriber's post, the subscriber's problems, and the most important theme
//! (docs/mechanics/market/social/opinions.md).

use super::chronicle::Chronicle;
use super::weights::PostWeightInputs;
use crate::context::DayContext;
use crate::customers::columns::Block;
use crate::events::{CustomerProblems, Opinion, PostCause, Theme};
use crate::identifiers::Group;
use crate::params::SocialParams;
use crate::quality::{quota_demand, quota_factor, relationship_as_read, relationship_bonus, service_penalty};

/// Inputs that all opinions of a day share.
#[derive(Clone, Copy)]
pub struct OpinionContext<'a> {
    /// Values that all customer mechanisms of the day share.
    pub day: &'a DayContext<'a>,
    /// Record of the company's last four weeks.
    pub chronicle: &'a Chronicle,
}

impl OpinionContext<'_> {
    #[inline]
    fn quota_factor(&self, block: &Block, at: usize) -> f64 {
        let rate = block.usage_rate[at];
        let demand = quota_demand(rate * self.day.morning.weekday, rate, self.day.params);
        quota_factor(self.day.morning.quotas[block.plan[at]], demand, &self.day.params.quality)
    }

    /// Returns today's problems of the subscriber in a row.
    #[inline]
    pub fn customer_problems(&self, block: &Block, at: usize) -> CustomerProblems {
        CustomerProblems {
            overload: self.day.service.overload > 0.0,
            outage: self.day.service.outage,
            issue: block.open_issue_days[at] > 0,
            quota: self.quota_factor(block, at) < 1.0,
        }
    }

    /// Returns the inputs of a subscriber's post weight. `before` is the satisfaction before today's update.
    #[inline]
    pub fn weight_inputs(&self, group: Group, block: &Block, at: usize, before: f64) -> PostWeightInputs {
        let satisfaction = block.satisfaction[at];
        PostWeightInputs {
            satisfaction,
            change: satisfaction - before,
            influencer: self.day.params.group(group).influencer,
            days_subscribed: self.day.day() - block.start_day[at],
            events: self.customer_problems(block, at).count(),
            // Contracts last only a month, so no customer is locked in.
            contract_locked: false,
            seats: if group.is_enterprise() { block.seats[at].trunc() } else { 1.0 },
        }
    }

    /// Returns the opinion of the subscriber in a row. `u` is a uniform draw.
    pub fn opinion(&self, group: Group, block: &Block, at: usize, before: f64, u: f64) -> Opinion {
        let customer_problems = self.customer_problems(block, at);
        let change = block.satisfaction[at] - before;
        let theme_weights = if block.satisfaction[at] < 0.0 {
            self.complaint_weights(group, block, at)
        } else {
            self.praise_weights(group, block, at)
        };
        Opinion {
            cause: post_cause(customer_problems, change, &self.day.params.social),
            customer_problems,
            theme: pick_theme(&theme_weights, u),
            days_subscribed: self.day.day() - block.start_day[at],
            plan: Some(block.plan[at]),
            price: block.effective_price[at],
            seats: block.seats[at] as u32,
            waiting_days: block.open_issue_days[at],
            downtime_minutes: self.day.service.downtime_minutes,
        }
    }

    /// Returns the themes that a subscriber can criticize, each with the quality that it costs.
    fn complaint_weights(&self, group: Group, block: &Block, at: usize) -> Vec<(Theme, f64)> {
        let quality = &self.day.params.quality;
        let delivered = self.day.morning.delivered(group, block.plan[at]);
        let (needed, share) = self.required_quality_and_budget_share(block, at);
        let shortage = (block.q_min[at] - delivered).max(0.0);
        let relationship = self.relationship(block, at);
        let issues = quality.issue_penalty_per_open_day * f64::from(block.open_issue_days[at]);
        let effect = self.day.ads.for_customer(group, block.customer[at]);
        vec![
            (Theme::Price, needed * share),
            (Theme::Quality, needed * (1.0 - share) + shortage),
            (Theme::Rivals, self.day.morning.expectations[group].quality),
            (Theme::Service, self.mean_penalty()),
            (Theme::Support, (-relationship).max(0.0) + issues),
            (Theme::Limits, (1.0 - self.quota_factor(block, at)) * delivered),
            (Theme::Ads, block.ads_quality_sensitivity[at] * effect),
        ]
    }

    /// Returns the themes that a subscriber can praise, each with the quality that it adds.
    fn praise_weights(&self, group: Group, block: &Block, at: usize) -> Vec<(Theme, f64)> {
        let quality = &self.day.params.quality;
        let delivered = self.day.morning.delivered(group, block.plan[at]);
        let surplus = (delivered - block.q_min[at]).max(0.0);
        let (_, share) = self.required_quality_and_budget_share(block, at);
        // Quality loss at full overload less the mean quality loss from bad service in recent weeks.
        let calm = (quality.service_overload_weight - self.mean_penalty()).max(0.0);
        vec![
            (Theme::Price, surplus * (1.0 - share)),
            (Theme::Quality, surplus * share),
            (Theme::Service, calm),
            (Theme::Support, self.relationship(block, at).max(0.0)),
            (Theme::Progress, self.chronicle.quality_change(group).max(0.0)),
            (Theme::Habit, self.day.tenure.bonus(self.day.day() - block.start_day[at])),
        ]
    }

    /// Returns two values for a subscriber: the quality required at the current price less the minimum quality, and
    /// the price as a share of the budget, 0..=1.
    fn required_quality_and_budget_share(&self, block: &Block, at: usize) -> (f64, f64) {
        let needed = (block.required[at] - block.q_min[at]).max(0.0);
        let budget = block.effective_c_max[at];
        let share = if budget > 0.0 { block.effective_price[at] / budget } else { 1.0 };
        (needed, share.clamp(0.0, 1.0))
    }

    fn relationship(&self, block: &Block, at: usize) -> f64 {
        let quality = &self.day.params.quality;
        relationship_bonus(relationship_as_read(block.relationship[at], quality), quality)
    }

    /// Returns the mean quality loss from overload and outages over the last two weeks.
    fn mean_penalty(&self) -> f64 {
        const DAYS: usize = 14;
        let penalty = |overload, outage| service_penalty(overload, outage, &self.day.params.quality);
        let pages = self.chronicle.newest_first(DAYS);
        let (sum, count) = pages
            .fold((0.0, 0.0), |(sum, count), page| (sum + penalty(page.overload, page.outage), count + 1.0));
        sum / count
    }
}

/// Returns the cause of a post: the first problem, otherwise a change in satisfaction, otherwise `General`.
pub fn post_cause(customer_problems: CustomerProblems, change: f64, params: &SocialParams) -> PostCause {
    match customer_problems {
        CustomerProblems { overload: true, .. } => PostCause::Overload,
        CustomerProblems { outage: true, .. } => PostCause::Outage,
        CustomerProblems { issue: true, .. } => PostCause::Issue,
        CustomerProblems { quota: true, .. } => PostCause::Quota,
        _ if change.abs() < params.satisfaction_change_threshold => PostCause::General,
        _ if change > 0.0 => PostCause::Improved,
        _ => PostCause::Declined,
    }
}

/// Picks a theme by weight with a uniform draw `u`. Returns `Quality` if all weights are zero.
pub fn pick_theme(theme_weights: &[(Theme, f64)], u: f64) -> Theme {
    let total: f64 = theme_weights.iter().map(|(_, worth)| worth).sum();
    let mut left = u * total;
    for (theme, worth) in theme_weights {
        if left < *worth {
            return *theme;
        }
        left -= worth;
    }
    Theme::Quality
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;

    #[test]
    fn problems_precede_satisfaction_changes() {
        let params = Params::bundled().social;
        let none = CustomerProblems::default();
        let all = CustomerProblems { overload: true, outage: true, issue: true, quota: true };
        for (customer_problems, change, expected) in [
            (all, 0.5, PostCause::Overload),
            (CustomerProblems { overload: false, ..all }, 0.5, PostCause::Outage),
            (CustomerProblems { issue: true, quota: true, ..none }, 0.0, PostCause::Issue),
            (CustomerProblems { quota: true, ..none }, -0.5, PostCause::Quota),
            (none, 0.02, PostCause::Improved),
            (none, -0.02, PostCause::Declined),
            (none, 0.019, PostCause::General),
        ] {
            assert_eq!(
                post_cause(customer_problems, change, &params),
                expected,
                "{customer_problems:?} {change}"
            );
        }
        assert_eq!(all.count(), 4);
    }

    #[test]
    fn themes_are_picked_by_weight() {
        let theme_weights = [(Theme::Price, 0.1), (Theme::Rivals, 0.0), (Theme::Quality, 0.3)];
        assert_eq!(pick_theme(&theme_weights, 0.0), Theme::Price);
        assert_eq!(pick_theme(&theme_weights, 0.24), Theme::Price);
        assert_eq!(pick_theme(&theme_weights, 0.26), Theme::Quality);
        assert_eq!(pick_theme(&[(Theme::Ads, 0.0)], 0.5), Theme::Quality);
    }
}
