//! Gross margins of plans: subscription revenue compared with the compute cost of usage, on every model tier. The
//! Product screen, forms and plain mode use the same definition. The compute cost is 30 times the cost of the last
//! day's usage. The revenue is the monthly price of the subscriptions that could use the product on the last day. It
//! excludes subscriptions that started on the last day, because they have no usage yet.

mod sentences;

use serde_json::Value;

pub use sentences::margin_sentences;

use super::formatting::format_money;
use novamind_base::formatting::{compact_number, dollars_and_cents, percent};
use novamind_database::{Cell, QueryResult, number_at, text_at};
use novamind_session::identifiers::{ByPlan, Group, Plan};
use novamind_session::{Session, query_rejection};
use novamind_tools::{Rejection, ToolId};

const SUBSCRIBERS_SQL: &str = include_str!("../../assets/readings/subscribers.sql");
const USAGE_SQL: &str = include_str!("../../assets/readings/usage.sql");
const DAYS_PER_MONTH: f64 = 30.0;
/// Text that replaces the margins until usage has been measured.
const NO_USAGE_MESSAGE: &str = "no margins: usage has not been measured yet";

/// Subscribers of a plan, their payments and their usage on the last day.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlanUsage {
    /// Number of active subscriptions of the plan.
    pub customers: f64,
    /// Number of seats of the active subscriptions.
    pub seats: f64,
    /// Revenue of the active subscriptions, dollars per month.
    pub monthly_revenue: f64,
    /// Number of subscriptions with measured usage: those that could use the product on the last day.
    pub measured_subscriptions: f64,
    /// Number of seats of the subscriptions with measured usage.
    pub measured_seats: f64,
    /// Measured usage on the last day, units.
    pub measured_units: f64,
    /// Revenue of the subscriptions with measured usage, dollars per month.
    pub measured_revenue: f64,
}

impl PlanUsage {
    fn add(self, other: PlanUsage) -> PlanUsage {
        PlanUsage {
            customers: self.customers + other.customers,
            seats: self.seats + other.seats,
            monthly_revenue: self.monthly_revenue + other.monthly_revenue,
            measured_subscriptions: self.measured_subscriptions + other.measured_subscriptions,
            measured_seats: self.measured_seats + other.measured_seats,
            measured_units: self.measured_units + other.measured_units,
            measured_revenue: self.measured_revenue + other.measured_revenue,
        }
    }

    /// Returns the usage in units per seat per day, or `None` if no usage was measured.
    pub fn units_per_seat(&self) -> Option<f64> {
        (self.measured_seats > 0.0).then(|| self.measured_units / self.measured_seats)
    }

    /// Returns the compute cost in dollars per seat per month. `unit_cost` is in dollars per unit.
    pub fn compute_cost(&self, unit_cost: f64) -> Option<f64> {
        self.units_per_seat().map(|usage| usage * DAYS_PER_MONTH * unit_cost)
    }

    /// Returns the revenue in dollars per seat per month. Only subscriptions with measured usage count. If no usage was
    /// measured, all subscriptions count.
    pub fn revenue_per_seat(&self) -> Option<f64> {
        match self.measured_seats > 0.0 {
            true => Some(self.measured_revenue / self.measured_seats),
            false => (self.seats > 0.0).then(|| self.monthly_revenue / self.seats),
        }
    }

    fn measured_revenue_per_seat(&self) -> Option<f64> {
        self.revenue_per_seat().filter(|_| self.units_per_seat().is_some())
    }

    /// Returns the share of revenue that compute leaves over, or `None` if it is unknown. `unit_cost` is in dollars per
    /// unit.
    pub fn margin(&self, unit_cost: f64) -> Option<f64> {
        margin(self.revenue_per_seat()?, self.compute_cost(unit_cost)?)
    }

    /// Returns the margin that the plan would have if every customer used the full quota. `quota` is in units per day.
    fn margin_at_full_quota(&self, quota: f64, unit_cost: f64) -> Option<f64> {
        let full = PlanUsage { measured_units: self.measured_subscriptions * quota, ..*self };
        full.margin(unit_cost)
    }
}

fn margin(price: f64, compute: f64) -> Option<f64> {
    (price > 0.0).then(|| 1.0 - compute / price)
}

/// Revenue and usage, by group and plan.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PlanSales {
    subscribed: Vec<(Group, Plan, PlanUsage)>,
    used: Vec<(Group, Plan, PlanUsage)>,
}

impl PlanSales {
    /// Reads the database of a run. The queries are not recorded.
    ///
    /// # Errors
    /// Returns an error if the run has no database or the database cannot be read.
    pub fn load(session: &Session) -> Result<PlanSales, Rejection> {
        session.wait_for_database()?;
        let (connection, limits) = (session.database().open_connection()?, session.company().query_limits());
        let mut sales = PlanSales::default();
        sales.set_subscribers(&connection.query(SUBSCRIBERS_SQL, limits).map_err(query_rejection)?);
        sales.set_usage(&connection.query(USAGE_SQL, limits).map_err(query_rejection)?);
        Ok(sales)
    }

    /// Sets the subscribers from a query result with these columns: group, plan, customers, seats, dollars per month.
    pub fn set_subscribers(&mut self, rows: &QueryResult) {
        self.subscribed = by_plan(rows, |row| PlanUsage {
            customers: number_at(row, 2),
            seats: number_at(row, 3),
            monthly_revenue: number_at(row, 4),
            ..PlanUsage::default()
        });
    }

    /// Sets the usage from a query result with these columns: group, plan, subscriptions, seats, units, dollars per
    /// month.
    pub fn set_usage(&mut self, rows: &QueryResult) {
        self.used = by_plan(rows, |row| PlanUsage {
            measured_subscriptions: number_at(row, 2),
            measured_seats: number_at(row, 3),
            measured_units: number_at(row, 4),
            measured_revenue: number_at(row, 5),
            ..PlanUsage::default()
        });
    }

    fn is_measured(&self) -> bool {
        Plan::ALL.into_iter().any(|plan| self.usage_of_plan(plan).units_per_seat().is_some())
    }

    /// Returns the usage of a plan, summed over all groups.
    pub fn usage_of_plan(&self, plan: Plan) -> PlanUsage {
        self.sum(|_, row_plan| row_plan == plan)
    }

    fn by_group(&self, plan: Plan) -> Vec<(Group, PlanUsage)> {
        let of =
            |group: Group| (group, self.sum(|row_group, row_plan| row_group == group && row_plan == plan));
        Group::all().map(of).filter(|(_, plan_usage)| plan_usage.customers > 0.0).collect()
    }

    fn sum(&self, counts: impl Fn(Group, Plan) -> bool) -> PlanUsage {
        let counted_rows =
            self.subscribed.iter().chain(&self.used).filter(|(group, plan, _)| counts(*group, *plan));
        counted_rows.fold(PlanUsage::default(), |sum, (_, _, more)| sum.add(*more))
    }
}

fn by_plan(rows: &QueryResult, read: impl Fn(&[Cell]) -> PlanUsage) -> Vec<(Group, Plan, PlanUsage)> {
    let parse_row =
        |row: &Vec<Cell>| Some((Group::parse(text_at(row, 0))?, Plan::parse(text_at(row, 1))?, read(row)));
    rows.rows.iter().filter_map(parse_row).collect()
}

/// Price, model tier and quota of a plan, in force or in an edited form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DraftPlanTerms {
    /// List price, dollars per seat per month.
    pub price: f64,
    /// Model tier that serves the plan.
    pub tier: u8,
    /// Quota, units per customer per day.
    pub quota: f64,
}

impl DraftPlanTerms {
    /// Returns the compute cost in dollars per unit on the plan's model tier, or `None` if the tier is unknown.
    fn unit_cost(&self, models: &[(u8, f64)]) -> Option<f64> {
        models.iter().find(|(tier, _)| *tier == self.tier).map(|(_, unit_cost)| *unit_cost)
    }
}

/// The setting that a form changes. It determines which margins the form shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarginSetting {
    /// List prices. The form also shows margins at the list price.
    Price,
    /// Model tiers of the plans.
    Tier,
    /// Quotas. The form also shows margins at full quota.
    Quota,
}

impl MarginSetting {
    /// Returns the setting that a tool changes, or `None` if the tool does not affect margins.
    pub fn from_tool(tool: ToolId) -> Option<MarginSetting> {
        match tool {
            ToolId::SetPrices => Some(MarginSetting::Price),
            ToolId::SetModelTiers => Some(MarginSetting::Tier),
            ToolId::SetUsageQuotas => Some(MarginSetting::Quota),
            _ => None,
        }
    }

    /// Returns the terms of the plans that a tool call with these arguments would set.
    pub fn apply(self, mut terms: ByPlan<DraftPlanTerms>, arguments: &Value) -> ByPlan<DraftPlanTerms> {
        for plan in Plan::ALL {
            let Some(value) = arguments.get(plan.id()).and_then(Value::as_f64) else { continue };
            let plan_terms = &mut terms[plan];
            match self {
                MarginSetting::Price => plan_terms.price = value,
                MarginSetting::Tier => plan_terms.tier = value as u8,
                MarginSetting::Quota => plan_terms.quota = value,
            }
        }
        terms
    }
}

/// Returns a table of the margins of every plan on every model tier: a header, and lines of text.
pub fn margin_lines(
    sales: &PlanSales,
    terms: &ByPlan<DraftPlanTerms>,
    margin_setting: MarginSetting,
    models: &[(u8, f64)],
    day: u32,
) -> Vec<String> {
    if !sales.is_measured() {
        return vec![NO_USAGE_MESSAGE.to_owned()];
    }
    let mut lines = vec![format!("gross margin by model tier at day-{day} usage; [ ] current")];
    let tiers: String = models.iter().map(|(tier, _)| format!("{:>8}", format!("T{tier} "))).collect();
    lines.push(format!("{:<16}{tiers}", "$/seat·month").trim_end().to_owned());
    for plan in Plan::ALL {
        let (plan_usage, set) = (sales.usage_of_plan(plan), terms[plan]);
        let row = |label: String, margin: &dyn Fn(f64) -> Option<f64>| {
            let cell = |(tier, unit_cost): &(u8, f64)| {
                format!("{:>8}", format_cell(margin(*unit_cost), *tier == set.tier))
            };
            let cells: String = models.iter().map(cell).collect();
            format!("{label:<16}{cells}").trim_end().to_owned()
        };
        let Some(paid) = plan_usage.measured_revenue_per_seat() else {
            lines.push(format!("{plan} no usage on day {day}"));
            continue;
        };
        lines.push(row(format!("{plan} paid {}", dollars_and_cents(paid)), &|unit_cost| {
            plan_usage.margin(unit_cost)
        }));
        match margin_setting {
            MarginSetting::Price if differs_by_a_cent(set.price, paid) => {
                let label = format!("{plan} list {}", dollars_and_cents(set.price));
                lines.push(row(label, &|unit_cost| margin(set.price, plan_usage.compute_cost(unit_cost)?)));
            }
            MarginSetting::Quota => {
                let label = format!("{plan} at quota {}", compact_number(set.quota));
                lines.push(row(label, &|unit_cost| plan_usage.margin_at_full_quota(set.quota, unit_cost)));
            }
            _ => {}
        }
    }
    lines.extend(Plan::ALL.into_iter().filter_map(|plan| describe_groups(sales, plan, terms[plan], models)));
    lines
}

/// Returns the margin of every plan on its current model tier, for small windows: a header, and one line per plan.
pub fn margin_summary(
    sales: &PlanSales,
    terms: &ByPlan<DraftPlanTerms>,
    margin_setting: MarginSetting,
    models: &[(u8, f64)],
    day: u32,
) -> Vec<String> {
    if !sales.is_measured() {
        return vec![NO_USAGE_MESSAGE.to_owned()];
    }
    let line = |plan: Plan| {
        let (plan_usage, set) = (sales.usage_of_plan(plan), terms[plan]);
        let Some(paid) = plan_usage.measured_revenue_per_seat() else {
            return format!("{plan} no usage on day {day}");
        };
        let unit_cost = set.unit_cost(models);
        let margin_text = |margin: &dyn Fn(f64) -> Option<f64>| format_margin(unit_cost.and_then(margin));
        let also = match margin_setting {
            MarginSetting::Price if differs_by_a_cent(set.price, paid) => {
                let margin = margin_text(&|unit_cost| margin(set.price, plan_usage.compute_cost(unit_cost)?));
                format!(", list {} {margin}", dollars_and_cents(set.price))
            }
            MarginSetting::Quota => {
                let margin = margin_text(&|unit_cost| plan_usage.margin_at_full_quota(set.quota, unit_cost));
                format!(", at quota {} {margin}", compact_number(set.quota))
            }
            _ => String::new(),
        };
        format!(
            "{plan} T{}: paid {} {}{also}",
            set.tier,
            dollars_and_cents(paid),
            margin_text(&|unit_cost| plan_usage.margin(unit_cost))
        )
    };
    let head = format!("gross margin at day-{day} usage");
    std::iter::once(head).chain(Plan::ALL.into_iter().map(line)).collect()
}

/// Returns whether the list price and the paid price differ by at least half a cent.
fn differs_by_a_cent(list: f64, paid: f64) -> bool {
    list > 0.0 && (list - paid).abs() >= 0.005
}

/// Lists the margins of a plan by group, on the plan's model tier. Returns `None` if only one group subscribes to the
/// plan.
fn describe_groups(
    sales: &PlanSales,
    plan: Plan,
    set: DraftPlanTerms,
    models: &[(u8, f64)],
) -> Option<String> {
    let unit_cost = set.unit_cost(models)?;
    let describe_group = |(group, plan_usage): &(Group, PlanUsage)| {
        let margin = plan_usage.margin(unit_cost).map_or("–".to_owned(), |margin| percent(margin, 0));
        format!("{group} {margin} of {}", plan_usage.revenue_per_seat().map_or("–".to_owned(), format_money))
    };
    let groups = sales.by_group(plan);
    (groups.len() > 1).then(|| {
        let texts: Vec<String> = groups.iter().map(describe_group).collect();
        format!("{plan} by group on T{}: {}", set.tier, texts.join(", "))
    })
}

/// Formats a margin. Shows `loss` if the loss exceeds about ten times the price.
fn format_margin(margin: Option<f64>) -> String {
    margin.map_or("–".to_owned(), |margin| match margin < -9.99 {
        true => "loss".to_owned(),
        false => percent(margin, 0),
    })
}

fn format_cell(margin: Option<f64>, is_set: bool) -> String {
    let text = format_margin(margin);
    if is_set { format!("[{text}]") } else { format!("{text} ") }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::test_kit::play_weeks;
    use novamind_session::CoreSettings;

    fn terms(core: &CoreSettings) -> ByPlan<DraftPlanTerms> {
        ByPlan::from_fn(|plan| DraftPlanTerms {
            price: core.prices[plan],
            tier: core.tiers[plan],
            quota: core.quotas[plan].units(),
        })
    }

    #[test]
    fn margins_match_the_tables_on_every_model() {
        let mut session = play_weeks(6);
        let sales = PlanSales::load(&session).expect("a database");
        let sql =
            "SELECT (SELECT sum(o.effective_price * o.seat_count) / sum(o.seat_count) FROM daily_usage u
                    JOIN subscriptions o ON o.customer_id = u.customer_id AND o.status = 'subscribed'
                    WHERE u.day = 42 AND o.plan = 'B'),
                   (SELECT sum(u.usage_units) * 30.0 / sum(o.seat_count) FROM daily_usage u
                    JOIN subscriptions o ON o.customer_id = u.customer_id AND o.status = 'subscribed'
                    WHERE u.day = 42 AND o.plan = 'B')";
        let row = session.query(sql).expect("figures").rows.remove(0);
        let (paid, units) = (number_at(&row, 0), number_at(&row, 1));
        let plan_usage = sales.usage_of_plan(Plan::B);
        for unit_cost in [0.0003, 0.002, 0.03] {
            let expected = 1.0 - units * unit_cost / paid;
            assert!((plan_usage.margin(unit_cost).expect("a margin") - expected).abs() < 1e-9);
        }
        let models = session.company().tool_limits().unit_costs();
        let now = terms(&session.settings().core);
        let draft = MarginSetting::Tier.apply(now, &json!({"B": 3}));
        let lines = margin_lines(&sales, &draft, MarginSetting::Tier, &models, 42);
        assert!(lines[0].contains("at day-42 usage"), "{lines:?}");
        let line = lines.iter().find(|line| line.starts_with("B paid ")).expect("plan B");
        let on_3 = format!("[{}]", percent(plan_usage.margin(models[2].1).expect("a margin"), 0));
        assert!(line.contains(&dollars_and_cents(paid)) && line.contains(&on_3), "{line} without {on_3}");
        let dear = MarginSetting::Price.apply(now, &json!({"B": 250}));
        let lines = margin_lines(&sales, &dear, MarginSetting::Price, &models, 42);
        let line = lines.iter().find(|line| line.starts_with("B list $250.00")).expect("the list price");
        let on_2 = format!("[{}]", percent(1.0 - units * models[1].1 / 250.0, 0));
        assert!(line.contains(&on_2), "{line} without {on_2}");
        let full_quota = MarginSetting::Quota.apply(now, &json!({"B": 300}));
        let lines = margin_lines(&sales, &full_quota, MarginSetting::Quota, &models, 42);
        let line = lines.iter().find(|line| line.starts_with("B at quota 300")).expect("the quota");
        let full = 1.0
            - plan_usage.measured_subscriptions * 300.0 / plan_usage.measured_seats * 30.0 * models[1].1
                / paid;
        assert!(line.contains(&format!("[{}]", percent(full, 0))), "{line} without {full}");
        // The summary for small windows shows the same margins.
        for (margin_setting, draft) in
            [(MarginSetting::Price, &dear), (MarginSetting::Quota, &full_quota), (MarginSetting::Tier, &now)]
        {
            let lines = margin_lines(&sales, draft, margin_setting, &models, 42);
            let set = |line: &str| Some(line.split_once('[')?.1.split_once(']')?.0.to_owned());
            let is_line_of_b = |line: &&String| line.starts_with("B ") && !line.starts_with("B by");
            let expected: Vec<String> =
                lines.iter().filter(is_line_of_b).filter_map(|line| set(line)).collect();
            let summary = margin_summary(&sales, draft, margin_setting, &models, 42);
            let line = summary.iter().find(|line| line.starts_with("B ")).expect("plan B");
            let texts: Vec<&str> = line
                .split(' ')
                .map(|word| word.trim_end_matches(','))
                .filter(|word| word.ends_with('%'))
                .collect();
            assert_eq!(texts, expected, "{line}");
            assert!(summary[0].contains("day-42") && summary.len() == 4, "{summary:?}");
        }
    }

    #[test]
    fn new_subscribers_do_not_change_margins() {
        let before = PlanUsage {
            customers: 55.0,
            seats: 55.0,
            monthly_revenue: 4_400.0,
            measured_subscriptions: 55.0,
            measured_seats: 55.0,
            measured_units: 33_952.0,
            measured_revenue: 4_400.0,
        };
        let joined = PlanUsage { customers: 650.0, seats: 650.0, monthly_revenue: 47_900.0, ..before };
        assert_eq!((joined.margin(0.006), joined.revenue_per_seat()), (before.margin(0.006), Some(80.0)));
    }

    #[test]
    fn margin_lines_report_missing_usage() {
        let session = play_weeks(0);
        let sales = PlanSales::load(&session).expect("a database");
        let lines =
            margin_lines(&sales, &terms(&session.settings().core), MarginSetting::Price, &[(1, 0.0003)], 0);
        assert_eq!(lines, ["no margins: usage has not been measured yet"]);
    }
}
