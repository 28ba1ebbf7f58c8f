//! Bills that fall due in a re-simulated week: renewals of individuals, and bills of enterprises.

use novamind_world::customers::columns::Block;
use novamind_world::events::{Facts, SubscriptionStatus};
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::params::Params;
use novamind_world::retention::due_today;
use novamind_world::state::World;

/// Upper ends of the bands of issue age, in days; older issues are in one more band.
const ISSUE_AGES: [u32; 7] = [0, 2, 4, 6, 9, 13, 20];
/// Number of bands of issue age. The first band contains subscribers without an open issue.
pub(crate) const ISSUE_BANDS: usize = ISSUE_AGES.len() + 1;

/// Bills of one group that fell due in a week, by the age of the open issue before the billing day.
pub(crate) type DueByIssue = [DueBills; ISSUE_BANDS];

/// Bills that fell due in a week. First bills of individuals are not included, because individuals pay them when they
/// sign up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct DueBills {
    /// Number of subscribers whose billing day fell in the week.
    pub bills: u32,
    /// Sum of the monthly prices of these subscribers, in dollars.
    pub dollars: f64,
    /// Sum of the payments of these subscribers in the week, in dollars.
    pub paid: f64,
    /// Number of individuals who cancelled instead of paying. Enterprises do not cancel on their billing day.
    pub cancelled: u32,
}

/// The subscribers who are due on a day.
pub(crate) struct DueToday<'a> {
    week: &'a mut ByGroup<DueByIssue>,
    /// Customer number, group and issue band of each subscriber.
    customers: Vec<(u32, Group, usize)>,
}

impl DueToday<'_> {
    /// Adds the renewals of the next day of `world` to the bills of a week. Must be called before that day is
    /// simulated, because individuals who cancel are removed.
    pub(crate) fn before_day<'a>(
        world: &World,
        params: &Params,
        week: &'a mut ByGroup<DueByIssue>,
    ) -> DueToday<'a> {
        let mut today = DueToday { week, customers: Vec::new() };
        today.add_due(world, params, world.day + 1, |group| !group.is_enterprise());
        today
    }

    /// Adds the outcomes of the renewals, and the bills of enterprises, after the day has been simulated. Enterprises
    /// are billed after all other events of a day, even if they became subscribers on that day.
    pub(crate) fn after_day(mut self, world: &World, params: &Params, facts: &Facts) {
        self.add_due(world, params, world.day, Group::is_enterprise);
        self.customers.sort_unstable();
        for payment in &facts.payments {
            if let Some(due) = self.due_of(payment.customer) {
                due.paid += payment.amount;
            }
        }
        let cancelled = facts.endings.iter().filter(|ending| ending.status == SubscriptionStatus::Cancelled);
        for ending in cancelled.filter(|ending| !ending.group.is_enterprise()) {
            if let Some(due) = self.due_of(ending.customer) {
                due.cancelled += 1;
            }
        }
    }

    fn add_due(&mut self, world: &World, params: &Params, day: u32, is_counted: impl Fn(Group) -> bool) {
        for (group, block) in world.customers.blocks().filter(|(group, _)| is_counted(*group)) {
            for at in due_today(block, day, params) {
                let band = issue_band(block, at);
                let due = &mut self.week[group][band];
                due.bills += 1;
                due.dollars += block.effective_price[at] * block.seats[at].trunc();
                self.customers.push((block.customer[at], group, band));
            }
        }
    }

    fn due_of(&mut self, customer: u32) -> Option<&mut DueBills> {
        let at = self.customers.binary_search_by_key(&customer, |(customer, ..)| *customer).ok()?;
        let (_, group, band) = self.customers[at];
        Some(&mut self.week[group][band])
    }
}

fn issue_band(block: &Block, at: usize) -> usize {
    ISSUE_AGES.partition_point(|age| *age < block.open_issue_days[at])
}
