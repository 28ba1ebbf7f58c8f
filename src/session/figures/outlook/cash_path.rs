//! Expected cash by day. Current subscribers are billed on their billing dates and renew or cancel at recent rates.
//! Signups continue their trend, which fades. Compute and ad revenue are proportional to recurring revenue. Costs to
//! which the settings commit the company stay as they are.
//!
//! The constants minimize the mean absolute error in `novamind lab forecasts`.

use super::billing_calendar::{BillingCalendar, SIGN_UP_WEEKS};
use novamind_record::figures::WeekFigures;
use novamind_world::events::Category;

/// Share of the growth rate of signups that remains after a day: 75 % after a week.
const GROWTH_KEPT_PER_DAY: f64 = 0.959_74;
/// Lower and upper limit of the weekly growth rate of signups, as logarithms.
const GROWTH_LIMITS: [f64; 2] = [-0.4, 0.15];
/// Rate at which signups decrease per week if they have no trend. Competitors and saturation reduce the signups of
/// most companies.
const SIGN_UP_DECAY_PER_WEEK: f64 = 0.08;
/// Number of signups at which half of the observed growth rate counts. The growth of fewer signups is mostly due to
/// chance.
const SIGN_UPS_OF_HALF_TREND: f64 = 10.0;
/// Assumed churn of individuals per billing period before any renewal, and the weight of this assumption, in
/// subscribers.
const ASSUMED_CHURN: (f64, f64) = (0.3, 20.0);
/// Assumed churn of enterprise seats per billing period before any renewal, and the weight of this assumption, in
/// seats.
const ASSUMED_SEAT_CHURN: (f64, f64) = (0.05, 100.0);
/// Days until an enterprise receives its first bill, on average.
const FIRST_ENTERPRISE_BILL_DAYS: usize = 15;
/// Limits of the logarithmic growth of new enterprise revenue and of lead costs.
const MAX_ENTERPRISE_GROWTH: f64 = 0.7;
const MAX_LEAD_COST_GROWTH: f64 = 1.5;
/// Upper limit of daily compute and of daily ad revenue, each as a share of monthly revenue.
const MAX_DAILY_SHARE: f64 = 1.0 / 7.0;

/// Cash and cumulative flows by day, beginning with today.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CashPath {
    committed: f64,
    days: Vec<PathDay>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct PathDay {
    cash: f64,
    /// Payments and ad revenue since today, dollars.
    income: f64,
    /// Compute and lead costs since today, dollars.
    variable: f64,
}

impl CashPath {
    pub(super) fn new(
        cash: f64,
        committed: f64,
        calendar: &BillingCalendar,
        weeks: &[WeekFigures],
        days: u32,
    ) -> CashPath {
        let trend = Trend::new(calendar, weeks);
        let mut path = vec![PathDay { cash, income: 0.0, variable: 0.0 }];
        let mut bills = [calendar.individuals.clone(), calendar.enterprises.clone()];
        let mut revenue: f64 = bills.iter().flatten().sum();
        let (mut growth, mut rate) = (0.0, trend.growth_rate / 7.0);
        for day in 0..days as usize {
            rate *= GROWTH_KEPT_PER_DAY;
            growth += rate - SIGN_UP_DECAY_PER_WEEK / 7.0;
            let new = trend.daily_sign_ups * libm::exp(growth);
            let new_seats = trend.daily_new_enterprise_revenue * libm::exp(growth.min(MAX_ENTERPRISE_GROWTH));
            let due = [0, 1].map(|at: usize| bills[at].get(day).copied().unwrap_or(0.0));
            let kept = [due[0] * (1.0 - trend.churn), due[1] * (1.0 - trend.seat_churn)];
            let first_bills = if day < FIRST_ENTERPRISE_BILL_DAYS { 0.0 } else { new_seats };
            let paid = [kept[0] + new, kept[1] + first_bills];
            bills.iter_mut().zip(paid).for_each(|(bills, paid)| bills.push(paid));
            revenue = (revenue + new + new_seats + kept[0] - due[0] + kept[1] - due[1]).max(0.0);
            let income = paid[0] + paid[1] + trend.ad_revenue_share * revenue;
            let variable = trend.compute_share * revenue
                + trend.daily_lead_cost * libm::exp(growth.min(MAX_LEAD_COST_GROWTH));
            let before = path[day];
            path.push(PathDay {
                cash: before.cash + income - variable - committed,
                income: before.income + income,
                variable: before.variable + variable,
            });
        }
        CashPath { committed, days: path }
    }

    /// Returns the last day of the path.
    pub(super) fn last_day(&self) -> u32 {
        self.days.len() as u32 - 1
    }

    /// Returns the expected cash after a number of days, in dollars. It can be negative.
    pub(super) fn cash(&self, days: u32) -> f64 {
        self.day(days).cash
    }

    /// Returns the cumulative income and variable costs of a number of days, in dollars.
    pub(super) fn flows(&self, days: u32) -> (f64, f64) {
        let day = self.day(days);
        (day.income, day.variable)
    }

    /// Returns the sum of all income and costs of a number of days, in dollars.
    pub(super) fn turnover(&self, days: u32) -> f64 {
        let (income, variable) = self.flows(days);
        income + variable + self.committed * f64::from(days.min(self.last_day()))
    }

    fn day(&self, days: u32) -> PathDay {
        self.days[days.min(self.last_day()) as usize]
    }
}

/// Rates of recent weeks, which the path continues.
#[derive(Default)]
struct Trend {
    /// Monthly revenue of the individuals who sign up on a day, dollars.
    daily_sign_ups: f64,
    /// Growth rate of signups per week, as a logarithm.
    growth_rate: f64,
    /// Monthly revenue of new enterprise seats per day, dollars.
    daily_new_enterprise_revenue: f64,
    /// Share of individuals who cancel in a billing period.
    churn: f64,
    /// Share of seats that enterprises cancel in a billing period.
    seat_churn: f64,
    /// Lead costs, dollars per day.
    daily_lead_cost: f64,
    /// Compute per day, as a share of monthly revenue.
    compute_share: f64,
    /// Ad revenue per day, as a share of monthly revenue.
    ad_revenue_share: f64,
}

impl Trend {
    fn new(calendar: &BillingCalendar, weeks: &[WeekFigures]) -> Trend {
        let recent = &weeks[weeks.len().saturating_sub(SIGN_UP_WEEKS)..];
        let Some(last) = recent.last() else { return Trend::default() };
        let sum = |figure: &dyn Fn(&WeekFigures) -> u32| f64::from(recent.iter().map(figure).sum::<u32>());
        let days = sum(&|week| week.days_run).max(1.0);
        let before = weeks.len().checked_sub(SIGN_UP_WEEKS + 1).map(|at| &weeks[at]);
        let periods = days / calendar.individuals.len().max(1) as f64;
        // Before the first renewals, cancellations provide no information about renewals.
        let churn = |left: f64, base: Option<u32>, (assumed, weight): (f64, f64)| {
            let (left, base) = base.map_or((0.0, 0.0), |base| (left / periods, f64::from(base)));
            ((left + assumed * weight) / (base + weight)).clamp(0.0, 1.0)
        };
        let (daily_sign_ups, growth_rate) =
            sign_up_trend(&calendar.signed_up[..recent.len()], sum(&|week| week.new_individual_subscribers));
        let seat_price = calendar.enterprises.iter().sum::<f64>() / f64::from(last.enterprise_seats.max(1));
        // Revenue in the middle of the last two weeks. Compute and ad revenue of these weeks depend on this revenue.
        let revenue_before = recent.iter().rev().nth(1).map_or(0.0, |week| week.recurring_revenue);
        let revenue = (revenue_before + last.recurring_revenue) / 2.0;
        let share = |category| match revenue > 1.0 {
            true => (daily_amount(&[*last], category) / revenue).min(MAX_DAILY_SHARE),
            false => 0.0,
        };
        Trend {
            daily_sign_ups,
            growth_rate,
            daily_new_enterprise_revenue: sum(&|week| week.new_enterprise_seats) * seat_price / days,
            churn: churn(
                sum(&|week| week.cancellations),
                before.map(|week| week.individual_subscribers),
                ASSUMED_CHURN,
            ),
            seat_churn: churn(
                sum(&|week| week.seats_lost),
                before.map(|week| week.enterprise_seats),
                ASSUMED_SEAT_CHURN,
            ),
            daily_lead_cost: daily_amount(
                &recent[recent.len().saturating_sub(2)..],
                Category::LeadAcquisitionCost,
            ),
            compute_share: share(Category::Compute),
            ad_revenue_share: share(Category::AdRevenue),
        }
    }
}

/// Returns the mean amount of a ledger category per day, as a positive number of dollars.
pub(super) fn daily_amount(weeks: &[WeekFigures], category: Category) -> f64 {
    let days: u32 = weeks.iter().map(|week| week.days_run).sum();
    weeks.iter().map(|week| week.booked.category_total(category)).sum::<f64>().abs() / f64::from(days.max(1))
}

/// Returns the level of signups in dollars per day, and their growth rate per week as a logarithm. `signed_up` are the
/// amounts of past weeks, the last week first, and `count` is the number of these signups.
fn sign_up_trend(signed_up: &[f64], count: f64) -> (f64, f64) {
    let half = signed_up.len() / 2;
    if half == 0 {
        return (signed_up.first().map_or(0.0, |week| week / 7.0), 0.0);
    }
    let mean = |weeks: &[f64]| weeks.iter().sum::<f64>() / weeks.len() as f64;
    let (recent, older) = (mean(&signed_up[..half]), mean(&signed_up[signed_up.len() - half..]));
    let observed = match recent > 0.0 && older > 0.0 {
        true => libm::log(recent / older) / (signed_up.len() - half) as f64,
        false => 0.0,
    };
    let [least, most] = GROWTH_LIMITS;
    let rate = (observed * count / (count + SIGN_UPS_OF_HALF_TREND)).clamp(least, most);
    // The mean refers to the middle of the recent weeks.
    let level = recent * libm::exp(rate * (half as f64 - 1.0) / 2.0);
    (level / 7.0, rate)
}
