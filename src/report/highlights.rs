//! Highlights: notable days of a run.

use super::formatting::{format_money, format_whole, pluralize};
use novamind_base::formatting::signed_dollars;
use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::RunEndReason;

/// A notable day of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Highlight {
    /// Day of the run on which the event occurred.
    pub day: u32,
    /// Description of the event on this day.
    pub text: String,
}

/// Maximum number of outages that are listed one by one. Further outages are only counted.
const MAX_LISTED_OUTAGES: usize = 3;

/// Returns the highlights of a run, sorted by day.
pub fn highlights(
    weeks: &[WeekFigures],
    cash_by_day: &[f64],
    outages: &[(u32, u32)],
    ended: Option<RunEndReason>,
) -> Vec<Highlight> {
    let mut found: Vec<Highlight> = Vec::new();
    let mut add = |day: u32, text: String| found.push(Highlight { day, text });
    add_first_times(weeks, &mut add);
    add_extremes(weeks, cash_by_day, &mut add);
    for (day, minutes) in outages.iter().take(MAX_LISTED_OUTAGES) {
        add(*day, format!("outage of {}", pluralize(*minutes, "minute")));
    }
    if let Some((day, _)) = outages.last().filter(|_| outages.len() > MAX_LISTED_OUTAGES) {
        let more = pluralize((outages.len() - MAX_LISTED_OUTAGES) as u32, "more outage");
        add(*day, format!("last of {more}"));
    }
    let last = cash_by_day.len().saturating_sub(1) as u32;
    if ended == Some(RunEndReason::Bankruptcy) {
        add(last, "bankrupt".to_owned());
    }
    found.sort_by_key(|highlight| highlight.day);
    found
}

fn add_first_times(weeks: &[WeekFigures], add: &mut impl FnMut(u32, String)) {
    let first = |fits: fn(&WeekFigures) -> bool| weeks.iter().find(|week| fits(week));
    if let Some(week) = first(|week| week.individual_subscribers > 0) {
        add(
            week.day,
            format!("first subscribers: {} that week", format_whole(f64::from(week.individual_subscribers))),
        );
    }
    if let Some(week) = first(|week| week.enterprise_seats > 0) {
        let seats = pluralize(week.enterprise_seats, "seat");
        add(week.day, format!("first enterprise signed that week: {seats}"));
    }
    if let Some(week) = first(|week| week.cash_change > 0.0) {
        add(week.day, format!("first profitable week: {}", signed_dollars(week.cash_change)));
    }
}

fn add_extremes(weeks: &[WeekFigures], cash_by_day: &[f64], add: &mut impl FnMut(u32, String)) {
    // Best and worst weeks are listed only if there are at least three weeks.
    if weeks.len() >= 3 {
        let by_change =
            |left: &&WeekFigures, right: &&WeekFigures| left.cash_change.total_cmp(&right.cash_change);
        // A week that the end of the run shortened cannot be the best week, because it has fewer days in which to lose
        // cash.
        let whole = weeks.iter().map(|week| week.days_run).max();
        let complete = weeks.iter().filter(|week| Some(week.days_run) == whole);
        if let Some(best) = complete.max_by(by_change) {
            add(best.day, format!("best week for cash: {}", signed_dollars(best.cash_change)));
        }
        if let Some(worst) = weeks.iter().min_by(by_change) {
            add(worst.day, format!("worst week for cash: {}", signed_dollars(worst.cash_change)));
        }
    }
    if let Some(week) = peak_week(weeks, |week| week.individual_subscribers) {
        add(week.day, format!("peak subscribers: {}", format_whole(f64::from(week.individual_subscribers))));
    }
    if let Some(week) = peak_week(weeks, |week| week.enterprise_seats) {
        add(week.day, format!("peak enterprise seats: {}", format_whole(f64::from(week.enterprise_seats))));
    }
    if let Some((day, cash)) = highest_cash(cash_by_day).filter(|(day, _)| *day > 0) {
        add(day, format!("peak cash: {}", format_money(cash)));
    }
    if let Some((day, cash)) = lowest_cash(cash_by_day).filter(|(day, cash)| *day > 0 && *cash >= 0.0) {
        add(day, format!("lowest cash: {}", format_money(cash)));
    }
}

/// Returns the first week in which a figure has its highest value.
pub fn peak_week(weeks: &[WeekFigures], figure: fn(&WeekFigures) -> u32) -> Option<&WeekFigures> {
    weeks.iter().rev().max_by_key(|week| figure(week)).filter(|week| figure(week) > 0)
}

/// Returns the first day with the highest cash, and the cash in dollars.
pub fn highest_cash(cash_by_day: &[f64]) -> Option<(u32, f64)> {
    let days = cash_by_day.iter().enumerate().rev();
    days.max_by(|left, right| left.1.total_cmp(right.1)).map(|(day, cash)| (day as u32, *cash))
}

/// Returns the first day with the lowest cash, and the cash in dollars.
pub fn lowest_cash(cash_by_day: &[f64]) -> Option<(u32, f64)> {
    let days = cash_by_day.iter().enumerate();
    days.min_by(|left, right| left.1.total_cmp(right.1)).map(|(day, cash)| (day as u32, *cash))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn week(day: u32, subscribers: u32, seats: u32, cash_change: f64) -> WeekFigures {
        WeekFigures {
            day,
            days_run: 7,
            individual_subscribers: subscribers,
            enterprise_seats: seats,
            cash_change,
            ..WeekFigures::default()
        }
    }

    #[test]
    fn highlights_are_ordered_by_day() {
        let weeks =
            [week(7, 0, 0, -50.0), week(14, 30, 0, 20.0), week(21, 30, 12, 90.0), week(28, 10, 12, -200.0)];
        let mut cash = vec![100.0; 29];
        (cash[21], cash[28]) = (160.0, -40.0);
        let outages = [(3, 30), (9, 10), (10, 20), (11, 5), (25, 40)];
        let found = highlights(&weeks, &cash, &outages, Some(RunEndReason::Bankruptcy));
        let lines: Vec<String> = found.iter().map(|one| format!("{} {}", one.day, one.text)).collect();
        assert_eq!(
            lines,
            [
                "3 outage of 30 minutes",
                "9 outage of 10 minutes",
                "10 outage of 20 minutes",
                "14 first subscribers: 30 that week",
                "14 first profitable week: +$20",
                "14 peak subscribers: 30",
                "21 first enterprise signed that week: 12 seats",
                "21 best week for cash: +$90",
                "21 peak enterprise seats: 12",
                "21 peak cash: $160",
                "25 last of 2 more outages",
                "28 worst week for cash: -$200",
                "28 bankrupt",
            ]
        );
        assert!(highlights(&[], &[100.0], &[], None).is_empty());
    }

    #[test]
    fn partial_week_before_bankruptcy_is_never_the_best_week() {
        let cut_short = WeekFigures { days_run: 2, ..week(23, 0, 0, -10.0) };
        let weeks = [week(7, 0, 0, -50.0), week(14, 0, 0, -40.0), week(21, 0, 0, -60.0), cut_short];
        let found = highlights(&weeks, &[100.0; 24], &[], Some(RunEndReason::Bankruptcy));
        let best = found.iter().find(|one| one.text.contains("best week")).expect("a best week");
        assert_eq!((best.day, best.text.as_str()), (14, "best week for cash: -$40"));
    }
}
