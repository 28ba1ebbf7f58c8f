//! Figures of a week that explanations and lessons can name.

use super::simulated_week::{SimulatedWeek, WeekGroupFigures};
use super::week::WeekFigures;
use novamind_world::events::Category;

/// Unit in which a figure is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureUnit {
    /// An amount in dollars.
    Dollars,
    /// A count, for example of subscribers or issues.
    Count,
    /// A share, where 1 is 100 %.
    Share,
    /// A share that is shown as a percentage with two decimals.
    PreciseShare,
    /// A level that is shown with three decimals.
    Level,
}

/// A function that reads a figure of the company and returns NaN if the figure has no value. `None` if only groups
/// have the figure.
pub type CompanyReader = Option<fn(&SimulatedWeek) -> f64>;
/// A function that reads a figure of a group. `None` if only the company has the figure.
pub type GroupReader = Option<fn(&WeekGroupFigures) -> f64>;

macro_rules! define_figures {
    ($($figure:ident = $name:literal, $unit:ident, $company:expr, $group:expr;)*) => {
        /// A figure of a week that explanations and lessons can name.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        #[allow(missing_docs)] // The name of each figure describes it.
        pub enum WeekFigure { $($figure),* }

        impl WeekFigure {
            /// All figures: the figures of the Overview in screen order, then the figures of the ledger.
            pub const ALL: &'static [WeekFigure] = &[$(WeekFigure::$figure),*];

            /// Returns the name that screens show for the figure.
            pub fn name(self) -> &'static str {
                match self { $(WeekFigure::$figure => $name),* }
            }

            /// Returns the unit of the figure.
            pub fn unit(self) -> FigureUnit {
                match self { $(WeekFigure::$figure => FigureUnit::$unit),* }
            }

            /// Returns the function that reads the figure of the company.
            pub fn company_reader(self) -> CompanyReader {
                match self { $(WeekFigure::$figure => $company),* }
            }

            /// Returns the function that reads the figure of a group.
            pub fn group_reader(self) -> GroupReader {
                match self { $(WeekFigure::$figure => $group),* }
            }
        }
    };
}

// Cost figures are positive, unlike costs in the ledger.
define_figures! {
    CashChange = "cash change", Dollars, Some(|week| week.figures.cash_change), None;
    RecurringRevenue = "recurring revenue", Dollars, Some(|week| week.figures.recurring_revenue), None;
    Payments = "payments", Dollars, Some(|week| week.figures.payments), None;
    RunningCosts = "running costs", Dollars, Some(|week| week.figures.costs), None;
    Subscribers = "subscribers", Count,
        Some(|week| week.figures.individual_subscribers.into()), Some(|group| group.figures.subscribers.into());
    Leads = "leads", Count, Some(SimulatedWeek::total_leads), Some(|group| group.figures.leads.into());
    IndividualLeads = "individual leads", Count, Some(|week| week.figures.new_individual_leads.into()), None;
    NewSubscribers = "new subscribers", Count,
        Some(|week| week.figures.new_individual_subscribers.into()), Some(|group| group.figures.signed.into());
    Conversion = "conversion", PreciseShare, Some(|week| week.figures.conversion()), Some(WeekGroupFigures::conversion);
    Cancellations = "cancellations", Count,
        Some(|week| week.figures.cancellations.into()), Some(|group| group.figures.left.into());
    Churn = "weekly churn", PreciseShare, Some(SimulatedWeek::individual_churn), Some(WeekGroupFigures::churn);
    Upgrades = "upgrades", Count, Some(|week| week.figures.upgrades.into()), None;
    Downgrades = "downgrades", Count, Some(|week| week.figures.downgrades.into()), None;
    Seats = "seats", Count, Some(|week| week.figures.enterprise_seats.into()), None;
    EnterpriseLeads = "enterprise leads", Count, Some(|week| week.figures.new_enterprise_leads.into()), None;
    NewSeats = "new seats", Count, Some(|week| week.figures.new_enterprise_seats.into()), None;
    SeatsLost = "seats lost", Count, Some(|week| week.figures.seats_lost.into()), None;
    CompaniesLost = "companies lost", Count, Some(|week| week.figures.companies_lost.into()), None;
    Usage = "usage", Count, Some(|week| week.figures.usage as f64), Some(|group| group.figures.usage as f64);
    OverloadPeak = "overload", Share, Some(|week| week.figures.overload_peak), None;
    Outage = "outage", Count, Some(|week| week.figures.downtime_minutes.into()), None;
    LatencyPeak = "latency", Count, Some(|week| week.figures.p95_ms_peak), None;
    ErrorRatePeak = "error rate", PreciseShare, Some(|week| week.figures.error_rate_peak), None;
    OpenIssues = "open issues", Count,
        Some(|week| week.figures.open_issues.into()), Some(|group| group.figures.open_issues.into());
    Satisfaction = "satisfaction", Level,
        Some(|week| week.satisfaction), Some(|group| group.figures.satisfaction.unwrap_or(f64::NAN));
    Reputation = "reputation", Level, None, Some(|group| group.figures.reputation);
    Income = "income", Dollars, Some(SimulatedWeek::income), None;
    Costs = "costs", Dollars, Some(SimulatedWeek::costs), None;
    AdRevenue = "ad revenue", Dollars, Some(|week| week.figures.booked.category_total(Category::AdRevenue)), None;
    Compute = "compute", Dollars, Some(|week| week.category_costs(Category::Compute)), None;
    Capacity = "capacity", Dollars, Some(|week| week.category_costs(Category::Capacity)), None;
    Advertising = "advertising", Dollars, Some(|week| week.category_costs(Category::Advertising)), None;
    LeadCosts = "lead costs", Dollars, Some(|week| week.category_costs(Category::LeadAcquisitionCost)), None;
    Operations = "operations", Dollars, Some(|week| week.category_costs(Category::Operations)), None;
    Development = "development", Dollars, Some(|week| week.category_costs(Category::Development)), None;
    Research = "R&D", Dollars, Some(|week| week.category_costs(Category::ResearchProject)), None;
    MarketResearch = "market research", Dollars, Some(|week| week.category_costs(Category::MarketResearch)), None;
    GroupStudies = "group studies", Dollars, Some(|week| week.category_costs(Category::GroupResearch)), None;
}

impl WeekFigure {
    /// Returns the figure that screens show under this name. The name may be followed by a comma and a unit or `peak`.
    pub fn parse_label(name: &str) -> Option<WeekFigure> {
        let is_named = |figure: &WeekFigure| name.split(',').next().is_some_and(|name| name == figure.name());
        let longer = match name {
            "enterprise seats" => Some(WeekFigure::Seats),
            "cash at week's end" | "cash" => Some(WeekFigure::CashChange),
            "churn" => Some(WeekFigure::Churn),
            _ => None,
        };
        WeekFigure::ALL.iter().copied().find(is_named).or(longer)
    }

    /// Returns the figure that sums a ledger category; `None` for the initial funding.
    pub fn for_category(category: Category) -> Option<WeekFigure> {
        Some(match category {
            Category::SubscriptionPayment => WeekFigure::Payments,
            Category::AdRevenue => WeekFigure::AdRevenue,
            Category::InitialFunding => return None,
            Category::Compute => WeekFigure::Compute,
            Category::Capacity => WeekFigure::Capacity,
            Category::Advertising => WeekFigure::Advertising,
            Category::LeadAcquisitionCost => WeekFigure::LeadCosts,
            Category::Operations => WeekFigure::Operations,
            Category::Development => WeekFigure::Development,
            Category::ResearchProject => WeekFigure::Research,
            Category::MarketResearch => WeekFigure::MarketResearch,
            Category::GroupResearch => WeekFigure::GroupStudies,
        })
    }

    /// Returns the name that commands and data use for the figure, for example `new_subscribers`.
    pub fn id(self) -> String {
        match self {
            // Screens also show 30-day churn, but commands and data have only this figure.
            WeekFigure::Churn => "churn".to_owned(),
            _ => self.name().replace(' ', "_"),
        }
    }

    /// Returns whether the figure is hidden until the run ends. Debug runs always show the figure.
    pub fn is_hidden(self) -> bool {
        matches!(self, WeekFigure::Satisfaction | WeekFigure::Reputation)
    }

    /// Computes the value of the figure from the visible figures of a week. Returns NaN if the figure has no value.
    /// Returns `None` if the figure needs group data or is hidden.
    pub fn company_value(self, figures: &WeekFigures) -> Option<f64> {
        use WeekFigure::{Churn, Leads, Reputation, Satisfaction};
        if matches!(self, Leads | Churn | Satisfaction | Reputation) {
            return None;
        }
        Some(self.company_reader()?(&SimulatedWeek::from_company_figures(*figures)))
    }

    /// Returns whether the figure exists for the company.
    pub fn has_company_value(self) -> bool {
        self.company_reader().is_some()
    }

    /// Returns whether the figure exists for each group.
    pub fn has_group_values(self) -> bool {
        self.group_reader().is_some()
    }
}
