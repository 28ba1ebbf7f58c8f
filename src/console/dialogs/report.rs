//! What a week has brought: what changed most, what is new, what needs an answer.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, Outcome};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, Click, centered};
use crate::console::company::Company;
use crate::console::screens::{Look, overview};
use crate::console::text::{arrow, wrapped};
use crate::console::theme::Role;
use crate::notation::{dollars, grouped, percent};
use crate::session::{Week, WeekFigures};

/// The report of a week.
pub struct Report {
    notices: Vec<(u32, String)>,
    remark: Option<String>,
}

impl Report {
    /// The report of a week that has just passed.
    pub fn of(week: &Week) -> Report {
        Report { notices: week.notices.clone(), remark: week.remark.clone() }
    }
}

/// A figure of the report.
struct Moved {
    name: &'static str,
    now: String,
    before: String,
    change: String,
    /// How much it moved, relative to its size.
    size: f64,
    good: bool,
}

/// A figure: name, how to read it, how to write it, whether more is better.
type Figure = (&'static str, fn(&WeekFigures) -> f64, fn(f64) -> String, bool);

const FIGURES: [Figure; 12] = [
    ("recurring revenue a month", |week| week.recurring_revenue, dollars, true),
    ("payments", |week| week.payments, dollars, true),
    ("running costs", |week| week.costs, dollars, false),
    ("individual subscribers", |week| f64::from(week.individual_subscribers), whole, true),
    ("enterprise seats", |week| f64::from(week.enterprise_seats), whole, true),
    ("new individual leads", |week| f64::from(week.new_individual_leads), whole, true),
    ("new individual subscribers", |week| f64::from(week.new_individual_subscribers), whole, true),
    ("cancellations", |week| f64::from(week.cancellations), whole, false),
    ("usage, units", |week| week.usage as f64, whole, true),
    ("overload, peak", |week| week.overload_peak, |share| percent(share, 1), false),
    ("outage minutes", |week| f64::from(week.downtime_minutes), whole, false),
    ("open issues", |week| f64::from(week.open_issues), whole, false),
];

fn whole(value: f64) -> String {
    grouped(value, 0)
}

fn moved(company: &Company) -> Vec<Moved> {
    let Some(now) = company.weeks.last() else { return Vec::new() };
    let before = company.weeks.len().checked_sub(2).map(|at| company.weeks[at]).unwrap_or_default();
    let figure = |(name, read, write, more_is_better): &Figure| {
        let (new, old) = (read(now), read(&before));
        let change = new - old;
        Moved {
            name,
            now: write(new),
            before: write(old),
            change: arrow(change, &write(change.abs())),
            size: change.abs() / old.abs().max(new.abs()).max(1e-9),
            good: (change > 0.0) == *more_is_better,
        }
    };
    let mut all: Vec<Moved> = FIGURES.iter().map(figure).filter(|moved| moved.size > 0.0).collect();
    all.sort_by(|left, right| right.size.total_cmp(&left.size));
    all
}

impl Dialog for Report {
    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Dialog]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Cancel]
    }

    fn act(&mut self, action: Action, _: &Look<'_>) -> Outcome {
        match action {
            Action::Cancel => Outcome::close(),
            _ => Outcome::stay(),
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let company = look.company;
        let Some(week) = company.weeks.last() else { return };
        let own = centered(area, 84.min(area.width), 26.min(area.height));
        canvas.clear(own, Role::Text);
        let title = format!("Week {} · day {}", week.day.div_ceil(7), week.day);
        let inside = canvas.pane(own, &title, "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let mut lines: Vec<Line<'_>> = Vec::new();
        let change = week.cash_change;
        lines.push(Line::from(vec![
            canvas.span(format!("Cash {}  ", dollars(week.cash)), Role::Strong),
            canvas.span(
                arrow(change, &dollars(change.abs())),
                if change >= 0.0 { Role::Good } else { Role::Bad },
            ),
            canvas.span(outcome_of_forecast(company), Role::Dim),
        ]));
        if let Some(remark) = &self.remark {
            lines.extend(
                wrapped(remark, inside.width as usize)
                    .into_iter()
                    .map(|line| Line::from(canvas.span(line, Role::Warning))),
            );
        }
        lines.push(Line::default());
        lines.push(Line::from(canvas.span("What changed most", Role::Header)));
        for moved in moved(company).into_iter().take(7) {
            lines.push(Line::from(vec![
                canvas.span(format!("  {:<28}{:>13}  ", moved.name, moved.now), Role::Text),
                canvas.span(format!("{:<14}", moved.change), if moved.good { Role::Good } else { Role::Bad }),
                canvas.span(format!("was {}", moved.before), Role::Dim),
            ]));
        }
        lines.push(Line::default());
        lines.push(Line::from(canvas.span("What happened", Role::Header)));
        let first = self.notices.len().saturating_sub(5);
        for (day, text) in &self.notices[first..] {
            lines.push(Line::from(vec![
                canvas.span(format!("  day {day:<4}"), Role::Dim),
                canvas.span(text.clone(), Role::Text),
            ]));
        }
        if self.notices.is_empty() {
            lines.push(Line::from(canvas.span("  no messages", Role::Dim)));
        }
        if first > 0 {
            lines.push(Line::from(canvas.span(format!("  and {first} before"), Role::Dim)));
        }
        lines.push(Line::default());
        lines.push(Line::from(canvas.span("Needs you", Role::Header)));
        let alerts = overview::alerts(company);
        for alert in alerts.iter().take(4) {
            let role = if alert.urgent { Role::Warning } else { Role::Text };
            lines.push(Line::from(
                canvas.span(format!("  {} {}", if alert.urgent { "!" } else { "·" }, alert.text), role),
            ));
        }
        if alerts.is_empty() {
            lines.push(Line::from(canvas.span("  nothing", Role::Dim)));
        }
        canvas.lines(inside, &lines);
        canvas.click(own, Click::Do(Action::Cancel));
        canvas.pane_keys(own, "enter or esc closes · w shows it again · d the dashboard as text");
    }
}

/// How the forecast of a week ago turned out.
fn outcome_of_forecast(company: &Company) -> String {
    let Some((filed, forecasts)) = company.last_forecasts() else { return String::new() };
    let Some(forecast) = forecasts.first() else { return String::new() };
    let Some(outcome) = company.cash_by_day.get((filed + forecast.horizon_days) as usize) else {
        return String::new();
    };
    let inside = forecast.lower <= *outcome && *outcome <= forecast.upper;
    let word = if inside { "inside" } else { "outside" };
    format!("   you expected {}: {word} your interval", dollars(forecast.point))
}

/// The report of the last week, to be shown again; none before a week has passed.
pub fn again(company: &Company) -> Option<Report> {
    company.weeks.last().map(|_| Report { notices: Vec::new(), remark: None })
}
