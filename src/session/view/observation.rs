//! A summary of the company for its player.

use serde::Serialize;

use super::CompanyView;
use super::identical_plans::IdenticalPlans;
use super::research_outlook::LateProject;
use crate::company::irrevocable::IrrevocableAction;
use crate::figures::changes::SettingChange;
use crate::figures::dashboard::{self, WaitingLeads};
use crate::figures::outlook::{ErrorIntervals, ExpectedFlows, Outlook, Runway};
use crate::figures::week::week_of_day;
use novamind_base::formatting::dollars;
use novamind_record::figures::{CategoryTotals, WeekFigures};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::RunEndReason;
use novamind_voice::model::settings::RecordedModelSettings;
use novamind_world::day::closing_figures;
use novamind_world::identifiers::{Group, Plan};
use novamind_world::params::{HorizonRule, Interface};

/// A summary of the company and its run for the player.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Observation {
    /// ID of the run.
    pub run: String,
    /// Mode of the run.
    pub mode: Mode,
    /// Seed of the run; `None` in studies, because participants must not know the seed.
    pub seed: Option<u64>,
    /// Name of the scenario.
    pub scenario: String,
    /// Whether the parameters differ from the bundled scenario of the same name.
    pub has_own_parameters: bool,
    /// Language model of the run, if one is used.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub voice: Option<RecordedModelSettings>,
    /// Whether the run is a branch of another run.
    pub is_branch: bool,
    /// Label of the participant.
    pub participant: Option<String>,
    /// Last simulated day.
    pub day: u32,
    /// Last day of the run.
    pub last_day: u32,
    /// Rule that derived the last day.
    pub horizon_rule: HorizonRule,
    /// Generation of the released simulator that defines the rules of the run.
    pub generation: Interface,
    /// Week of the last simulated day.
    pub week: u32,
    /// Current cash, dollars.
    pub cash: f64,
    /// Cash on day 0, before any purchase, dollars.
    pub starting_cash: f64,
    /// Cash change over the last week, or over the simulated days of a started week, dollars; 0 before the first day.
    pub cash_change: f64,
    /// Number of days of the cash change: fewer than 7 after single days, or if the run ended within a week.
    pub cash_change_days: u32,
    /// Ledger totals since the end of the last week: purchases, and entries of simulated days of a started week.
    pub booked_since: CategoryTotals,
    /// Costs to which the current settings commit the company: capacity, operations, development, advertising, dollars
    /// per day.
    pub committed: f64,
    /// Number of forecast horizons that end within the run.
    #[serde(skip)]
    pub horizons_in_run: usize,
    /// Expected cash by day, with ranges.
    #[serde(skip)]
    pub outlook: Outlook,
    /// Costs to which the settings at the end of the last week committed the company, dollars per day.
    pub committed_before: f64,
    /// Weeks for which cash lasts.
    #[serde(skip)]
    pub runway: Runway,
    /// Weeks until the expected cash is below zero; `None` if that is after 26 weeks or after the last day.
    pub runway_weeks: Option<f64>,
    /// Active subscriptions of individuals.
    pub subscribers: u32,
    /// Number of active enterprises.
    pub companies: u32,
    /// Number of seats of active enterprises.
    pub seats: u32,
    /// Known groups, in a fixed order.
    pub known_groups: Vec<Group>,
    /// Reason for the end of the run; `None` if the run is unfinished.
    pub ended: Option<RunEndReason>,
    /// Score of the run; `None` before the end.
    pub score: Option<f64>,
    /// Figures of the last week; `None` before the end of the first week.
    pub last_week: Option<WeekFigures>,
    /// Dashboard of the last week, or a newly built dashboard before the first week.
    pub dashboard: String,
    /// Settings that changed since the last week.
    pub changes: Vec<SettingChange>,
    /// Descriptions of purchases and other irrevocable actions since the last week.
    pub purchases: Vec<String>,
    /// Plans that differ only in price.
    pub alike_plans: Vec<IdenticalPlans>,
    /// Threads that wait for a response.
    pub waiting: Vec<WaitingThread>,
    /// Number of running R&D projects.
    pub running_research: u32,
    /// R&D projects that will not finish before the last day.
    pub late_projects: Vec<LateProject>,
}

/// A thread that waits for a response.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WaitingThread {
    /// Number of the thread.
    pub thread: u32,
    /// Customer number of the enterprise.
    pub customer: u32,
    /// Group of the enterprise.
    pub group: &'static str,
    /// Seats of the enterprise.
    pub seats: u32,
    /// Kind of the thread, which depends on how the thread started.
    pub kind: &'static str,
    /// Number of the last turn in the thread.
    pub turn: u32,
    /// Number of offers that the player sent in the thread.
    pub offers_so_far: u32,
    /// The player's last offer: plans with prices, dollars per seat per month.
    pub last_offer: Vec<(Plan, f64)>,
    /// Last price that the enterprise named, dollars per seat per month.
    pub asked: Option<f64>,
    /// Days until the deadline of the thread.
    pub days_left: u32,
}

impl Observation {
    /// Returns the number of active subscriptions. Each active enterprise counts as one subscription.
    pub fn active_subscriptions(&self) -> u32 {
        self.subscribers + self.companies
    }

    /// Returns the number of days, at most 28, for which income and costs are expected: the rest of the run if it is
    /// shorter.
    pub fn expected_days(&self) -> u32 {
        self.days_left().min(28)
    }

    /// Returns the income and the variable costs that are expected for [`Observation::expected_days`], per week.
    pub fn expected_flows(&self) -> ExpectedFlows {
        self.outlook.expected_flows(self.expected_days())
    }

    /// Describes how often ranges of naive forecasts contained the actual cash of companies like this one. Returns
    /// `None` if too few companies were measured or the ranges contained too few outcomes. After a large change of the
    /// advertising budget, describes what the ranges leave out, because the measured coverage does not apply.
    pub fn describe_ranges(&self) -> Option<String> {
        if let Some(change) = self.outlook.advertising_change {
            return Some(format!(
                "You changed advertising from {} to {} a day. The naive forecasts include its cost, but not the signups it \
                 adds or removes, so the ranges can be too narrow",
                dollars(change.before.round()),
                dollars(change.now.round())
            ));
        }
        ErrorIntervals::bundled().describe_coverage(self.outlook.stage, self.days_left())
    }

    /// Returns the number of days from the last simulated day to the last day of the run.
    pub fn days_left(&self) -> u32 {
        self.last_day.saturating_sub(self.day)
    }
}

impl CompanyView<'_> {
    /// Returns a summary of the company for the player.
    pub fn observe(&self) -> Observation {
        let (closing, outlook) = (closing_figures(&self.simulation.world), self.outlook());
        let runway = outlook.runway(self.manifest.days.saturating_sub(self.simulation.world.day));
        Observation {
            run: self.manifest.id.clone(),
            mode: self.manifest.mode,
            seed: Some(self.manifest.seed).filter(|_| self.manifest.study.is_none()),
            scenario: self.manifest.scenario.clone(),
            has_own_parameters: self.derived.has_custom_parameters(self.simulation, self.manifest),
            voice: self.manifest.voice.clone(),
            is_branch: self.manifest.parent.is_some(),
            participant: self.manifest.participant.clone(),
            day: self.simulation.world.day,
            last_day: self.manifest.days,
            horizon_rule: self.manifest.horizon_rule(),
            generation: self.manifest.generation(),
            week: week_of_day(self.simulation.world.day),
            cash: self.simulation.world.finance.cash,
            starting_cash: self.manifest.cash,
            cash_change: self.latest_figures().map_or(0.0, |week| week.cash_change),
            cash_change_days: self.latest_figures().map_or(0, |week| week.days_run),
            booked_since: self.booked_since(),
            committed: self.daily_cost(&self.simulation.world.settings),
            horizons_in_run: self.horizons_in_run(),
            outlook,
            runway,
            committed_before: self.daily_cost(&self.history.week_actions.settings),
            runway_weeks: runway.expected,
            subscribers: closing.individual_subscribers,
            companies: self.active_enterprise_count(),
            seats: closing.enterprise_seats,
            known_groups: Group::all()
                .filter(|group| self.simulation.world.market.is_known(*group))
                .collect(),
            ended: self.history.ended,
            score: self.score(),
            last_week: self.history.weeks.last().copied(),
            dashboard: self.dashboard(),
            changes: self.setting_changes(),
            purchases: self
                .history
                .week_actions
                .irrevocable_actions
                .iter()
                .map(IrrevocableAction::to_string)
                .collect(),
            alike_plans: self.identical_plans(),
            waiting: self.waiting_threads(),
            running_research: self.running_research_count(),
            late_projects: self.late_projects(),
        }
    }

    /// Returns the weekly dashboard after the last simulated day, which does not show later setting changes. Before
    /// the first day, builds the dashboard from the current state.
    pub fn dashboard(&self) -> String {
        self.history
            .last_dashboard
            .clone()
            .unwrap_or_else(|| self.build_dashboard(self.simulation.open_issues()))
    }

    pub(crate) fn build_dashboard(&self, open_issues: u32) -> String {
        let closing = closing_figures(&self.simulation.world);
        let stocks = WeekFigures {
            cash: closing.cash,
            individual_subscribers: closing.individual_subscribers,
            enterprise_seats: closing.enterprise_seats,
            open_issues,
            ..WeekFigures::default()
        };
        let waiting = self.waiting_threads();
        let waiting = WaitingLeads {
            threads: waiting.len() as u32,
            days_left: waiting.iter().map(|thread| thread.days_left).min().unwrap_or(0),
        };
        let week = if self.history.current_week.days_run > 0 {
            Some(&self.history.current_week)
        } else {
            self.history.weeks.last()
        };
        dashboard::dashboard_text(
            &self.simulation.world,
            &self.simulation.params,
            week,
            &stocks,
            &self.history.calculation_outputs,
            waiting,
        )
    }

    /// Returns the threads that wait for a response, ordered by deadline.
    fn waiting_threads(&self) -> Vec<WaitingThread> {
        let patience = self.simulation.params.enterprise.agent_response_timeout_days;
        let enterprise = &self.simulation.world.enterprise;
        let threads = enterprise.threads.iter().filter(|thread| thread.awaits_player());
        let waiting = threads.map(|thread| {
            let company = enterprise.enterprise_customer(thread.customer);
            let row = company.and_then(|company| company.row(&self.simulation.world.customers));
            WaitingThread {
                thread: thread.number,
                customer: thread.customer,
                group: thread.group.id(),
                seats: row.map_or(1, |row| row.seats as u32),
                kind: thread.kind.id(),
                turn: thread.last().number,
                offers_so_far: thread.player_turn_count(),
                last_offer: thread
                    .last_offerings()
                    .iter()
                    .map(|offering| (offering.plan, offering.price))
                    .collect(),
                asked: thread.last_asked_price(),
                days_left: (thread.last().day + patience).saturating_sub(self.simulation.world.day),
            }
        });
        let mut waiting: Vec<WaitingThread> = waiting.collect();
        waiting.sort_by_key(|thread| (thread.days_left, std::cmp::Reverse(thread.seats), thread.thread));
        waiting
    }

    fn active_enterprise_count(&self) -> u32 {
        let enterprise = Group::all().filter(|group| group.is_enterprise());
        enterprise.map(|group| self.simulation.world.customers.groups[group].active_count()).sum()
    }

    fn running_research_count(&self) -> u32 {
        self.simulation
            .world
            .product
            .research
            .iter()
            .filter(|project| project.completed_day.is_none())
            .count() as u32
    }

    fn latest_figures(&self) -> Option<&WeekFigures> {
        let running = &self.history.current_week;
        if running.days_run > 0 { Some(running) } else { self.history.weeks.last() }
    }

    fn booked_since(&self) -> CategoryTotals {
        let mut booked = self.history.current_week.booked;
        self.history.call_ledger.iter().for_each(|entry| booked.add(entry.category, entry.amount));
        booked
    }
}
