//! A week told: what cash did and what that consists of, what changed most and why it may have, what is new, and
//! what became of the forecasts for it.

use super::causes::{Figure, Seen, cause};
use super::movement::{Movement, movement};
use super::words::{money, number, whole};
use crate::notation::{compact, percent};
use crate::session::{Decisions, JournalEntry, Session, WeekFigures};

/// A figure that moved.
#[derive(Debug, Clone, PartialEq)]
pub struct Move {
    /// Name.
    pub name: &'static str,
    /// Value of the week before.
    pub old: String,
    /// Value of the week.
    pub new: String,
    /// Whether it rose.
    pub up: bool,
    /// Whether that is good for the company; none where it depends.
    pub good: Option<bool>,
    /// How it moved against the weeks before.
    pub movement: Movement,
    /// Why it may have.
    pub cause: Option<String>,
}

impl Move {
    /// The change in percent, where there was something before.
    pub fn in_percent(&self) -> Option<String> {
        let (old, new) = (self.movement.old, self.movement.new);
        let share = (old > 0.0).then(|| (new - old) / old)?;
        let decimals = if share.abs() < 0.0995 { 1 } else { 0 };
        Some(if share.abs() < 10.0 {
            percent(share.abs(), decimals)
        } else {
            format!("×{}", whole(new / old))
        })
    }
}

/// A forecast for the end of the week, and what came.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Due {
    /// Days ahead.
    pub horizon_days: u32,
    /// What was said.
    pub point: f64,
    /// Lower end.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
    /// What came.
    pub outcome: f64,
}

impl Due {
    /// Whether the interval held what came.
    pub fn is_inside(&self) -> bool {
        self.lower <= self.outcome && self.outcome <= self.upper
    }

    /// Distance of the point from what came, relative to it.
    pub fn miss(&self) -> f64 {
        (self.point - self.outcome).abs() / self.outcome.abs().max(1.0)
    }

    /// Inside, above or below the interval, with a sign that needs no colour.
    pub fn verdict(&self) -> &'static str {
        match self.is_inside() {
            true => "✓ inside",
            false if self.outcome > self.upper => "▲ above",
            false => "▼ below",
        }
    }
}

/// A week told.
#[derive(Debug, Clone, PartialEq)]
pub struct WeekReport {
    /// Its figures.
    pub week: WeekFigures,
    /// What the change of cash consists of: payments, running costs, the rest.
    pub parts: [(&'static str, f64); 3],
    /// What changed, the most unusual first.
    pub moves: Vec<Move>,
    /// Forecasts for its last day, the shortest first.
    pub due: Vec<Due>,
    /// Posts of customers in it.
    pub customer_posts: u32,
    /// Answers to our posts in it.
    pub comments: u32,
    /// Posts of the press in it.
    pub press: u32,
}

/// A figure: what it is, its name, how it is read and written, whether more of it is better.
struct Row(Figure, &'static str, fn(&WeekFigures) -> f64, fn(f64) -> String, Option<bool>);

fn in_percent(share: f64) -> String {
    percent(share, 1)
}

/// Of the week's individual leads, those who signed up.
fn conversion(week: &WeekFigures) -> f64 {
    match week.new_individual_leads {
        0 => f64::NAN,
        leads => f64::from(week.new_individual_subscribers) / f64::from(leads),
    }
}

const FIGURES: [Row; 14] = [
    Row(Figure::Revenue, "recurring revenue", |week| week.recurring_revenue, money, Some(true)),
    Row(Figure::Payments, "payments", |week| week.payments, money, Some(true)),
    Row(Figure::Costs, "running costs", |week| week.costs, money, Some(false)),
    Row(Figure::Subscribers, "subscribers", |week| f64::from(week.individual_subscribers), whole, Some(true)),
    Row(Figure::Seats, "enterprise seats", |week| f64::from(week.enterprise_seats), whole, Some(true)),
    Row(Figure::Leads, "individual leads", |week| f64::from(week.new_individual_leads), whole, Some(true)),
    Row(
        Figure::CompanyLeads,
        "company leads",
        |week| f64::from(week.new_enterprise_leads),
        whole,
        Some(true),
    ),
    Row(
        Figure::Signups,
        "new subscribers",
        |week| f64::from(week.new_individual_subscribers),
        whole,
        Some(true),
    ),
    Row(Figure::Conversion, "conversion", conversion, in_percent, Some(true)),
    Row(Figure::Cancellations, "cancellations", |week| f64::from(week.cancellations), whole, Some(false)),
    Row(Figure::Usage, "usage, units", |week| week.usage as f64, compact, None),
    Row(Figure::Overload, "overload, peak", |week| week.overload_peak, in_percent, Some(false)),
    Row(Figure::Outage, "outage, minutes", |week| f64::from(week.downtime_minutes), number, Some(false)),
    Row(Figure::Issues, "open issues", |week| f64::from(week.open_issues), whole, Some(false)),
];

/// What a week is told from.
pub struct Sources<'a> {
    /// Figures of every week.
    pub weeks: &'a [WeekFigures],
    /// What was decided before each.
    pub decisions: &'a [Decisions],
    /// Everything that was done.
    pub journal: &'a [JournalEntry],
    /// Cash at the end of each day, day 0 first.
    pub cash_by_day: &'a [f64],
    /// Days of posts: of customers, of comments on ours, of the press.
    pub posts: [&'a [u32]; 3],
}

impl WeekReport {
    /// The last week of a run; none before the first.
    pub fn of_session(session: &Session) -> Option<WeekReport> {
        let mut posts: [Vec<u32>; 3] = Default::default();
        for post in session.posts() {
            // The press is the only one without a profile, comments aside.
            let kind = match (post.own_post, &post.profile) {
                (Some(_), _) => 1,
                (None, Some(_)) => 0,
                (None, None) => 2,
            };
            posts[kind].push(post.day);
        }
        WeekReport::of(&Sources {
            weeks: session.weeks(),
            decisions: session.decisions(),
            journal: session.journal(),
            cash_by_day: session.cash_by_day(),
            posts: posts.each_ref().map(Vec::as_slice),
        })
    }

    /// The last week of these; none before the first.
    pub fn of(sources: &Sources<'_>) -> Option<WeekReport> {
        let week = *sources.weeks.last()?;
        let first_day = week.day - week.days_run.min(week.day) + 1;
        let count =
            |days: &[u32]| days.iter().filter(|day| (first_day..=week.day).contains(*day)).count() as u32;
        let [customer_posts, comments, press] = sources.posts.map(count);
        let rest = week.cash_change - week.payments + week.costs;
        Some(WeekReport {
            week,
            parts: [("payments", week.payments), ("running costs", -week.costs), ("the rest", rest)],
            moves: moves(sources, &week, press),
            due: due(sources, week.day),
            customer_posts,
            comments,
            press,
        })
    }
}

fn moves(sources: &Sources<'_>, week: &WeekFigures, press: u32) -> Vec<Move> {
    let nothing = WeekFigures::default();
    let before = sources.weeks.len().checked_sub(2).map_or(&nothing, |at| &sources.weeks[at]);
    let first_day = before.day;
    let own_posts = sources.journal.iter().filter(|entry| {
        matches!(entry, JournalEntry::Call { day, tool, .. } if *day == first_day && tool == "post_social_media")
    });
    let decided = sources.decisions.iter().rev().find(|decided| decided.day == first_day);
    let seen = Seen { now: week, before, decided, press, own_posts: own_posts.count() as u32 };
    let moved = |Row(figure, name, read, write, more_is_better): &Row| {
        // Before the first week there was nothing.
        let series: Vec<f64> = std::iter::once(&nothing).chain(sources.weeks).map(read).collect();
        let movement = movement(&series)?;
        let up = movement.new > movement.old;
        let (old, new) = (write(movement.old), write(movement.new));
        // What is written the same, or moved by less than a thousandth, did not move for the reader.
        let moved = old != new && movement.size() >= 0.001;
        moved.then(|| Move {
            name,
            old,
            new,
            up,
            good: more_is_better.map(|better| better == up),
            movement,
            cause: cause(*figure, up, &seen),
        })
    };
    let mut moves: Vec<Move> = FIGURES.iter().filter_map(moved).collect();
    moves.sort_by(|left, right| right.movement.unusual.total_cmp(&left.movement.unusual));
    moves
}

fn due(sources: &Sources<'_>, day: u32) -> Vec<Due> {
    let Some(outcome) = sources.cash_by_day.get(day as usize).copied() else { return Vec::new() };
    let mut due: Vec<Due> = Vec::new();
    for entry in sources.journal {
        let JournalEntry::Advance { day: filed, forecasts, .. } = entry else { continue };
        let fitting = forecasts.iter().filter(|forecast| filed + forecast.horizon_days == day);
        due.extend(fitting.map(|forecast| Due {
            horizon_days: forecast.horizon_days,
            point: forecast.point,
            lower: forecast.lower,
            upper: forecast.upper,
            outcome,
        }));
    }
    due.sort_by_key(|due| due.horizon_days);
    due
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::test_kit;

    #[test]
    fn a_week_names_its_parts_its_forecasts_and_what_moved() {
        let session = test_kit::played(5);
        let report = WeekReport::of_session(&session).expect("five weeks have passed");
        let sum: f64 = report.parts.iter().map(|(_, dollars)| dollars).sum();
        assert!((sum - report.week.cash_change).abs() < 0.01);
        let horizons: Vec<u32> = report.due.iter().map(|due| due.horizon_days).collect();
        assert_eq!(horizons, [7, 28]);
        assert!(report.due.iter().all(|due| due.outcome == report.week.cash && due.miss() < 1.0));
        assert!(report.moves.len() > 4);
        let order: Vec<f64> = report.moves.iter().map(|moved| moved.movement.unusual).collect();
        assert!(order.is_sorted_by(|left, right| left >= right), "{order:?}");
        assert!(report.moves.iter().all(|moved| moved.old != moved.new));
    }

    #[test]
    fn the_first_week_is_told_against_nothing_and_no_week_not_at_all() {
        assert_eq!(WeekReport::of_session(&test_kit::played(0)), None);
        let report = WeekReport::of_session(&test_kit::played(1)).expect("a week");
        let costs = report.moves.iter().find(|moved| moved.name == "running costs").expect("they rose");
        assert_eq!((costs.old.as_str(), costs.up, costs.good), ("$0", true, Some(false)));
        assert!(costs.cause.is_some());
        assert_eq!(costs.in_percent(), None);
    }
}
