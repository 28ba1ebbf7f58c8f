//! SVG drawings of a class. All students are drawn in grey. The style of the page highlights one student.

use std::fmt::Write;

use super::curves::StudentPoints;
use crate::formatting::format_tick;
use crate::svg::Scale;
use novamind_base::formatting::escape_html;

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 340.0;
const LEFT: f64 = 66.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 44.0;

pub(super) struct PointDrawing<'a> {
    pub title: String,
    /// Label of the horizontal axis.
    pub x_label: String,
    /// Lines or points to draw.
    pub points: &'a [StudentPoints<'a>],
    /// Whether lines connect the points of a student.
    pub is_line: bool,
    /// Whether the diagonal is drawn, on which both values are equal.
    pub has_diagonal: bool,
}

/// Draws the lines or points as SVG. `class_of` returns the CSS class and the title of a student's marks.
pub(super) fn draw(
    drawing: &PointDrawing<'_>,
    class_of: &dyn Fn(&str) -> Option<(String, String)>,
) -> String {
    let all = || drawing.points.iter().flat_map(|student_points| &student_points.points).copied();
    let both = drawing.has_diagonal;
    let across = all().flat_map(|(x, y)| if both { vec![x, y] } else { vec![x] });
    let up = all().flat_map(|(x, y)| if both { vec![x, y] } else { vec![y] });
    let (x, y) = (Scale::new(across, 8.0, both || !drawing.is_line), Scale::new(up, 5.0, true));
    let column = |value: f64| LEFT + x.share(value) * (WIDTH - LEFT - RIGHT);
    let row = |value: f64| TOP + (1.0 - y.share(value)) * (HEIGHT - TOP - BOTTOM);
    let title = escape_html(&drawing.title);
    let mut svg = format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{title}\">\n");
    for value in y.ticks() {
        let at = row(value);
        let _ = writeln!(
            svg,
            "<line class=\"grid\" x1=\"{LEFT}\" y1=\"{at:.1}\" x2=\"{:.1}\" y2=\"{at:.1}\"/><text class=\"label end\" \
             x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            WIDTH - RIGHT,
            LEFT - 8.0,
            at + 4.0,
            escape_html(&format_tick(value))
        );
    }
    let below = HEIGHT - BOTTOM + 16.0;
    for value in x.ticks() {
        let _ = writeln!(
            svg,
            "<text class=\"label middle\" x=\"{:.1}\" y=\"{below:.1}\">{}</text>",
            column(value),
            escape_html(&format_tick(value))
        );
    }
    let _ = writeln!(
        svg,
        "<text class=\"label middle\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
        LEFT + (WIDTH - LEFT - RIGHT) / 2.0,
        below + 18.0,
        escape_html(&drawing.x_label)
    );
    if both {
        let (from, to) = (x.from.max(y.from), x.to.min(y.to));
        let _ = writeln!(
            svg,
            "<line class=\"zero\" x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\"/>",
            column(from),
            row(from),
            column(to),
            row(to)
        );
    }
    // Later marks cover earlier ones. The reference play covers the students, and the highlighted student covers the
    // reference play.
    let (good, students): (Vec<_>, Vec<_>) =
        drawing.points.iter().partition(|student_points| student_points.label.is_none());
    for student_points in students.into_iter().chain(good) {
        let (class, name) = match student_points.label {
            None => ("good".to_owned(), "reference play".to_owned()),
            Some(label) => match class_of(label) {
                Some(named) => named,
                None => continue,
            },
        };
        let finite = || student_points.points.iter().filter(|(x, y)| x.is_finite() && y.is_finite());
        let name = escape_html(&name);
        if drawing.is_line {
            let points: Vec<String> =
                finite().map(|(x, y)| format!("{:.1},{:.1}", column(*x), row(*y))).collect();
            let _ = writeln!(
                svg,
                "<polyline class=\"curve {class}\" points=\"{}\"><title>{name}</title></polyline>",
                points.join(" ")
            );
        } else {
            for (x, y) in finite() {
                let _ = writeln!(
                    svg,
                    "<circle class=\"dot {class}\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"5\"><title>{name}</title></circle>",
                    column(*x),
                    row(*y)
                );
            }
        }
    }
    svg.push_str("</svg>\n");
    svg
}
