//! Enterprise churn: reasons, reputation damage, and candidates for posts.

use super::enterprise_customer::adjust_relationship;
use super::{EnterpriseStatus, NegotiationStep};
use crate::customers::columns::Subscriber;
use crate::events::{EndCause, SubscriptionEnded, SubscriptionStatus, ThreadKind};
use crate::identifiers::Group;
use crate::params::Params;
use crate::quality::{quota_demand, relationship_as_read, relationship_bonus};
use crate::random::Part;
use crate::reputation::{ReputationCause, event_damage};

/// An enterprise subscriber whose thread died today and that may post about the loss.
///
/// A thread that reappears reports the same loss again every day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LostEnterprise {
    /// Customer number, unique across all groups.
    pub customer: u32,
    /// Group to which the enterprise belongs.
    pub group: Group,
    /// Sequence number of the enterprise within its group.
    pub n: u32,
    /// Number of whole seats of the enterprise.
    pub seats: u32,
    /// Days since the subscription started; `None` if the subscription ended earlier.
    pub days_subscribed: Option<u32>,
    /// Kind of the thread: the reason why the thread was opened.
    pub kind: ThreadKind,
    /// Side whose silence ended the thread.
    pub failure: ThreadFailure,
}

/// The side whose silence ended a thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ThreadFailure {
    /// The enterprise ended the thread without a reply.
    Silence,
    /// The player did not answer before the deadline.
    Timeout,
}

/// Values that determine why an enterprise left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChurnFactors {
    /// Number of days for which the enterprise's issue has been open, or 0 if there is none.
    pub issue_days: u32,
    /// Shared quality of the plan, without targeted development: today's value if the enterprise stopped replying, and
    /// this morning's value after a timeout.
    pub shared_quality: f64,
    /// Quality bonus from the relationship.
    pub relationship_bonus: f64,
    /// Demand of the enterprise that is compared with the quota, units.
    pub demand: f64,
    /// Quota of the enterprise's plan, units.
    pub quota: f64,
}

/// Returns the first reason that explains why an enterprise left.
pub fn churn_reason(blame: ThreadFailure, grounds: &ChurnFactors, params: &Params) -> EndCause {
    let sales = &params.enterprise;
    let poor = match blame {
        ThreadFailure::Silence => {
            let quality = (grounds.shared_quality + grounds.relationship_bonus)
                .clamp(params.quality.negotiation_quality_min, params.quality.negotiation_quality_max);
            quality - sales.churn_reason_quality_reference < sales.churn_reason_quality_gap
        }
        ThreadFailure::Timeout => grounds.shared_quality < sales.timeout_quality_reason_threshold,
    };
    if grounds.issue_days >= sales.extended_issue_days {
        EndCause::ExtendedIssue
    } else if poor {
        EndCause::QualityChange
    } else if blame == ThreadFailure::Silence && grounds.demand > grounds.quota {
        EndCause::QuotaChange
    } else {
        EndCause::PriceSensitivity
    }
}

impl NegotiationStep<'_> {
    /// Ends the subscription of the thread's customer. Damages the reputation even if the subscription already ended,
    /// so a thread that reappears damages the reputation every day.
    pub(super) fn lose_subscriber(&mut self, thread: usize, blame: ThreadFailure, relationship_delta: f64) {
        let thread_state = &self.enterprise.threads[thread];
        let (customer, group, kind, number) =
            (thread_state.customer, thread_state.group, thread_state.kind, thread_state.number);
        let Some(at) = self.enterprise.enterprise_position(customer) else { return };
        let n = self.enterprise.companies[at].n;
        let left = self.customers.groups[group].deactivate(n);
        if let Some(row) = left {
            let ending = self.subscription_ending(at, &row, blame);
            self.facts.endings.push(ending);
            self.enterprise.companies[at].status = EnterpriseStatus::Lost(row);
        }
        let sales = &self.day.params.enterprise;
        let company = &mut self.enterprise.companies[at];
        let Some(row) = company.row(self.customers) else { return };
        let relationship = adjust_relationship(row.relationship, relationship_delta, sales);
        company.set_relationship(relationship, self.customers);
        self.damage_reputation(group, n, number);
        self.result.lost.push(LostEnterprise {
            customer,
            group,
            n: row.n,
            seats: row.seats as u32,
            days_subscribed: left.map(|row| self.today() - row.start_day),
            kind,
            failure: blame,
        });
    }

    fn subscription_ending(
        &self,
        company: usize,
        row: &Subscriber,
        blame: ThreadFailure,
    ) -> SubscriptionEnded {
        let company = &self.enterprise.companies[company];
        let today = self.today();
        SubscriptionEnded {
            subscription: company.subscription,
            customer: company.customer,
            group: company.group,
            seats: row.seats as u32,
            // After a timeout, the enterprise leaves today, but the recorded last day is the end of the agreed month.
            day: match blame {
                ThreadFailure::Silence => today,
                ThreadFailure::Timeout => company.contract_end_day.max(today),
            },
            status: SubscriptionStatus::Cancelled,
            cause: churn_reason(blame, &self.churn_factors(row, blame), self.day.params),
        }
    }

    fn churn_factors(&self, row: &Subscriber, blame: ThreadFailure) -> ChurnFactors {
        let (morning, params) = (self.day.morning, self.day.params);
        let quality = &params.quality;
        let shared = match blame {
            ThreadFailure::Silence => quality.base_product_quality + self.context.product.shared_bonus,
            ThreadFailure::Timeout => morning.shared_quality,
        };
        let relationship = relationship_as_read(row.relationship, quality);
        ChurnFactors {
            issue_days: row.open_issue_days.saturating_sub(params.issues.new_issue_open_days),
            shared_quality: shared * morning.multipliers[row.plan],
            relationship_bonus: relationship_bonus(relationship, quality),
            demand: quota_demand(row.usage_rate, row.usage_rate, params),
            quota: morning.quotas[row.plan],
        }
    }

    fn damage_reputation(&mut self, group: Group, n: u32, thread: u32) {
        let keys = [u64::from(self.today()), group.index() as u64, u64::from(n), u64::from(thread)];
        let u = self.day.streams.open(Part::ReputationEvent, keys).uniform();
        let reputation = &self.day.params.reputation;
        let damage = event_damage(self.day.morning.subscribers[group], u, reputation);
        self.reputation.add_all(
            (group, ReputationCause::LostEnterprise),
            &[-damage],
            self.day.params,
            self.on_reputation_write,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn churn_reason_is_the_first_that_applies() {
        let params = Params::bundled();
        let quality = &params.quality;
        let grounds = |issue_days, shared: f64, relationship, demand| ChurnFactors {
            issue_days,
            shared_quality: quality.base_product_quality + shared,
            relationship_bonus: relationship_bonus(relationship, quality),
            demand,
            quota: 1000.0,
        };
        for (grounds, reason) in [
            (grounds(14, 0.6, 0.5, 0.0), EndCause::ExtendedIssue),
            (grounds(13, 0.6, 0.5, 0.0), EndCause::PriceSensitivity),
            (grounds(0, 0.14, 0.5, 0.0), EndCause::QualityChange),
            (grounds(0, 0.15, 0.5, 0.0), EndCause::QualityChange),
            (grounds(0, 0.0, 0.8, 0.0), EndCause::PriceSensitivity),
            (grounds(0, 0.6, 0.5, 1001.0), EndCause::QuotaChange),
            (grounds(0, 0.6, 0.5, 1000.0), EndCause::PriceSensitivity),
        ] {
            assert_eq!(churn_reason(ThreadFailure::Silence, &grounds, &params), reason, "{grounds:?}");
        }
        for (shared, reason) in [(0.1499, EndCause::QualityChange), (0.16, EndCause::PriceSensitivity)] {
            // After a timeout, relationship and quota are not considered as reasons.
            let grounds = grounds(0, shared, 0.0, 5000.0);
            assert_eq!(churn_reason(ThreadFailure::Timeout, &grounds, &params), reason, "{grounds:?}");
        }
    }
}
