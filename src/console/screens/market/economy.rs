//! The published index of the economy: days of measurement, days of publication, and the unpublished period.
//! News of competitors are marked by day.

use ratatui::layout::Rect;

use super::model::Published;
use super::news::RivalNews;
use super::{Market, hidden};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::grouped;
use novamind_session::ToolLimits;
use novamind_tui::canvas::{Canvas, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Axis, Line, Side, Unit, chart};
use novamind_worker::company::Company;

/// Marks for the number of competitor news in a column, relative to the maximum.
const MARKS: [&str; 4] = ["▁", "▃", "▅", "█"];

/// Returns the day on which the next measurement is published.
pub fn next_day(economy: &[Published], terms: &ToolLimits) -> u32 {
    let measured = economy.last().map_or(1, |last| last.day + terms.economy_every_days);
    measured + terms.economy_lag_days
}

pub struct EconomyView<'a> {
    /// Published measurements, oldest first.
    pub economy: &'a [Published],
    /// Index of the selected measurement.
    pub point: Option<usize>,
    /// News of the press, newest first.
    pub news: &'a [RivalNews],
}

impl<'a> EconomyView<'a> {
    /// Returns the selected measurement; by default the last one.
    pub fn selected(&self) -> Option<&'a Published> {
        self.point.and_then(|at| self.economy.get(at)).or(self.economy.last())
    }
}

pub struct EconomyPane;

impl Pane<Market> for EconomyPane {
    fn scopes(&self, _: &Market) -> Vec<Scope> {
        vec![Scope::Market, Scope::List]
    }

    fn hints(&self, _: &Market) -> Vec<Action> {
        vec![Action::Left, Action::Right, Action::Open, Action::FindGroup]
    }

    fn figure(&self, market: &Market, _: &Look<'_>) -> Option<Figure> {
        let day = market.economy().selected()?.day;
        Some(Figure {
            title: format!("PMI of day {day}"),
            term: "pmi",
            sql: Some(format!("SELECT * FROM macroeconomic_conditions WHERE day = {day}")),
            why: None,
        })
    }

    fn act(&self, market: &mut Market, action: Action, _: &Look<'_>) -> Vec<Effect> {
        let last = market.facts.economy.len().saturating_sub(1);
        let now = market.point.unwrap_or(last).min(last);
        market.point = match action {
            Action::Open => return market.economy().selected().map(read).into_iter().collect(),
            Action::Left | Action::Down | Action::PageDown => Some(now.saturating_sub(1)),
            Action::Right | Action::Up | Action::PageUp => Some((now + 1).min(last)),
            Action::First => Some(0),
            Action::Last | Action::Close => None,
            _ => market.point,
        }
        // A selection of the last measurement follows newer ones.
        .filter(|at| *at < last);
        Vec::new()
    }

    fn border(&self, market: &Market, _: Rect, look: &Look<'_>) -> Border {
        let note = market.economy().selected().map_or(String::new(), |here| {
            let sign = if here.change < 0.0 { '-' } else { '+' };
            let figures = format!("PMI {} ({sign}{})", grouped(here.value, 1), grouped(here.change.abs(), 1));
            format!("{figures} · {}", here.words)
        });
        let keys = [Action::Left, Action::Right].map(|action| look.keys.label(action).unwrap_or_default());
        let keys = format!("{}/{} other measurements", keys[0], keys[1]);
        Border { title: "Economy".to_owned(), note, keys, ..Border::default() }
    }

    fn draw(&self, market: &Market, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let inside = match &look.company.hidden {
            Some(hidden) => hidden::draw_above(canvas, seat.area, &hidden::of_economy(hidden)),
            None => seat.area,
        };
        let view = market.economy();
        let Some(here) = view.selected() else {
            return draw_nothing(canvas, inside, &view, &look.company.terms);
        };
        let terms = &look.company.terms;
        let width = inside.width as usize;
        let lag = format!(
            "measured on day {}, published on day {}; next on day {}",
            here.day,
            here.day + terms.economy_lag_days,
            next_day(view.economy, terms)
        );
        let mut words = wrapped(&here.text, width);
        words.extend(wrapped(&lag, width));
        if inside.height >= 14 {
            words.extend(wrapped("◆ published · ░ not yet published · ▁▃▅ news of competitors", width));
        }
        let room = (inside.height / 2) as usize;
        let words = &words[words.len().saturating_sub(room.max(1))..];
        let above = inside.height.saturating_sub(words.len() as u16);
        draw_curve(canvas, Rect { height: above, ..inside }, look.company, &view, here);
        let below = Rect { y: inside.y + above, height: inside.height - above, ..inside };
        for (row, line) in rows_of(below).zip(words) {
            canvas.text(row, line, Role::Dim);
        }
    }
}

fn read(point: &Published) -> Effect {
    Effect::ShowText(format!("PMI of day {} · {}", point.day, point.words), point.text.clone())
}

fn draw_nothing(canvas: &mut Canvas<'_>, area: Rect, view: &EconomyView<'_>, terms: &ToolLimits) {
    let words = format!(
        "No index yet: day 1 is published on day {}, {} days after measurement",
        next_day(view.economy, terms),
        terms.economy_lag_days
    );
    for (row, line) in rows_of(area).zip(wrapped(&words, area.width as usize)) {
        canvas.text(row, &line, Role::Dim);
    }
}

/// Draws the curve by day of measurement, above two lanes with days of publication and news of competitors.
fn draw_curve(
    canvas: &mut Canvas<'_>,
    area: Rect,
    company: &Company,
    view: &EconomyView<'_>,
    here: &Published,
) {
    let lanes = if area.height >= 9 { 2 } else { 0 };
    // The lane names need four columns left of the axis.
    let indent = if lanes > 0 { 2.min(area.width) } else { 0 };
    let upper = Rect { x: area.x + indent, width: area.width - indent, height: area.height - lanes, ..area };
    let today = company.seen.day.max(2);
    let points = view.economy.iter().map(|own| (f64::from(own.day), own.value)).collect();
    let selected = vec![(f64::from(here.day), here.value)];
    let lines = [
        Line::through(points, Role::Series(0)),
        Line { scattered: true, ..Line::through(selected, Role::Strong) },
    ];
    let days = [1.0, f64::from(today)];
    let x = Axis { write: &|day| format!("day {day:.0}"), holds: &days };
    chart(canvas, upper, &lines, &x, &Side { unit: Unit::Number, holds: &[50.0] });
    let Some(plot) = plot_of(canvas, upper) else { return };
    let column = |day: u32| {
        let share = f64::from(day.clamp(1, today) - 1) / f64::from(today - 1);
        plot.x + (share * f64::from(plot.width - 1)).round() as u16
    };
    if let Some(last) = view.economy.last() {
        shade(canvas, Rect { x: column(last.day) + 1, width: plot.right() - column(last.day) - 1, ..plot });
    }
    if lanes == 0 {
        return;
    }
    let [told, rivals] = [0, 1].map(|lane| Rect { y: upper.bottom() + lane, height: 1, ..area });
    let names = Rect { width: plot.x - area.x, ..told };
    canvas.text(names, "publ", Role::Dim);
    canvas.text(Rect { y: rivals.y, ..names }, "news", Role::Dim);
    for own in view.economy {
        let (from, to) = (column(own.day), column(own.day + company.terms.economy_lag_days));
        let role = if own.day == here.day { Role::Strong } else { Role::Series(0) };
        if own.day == here.day && to > from {
            canvas.text(
                Rect { x: from, width: to - from, ..told },
                &"─".repeat((to - from) as usize),
                Role::Dim,
            );
        }
        canvas.text(Rect { x: to, width: 1, ..told }, "◆", role);
    }
    let counts: Vec<(u16, usize)> =
        (plot.left()..plot.right()).map(|x| (x, count_at(view.news, |day| column(day) == x))).collect();
    let most = counts.iter().map(|(_, count)| *count).max().unwrap_or(0).max(1);
    for (x, count) in counts.into_iter().filter(|(_, count)| *count > 0) {
        let level = (count * MARKS.len()).div_ceil(most) - 1;
        canvas.text(Rect { x, width: 1, ..rivals }, MARKS[level.min(MARKS.len() - 1)], Role::Series(1));
    }
}

fn count_at(news: &[RivalNews], holds: impl Fn(u32) -> bool) -> usize {
    news.iter().filter(|item| item.rival.is_some() && holds(item.post.day)).count()
}

/// Returns the area of the curve, without the axes that the chart has drawn.
fn plot_of(canvas: &Canvas<'_>, area: Rect) -> Option<Rect> {
    let area = area.intersection(canvas.area());
    let below = area.bottom().checked_sub(2).filter(|_| area.height >= 4)?;
    let axis = (area.left()..area.right()).find(|x| canvas.buffer[(*x, below)].symbol() == "└")?;
    let width = area.right() - axis - 1;
    (width > 3).then(|| Rect { x: axis + 1, y: area.y, width, height: area.height - 2 })
}

/// Shades the days without published values.
fn shade(canvas: &mut Canvas<'_>, area: Rect) {
    for row in rows_of(area.intersection(canvas.area())) {
        for x in row.left()..row.right() {
            if matches!(canvas.buffer[(x, row.y)].symbol(), " " | "\u{2800}") {
                canvas.text(Rect { x, width: 1, ..row }, "░", Role::Border);
            }
        }
    }
}
