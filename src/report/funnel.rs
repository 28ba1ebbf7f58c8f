//! Enterprises by group and stage: arrived, requested an offer, signed.

use super::fit::{Beside, TruthRange};
use super::words::{count, whole};
use novamind_session::identifiers::{ByGroup, Group, Plan};
use novamind_session::{DeliveredQuality, Estimates, GroupWeek, Session};

/// Enterprises of a group over the whole run, by stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Funnel {
    /// Group.
    pub group: Group,
    /// Enterprises that arrived.
    pub came: u32,
    /// Enterprises that requested an offer. The others found no plan with sufficient quality.
    pub asked: u32,
    /// Enterprises that signed.
    pub signed: u32,
    /// Enterprises that found no sufficient plan in the last four weeks.
    pub turned_away_lately: u32,
    /// The plan that delivers the highest quality to the group, and that quality.
    pub best: Option<(Plan, f64)>,
    /// Its quota, units a day.
    pub quota: f64,
    /// Usage of the smallest enterprise, units a day.
    pub usage: TruthRange,
    /// Mean required quality of the group.
    pub floor: TruthRange,
    /// Day of the estimate of required quality.
    pub as_of: u32,
}

/// Returns the funnel of every known group of enterprises, in their fixed order.
pub fn funnels(session: &Session) -> Vec<Funnel> {
    let (estimates, quality) = (session.company().estimates(), session.company().delivered_quality());
    let known = estimates.iter().filter(|own| own.group.is_enterprise());
    let quotas = session.settings().core.quotas;
    known
        .map(|own| {
            funnel(own, &quality, session.company().group_weeks(), &quotas.0.map(|quota| quota.units()))
        })
        .collect()
}

fn funnel(
    own: &Estimates,
    quality: &[DeliveredQuality],
    weeks: &[ByGroup<GroupWeek>],
    quotas: &[f64; 3],
) -> Funnel {
    let lately = &weeks[weeks.len().saturating_sub(4)..];
    let sum_of = |weeks: &[ByGroup<GroupWeek>], figure: fn(&GroupWeek) -> u32| -> u32 {
        weeks.iter().map(|week| figure(&week[own.group])).sum()
    };
    let sum = |figure: fn(&GroupWeek) -> u32| sum_of(weeks, figure);
    let best = quality.iter().find(|quality| quality.group == own.group).and_then(|quality| {
        let plans = Plan::ALL.into_iter().map(|plan| (plan, quality.by_plan[plan]));
        plans.max_by(|left, right| left.1.total_cmp(&right.1))
    });
    Funnel {
        group: own.group,
        came: sum(|week| week.leads),
        asked: sum(|week| week.asked),
        signed: sum(|week| week.signed),
        turned_away_lately: sum_of(lately, |week| week.leads - week.asked),
        best,
        quota: best.map_or(0.0, |(plan, _)| quotas[plan.index()]),
        usage: own.account_range().into(),
        floor: TruthRange::behind(own.floor, own.noise),
        as_of: own.as_of,
    }
}

impl Funnel {
    /// Returns the number of enterprises that found no plan with sufficient quality.
    pub fn turned_away(&self) -> u32 {
        self.came.saturating_sub(self.asked)
    }

    /// Describes the funnel in one line. Adds the comparison if enterprises turned away in the last four
    /// weeks.
    pub fn in_words(&self) -> String {
        let mut text = format!(
            "{}: {} arrived, {} found no plan good enough, {} requested an offer, {} signed",
            self.group,
            count(self.came, "enterprise"),
            whole(f64::from(self.turned_away())),
            whole(f64::from(self.asked)),
            whole(f64::from(self.signed))
        );
        if let Some((plan, delivered)) = self.best.filter(|_| self.turned_away_lately > 0) {
            let (floor, day) = (self.floor.quality(), self.as_of);
            text += &format!(
                "; {plan} delivers {delivered:.4}, their mean required quality is {floor} (as of day {day})"
            );
            if self.usage.beside(self.quota) != Beside::Above {
                text += &format!(
                    "; its quota is {}, the smallest enterprises need {} units a day",
                    whole(self.quota),
                    self.usage.units()
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
    fn companies_are_counted_as_the_tables_have_them() {
        let new = NewRun { seed: Some(11), cash: Some(2e7), storage: Storage::Memory, ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
        let ads = json!({"E1": 4000, "E2": 4000, "E3": 4000});
        for (tool, arguments) in [
            ("set_prices", json!({"A": 14, "B": 32, "C": 55})),
            ("set_model_tiers", json!({"A": 4, "B": 4, "C": 4})),
            ("set_usage_quotas", json!({"A": 300, "B": 30_000, "C": 1_000_000})),
            ("set_targeted_dev_spend", json!({"targeted_spend": {"E1": 4000, "E2": 5000}})),
            ("set_targeted_ad_spend", json!({"targeted_spend": {"social_media": ads, "linkedin": ads}})),
            ("set_capacity_tier", json!({"tier": 5})),
        ] {
            session.call(tool, &arguments, Via::Script).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
        }
        for _ in 0..16 {
            let deals: Vec<_> = session
                .company()
                .observe()
                .waiting
                .iter()
                .map(|own| json!([own.customer, [["C", 4.0], ["B", 3.0]]]))
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
        assert_eq!(all.iter().map(|own| own.group.id()).collect::<Vec<_>>(), ["E1", "E2", "E3"]);
        let mut number =
            |sql: String| novamind_database::number_at(&session.query(&sql).expect("rows").rows[0], 0) as u32;
        for own in &all {
            let group = own.group;
            let of = |table: &str, condition: &str| {
                format!(
                    "SELECT count(DISTINCT c.customer_id) FROM customers c {table} WHERE c.group_id = '{group}' {condition}"
                )
            };
            assert_eq!(own.came, number(of("", "")), "{group}");
            let turns = "JOIN enterprise_turns t ON t.customer_id = c.customer_id";
            assert_eq!(own.asked, number(of(turns, "AND t.thread_type = 'new_lead'")), "{group}");
            let signed = "AND t.thread_type = 'new_lead' AND t.close_reason = 'accepted'";
            assert_eq!(own.signed, number(of(turns, signed)), "{group}");
        }
        assert!(
            all.iter().any(|own| own.signed > 0) && all.iter().any(|own| own.turned_away() > 0),
            "{all:?}"
        );
        let away = all.iter().find(|own| own.turned_away() > 0).expect("some");
        assert!(away.in_words().contains("found no plan good enough"), "{}", away.in_words());
        let lately = all.iter().find(|own| own.turned_away_lately > 0).expect("some, lately");
        assert!(
            lately.in_words().contains(" delivers ") && lately.in_words().contains("required quality is ")
        );
    }
}
