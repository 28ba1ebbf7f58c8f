//! Who sees what: the truth is a look inside, and everybody else sees what studies have told.

use std::sync::Arc;

use super::assumed::{Reading, market_of};
use super::explorer::{CurveBasis, CurveExplorer, OnOffer, PlanPoint};
use crate::state::Session;
use novamind_tools::Refusal;
use novamind_world::identifiers::{ByPlan, Group, Plan};
use novamind_world::market::drift::Expectation;
use novamind_world::retention::renewal::ongoing_discount;

/// No customer has the number 0: promotions of single customers are left out.
const NOBODY: u32 = 0;

/// A look at the traits of a group that was allowed and recorded: without one they are not shown.
#[derive(Debug)]
pub struct CurveLook(Group);

impl Session {
    /// The explorer of a group, as far as the player may know: of its traits in debug runs and in runs that are over, where
    /// the look is recorded, and of what studies have told in all others.
    ///
    /// # Errors
    /// `group_not_discovered`, `guess_first`, `not_saved`.
    pub fn curve_explorer(&mut self, group: Group) -> Result<CurveExplorer, Refusal> {
        if !self.may_look_inside() {
            return self.estimated_curve(group);
        }
        let look = self.look_at_curve(group, self.day())?;
        Ok(self.true_curve(&look))
    }

    /// Records a look at the curve of a group as it is on a day.
    ///
    /// # Errors
    /// `not_in_this_mode`, `not_saved`.
    pub fn look_at_curve(&mut self, group: Group, day: u32) -> Result<CurveLook, Refusal> {
        self.refuse_to_look_inside()?;
        self.record_look_inside("curve", group.id(), day)?;
        Ok(CurveLook(group))
    }

    /// The explorer of the traits of a group at this moment of the run.
    pub fn true_curve(&self, look: &CurveLook) -> CurveExplorer {
        let CurveLook(group) = *look;
        let expectation = self.simulation.world.market.drift.expectation(group);
        let market = (expectation, self.simulation.params.clone());
        let basis = CurveBasis::Truth { day: self.day() };
        CurveExplorer::of(group, basis, self.on_offer(group), vec![market])
    }

    /// The explorer of what studies have told of a group. In a lesson it waits for the guess, which it would answer.
    ///
    /// # Errors
    /// `group_not_discovered`, `guess_first`.
    pub fn estimated_curve(&self, group: Group) -> Result<CurveExplorer, Refusal> {
        if let Some(lesson) = self.lesson() {
            lesson.refuse_before_guess(self.weeks_passed())?;
        }
        let all = self.estimates();
        let Some(own) = all.iter().find(|own| own.group == group) else {
            let known: Vec<&str> = all.iter().map(|own| own.group.id()).collect();
            let message =
                format!("group {group} is not known yet; the known groups are {}", known.join(", "));
            return Err(Refusal::at("group", "group_not_discovered", message));
        };
        // What the market has added since the study is not known.
        let market =
            |reading| (Expectation::default(), Arc::new(market_of(own, reading, &self.simulation.params)));
        let markets = [Reading::Likely, Reading::Strict, Reading::Generous].map(market).into();
        let basis = CurveBasis::Estimates { level: own.level, noise: own.noise, as_of: own.as_of };
        Ok(CurveExplorer::of(group, basis, self.on_offer(group), markets))
    }

    /// Prices, qualities and quotas in force, and promotions: all of it is shown to the player elsewhere.
    fn on_offer(&self, group: Group) -> OnOffer {
        let (world, params) = (&self.simulation.world, &self.simulation.params);
        let (settings, product) = (&world.settings, world.product.quality(group, params));
        let promotion = if group.is_enterprise() { 0.0 } else { settings.lead_promotion.sum(group, None) };
        OnOffer {
            plans: ByPlan::from_fn(|plan: Plan| PlanPoint {
                list: settings.core.prices[plan],
                quality: product * params.model(settings.core.tiers[plan]).quality_multiplier,
                quota: settings.core.quotas[plan].units(),
            }),
            promotion,
            ongoing: ByPlan::from_fn(|plan| ongoing_discount(NOBODY, group, plan, settings, params)),
        }
    }
}
