//! Charts as SVG: for a page whose style sheet sets the colors, or as a self-contained file. Every chart contains its
//! title and summary as text.

use std::fmt::Write;

use super::formatting::{format_dollar_tick, format_money, format_tick, format_whole};
use super::page::{Band, Chart, Curve, Plot, StackSeries};
use super::plot::AxisScale;
use novamind_base::formatting::escape_html;

const WIDTH: f64 = 760.0;
const LEFT: f64 = 66.0;
const RIGHT: f64 = 14.0;
const BOTTOM: f64 = 40.0;
const PLOT_HEIGHT: f64 = 220.0;
const LEGEND_ROW_HEIGHT: f64 = 20.0;
/// Approximate width of a character in the legend, pixels.
const LEGEND_LETTER_WIDTH: f64 = 6.6;

/// Scales of the two axes of a chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisScales {
    /// Scale of the horizontal axis.
    pub x: AxisScale,
    /// Scale of the vertical axis.
    pub y: AxisScale,
}

/// Scales of charts in reports. Labels on the horizontal axis are whole days or weeks.
const REPORT_AXES: AxisScales = AxisScales { x: AxisScale::Whole, y: AxisScale::Linear };

/// A chart of a self-contained file, and the scales of its axes.
pub struct ScaledChart {
    /// Content, title and labels of the chart.
    pub chart: Chart,
    /// Scales of the chart's axes.
    pub axes: AxisScales,
}

/// A range of values with round steps. For a logarithmic axis, the range consists of logarithms.
pub(super) struct Scale {
    pub(super) from: f64,
    pub(super) to: f64,
    step: f64,
    kind: AxisScale,
}

impl Scale {
    /// Creates a scale that has about `steps` steps. If `round_ends` is true, widens the range to round endpoints.
    pub(super) fn new(values: impl Iterator<Item = f64>, steps: f64, round_ends: bool) -> Scale {
        let (mut from, mut to) = values
            .filter(|value| value.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), value| (from.min(value), to.max(value)));
        if from > to {
            (from, to) = (0.0, 1.0);
        }
        if to - from < 1e-9 {
            (from, to) = (from - 1.0, to + 1.0);
        }
        let step = round_step((to - from) / steps);
        if round_ends {
            (from, to) = ((from / step + 1e-9).floor() * step, (to / step - 1e-9).ceil() * step);
        }
        Scale { from, to, step, kind: AxisScale::Linear }
    }

    fn for_axis(kind: AxisScale, values: impl Iterator<Item = f64>, steps: f64, round_ends: bool) -> Scale {
        let scale = Scale::new(values.map(|value| kind.position(value)), steps, round_ends);
        match kind {
            AxisScale::Linear => scale,
            AxisScale::Whole => Scale { step: scale.step.max(1.0), kind, ..scale },
            AxisScale::Logarithmic if round_ends => {
                Scale { from: scale.from.floor(), to: scale.to.ceil(), kind, ..scale }
            }
            AxisScale::Logarithmic => Scale { kind, ..scale },
        }
    }

    pub(super) fn share(&self, value: f64) -> f64 {
        ((self.kind.position(value) - self.from) / (self.to - self.from)).clamp(0.0, 1.0)
    }

    pub(super) fn ticks(&self) -> Vec<f64> {
        if self.kind == AxisScale::Logarithmic {
            return self.decade_ticks();
        }
        let first = (self.from / self.step - 1e-9).ceil() as i64;
        let last = (self.to / self.step + 1e-9).floor() as i64;
        (first..=last).map(|at| at as f64 * self.step).collect()
    }

    /// Returns the powers of ten in the range. If there are few of them, also returns twice and five times each power.
    fn decade_ticks(&self) -> Vec<f64> {
        let factors: &[f64] = if self.to - self.from <= 3.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let decades = self.from.floor() as i32..=self.to.ceil() as i32;
        let all = decades.flat_map(|decade| {
            let power = libm::pow(10.0, f64::from(decade));
            factors.iter().map(move |factor| factor * power)
        });
        let inside = |value: &f64| (self.from - 1e-9..=self.to + 1e-9).contains(&libm::log10(*value));
        all.filter(inside).collect()
    }
}

/// Returns the smallest step of the form 1, 2 or 5 times a power of ten that is at least `min`.
fn round_step(min: f64) -> f64 {
    let magnitude = libm::pow(10.0, libm::floor(libm::log10(min)));
    let fitting = [1.0, 2.0, 5.0, 10.0].into_iter().find(|step| step * magnitude >= min * 0.999);
    fitting.unwrap_or(10.0) * magnitude
}

struct PlotLayout {
    x: Scale,
    y: Scale,
    top: f64,
}

impl PlotLayout {
    fn x_position(&self, value: f64) -> f64 {
        LEFT + self.x.share(value) * (WIDTH - LEFT - RIGHT)
    }

    fn y_position(&self, value: f64) -> f64 {
        self.top + (1.0 - self.y.share(value)) * PLOT_HEIGHT
    }
}

/// Draws a chart as SVG for a page. Element IDs contain `number` to be unique on the page.
pub fn draw(chart: &Chart, number: usize) -> String {
    let (inside, height) = draw_plot(chart, REPORT_AXES);
    format!(
        "<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-labelledby=\"t{number} d{number}\">\n\
         <title id=\"t{number}\">{}</title>\n<desc id=\"d{number}\">{}</desc>\n{inside}</svg>\n",
        escape_html(&chart.title),
        escape_html(&chart.summary)
    )
}

/// Style sheet of self-contained files. It uses plain colors, which every SVG viewer supports.
const STYLE: &str = include_str!("../../assets/chart.css");

/// Draws charts below each other in one self-contained SVG file, without external scripts or fonts.
pub fn standalone_svg(title: &str, parts: &[ScaledChart]) -> String {
    const HEADER_HEIGHT: f64 = 30.0;
    let (mut all, mut below) = (String::new(), 10.0);
    for (at, part) in parts.iter().enumerate() {
        let (inside, height) = draw_plot(&part.chart, part.axes);
        let _ = writeln!(
            all,
            "<g transform=\"translate(0 {below})\" role=\"img\" aria-labelledby=\"t{at} d{at}\">\n\
             <title id=\"t{at}\">{name}</title>\n<desc id=\"d{at}\">{}</desc>\n\
             <text class=\"name\" x=\"{LEFT}\" y=\"16\">{name}</text>\n<g transform=\"translate(0 {HEADER_HEIGHT})\">\n{inside}</g>\n</g>",
            escape_html(&part.chart.summary),
            name = escape_html(&part.chart.title)
        );
        below += height + HEADER_HEIGHT + 10.0;
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {below}\" width=\"{WIDTH}\" height=\"{below}\" \
         font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\">\n<title>{}</title>\n<style>\n{STYLE}</style>\n\
         <rect class=\"paper\" width=\"{WIDTH}\" height=\"{below}\"/>\n{all}</svg>\n",
        escape_html(title)
    )
}

fn draw_plot(chart: &Chart, kinds: AxisScales) -> (String, f64) {
    let keys = legend_keys(chart);
    let (mut svg, rows) = draw_legend(&keys);
    let sheet = PlotLayout {
        x: x_scale(chart, kinds.x),
        y: y_scale(chart, kinds.y),
        top: 10.0 + rows * LEGEND_ROW_HEIGHT,
    };
    draw_axes(&mut svg, chart, &sheet);
    match &chart.plot {
        Plot::Lines { curves, band } => {
            band.iter().for_each(|band| draw_band(&mut svg, band, &sheet));
            curves.iter().enumerate().for_each(|(at, curve)| draw_curve(&mut svg, curve, at, &sheet));
        }
        Plot::Stacks { positions: at, series: parts } => draw_stacks(&mut svg, at, parts, chart, &sheet),
    }
    (svg, sheet.top + PLOT_HEIGHT + BOTTOM)
}

/// Returns the smallest distance between neighboring bars, which limits the width of a bar.
fn bar_spacing(at: &[f64]) -> f64 {
    let min = at.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(f64::INFINITY, f64::min);
    if min.is_finite() && min > 0.0 { min } else { 1.0 }
}

fn x_scale(chart: &Chart, kind: AxisScale) -> Scale {
    let values: Vec<f64> = match &chart.plot {
        Plot::Lines { curves, band } => {
            let band_values = band.iter().flat_map(|band| band.points.iter().map(|point| point.0));
            curves
                .iter()
                .flat_map(|curve| curve.points.iter().map(|point| point.0))
                .chain(band_values)
                .collect()
        }
        // The first and the last bar extend beyond the range by half a bar width.
        Plot::Stacks { positions: at, .. } => {
            let half = bar_spacing(at) / 2.0;
            at.iter().flat_map(|place| [place - half, place + half]).collect()
        }
    };
    Scale::for_axis(kind, values.into_iter(), 8.0, false)
}

fn y_scale(chart: &Chart, kind: AxisScale) -> Scale {
    let mut values: Vec<f64> = match &chart.plot {
        Plot::Lines { curves, band } => {
            let band_values =
                band.iter().flat_map(|band| band.points.iter().flat_map(|point| [point.1, point.2]));
            curves
                .iter()
                .flat_map(|curve| curve.points.iter().map(|point| point.1))
                .chain(band_values)
                .collect()
        }
        Plot::Stacks { positions: at, series: parts } => {
            let sum = |bar: usize, up: bool| -> f64 {
                parts.iter().map(|part| part.values[bar]).filter(|value| (*value > 0.0) == up).sum()
            };
            (0..at.len()).flat_map(|bar| [sum(bar, true), sum(bar, false)]).chain([0.0]).collect()
        }
    };
    if let Some((low, high)) = chart.y_limits {
        values.iter_mut().for_each(|value| *value = value.clamp(low, high));
    }
    let max = values.iter().copied().fold(0.0, f64::max);
    let min = values.iter().copied().fold(f64::INFINITY, f64::min);
    // Zero is included if the smallest value is less than half of the largest value.
    if min > 0.0 && min < 0.5 * max {
        values.push(0.0);
    }
    Scale::for_axis(kind, values.into_iter(), 5.0, true)
}

fn draw_axes(svg: &mut String, chart: &Chart, sheet: &PlotLayout) {
    let label = |value: f64| if chart.is_in_dollars { format_dollar_tick(value) } else { format_tick(value) };
    let right = WIDTH - RIGHT;
    for value in sheet.y.ticks() {
        let y = sheet.y_position(value);
        let class = if value == 0.0 { "zero" } else { "grid" };
        let _ = writeln!(
            svg,
            "<line class=\"{class}\" x1=\"{LEFT}\" y1=\"{y:.1}\" x2=\"{right}\" y2=\"{y:.1}\"/>"
        );
        let _ = writeln!(
            svg,
            "<text class=\"label end\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            LEFT - 8.0,
            y + 4.0,
            escape_html(&label(value))
        );
    }
    let below = sheet.top + PLOT_HEIGHT + 16.0;
    for value in sheet.x.ticks() {
        let x = sheet.x_position(value);
        let _ = writeln!(
            svg,
            "<text class=\"label middle\" x=\"{x:.1}\" y=\"{below:.1}\">{}</text>",
            format_tick(value)
        );
    }
    let middle = LEFT + (WIDTH - LEFT - RIGHT) / 2.0;
    let _ = writeln!(
        svg,
        "<text class=\"label middle\" x=\"{middle:.1}\" y=\"{:.1}\">{}</text>",
        below + 18.0,
        escape_html(chart.x_label)
    );
}

fn draw_curve(svg: &mut String, curve: &Curve, at: usize, sheet: &PlotLayout) {
    let has_place =
        |(x, y): &&(f64, f64)| sheet.x.kind.position(*x).is_finite() && sheet.y.kind.position(*y).is_finite();
    let points: Vec<String> = curve
        .points
        .iter()
        .filter(has_place)
        .map(|(x, y)| format!("{:.1},{:.1}", sheet.x_position(*x), sheet.y_position(*y)))
        .collect();
    let _ = writeln!(
        svg,
        "<polyline class=\"line s{}\" points=\"{}\"><title>{}</title></polyline>",
        at + 1,
        points.join(" "),
        escape_html(&curve.name)
    );
}

fn draw_band(svg: &mut String, band: &Band, sheet: &PlotLayout) {
    let upper = band.points.iter().map(|(x, _, upper)| (x, upper));
    let lower = band.points.iter().rev().map(|(x, lower, _)| (x, lower));
    let points: Vec<String> = upper
        .chain(lower)
        .map(|(x, y)| format!("{:.1},{:.1}", sheet.x_position(*x), sheet.y_position(*y)))
        .collect();
    let _ = writeln!(
        svg,
        "<polygon class=\"band\" points=\"{}\"><title>{}</title></polygon>",
        points.join(" "),
        escape_html(&band.name)
    );
}

fn draw_stacks(svg: &mut String, at: &[f64], parts: &[StackSeries], chart: &Chart, sheet: &PlotLayout) {
    let width = bar_spacing(at) * (WIDTH - LEFT - RIGHT) / (sheet.x.to - sheet.x.from) * 0.8;
    let write = |value: f64| if chart.is_in_dollars { format_money(value) } else { format_whole(value) };
    for (bar, place) in at.iter().enumerate() {
        let (mut up, mut down) = (0.0, 0.0);
        for (number, part) in parts.iter().enumerate() {
            let value = part.values[bar];
            if value == 0.0 {
                continue;
            }
            let from = if value > 0.0 { up } else { down };
            let (top, bottom) = (
                sheet.y_position(f64::max(from, from + value)),
                sheet.y_position(f64::min(from, from + value)),
            );
            if value > 0.0 {
                up += value
            } else {
                down += value
            }
            let _ = writeln!(
                svg,
                "<rect class=\"part f{}\" x=\"{:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{:.1}\"><title>{} {}: {} {}</title></rect>",
                number + 1,
                sheet.x_position(*place) - width / 2.0,
                (bottom - top).max(0.0),
                escape_html(chart.x_label),
                place,
                escape_html(&part.name),
                write(value)
            );
        }
    }
}

enum LegendMark {
    Line(usize),
    Area(String),
}

fn legend_keys(chart: &Chart) -> Vec<(LegendMark, String)> {
    match &chart.plot {
        Plot::Lines { curves, band } => {
            let lines =
                curves.iter().enumerate().map(|(at, curve)| (LegendMark::Line(at + 1), curve.name.clone()));
            lines
                .chain(band.iter().map(|band| (LegendMark::Area("band".to_owned()), band.name.clone())))
                .collect()
        }
        Plot::Stacks { series: parts, .. } => {
            let sign = |at: usize| LegendMark::Area(format!("part f{}", at + 1));
            parts.iter().enumerate().map(|(at, part)| (sign(at), part.name.clone())).collect()
        }
    }
}

fn draw_legend(keys: &[(LegendMark, String)]) -> (String, f64) {
    let mut svg = String::new();
    let (mut x, mut row) = (LEFT, 0.0);
    for (sign, name) in keys {
        let width = 34.0 + name.chars().count() as f64 * LEGEND_LETTER_WIDTH + 18.0;
        if x + width > WIDTH && x > LEFT {
            (x, row) = (LEFT, row + 1.0);
        }
        let y = 12.0 + row * LEGEND_ROW_HEIGHT;
        let _ = match sign {
            LegendMark::Line(at) => writeln!(
                svg,
                "<line class=\"line s{at}\" x1=\"{x:.1}\" y1=\"{y:.1}\" x2=\"{:.1}\" y2=\"{y:.1}\"/>",
                x + 26.0
            ),
            LegendMark::Area(class) => writeln!(
                svg,
                "<rect class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\" width=\"14\" height=\"12\"/>",
                x + 12.0,
                y - 6.0
            ),
        };
        let _ = writeln!(
            svg,
            "<text class=\"label\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            x + 33.0,
            y + 4.0,
            escape_html(name)
        );
        x += width;
    }
    (svg, row + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_have_round_steps() {
        let scale = Scale::new([3.0, 97.0].into_iter(), 5.0, true);
        assert_eq!(scale.ticks(), [0.0, 20.0, 40.0, 60.0, 80.0, 100.0]);
        let below = Scale::new([-1_200_000.0, 800_000.0].into_iter(), 5.0, true);
        assert_eq!((below.from, below.to, below.step), (-1_500_000.0, 1_000_000.0, 500_000.0));
        assert_eq!(Scale::new(std::iter::empty(), 5.0, true).ticks().len(), 6);
        let flat = Scale::new([7.0, 7.0].into_iter(), 5.0, true);
        assert!(flat.from < 7.0 && flat.to > 7.0);
    }

    #[test]
    fn chart_values_increase_upwards() {
        let scale = || Scale { from: -10.0, to: 30.0, step: 10.0, kind: AxisScale::Linear };
        let sheet = PlotLayout { x: scale(), y: scale(), top: 20.0 };
        let places = [30.0, 10.0, -10.0, 99.0].map(|value| sheet.y_position(value));
        assert_eq!(places, [20.0, 20.0 + PLOT_HEIGHT / 2.0, 20.0 + PLOT_HEIGHT, 20.0]);
    }

    #[test]
    fn chart_coordinates_are_inside_the_drawing() {
        let wild = Curve {
            name: "a<b".to_owned(),
            points: vec![(0.0, 1.0), (1.0, 1e12), (2.0, f64::NAN), (3.0, -5.0)],
        };
        let chart = Chart {
            title: "t".to_owned(),
            summary: "s".to_owned(),
            x_label: "day",
            is_in_dollars: true,
            y_limits: Some((0.0, 10.0)),
            plot: Plot::Lines { curves: vec![wild], band: None },
        };
        let svg = draw(&chart, 1);
        assert!(svg.contains("a&lt;b") && !svg.contains("NaN"), "{svg}");
        let points = svg.split("points=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("points");
        for point in points.split(' ') {
            let (x, y) = point.split_once(',').expect("two coordinates");
            let (x, y): (f64, f64) = (x.parse().expect("x"), y.parse().expect("y"));
            assert!((0.0..=WIDTH).contains(&x) && (0.0..=300.0).contains(&y), "{point}");
        }
    }

    fn attribute(tag: &str, name: &str) -> f64 {
        let (_, rest) = tag.split_once(&format!(" {name}=\"")).unwrap_or_else(|| panic!("{name} in {tag}"));
        rest.split('"').next().expect("a value").parse().unwrap_or_else(|_| panic!("{name} in {tag}"))
    }

    type Ticks = Vec<(f64, f64)>;

    fn ticks(svg: &str) -> (Ticks, Ticks) {
        let label = |text: &str| -> Option<f64> {
            text.split('>').nth(1)?.split('<').next()?.replace(['$', ','], "").parse().ok()
        };
        let lines: Vec<&str> = svg.lines().collect();
        let down = lines.windows(2).filter(|pair| {
            pair[0].starts_with("<line class=\"grid") || pair[0].starts_with("<line class=\"zero")
        });
        let down = down.filter_map(|pair| Some((label(pair[1])?, attribute(pair[0], "y1")))).collect();
        let across = lines.iter().filter(|line| line.starts_with("<text class=\"label middle"));
        let across = across.filter_map(|line| Some((label(line)?, attribute(line, "x")))).collect();
        (down, across)
    }

    fn coordinate_of(ticks: &[(f64, f64)], value: f64) -> f64 {
        ticks
            .iter()
            .find(|(tick, _)| *tick == value)
            .unwrap_or_else(|| panic!("no tick {value}: {ticks:?}"))
            .1
    }

    fn points(svg: &str, class: &str) -> Vec<(f64, f64)> {
        let tag = svg.split(&format!("class=\"{class}\" points=\"")).nth(1).expect("a curve");
        let pair = |point: &str| {
            let (x, y) = point.split_once(',').expect("two coordinates");
            (x.parse().expect("x"), y.parse().expect("y"))
        };
        tag.split('"').next().expect("points").split(' ').map(pair).collect()
    }

    fn chart(plot: Plot) -> Chart {
        Chart {
            title: "t".to_owned(),
            summary: "s".to_owned(),
            x_label: "week",
            is_in_dollars: false,
            y_limits: None,
            plot,
        }
    }

    #[test]
    fn curves_and_bands_match_the_axes() {
        let values = [(0.0, 0.0), (4.0, 50.0), (6.0, -50.0), (10.0, 100.0)];
        let band: Vec<(f64, f64, f64)> = values.iter().map(|(x, y)| (*x, *y, 100.0)).collect();
        let curve = Curve { name: "c".to_owned(), points: values.to_vec() };
        let second = Curve { name: "d".to_owned(), points: vec![(2.0, 50.0), (8.0, 0.0)] };
        let band = Band { name: "b".to_owned(), points: band };
        let svg = draw(&chart(Plot::Lines { curves: vec![curve, second], band: Some(band) }), 1);
        let (down, across) = ticks(&svg);
        let expected = |points: &[(f64, f64)]| -> Vec<(f64, f64)> {
            points.iter().map(|(x, y)| (coordinate_of(&across, *x), coordinate_of(&down, *y))).collect()
        };
        assert_eq!(points(&svg, "line s1"), expected(&values));
        assert_eq!(points(&svg, "line s2"), expected(&[(2.0, 50.0), (8.0, 0.0)]));
        let upper = values.iter().map(|(x, _)| (*x, 100.0));
        let around: Vec<(f64, f64)> = upper.chain(values.into_iter().rev()).collect();
        assert_eq!(points(&svg, "band"), expected(&around));
        // The ticks of both axes must be evenly spaced and increase in the correct direction.
        assert!(down.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 > pair[1].1), "{down:?}");
        assert!(across.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 < pair[1].1), "{across:?}");
    }

    #[test]
    fn stacked_bar_heights_match_values() {
        let part =
            |name: &str, values: [f64; 2]| StackSeries { name: name.to_owned(), values: values.to_vec() };
        let parts = vec![part("a", [40.0, 0.0]), part("b", [20.0, 60.0]), part("c", [-20.0, -40.0])];
        let svg = draw(&chart(Plot::Stacks { positions: vec![1.0, 2.0], series: parts }), 1);
        let (down, across) = ticks(&svg);
        let bars: Vec<(f64, f64, f64)> = svg
            .lines()
            .filter(|line| line.starts_with("<rect class=\"part f") && line.contains("<title>"))
            .map(|tag| {
                let (top, height) = (attribute(tag, "y"), attribute(tag, "height"));
                (attribute(tag, "x") + attribute(tag, "width") / 2.0, top, top + height)
            })
            .collect();
        let expected =
            [(1.0, 40.0, 0.0), (1.0, 60.0, 40.0), (1.0, 0.0, -20.0), (2.0, 60.0, 0.0), (2.0, 0.0, -40.0)];
        assert_eq!(bars.len(), expected.len());
        for ((middle, top, bottom), (week, high, low)) in bars.into_iter().zip(expected) {
            assert!((middle - coordinate_of(&across, week)).abs() < 0.11, "week {week}: {middle}");
            // Coordinates have one decimal.
            assert!((top - coordinate_of(&down, high)).abs() < 0.11, "{high} in week {week}: {top}");
            assert!((bottom - coordinate_of(&down, low)).abs() < 0.16, "{low} in week {week}: {bottom}");
        }
    }

    #[test]
    fn decades_are_evenly_spaced_on_log_axis() {
        let scale = Scale::for_axis(AxisScale::Logarithmic, [3.0, 70_000.0].into_iter(), 5.0, true);
        assert_eq!(scale.ticks(), [1.0, 10.0, 100.0, 1e3, 1e4, 1e5]);
        let shares: Vec<f64> = scale.ticks().into_iter().map(|value| scale.share(value)).collect();
        assert!(shares.windows(2).all(|pair| (pair[1] - pair[0] - 0.2).abs() < 1e-12), "{shares:?}");
        let few = Scale::for_axis(AxisScale::Logarithmic, [10.0, 100.0].into_iter(), 5.0, true);
        assert_eq!(few.ticks(), [10.0, 20.0, 50.0, 100.0]);
    }

    #[test]
    fn standalone_svg_includes_style_and_separates_charts() {
        let curve = Curve { name: "c".to_owned(), points: vec![(0.0, 0.0), (0.5, 1.0)] };
        let part = || ScaledChart {
            chart: chart(Plot::Lines { curves: vec![curve.clone()], band: None }),
            axes: AxisScales { x: AxisScale::Linear, y: AxisScale::Linear },
        };
        let svg = standalone_svg("a & b", &[part(), part()]);
        assert!(svg.starts_with("<svg xmlns=") && svg.contains("<title>a &amp; b</title>"), "{svg}");
        assert!(svg.contains(".s1 {") && !svg.contains("var("), "the style is complete");
        let heads: Vec<&str> =
            svg.lines().filter(|line| line.starts_with("<g transform=\"translate(0 ")).collect();
        assert_eq!(heads.len(), 4, "{svg}");
        // A linear axis also has labels at fractions.
        assert!(svg.contains(">0.10<") || svg.contains(">0.1<"), "{svg}");
    }
}
