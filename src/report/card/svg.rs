//! The card as a self-contained SVG, without external styles, scripts or fonts.

use std::fmt::Write;

use super::{Card, LabeledFigure};
use crate::formatting::format_dollar_tick;
use novamind_base::formatting::escape_html;

/// Common size of pictures that are shared on social media, pixels.
const SIZE: (f64, f64) = (1200.0, 630.0);
const MARGIN: f64 = 60.0;
const CURVE_TOP_AND_BOTTOM: (f64, f64) = (200.0, 400.0);
const MAX_CURVE_POINTS: usize = 360;

const BACKGROUND_COLOR: &str = "#14171c";
const TEXT_COLOR: &str = "#eceff3";
const SECONDARY_COLOR: &str = "#9aa3ae";
const CURVE_COLOR: &str = "#2fa3b5";
const MARK_COLOR: &str = "#e0b04a";

pub fn draw(card: &Card) -> String {
    let (width, height) = SIZE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         role=\"img\" aria-labelledby=\"t d\" font-family=\"'Segoe UI','Helvetica Neue',Arial,sans-serif\">\n\
         <title id=\"t\">{}</title>\n<desc id=\"d\">{}</desc>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"{BACKGROUND_COLOR}\"/>\n",
        escape_html(&card.headline),
        escape_html(&describe_card(card))
    );
    draw_text(&mut svg, (MARGIN, 62.0), 24.0, CURVE_COLOR, true, "NovaMind");
    if let Some(voice) = card.voice {
        draw_text(&mut svg, (MARGIN + 150.0, 62.0), 18.0, SECONDARY_COLOR, false, voice);
    }
    draw_text(&mut svg, (MARGIN, 132.0), 54.0, TEXT_COLOR, true, &card.headline);
    if let Some(rank) = &card.rank {
        draw_text(&mut svg, (MARGIN, 170.0), 24.0, SECONDARY_COLOR, false, rank);
    }
    draw_curve(&mut svg, card);
    draw_figures(&mut svg, 462.0, &card.turning_points);
    draw_figures(&mut svg, 538.0, &card.numbers);
    draw_text(&mut svg, (MARGIN, 610.0), 18.0, SECONDARY_COLOR, false, &card.source);
    svg.push_str("</svg>\n");
    svg
}

fn describe_card(card: &Card) -> String {
    let facts = card.turning_points.iter().chain(&card.numbers);
    facts.map(|fact| format!("{}: {}", fact.name, fact.value)).collect::<Vec<_>>().join("; ")
}

fn draw_text(svg: &mut String, (x, y): (f64, f64), size: f64, colour: &str, bold: bool, words: &str) {
    let weight = if bold { " font-weight=\"bold\"" } else { "" };
    let _ = writeln!(
        svg,
        "<text x=\"{x:.0}\" y=\"{y:.0}\" font-size=\"{size:.0}\" fill=\"{colour}\"{weight}>{}</text>",
        escape_html(words)
    );
}

fn draw_figures(svg: &mut String, y: f64, facts: &[LabeledFigure]) {
    for (at, fact) in facts.iter().enumerate() {
        let x = MARGIN + at as f64 * 370.0;
        draw_text(svg, (x, y), 30.0, TEXT_COLOR, true, &fact.value);
        draw_text(svg, (x, y + 26.0), 18.0, SECONDARY_COLOR, false, &fact.name);
    }
}

fn point_position(card: &Card, day: usize, max: f64) -> (f64, f64) {
    let last = card.cash_by_day.len().saturating_sub(1).max(1) as f64;
    let share = (card.cash_by_day[day] / max).clamp(0.0, 1.0);
    (
        MARGIN + day as f64 / last * (SIZE.0 - 2.0 * MARGIN),
        CURVE_TOP_AND_BOTTOM.1 - share * (CURVE_TOP_AND_BOTTOM.1 - CURVE_TOP_AND_BOTTOM.0),
    )
}

fn draw_curve(svg: &mut String, card: &Card) {
    let max = card.cash_by_day.iter().copied().fold(1.0, f64::max);
    let last = card.cash_by_day.len().saturating_sub(1);
    let step = card.cash_by_day.len().div_ceil(MAX_CURVE_POINTS).max(1);
    let mut days: Vec<usize> = (0..card.cash_by_day.len()).step_by(step).collect();
    if days.last().is_some_and(|number| *number < last) {
        days.push(last);
    }
    let points: Vec<String> = days
        .into_iter()
        .map(|day| {
            let (x, y) = point_position(card, day, max);
            format!("{x:.1},{y:.1}")
        })
        .collect();
    let (left, right) = (MARGIN, SIZE.0 - MARGIN);
    let points = points.join(" ");
    let _ = writeln!(
        svg,
        "<line x1=\"{left}\" y1=\"{0}\" x2=\"{right}\" y2=\"{0}\" stroke=\"{SECONDARY_COLOR}\"/>",
        CURVE_TOP_AND_BOTTOM.1
    );
    let _ = writeln!(
        svg,
        "<polyline points=\"{points}\" fill=\"none\" stroke=\"{CURVE_COLOR}\" stroke-width=\"4\" stroke-linejoin=\"round\"/>"
    );
    for day in card.marks.iter().map(|day| *day as usize).filter(|day| *day <= last) {
        if card.cash_by_day.is_empty() {
            break;
        }
        let (x, y) = point_position(card, day, max);
        let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"7\" fill=\"{MARK_COLOR}\"/>");
    }
    draw_text(
        svg,
        (left, CURVE_TOP_AND_BOTTOM.0 - 8.0),
        16.0,
        SECONDARY_COLOR,
        false,
        &format_dollar_tick(max),
    );
    draw_text(svg, (left, CURVE_TOP_AND_BOTTOM.1 + 20.0), 16.0, SECONDARY_COLOR, false, "day 0");
    let _ = writeln!(
        svg,
        "<text x=\"{right}\" y=\"{}\" font-size=\"16\" fill=\"{SECONDARY_COLOR}\" text-anchor=\"end\">day {last}</text>",
        CURVE_TOP_AND_BOTTOM.1 + 20.0
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample_card(cash: &[f64], marks: &[u32]) -> Card {
        let fact = |value: &str| LabeledFigure { value: value.to_owned(), name: "n".to_owned() };
        Card {
            headline: "h".to_owned(),
            rank: None,
            cash_by_day: cash.to_vec(),
            marks: marks.to_vec(),
            turning_points: vec![fact("a")],
            numbers: ["b", "c", "d"].map(fact),
            voice: None,
            source: "s".to_owned(),
        }
    }

    #[test]
    fn card_curve_follows_cash() {
        let svg = draw(&sample_card(&[100.0, 50.0, 0.0, 25.0], &[0, 2]));
        assert!(svg.contains("points=\"60.0,200.0 420.0,300.0 780.0,400.0 1140.0,350.0\""), "{svg}");
        assert!(
            svg.contains("cx=\"60.0\" cy=\"200.0\"") && svg.contains("cx=\"780.0\" cy=\"400.0\""),
            "{svg}"
        );
        assert!(svg.contains("width=\"1200\" height=\"630\""));
    }

    #[test]
    fn card_is_drawn_for_every_run() {
        for cash in [&[][..], &[-3.0][..], &[0.0, 0.0][..], &[1e9; 700][..]] {
            let svg = draw(&sample_card(cash, &[0, 900]));
            assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.ends_with("</svg>\n"), "{svg}");
        }
    }
}
