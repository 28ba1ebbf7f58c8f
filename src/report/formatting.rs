//! Number formats and names that all reports use.

pub use novamind_base::formatting::pluralize;
use novamind_base::formatting::{compact_number, grouped_number, signed_dollars};
use novamind_insight::{BranchOrigin, FirstChange};
use novamind_session::{Category, MAX_RUNWAY_DAYS, Observation, Runway};

/// Formats dollars with the sign before the dollar sign: `$1,234`, `-$45`.
pub fn format_money(value: f64) -> String {
    let sign = if value < -0.5 { "-" } else { "" };
    format!("{sign}${}", grouped_number(value.abs(), 0))
}

/// Returns the name of a figure of the week on screens. The name of data and commands is that of the dashboard of the
/// release, in which enterprise leads are only the enterprises that requested an offer.
pub fn figure_name(name: &str) -> &str {
    if name == "enterprise leads" { "offer requests" } else { name }
}

/// Returns the label of a figure of the week. The unit is part of the label if neither the name nor the value shows it.
pub fn figure_label(name: &str) -> &str {
    match name {
        "recurring revenue" => "recurring $/month",
        name => figure_name(name),
    }
}

/// Returns the cash at the end of the last week if purchases on the same day have changed the cash since.
pub fn cash_before_purchases(seen: &Observation) -> Option<f64> {
    // The change of a started week in a debug run includes its days.
    let is_decision_day = seen.day.is_multiple_of(7);
    let before = seen.last_week.map_or(seen.starting_cash, |week| week.cash);
    (is_decision_day && (before - seen.cash).abs() >= 0.005).then_some(before)
}

/// Describes the last change in cash and its period: `+$1,234 over the last week`.
pub fn describe_cash_change(seen: &Observation) -> String {
    let span = match seen.cash_change_days {
        0 | 7 => "week".to_owned(),
        1 => "day".to_owned(),
        days => pluralize(days, "day"),
    };
    format!("{} over the last {span}", signed_dollars(seen.cash_change))
}

/// Describes how long cash should last, as an 80 % range: `cash should last 9 to 19 weeks`.
pub fn describe_runway(runway: &Runway) -> String {
    let whole = |weeks: f64| pluralize(weeks as u32, "week");
    match (runway.earliest, runway.latest) {
        (None, _) if runway.is_cut => {
            format!("cash should last at least {} weeks", MAX_RUNWAY_DAYS / 7)
        }
        (None, _) => "cash should last to the last day".to_owned(),
        (Some(least), None) => format!("cash should last at least {}", whole(least)),
        (Some(least), Some(most)) if least as u32 == most as u32 => {
            format!("cash should last {}", whole(most))
        }
        (Some(least), Some(most)) => format!("cash should last {} to {}", least as u32, whole(most)),
    }
}

/// Describes the origin of a branch: `branch of 1a2b3c4d from week 5, first change set_prices on day 28`.
pub fn describe_origin(origin: &BranchOrigin) -> String {
    let BranchOrigin { run, week, first_change } = origin;
    let change = first_change
        .as_ref()
        .map_or(String::new(), |change| format!(", first change {}", describe_first_change(change)));
    format!("branch of {run} from week {week}{change}")
}

/// Describes the first decision of a branch that differs from the parent run: `set_prices on day 28`, `no set_prices on
/// day 28`.
pub fn describe_first_change(change: &FirstChange) -> String {
    let FirstChange { day, what, is_left_out } = change;
    format!("{}{what} on day {day}", if *is_left_out { "no " } else { "" })
}

/// Describes the lengths of two compared weeks: `of 3 days, the previous week of 7`. Returns `None` if the lengths are
/// equal.
pub fn describe_short_week(days: u32, before: u32) -> Option<String> {
    (days != before).then(|| format!("of {}, the previous week of {before}", pluralize(days, "day")))
}

/// Returns the display name of a ledger category.
pub fn category_name(category: Category) -> &'static str {
    match category {
        Category::SubscriptionPayment => "payments",
        Category::AdRevenue => "ad revenue",
        Category::InitialFunding => "funding",
        Category::Compute => "compute",
        Category::Capacity => "capacity",
        Category::Advertising => "advertising",
        Category::LeadAcquisitionCost => "lead costs",
        Category::Operations => "operations",
        Category::Development => "development",
        Category::ResearchProject => "R&D",
        Category::MarketResearch => "market research",
        Category::GroupResearch => "group studies",
    }
}

/// Formats a number without decimals.
pub fn format_whole(value: f64) -> String {
    grouped_number(value + 0.0, 0)
}

/// Formats a number with at most two decimals.
pub fn format_number(value: f64) -> String {
    let value = value + 0.0;
    grouped_number(value, if value.fract() == 0.0 || value.abs() >= 10_000.0 { 0 } else { 2 })
}

/// Formats a range, with the lower endpoint rounded down and the upper endpoint rounded up: `18 to 87`.
pub fn format_range(least: f64, most: f64, decimals: usize) -> String {
    let unit = (0..decimals).fold(1.0, |unit, _| unit * 10.0);
    // The small term cancels rounding errors, so that whole multiples of the unit are not rounded away.
    let (least, most) = ((least * unit + 1e-9).floor() / unit, (most * unit - 1e-9).ceil() / unit);
    format!("{} to {}", grouped_number(least, decimals), grouped_number(most, decimals))
}

/// Formats the difference between two shares in percentage points: `9.3 pt`. Percent would be ambiguous for such
/// differences.
pub fn format_percentage_points(difference: f64, decimals: usize) -> String {
    format!("{} pt", grouped_number(100.0 * difference, decimals))
}

/// Formats the number in an axis label without trailing zeros: `1.5M`, `200k`, `0`.
pub fn format_tick(value: f64) -> String {
    let text = compact_number(value);
    let (digits, suffix) = match text.find(|letter: char| letter.is_ascii_alphabetic()) {
        Some(at) => text.split_at(at),
        None => (text.as_str(), ""),
    };
    let digits = match digits.contains('.') {
        true => digits.trim_end_matches('0').trim_end_matches('.'),
        false => digits,
    };
    format!("{digits}{suffix}")
}

/// Formats the dollar amount in an axis label.
pub fn format_dollar_tick(value: f64) -> String {
    let sign = if value < 0.0 { "-" } else { "" };
    format!("{sign}${}", format_tick(value.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_formatted() {
        assert_eq!([format_money(-1234.4), format_money(-0.2), format_money(5.0)], ["-$1,234", "$0", "$5"]);
        assert_eq!(
            [pluralize(1, "week"), pluralize(2, "day"), pluralize(1200, "lead"), pluralize(2, "company")],
            ["1 week", "2 days", "1,200 leads", "2 companies"]
        );
        assert_eq!(
            [format_tick(1_500_000.0), format_tick(200_000.0), format_tick(0.0), format_tick(120.0)],
            ["1.5M", "200k", "0", "120"]
        );
        assert_eq!(format_range(30.3 / 1.65, 30.3 / 0.35, 0), "18 to 87");
        assert_eq!(format_range(0.2, 0.4, 3), "0.200 to 0.400");
        assert_eq!(format_dollar_tick(-2_000_000.0), "-$2M");
        assert_eq!([format_number(12.0), format_number(0.25)], ["12", "0.25"]);
    }
}
