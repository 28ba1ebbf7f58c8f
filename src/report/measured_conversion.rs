//! The measured conversion of a group, which is shown next to every estimate of its conversion.

use super::fit::LeadFlow;
use super::formatting::{format_whole, pluralize};
use novamind_base::formatting::percent;
use novamind_session::Session;
use novamind_session::identifiers::Group;
use novamind_tools::ToolId;

/// Number of weeks over which conversion is measured.
pub const MEASURED_WEEKS: usize = 4;

/// Settings by which leads judge the plans when they arrive. If one of them changes during the measured weeks, the
/// leads of these weeks did not all see the same plans.
pub const SETTINGS_JUDGED_BY_LEADS: [ToolId; 4] =
    [ToolId::SetPrices, ToolId::SetModelTiers, ToolId::SetUsageQuotas, ToolId::SetLeadPromotion];

/// Number of leads of a group in the last weeks, and number of those leads that took a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredConversion {
    /// Number of individuals who signed up, or number of enterprises that requested an offer.
    pub taken: u32,
    /// Number of leads that arrived in the measured weeks.
    pub leads: u32,
    /// First and last measured week; `None` before the first week.
    pub weeks: Option<(u32, u32)>,
    /// Days on which the plans changed after the start of the measured weeks, in ascending order.
    pub changed_on: Vec<u32>,
    is_enterprise: bool,
}

impl MeasuredConversion {
    /// Measures the conversion of a group over the last weeks.
    pub fn of_group(session: &Session, group: Group) -> MeasuredConversion {
        let company = session.company();
        let all = company.group_weeks();
        let recent = &all[all.len().saturating_sub(MEASURED_WEEKS)..];
        let flow = LeadFlow::sum(recent.iter().map(|week| &week[group]));
        let last = all.len() as u32;
        let start = session.day().saturating_sub(7 * recent.len() as u32);
        let today = company.setting_changes();
        let decided = company.decisions().iter().map(|decisions| (decisions.day, &decisions.changes));
        let days = decided
            .chain([(session.day(), &today)])
            // A change at the start of the measured weeks affects all leads in these weeks.
            .filter(|(day, _)| *day > start)
            .filter(|(_, changes)| {
                changes.iter().any(|change| SETTINGS_JUDGED_BY_LEADS.contains(&change.setting.tool()))
            })
            .map(|(day, _)| day);
        MeasuredConversion {
            taken: if group.is_enterprise() { flow.requests } else { flow.signups },
            leads: flow.leads,
            weeks: (!recent.is_empty()).then(|| (last + 1 - recent.len() as u32, last)),
            changed_on: days.collect(),
            is_enterprise: group.is_enterprise(),
        }
    }

    /// Returns the share of leads that took a plan, or `None` if there are no leads.
    pub fn share(&self) -> Option<f64> {
        (self.leads > 0).then(|| f64::from(self.taken) / f64::from(self.leads))
    }

    /// Describes the measurement: `measured 26.1%: 321 of 1,230 leads in weeks 4 to 7`.
    pub fn describe(&self) -> String {
        let Some(weeks) = self.describe_weeks() else {
            return "not measured yet, because no week has been simulated".to_owned();
        };
        let Some(share) = self.share() else { return format!("not measured: no leads in {weeks}") };
        let whole = |count: u32| format_whole(f64::from(count));
        let asked = if self.is_enterprise { " asked for an offer" } else { "" };
        let changed = self.describe_changes();
        format!(
            "measured {}: {} of {} leads{asked} in {weeks}{changed}",
            percent(share, 1),
            whole(self.taken),
            whole(self.leads)
        )
    }

    /// Describes the days on which the plans changed, because leads before and after them saw different plans.
    fn describe_changes(&self) -> String {
        let days = |days: &[u32]| days.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
        match self.changed_on.as_slice() {
            [] => String::new(),
            [day] => format!("; you changed the plans on day {day}"),
            [earlier @ .., last] if earlier.len() < MEASURED_WEEKS => {
                format!("; you changed the plans on days {} and {last}", days(earlier))
            }
            [.., last] => format!(
                "; you changed the plans on {}, last on day {last}",
                pluralize(self.changed_on.len() as u32, "day")
            ),
        }
    }

    /// Describes the measurement briefly: `measured 26% of 1,230 leads`.
    pub fn describe_briefly(&self) -> String {
        match self.share() {
            Some(share) => {
                format!("measured {} of {} leads", percent(share, 0), format_whole(f64::from(self.leads)))
            }
            None => "not measured yet".to_owned(),
        }
    }

    fn describe_weeks(&self) -> Option<String> {
        let (first, last) = self.weeks?;
        Some(if first == last { format!("week {last}") } else { format!("weeks {first} to {last}") })
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::test_kit::{advance_weeks, play_weeks};
    use novamind_database::number_at;
    use novamind_record::trajectory::record::Via;

    fn group(id: &str) -> Group {
        Group::parse(id).expect("a group")
    }

    #[test]
    fn measured_conversion_matches_the_tables_of_the_last_four_weeks() {
        let mut session = play_weeks(6);
        let measured = MeasuredConversion::of_group(&session, group("S1"));
        let sql = "SELECT count(*), total(s.status IN ('subscribed', 'cancelled')) FROM customers c LEFT JOIN \
                   subscriptions s USING (customer_id) WHERE c.group_id = 'S1' AND c.created_day BETWEEN 15 AND 42";
        let rows = session.query(sql).expect("rows").rows;
        assert_eq!(
            (f64::from(measured.leads), f64::from(measured.taken)),
            (number_at(&rows[0], 0), number_at(&rows[0], 1))
        );
        assert_eq!((measured.weeks, measured.changed_on.as_slice()), (Some((3, 6)), [].as_slice()));
        let text = measured.describe();
        assert!(text.starts_with("measured ") && text.ends_with(" leads in weeks 3 to 6"), "{text}");
    }

    #[test]
    fn measurement_names_the_days_on_which_the_plans_changed() {
        let mut session = play_weeks(5);
        session.call("set_prices", &json!({"A": 19}), Via::Script).expect("a price");
        let measured = MeasuredConversion::of_group(&session, group("S1"));
        assert!(
            measured.describe().ends_with("; you changed the plans on days 14 and 35"),
            "{}",
            measured.describe()
        );
        advance_weeks(&mut session, 1);
        session.call("set_prices", &json!({"A": 18}), Via::Script).expect("a price");
        let measured = MeasuredConversion::of_group(&session, group("S1"));
        assert!(
            measured.describe().ends_with("; you changed the plans on days 35 and 42"),
            "{}",
            measured.describe()
        );
        let once = MeasuredConversion { changed_on: vec![35], ..measured.clone() };
        assert!(once.describe().ends_with("; you changed the plans on day 35"), "{}", once.describe());
        let often = MeasuredConversion { changed_on: (30..40).collect(), ..measured };
        assert!(
            often.describe().ends_with("; you changed the plans on 10 days, last on day 39"),
            "{}",
            often.describe()
        );
        advance_weeks(&mut session, 4);
        let measured = MeasuredConversion::of_group(&session, group("S1"));
        assert!(measured.changed_on.is_empty(), "all leads saw the new plans");
    }

    #[test]
    fn missing_measurements_are_explained() {
        let session = play_weeks(0);
        let measured = MeasuredConversion::of_group(&session, group("S1"));
        assert_eq!(measured.describe(), "not measured yet, because no week has been simulated");
        let measured = MeasuredConversion { weeks: Some((1, 1)), ..measured };
        assert_eq!(measured.describe(), "not measured: no leads in week 1");
        let asked = MeasuredConversion { taken: 2, leads: 8, is_enterprise: true, ..measured.clone() };
        assert_eq!(asked.describe(), "measured 25.0%: 2 of 8 leads asked for an offer in week 1");
        assert_eq!(
            (asked.describe_briefly(), measured.describe_briefly()),
            ("measured 25% of 8 leads".to_owned(), "not measured yet".to_owned())
        );
    }
}
