//! Size limits for the next day. Without them, extreme parameters and budgets could create more customers than fit
//! into memory.

use crate::events::Facts;
use crate::identifiers::Group;
use crate::market::leads::{LeadContext, lead_factors};
use crate::market::{economy, surges, yields};
use crate::params::Params;
use crate::random::Streams;
use crate::state::World;

/// Maximum number of expected leads per day.
pub const MAX_LEADS_PER_DAY: u32 = 1_000_000;
/// Maximum number of subscribers, including the leads of the next day. An enterprise counts once.
pub const MAX_CUSTOMERS: u32 = 5_000_000;
/// Highest customer number. Lost leads use numbers too.
const MAX_CUSTOMER_NUMBERS: u32 = u32::MAX / 2;

/// A limit that the next day would exceed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExceededLimit {
    /// More than [`MAX_LEADS_PER_DAY`] leads are expected, or the expected number is NaN.
    Leads,
    /// The sum of subscribers and expected leads exceeds [`MAX_CUSTOMERS`].
    Customers,
    /// The leads need more customer numbers than remain.
    Numbers,
}

/// Returns the limit that the next day would exceed, or `None` if the day can be simulated.
pub fn exceeded_limit_on_next_day(
    world: &World,
    params: &Params,
    streams: &Streams,
) -> Option<ExceededLimit> {
    let leads = expected_leads(world, params, streams);
    let customers = world.customers.active_by_group().iter().map(|count| f64::from(*count)).sum::<f64>();
    if leads.is_nan() || leads > f64::from(MAX_LEADS_PER_DAY) {
        Some(ExceededLimit::Leads)
    } else if customers + leads > f64::from(MAX_CUSTOMERS) {
        Some(ExceededLimit::Customers)
    } else if f64::from(world.customers.next_customer) + leads > f64::from(MAX_CUSTOMER_NUMBERS) {
        Some(ExceededLimit::Numbers)
    } else {
        None
    }
}

/// Returns the expected number of leads of the next day. Ignores cancellations, posts and reputation changes on that
/// day.
fn expected_leads(world: &World, params: &Params, streams: &Streams) -> f64 {
    let day = world.day + 1;
    let mut market = world.market.clone();
    surges::draw_week_surges(day, world.last_day(params), &mut market.surges, params, streams);
    yields::vary_yields(day, &mut market.yields, params, streams);
    economy::step(day, &mut market.economy, false, params, streams, &mut Facts::default());
    let subscribers = world.customers.active_by_group();
    let context = LeadContext {
        day,
        calendar: params.calendar.lead_factor(day),
        market: &market,
        subscribers: &subscribers,
        ads: &world.settings.targeted_ads,
        params,
    };
    let known = Group::all().filter(|group| market.is_known(*group));
    known.map(|group| lead_factors(group, &context).expected()).sum()
}
