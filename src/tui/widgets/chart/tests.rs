use ratatui::symbols::Marker;

use super::*;
use crate::render_rows;

fn drawn(plot: &Plot<'_>, width: u16, height: u16, marker: Marker) -> Vec<String> {
    render_rows(width, height, |canvas, area| {
        canvas.marker = marker;
        plot.draw(canvas, area);
    })
}

fn plot<'a>(lines: &'a [Curve], band: Option<&'a Band>) -> Plot<'a> {
    let x = &XAxis { format: &day, required_values: &[] };
    let y = &YAxis { unit: AxisUnit::Dollars, required_values: &[] };
    Plot { curves: lines, band, marked_x: None, x, y }
}

fn day(day: f64) -> String {
    format!("day {day:.0}")
}

#[test]
fn axis_labels_are_round_and_within_the_data() {
    let rising: Vec<f64> = (0..=252).map(|day| f64::from(day) * 40_000.0).collect();
    let lines = [Curve::from_values(&rising, Role::Text).with_name("cash")];
    let picture = drawn(&plot(&lines, None), 60, 14, Marker::Braille);
    let text = picture.join("\n");
    let days =
        |picture: &[String]| picture.last().expect("a row").split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(days(&picture), "day 0 day 50 day 100 day 150 day 200 day 250", "{text}");
    for label in ["$0┤", "$5M┤", "$10M┤"] {
        assert!(picture.iter().any(|line| line.trim_start().starts_with(label)), "{label} in\n{text}");
    }
    assert!(picture[0].ends_with("cash"), "{text}");
    let small = drawn(&plot(&lines, None), 24, 6, Marker::Braille);
    assert_eq!(days(&small), "day 0 day 200", "{}", small.join("\n"));
}

#[test]
fn every_marker_draws_the_same_curve() {
    let lines = [Curve::from_values(&[0.0, 1.0], Role::Text)];
    for (marker, glyphs) in
        [(Marker::Braille, "⡠⠊⠔⠁⢀⠈⠑⠤⠒⡔⠜⠎"), (Marker::HalfBlock, "▀▄█"), (Marker::Dot, "•")]
    {
        let picture = drawn(&plot(&lines, None), 30, 8, marker);
        let count = |line: &String| line.chars().filter(|glyph| glyphs.contains(*glyph)).count();
        assert!(picture.iter().map(count).sum::<usize>() >= 6, "{}", picture.join("\n"));
    }
}

#[test]
fn curve_names_have_separate_rows() {
    let lines = [
        Curve::from_values(&[1.0, 2.0, 3.0], Role::Text).with_name("one"),
        Curve::from_values(&[1.0, 2.0, 3.0], Role::Text).with_name("two"),
    ];
    let band = Band { bounds: vec![(1.0, 1.0, 2.0), (2.0, 2.0, 4.0)], name: "95 %" };
    let picture = drawn(&plot(&lines, Some(&band)), 60, 12, Marker::Braille);
    let text = picture.join("\n");
    assert!(picture.iter().any(|line| line.contains("░░░")), "{text}");
    assert!(!picture.iter().any(|line| line.chars().take(20).any(|glyph| glyph == '░')), "{text}");
    for name in ["one", "two", "95 %"] {
        assert_eq!(picture.iter().filter(|line| line.ends_with(name)).count(), 1, "{text}");
    }
    assert_eq!(
        (band.bounds_at(0.5), band.bounds_at(1.5), band.bounds_at(2.5)),
        (None, Some((1.5, 3.0)), None)
    );
}

#[test]
fn charts_without_points_or_with_extreme_values_are_drawn() {
    let nothing = drawn(&plot(&[], None), 60, 8, Marker::Braille);
    assert!(nothing[0].starts_with("no data"));
    let one =
        drawn(&plot(&[Curve::from_values(&[5.0], Role::Text)], None), 60, 8, Marker::Braille).join("\n");
    assert!(one.contains('•') && one.contains("$0┤"), "{one}");
    let zeros =
        drawn(&plot(&[Curve::from_values(&[0.0; 9], Role::Text)], None), 60, 8, Marker::Braille).join("\n");
    assert!(zeros.contains("$0┤") && zeros.contains("$1┤") && !zeros.contains('-'), "{zeros}");
    for values in [[f64::NAN, 1.0, 1.0], [1e300, -1e300, 0.0], [0.0, 1e-300, 0.0], [5.0, 5.0, 5.0]] {
        for (width, height) in [(16, 4), (17, 5), (60, 20), (300, 60)] {
            drawn(&plot(&[Curve::from_values(&values, Role::Text)], None), width, height, Marker::Braille);
        }
    }
}

#[test]
fn summary_is_as_long_as_its_width_allows() {
    let values = [3.0, 1.0, 2.0];
    let write = |value: f64| format!("{value:.0}");
    assert_eq!(summary(&values, &write, 80), "2 ▲ 1 · min 1 · max 3");
    assert_eq!(summary(&values, &write, 8), "2 ▲ 1");
    assert_eq!(summary(&values, &write, 2), "2");
    assert_eq!(summary(&[], &write, 80), "no data yet");
}

#[test]
fn steep_bands_have_no_gaps() {
    let lines = [Curve::from_values(&[0.0; 2], Role::Text)];
    let band = Band { bounds: vec![(0.0, 0.0, 0.0), (20.0, 0.9e6, 1.0e6), (22.0, 0.1e6, 0.2e6)], name: "" };
    let picture = drawn(&plot(&lines, Some(&band)), 40, 20, Marker::Braille);
    let cell = |column: usize, row: usize| picture[row].chars().nth(column) == Some('░');
    let rows = |column: usize| (0..18).filter(|row| cell(column, *row)).collect::<Vec<_>>();
    let columns: Vec<usize> = (8..40).filter(|column| !rows(*column).is_empty()).collect();
    assert!(columns.len() > 20, "{}", picture.join("\n"));
    for pair in columns.windows(2) {
        let (left, right) = (rows(pair[0]), rows(pair[1]));
        let touch = left.iter().any(|row| right.iter().any(|other| row.abs_diff(*other) <= 1));
        assert!(pair[1] == pair[0] + 1 && touch, "{}", picture.join("\n"));
    }
}

#[test]
fn wide_band_is_cut_and_marked() {
    let lines = [Curve::from_values(&[8e6, 9e6, 10e6, 9e6], Role::Text).with_name("cash")];
    let wide = Band { bounds: vec![(3.0, 9e6, 9e6), (6.0, -50e6, 60e6)], name: "95 %" };
    let picture = drawn(&plot(&lines, Some(&wide)), 60, 14, Marker::Braille);
    let text = picture.join("\n");
    assert!(text.contains('▲') && text.contains('▼'), "{text}");
    assert!(!text.contains("$60M") && !text.contains("-$50M"), "{text}");
    let narrow = Band { bounds: vec![(3.0, 9e6, 9e6), (6.0, 8e6, 11e6)], name: "95 %" };
    let picture = drawn(&plot(&lines, Some(&narrow)), 60, 14, Marker::Braille).join("\n");
    assert!(picture.contains('░') && !picture.contains('▲') && !picture.contains('▼'), "{picture}");
}

#[test]
fn band_around_a_constant_curve_is_not_cut() {
    let lines = [Curve::from_values(&[1e6, 1e6], Role::Text)];
    let band = Band { bounds: vec![(1.0, 1e6, 1e6), (2.0, 0.9e6, 1.1e6)], name: "95 %" };
    let picture = drawn(&plot(&lines, Some(&band)), 60, 14, Marker::Braille).join("\n");
    assert!(picture.contains('░') && !picture.contains('▲') && !picture.contains('▼'), "{picture}");
}
