//! A read-only view of a company for its player, without access to files, records or hidden state.

pub(crate) mod cash_outlook;
pub(crate) mod debug_parameters;
pub(crate) mod identical_plans;
pub(crate) mod observation;
pub(crate) mod research_outlook;
pub(crate) mod tool_limits;

use std::time::Duration;

use serde_json::{Map, Value};

use crate::company::history::History;
use crate::company::overrides::DerivedValues;
use crate::company::run_context::RunContext;
use crate::company::simulation::Simulation;
use crate::figures::capacity_by_usage::UsageCapacityRule;
use crate::figures::changes::{Decisions, SettingChange, daily_cost};
use crate::figures::dashboard::{DeliveredQuality, delivered_quality};
use crate::figures::estimates::Estimates;
use crate::figures::groups::{GroupWeek, PlanRevenue, plan_revenue};
use crate::figures::scored_forecast::{ForecastScore, submitted_forecasts};
use crate::figures::week::Forecasts;
use novamind_database::query::QueryLimits;
use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::record::{CalculationOutput, RunEndReason};
use novamind_tools::{GetGroupInsights, PublicPost, Tool, ToolContext, ToolKind, find};
use novamind_voice::EnterpriseNames;
use novamind_world::customers::customer_numbers::CustomerNumbers;
use novamind_world::identifiers::{ByGroup, ByPlan, Channel, Group};
use novamind_world::market::surges::week_end;
use novamind_world::params::Params;
use novamind_world::settings::Settings;

/// A read-only view of the company of a run that contains only what its player may see.
#[derive(Clone, Copy)]
pub struct CompanyView<'a> {
    pub(crate) manifest: &'a Manifest,
    pub(crate) simulation: &'a Simulation,
    pub(crate) history: &'a History,
    pub(crate) surroundings: &'a RunContext,
    pub(crate) derived: &'a DerivedValues,
}

impl<'a> CompanyView<'a> {
    /// Returns the settings that changed since the last week, with old and new values.
    pub fn setting_changes(&self) -> Vec<SettingChange> {
        self.history.setting_changes(&self.simulation.world)
    }

    /// Returns the arguments of a tool call that would set the current values.
    pub fn current_arguments(&self, tool: impl AsRef<str>) -> Map<String, Value> {
        find(tool.as_ref())
            .map(|tool| tool.current_arguments(&self.simulation.world.settings))
            .unwrap_or_default()
    }

    /// Runs a read-only tool without recording the call, for panes that refresh continuously. Returns `None` if the
    /// tool rejects the call or is not read-only.
    pub fn read_tool<T: Tool>(&self, tool: &T, args: T::Args) -> Option<T::Answer> {
        if tool.spec().kind != ToolKind::Read {
            return None;
        }
        let planned = tool.plan(&self.tool_context(), args).ok()?;
        let resolved = self.simulation.resolve(planned.command);
        planned.reply.into_answer_without_script(&resolved)
    }

    pub(crate) fn tool_context(&self) -> ToolContext<'a> {
        ToolContext::new(&self.simulation.world, &self.simulation.params)
            .with_session(self.surroundings)
            .with_posts(&self.simulation.feed.posts)
    }

    /// Returns the next decision day: the end of the week that contains the next day.
    pub fn next_decision_day(&self) -> u32 {
        week_end(self.simulation.world.day + 1, self.simulation.params.run.days_per_week, self.manifest.days)
    }

    /// Returns the posts of other authors in the social feed, ordered by number.
    pub fn posts(&self) -> &'a [PublicPost] {
        &self.simulation.feed.posts
    }

    /// Returns the outputs of the calculations before the last week.
    pub fn calculation_outputs(&self) -> &'a [CalculationOutput] {
        &self.history.calculation_outputs
    }

    /// Returns the decisions before each simulated week, in order. Single days of debug runs count as weeks.
    pub fn decisions(&self) -> &'a [Decisions] {
        &self.history.decisions
    }

    /// Returns the notices of the last simulated days, each with its day and text.
    pub fn notices(&self) -> &'a [(u32, String)] {
        &self.history.notices
    }

    /// Returns the figures of all groups for every simulated week.
    pub fn group_weeks(&self) -> &'a [ByGroup<GroupWeek>] {
        &self.history.group_weeks
    }

    /// Returns the revenue of the subscriptions of each plan that could use the product on the last day.
    pub fn plan_revenue(&self) -> ByPlan<PlanRevenue> {
        plan_revenue(&self.simulation.world)
    }

    /// Returns the distinct SQL statements of this run, newest last.
    pub fn query_history(&self) -> &'a [String] {
        &self.history.query_history
    }

    /// Returns the row and time limits of a query in this run.
    pub fn query_limits(&self) -> QueryLimits {
        let limits = &self.simulation.params.limits;
        QueryLimits {
            rows: limits.query_row_limit as usize,
            time: Duration::from_secs(u64::from(limits.query_timeout_seconds)),
            steps: None,
        }
    }

    /// Returns the names of the enterprises.
    pub fn enterprise_names(&self) -> &'a EnterpriseNames {
        &self.simulation.names
    }

    /// Returns the customer numbers of all customers.
    pub fn customer_numbers(&self) -> &'a CustomerNumbers {
        &self.simulation.world.customers.numbers
    }

    /// Returns the score: cash after the last day, 0 after a bankruptcy. Returns `None` before the end and for
    /// abandoned runs.
    pub(crate) fn score(&self) -> Option<f64> {
        match self.history.ended {
            Some(RunEndReason::Horizon) => Some(self.simulation.world.finance.cash),
            Some(RunEndReason::Bankruptcy) => Some(0.0),
            Some(RunEndReason::Abandoned | RunEndReason::Lesson) | None => None,
        }
    }

    /// Returns the running costs that depend only on settings, in dollars per day.
    pub(crate) fn daily_cost(&self, settings: &Settings) -> f64 {
        let capacity = self.simulation.params.capacity_tier(settings.core.capacity_tier);
        daily_cost(settings, f64::from(capacity.cost_per_day))
    }

    /// Returns the delivered quality for every known group, as in the dashboard.
    pub fn delivered_quality(&self) -> Vec<DeliveredQuality> {
        delivered_quality(&self.simulation.world, &self.simulation.params)
    }

    /// Returns the base quality, and the general bonus from development for all groups.
    pub fn base_quality(&self) -> (f64, f64) {
        (self.simulation.params.quality.base_product_quality, self.simulation.world.product.shared_bonus)
    }

    /// Returns the estimates of every known group, in a fixed order. Does not record a tool call.
    pub fn estimates(&self) -> Vec<Estimates> {
        let limits = self.tool_limits();
        let of = |group: Group| {
            let insights = self.read_tool(&GetGroupInsights, group)?;
            let (level, estimates) = (insights.info_level, insights.estimates);
            let [least, most] = estimates.seat_range.unwrap_or([1, 1]);
            Some(Estimates {
                group,
                level,
                as_of: self.simulation.world.market.knowledge[group].snapshot?.day,
                max_relative_error: limits.study_level(level)?.noise,
                budget: estimates.willingness_to_pay,
                usage: estimates.usage_volume,
                required_quality: estimates.quality_floor_q_min,
                seats: (least as f64, most as f64),
            })
        };
        Group::all().filter(|group| self.simulation.world.market.is_known(*group)).filter_map(of).collect()
    }

    /// Returns the scores of the submitted forecasts, one score per horizon.
    pub fn forecast_scores(&self) -> Vec<ForecastScore> {
        let filed = submitted_forecasts(&self.history.journal, &self.history.weeks);
        let horizons = self.simulation.params.limits.prediction_horizons_days.iter();
        horizons.map(|horizon| ForecastScore::from_forecasts(*horizon, &filed)).collect()
    }

    /// Returns the number of forecast horizons that end within the run. Only these forecasts can be scored.
    pub fn horizons_in_run(&self) -> usize {
        let days_left = self.manifest.days.saturating_sub(self.simulation.world.day);
        let horizons = self.simulation.params.limits.prediction_horizons_days.iter();
        horizons.filter(|horizon| **horizon <= days_left).count()
    }

    /// Returns the naive forecasts of cash for all horizons.
    pub fn naive_forecasts(&self) -> Forecasts {
        self.outlook().naive_forecasts(&self.simulation.params.limits.prediction_horizons_days)
    }

    /// Returns the capacity tier that a rule would set now.
    pub fn capacity_tier_by_rule(&self, rule: UsageCapacityRule) -> u8 {
        let now = self.simulation.world.settings.core.capacity_tier;
        rule.next_tier(now, self.history.weeks.last(), &self.simulation.params)
    }

    /// Returns the capacity tier that is one step closer to the smallest tier that serves the mean usage of the last
    /// week at 80 % utilization.
    pub fn capacity_step_toward_usage(&self) -> u8 {
        self.capacity_tier_by_rule(UsageCapacityRule::StepByStep)
    }

    /// Returns the channel with the most leads per dollar for a group at the start of the run. Returns `None` for
    /// unfinished runs, because this channel is hidden from players.
    pub fn true_best_channel(&self, group: Group) -> Option<Channel> {
        self.history.ended.map(|_| best_starting_channel(group, &self.simulation.params))
    }
}

/// Returns the channel with the highest yield for a group on day 0. If yields are equal, returns the first channel.
pub fn best_starting_channel(group: Group, params: &Params) -> Channel {
    let yields = params.starting_yields();
    let better =
        |best: Channel, next: Channel| if yields[next][group] > yields[best][group] { next } else { best };
    Channel::ALL.into_iter().reduce(better).unwrap_or(Channel::ALL[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{NewRun, Storage};
    use crate::play::Session;
    use novamind_record::folder::configuration::Configuration;

    #[test]
    fn estimates_match_the_tool_and_their_range_contains_the_mean() {
        let new = NewRun { storage: Storage::Memory, ..NewRun::default() };
        let session = Session::create(new, &Configuration::bundled()).expect("a run");
        let all = session.company().estimates();
        assert_eq!(all.len(), 6);
        let s1 = all[0];
        let answer = session.company().read_tool(&GetGroupInsights, all[0].group).expect("an answer");
        assert_eq!((s1.group.id(), s1.level, s1.max_relative_error), ("S1", 1, 0.65));
        assert_eq!(s1.budget, answer.estimates.willingness_to_pay);
        let mean = session.params().group(s1.group).c_max_mean;
        let (least, most) = s1.true_range(s1.budget);
        assert!(least <= mean + 0.01 && mean <= most + 0.01, "{least} {mean} {most}");
    }
}
