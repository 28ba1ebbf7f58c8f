//! Explanations of differences from the published account.

use super::account::BoundAccount;
use super::account_line::AccountLine;
use super::acquisition_costs;
use super::attainable_market;
use novamind_base::formatting::{grouped_number, percent};
use novamind_world::identifiers::Group;
use novamind_world::params::Params;

impl BoundAccount {
    /// Explains why the figure of a line differs from the published figure.
    pub(super) fn explain_difference(&self, line: AccountLine, value: f64, params: &Params) -> String {
        let millions = value / 1e6;
        if (millions - line.published_millions()).abs() <= line.rounding_error() {
            return format!("within ±{}, the rounding of the published figure", line.rounding_error());
        }
        let ratio = line.published_millions() / millions;
        match line {
            AccountLine::Individuals | AccountLine::Enterprises => {
                self.explain_revenue_difference(line, params)
            }
            AccountLine::Revenue => "the sum of the two lines above".to_owned(),
            AccountLine::Compute => {
                let units = 1e6 * line.published_millions()
                    / (params.model_tier(self.assumptions.model_tier).unit_cost
                        * f64::from(self.assumptions.days));
                format!(
                    "{} million units a day here, {} published",
                    grouped_number(self.daily_usage / 1e6, 0),
                    grouped_number(units / 1e6, 0)
                )
            }
            AccountLine::TargetedDevelopment if params.competitor.competitor_events_disabled => {
                "competitors raise expectations in the published account, but not here".to_owned()
            }
            AccountLine::TargetedDevelopment => format!(
                "the gap of each group depends on competitors: mean over {} seeds here; the paper's method for gaps is unknown",
                super::shared_quality::SEED_COUNT
            ),
            AccountLine::Advertising => format!(
                "the published figure is {} of the figure here, which fills every market within the first {} days at rising lead costs; the paper's pace is unknown",
                percent(ratio, 0),
                self.assumptions.renewals.first().unwrap_or(&0)
            ),
            AccountLine::LeadCosts => format!(
                "one lead per customer here; the published figure pays for {} leads per customer",
                grouped_number(
                    1e6 * line.published_millions()
                        / params.leads.lead_acquisition_cost
                        / acquisition_costs::acquired_customer_count(params),
                    2
                )
            ),
            AccountLine::Operations => {
                "supported customers and seats differ because the markets differ".to_owned()
            }
            AccountLine::MarketResearch => {
                let unknown = Group::all().filter(|group| !group.is_initially_known()).count();
                let research = &params.market_research;
                format!(
                    "{} attempts find {unknown} groups on average; the published figure pays for {}",
                    grouped_number(unknown as f64 / research.market_research_discover_prob, 1),
                    grouped_number(1e6 * line.published_millions() / research.discovery_cost_level_1, 0)
                )
            }
            AccountLine::GroupResearch => format!(
                "studies of every discovered group up to level {}, at current prices; the paper's study levels are unknown",
                self.assumptions.study_level
            ),
            AccountLine::Costs => "the sum of the costs above".to_owned(),
            AccountLine::Subtotal => "cash on day 0 plus revenue minus costs".to_owned(),
            AccountLine::Estimate => {
                format!("{} of the amount before the discount, as published", self.assumptions.reported_share)
            }
            AccountLine::Capacity | AccountLine::GlobalDevelopment | AccountLine::Research => {
                "the current parameters differ from the published ones".to_owned()
            }
        }
    }

    fn explain_revenue_difference(&self, line: AccountLine, params: &Params) -> String {
        let is_enterprise_line = line == AccountLine::Enterprises;
        let groups = Group::all().filter(|group| group.is_enterprise() == is_enterprise_line);
        let bills = self.assumptions.renewals.len() as f64;
        let full =
            bills * groups.map(|group| attainable_market::full_billing_revenue(group, params)).sum::<f64>();
        let what =
            if is_enterprise_line { "the maximum seats of every account" } else { "the markets of day 0" };
        format!(
            "{} of full billing is paid here; full billing of {what} at mean budgets is {} million, of which the published figure is {}",
            percent(self.customer_revenue(is_enterprise_line) / full, 1),
            grouped_number(full / 1e6, 0),
            percent(1e6 * line.published_millions() / full, 1)
        )
    }
}
