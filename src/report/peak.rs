//! Projected peak usage of next week: usage on the busiest day of the last week, multiplied by the growth of this usage
//! since the week before. Every text states that the value is a projection.

use super::formatting::format_whole;
use novamind_base::formatting::percent;
use novamind_record::figures::WeekFigures;

/// Usage on the busiest day of the last week, and the growth of this usage since the week before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakProjection {
    /// Usage on the busiest day of the last week, units.
    pub peak_usage: f64,
    /// Ratio of `peak_usage` to the usage on the busiest day of the week before.
    pub growth: f64,
}

impl PeakProjection {
    /// Returns the projection, or `None` if one of the last two weeks is incomplete or has no usage.
    pub fn from_weeks(weeks: &[WeekFigures]) -> Option<PeakProjection> {
        let [.., before, last] = weeks else { return None };
        let is_whole = |week: &WeekFigures| week.days_run == 7 && week.busiest_day > 0;
        (is_whole(before) && is_whole(last)).then(|| PeakProjection {
            peak_usage: last.busiest_day as f64,
            growth: last.busiest_day as f64 / before.busiest_day as f64,
        })
    }

    /// Returns the projected usage of next week's busiest day, units.
    pub fn next_peak(&self) -> f64 {
        self.peak_usage * self.growth
    }

    /// Compares the projected peak with a capacity tier: `at last week's growth (+12%), next week's peak is
    /// 61,000 units, 76% of tier 1`.
    pub fn describe(&self, tier: u32, units: f64) -> String {
        let share = percent(self.next_peak() / units.max(1.0), 0);
        format!(
            "at last week's growth ({}), next week's peak is {} units, {share} of tier {tier}",
            self.format_growth(),
            format_whole(self.next_peak())
        )
    }

    /// Formats growth with its sign: `+12%`.
    pub fn format_growth(&self) -> String {
        let growth = percent(self.growth - 1.0, 0);
        if growth.starts_with('-') { growth } else { format!("+{growth}") }
    }
}

/// Compares the usage that a capacity tier serves with the busiest day of the last week: `tier 1 serves 80,000 units a
/// day; the busiest day of the last week had 61,000, 76% of it`.
pub fn describe_peak_and_tier(weeks: &[WeekFigures], tier: u32, units: f64) -> String {
    let holds = format!("tier {tier} serves {} units a day", format_whole(units));
    match weeks.last() {
        None => format!("{holds}; no week has run yet"),
        Some(week) => {
            let busiest = week.busiest_day as f64;
            let share = percent(busiest / units.max(1.0), 0);
            format!("{holds}; the busiest day of the last week had {}, {share} of it", format_whole(busiest))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::play_weeks;
    use novamind_database::number_at;

    #[test]
    fn peak_projection_matches_the_tables() {
        let mut session = play_weeks(6);
        let projection = PeakProjection::from_weeks(session.weeks()).expect("two weeks with usage");
        let mut busiest = |from: u32| {
            let sql = format!(
                "SELECT max(total_usage_units) FROM service_day WHERE day > {from} AND day <= {from} + 7"
            );
            number_at(&session.query(&sql).expect("a maximum").rows[0], 0)
        };
        let (before, last) = (busiest(28), busiest(35));
        assert_eq!((projection.peak_usage, projection.next_peak()), (last, last * (last / before)));
        assert!(projection.describe(1, 200_000.0).contains(&format_whole(last * last / before)));
    }

    #[test]
    fn describe_peak_and_tier_compares_with_the_busiest_day() {
        let week = WeekFigures { days_run: 7, busiest_day: 61_000, ..WeekFigures::default() };
        assert_eq!(
            describe_peak_and_tier(&[week], 1, 80_000.0),
            "tier 1 serves 80,000 units a day; the busiest day of the last week had 61,000, 76% of it"
        );
        assert!(describe_peak_and_tier(&[], 1, 80_000.0).ends_with("no week has run yet"));
    }

    #[test]
    fn peak_projection_requires_two_whole_weeks() {
        let week = |days_run, busiest_day| WeekFigures { days_run, busiest_day, ..WeekFigures::default() };
        assert_eq!(PeakProjection::from_weeks(&[week(7, 50)]), None);
        assert_eq!(PeakProjection::from_weeks(&[week(7, 0), week(7, 50)]), None);
        assert_eq!(PeakProjection::from_weeks(&[week(7, 50), week(3, 50)]), None);
        let shrinks = PeakProjection::from_weeks(&[week(7, 50), week(7, 25)]).expect("two weeks");
        assert_eq!((shrinks.next_peak(), shrinks.format_growth().as_str()), (12.5, "-50%"));
    }
}
