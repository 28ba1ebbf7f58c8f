//! A shareable card that summarizes a run, as text of 80 columns or as a picture. The card shows the cash curve,
//! turning points, figures and the scenario.

mod svg;
mod text;

use super::formatting::{format_money, format_whole, pluralize};
use super::highlights::{highest_cash, lowest_cash, peak_week};
use super::run_report::RunReport;
use novamind_base::formatting::escape_control_characters;
use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::RunEndReason;
use novamind_session::Generation;

#[derive(Debug, Clone, PartialEq, Eq)]
struct LabeledFigure {
    /// Value with its unit, as text.
    value: String,
    name: String,
}

#[derive(Debug, Clone, PartialEq)]
struct Card {
    headline: String,
    /// Rank among the published results; `None` if the run is not comparable.
    rank: Option<String>,
    cash_by_day: Vec<f64>,
    /// Days of the highest and the lowest cash.
    marks: Vec<u32>,
    turning_points: Vec<LabeledFigure>,
    numbers: [LabeledFigure; 3],
    /// Remark about a language model that worded or judged posts, if any.
    voice: Option<&'static str>,
    /// Scenario, seed and program version of the run.
    source: String,
}

pub fn to_text(report: &RunReport) -> String {
    text::to_text(&Card::from_report(report))
}

pub fn to_svg(report: &RunReport) -> String {
    svg::draw(&Card::from_report(report))
}

impl Card {
    fn from_report(report: &RunReport) -> Card {
        let (highest, lowest) = (highest_cash(&report.cash_by_day), lowest_cash(&report.cash_by_day));
        let fact = |value: String, name: String| LabeledFigure { value, name };
        let mut turning_points = Vec::new();
        if let Some((day, cash)) = highest {
            turning_points.push(fact(format_money(cash), format!("highest cash, day {day}")));
        }
        if let Some((day, cash)) = lowest {
            turning_points.push(fact(format_money(cash), format!("lowest cash, day {day}")));
        }
        if let Some(week) = peak_week(&report.weeks, |week| week.individual_subscribers) {
            let count = format_whole(f64::from(week.individual_subscribers));
            turning_points.push(fact(count, format!("peak subscribers, day {}", week.day)));
        }
        let last = report.weeks.last().copied().unwrap_or_default();
        let grew = report.weeks.iter().filter(|week: &&WeekFigures| week.cash_change > 0.0).count();
        Card {
            headline: headline(report),
            rank: report.ranking.rank.map(|_| report.ranking.describe()),
            cash_by_day: report.cash_by_day.clone(),
            marks: [highest, lowest].into_iter().flatten().map(|(day, _)| day).collect(),
            turning_points,
            numbers: [
                fact(
                    format_whole(f64::from(last.individual_subscribers)),
                    format!("subscribers, day {}", report.observation.day),
                ),
                fact(
                    format_whole(f64::from(last.enterprise_seats)),
                    format!("seats, day {}", report.observation.day),
                ),
                fact(format!("{grew} of {}", report.weeks.len()), "weeks with rising cash".to_owned()),
            ],
            voice: describe_voice(report),
            source: describe_source(report),
        }
    }
}

fn headline(report: &RunReport) -> String {
    let (day, cash) = (report.observation.day, format_money(report.observation.cash));
    match report.observation.ended {
        Some(RunEndReason::Horizon) => format!("{cash} after {}", pluralize(day, "day")),
        Some(RunEndReason::Bankruptcy) => format!("Bankrupt on day {day}"),
        Some(RunEndReason::Abandoned) => format!("Abandoned on day {day} with {cash}, without a score"),
        Some(RunEndReason::Lesson) => format!("{cash} at the end of the lesson on day {day}"),
        None => format!("{cash} on day {day} of {}", report.observation.last_day),
    }
}

fn describe_voice(report: &RunReport) -> Option<&'static str> {
    let model = report.observation.voice.as_ref()?;
    Some(match (model.words, model.judge) {
        (true, true) => "A language model worded customers' posts and judged the player's posts.",
        (_, false) => "A language model worded customers' posts.",
        (false, true) => "A language model judged the player's posts.",
    })
}

fn describe_source(report: &RunReport) -> String {
    let seed = report.observation.seed.map_or(String::new(), |seed| format!(" · seed {seed}"));
    let changed = if report.observation.has_own_parameters { " · changed parameters" } else { "" };
    let scenario: String = escape_control_characters(&report.observation.scenario).chars().take(24).collect();
    let generation = match report.observation.generation {
        Generation::Release1 => "",
        Generation::Release2 => " · release 2",
    };
    format!(
        "scenario {scenario}{generation}{seed}{changed} · version {}",
        escape_control_characters(&report.version)
    )
}

#[cfg(test)]
mod tests {
    use unicode_width::UnicodeWidthStr;

    use super::*;
    use crate::test_kit;
    use novamind_database::Cell;
    use novamind_session::Session;

    fn query_number(session: &mut Session, sql: &str) -> f64 {
        let rows = session.query(sql).expect(sql);
        match rows.rows[0][0] {
            Cell::Integer(value) => value as f64,
            Cell::Real(value) => value,
            _ => 0.0,
        }
    }

    fn ledger_cash(session: &mut Session, last: u32) -> Vec<f64> {
        let until = |day| format!("SELECT total(amount) FROM ledger WHERE day <= {day}");
        (0..=last).map(|day| query_number(session, &until(day))).collect()
    }

    #[test]
    fn card_figures_match_the_database() {
        let mut session = test_kit::finished_run();
        let report = RunReport::from_session(&session);
        let card = Card::from_report(&report);
        let cash = ledger_cash(&mut session, 35);
        assert_eq!(card.cash_by_day.len(), cash.len());
        for (day, (shown, booked)) in card.cash_by_day.iter().zip(&cash).enumerate() {
            assert!((shown - booked).abs() < 0.005, "day {day}: {shown} and {booked}");
        }
        let best = cash.iter().copied().fold(f64::MIN, f64::max);
        let day = cash.iter().position(|amount| *amount == best).expect("a day");
        assert_eq!(card.turning_points[0].name, format!("highest cash, day {day}"));
        assert_eq!(card.turning_points[0].value, format_money(best));
        let min = cash.iter().copied().fold(f64::MAX, f64::min);
        let day = cash.iter().position(|amount| *amount == min).expect("a day");
        assert_eq!(card.turning_points[1].name, format!("lowest cash, day {day}"));
        assert_eq!(card.turning_points[1].value, format_money(min));
        let mut active = |day: usize| {
            let sql = format!(
                "SELECT count(*) FROM subscriptions s JOIN customers c USING (customer_id) WHERE c.customer_type = 'small' AND \
                 s.status IN ('subscribed', 'cancelled') AND s.start_day <= {day} AND \
                 (s.end_day IS NULL OR s.end_day > {day})"
            );
            query_number(&mut session, &sql)
        };
        let by_week: Vec<f64> = (1..=5).map(|week| active(week * 7)).collect();
        let most = by_week.iter().copied().fold(0.0, f64::max);
        let day = 7 * (1 + by_week.iter().position(|count| *count == most).expect("a week"));
        assert_eq!(card.turning_points[2].value, format_whole(most));
        assert_eq!(card.turning_points[2].name, format!("peak subscribers, day {day}"));
        assert_eq!(card.numbers[0].value, format_whole(by_week[4]));
        let seats = "SELECT total(seat_count) FROM subscriptions s JOIN customers c USING (customer_id) \
                     WHERE c.customer_type = 'large' AND s.status = 'subscribed'";
        let seats = query_number(&mut session, seats);
        assert_eq!(card.numbers[1].value, format_whole(seats));
        let grew = (1..=5).filter(|week| cash[week * 7] > cash[week * 7 - 7]).count();
        assert_eq!(card.numbers[2].value, format!("{grew} of 5"));
        assert_eq!(card.headline, format!("{} after 35 days", format_money(cash[35])));
        assert_eq!(card.rank, None, "35 days instead of 500");
    }

    #[test]
    fn card_fits_80_columns_and_states_the_outcome() {
        for (session, part) in [
            (test_kit::finished_run(), "after 35 days"),
            (test_kit::bankrupt_run(), "Bankrupt on day "),
            (test_kit::play_weeks(0), "on day 0 of 200"),
            (test_kit::play_weeks(2), "on day 14 of 200"),
        ] {
            let card = to_text(&RunReport::from_session(&session));
            assert!(card.contains(part) && card.contains("seed 7"), "{card}");
            assert!(card.lines().all(|line| line.width() <= 80), "{card}");
        }
    }

    #[test]
    fn user_text_is_escaped() {
        let mut report = RunReport::from_session(&test_kit::finished_run());
        report.observation.scenario = "<script>\u{1b}[31m\u{202e}&".to_owned();
        report.version = "\u{1b}]0;x\u{7}".to_owned();
        let text = to_text(&report);
        assert!(!text.contains('\u{1b}') && !text.contains('\u{202e}') && !text.contains('\u{7}'), "{text}");
        assert!(text.lines().all(|line| line.width() <= 80), "{text}");
        let svg = to_svg(&report);
        assert!(svg.contains("&lt;script&gt;") && !svg.contains("<script"), "{svg}");
    }

    #[test]
    fn card_shows_a_rank_only_for_comparable_runs() {
        let mut report = RunReport::from_session(&test_kit::finished_run());
        assert!(!to_text(&report).contains("rank"));
        (report.observation.last_day, report.observation.seed) = (500, Some(42));
        report.ranking = crate::ranking::rank_score(Some(14_208_331.0), &report.observation);
        assert!(to_text(&report).contains("rank 2 of 18") && to_svg(&report).contains("rank 2 of 18"));
    }
}
