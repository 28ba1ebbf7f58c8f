//! Sales funnel of enterprises: how many enterprises of each group arrived, requested an offer and signed.

use super::fit::{RangePosition, TrueValueRange};
use super::formatting::{format_whole, pluralize};
use novamind_session::identifiers::{ByGroup, Group, Plan};
use novamind_session::{DeliveredQuality, Estimates, GroupWeek, Session};

/// How many enterprises of a group reached each stage of the sales funnel, over the whole run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Funnel {
    /// Enterprise group that the other fields describe.
    pub group: Group,
    /// Number of enterprises that arrived, whether or not they requested an offer.
    pub enterprises: u32,
    /// Number of enterprises that requested an offer. The remaining enterprises found no plan with sufficient quality.
    pub requests: u32,
    /// Number of enterprises that signed a deal.
    pub deals: u32,
    /// Number of enterprises that found no plan with sufficient quality in the last four weeks.
    pub recently_lost: u32,
    /// The plan that delivers the highest quality to the group, and this quality; `None` if it is unknown.
    pub best_quality: Option<(Plan, f64)>,
    /// Quota of the plan with the highest quality, units per day.
    pub quota: f64,
    /// Estimated usage of the smallest enterprise, units per day.
    pub usage: TrueValueRange,
    /// Estimated mean required quality of the group.
    pub floor: TrueValueRange,
    /// Day for which required quality is estimated.
    pub study_day: u32,
}

/// Returns the funnel of every known enterprise group, in the fixed order of groups.
pub fn funnels(session: &Session) -> Vec<Funnel> {
    let (estimates, quality) = (session.company().estimates(), session.company().delivered_quality());
    let known = estimates.iter().filter(|group_estimates| group_estimates.group.is_enterprise());
    let quotas = session.settings().core.quotas;
    known
        .map(|group_estimates| {
            funnel(
                group_estimates,
                &quality,
                session.company().group_weeks(),
                &quotas.0.map(|quota| quota.units()),
            )
        })
        .collect()
}

fn funnel(
    estimates: &Estimates,
    quality: &[DeliveredQuality],
    weeks: &[ByGroup<GroupWeek>],
    quotas: &[f64; 3],
) -> Funnel {
    let lately = &weeks[weeks.len().saturating_sub(4)..];
    let sum_of = |weeks: &[ByGroup<GroupWeek>], figure: fn(&GroupWeek) -> u32| -> u32 {
        weeks.iter().map(|week| figure(&week[estimates.group])).sum()
    };
    let sum = |figure: fn(&GroupWeek) -> u32| sum_of(weeks, figure);
    let best = quality.iter().find(|quality| quality.group == estimates.group).and_then(|quality| {
        let plans = Plan::ALL.into_iter().map(|plan| (plan, quality.by_plan[plan]));
        plans.max_by(|left, right| left.1.total_cmp(&right.1))
    });
    Funnel {
        group: estimates.group,
        enterprises: sum(|week| week.leads),
        requests: sum(|week| week.asked),
        deals: sum(|week| week.signed),
        recently_lost: sum_of(lately, |week| week.leads - week.asked),
        best_quality: best,
        quota: best.map_or(0.0, |(plan, _)| quotas[plan.index()]),
        usage: estimates.account_usage_range().into(),
        floor: TrueValueRange::from_estimate(estimates.required_quality, estimates.max_relative_error),
        study_day: estimates.as_of,
    }
}

impl Funnel {
    /// Returns the number of enterprises that requested no offer because no plan had sufficient quality.
    pub fn lost_before_request(&self) -> u32 {
        self.enterprises.saturating_sub(self.requests)
    }

    /// Describes the funnel in one line. Adds the delivered and the required quality if some enterprises found no plan
    /// with sufficient quality in the last four weeks.
    pub fn describe(&self) -> String {
        let mut text = format!(
            "{}: {} arrived, {} found no plan good enough, {} requested an offer, {} signed",
            self.group,
            pluralize(self.enterprises, "enterprise"),
            format_whole(f64::from(self.lost_before_request())),
            format_whole(f64::from(self.requests)),
            format_whole(f64::from(self.deals))
        );
        if let Some((plan, delivered)) = self.best_quality.filter(|_| self.recently_lost > 0) {
            let (floor, day) = (self.floor.format_quality(), self.study_day);
            text += &format!(
                "; {plan} delivers {delivered:.4} now, and their mean required quality was {floor} on day {day}"
            );
            if self.usage.position_of(self.quota) != RangePosition::Above {
                text += &format!(
                    "; its quota is {} units a day, and the estimated usage of an enterprise with the fewest seats is {}",
                    format_whole(self.quota),
                    self.usage.format_units()
                );
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::trajectory::record::Via;
    use novamind_session::{NewRun, Storage};

    #[test]
    fn funnel_counts_match_the_tables() {
        let new = NewRun { seed: Some(11), cash: Some(2e7), storage: Storage::Memory, ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        let ads = json!({"E1": 4000, "E2": 4000, "E3": 4000});
        for (tool, arguments) in [
            ("set_prices", json!({"A": 14, "B": 32, "C": 55})),
            ("set_model_tiers", json!({"A": 4, "B": 4, "C": 4})),
            ("set_usage_quotas", json!({"A": 300, "B": 30_000, "C": 1_000_000})),
            ("set_targeted_dev_spend", json!({"targeted_spend": {"E1": 4000, "E2": 5000}})),
            ("set_targeted_ad_spend", json!({"targeted_spend": {"social_media": ads, "linkedin": ads}})),
            ("set_capacity_tier", json!({"tier": 5})),
        ] {
            session
                .call(tool, &arguments, Via::Script)
                .unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
        }
        for _ in 0..16 {
            let deals: Vec<_> = session
                .company()
                .observe()
                .waiting
                .iter()
                .map(|waiting_thread| json!([waiting_thread.customer, [["C", 4.0], ["B", 3.0]]]))
                .collect();
            if !deals.is_empty() {
                session
                    .call("send_enterprise_deal", &json!({ "deals": deals }), Via::Script)
                    .expect("offers");
            }
            let forecasts = session.company().naive_forecasts();
            session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
        }
        let all = funnels(&session);
        assert_eq!(all.iter().map(|funnel| funnel.group.id()).collect::<Vec<_>>(), ["E1", "E2", "E3"]);
        let mut number =
            |sql: String| novamind_database::number_at(&session.query(&sql).expect("rows").rows[0], 0) as u32;
        for funnel in &all {
            let group = funnel.group;
            let of = |table: &str, condition: &str| {
                format!(
                    "SELECT count(DISTINCT c.customer_id) FROM customers c {table} WHERE c.group_id = '{group}' {condition}"
                )
            };
            assert_eq!(funnel.enterprises, number(of("", "")), "{group}");
            let turns = "JOIN enterprise_turns t ON t.customer_id = c.customer_id";
            assert_eq!(funnel.requests, number(of(turns, "AND t.thread_type = 'new_lead'")), "{group}");
            let signed = "AND t.thread_type = 'new_lead' AND t.close_reason = 'accepted'";
            assert_eq!(funnel.deals, number(of(turns, signed)), "{group}");
        }
        assert!(
            all.iter().any(|funnel| funnel.deals > 0)
                && all.iter().any(|funnel| funnel.lost_before_request() > 0),
            "{all:?}"
        );
        let away = all.iter().find(|funnel| funnel.lost_before_request() > 0).expect("some");
        assert!(away.describe().contains("found no plan good enough"), "{}", away.describe());
        let lately = all.iter().find(|funnel| funnel.recently_lost > 0).expect("some, lately");
        assert!(
            lately.describe().contains(" delivers ")
                && lately.describe().contains(" now, and their mean required quality was ")
        );
    }
}
