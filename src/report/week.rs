//! Weekly report: change of cash and its parts, the most unusual changes of figures, decisions before the week, news,
//! and the outcome of due forecasts.

use std::ops::Range;

use super::chapters::change_in_words;
use super::movement::{Movement, movement};
use super::words::{category_name, money, number, points, short_week_in_words, whole};
use novamind_base::notation::{compact, percent};
use novamind_record::figures::{Booked, WeekFigures};
use novamind_session::{
    Category, Decisions, JournalEntry, ScoredForecast, Session, TIME_LIMIT, filed_forecasts,
};

/// A figure that changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Move {
    /// Name.
    pub name: &'static str,
    /// Value of the week before.
    pub old: String,
    /// Value of the week.
    pub new: String,
    /// Whether the figure rose.
    pub up: bool,
    /// Whether the change is good for the company; `None` if it depends.
    pub good: Option<bool>,
    /// Whether the figure is a share from 0 to 1.
    pub is_share: bool,
    /// Comparison with the changes of earlier weeks.
    pub movement: Movement,
    /// Ledger categories whose changes add up to this one, largest first. Empty if the figure is not from the ledger.
    pub split: Vec<(&'static str, f64)>,
}

impl Move {
    /// Formats the size of the change: percentage points for shares, otherwise percent of the value before. `None` if
    /// that was 0.
    pub fn size_in_words(&self) -> Option<String> {
        let (old, new) = (self.movement.old, self.movement.new);
        if self.is_share {
            return Some(points((new - old).abs(), 1));
        }
        let share = (old > 0.0).then(|| (new - old) / old)?;
        let decimals = if share.abs() < 0.0995 { 1 } else { 0 };
        Some(if share.abs() < 10.0 {
            percent(share.abs(), decimals)
        } else {
            format!("×{}", whole(new / old))
        })
    }
}

/// The report on a week.
#[derive(Debug, Clone, PartialEq)]
pub struct WeekReport {
    /// Figures of the week.
    pub week: WeekFigures,
    /// Lengths of this week and the one before, if they differ: the last week of a run can be short.
    pub short: Option<String>,
    /// Parts of the change of cash by ledger category: income, then costs from the largest.
    pub parts: Vec<(&'static str, f64)>,
    /// Changed figures, the most unusual first.
    pub moves: Vec<Move>,
    /// Changed settings as old → new, then purchases, posts and offers.
    pub decided: Vec<String>,
    /// Forecasts for the last day of the week, shortest horizon first.
    pub due: Vec<ScoredForecast>,
    /// Number of customers' posts.
    pub customer_posts: u32,
    /// Number of comments on the company's posts.
    pub comments: u32,
    /// Number of news items.
    pub news_items: u32,
    /// Days on which a time limit filed a week.
    limit_days: Vec<u32>,
}

/// A figure: name, reader, unit, whether higher is better, and its ledger categories.
struct Row(&'static str, fn(&WeekFigures) -> f64, Unit, Option<bool>, &'static [Category]);

/// Unit of a figure, which determines its format and random variation.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Unit {
    Dollars,
    Count,
    Units,
    Minutes,
    ShareOfLeads,
    Share,
}

impl Unit {
    fn write(self, value: f64) -> String {
        match self {
            Unit::Dollars => money(value),
            Unit::Count => whole(value),
            Unit::Units => compact(value),
            Unit::Minutes => number(value),
            Unit::ShareOfLeads | Unit::Share => percent(value, 1),
        }
    }

    fn is_share(self) -> bool {
        matches!(self, Unit::ShareOfLeads | Unit::Share)
    }

    /// Returns the random variation of a weekly value, or the amount too small to matter to the company.
    fn noise(self, value: f64, week: &WeekFigures) -> f64 {
        match self {
            // A hundredth of the company's turnover.
            Unit::Dollars => 0.01 * (week.payments + week.costs).max(100.0),
            // Counts of independent events.
            Unit::Count | Unit::Units | Unit::Minutes => value.max(1.0).sqrt(),
            Unit::ShareOfLeads => 0.5 / f64::from(week.new_individual_leads.max(1)).sqrt(),
            Unit::Share => 0.01,
        }
    }
}

const RUNNING: [Category; 5] = [
    Category::Capacity,
    Category::Compute,
    Category::Operations,
    Category::Development,
    Category::Advertising,
];

const FIGURES: [Row; 14] = [
    Row("recurring revenue", |week| week.recurring_revenue, Unit::Dollars, Some(true), &[]),
    Row("payments", |week| week.payments, Unit::Dollars, Some(true), &[]),
    Row("running costs", |week| week.costs, Unit::Dollars, Some(false), &RUNNING),
    Row("subscribers", |week| f64::from(week.individual_subscribers), Unit::Count, Some(true), &[]),
    Row("enterprise seats", |week| f64::from(week.enterprise_seats), Unit::Count, Some(true), &[]),
    Row("individual leads", |week| f64::from(week.new_individual_leads), Unit::Count, Some(true), &[]),
    Row("enterprise leads", |week| f64::from(week.new_enterprise_leads), Unit::Count, Some(true), &[]),
    Row("new subscribers", |week| f64::from(week.new_individual_subscribers), Unit::Count, Some(true), &[]),
    Row("conversion", WeekFigures::conversion, Unit::ShareOfLeads, Some(true), &[]),
    Row("cancellations", |week| f64::from(week.cancellations), Unit::Count, Some(false), &[]),
    Row("usage, units", |week| week.usage as f64, Unit::Units, None, &[]),
    Row("overload, peak", |week| week.overload_peak, Unit::Share, Some(false), &[]),
    Row("outage, minutes", |week| f64::from(week.downtime_minutes), Unit::Minutes, Some(false), &[]),
    Row("open issues", |week| f64::from(week.open_issues), Unit::Count, Some(false), &[]),
];

/// Data for a weekly report.
pub struct Sources<'a> {
    /// Figures of every week.
    pub weeks: &'a [WeekFigures],
    /// Decisions before each week.
    pub decisions: &'a [Decisions],
    /// All actions.
    pub journal: &'a [JournalEntry],
    /// Cash at the end of each day, day 0 first.
    pub cash_by_day: &'a [f64],
    /// Days of posts: by customers, comments on the company's posts, and news items.
    pub posts: [&'a [u32]; 3],
}

impl WeekReport {
    /// Returns the report on the last week; `None` before the first.
    pub fn of_session(session: &Session) -> Option<WeekReport> {
        let mut posts: [Vec<u32>; 3] = Default::default();
        for post in session.company().posts() {
            // News items have no customer group.
            let kind = match (post.own_post, &post.written_by) {
                (Some(_), _) => 1,
                (None, Some(_)) => 0,
                (None, None) => 2,
            };
            posts[kind].push(post.day);
        }
        WeekReport::of(&Sources {
            weeks: session.weeks(),
            decisions: session.company().decisions(),
            journal: session.journal(),
            cash_by_day: session.cash_by_day(),
            posts: posts.each_ref().map(Vec::as_slice),
        })
    }

    /// Returns the report on the last of these weeks; `None` before the first.
    pub fn of(sources: &Sources<'_>) -> Option<WeekReport> {
        let week = *sources.weeks.last()?;
        let first_day = week.day - week.days_run.min(week.day) + 1;
        let count =
            |days: &[u32]| days.iter().filter(|day| (first_day..=week.day).contains(*day)).count() as u32;
        let [customer_posts, comments, news_items] = sources.posts.map(count);
        Some(WeekReport {
            week,
            short: short(sources.weeks),
            parts: parts(&week.booked),
            moves: moves(sources, &week),
            decided: decided(sources, first_day - 1..week.day),
            due: due(sources, week.day),
            customer_posts,
            comments,
            news_items,
            limit_days: sources.journal.iter().filter_map(filed_at_limit).collect(),
        })
    }

    /// Returns whether a time limit filed the week.
    pub fn was_filed_at_limit(&self) -> bool {
        self.limit_days.contains(&(self.week.day - self.week.days_run.min(self.week.day)))
    }

    /// Returns whether a time limit filed a forecast.
    pub fn is_of_limit(&self, forecast: &ScoredForecast) -> bool {
        self.limit_days.contains(&forecast.day)
    }
}

/// Describes the lengths of the last two weeks if they differ.
fn short(weeks: &[WeekFigures]) -> Option<String> {
    let [.., before, own] = weeks else { return None };
    short_week_in_words(own.days_run, before.days_run)
}

/// Returns the day on which a time limit filed a week.
fn filed_at_limit(entry: &JournalEntry) -> Option<u32> {
    match entry {
        JournalEntry::Advance { day, rationale, filled_naively: [true, true, true, true], .. }
            if rationale == TIME_LIMIT =>
        {
            Some(*day)
        }
        _ => None,
    }
}

/// Returns ledger entries: income, then costs from the largest.
fn parts(booked: &Booked) -> Vec<(&'static str, f64)> {
    let mut parts: Vec<(&'static str, f64)> =
        booked.entries().map(|(category, dollars)| (category_name(category), dollars)).collect();
    parts.sort_by(|left, right| {
        (left.1 < 0.0).cmp(&(right.1 < 0.0)).then(right.1.abs().total_cmp(&left.1.abs()))
    });
    parts
}

/// Describes the decisions of some days: before a week, and between its single days if it was run day by day.
fn decided(sources: &Sources<'_>, days: Range<u32>) -> Vec<String> {
    let found = sources.decisions.iter().filter(|decided| days.contains(&decided.day));
    found
        .flat_map(|decided| {
            decided.changes.iter().map(change_in_words).chain(decided.purchases.iter().cloned())
        })
        .collect()
}

fn moves(sources: &Sources<'_>, week: &WeekFigures) -> Vec<Move> {
    let nothing = WeekFigures::default();
    let before = sources.weeks.len().checked_sub(2).map_or(&nothing, |at| &sources.weeks[at]);
    let moved = |Row(name, read, unit, more_is_better, categories): &Row| {
        // Before the first week all figures are 0.
        let series: Vec<f64> = std::iter::once(&nothing).chain(sources.weeks).map(read).collect();
        let noise = unit.noise(read(before), before).max(unit.noise(read(week), week));
        let movement = movement(&series, noise)?;
        let up = movement.new > movement.old;
        let (old, new) = (unit.write(movement.old), unit.write(movement.new));
        // Values that are displayed alike, or changed by less than a thousandth, count as unchanged.
        let moved = old != new && movement.size() >= 0.001;
        moved.then(|| Move {
            name,
            old,
            new,
            up,
            good: more_is_better.map(|better| better == up),
            is_share: unit.is_share(),
            movement,
            split: split(categories, &before.booked, &week.booked),
        })
    };
    let mut moves: Vec<Move> = FIGURES.iter().filter_map(moved).collect();
    moves.sort_by(|left, right| right.movement.unusual.total_cmp(&left.movement.unusual));
    moves
}

fn split(categories: &[Category], before: &Booked, now: &Booked) -> Vec<(&'static str, f64)> {
    let mut changes: Vec<(&'static str, f64)> = categories
        .iter()
        .map(|category| (category_name(*category), before.of(*category) - now.of(*category)))
        .filter(|(_, dollars)| *dollars != 0.0)
        .collect();
    changes.sort_by(|left, right| right.1.abs().total_cmp(&left.1.abs()));
    changes
}

fn due(sources: &Sources<'_>, day: u32) -> Vec<ScoredForecast> {
    let mut due = filed_forecasts(sources.journal, sources.cash_by_day);
    due.retain(|forecast| forecast.due() == day && forecast.outcome.is_some());
    due.sort_by_key(|due| due.forecast.horizon_days);
    due
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit;

    #[test]
    fn calls_between_the_single_days_of_the_last_short_week_are_told() {
        use novamind_record::mode::Mode;
        use novamind_record::trajectory::record::Via;
        use novamind_session::{NewRun, Storage};
        let new = NewRun { days: Some(10), mode: Mode::Debug, storage: Storage::Memory, ..NewRun::default() };
        let mut session =
            Session::create(new, &novamind_record::folder::configuration::Configuration::shipped())
                .expect("a run");
        for days in [7, 1] {
            session.step(days, &mut |_| {}).expect("days");
        }
        let prices = serde_json::json!({ "A": 12 });
        session.call("set_prices", &prices, Via::Script).expect("a price");
        session.step(2, &mut |_| {}).expect("days");
        assert!(session.ended().is_some());
        let report = WeekReport::of_session(&session).expect("a week");
        assert_eq!((report.week.day, report.week.days_run), (10, 3));
        assert!(report.decided.iter().any(|text| text.contains("12")), "{:?}", report.decided);
    }

    #[test]
    fn the_parts_add_up_to_the_change_of_cash_and_agree_with_the_ledger() {
        let mut session = test_kit::played(5);
        let report = WeekReport::of_session(&session).expect("five weeks have passed");
        let sum: f64 = report.parts.iter().map(|(_, dollars)| dollars).sum();
        assert!((sum - report.week.cash_change).abs() < 0.01);
        for (at, week) in session.weeks().to_vec().iter().enumerate() {
            let of_week = novamind_session::entries_of_weeks(at as u32 + 1, at as u32 + 1);
            let sql = format!("SELECT category, sum(amount) FROM ledger WHERE {of_week} GROUP BY 1");
            for row in session.query(&sql).expect("rows").rows {
                let (id, dollars) =
                    (novamind_database::text_at(&row, 0), novamind_database::number_at(&row, 1));
                let category = Category::ALL.into_iter().find(|own| own.id() == id).expect("a category");
                assert!((week.booked.of(category) - dollars).abs() < 0.01, "week {} {id}", at + 1);
            }
        }
        let costs = report.moves.iter().find(|moved| moved.name == "running costs").expect("they changed");
        let split: f64 = costs.split.iter().map(|(_, dollars)| dollars).sum();
        assert!((split - (costs.movement.new - costs.movement.old)).abs() < 0.01);
    }

    #[test]
    fn a_week_reports_its_forecasts_and_the_figures_that_moved() {
        let session = test_kit::played(5);
        let report = WeekReport::of_session(&session).expect("five weeks have passed");
        let horizons: Vec<u32> = report.due.iter().map(|due| due.forecast.horizon_days).collect();
        assert_eq!(horizons, [7, 28]);
        assert!(
            report.due.iter().all(|due| due.outcome == Some(report.week.cash)
                && due.error().is_some_and(|error| error.abs() < 1.0))
        );
        assert!(report.moves.len() > 4);
        let order: Vec<f64> = report.moves.iter().map(|moved| moved.movement.unusual).collect();
        assert!(order.is_sorted_by(|left, right| left >= right), "{order:?}");
        assert!(report.moves.iter().all(|moved| moved.old != moved.new));
        assert!(report.decided.is_empty(), "no setting changed before week 5: {:?}", report.decided);
    }

    #[test]
    fn the_first_week_is_reported_against_nothing_and_no_week_not_at_all() {
        assert_eq!(WeekReport::of_session(&test_kit::played(0)), None);
        let report = WeekReport::of_session(&test_kit::played(1)).expect("a week");
        let costs = report.moves.iter().find(|moved| moved.name == "running costs").expect("they rose");
        assert_eq!((costs.old.as_str(), costs.up, costs.good), ("$0", true, Some(false)));
        assert_eq!(costs.size_in_words(), None);
        assert!(report.decided.contains(&"price A: 0 → 12 $/month".to_owned()), "{:?}", report.decided);
    }

    fn two_weeks(before: WeekFigures, week: WeekFigures, more: usize) -> WeekReport {
        let mut weeks: Vec<WeekFigures> = (0..more).map(|_| before).collect();
        weeks.extend([before, week]);
        for (at, own) in weeks.iter_mut().enumerate() {
            (own.day, own.days_run) = (7 * (at as u32 + 1), 7);
        }
        let sources = Sources {
            weeks: &weeks,
            decisions: &[],
            journal: &[],
            cash_by_day: &[0.0],
            posts: [&[], &[], &[]],
        };
        WeekReport::of(&sources).expect("weeks")
    }

    #[test]
    fn large_money_ranks_above_one_cancellation_less() {
        let before =
            WeekFigures { cancellations: 1, payments: 4_000.0, costs: 20_000.0, ..WeekFigures::default() };
        let week = WeekFigures { cancellations: 0, payments: 9_800.0, ..before };
        for more in [0, 5] {
            let report = two_weeks(before, week, more);
            let names: Vec<&str> = report.moves.iter().map(|moved| moved.name).collect();
            assert_eq!(names, ["payments", "cancellations"], "after {more} weeks");
            assert_eq!(report.moves[1].movement.standing(), "", "after {more} weeks");
        }
        // Many cancellations rank above a minor change of money.
        let wave = WeekFigures { cancellations: 90, payments: 4_100.0, ..before };
        assert_eq!(two_weeks(before, wave, 5).moves[0].name, "cancellations");
    }

    #[test]
    fn shares_change_by_percentage_points() {
        let before = WeekFigures {
            new_individual_leads: 1_000,
            new_individual_subscribers: 517,
            ..WeekFigures::default()
        };
        let week = WeekFigures { new_individual_subscribers: 424, ..before };
        let report = two_weeks(before, week, 0);
        let size =
            |name: &str| report.moves.iter().find(|moved| moved.name == name).and_then(Move::size_in_words);
        assert_eq!(size("conversion").as_deref(), Some("9.3 pt"));
        assert_eq!(size("new subscribers").as_deref(), Some("18%"));
    }
}
