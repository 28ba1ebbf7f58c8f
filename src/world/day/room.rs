//! Whether the next day has room for those who come: parameters and budgets can ask for more people than a machine holds.

use crate::events::Facts;
use crate::identifiers::Group;
use crate::market::leads::{LeadContext, lead_factors};
use crate::market::{economy, surges, yields};
use crate::params::Params;
use crate::random::Streams;
use crate::state::World;

/// Leads that a day holds at most, as they are expected: most of all markets of the release at once.
pub const MOST_LEADS_A_DAY: u32 = 1_000_000;
/// Subscribers and companies that a world holds at most, those of the next day included.
pub const MOST_CUSTOMERS: u32 = 5_000_000;
/// Numbers that are given to leads, the lost ones included.
const MOST_NUMBERS: u32 = u32::MAX / 2;

/// What a day has no room for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoRoom {
    /// More than [`MOST_LEADS_A_DAY`] are expected, or their number is none.
    Leads,
    /// With its leads there could be more than [`MOST_CUSTOMERS`].
    Customers,
    /// There are no numbers left for leads.
    Numbers,
}

/// What the day after the present one has no room for; none if it can be simulated.
pub fn room_for_next_day(world: &World, params: &Params, streams: &Streams) -> Option<NoRoom> {
    let leads = expected_leads(world, params, streams);
    let customers = world.customers.active().iter().map(|count| f64::from(*count)).sum::<f64>();
    if leads.is_nan() || leads > f64::from(MOST_LEADS_A_DAY) {
        Some(NoRoom::Leads)
    } else if customers + leads > f64::from(MOST_CUSTOMERS) {
        Some(NoRoom::Customers)
    } else if f64::from(world.customers.next_customer) + leads > f64::from(MOST_NUMBERS) {
        Some(NoRoom::Numbers)
    } else {
        None
    }
}

/// Leads of the next day as they will be expected, if nobody cancels and no post or reputation moves until they come.
fn expected_leads(world: &World, params: &Params, streams: &Streams) -> f64 {
    let day = world.day + 1;
    let mut market = world.market.clone();
    surges::draw_week(day, world.total_days, &mut market.surges, params, streams);
    yields::vary(day, &mut market.yields, params, streams);
    economy::step(day, &mut market.economy, false, params, streams, &mut Facts::default());
    let subscribers = world.customers.active();
    let context = LeadContext {
        day,
        calendar: params.calendar.of_leads(day),
        market: &market,
        subscribers: &subscribers,
        ads: &world.settings.targeted_ads,
        params,
    };
    let known = Group::all().filter(|group| market.is_known(*group));
    known.map(|group| lead_factors(group, &context).expected()).sum()
}
