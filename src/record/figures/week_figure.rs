//! Figures of a week whose change can be explained.

use super::simulated_week::{GroupOfWeek, SimulatedWeek};
use super::week::WeekFigures;
use novamind_world::events::Category;

/// What a figure is counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureUnit {
    /// Dollars.
    Dollars,
    /// A number of something.
    Count,
    /// A share, from 0 to 1 and above.
    Share,
    /// A share of which hundredths of a percent matter.
    FineShare,
    /// A level that is no share, and of which thousandths matter.
    Level,
}

/// How a figure is read of the company; none where it is one of groups only. Not a number where it has no value.
pub type OfCompany = Option<fn(&SimulatedWeek) -> f64>;
/// How it is read of a group; none where it is one of the company only.
pub type OfGroup = Option<fn(&GroupOfWeek) -> f64>;

macro_rules! figures {
    ($($figure:ident = $name:literal, $unit:ident, $company:expr, $group:expr;)*) => {
        /// A figure of a week.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        #[allow(missing_docs)] // Each is described by its name.
        pub enum WeekFigure { $($figure),* }

        impl WeekFigure {
            /// All of them: those of the Overview in its order, then those of the ledger.
            pub const ALL: &'static [WeekFigure] = &[$(WeekFigure::$figure),*];

            /// Name, as screens write it.
            pub fn name(self) -> &'static str {
                match self { $(WeekFigure::$figure => $name),* }
            }

            /// What it is counted in.
            pub fn unit(self) -> FigureUnit {
                match self { $(WeekFigure::$figure => FigureUnit::$unit),* }
            }

            /// How it is read of the company.
            pub fn of_company(self) -> OfCompany {
                match self { $(WeekFigure::$figure => $company),* }
            }

            /// How it is read of a group.
            pub fn of_group(self) -> OfGroup {
                match self { $(WeekFigure::$figure => $group),* }
            }
        }
    };
}

// Costs of the ledger are told as what they are, not as negative dollars.
figures! {
    CashChange = "cash change", Dollars, Some(|week| week.figures.cash_change), None;
    RecurringRevenue = "recurring revenue", Dollars, Some(|week| week.figures.recurring_revenue), None;
    Payments = "payments", Dollars, Some(|week| week.figures.payments), None;
    RunningCosts = "running costs", Dollars, Some(|week| week.figures.costs), None;
    Subscribers = "subscribers", Count,
        Some(|week| week.figures.individual_subscribers.into()), Some(|own| own.measured.subscribers.into());
    Leads = "leads", Count, Some(SimulatedWeek::leads), Some(|own| own.measured.leads.into());
    IndividualLeads = "individual leads", Count, Some(|week| week.figures.new_individual_leads.into()), None;
    NewSubscribers = "new subscribers", Count,
        Some(|week| week.figures.new_individual_subscribers.into()), Some(|own| own.measured.signed.into());
    Conversion = "conversion", FineShare, Some(|week| week.figures.conversion()), Some(GroupOfWeek::conversion);
    Cancellations = "cancellations", Count,
        Some(|week| week.figures.cancellations.into()), Some(|own| own.measured.left.into());
    Churn = "churn", FineShare, Some(SimulatedWeek::churn), Some(GroupOfWeek::churn);
    Upgrades = "upgrades", Count, Some(|week| week.figures.upgrades.into()), None;
    Downgrades = "downgrades", Count, Some(|week| week.figures.downgrades.into()), None;
    Seats = "seats", Count, Some(|week| week.figures.enterprise_seats.into()), None;
    EnterpriseLeads = "enterprise leads", Count, Some(|week| week.figures.new_enterprise_leads.into()), None;
    NewSeats = "new seats", Count, Some(|week| week.figures.new_enterprise_seats.into()), None;
    SeatsLost = "seats lost", Count, Some(|week| week.figures.seats_lost.into()), None;
    CompaniesLost = "companies lost", Count, Some(|week| week.figures.companies_lost.into()), None;
    Usage = "usage", Count, Some(|week| week.figures.usage as f64), Some(|own| own.measured.usage as f64);
    OverloadPeak = "overload", Share, Some(|week| week.figures.overload_peak), None;
    Outage = "outage", Count, Some(|week| week.figures.downtime_minutes.into()), None;
    LatencyPeak = "latency", Count, Some(|week| week.figures.p95_ms_peak), None;
    ErrorRatePeak = "error rate", FineShare, Some(|week| week.figures.error_rate_peak), None;
    OpenIssues = "open issues", Count,
        Some(|week| week.figures.open_issues.into()), Some(|own| own.measured.open_issues.into());
    Satisfaction = "satisfaction", Level,
        Some(|week| week.satisfaction), Some(|own| own.measured.satisfaction.unwrap_or(f64::NAN));
    Reputation = "reputation", Level, None, Some(|own| own.measured.reputation);
    Income = "income", Dollars, Some(SimulatedWeek::income), None;
    Costs = "costs", Dollars, Some(SimulatedWeek::costs), None;
    AdRevenue = "ad revenue", Dollars, Some(|week| week.figures.booked.of(Category::AdRevenue)), None;
    Compute = "compute", Dollars, Some(|week| week.spent(Category::Compute)), None;
    Capacity = "capacity", Dollars, Some(|week| week.spent(Category::Capacity)), None;
    Advertising = "advertising", Dollars, Some(|week| week.spent(Category::Advertising)), None;
    LeadCosts = "lead costs", Dollars, Some(|week| week.spent(Category::LeadAcquisitionCost)), None;
    Operations = "operations", Dollars, Some(|week| week.spent(Category::Operations)), None;
    Development = "development", Dollars, Some(|week| week.spent(Category::Development)), None;
    Research = "R&D", Dollars, Some(|week| week.spent(Category::ResearchProject)), None;
    MarketResearch = "market research", Dollars, Some(|week| week.spent(Category::MarketResearch)), None;
    GroupStudies = "group studies", Dollars, Some(|week| week.spent(Category::GroupResearch)), None;
}

impl WeekFigure {
    /// The figure that screens call so; unit or peak may follow its name.
    pub fn named(name: &str) -> Option<WeekFigure> {
        let own = |figure: &WeekFigure| name.split(',').next().is_some_and(|name| name == figure.name());
        let longer = match name {
            "enterprise seats" => Some(WeekFigure::Seats),
            "cash at week's end" | "cash" => Some(WeekFigure::CashChange),
            _ => None,
        };
        WeekFigure::ALL.iter().copied().find(own).or(longer)
    }

    /// The figure that movements of a category of the ledger add up to; none of the money that the company began with.
    pub fn of_category(category: Category) -> Option<WeekFigure> {
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

    /// Its name in commands and data: `new_subscribers`.
    pub fn id(self) -> String {
        self.name().replace(' ', "_")
    }

    /// Whether no player may see it whose run goes on, outside of debug runs.
    pub fn is_hidden(self) -> bool {
        matches!(self, WeekFigure::Satisfaction | WeekFigure::Reputation)
    }

    /// Its value in a week whose groups are not told; none for a figure that is made of groups or hidden. Not a number where
    /// it has no value.
    pub fn of_week(self, figures: &WeekFigures) -> Option<f64> {
        use WeekFigure::{Churn, Leads, Reputation, Satisfaction};
        if matches!(self, Leads | Churn | Satisfaction | Reputation) {
            return None;
        }
        Some(self.of_company()?(&SimulatedWeek::without_groups(*figures)))
    }

    /// Whether it is one of the company.
    pub fn is_of_company(self) -> bool {
        self.of_company().is_some()
    }

    /// Whether it is one of each group.
    pub fn is_of_group(self) -> bool {
        self.of_group().is_some()
    }
}
