//! N and p: the largest attainable market of a group and the highest price that the group supports.

use novamind_world::identifiers::Group;
use novamind_world::params::Params;

/// Returns the number of paying individuals or seats in a group.
pub fn attainable_customers(group: Group, params: &Params) -> f64 {
    let group_params = params.group(group);
    group_params.base_market_cap * f64::from(group_params.seat_count_max.unwrap_or(1))
}

/// Returns the highest price that a group supports, $ per customer or seat per month.
pub fn highest_price(group: Group, params: &Params) -> f64 {
    params.group(group).c_max_mean
}

/// Returns the revenue in dollars of a billing day on which all customers pay.
pub fn full_billing_revenue(group: Group, params: &Params) -> f64 {
    attainable_customers(group, params) * highest_price(group, params)
}

/// Returns the mean usage of all customers over the days of a week, units per day.
pub fn daily_usage(params: &Params) -> f64 {
    let week = params.calendar.weekly;
    let mean_day = week.iter().sum::<f64>() / week.len() as f64;
    let demand = |group| attainable_customers(group, params) * params.group(group).usage_demand_mean;
    mean_day * Group::all().map(demand).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attainable_market_counts_customers_and_seats() {
        let params = Params::bundled();
        let group = |id| Group::parse(id).expect("a group");
        assert_eq!(attainable_customers(group("S1"), &params), 272_000.0);
        assert_eq!(attainable_customers(group("E3"), &params), 136.0 * 2000.0);
        assert_eq!(full_billing_revenue(group("S1"), &params), 13_600_000.0);
        // The revenue of sixteen full billing days is slightly above the published revenue.
        let all: f64 = Group::all().map(|group| 16.0 * full_billing_revenue(group, &params)).sum();
        assert!((all / 1e6 - 6733.476).abs() < 1e-6, "{all}");
        assert!((daily_usage(&params) / 1e6 - 507.970279).abs() < 1e-6);
    }
}
