//! Lines, points and bars as text.

use unicode_width::UnicodeWidthStr;

use super::words::tick;
use novamind_base::notation::compact;

/// How values are placed on an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisScale {
    /// Evenly.
    Linear,
    /// Evenly, and only whole numbers are labelled: days, weeks.
    Whole,
    /// By their logarithms; values of zero and below have no place.
    Logarithmic,
}

impl AxisScale {
    /// Its name for programs.
    pub fn name(self) -> &'static str {
        match self {
            AxisScale::Linear | AxisScale::Whole => "linear",
            AxisScale::Logarithmic => "logarithmic",
        }
    }

    /// Where a value stands on a ruler; not a number where it has no place.
    pub fn placed(self, value: f64) -> f64 {
        match self {
            AxisScale::Linear | AxisScale::Whole => value,
            AxisScale::Logarithmic if value > 0.0 => libm::log10(value),
            AxisScale::Logarithmic => f64::NAN,
        }
    }
}

/// The room of a drawing.
pub struct Frame {
    /// Letters across, labels included.
    pub width: usize,
    /// Lines without the labels below.
    pub height: usize,
    /// The axis below.
    pub across: AxisScale,
    /// The axis to the left.
    pub up: AxisScale,
}

/// What the drawings of reports have.
const OF_REPORTS: Frame = Frame { width: 81, height: 14, across: AxisScale::Linear, up: AxisScale::Linear };

/// Letters of the labels to the left and of the axis.
const LABELS: usize = 11;

/// Heights of a curve in one row, the lowest first.
pub const LEVELS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// The height of a share, 0 to 1, in a curve in one row.
pub fn level(share: f64) -> char {
    let highest = LEVELS.len() - 1;
    LEVELS[((share * highest as f64).round() as usize).min(highest)]
}

/// Something that is drawn with a sign; later ones are drawn over earlier ones.
pub struct Drawn<'a> {
    /// The sign.
    pub sign: char,
    /// Where it goes.
    pub points: &'a [(f64, f64)],
    /// Whether points are joined.
    pub is_line: bool,
}

/// Draws; empty where there is nothing.
pub(super) fn plot(drawn: &[Drawn<'_>]) -> String {
    plot_in(&OF_REPORTS, drawn)
}

/// Draws in a room; empty where there is nothing.
pub fn plot_in(frame: &Frame, drawn: &[Drawn<'_>]) -> String {
    let (columns, rows) = (frame.width.saturating_sub(LABELS).max(8), frame.height.max(2));
    let placed = |(x, y): &(f64, f64)| (frame.across.placed(*x), frame.up.placed(*y));
    let all = || {
        let points = drawn.iter().flat_map(|own| own.points);
        points.filter(|own| placed(own).0.is_finite() && placed(own).1.is_finite())
    };
    let Some((left, right)) = reach(all().map(|point| point.0)) else { return String::new() };
    let Some((low, high)) = reach(all().map(|point| point.1)) else { return String::new() };
    let (from, to) = (placed(&(left, low)), placed(&(right, high)));
    let mut cells = vec![vec![' '; columns]; rows];
    let place = |share: f64, size: usize| ((share * (size - 1) as f64).round() as usize).min(size - 1);
    let mut put = |x: f64, y: f64, sign: char| {
        if x.is_finite() && y.is_finite() {
            let column = place((x - from.0) / (to.0 - from.0), columns);
            let row = rows - 1 - place((y - from.1) / (to.1 - from.1), rows);
            cells[row][column] = sign;
        }
    };
    for own in drawn {
        let points: Vec<(f64, f64)> = own.points.iter().map(placed).collect();
        points.iter().for_each(|(x, y)| put(*x, *y, own.sign));
        for pair in points.windows(2).filter(|_| own.is_line) {
            for at in 0..=columns {
                let share = at as f64 / columns as f64;
                put(between(pair[0].0, pair[1].0, share), between(pair[0].1, pair[1].1, share), own.sign);
            }
        }
    }
    let mut text = String::new();
    for (at, row) in cells.iter().enumerate() {
        let label = match at {
            0 => compact(high),
            at if at == rows - 1 => compact(low),
            _ => String::new(),
        };
        text += format!("{label:>9} |{}", row.iter().collect::<String>()).trim_end();
        text.push('\n');
    }
    let width = columns.saturating_sub(compact(left).chars().count());
    text + &format!("{:>10} {}{:>width$}\n", "", compact(left), compact(right))
}

/// Bars lying under each other, each with its place before and its value behind it.
pub fn bars(points: &[(f64, f64)], width: usize) -> String {
    let most = points.iter().map(|point| point.1).filter(|own| own.is_finite()).fold(0.0, f64::max);
    let (labels, values): (Vec<String>, Vec<String>) =
        points.iter().map(|(x, y)| (tick(*x), compact(*y))).unzip();
    let widest = |texts: &[String]| texts.iter().map(|text| text.width()).max().unwrap_or(0);
    let (before, behind) = (widest(&labels), widest(&values));
    let room = width.saturating_sub(before + behind + 3).max(4);
    let mut text = String::new();
    for ((point, label), value) in points.iter().zip(&labels).zip(&values) {
        let length = if most > 0.0 { (point.1.max(0.0) / most * room as f64).round() as usize } else { 0 };
        text += &format!("{label:>before$} │{} {value}\n", "█".repeat(length.min(room)));
    }
    text
}

fn between(from: f64, to: f64, share: f64) -> f64 {
    from + (to - from) * share
}

/// From the least to the greatest value, a little apart; none where there is none.
fn reach(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (least, most) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), own| (least.min(own), most.max(own)));
    let apart = most - least > 1e-9 * most.abs().max(least.abs()).min(1.0);
    (least <= most).then_some(match least {
        _ if apart => (least, most),
        // A level above zero keeps a logarithm.
        level if level > 0.0 => (0.5 * level, 1.5 * level),
        level => (level - 1.0, level + 1.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_goes_from_corner_to_corner_and_the_lit_one_lies_above() {
        let (pale, lit) = ([(0.0, 0.0), (10.0, 100.0)], [(0.0, 100.0), (10.0, 0.0)]);
        let line = |sign, points| Drawn { sign, points, is_line: true };
        let text = plot(&[line('.', &pale), line('#', &lit)]);
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(rows.len(), OF_REPORTS.height + 1);
        assert!(rows[0].starts_with("      100 |#") && rows[0].ends_with('.'), "{text}");
        assert!(rows[OF_REPORTS.height - 1].trim_end().ends_with('#'), "{text}");
        assert_eq!(plot(&[]), "");
        assert!(plot(&[line('.', &[(1.0, 1.0)])]).contains('.'), "one point has a place");
    }

    #[test]
    fn a_power_is_a_straight_line_where_both_axes_are_logarithmic() {
        let points: Vec<(f64, f64)> =
            (0..=4).map(|at| libm::pow(10.0, f64::from(at))).map(|x| (x, x * x)).collect();
        let scale = AxisScale::Logarithmic;
        let frame = Frame { width: LABELS + 21, height: 21, across: scale, up: scale };
        let text = plot_in(&frame, &[Drawn { sign: '*', points: &points, is_line: true }]);
        for (at, row) in text.lines().take(21).enumerate() {
            assert_eq!(row.find('*').map(|place| place - LABELS), Some(20 - at), "{text}");
        }
        assert!(text.lines().all(|line| line.chars().count() <= frame.width), "{text}");
        let nothing = [(0.0, 1.0), (-1.0, 5.0)];
        assert_eq!(plot_in(&frame, &[Drawn { sign: '*', points: &nothing, is_line: true }]), "");
    }

    #[test]
    fn bars_are_as_long_as_their_values() {
        let text = bars(&[(1.0, 10.0), (2.0, 5.0), (3.0, 0.0)], 30);
        let lengths: Vec<usize> = text.lines().map(|line| line.matches('█').count()).collect();
        assert_eq!(lengths, [24, 12, 0], "{text}");
        assert!(text.lines().all(|line| line.width() <= 30), "{text}");
    }
}
