//! Access to curves: the true curve needs an inspection; otherwise the curve comes from estimates of market studies.

use std::sync::Arc;

use super::assumed::{Reading, market_of};
use super::explorer::{CurveBasis, CurveExplorer, OnOffer, PlanPoint};
use novamind_session::{Look, Session};
use novamind_tools::Refusal;
use novamind_world::customers::drift::Expectation;
use novamind_world::identifiers::{ByPlan, Group, Plan};
use novamind_world::retention::renewal::ongoing_discount;

/// A number that no customer has, which excludes discounts of single customers.
const NOBODY: u32 = 0;

/// A permitted and recorded inspection of the traits of a group. The true curve requires one.
#[derive(Debug)]
pub struct CurveLook {
    group: Group,
    look: Look,
}

impl CurveLook {
    /// Records an inspection of the curve of a group on a day.
    ///
    /// # Errors
    /// `not_in_this_mode`, `not_saved`.
    pub fn begin(run: &mut Session, group: Group, day: u32) -> Result<CurveLook, Refusal> {
        Ok(CurveLook { group, look: Look::begin_at(run, "curve", group.id(), day)? })
    }
}

impl CurveExplorer {
    /// Opens the explorer of a group with the information that the player may see: the true traits in debug runs and finished
    /// runs, where the inspection is recorded, and the estimates of market studies in all other runs.
    ///
    /// # Errors
    /// `group_not_discovered`, `guess_first`, `not_saved`.
    pub fn of(run: &mut Session, group: Group) -> Result<CurveExplorer, Refusal> {
        if !run.may_look_inside() {
            return CurveExplorer::estimated(run, group);
        }
        let look = CurveLook::begin(run, group, run.day())?;
        Ok(CurveExplorer::true_at(run, &look))
    }

    /// Returns the explorer of the true traits of a group at the current moment of the run.
    pub fn true_at(run: &Session, CurveLook { group, look }: &CurveLook) -> CurveExplorer {
        let inside = look.inside(run);
        let (world, params) = (inside.world(), inside.params());
        let market = (world.market.drift.expectation(*group), params.clone());
        let product = world.product.quality(*group, params);
        let tiers = &world.settings.core.tiers;
        let quality = ByPlan::from_fn(|plan| product * params.model(tiers[plan]).quality_multiplier);
        let basis = CurveBasis::Truth { day: run.day() };
        CurveExplorer::drawn(*group, basis, on_offer(run, *group, &quality), vec![market])
    }

    /// Returns the explorer of the estimates of market studies. In a lesson it requires the guess, because it would reveal the answer.
    ///
    /// # Errors
    /// `group_not_discovered`, `guess_first`.
    pub fn estimated(run: &Session, group: Group) -> Result<CurveExplorer, Refusal> {
        if let Some(lesson) = run.lesson() {
            lesson.refuse_before_guess(run.day() / run.params().run.days_per_week)?;
        }
        let all = run.company().estimates();
        let delivered = run.company().delivered_quality();
        let quality = delivered.iter().find(|own| own.group == group).map(|own| own.by_plan);
        let own = all.iter().find(|own| own.group == group);
        let Some((own, quality)) = own.zip(quality) else {
            let known: Vec<&str> = all.iter().map(|own| own.group.id()).collect();
            let message =
                format!("group {group} is not known yet; the known groups are {}", known.join(", "));
            return Err(Refusal::at("group", "group_not_discovered", message));
        };
        // Drift since the study is unknown.
        let market = |reading| (Expectation::default(), Arc::new(market_of(own, reading, run.params())));
        let markets = [Reading::Likely, Reading::Strict, Reading::Generous].map(market).into();
        let basis = CurveBasis::Estimates { level: own.level, noise: own.noise, as_of: own.as_of };
        Ok(CurveExplorer::drawn(group, basis, on_offer(run, group, &quality), markets))
    }
}

/// Returns current prices, qualities, quotas and discounts, all of which the player can see elsewhere.
fn on_offer(run: &Session, group: Group, quality: &ByPlan<f64>) -> OnOffer {
    let (settings, params) = (run.settings(), run.params());
    let promotion = if group.is_enterprise() { 0.0 } else { settings.lead_promotion.sum(group, None) };
    OnOffer {
        plans: ByPlan::from_fn(|plan: Plan| PlanPoint {
            list: settings.core.prices[plan],
            quality: quality[plan],
            quota: settings.core.quotas[plan].units(),
        }),
        promotion,
        ongoing: ByPlan::from_fn(|plan| ongoing_discount(NOBODY, group, plan, settings, params)),
    }
}
