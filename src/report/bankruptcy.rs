//! Analysis of a bankruptcy: costs by kind and turning points.

use std::collections::BTreeMap;

use super::formatting::{format_money, format_whole, pluralize};
use novamind_record::figures::WeekFigures;

/// A kind of cost, with its share of all costs over the run.
#[derive(Debug, Clone, PartialEq)]
pub struct CostShare {
    pub name: &'static str,
    pub dollars: f64,
    /// Share of all costs, from 0 to 1.
    pub share: f64,
}

/// Kinds of cost and their ledger categories.
pub const COST_CATEGORIES: [(&str, &[&str]); 6] = [
    ("development and R&D", &["development", "research_project"]),
    ("ads and leads", &["advertising", "lead_acquisition_cost"]),
    ("compute", &["compute"]),
    ("capacity", &["capacity"]),
    ("operations", &["operations"]),
    ("market studies", &["market_research", "group_research"]),
];

/// Kinds of income and their ledger categories, excluding the initial funding.
pub const INCOME_CATEGORIES: [(&str, &[&str]); 2] =
    [("payments", &["subscription_payment"]), ("ad revenue", &["ad_revenue"])];

/// Returns costs by kind, highest cost first. Omits kinds without costs.
pub fn cost_shares(totals: &BTreeMap<&str, f64>) -> Vec<CostShare> {
    let spent = |names: &[&str]| -> f64 { names.iter().filter_map(|name| totals.get(name)).sum() };
    let mut all: Vec<(&'static str, f64)> =
        COST_CATEGORIES.iter().map(|(name, held)| (*name, -spent(held))).collect();
    all.retain(|(_, dollars)| *dollars > 0.0);
    all.sort_by(|left, right| right.1.total_cmp(&left.1));
    let sum: f64 = all.iter().map(|(_, dollars)| dollars).sum();
    all.into_iter().map(|(name, dollars)| CostShare { name, dollars, share: dollars / sum }).collect()
}

/// Describes turning points: the peak number of subscribers, the last profitable week, and the weeks before the
/// bankruptcy.
pub fn describe_turning_points(weeks: &[WeekFigures]) -> Vec<String> {
    let Some(last) = weeks.last() else { return Vec::new() };
    let mut texts = Vec::new();
    let high = |figure: fn(&WeekFigures) -> f64| {
        weeks.iter().rev().max_by(|left, right| figure(left).total_cmp(&figure(right)))
    };
    let people = |week: &WeekFigures| f64::from(week.individual_subscribers);
    match high(people).filter(|week| people(week) > 0.0) {
        None => texts.push("No one subscribed: there were costs and no income.".to_owned()),
        Some(top) if top.day < last.day => texts.push(format!(
            "Peak: {} on day {}; {} at the end.",
            pluralize(top.individual_subscribers, "subscriber"),
            top.day,
            format_whole(people(last))
        )),
        Some(top) => texts.push(format!(
            "The number of subscribers was still growing at the end: {}.",
            format_whole(people(top))
        )),
    }
    if let Some(week) = weeks.iter().rev().find(|week| week.cash_change > 0.0) {
        texts.push(format!("The last profitable week ended on day {}.", week.day));
    } else {
        texts.push("No week was profitable.".to_owned());
    }
    let recent = &weeks[weeks.len().saturating_sub(4)..];
    let mean = |figure: fn(&WeekFigures) -> f64| recent.iter().map(figure).sum::<f64>() / recent.len() as f64;
    let (income, costs) = (mean(|week| week.payments), mean(|week| week.costs));
    texts.push(format!(
        "In the last {}, income was {} a week and running costs {}.",
        pluralize(recent.len() as u32, "week"),
        format_money(income),
        format_money(costs)
    ));
    let shrinking_week = weeks.iter().find(|week| week.cancellations > week.new_individual_subscribers);
    if let Some(week) = shrinking_week.filter(|week| week.cancellations > 20) {
        texts.push(format!(
            "In the week to day {}, cancellations ({}) exceeded new subscribers ({}) for the first time.",
            week.day,
            format_whole(f64::from(week.cancellations)),
            format_whole(f64::from(week.new_individual_subscribers))
        ));
    }
    texts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample_week(
        day: u32,
        subscribers: u32,
        joined: u32,
        left: u32,
        payments: f64,
        costs: f64,
    ) -> WeekFigures {
        WeekFigures {
            day,
            individual_subscribers: subscribers,
            new_individual_subscribers: joined,
            cancellations: left,
            payments,
            costs,
            cash_change: payments - costs,
            ..WeekFigures::default()
        }
    }

    #[test]
    fn cost_shares_sum_to_one() {
        let totals = BTreeMap::from([
            ("initial_funding", 1000.0),
            ("subscription_payment", 300.0),
            ("development", -500.0),
            ("research_project", -100.0),
            ("advertising", -200.0),
            ("compute", 0.0),
        ]);
        let shares: Vec<(&str, f64, f64)> =
            cost_shares(&totals).iter().map(|cost| (cost.name, cost.dollars, cost.share)).collect();
        assert_eq!(shares, [("development and R&D", 600.0, 0.75), ("ads and leads", 200.0, 0.25)]);
        assert!(cost_shares(&BTreeMap::new()).is_empty());
    }

    #[test]
    fn turning_points_are_described() {
        let weeks = [
            sample_week(7, 100, 100, 0, 50.0, 40.0),
            sample_week(14, 150, 60, 10, 90.0, 120.0),
            sample_week(21, 90, 20, 80, 60.0, 160.0),
        ];
        assert_eq!(
            describe_turning_points(&weeks),
            [
                "Peak: 150 subscribers on day 14; 90 at the end.",
                "The last profitable week ended on day 7.",
                "In the last 3 weeks, income was $67 a week and running costs $107.",
                "In the week to day 21, cancellations (80) exceeded new subscribers (20) for the first time.",
            ]
        );
        assert!(
            describe_turning_points(&[sample_week(7, 0, 0, 0, 0.0, 9.0)])[0].starts_with("No one subscribed")
        );
        assert!(describe_turning_points(&[]).is_empty());
    }
}
