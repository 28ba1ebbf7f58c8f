//! The card as a self-contained SVG, without external styles, scripts or fonts.

use std::fmt::Write;

use super::{Card, CardFigure};
use crate::words::dollar_tick;
use novamind_base::notation::escaped_html;

/// Common size of shared pictures.
const SIZE: (f64, f64) = (1200.0, 630.0);
const EDGE: f64 = 60.0;
const CURVE: (f64, f64) = (200.0, 400.0);
const POINTS: usize = 360;

const PAPER: &str = "#14171c";
const INK: &str = "#eceff3";
const DIM: &str = "#9aa3ae";
const LINE: &str = "#2fa3b5";
const MARK: &str = "#e0b04a";

pub fn draw(card: &Card) -> String {
    let (width, height) = SIZE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         role=\"img\" aria-labelledby=\"t d\" font-family=\"'Segoe UI','Helvetica Neue',Arial,sans-serif\">\n\
         <title id=\"t\">{}</title>\n<desc id=\"d\">{}</desc>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"{PAPER}\"/>\n",
        escaped_html(&card.headline),
        escaped_html(&described(card))
    );
    text(&mut svg, (EDGE, 62.0), 24.0, LINE, true, "NovaMind");
    if let Some(voice) = card.voice {
        text(&mut svg, (EDGE + 150.0, 62.0), 18.0, DIM, false, voice);
    }
    text(&mut svg, (EDGE, 132.0), 54.0, INK, true, &card.headline);
    if let Some(rank) = &card.rank {
        text(&mut svg, (EDGE, 170.0), 24.0, DIM, false, rank);
    }
    curve(&mut svg, card);
    row(&mut svg, 462.0, &card.turning_points);
    row(&mut svg, 538.0, &card.numbers);
    text(&mut svg, (EDGE, 610.0), 18.0, DIM, false, &card.source);
    svg.push_str("</svg>\n");
    svg
}

fn described(card: &Card) -> String {
    let facts = card.turning_points.iter().chain(&card.numbers);
    facts.map(|fact| format!("{}: {}", fact.name, fact.value)).collect::<Vec<_>>().join("; ")
}

fn text(svg: &mut String, (x, y): (f64, f64), size: f64, colour: &str, bold: bool, words: &str) {
    let weight = if bold { " font-weight=\"bold\"" } else { "" };
    let _ = writeln!(
        svg,
        "<text x=\"{x:.0}\" y=\"{y:.0}\" font-size=\"{size:.0}\" fill=\"{colour}\"{weight}>{}</text>",
        escaped_html(words)
    );
}

fn row(svg: &mut String, y: f64, facts: &[CardFigure]) {
    for (at, fact) in facts.iter().enumerate() {
        let x = EDGE + at as f64 * 370.0;
        text(svg, (x, y), 30.0, INK, true, &fact.value);
        text(svg, (x, y + 26.0), 18.0, DIM, false, &fact.name);
    }
}

fn place(card: &Card, day: usize, most: f64) -> (f64, f64) {
    let last = card.cash_by_day.len().saturating_sub(1).max(1) as f64;
    let share = (card.cash_by_day[day] / most).clamp(0.0, 1.0);
    (EDGE + day as f64 / last * (SIZE.0 - 2.0 * EDGE), CURVE.1 - share * (CURVE.1 - CURVE.0))
}

fn curve(svg: &mut String, card: &Card) {
    let most = card.cash_by_day.iter().copied().fold(1.0, f64::max);
    let last = card.cash_by_day.len().saturating_sub(1);
    let step = card.cash_by_day.len().div_ceil(POINTS).max(1);
    let mut days: Vec<usize> = (0..card.cash_by_day.len()).step_by(step).collect();
    if days.last().is_some_and(|own| *own < last) {
        days.push(last);
    }
    let points: Vec<String> = days
        .into_iter()
        .map(|day| {
            let (x, y) = place(card, day, most);
            format!("{x:.1},{y:.1}")
        })
        .collect();
    let (left, right) = (EDGE, SIZE.0 - EDGE);
    let points = points.join(" ");
    let _ =
        writeln!(svg, "<line x1=\"{left}\" y1=\"{0}\" x2=\"{right}\" y2=\"{0}\" stroke=\"{DIM}\"/>", CURVE.1);
    let _ = writeln!(
        svg,
        "<polyline points=\"{points}\" fill=\"none\" stroke=\"{LINE}\" stroke-width=\"4\" stroke-linejoin=\"round\"/>"
    );
    for day in card.marks.iter().map(|day| *day as usize).filter(|day| *day <= last) {
        if card.cash_by_day.is_empty() {
            break;
        }
        let (x, y) = place(card, day, most);
        let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"7\" fill=\"{MARK}\"/>");
    }
    text(svg, (left, CURVE.0 - 8.0), 16.0, DIM, false, &dollar_tick(most));
    text(svg, (left, CURVE.1 + 20.0), 16.0, DIM, false, "day 0");
    let _ = writeln!(
        svg,
        "<text x=\"{right}\" y=\"{}\" font-size=\"16\" fill=\"{DIM}\" text-anchor=\"end\">day {last}</text>",
        CURVE.1 + 20.0
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn card(cash: &[f64], marks: &[u32]) -> Card {
        let fact = |value: &str| CardFigure { value: value.to_owned(), name: "n".to_owned() };
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
    fn the_curve_passes_where_the_cash_was() {
        let svg = draw(&card(&[100.0, 50.0, 0.0, 25.0], &[0, 2]));
        assert!(svg.contains("points=\"60.0,200.0 420.0,300.0 780.0,400.0 1140.0,350.0\""), "{svg}");
        assert!(
            svg.contains("cx=\"60.0\" cy=\"200.0\"") && svg.contains("cx=\"780.0\" cy=\"400.0\""),
            "{svg}"
        );
        assert!(svg.contains("width=\"1200\" height=\"630\""));
    }

    #[test]
    fn every_run_can_be_drawn() {
        for cash in [&[][..], &[-3.0][..], &[0.0, 0.0][..], &[1e9; 700][..]] {
            let svg = draw(&card(cash, &[0, 900]));
            assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.ends_with("</svg>\n"), "{svg}");
        }
    }
}
