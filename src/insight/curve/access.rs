//! Access to curves. The true curve requires an inspection. Otherwise the curve is computed from estimates of market
//! studies.

use std::sync::Arc;

use super::assumed::{EstimateVariant, assumed_params};
use super::explorer::{CurrentOffer, CurveBasis, CurveExplorer, PlanPoint};
use novamind_session::{InspectionPermit, Session};
use novamind_tools::Rejection;
use novamind_world::customers::drift::Expectation;
use novamind_world::identifiers::{ByPlan, Group, Plan};
use novamind_world::params::Params;
use novamind_world::retention::renewal::ongoing_discount;

/// A customer number that does not exist, so that no discount for a single customer applies.
const NO_CUSTOMER: u32 = 0;

/// A proof that an inspection of a group's traits is permitted and recorded. The true curve requires this proof.
#[derive(Debug)]
pub struct CurveInspection {
    group: Group,
    inspection: InspectionPermit,
}

impl CurveInspection {
    /// Records an inspection of a group's curve on a day.
    ///
    /// # Errors
    /// `not_in_this_mode`, `not_saved`.
    pub fn record(run: &mut Session, group: Group, day: u32) -> Result<CurveInspection, Rejection> {
        Ok(CurveInspection {
            group,
            inspection: InspectionPermit::start_at_current_state(run, "curve", group.id(), day)?,
        })
    }
}

impl CurveExplorer {
    /// Opens the curve explorer of a group with the information that the player may see. Debug runs and finished runs
    /// show the true traits, and the inspection is recorded. All other runs show the estimates of market studies.
    ///
    /// # Errors
    /// `group_not_discovered`, `guess_first`, `not_saved`.
    pub fn open(run: &mut Session, group: Group) -> Result<CurveExplorer, Rejection> {
        if run.check_inspection().is_err() {
            return CurveExplorer::from_estimates(run, group);
        }
        let inspection = CurveInspection::record(run, group, run.day())?;
        Ok(CurveExplorer::from_true_values(run, &inspection))
    }

    /// Returns the curve explorer for the true traits of a group in the current state of the run.
    pub fn from_true_values(
        run: &Session,
        CurveInspection { group, inspection: permit }: &CurveInspection,
    ) -> CurveExplorer {
        let inside = permit.hidden_state(run);
        let (world, params) = (inside.world(), inside.params());
        let market = (world.market.drift.expectation(*group), params.clone());
        let product = world.product.quality(*group, params);
        let tiers = &world.settings.core.tiers;
        let quality = ByPlan::from_fn(|plan| product * params.model_tier(tiers[plan]).quality_multiplier);
        let basis = CurveBasis::Truth { day: run.day() };
        CurveExplorer::from_markets(*group, basis, current_offer(run, *group, &quality), vec![market])
    }

    /// Returns the curve explorer for the estimates of market studies. In a lesson, the student must enter the guess
    /// first, because the explorer would reveal the answer.
    ///
    /// # Errors
    /// `group_not_discovered`, `guess_first`.
    pub fn from_estimates(run: &Session, group: Group) -> Result<CurveExplorer, Rejection> {
        let (basis, offer, markets) = estimated_markets(run, group)?;
        Ok(CurveExplorer::from_markets(group, basis, offer, markets))
    }

    /// Returns the curve explorer for the estimates of market studies, but does not compute the points of the curve.
    /// The expected decisions of leads do not need the points.
    ///
    /// # Errors
    /// `group_not_discovered`, `guess_first`.
    pub fn from_estimates_without_points(run: &Session, group: Group) -> Result<CurveExplorer, Rejection> {
        let (basis, offer, markets) = estimated_markets(run, group)?;
        Ok(CurveExplorer::without_points(group, basis, offer, markets))
    }
}

/// Source of a curve, current offer, and the markets that match the estimates, with the likely market first.
type EstimatedMarkets = (CurveBasis, CurrentOffer, Vec<(Expectation, Arc<Params>)>);

fn estimated_markets(run: &Session, group: Group) -> Result<EstimatedMarkets, Rejection> {
    if let Some(lesson) = run.lesson() {
        lesson.check_guess_submitted(run.day() / run.params().run.days_per_week)?;
    }
    let all = run.company().estimates();
    let delivered = run.company().delivered_quality();
    let quality = delivered
        .iter()
        .find(|delivered_quality| delivered_quality.group == group)
        .map(|delivered_quality| delivered_quality.by_plan);
    let estimates = all.iter().find(|estimates| estimates.group == group);
    let Some((estimates, quality)) = estimates.zip(quality) else {
        let known: Vec<&str> = all.iter().map(|estimates| estimates.group.id()).collect();
        let message = format!("group {group} is not known yet; the known groups are {}", known.join(", "));
        return Err(Rejection::for_field("group", "group_not_discovered", message));
    };
    // The drift since the study is unknown.
    let market =
        |reading| (Expectation::default(), Arc::new(assumed_params(estimates, reading, run.params())));
    let markets =
        [EstimateVariant::Likely, EstimateVariant::Strict, EstimateVariant::Generous].map(market).into();
    let basis = CurveBasis::Estimates {
        level: estimates.level,
        noise: estimates.max_relative_error,
        as_of: estimates.as_of,
    };
    Ok((basis, current_offer(run, group, &quality), markets))
}

/// Returns the current prices, qualities, quotas and discounts. The player can see all of these values elsewhere.
fn current_offer(run: &Session, group: Group, quality: &ByPlan<f64>) -> CurrentOffer {
    let (settings, params) = (run.settings(), run.params());
    let promotion = if group.is_enterprise() { 0.0 } else { settings.lead_promotion.sum(group, None) };
    CurrentOffer {
        plans: ByPlan::from_fn(|plan: Plan| PlanPoint {
            list_price: settings.core.prices[plan],
            quality: quality[plan],
            quota: settings.core.quotas[plan].units(),
        }),
        discount: promotion,
        ongoing_discounts: ByPlan::from_fn(|plan| {
            ongoing_discount(NO_CUSTOMER, group, plan, settings, params)
        }),
    }
}
