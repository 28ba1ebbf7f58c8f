//! Weekly report: the cash change and its components, the most unusual changes in figures, decisions before the week,
//! news, and the outcomes of due forecasts.

use std::ops::Range;

use super::decision_periods::{by_amount, describe_change};
use super::figure_change::{FigureChange, last_change};
use super::formatting::{
    category_name, describe_short_week, format_money, format_number, format_percentage_points, format_whole,
};
use novamind_base::formatting::{compact_number, percent};
use novamind_database::Interface;
use novamind_record::figures::{CategoryTotals, WeekFigures};
use novamind_session::{
    Category, Decisions, JournalEntry, ScoredForecast, Session, TIME_LIMIT_RATIONALE, submitted_forecasts,
};

/// A figure that changed over the week.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangedFigure {
    /// Name of the figure, as reports show it.
    pub name: &'static str,
    /// Value of the previous week, as text with its unit.
    pub old: String,
    /// Value of the reported week, as text with its unit.
    pub new: String,
    /// Whether the figure rose.
    pub is_increase: bool,
    /// Whether the change is favorable for the company; `None` if a rise can be either good or bad.
    pub is_favorable: Option<bool>,
    /// Whether the figure is a share from 0 to 1.
    pub is_share: bool,
    /// Comparison with the changes of earlier weeks.
    pub change: FigureChange,
    /// Changes by ledger category that add up to the change of the figure, largest first; empty if the figure does not
    /// come from the ledger.
    pub category_changes: Vec<(&'static str, f64)>,
}

impl ChangedFigure {
    /// Formats the size of the change: for shares in percentage points, otherwise in percent of the previous value.
    /// Returns `None` if the previous value was 0.
    pub fn format_size(&self) -> Option<String> {
        let (old, new) = (self.change.old, self.change.new);
        if self.is_share {
            return Some(format_percentage_points((new - old).abs(), 1));
        }
        let share = (old > 0.0).then(|| (new - old) / old)?;
        let decimals = if share.abs() < 0.0995 { 1 } else { 0 };
        Some(if share.abs() < 10.0 {
            percent(share.abs(), decimals)
        } else {
            format!("×{}", format_whole(new / old))
        })
    }
}

/// The report on a simulated week.
#[derive(Debug, Clone, PartialEq)]
pub struct WeekReport {
    /// Figures of the reported week.
    pub week: WeekFigures,
    /// Describes the lengths of this week and the previous week; `None` if they are equal. The last week of a run can
    /// be short.
    pub short_week_note: Option<String>,
    /// Amounts by ledger category that add up to the cash change: income first, then costs from the largest.
    pub cash_components: Vec<(&'static str, f64)>,
    /// Changed figures, starting with the most unusual change.
    pub changed_figures: Vec<ChangedFigure>,
    /// Descriptions of changed settings, with old and new values and the largest amounts of money first; then
    /// descriptions of purchases, posts and offers.
    pub decisions: Vec<String>,
    /// Forecasts for the last day of the week, shortest horizon first.
    pub due_forecasts: Vec<ScoredForecast>,
    /// Number of customers' posts in the week.
    pub customer_posts: u32,
    /// Number of comments on the company's posts.
    pub comments: u32,
    /// Number of news items in the week.
    pub news_items: u32,
    /// Decision days of the weeks that were filed automatically because a time limit was reached.
    limit_days: Vec<u32>,
}

/// A figure of the report: name, function that reads the value, unit, whether higher is better, and ledger categories.
struct FigureRow(&'static str, fn(&WeekFigures) -> f64, WeekFigureUnit, Option<bool>, &'static [Category]);

/// Unit of a figure, which determines its format and its random variation.
#[derive(Clone, Copy, PartialEq, Eq)]
enum WeekFigureUnit {
    Dollars,
    Count,
    Units,
    Minutes,
    ShareOfLeads,
    Share,
}

impl WeekFigureUnit {
    fn format(self, value: f64) -> String {
        match self {
            WeekFigureUnit::Dollars => format_money(value),
            WeekFigureUnit::Count => format_whole(value),
            WeekFigureUnit::Units => compact_number(value),
            WeekFigureUnit::Minutes => format_number(value),
            WeekFigureUnit::ShareOfLeads | WeekFigureUnit::Share => percent(value, 1),
        }
    }

    fn is_share(self) -> bool {
        matches!(self, WeekFigureUnit::ShareOfLeads | WeekFigureUnit::Share)
    }

    /// Returns the random variation of a weekly value. For dollars, returns the largest amount that is insignificant
    /// for the company.
    fn noise(self, value: f64, week: &WeekFigures) -> f64 {
        match self {
            // Changes below one hundredth of the company's income and costs are insignificant.
            WeekFigureUnit::Dollars => 0.01 * (week.payments + week.costs).max(100.0),
            // Counts of independent events vary by about their square root.
            WeekFigureUnit::Count | WeekFigureUnit::Units | WeekFigureUnit::Minutes => value.max(1.0).sqrt(),
            WeekFigureUnit::ShareOfLeads => 0.5 / f64::from(week.new_individual_leads.max(1)).sqrt(),
            WeekFigureUnit::Share => 0.01,
        }
    }
}

const RUNNING_COST_CATEGORIES: [Category; 5] = [
    Category::Capacity,
    Category::Compute,
    Category::Operations,
    Category::Development,
    Category::Advertising,
];

const FIGURES: [FigureRow; 14] = [
    FigureRow("recurring revenue", |week| week.recurring_revenue, WeekFigureUnit::Dollars, Some(true), &[]),
    FigureRow("payments", |week| week.payments, WeekFigureUnit::Dollars, Some(true), &[]),
    FigureRow(
        "running costs",
        |week| week.costs,
        WeekFigureUnit::Dollars,
        Some(false),
        &RUNNING_COST_CATEGORIES,
    ),
    FigureRow(
        "subscribers",
        |week| f64::from(week.individual_subscribers),
        WeekFigureUnit::Count,
        Some(true),
        &[],
    ),
    FigureRow(
        "enterprise seats",
        |week| f64::from(week.enterprise_seats),
        WeekFigureUnit::Count,
        Some(true),
        &[],
    ),
    FigureRow(
        "individual leads",
        |week| f64::from(week.new_individual_leads),
        WeekFigureUnit::Count,
        Some(true),
        &[],
    ),
    FigureRow(
        "enterprise leads",
        |week| f64::from(week.new_enterprise_leads),
        WeekFigureUnit::Count,
        Some(true),
        &[],
    ),
    FigureRow(
        "new subscribers",
        |week| f64::from(week.new_individual_subscribers),
        WeekFigureUnit::Count,
        Some(true),
        &[],
    ),
    FigureRow("conversion", WeekFigures::conversion, WeekFigureUnit::ShareOfLeads, Some(true), &[]),
    FigureRow("cancellations", |week| f64::from(week.cancellations), WeekFigureUnit::Count, Some(false), &[]),
    FigureRow("usage, units", |week| week.usage as f64, WeekFigureUnit::Units, None, &[]),
    FigureRow("overload, peak", |week| week.overload_peak, WeekFigureUnit::Share, Some(false), &[]),
    FigureRow(
        "outage, minutes",
        |week| f64::from(week.downtime_minutes),
        WeekFigureUnit::Minutes,
        Some(false),
        &[],
    ),
    FigureRow("open issues", |week| f64::from(week.open_issues), WeekFigureUnit::Count, Some(false), &[]),
];

/// What a weekly report is computed from.
pub struct WeekReportInput<'a> {
    /// Figures of every simulated week.
    pub weeks: &'a [WeekFigures],
    /// Decisions before each week.
    pub decisions: &'a [Decisions],
    /// Journal with all actions of the run.
    pub journal: &'a [JournalEntry],
    /// Publication days of customers' posts, of comments on the company's posts, and of news items, in this order.
    pub posts: [&'a [u32]; 3],
}

impl WeekReport {
    /// Returns the report on the last week of a session, or `None` before the first week.
    pub fn from_session(session: &Session) -> Option<WeekReport> {
        let has_authors = session.params().fidelity.interface == Interface::Release1;
        let mut posts: [Vec<u32>; 3] = Default::default();
        for post in session.company().posts() {
            // News items have no customer group. Release 2 does not publish the authors of posts, so customers' posts
            // and news items are counted together.
            let kind = match (post.own_post, &post.written_by) {
                (Some(_), _) => 1,
                (None, None) if has_authors => 2,
                (None, _) => 0,
            };
            posts[kind].push(post.day);
        }
        WeekReport::from_input(&WeekReportInput {
            weeks: session.weeks(),
            decisions: session.company().decisions(),
            journal: session.journal(),
            posts: posts.each_ref().map(Vec::as_slice),
        })
    }

    /// Returns the report on the last week of the input, or `None` before the first week.
    pub fn from_input(sources: &WeekReportInput<'_>) -> Option<WeekReport> {
        let week = *sources.weeks.last()?;
        let first_day = week.day - week.days_run.min(week.day) + 1;
        let count =
            |days: &[u32]| days.iter().filter(|day| (first_day..=week.day).contains(*day)).count() as u32;
        let [customer_posts, comments, news_items] = sources.posts.map(count);
        Some(WeekReport {
            week,
            short_week_note: describe_unequal_weeks(sources.weeks),
            cash_components: cash_components(&week.booked),
            changed_figures: changed_figures(sources, &week),
            decisions: describe_decisions(sources, first_day - 1..week.day),
            due_forecasts: due_forecasts(sources, week.day),
            customer_posts,
            comments,
            news_items,
            limit_days: sources.journal.iter().filter_map(day_filed_at_limit).collect(),
        })
    }

    /// Returns whether the week was filed automatically because a time limit was reached.
    pub fn was_filed_at_limit(&self) -> bool {
        self.limit_days.contains(&(self.week.day - self.week.days_run.min(self.week.day)))
    }

    /// Returns whether a forecast was filed automatically because a time limit was reached.
    pub fn was_forecast_filed_at_limit(&self, forecast: &ScoredForecast) -> bool {
        self.limit_days.contains(&forecast.day)
    }
}

/// Describes the lengths of the last two weeks; `None` if they are equal.
fn describe_unequal_weeks(weeks: &[WeekFigures]) -> Option<String> {
    let [.., before, week_figures] = weeks else { return None };
    describe_short_week(week_figures.days_run, before.days_run)
}

/// Returns the decision day of a week that was filed automatically at a time limit, or `None` if the journal entry is
/// not about such a week.
fn day_filed_at_limit(entry: &JournalEntry) -> Option<u32> {
    match entry {
        JournalEntry::Advance { day, rationale, filled_naively: [true, true, true, true], .. }
            if rationale == TIME_LIMIT_RATIONALE =>
        {
            Some(*day)
        }
        _ => None,
    }
}

/// Returns the amounts by ledger category: income first, then costs from the largest.
fn cash_components(booked: &CategoryTotals) -> Vec<(&'static str, f64)> {
    let mut parts: Vec<(&'static str, f64)> =
        booked.nonzero_totals().map(|(category, dollars)| (category_name(category), dollars)).collect();
    parts.sort_by(|left, right| {
        (left.1 < 0.0).cmp(&(right.1 < 0.0)).then(right.1.abs().total_cmp(&left.1.abs()))
    });
    parts
}

/// Describes the decisions in a range of days: those before a week and, if its days were run one by one, those between
/// the days.
fn describe_decisions(sources: &WeekReportInput<'_>, days: Range<u32>) -> Vec<String> {
    let found = sources.decisions.iter().filter(|decided| days.contains(&decided.day));
    found
        .flat_map(|decided| {
            let changes = by_amount(&decided.changes).into_iter().map(describe_change);
            changes.chain(decided.purchases.iter().cloned())
        })
        .collect()
}

fn changed_figures(sources: &WeekReportInput<'_>, week: &WeekFigures) -> Vec<ChangedFigure> {
    let nothing = WeekFigures::default();
    let before = sources.weeks.len().checked_sub(2).map_or(&nothing, |at| &sources.weeks[at]);
    let moved = |FigureRow(name, read, unit, more_is_better, categories): &FigureRow| {
        // Before the first week all figures are 0.
        let series: Vec<f64> = std::iter::once(&nothing).chain(sources.weeks).map(read).collect();
        let noise = unit.noise(read(before), before).max(unit.noise(read(week), week));
        let movement = last_change(&series, noise)?;
        let up = movement.new > movement.old;
        let (old, new) = (unit.format(movement.old), unit.format(movement.new));
        // A figure counts as unchanged if its displayed value is the same, or if it changed by less than one
        // thousandth.
        let moved = old != new && movement.relative_size() >= 0.001;
        moved.then(|| ChangedFigure {
            name,
            old,
            new,
            is_increase: up,
            is_favorable: more_is_better.map(|better| better == up),
            is_share: unit.is_share(),
            change: movement,
            category_changes: category_changes(categories, &before.booked, &week.booked),
        })
    };
    let mut moves: Vec<ChangedFigure> = FIGURES.iter().filter_map(moved).collect();
    moves.sort_by(|left, right| right.change.unusualness.total_cmp(&left.change.unusualness));
    moves
}

fn category_changes(
    categories: &[Category],
    before: &CategoryTotals,
    now: &CategoryTotals,
) -> Vec<(&'static str, f64)> {
    let mut changes: Vec<(&'static str, f64)> = categories
        .iter()
        .map(|category| {
            (category_name(*category), before.category_total(*category) - now.category_total(*category))
        })
        .filter(|(_, dollars)| *dollars != 0.0)
        .collect();
    changes.sort_by(|left, right| right.1.abs().total_cmp(&left.1.abs()));
    changes
}

fn due_forecasts(sources: &WeekReportInput<'_>, day: u32) -> Vec<ScoredForecast> {
    let mut due = submitted_forecasts(sources.journal, sources.weeks);
    due.retain(|forecast| forecast.due_day() == day && forecast.outcome.is_some());
    due.sort_by_key(|due| due.forecast.horizon_days);
    due
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit;

    #[test]
    fn calls_between_single_days_are_listed() {
        use novamind_record::mode::Mode;
        use novamind_record::trajectory::record::Via;
        use novamind_session::{NewRun, Storage};
        let new = NewRun { days: Some(10), mode: Mode::Debug, storage: Storage::Memory, ..NewRun::default() };
        let mut session =
            Session::create(new, &novamind_record::folder::configuration::Configuration::bundled())
                .expect("a run");
        for days in [7, 1] {
            session.step(days, &mut |_| {}).expect("days");
        }
        let prices = serde_json::json!({ "A": 12 });
        session.call("set_prices", &prices, Via::Script).expect("a price");
        session.step(2, &mut |_| {}).expect("days");
        assert!(session.ended().is_some());
        let report = WeekReport::from_session(&session).expect("a week");
        assert_eq!((report.week.day, report.week.days_run), (10, 3));
        assert!(report.decisions.iter().any(|text| text.contains("12")), "{:?}", report.decisions);
    }

    #[test]
    fn cash_components_add_up_to_cash_change_and_match_the_ledger() {
        let mut session = test_kit::play_weeks(5);
        let report = WeekReport::from_session(&session).expect("five weeks have passed");
        let sum: f64 = report.cash_components.iter().map(|(_, dollars)| dollars).sum();
        assert!((sum - report.week.cash_change).abs() < 0.01);
        for (at, week) in session.weeks().to_vec().iter().enumerate() {
            let of_week = novamind_session::ledger_weeks_condition_sql(at as u32 + 1, at as u32 + 1);
            let sql = format!("SELECT category, sum(amount) FROM ledger WHERE {of_week} GROUP BY 1");
            for row in session.query(&sql).expect("rows").rows {
                let (id, dollars) =
                    (novamind_database::text_at(&row, 0), novamind_database::number_at(&row, 1));
                let category =
                    Category::ALL.into_iter().find(|category| category.id() == id).expect("a category");
                assert!(
                    (week.booked.category_total(category) - dollars).abs() < 0.01,
                    "week {} {id}",
                    at + 1
                );
            }
        }
        let costs =
            report.changed_figures.iter().find(|moved| moved.name == "running costs").expect("they changed");
        let split: f64 = costs.category_changes.iter().map(|(_, dollars)| dollars).sum();
        assert!((split - (costs.change.new - costs.change.old)).abs() < 0.01);
    }

    #[test]
    fn week_report_lists_forecasts_and_moved_figures() {
        let session = test_kit::play_weeks(5);
        let report = WeekReport::from_session(&session).expect("five weeks have passed");
        let horizons: Vec<u32> = report.due_forecasts.iter().map(|due| due.forecast.horizon_days).collect();
        assert_eq!(horizons, [7, 28]);
        assert!(report.due_forecasts.iter().all(|due| due.outcome == Some(report.week.cash)
            && due.relative_error().is_some_and(|error| error.abs() < 1.0)));
        assert!(report.changed_figures.len() > 4);
        let order: Vec<f64> = report.changed_figures.iter().map(|moved| moved.change.unusualness).collect();
        assert!(order.is_sorted_by(|left, right| left >= right), "{order:?}");
        assert!(report.changed_figures.iter().all(|moved| moved.old != moved.new));
        assert!(report.decisions.is_empty(), "no setting changed before week 5: {:?}", report.decisions);
    }

    #[test]
    fn first_week_has_no_comparison_and_day_0_no_report() {
        assert_eq!(WeekReport::from_session(&test_kit::play_weeks(0)), None);
        let report = WeekReport::from_session(&test_kit::play_weeks(1)).expect("a week");
        let costs =
            report.changed_figures.iter().find(|moved| moved.name == "running costs").expect("they rose");
        assert_eq!((costs.old.as_str(), costs.is_increase, costs.is_favorable), ("$0", true, Some(false)));
        assert_eq!(costs.format_size(), None);
        assert!(report.decisions.contains(&"price A: 0 → 12 $/month".to_owned()), "{:?}", report.decisions);
    }

    fn two_weeks(before: WeekFigures, week: WeekFigures, more: usize) -> WeekReport {
        let mut weeks: Vec<WeekFigures> = (0..more).map(|_| before).collect();
        weeks.extend([before, week]);
        for (at, week_figures) in weeks.iter_mut().enumerate() {
            (week_figures.day, week_figures.days_run) = (7 * (at as u32 + 1), 7);
        }
        let sources = WeekReportInput { weeks: &weeks, decisions: &[], journal: &[], posts: [&[], &[], &[]] };
        WeekReport::from_input(&sources).expect("weeks")
    }

    #[test]
    fn moved_figures_rank_large_amounts_above_single_counts() {
        let before =
            WeekFigures { cancellations: 1, payments: 4_000.0, costs: 20_000.0, ..WeekFigures::default() };
        let week = WeekFigures { cancellations: 0, payments: 9_800.0, ..before };
        for more in [0, 5] {
            let report = two_weeks(before, week, more);
            let names: Vec<&str> = report.changed_figures.iter().map(|moved| moved.name).collect();
            assert_eq!(names, ["payments", "cancellations"], "after {more} weeks");
            assert_eq!(report.changed_figures[1].change.describe_rarity(), "", "after {more} weeks");
        }
        // Many cancellations rank above a minor change in payments.
        let wave = WeekFigures { cancellations: 90, payments: 4_100.0, ..before };
        assert_eq!(two_weeks(before, wave, 5).changed_figures[0].name, "cancellations");
    }

    #[test]
    fn share_changes_are_formatted_in_percentage_points() {
        let before = WeekFigures {
            new_individual_leads: 1_000,
            new_individual_subscribers: 517,
            ..WeekFigures::default()
        };
        let week = WeekFigures { new_individual_subscribers: 424, ..before };
        let report = two_weeks(before, week, 0);
        let size = |name: &str| {
            report
                .changed_figures
                .iter()
                .find(|moved| moved.name == name)
                .and_then(ChangedFigure::format_size)
        };
        assert_eq!(size("conversion").as_deref(), Some("9.3 pt"));
        assert_eq!(size("new subscribers").as_deref(), Some("18%"));
    }
}
