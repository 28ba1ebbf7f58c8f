//! Product figures that are collected from query results: plans, capacity, service, issues and projects.

use std::collections::BTreeMap;

use novamind_database::{QueryResult, number_at, text_at};
use novamind_record::figures::WeekFigures;
use novamind_report::plan_margins::{PlanUsage, PlanSales};
use novamind_session::identifiers::Plan;
use novamind_session::{Category, ResearchMeans};
use novamind_tools::{CapacityTierFacts, ResearchTierFacts, ToolId};
use novamind_worker::company::DisplayedCompany;

/// A plan with its settings and revenue.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PlanFacts {
    /// Model tier of the plan.
    pub tier: u32,
    /// Quota in units per customer per day.
    pub quota: f64,
    /// List price, $ per seat per month.
    pub price: f64,
    /// Compute cost in $ per unit.
    pub unit_cost: f64,
    /// Subscribers of the plan, their payments and their usage on the last day.
    pub usage: PlanUsage,
}

impl PlanFacts {
    /// Returns the compute cost in $ per seat per month.
    pub fn compute_cost_per_seat(&self) -> Option<f64> {
        self.usage.compute_cost(self.unit_cost)
    }

    /// Returns the gross margin: the share of revenue that remains after compute cost.
    pub fn margin(&self) -> Option<f64> {
        self.usage.margin(self.unit_cost)
    }
}

/// Returns the figures of all plans from their settings and sales.
pub fn plans(sales: &PlanSales, company: &DisplayedCompany) -> [PlanFacts; 3] {
    Plan::ALL.map(|plan| {
        let tier = company.current_setting(ToolId::SetModelTiers, plan.id()) as u32;
        let model = company.price_list.model_tiers.get(&(tier as u8));
        PlanFacts {
            tier,
            quota: company.current_setting(ToolId::SetUsageQuotas, plan.id()),
            price: company.current_setting(ToolId::SetPrices, plan.id()),
            unit_cost: model.map_or(0.0, |model| model.cost_per_usage_unit),
            usage: sales.usage_of_plan(plan),
        }
    })
}

/// A tier of rented computing capacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapacityTier {
    /// Number of the capacity tier.
    pub tier: u32,
    /// Capacity in units per day.
    pub units: f64,
    /// Cost in dollars per day.
    pub cost: f64,
}

/// Returns all capacity tiers, the smallest first.
pub fn capacity_tiers(company: &DisplayedCompany) -> Vec<CapacityTier> {
    let capacity_tier = |(tier, facts): (&u8, &CapacityTierFacts)| CapacityTier {
        tier: u32::from(*tier),
        units: f64::from(facts.capacity_units),
        cost: f64::from(facts.cost_per_day),
    };
    let mut sorted_tiers: Vec<CapacityTier> = company.price_list.capacity_tiers.iter().map(capacity_tier).collect();
    sorted_tiers.sort_by_key(|capacity_tier| capacity_tier.tier);
    sorted_tiers
}

/// Usage, capacity and service quality on one day.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ServiceDay {
    /// Day of the run.
    pub day: u32,
    /// Usage on the day in units.
    pub usage: f64,
    /// Capacity on the day in units.
    pub capacity: f64,
    /// Capacity tier on the day.
    pub tier: u32,
    /// 95th percentile of the latency in milliseconds.
    pub latency_ms: f64,
    /// Share of failed requests.
    pub error_rate: f64,
    /// Duration of outages in minutes.
    pub downtime_minutes: f64,
}

impl ServiceDay {
    /// Returns the usage divided by capacity.
    pub fn utilization(&self) -> f64 {
        if self.capacity > 0.0 { self.usage / self.capacity } else { 0.0 }
    }
}

/// Parses the service data of all days.
pub fn parse_service_days(rows: &QueryResult) -> Vec<ServiceDay> {
    let day = |row: &Vec<novamind_database::Cell>| ServiceDay {
        day: number_at(row, 0) as u32,
        usage: number_at(row, 1),
        capacity: number_at(row, 2),
        tier: number_at(row, 3) as u32,
        latency_ms: number_at(row, 4),
        error_rate: number_at(row, 5),
        downtime_minutes: number_at(row, 6),
    };
    rows.rows.iter().map(day).collect()
}

/// Returns the mean and peak usage of the last seven days, or `None` before the first day.
pub fn last_week(days: &[ServiceDay]) -> Option<(f64, f64)> {
    let last = &days[days.len().saturating_sub(7)..];
    let peak = last.iter().map(|day| day.usage).fold(0.0, f64::max);
    (!last.is_empty()).then(|| (last.iter().map(|day| day.usage).sum::<f64>() / last.len() as f64, peak))
}

/// Numbers of open issues by age in days: up to 3, 4 to 7, 8 to 14, 15 or more.
pub type IssueAges = [f64; 4];

/// Parses the numbers of open issues by group and age.
pub fn parse_issues(rows: &QueryResult) -> BTreeMap<String, IssueAges> {
    let ages = |row: &Vec<novamind_database::Cell>| std::array::from_fn(|at| number_at(row, at + 1));
    rows.rows.iter().map(|row| (text_at(row, 0).to_owned(), ages(row))).collect()
}

/// An R&D project that was started.
#[derive(Debug, Clone, PartialEq)]
pub struct Project {
    /// Identifier of the project.
    pub id: String,
    /// Tier of the project, which determines its cost and gain.
    pub tier: u32,
    /// Whether the project is completed.
    pub done: bool,
    /// Day on which the project was paid for.
    pub started_day: u32,
    /// Expected or actual day of completion.
    pub expected_day: u32,
    /// Quality that the project adds.
    pub boost: f64,
}

/// Parses the R&D projects, the newest first.
pub fn parse_projects(rows: &QueryResult) -> Vec<Project> {
    let project = |row: &Vec<novamind_database::Cell>| Project {
        id: text_at(row, 0).to_owned(),
        tier: number_at(row, 1) as u32,
        done: text_at(row, 2) == "completed",
        started_day: number_at(row, 3) as u32,
        expected_day: number_at(row, 4) as u32,
        boost: number_at(row, 5),
    };
    rows.rows.iter().map(project).collect()
}

/// An R&D project that can be started.
#[derive(Debug, Clone, PartialEq)]
pub struct ProjectOffer {
    /// Tier of the offered project.
    pub tier: u32,
    /// Name of the project tier.
    pub name: String,
    /// Cost of the project in dollars.
    pub cost: f64,
    /// Mean duration in days and mean quality gain.
    pub means: ResearchMeans,
    /// Number of running projects and number of completed projects of this tier.
    pub running_and_done: (usize, usize),
}

/// Returns the R&D projects that can be started.
pub fn offers(company: &DisplayedCompany) -> Vec<ProjectOffer> {
    let offer = |(tier, means): (&ResearchTierFacts, &ResearchMeans)| ProjectOffer {
        tier: u32::from(tier.tier),
        name: tier.name.clone(),
        cost: f64::from(tier.cost),
        means: *means,
        running_and_done: (tier.in_progress, tier.completed),
    };
    company.projects.tiers.iter().zip(&company.research_means).map(offer).collect()
}

/// Returns the spending in a ledger category in dollars for each week, starting with the first week.
pub fn weekly_spending(weeks: &[WeekFigures], category: Category) -> Vec<f64> {
    weeks.iter().map(|week| -week.booked.category_total(category)).collect()
}
