//! Who sees what: the truth is a look inside, and everybody else sees what studies have told.

use std::sync::Arc;

use super::assumed::{Reading, market_of};
use super::explorer::{CurveBasis, CurveExplorer, OnOffer, PlanPoint};
use novamind_session::{Look, Session};
use novamind_tools::Refusal;
use novamind_world::customers::drift::Expectation;
use novamind_world::identifiers::{ByPlan, Group, Plan};
use novamind_world::retention::renewal::ongoing_discount;

/// No customer has the number 0: promotions of single customers are left out.
const NOBODY: u32 = 0;

/// A look at the traits of a group that was allowed and recorded: without one they are not shown.
#[derive(Debug)]
pub struct CurveLook {
    group: Group,
    look: Look,
}

impl CurveLook {
    /// Records a look at the curve of a group as it is on a day.
    ///
    /// # Errors
    /// `not_in_this_mode`, `not_saved`.
    pub fn begin(run: &mut Session, group: Group, day: u32) -> Result<CurveLook, Refusal> {
        Ok(CurveLook { group, look: Look::begin_at(run, "curve", group.id(), day)? })
    }
}

impl CurveExplorer {
    /// The explorer of a group, as far as the player may know: of its traits in debug runs and in runs that are over, where
    /// the look is recorded, and of what studies have told in all others.
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

    /// The explorer of the traits of a group at this moment of the run.
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

    /// The explorer of what studies have told of a group. In a lesson it waits for the guess, which it would answer.
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
        // What the market has added since the study is not known.
        let market = |reading| (Expectation::default(), Arc::new(market_of(own, reading, run.params())));
        let markets = [Reading::Likely, Reading::Strict, Reading::Generous].map(market).into();
        let basis = CurveBasis::Estimates { level: own.level, noise: own.noise, as_of: own.as_of };
        Ok(CurveExplorer::drawn(group, basis, on_offer(run, group, &quality), markets))
    }
}

/// Prices, qualities and quotas in force, and promotions: all of it is shown to the player elsewhere.
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
