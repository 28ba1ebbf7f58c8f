//! Lines and points as text: all of them pale, one lit.

use crate::notation::compact;

/// Columns of the drawing.
const WIDTH: usize = 70;
/// Lines of the drawing.
const HEIGHT: usize = 14;

/// Something that is drawn with a sign; later ones are drawn over earlier ones.
pub(super) struct Drawn<'a> {
    /// The sign.
    pub sign: char,
    /// Where it goes.
    pub points: &'a [(f64, f64)],
    /// Whether points are joined.
    pub is_line: bool,
}

/// Draws; empty where there is nothing.
pub(super) fn plot(drawn: &[Drawn<'_>]) -> String {
    let all = || drawn.iter().flat_map(|own| own.points).filter(|(x, y)| x.is_finite() && y.is_finite());
    let Some((left, right)) = reach(all().map(|point| point.0)) else { return String::new() };
    let Some((low, high)) = reach(all().map(|point| point.1)) else { return String::new() };
    let mut cells = vec![vec![' '; WIDTH]; HEIGHT];
    let place = |share: f64, size: usize| ((share * (size - 1) as f64).round() as usize).min(size - 1);
    let mut put = |x: f64, y: f64, sign: char| {
        let column = place((x - left) / (right - left), WIDTH);
        let row = HEIGHT - 1 - place((y - low) / (high - low), HEIGHT);
        cells[row][column] = sign;
    };
    for own in drawn {
        for point in own.points.iter().filter(|(x, y)| x.is_finite() && y.is_finite()) {
            put(point.0, point.1, own.sign);
        }
        for pair in own.points.windows(2).filter(|_| own.is_line) {
            for at in 0..=WIDTH {
                let share = at as f64 / WIDTH as f64;
                let (x, y) = (between(pair[0].0, pair[1].0, share), between(pair[0].1, pair[1].1, share));
                if x.is_finite() && y.is_finite() {
                    put(x, y, own.sign);
                }
            }
        }
    }
    let mut text = String::new();
    for (at, row) in cells.iter().enumerate() {
        let label = match at {
            0 => compact(high),
            at if at == HEIGHT - 1 => compact(low),
            _ => String::new(),
        };
        text += format!("{label:>9} |{}", row.iter().collect::<String>()).trim_end();
        text.push('\n');
    }
    let width = WIDTH - compact(left).chars().count();
    text + &format!("{:>10} {}{:>width$}\n", "", compact(left), compact(right))
}

fn between(from: f64, to: f64, share: f64) -> f64 {
    from + (to - from) * share
}

/// From the least to the greatest value, a little apart; none where there is none.
fn reach(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (least, most) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), own| (least.min(own), most.max(own)));
    (least <= most).then_some(if most - least < 1e-9 { (least - 1.0, most + 1.0) } else { (least, most) })
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
        assert_eq!(rows.len(), HEIGHT + 1);
        assert!(rows[0].starts_with("      100 |#") && rows[0].ends_with('.'), "{text}");
        assert!(rows[HEIGHT - 1].trim_end().ends_with('#'), "{text}");
        assert_eq!(plot(&[]), "");
        assert!(plot(&[line('.', &[(1.0, 1.0)])]).contains('.'), "one point has a place");
    }
}
