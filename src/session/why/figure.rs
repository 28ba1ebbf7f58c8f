//! Figures of a week whose change can be explained.

use crate::session::figures::week::WeekFigures;

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
}

macro_rules! figures {
    ($($figure:ident = $name:literal, $unit:ident, $read:expr;)*) => {
        /// A figure of a week.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        #[allow(missing_docs)] // Each is described by its name.
        pub enum WeekFigure { $($figure),* }

        impl WeekFigure {
            /// All of them, in the order of the Overview.
            pub const ALL: &'static [WeekFigure] = &[$(WeekFigure::$figure),*];

            /// Name, as screens write it.
            pub fn name(self) -> &'static str {
                match self { $(WeekFigure::$figure => $name),* }
            }

            /// What it is counted in.
            pub fn unit(self) -> FigureUnit {
                match self { $(WeekFigure::$figure => FigureUnit::$unit),* }
            }

            /// Its value in a week; not a number where it has none.
            pub fn of(self, week: &WeekFigures) -> f64 {
                let read: fn(&WeekFigures) -> f64 = match self { $(WeekFigure::$figure => $read),* };
                read(week)
            }
        }
    };
}

figures! {
    CashChange = "cash change", Dollars, |week| week.cash_change;
    RecurringRevenue = "recurring revenue", Dollars, |week| week.recurring_revenue;
    Payments = "payments", Dollars, |week| week.payments;
    RunningCosts = "running costs", Dollars, |week| week.costs;
    Subscribers = "subscribers", Count, |week| f64::from(week.individual_subscribers);
    IndividualLeads = "individual leads", Count, |week| f64::from(week.new_individual_leads);
    NewSubscribers = "new subscribers", Count, |week| f64::from(week.new_individual_subscribers);
    Conversion = "conversion", FineShare, WeekFigures::conversion;
    Cancellations = "cancellations", Count, |week| f64::from(week.cancellations);
    Upgrades = "upgrades", Count, |week| f64::from(week.upgrades);
    Downgrades = "downgrades", Count, |week| f64::from(week.downgrades);
    Seats = "seats", Count, |week| f64::from(week.enterprise_seats);
    EnterpriseLeads = "enterprise leads", Count, |week| f64::from(week.new_enterprise_leads);
    NewSeats = "new seats", Count, |week| f64::from(week.new_enterprise_seats);
    SeatsLost = "seats lost", Count, |week| f64::from(week.seats_lost);
    CompaniesLost = "companies lost", Count, |week| f64::from(week.companies_lost);
    Usage = "usage", Count, |week| week.usage as f64;
    OverloadPeak = "overload", Share, |week| week.overload_peak;
    Outage = "outage", Count, |week| f64::from(week.downtime_minutes);
    OpenIssues = "open issues", Count, |week| f64::from(week.open_issues);
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

    /// Its name in commands and data: `new_subscribers`.
    pub fn id(self) -> String {
        self.name().replace(' ', "_")
    }
}
