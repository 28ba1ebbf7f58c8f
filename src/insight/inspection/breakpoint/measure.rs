//! Daily figures of the company or of a group, for conditions.

use std::fmt;

use super::measured_days::MeasuredDay;
use novamind_record::figures::GroupFigures;
use novamind_record::figures::churn;
use novamind_world::identifiers::Group;

/// The relation of a figure to time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeasureKind {
    /// The value at the end of a day.
    State,
    /// A count or amount of a day, which can be summed over several days.
    Flow,
    /// A share over several days, with the default number of days.
    Share(u32),
}

// For a share, the function returns the numerator. `Quantity::value` divides the sum by the denominator.
type CompanyFigureFn = Option<fn(&MeasuredDay) -> f64>;
type GroupFigureFn = Option<fn(&GroupFigures) -> Option<f64>>;

macro_rules! measures {
    ($($measure:ident = $id:literal, $kind:expr, $company:expr, $group:expr;)*) => {
        /// A daily figure of the company or of a group.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[allow(missing_docs)] // The name of each figure describes it.
        pub enum Measure { $($measure),* }

        impl Measure {
            /// All daily figures that a condition can use.
            pub const ALL: &'static [Measure] = &[$(Measure::$measure),*];

            /// Returns the identifier that conditions and data use for the figure.
            pub fn id(self) -> &'static str {
                match self { $(Measure::$measure => $id),* }
            }

            /// Returns how the figure relates to time.
            pub fn kind(self) -> MeasureKind {
                match self { $(Measure::$measure => $kind),* }
            }

            fn company_figure(self) -> CompanyFigureFn {
                match self { $(Measure::$measure => $company),* }
            }

            fn group_figure(self) -> GroupFigureFn {
                match self { $(Measure::$measure => $group),* }
            }
        }
    };
}

measures! {
    Cash = "cash", MeasureKind::State, Some(|day| day.figures.cash), None;
    RecurringRevenue = "recurring_revenue", MeasureKind::State, Some(|day| day.figures.mrr), None;
    Payments = "payments", MeasureKind::Flow, Some(|day| day.figures.payments_received), None;
    RunningCosts = "running_costs", MeasureKind::Flow, Some(|day| day.figures.total_costs), None;
    Subscribers = "subscribers", MeasureKind::State,
        Some(|day| day.figures.individual_subscribers.into()), Some(|group_figures| Some(group_figures.subscribers.into()));
    Seats = "seats", MeasureKind::State, Some(|day| day.figures.enterprise_seats.into()), None;
    Leads = "leads", MeasureKind::Flow,
        Some(|day| day.figures.new_leads.into()), Some(|figures| Some(figures.leads.into()));
    IndividualLeads = "individual_leads", MeasureKind::Flow,
        Some(|day| day.figures.new_individual_leads.into()), None;
    NewSubscribers = "new_subscribers", MeasureKind::Flow,
        Some(|day| day.figures.new_individual_subscribers.into()), Some(|figures| Some(figures.signed.into()));
    NewSeats = "new_seats", MeasureKind::Flow, Some(|day| day.figures.new_enterprise_seats.into()), None;
    Conversion = "conversion", MeasureKind::Share(7),
        Some(|day| day.figures.new_individual_subscribers.into()), Some(|figures| Some(figures.signed.into()));
    Cancellations = "cancellations", MeasureKind::Flow,
        Some(|day| day.figures.cancellations.into()), Some(|figures| Some(figures.left.into()));
    Churn = "churn", MeasureKind::Share(30),
        Some(|day| day.figures.cancellations.into()), Some(|figures| Some(figures.left.into()));
    Upgrades = "upgrades", MeasureKind::Flow, Some(|day| day.figures.upgrades.into()), None;
    Downgrades = "downgrades", MeasureKind::Flow, Some(|day| day.figures.downgrades.into()), None;
    Usage = "usage", MeasureKind::Flow,
        Some(|day| day.figures.total_usage as f64), Some(|figures| Some(figures.usage as f64));
    Overload = "overload", MeasureKind::State, Some(|day| day.figures.overload), None;
    Downtime = "downtime_minutes", MeasureKind::Flow,
        Some(|day| day.figures.downtime_minutes.into()), None;
    OpenIssues = "open_issues", MeasureKind::State,
        Some(|day| day.open_issues().into()), Some(|figures| Some(figures.open_issues.into()));
    Reputation = "reputation", MeasureKind::State, None, Some(|figures| Some(figures.reputation));
    Satisfaction = "satisfaction", MeasureKind::State, None, Some(|figures| figures.satisfaction);
    Relationship = "relationship", MeasureKind::State, None, Some(|figures| figures.relationship);
}

/// The reason why a quantity is invalid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum QuantityError {
    /// A group is given, but only the company has the figure.
    CompanyOnly,
    /// No group is given, but only groups have the figure.
    GroupOnly,
    /// A number of days is given, but the figure is a value at the end of a day.
    NotSummable,
    /// The number of days is 0 or above [`Quantity::MAX_DAYS`].
    DaysOutOfRange,
}

/// A figure of the company or of a group, over one or more days that end with the evaluated day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quantity {
    measure: Measure,
    group: Option<Group>,
    days: u32,
}

impl Quantity {
    /// Maximum number of days over which a figure can be summed.
    pub const MAX_DAYS: u32 = 1000;

    /// Creates a quantity. `days`, if given, must be from 1 to [`Quantity::MAX_DAYS`].
    pub(crate) fn new(
        measure: Measure,
        group: Option<Group>,
        days: Option<u32>,
    ) -> Result<Quantity, QuantityError> {
        match group {
            Some(_) if measure.group_figure().is_none() => return Err(QuantityError::CompanyOnly),
            None if measure.company_figure().is_none() => return Err(QuantityError::GroupOnly),
            _ => {}
        }
        let days = match (measure.kind(), days) {
            (MeasureKind::State, Some(_)) => return Err(QuantityError::NotSummable),
            (_, Some(days)) if !(1..=Quantity::MAX_DAYS).contains(&days) => {
                return Err(QuantityError::DaysOutOfRange);
            }
            (_, Some(days)) => days,
            (MeasureKind::Share(usual), None) => usual,
            (MeasureKind::State | MeasureKind::Flow, None) => 1,
        };
        Ok(Quantity { measure, group, days })
    }

    /// Returns the daily figure without its group and days.
    pub fn measure(&self) -> Measure {
        self.measure
    }

    /// Returns the group of the figure, or `None` for the company.
    pub fn group(&self) -> Option<Group> {
        self.group
    }

    /// Returns the number of days of a sum or share; 1 for a value at the end of a day.
    pub fn days(&self) -> u32 {
        self.days
    }

    /// Returns the number of days as conditions write it, for example ` over 7`; empty for the value of one day.
    pub fn describe_days(&self) -> String {
        match (self.measure.kind(), self.days) {
            (MeasureKind::State, _) | (MeasureKind::Flow, 1) => String::new(),
            (_, days) => format!(" over {days}"),
        }
    }

    /// Returns the value of the figure on a day. `days` starts with day 1. Returns `None` if too few days have been
    /// simulated or the denominator is 0.
    pub(crate) fn value(&self, days: &[MeasuredDay], day: u32) -> Option<f64> {
        let value = match self.measure {
            Measure::Churn => {
                let beginning = day.checked_sub(self.days)?;
                let before = self.value_on_day(Measure::Subscribers, days, beginning)?;
                churn(self.sum(self.measure, days, day)?, before)?
            }
            Measure::Conversion => {
                let leads = if self.group.is_some() { Measure::Leads } else { Measure::IndividualLeads };
                self.sum(self.measure, days, day)? / self.sum(leads, days, day)?
            }
            measure if measure.kind() == MeasureKind::State => self.value_on_day(measure, days, day)?,
            measure => self.sum(measure, days, day)?,
        };
        value.is_finite().then_some(value)
    }

    fn sum(&self, measure: Measure, days: &[MeasuredDay], day: u32) -> Option<f64> {
        let first = (day + 1).checked_sub(self.days)?;
        (first..=day).map(|day| self.value_on_day(measure, days, day)).sum()
    }

    fn value_on_day(&self, measure: Measure, days: &[MeasuredDay], day: u32) -> Option<f64> {
        let measured_day = days.get(day.checked_sub(1)? as usize)?;
        match self.group {
            Some(group) => measure.group_figure()?(&measured_day.groups[group]),
            None => Some(measure.company_figure()?(measured_day)),
        }
    }
}

/// Formats a figure: `churn(S1)` or `cash`.
impl fmt::Display for Quantity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.group {
            Some(group) => write!(formatter, "{}({group})", self.measure.id()),
            None => formatter.write_str(self.measure.id()),
        }
    }
}
