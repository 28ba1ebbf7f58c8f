//! Text charts made of lines, points and bars.

use unicode_width::UnicodeWidthStr;

use super::formatting::format_tick;
use novamind_base::formatting::compact_number;

/// How values are mapped to positions on an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisScale {
    /// Positions are proportional to values.
    Linear,
    /// Linear scale with labels only at whole numbers, for days and weeks.
    Whole,
    /// Logarithmic scale. Values that are not positive are not drawn.
    Logarithmic,
}

impl AxisScale {
    /// Returns the name of the scale in machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            AxisScale::Linear | AxisScale::Whole => "linear",
            AxisScale::Logarithmic => "logarithmic",
        }
    }

    /// Maps a value to its position on the axis. Returns NaN if the scale cannot show the value.
    pub fn position(self, value: f64) -> f64 {
        match self {
            AxisScale::Linear | AxisScale::Whole => value,
            AxisScale::Logarithmic if value > 0.0 => libm::log10(value),
            AxisScale::Logarithmic => f64::NAN,
        }
    }
}

/// Size and axes of a text chart.
pub struct PlotArea {
    /// Width in characters, including labels.
    pub width: usize,
    /// Height in lines, excluding the labels below the chart.
    pub height: usize,
    /// Scale of the horizontal axis.
    pub x_scale: AxisScale,
    /// Scale of the vertical axis.
    pub y_scale: AxisScale,
}

const REPORT_AREA: PlotArea =
    PlotArea { width: 81, height: 14, x_scale: AxisScale::Linear, y_scale: AxisScale::Linear };

const LABEL_WIDTH: usize = 11;

/// Bar heights of a sparkline, lowest first.
pub const SPARKLINE_CHARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// Returns the sparkline character for a share from 0 to 1.
pub fn sparkline_char(share: f64) -> char {
    let highest = SPARKLINE_CHARS.len() - 1;
    SPARKLINE_CHARS[((share * highest as f64).round() as usize).min(highest)]
}

/// A series of points that are drawn with the same character. Later series cover earlier ones.
pub struct PlotSeries<'a> {
    /// Character that represents the points.
    pub mark: char,
    /// Points of the series, as horizontal and vertical values.
    pub points: &'a [(f64, f64)],
    /// Whether lines connect the points.
    pub is_line: bool,
}

pub(super) fn plot_report(drawn: &[PlotSeries<'_>]) -> String {
    plot_in(&REPORT_AREA, drawn)
}

/// Draws series in a frame. Returns an empty text if there are no points.
pub fn plot_in(frame: &PlotArea, drawn: &[PlotSeries<'_>]) -> String {
    let (columns, rows) = (frame.width.saturating_sub(LABEL_WIDTH).max(8), frame.height.max(2));
    let scale_point = |(x, y): &(f64, f64)| (frame.x_scale.position(*x), frame.y_scale.position(*y));
    let all = || {
        let points = drawn.iter().flat_map(|plot_series| plot_series.points);
        points.filter(|point| scale_point(point).0.is_finite() && scale_point(point).1.is_finite())
    };
    let Some((left, right)) = padded_range(all().map(|point| point.0)) else { return String::new() };
    let Some((low, high)) = padded_range(all().map(|point| point.1)) else { return String::new() };
    let (from, to) = (scale_point(&(left, low)), scale_point(&(right, high)));
    let mut cells = vec![vec![' '; columns]; rows];
    let place = |share: f64, size: usize| ((share * (size - 1) as f64).round() as usize).min(size - 1);
    let mut put = |x: f64, y: f64, sign: char| {
        if x.is_finite() && y.is_finite() {
            let column = place((x - from.0) / (to.0 - from.0), columns);
            let row = rows - 1 - place((y - from.1) / (to.1 - from.1), rows);
            cells[row][column] = sign;
        }
    };
    for series in drawn {
        let points: Vec<(f64, f64)> = series.points.iter().map(scale_point).collect();
        points.iter().for_each(|(x, y)| put(*x, *y, series.mark));
        for pair in points.windows(2).filter(|_| series.is_line) {
            for at in 0..=columns {
                let share = at as f64 / columns as f64;
                put(
                    interpolate(pair[0].0, pair[1].0, share),
                    interpolate(pair[0].1, pair[1].1, share),
                    series.mark,
                );
            }
        }
    }
    let mut text = String::new();
    for (at, row) in cells.iter().enumerate() {
        let label = match at {
            0 => compact_number(high),
            at if at == rows - 1 => compact_number(low),
            _ => String::new(),
        };
        text += format!("{label:>9} |{}", row.iter().collect::<String>()).trim_end();
        text.push('\n');
    }
    let width = columns.saturating_sub(compact_number(left).chars().count());
    text + &format!("{:>10} {}{:>width$}\n", "", compact_number(left), compact_number(right))
}

/// Draws horizontal bars. Each bar has its label on the left and its value on the right.
pub fn horizontal_bars(points: &[(f64, f64)], width: usize) -> String {
    let max = points.iter().map(|point| point.1).filter(|value| value.is_finite()).fold(0.0, f64::max);
    let (labels, values): (Vec<String>, Vec<String>) =
        points.iter().map(|(x, y)| (format_tick(*x), compact_number(*y))).unzip();
    let widest = |texts: &[String]| texts.iter().map(|text| text.width()).max().unwrap_or(0);
    let (before, behind) = (widest(&labels), widest(&values));
    let room = width.saturating_sub(before + behind + 3).max(4);
    let mut text = String::new();
    for ((point, label), value) in points.iter().zip(&labels).zip(&values) {
        let length = if max > 0.0 { (point.1.max(0.0) / max * room as f64).round() as usize } else { 0 };
        text += &format!("{label:>before$} │{} {value}\n", "█".repeat(length.min(room)));
    }
    text
}

fn interpolate(from: f64, to: f64, share: f64) -> f64 {
    from + (to - from) * share
}

/// Returns the range of the values, or `None` if there are no values. If all values are equal, returns a wider range
/// around them.
fn padded_range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (min, max) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), value| (min.min(value), max.max(value)));
    let is_range_wide = max - min > 1e-9 * max.abs().max(min.abs()).min(1.0);
    (min <= max).then_some(match min {
        _ if is_range_wide => (min, max),
        // A positive value is multiplied, so that the lower endpoint is also positive and a logarithmic scale can show
        // it.
        level if level > 0.0 => (0.5 * level, 1.5 * level),
        level => (level - 1.0, level + 1.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plotted_line_spans_the_corners_and_later_series_are_on_top() {
        let (pale, lit) = ([(0.0, 0.0), (10.0, 100.0)], [(0.0, 100.0), (10.0, 0.0)]);
        let line = |sign, points| PlotSeries { mark: sign, points, is_line: true };
        let text = plot_report(&[line('.', &pale), line('#', &lit)]);
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(rows.len(), REPORT_AREA.height + 1);
        assert!(rows[0].starts_with("      100 |#") && rows[0].ends_with('.'), "{text}");
        assert!(rows[REPORT_AREA.height - 1].trim_end().ends_with('#'), "{text}");
        assert_eq!(plot_report(&[]), "");
        assert!(plot_report(&[line('.', &[(1.0, 1.0)])]).contains('.'), "a single point is drawn");
    }

    #[test]
    fn plotted_power_law_is_straight_on_log_axes() {
        let points: Vec<(f64, f64)> =
            (0..=4).map(|at| libm::pow(10.0, f64::from(at))).map(|x| (x, x * x)).collect();
        let scale = AxisScale::Logarithmic;
        let frame = PlotArea { width: LABEL_WIDTH + 21, height: 21, x_scale: scale, y_scale: scale };
        let text = plot_in(&frame, &[PlotSeries { mark: '*', points: &points, is_line: true }]);
        for (at, row) in text.lines().take(21).enumerate() {
            assert_eq!(row.find('*').map(|place| place - LABEL_WIDTH), Some(20 - at), "{text}");
        }
        assert!(text.lines().all(|line| line.chars().count() <= frame.width), "{text}");
        let nothing = [(0.0, 1.0), (-1.0, 5.0)];
        assert_eq!(plot_in(&frame, &[PlotSeries { mark: '*', points: &nothing, is_line: true }]), "");
    }

    #[test]
    fn bar_length_is_proportional() {
        let text = horizontal_bars(&[(1.0, 10.0), (2.0, 5.0), (3.0, 0.0)], 30);
        let lengths: Vec<usize> = text.lines().map(|line| line.matches('█').count()).collect();
        assert_eq!(lengths, [24, 12, 0], "{text}");
        assert!(text.lines().all(|line| line.width() <= 30), "{text}");
    }
}
