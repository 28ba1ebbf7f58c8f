//! Explanations of differences from the published account.

use super::account::BoundAccount;
use super::customers;
use super::published::AccountLine;
use super::winning;
use novamind_base::notation::{grouped, percent};
use novamind_world::identifiers::Group;
use novamind_world::params::Params;

impl BoundAccount {
    /// Returns the reason why a line differs from the published one.
    pub(super) fn why(&self, line: AccountLine, own: f64, params: &Params) -> String {
        let millions = own / 1e6;
        if (millions - line.published()).abs() <= line.rounding() {
            return format!("within ±{}, the rounding of the published figure", line.rounding());
        }
        let ratio = line.published() / millions;
        match line {
            AccountLine::Individuals | AccountLine::Companies => self.why_revenue(line, params),
            AccountLine::Revenue => "the sum of the two lines above".to_owned(),
            AccountLine::Compute => {
                let units = 1e6 * line.published()
                    / (params.model(self.premises.model_tier).unit_cost * f64::from(self.premises.days));
                format!(
                    "{} million units a day here, {} published",
                    grouped(self.daily_usage / 1e6, 0),
                    grouped(units / 1e6, 0)
                )
            }
            AccountLine::TargetedDevelopment if params.competitor.competitor_events_disabled => {
                "no competitor raises expectations here; in the published account they do".to_owned()
            }
            AccountLine::TargetedDevelopment => format!(
                "the gap of each group depends on competitors: mean over {} seeds here; the paper's method for gaps is unknown",
                super::climate::LUCKS
            ),
            AccountLine::Advertising => format!(
                "published {} of ours: ours fills every market within the first {} days, where leads become more expensive; the paper's pace is unknown",
                percent(ratio, 0),
                self.premises.renewals.first().unwrap_or(&0)
            ),
            AccountLine::LeadCosts => format!(
                "one lead per customer here; the published figure pays for {} leads per customer",
                grouped(
                    1e6 * line.published() / params.leads.lead_acquisition_cost / winning::accounts(params),
                    2
                )
            ),
            AccountLine::Operations => {
                "supported customers and seats differ because the markets do".to_owned()
            }
            AccountLine::MarketResearch => {
                let unknown = Group::all().filter(|group| !group.initially_known()).count();
                let law = &params.market_research;
                format!(
                    "{} attempts find {unknown} groups on average; the published figure pays for {}",
                    grouped(unknown as f64 / law.market_research_discover_prob, 1),
                    grouped(1e6 * line.published() / law.discovery_cost_level_1, 0)
                )
            }
            AccountLine::GroupResearch => format!(
                "a study to level {} of every found group, at current prices; the levels that the paper pays for are unknown",
                self.premises.study_level
            ),
            AccountLine::Costs => "the sum of the costs above".to_owned(),
            AccountLine::Subtotal => "cash on day 0 plus revenue minus costs".to_owned(),
            AccountLine::Estimate => {
                format!("{} of the amount before the discount, as published", self.premises.reported_share)
            }
            AccountLine::Capacity | AccountLine::GlobalDevelopment | AccountLine::Research => {
                "the current parameters differ from the published ones".to_owned()
            }
        }
    }

    fn why_revenue(&self, line: AccountLine, params: &Params) -> String {
        let of_companies = line == AccountLine::Companies;
        let groups = Group::all().filter(|group| group.is_enterprise() == of_companies);
        let bills = self.premises.renewals.len() as f64;
        let full = bills * groups.map(|group| customers::full_bill(group, params)).sum::<f64>();
        let what = if of_companies { "the maximum seats of every account" } else { "the markets of day 0" };
        format!(
            "{} of full billing is paid here; full billing of {what} at mean budgets is {} million, of which the published figure is {}",
            percent(self.revenue_of(of_companies) / full, 1),
            grouped(full / 1e6, 0),
            percent(1e6 * line.published() / full, 1)
        )
    }
}
