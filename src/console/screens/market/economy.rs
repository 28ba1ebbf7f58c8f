//! Chart of the PMI, with days of measurement, days of publication and the unpublished period. Competitor news is
//! marked by day.

use ratatui::layout::Rect;

use super::model::EconomyMeasurement;
use super::news::CompetitorNews;
use super::{Market, true_values};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::grouped_number;
use novamind_session::ToolLimits;
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{XAxis, Curve, YAxis, AxisUnit, draw_chart};
use novamind_worker::company::DisplayedCompany;

/// Symbols for the number of competitor news items in a chart column, relative to the maximum.
const NEWS_SYMBOLS: [&str; 4] = ["▁", "▃", "▅", "█"];

/// Returns the day on which the next PMI measurement is published.
pub fn next_publication_day(economy: &[EconomyMeasurement], terms: &ToolLimits) -> u32 {
    let measured = economy.last().map_or(1, |last| last.day + terms.economy_every_days);
    measured + terms.economy_lag_days
}

pub struct EconomyView<'a> {
    /// Published measurements, oldest first.
    pub economy: &'a [EconomyMeasurement],
    /// Index of the selected measurement, or `None` for the last measurement.
    pub selected_index: Option<usize>,
    /// News of the press, newest first.
    pub news: &'a [CompetitorNews],
}

impl<'a> EconomyView<'a> {
    /// Returns the selected measurement. The default is the last measurement.
    pub fn selected(&self) -> Option<&'a EconomyMeasurement> {
        self.selected_index.and_then(|at| self.economy.get(at)).or(self.economy.last())
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

    fn figure(&self, market: &Market, _: &ScreenContext<'_>) -> Option<Figure> {
        let day = market.economy_view().selected()?.day;
        Some(Figure {
            title: format!("PMI of day {day}"),
            term: "pmi",
            sql: Some(format!("SELECT * FROM macroeconomic_conditions WHERE day = {day}")),
            week_quantity: None,
        })
    }

    fn handle_action(&self, market: &mut Market, action: Action, _: &ScreenContext<'_>) -> Vec<Effect> {
        let last = market.facts.economy.len().saturating_sub(1);
        let now = market.selected_measurement.unwrap_or(last).min(last);
        market.selected_measurement = match action {
            Action::Open => return market.economy_view().selected().map(show_measurement).into_iter().collect(),
            Action::Left | Action::Down | Action::PageDown => Some(now.saturating_sub(1)),
            Action::Right | Action::Up | Action::PageUp => Some((now + 1).min(last)),
            Action::First => Some(0),
            Action::Last | Action::Close => None,
            _ => market.selected_measurement,
        }
        // `None` selects the last measurement, even after new measurements are published.
        .filter(|at| *at < last);
        Vec::new()
    }

    fn border(&self, market: &Market, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let note = market.economy_view().selected().map_or(String::new(), |here| {
            let sign = if here.change < 0.0 { '-' } else { '+' };
            let figures = format!("PMI {} ({sign}{})", grouped_number(here.value, 1), grouped_number(here.change.abs(), 1));
            format!("{figures} · {}", here.phase)
        });
        let keys = [Action::Left, Action::Right].map(|action| context.keys.label(action).unwrap_or_default());
        let keys = format!("{}/{} other measurements", keys[0], keys[1]);
        PaneBorder { title: "Economy".to_owned(), note, keys, ..PaneBorder::default() }
    }

    fn draw(&self, market: &Market, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let inside = match &context.company.hidden_values {
            Some(hidden) => true_values::draw_lines_above(canvas, placement.area, &true_values::economy_lines(hidden)),
            None => placement.area,
        };
        let view = market.economy_view();
        let Some(here) = view.selected() else {
            return draw_empty_state(canvas, inside, &view, &context.company.tool_limits);
        };
        let terms = &context.company.tool_limits;
        let width = inside.width as usize;
        let lag = format!(
            "measured on day {}, published on day {}; next on day {}",
            here.day,
            here.day + terms.economy_lag_days,
            next_publication_day(view.economy, terms)
        );
        let mut words = wrap(&here.text, width);
        words.extend(wrap(&lag, width));
        if inside.height >= 14 {
            words.extend(wrap("◆ published · ░ not yet published · ▁▃▅ news about competitors", width));
        }
        let room = (inside.height / 2) as usize;
        let words = &words[words.len().saturating_sub(room.max(1))..];
        let above = inside.height.saturating_sub(words.len() as u16);
        draw_curve(canvas, Rect { height: above, ..inside }, context.company, &view, here);
        let below = Rect { y: inside.y + above, height: inside.height - above, ..inside };
        for (row, line) in row_rects(below).zip(words) {
            canvas.draw_text(row, line, Role::Dim);
        }
    }
}

fn show_measurement(point: &EconomyMeasurement) -> Effect {
    Effect::ShowText(format!("PMI of day {} · {}", point.day, point.phase), point.text.clone())
}

fn draw_empty_state(canvas: &mut Canvas<'_>, area: Rect, view: &EconomyView<'_>, terms: &ToolLimits) {
    let words = format!(
        "No PMI yet: the value of day 1 is published on day {}, {} days after measurement",
        next_publication_day(view.economy, terms),
        terms.economy_lag_days
    );
    for (row, line) in row_rects(area).zip(wrap(&words, area.width as usize)) {
        canvas.draw_text(row, &line, Role::Dim);
    }
}

/// Draws the PMI curve by day of measurement. Below the curve, two lanes show days of publication and competitor news.
fn draw_curve(
    canvas: &mut Canvas<'_>,
    area: Rect,
    company: &DisplayedCompany,
    view: &EconomyView<'_>,
    here: &EconomyMeasurement,
) {
    let lanes = if area.height >= 9 { 2 } else { 0 };
    // The names of the lanes need additional columns to the left of the axis.
    let indent = if lanes > 0 { 2.min(area.width) } else { 0 };
    let upper = Rect { x: area.x + indent, width: area.width - indent, height: area.height - lanes, ..area };
    let today = company.observation.day.max(2);
    let points = view.economy.iter().map(|economy_measurement| (f64::from(economy_measurement.day), economy_measurement.value)).collect();
    let selected = vec![(f64::from(here.day), here.value)];
    let lines = [
        Curve::from_points(points, Role::Series(0)),
        Curve { is_scatter: true, ..Curve::from_points(selected, Role::Strong) },
    ];
    let days = [1.0, f64::from(today)];
    let x = XAxis { format: &|day| format!("day {day:.0}"), required_values: &days };
    draw_chart(canvas, upper, &lines, &x, &YAxis { unit: AxisUnit::Number, required_values: &[50.0] });
    let Some(plot) = plot_area(canvas, upper) else { return };
    let column = |day: u32| {
        let share = f64::from(day.clamp(1, today) - 1) / f64::from(today - 1);
        plot.x + (share * f64::from(plot.width - 1)).round() as u16
    };
    if let Some(last) = view.economy.last() {
        shade_unpublished_days(canvas, Rect { x: column(last.day) + 1, width: plot.right() - column(last.day) - 1, ..plot });
    }
    if lanes == 0 {
        return;
    }
    let [published_row, competitor_row] = [0, 1].map(|lane| Rect { y: upper.bottom() + lane, height: 1, ..area });
    let names = Rect { width: plot.x - area.x, ..published_row };
    canvas.draw_text(names, "publ", Role::Dim);
    canvas.draw_text(Rect { y: competitor_row.y, ..names }, "news", Role::Dim);
    for measurement in view.economy {
        let (from, to) = (column(measurement.day), column(measurement.day + company.tool_limits.economy_lag_days));
        let role = if measurement.day == here.day { Role::Strong } else { Role::Series(0) };
        if measurement.day == here.day && to > from {
            canvas.draw_text(
                Rect { x: from, width: to - from, ..published_row },
                &"─".repeat((to - from) as usize),
                Role::Dim,
            );
        }
        canvas.draw_text(Rect { x: to, width: 1, ..published_row }, "◆", role);
    }
    let counts: Vec<(u16, usize)> =
        (plot.left()..plot.right()).map(|x| (x, count_competitor_news(view.news, |day| column(day) == x))).collect();
    let max = counts.iter().map(|(_, count)| *count).max().unwrap_or(0).max(1);
    for (x, count) in counts.into_iter().filter(|(_, count)| *count > 0) {
        let level = (count * NEWS_SYMBOLS.len()).div_ceil(max) - 1;
        canvas.draw_text(Rect { x, width: 1, ..competitor_row }, NEWS_SYMBOLS[level.min(NEWS_SYMBOLS.len() - 1)], Role::Series(1));
    }
}

fn count_competitor_news(news: &[CompetitorNews], is_in_column: impl Fn(u32) -> bool) -> usize {
    news.iter().filter(|item| item.competitor.is_some() && is_in_column(item.post.day)).count()
}

/// Returns the area of the curve without the axes, which the chart has already drawn.
fn plot_area(canvas: &Canvas<'_>, area: Rect) -> Option<Rect> {
    let area = area.intersection(canvas.area());
    let below = area.bottom().checked_sub(2).filter(|_| area.height >= 4)?;
    let axis = (area.left()..area.right()).find(|x| canvas.buffer[(*x, below)].symbol() == "└")?;
    let width = area.right() - axis - 1;
    (width > 3).then(|| Rect { x: axis + 1, y: area.y, width, height: area.height - 2 })
}

/// Shades the part of the chart with days whose PMI is not published yet.
fn shade_unpublished_days(canvas: &mut Canvas<'_>, area: Rect) {
    for row in row_rects(area.intersection(canvas.area())) {
        for x in row.left()..row.right() {
            if matches!(canvas.buffer[(x, row.y)].symbol(), " " | "\u{2800}") {
                canvas.draw_text(Rect { x, width: 1, ..row }, "░", Role::Border);
            }
        }
    }
}
