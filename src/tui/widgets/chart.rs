//! Charts: curves with round axis labels, a grid, bands, and names at the ends of the curves.

use ratatui::layout::Rect;
use ratatui::symbols::Marker;
use unicode_width::UnicodeWidthStr;

use super::raster::{Raster, row_of_share};
use super::scale::{AxisUnit, ticks, widen_to_ticks};
use crate::canvas::{Align, Canvas};
use crate::text::format_change;
use crate::theme::Role;

/// Largest distance of a band from the curves, as a multiple of the range of the curves. The band is cut at this
/// distance.
const MAX_BAND_DISTANCE: f64 = 1.0;
/// Smallest distance at which a band is cut, as a share of the largest absolute value of the curves. Without this
/// minimum, the band around a nearly constant curve would not be visible.
const MIN_BAND_DISTANCE: f64 = 0.25;
/// Distance between the arrows that mark a cut band, in columns.
const CUT_MARK_DISTANCE: u16 = 4;

/// Maximum number of rows of a chart that labels only values near the middle of a row.
const MAX_LOW_CHART_ROWS: u16 = 5;
/// Largest distance between a labelled value and the middle of its row in a low chart, in rows.
const MAX_LABEL_DISTANCE: f64 = 0.25;

/// Minimum width of a chart with names at the ends of its curves.
const MIN_WIDTH_FOR_NAMES: u16 = 36;

/// A curve of a chart.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Points as horizontal and vertical values. Points that are not finite are omitted.
    pub points: Vec<(f64, f64)>,
    /// Role that determines the color of the curve.
    pub role: Role,
    /// Whether the points are drawn separately, not connected by a line.
    pub is_scatter: bool,
    /// Name that is drawn at the end of the curve if there is space; empty for no name.
    pub name: &'static str,
}

impl Curve {
    /// Returns a curve through values at the positions 0, 1, 2, …
    pub fn from_values(values: &[f64], role: Role) -> Curve {
        let points = values.iter().enumerate().map(|(at, value)| (at as f64, *value)).collect();
        Curve::from_points(points, role)
    }

    /// Returns a curve through points.
    pub fn from_points(points: Vec<(f64, f64)>, role: Role) -> Curve {
        Curve { points, role, is_scatter: false, name: "" }
    }

    /// Sets the name that is drawn at the end of the curve.
    pub fn with_name(self, name: &'static str) -> Curve {
        Curve { name, ..self }
    }
}

/// A shaded area between two bounds. A band that would flatten the curves is cut, and arrows mark where it continues.
#[derive(Debug, Clone)]
pub struct Band {
    /// Horizontal position, lower bound and upper bound of each point, sorted by position.
    pub bounds: Vec<(f64, f64, f64)>,
    /// Name that is drawn at the end of the band; empty for no name.
    pub name: &'static str,
}

impl Band {
    /// Returns the lower and upper bound at a position, or `None` outside of the band.
    fn bounds_at(&self, x: f64) -> Option<(f64, f64)> {
        let next = self.bounds.iter().position(|end| end.0 >= x)?;
        let (after, before) = (self.bounds[next], self.bounds[next.saturating_sub(1)]);
        if x < before.0 {
            return None;
        }
        let share = if after.0 > before.0 { (x - before.0) / (after.0 - before.0) } else { 0.0 };
        Some((before.1 + (after.1 - before.1) * share, before.2 + (after.2 - before.2) * share))
    }
}

/// The horizontal axis of a chart.
pub struct XAxis<'a> {
    /// Function that formats a value for a label.
    pub format: &'a dyn Fn(f64) -> String,
    /// Values that the axis must include.
    pub required_values: &'a [f64],
}

/// The vertical axis of a chart.
pub struct YAxis<'a> {
    /// Unit of the values, which determines the format of their labels.
    pub unit: AxisUnit,
    /// Values that the axis must include.
    pub required_values: &'a [f64],
}

/// A label at a point of a chart, drawn above curves and bands.
pub struct PointLabel {
    /// Position of the label on the horizontal axis.
    pub x: f64,
    /// Position of the label on the vertical axis.
    pub y: f64,
    /// Text that is drawn at the point.
    pub text: &'static str,
    /// Role that determines the style of the label.
    pub role: Role,
}

/// A chart of curves and an optional band.
pub struct Plot<'a> {
    /// Curves of the chart. Later curves are drawn above earlier curves.
    pub curves: &'a [Curve],
    /// A band that is drawn behind the curves.
    pub band: Option<&'a Band>,
    /// Horizontal position of a vertical line, if any.
    pub marked_x: Option<f64>,
    /// Labels and required values of the horizontal axis.
    pub x: &'a XAxis<'a>,
    /// Unit and required values of the vertical axis.
    pub y: &'a YAxis<'a>,
}

/// Draws a chart of curves, or [`Canvas::empty_chart_text`] if there is no data.
pub fn draw_chart(canvas: &mut Canvas<'_>, area: Rect, lines: &[Curve], x: &XAxis<'_>, y: &YAxis<'_>) {
    Plot { curves: lines, band: None, marked_x: None, x, y }.draw(canvas, area);
}

/// A label of the horizontal axis: the column of its tick, the first column of its text, and the text.
type AxisLabel = (u16, u16, String);

struct PlotFrame {
    area: Rect,
    marker: Marker,
    x: [f64; 2],
    y: [f64; 2],
}

impl PlotFrame {
    fn fraction([from, to]: [f64; 2], value: f64) -> f64 {
        (value - from) / (to - from)
    }

    fn column(&self, x: f64) -> u16 {
        let max = f64::from(self.area.width.saturating_sub(1));
        self.area.x + (PlotFrame::fraction(self.x, x).clamp(0.0, 1.0) * max).round() as u16
    }

    /// Returns the row in which curves are drawn at a value.
    fn row(&self, y: f64) -> u16 {
        self.area.y + row_of_share(self.marker, self.area.height, PlotFrame::fraction(self.y, y)).0
    }

    /// Returns whether a label of a value describes its row. In a low chart, a row covers a large range of values, so
    /// only values near the middle of a row and the ends of the axis are labelled.
    fn is_labelled(&self, y: f64) -> bool {
        let share = PlotFrame::fraction(self.y, y);
        let is_end = !(1e-9..=1.0 - 1e-9).contains(&share);
        let distance = row_of_share(self.marker, self.area.height, share).1;
        self.area.height > MAX_LOW_CHART_ROWS || is_end || distance <= MAX_LABEL_DISTANCE
    }
}

impl Plot<'_> {
    /// Draws the chart, or [`Canvas::empty_chart_text`] if there is no data.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        self.draw_with_labels(canvas, area, &[]);
    }

    /// Draws the chart with point labels on top. Labels outside of the axes are drawn at the edge.
    pub fn draw_with_labels(&self, canvas: &mut Canvas<'_>, area: Rect, signs: &[PointLabel]) {
        let area = area.intersection(canvas.buffer.area);
        if area.width < 16 || area.height < 4 {
            return;
        }
        let points = || self.curves.iter().flat_map(|line| &line.points).filter(|point| point.1.is_finite());
        if points().next().is_none() {
            canvas.draw_text(area, canvas.empty_chart_text, Role::Dim);
            return;
        }
        let band = || self.band.iter().flat_map(|band| &band.bounds);
        let x =
            axis_bounds(points().map(|point| point.0).chain(band().map(|end| end.0)), self.x.required_values);
        // Curves that are zero everywhere have no shape that a band could flatten.
        let limits = match points().all(|point| point.1 == 0.0) {
            true => [f64::NEG_INFINITY, f64::INFINITY],
            false => band_limits(axis_bounds(points().map(|point| point.1), self.y.required_values)),
        };
        let ends = band().flat_map(|end| [end.1.max(limits[0]), end.2.min(limits[1])]);
        let y = axis_bounds(points().map(|point| point.1).chain(ends), self.y.required_values);
        let rows = ((area.height - 2) / 4).clamp(2, 6) as usize;
        let y = widen_to_ticks(y, rows);
        let marks = ticks(y, rows + 1);
        let labels = self.y.unit.labels(&marks);
        let left = labels.iter().map(|label| label.width()).max().unwrap_or(0) as u16;
        let left = left.min(area.width / 2);
        let plot = area.width - left - 1;
        let names = if plot >= MIN_WIDTH_FOR_NAMES { self.longest_name_width() } else { 0 };
        let inside = Rect {
            x: area.x + left + 1,
            y: area.y,
            width: plot - if names > 0 { names + 1 } else { 0 },
            height: area.height - 2,
        };
        let frame = PlotFrame { area: inside, marker: canvas.marker, x, y };
        draw_y_axis(canvas, area, &frame, &marks, &labels);
        self.draw_x_axis(canvas, area, &frame);
        self.draw_band(canvas, &frame, limits);
        if let Some(mark) = self.marked_x.filter(|mark| *mark >= x[0] && *mark <= x[1]) {
            for y in inside.top()..inside.bottom() {
                canvas.draw_text(Rect { x: frame.column(mark), y, width: 1, height: 1 }, "┊", Role::Dim);
            }
        }
        self.draw_curves(canvas, &frame);
        for sign in signs {
            let place = Rect { x: frame.column(sign.x), y: frame.row(sign.y), height: 1, ..inside };
            let room = inside.right().saturating_sub(place.x);
            canvas.draw_text(Rect { width: room, ..place }, sign.text, sign.role);
        }
        if names > 0 {
            let place = Rect { x: inside.right() + 1, width: names, ..inside };
            self.draw_curve_names(canvas, place, &frame);
        }
    }

    fn longest_name_width(&self) -> u16 {
        let names = self.curves.iter().map(|line| line.name).chain(self.band.map(|band| band.name));
        names.map(UnicodeWidthStr::width).max().unwrap_or(0) as u16
    }

    /// Draws the horizontal axis with as many round labels as fit.
    fn draw_x_axis(&self, canvas: &mut Canvas<'_>, area: Rect, frame: &PlotFrame) {
        let inside = frame.area;
        let line = Rect { x: inside.x - 1, y: inside.bottom(), width: inside.width + 1, height: 1 };
        canvas.draw_text(line, &format!("└{}", "─".repeat(inside.width as usize)), Role::Border);
        let row = Rect { y: inside.bottom() + 1, height: 1, ..area };
        let place = |value: f64| {
            let (label, column) = ((self.x.format)(value), frame.column(value));
            let width = label.width() as u16;
            let x = column.saturating_sub(width / 2).max(area.x);
            (column, x.min(area.right().saturating_sub(width)), label)
        };
        let clear = |left: &AxisLabel, right: &AxisLabel| left.1 + (left.2.width() as u16) + 1 < right.1;
        // Labels must differ and must not touch each other.
        let fits = |labels: &Vec<AxisLabel>| {
            labels.windows(2).all(|pair| clear(&pair[0], &pair[1]) && pair[0].2 != pair[1].2)
        };
        let placed = |count: usize| ticks(frame.x, count).into_iter().map(place).collect::<Vec<AxisLabel>>();
        let mut labels = (1..=12).rev().map(placed).find(fits).unwrap_or_default();
        for value in
            self.x.required_values.iter().filter(|value| **value >= frame.x[0] && **value <= frame.x[1])
        {
            let held = place(*value);
            labels.retain(|label| clear(label, &held) || clear(&held, label));
            labels.push(held);
        }
        for (column, x, label) in labels {
            canvas.draw_text(Rect { x: column, width: 1, ..line }, "┬", Role::Border);
            canvas.draw_text(Rect { x, width: area.right() - x, ..row }, &label, Role::Dim);
        }
    }

    /// Draws the band within its limits. Arrows mark columns in which the band continues beyond a limit.
    fn draw_band(&self, canvas: &mut Canvas<'_>, frame: &PlotFrame, limits: [f64; 2]) {
        let Some(band) = self.band else { return };
        for at in 0..frame.area.width {
            // A column covers the band from its left to its right edge, so that neighboring columns of a steep band
            // touch.
            let edges = [f64::from(at) - 0.5, f64::from(at) + 0.5].map(|column| {
                let share = column / f64::from(frame.area.width.saturating_sub(1).max(1));
                band.bounds_at(frame.x[0] + (frame.x[1] - frame.x[0]) * share)
            });
            let ends = edges.iter().flatten();
            let upper = ends.clone().map(|end| frame.row(end.1.min(limits[1]))).min();
            let lower = ends.clone().map(|end| frame.row(end.0.max(limits[0]))).max();
            let (Some(upper), Some(lower)) = (upper, lower) else { continue };
            let cuts = [ends.clone().any(|end| end.1 > limits[1]), ends.clone().any(|end| end.0 < limits[0])];
            for y in upper..=lower {
                let cell = Rect { x: frame.area.x + at, y, width: 1, height: 1 };
                canvas.draw_text(cell, "░", Role::Fan);
            }
            for (y, arrow, _) in
                [(upper, "▲", cuts[0]), (lower, "▼", cuts[1])].into_iter().filter(|mark| mark.2)
            {
                if at % CUT_MARK_DISTANCE == 0 {
                    canvas.draw_text(
                        Rect { x: frame.area.x + at, y, width: 1, height: 1 },
                        arrow,
                        Role::Text,
                    );
                }
            }
        }
    }

    fn draw_curves(&self, canvas: &mut Canvas<'_>, frame: &PlotFrame) {
        let mut raster = Raster::new(canvas.marker, frame.area.width, frame.area.height);
        let has_single_point =
            |line: &Curve| line.points.iter().filter(|point| point.1.is_finite()).count() == 1;
        for line in self.curves.iter().filter(|line| !line.is_scatter) {
            let place = |point: &(f64, f64)| {
                (PlotFrame::fraction(frame.x, point.0), PlotFrame::fraction(frame.y, point.1))
            };
            let points: Vec<(f64, f64)> =
                line.points.iter().filter(|point| point.1.is_finite()).map(place).collect();
            points.windows(2).for_each(|pair| raster.draw_line(pair[0], pair[1], line.role));
        }
        raster.draw(canvas, frame.area);
        // A curve with a single value is drawn as a point.
        for line in self.curves.iter().filter(|line| line.is_scatter || has_single_point(line)) {
            for point in line.points.iter().filter(|point| point.1.is_finite()) {
                let cell = Rect { x: frame.column(point.0), y: frame.row(point.1), width: 1, height: 1 };
                canvas.draw_text(cell, "•", line.role);
            }
        }
    }

    /// Draws the names of curves next to their last points, in vertical order.
    fn draw_curve_names(&self, canvas: &mut Canvas<'_>, place: Rect, frame: &PlotFrame) {
        let name_of_curve = |line: &Curve| {
            let last = line.points.iter().rev().find(|point| point.1.is_finite())?;
            Some((line.name, last.1, line.role))
        };
        let band_label = |band: &Band| Some((band.name, band.bounds.last()?.2, Role::Text));
        let lines = self.curves.iter().rev().filter_map(name_of_curve);
        let mut names: Vec<(&str, f64, Role)> = lines
            .chain(self.band.and_then(band_label))
            .filter(|named_curve| !named_curve.0.is_empty())
            .collect();
        names.truncate(usize::from(place.height));
        names.sort_by(|one, other| other.1.total_cmp(&one.1));
        let wanted: Vec<u16> = names.iter().map(|named_curve| frame.row(named_curve.1)).collect();
        for ((name, _, role), y) in names.into_iter().zip(spread_rows(&wanted, place)) {
            canvas.draw_text(Rect { y, height: 1, ..place }, name, role);
        }
    }
}

/// Returns distinct rows in the order of the wanted rows, each as close to its wanted row as possible.
fn spread_rows(wanted: &[u16], place: Rect) -> Vec<u16> {
    let mut rows: Vec<u16> = Vec::with_capacity(wanted.len());
    for row in wanted {
        let min = rows.last().map_or(place.top(), |above| above + 1);
        rows.push((*row).max(min));
    }
    let mut max = place.bottom();
    for row in rows.iter_mut().rev() {
        max = max.saturating_sub(1);
        *row = (*row).min(max);
        max = *row;
    }
    rows
}

/// Returns the lower and the upper limit of a band, for curves with this range of values.
fn band_limits([least, most]: [f64; 2]) -> [f64; 2] {
    let distance = (MAX_BAND_DISTANCE * (most - least)).max(MIN_BAND_DISTANCE * most.abs().max(least.abs()));
    [least - distance, most + distance]
}

fn axis_bounds(values: impl Iterator<Item = f64>, required: &[f64]) -> [f64; 2] {
    let all = values.chain(required.iter().copied());
    let (min, max) =
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), value| (min.min(value), max.max(value)));
    match min {
        _ if max > min => [min, max],
        0.0 => [0.0, 1.0],
        // A constant value is drawn in the middle of an axis that starts at zero.
        level => [(2.0 * level).min(0.0), (2.0 * level).max(0.0)],
    }
}

/// Draws the vertical axis and the grid, with a solid zero line.
fn draw_y_axis(canvas: &mut Canvas<'_>, area: Rect, frame: &PlotFrame, marks: &[f64], labels: &[String]) {
    let inside = frame.area;
    let axis = inside.x - 1;
    for y in inside.top()..inside.bottom() {
        canvas.draw_text(Rect { x: axis, y, width: 1, height: 1 }, "│", Role::Border);
    }
    let mut free = inside.bottom();
    for (value, label) in marks.iter().zip(labels) {
        let y = frame.row(*value);
        if y >= free || !frame.is_labelled(*value) {
            continue;
        }
        free = y;
        let grid = if *value == 0.0 { "─".repeat(inside.width as usize) } else { grid_line(inside.width) };
        canvas.draw_text(Rect { y, height: 1, ..inside }, &grid, Role::Border);
        canvas.draw_text(Rect { x: axis, y, width: 1, height: 1 }, "┤", Role::Border);
        let place = Rect { x: area.x, y, width: axis - area.x, height: 1 };
        canvas.draw_aligned(place, label, Role::Dim, Align::Right);
    }
}

fn grid_line(width: u16) -> String {
    (0..width).map(|at| if at % 4 == 3 { '┈' } else { ' ' }).collect()
}

/// Returns zero as a required axis value if the values are near zero. Otherwise, returns no value, because an axis that
/// includes zero would flatten the curve.
pub fn zero_if_near(values: impl Iterator<Item = f64> + Clone) -> &'static [f64] {
    let max = values.clone().fold(f64::NEG_INFINITY, f64::max);
    let min = values.fold(f64::INFINITY, f64::min);
    if min < 0.5 * max { &[0.0] } else { &[] }
}

/// Describes a series by its last value and, if they fit, its last change, minimum and maximum.
pub fn summary(values: &[f64], write: &dyn Fn(f64) -> String, room: usize) -> String {
    let Some(now) = values.last() else { return "no data yet".to_owned() };
    let mut words = write(*now);
    let min = values.iter().copied().fold(f64::INFINITY, f64::min);
    let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let before = values.len().checked_sub(2).map(|at| values[at]);
    let change =
        before.map(|before| format!(" {}", format_change(now - before, &write((now - before).abs()))));
    let extremes = format!(" · min {} · max {}", write(min), write(max));
    for part in change.into_iter().chain([extremes]) {
        if words.width() + part.width() > room {
            break;
        }
        words += &part;
    }
    words
}

/// Returns the width that is available for a note next to the title of a pane.
pub fn note_width(area: Rect, title: &str) -> usize {
    (area.width as usize).saturating_sub(title.width() + 9)
}

#[cfg(test)]
mod tests;
