//! The figures in the comparison of branches.

use crate::counterfactual::branch::BranchOutcome;
use novamind_record::figures::{FigureUnit, WeekFigures};
use novamind_world::events::DayFigures;

const CHURN_WINDOW_DAYS: usize = 30;

/// A figure of a branch at the end of a week.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BranchFigure {
    /// Cash in dollars.
    Cash,
    /// Monthly recurring revenue in dollars.
    RecurringRevenue,
    /// Number of active individual subscriptions.
    Subscribers,
    /// Number of seats of active enterprises.
    Seats,
    /// Cancellations of individuals in the last 30 days, as a share of the subscribers 30 days earlier; NaN if there
    /// are no subscribers.
    Churn,
    /// Number of individual leads in the week.
    Leads,
    /// Number of individuals who signed up in the week.
    NewSubscribers,
    /// New subscribers of the week as a share of its individual leads; NaN if there are no leads.
    Conversion,
    /// Number of individuals who cancelled in the week.
    Cancellations,
    /// Mean satisfaction of individuals, which is hidden in unfinished runs.
    Satisfaction,
}

/// Values of all figures at the end of a week.
pub(super) type FigureValues = [f64; BranchFigure::ALL.len()];

impl BranchFigure {
    /// All figures in display order.
    pub const ALL: [BranchFigure; 10] = [
        BranchFigure::Cash,
        BranchFigure::RecurringRevenue,
        BranchFigure::Subscribers,
        BranchFigure::Seats,
        BranchFigure::Churn,
        BranchFigure::Leads,
        BranchFigure::NewSubscribers,
        BranchFigure::Conversion,
        BranchFigure::Cancellations,
        BranchFigure::Satisfaction,
    ];

    /// Returns the display name of the figure.
    pub fn name(self) -> &'static str {
        match self {
            BranchFigure::Cash => "cash",
            BranchFigure::RecurringRevenue => "recurring revenue",
            BranchFigure::Subscribers => "subscribers",
            BranchFigure::Seats => "enterprise seats",
            BranchFigure::Churn => "30-day churn",
            BranchFigure::Leads => "individual leads a week",
            BranchFigure::NewSubscribers => "new subscribers a week",
            BranchFigure::Conversion => "conversion",
            BranchFigure::Cancellations => "cancellations a week",
            BranchFigure::Satisfaction => "satisfaction",
        }
    }

    /// Returns the identifier of the figure in data formats.
    pub fn id(self) -> String {
        match self {
            // Data formats keep the earlier name.
            BranchFigure::Churn => "churn_of_30_days".to_owned(),
            _ => self.name().replace(' ', "_"),
        }
    }

    /// Returns the unit of the figure.
    pub fn unit(self) -> FigureUnit {
        match self {
            BranchFigure::Cash | BranchFigure::RecurringRevenue => FigureUnit::Dollars,
            BranchFigure::Churn => FigureUnit::Share,
            BranchFigure::Conversion => FigureUnit::PreciseShare,
            BranchFigure::Satisfaction => FigureUnit::Level,
            _ => FigureUnit::Count,
        }
    }

    /// Returns whether the figure is hidden in unfinished runs, except debug runs.
    pub(super) fn is_hidden(self) -> bool {
        self == BranchFigure::Satisfaction
    }
}

/// Returns the figures at the end of each week of a branch. `earlier` contains the days before the branch starts.
pub(super) fn weekly_values(earlier: &[DayFigures], outcome: &BranchOutcome) -> Vec<FigureValues> {
    let days: Vec<&DayFigures> = earlier.iter().chain(&outcome.days).collect();
    let churn = |last_day: u32| {
        let last = days.iter().rposition(|day| day.day == last_day).unwrap_or(0);
        let Some(before) = (last + 1).checked_sub(CHURN_WINDOW_DAYS + 1) else { return f64::NAN };
        let left: u32 = days[before + 1..=last].iter().map(|day| day.cancellations).sum();
        f64::from(left) / f64::from(days[before].individual_subscribers)
    };
    let weeks = outcome.weeks.iter().zip(&outcome.satisfaction);
    let value = |(week, satisfaction): (&WeekFigures, &f64)| {
        BranchFigure::ALL.map(|figure| match figure {
            BranchFigure::Cash => week.cash,
            BranchFigure::RecurringRevenue => week.recurring_revenue,
            BranchFigure::Subscribers => week.individual_subscribers.into(),
            BranchFigure::Seats => week.enterprise_seats.into(),
            BranchFigure::Churn => churn(week.day),
            BranchFigure::Leads => week.new_individual_leads.into(),
            BranchFigure::NewSubscribers => week.new_individual_subscribers.into(),
            BranchFigure::Conversion => week.conversion(),
            BranchFigure::Cancellations => week.cancellations.into(),
            BranchFigure::Satisfaction => *satisfaction,
        })
    };
    weeks.map(value).collect()
}
