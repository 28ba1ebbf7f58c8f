//! Panes of the page that shows the results of a class.

use ratatui::layout::Rect;

use super::{ClassPage, LowerPane};
use novamind_base::formatting::{compact_number, short_dollars};
use novamind_report::class::{
    ClassQuestion, ClassView, RankedStudent, StudentPoints, class_questions, describe_submission_count,
    format_score, pitfall_counts, rank_students, scatter, student_curves,
};
use novamind_report::pluralize;
use novamind_tui::canvas::{Align, Canvas, Click, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::{Curve, Plot, PointLabel, XAxis, YAxis, zero_if_near};
use novamind_tui::widgets::scale::AxisUnit;

/// Width of the ranking in narrow windows and in wide windows.
const RANKING_WIDTH: (u16, u16) = (29, 52);
/// Minimum window width for the ranking columns with tries, hints and pitfalls.
const MIN_WIDE_RANKING_WIDTH: u16 = 110;
/// Minimum window height for showing the guesses and the pitfalls in separate panes.
const MIN_HEIGHT_FOR_ALL_PANES: u16 = 34;
const HIGHLIGHT_SYMBOL: &str = "◆";

impl ClassPage {
    pub(in crate::screens::menu) fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let view = self.view();
        let ranking = rank_students(&view);
        let title =
            Rect { x: area.x + 1, width: area.width.saturating_sub(2), height: 1.min(area.height), ..area };
        canvas.draw_text(
            title,
            &format!("{} · {}", view.title(), describe_submission_count(&view)),
            Role::Title,
        );
        let body = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
        let width = if area.width >= MIN_WIDE_RANKING_WIDTH { RANKING_WIDTH.1 } else { RANKING_WIDTH.0 }
            .min(body.width);
        self.draw_ranking(canvas, Rect { width, ..body }, &view, &ranking);
        let right = Rect { x: body.x + width, width: body.width - width, ..body };
        let parts = if body.height >= MIN_HEIGHT_FOR_ALL_PANES { 3 } else { 2 };
        let height = right.height / parts;
        let at = |number: u16| {
            let height = if number + 1 == parts { right.height - number * height } else { height };
            Rect { y: right.y + number * (right.height / parts), height, ..right }
        };
        self.draw_curves(canvas, at(0), &view, &ranking);
        if parts == 2 {
            return match self.lower_pane {
                LowerPane::Scatter => self.draw_scatter(canvas, at(1), &view, &ranking),
                LowerPane::Guesses => self.draw_guesses(canvas, at(1), &view, &ranking),
                LowerPane::Pitfalls => draw_pitfalls(canvas, at(1), &view),
            };
        }
        self.draw_scatter(canvas, at(1), &view, &ranking);
        let last = at(2);
        let left = Rect { width: last.width / 2, ..last };
        self.draw_guesses(canvas, left, &view, &ranking);
        draw_pitfalls(canvas, Rect { x: left.right(), width: last.width - left.width, ..last }, &view);
    }

    fn draw_ranking(
        &self,
        canvas: &mut Canvas<'_>,
        area: Rect,
        view: &ClassView<'_>,
        ranking: &[RankedStudent<'_>],
    ) {
        let note = format!("{} of {}", ranking.len(), view.class.students.len());
        let inside = canvas.draw_pane_frame(area, "Ranking", &note, true);
        let is_wide = area.width == RANKING_WIDTH.1;
        let mut rows = row_rects(inside);
        let score = if view.lesson.is_some() { "vs ref." } else { "cash" };
        if let Some(row) = rows.next() {
            draw_cells(canvas, row, ["", "student", score, "goals", "tries", "hints"], is_wide, Role::Header);
        }
        let highlighted = self.highlighted_index(ranking);
        let measure = wrap(&format!("by {}", view.describe_measure()), inside.width as usize);
        // The figure that determines the ranking is named below the list if there are enough rows.
        let room = inside.height.saturating_sub(1);
        let for_measure = (measure.len() as u16 + 1).min(room.saturating_sub(ranking.len() as u16));
        let for_measure = if for_measure > measure.len() as u16 { for_measure } else { 0 };
        let shown = (room - for_measure) as usize;
        canvas.page_rows = shown as u16;
        let list = Rect { height: shown as u16, ..inside };
        let from = canvas.scroll_to_row(list, highlighted.unwrap_or(0), ranking.len());
        for (row, (at, student)) in rows.take(shown).zip(ranking.iter().enumerate().skip(from)) {
            let here = highlighted == Some(at);
            if here {
                canvas.clear(row, Role::Selection);
            }
            let cells = [
                (at + 1).to_string(),
                student.name.clone(),
                match view.lesson {
                    Some(_) => format_score(view, student),
                    None => short_dollars(student.score),
                },
                student.format_goals(),
                student.max_try().to_string(),
                student.hint_count().to_string(),
            ];
            let cells: [&str; 6] = std::array::from_fn(|at| cells[at].as_str());
            draw_cells(canvas, row, cells, is_wide, if here { Role::Selection } else { Role::Text });
            canvas.register_click(row, Click::Row(0, at));
        }
        if ranking.is_empty() {
            let row = Rect { y: inside.y + 1, height: room.min(1), ..inside };
            canvas.draw_text(row, " No student has finished", Role::Dim);
        }
        let below = Rect { y: inside.bottom() - for_measure, height: for_measure, ..inside };
        for (row, line) in row_rects(below).skip(1).zip(&measure) {
            canvas.draw_text(
                Rect { x: row.x + 1, width: row.width.saturating_sub(1), ..row },
                line,
                Role::Dim,
            );
        }
    }

    /// Returns the title of the part and the selected student, for the note of a pane.
    fn highlighted_student_text(
        &self,
        view: &ClassView<'_>,
        ranking: &[RankedStudent<'_>],
        sign: &str,
    ) -> String {
        let highlighted = self.highlighted_index(ranking).map(|at| format!("{} {sign}", ranking[at].name));
        let part = view.part_title(self.part).map(str::to_owned);
        part.into_iter().chain(highlighted).collect::<Vec<_>>().join(" · ")
    }

    fn draw_curves(
        &self,
        canvas: &mut Canvas<'_>,
        area: Rect,
        view: &ClassView<'_>,
        ranking: &[RankedStudent<'_>],
    ) {
        let inside = canvas.draw_pane_frame(
            area,
            "Cash by day",
            &self.highlighted_student_text(view, ranking, "selected"),
            false,
        );
        let all = student_curves(view, ranking, self.part);
        let mut lines: Vec<(u8, Curve)> = all
            .iter()
            .map(|student_points| {
                let line = |role| Curve::from_points(student_points.points.clone(), role);
                match student_points.label {
                    None => (1, line(Role::Series(1)).with_name("reference")),
                    label if label == self.shown.highlighted_student.as_deref() => {
                        (2, line(Role::Series(0)).with_name("selected"))
                    }
                    Some(_) => (0, line(Role::Dim)),
                }
            })
            .collect();
        lines.sort_by_key(|(place, _)| *place);
        let lines: Vec<Curve> = lines.into_iter().map(|(_, line)| line).collect();
        if lines.is_empty() {
            return canvas.draw_text(inside, " No student has finished this part", Role::Dim);
        }
        let zero = zero_if_near(lines.iter().flat_map(|line| line.points.iter().map(|point| point.1)));
        let x = XAxis { format: &|day| format!("day {day:.0}"), required_values: &[0.0] };
        Plot {
            curves: &lines,
            band: None,
            marked_x: None,
            x: &x,
            y: &YAxis { unit: AxisUnit::Dollars, required_values: zero },
        }
        .draw(canvas, inside);
    }

    /// Draws one point per student. The selected student has a special mark.
    fn draw_points(
        &self,
        canvas: &mut Canvas<'_>,
        area: Rect,
        points: &[StudentPoints<'_>],
        units: (&dyn Fn(f64) -> String, AxisUnit),
        diagonal: Option<[(f64, f64); 2]>,
    ) {
        let highlighted = |student_points: &&StudentPoints<'_>| {
            student_points.label == self.shown.highlighted_student.as_deref()
        };
        let others = points
            .iter()
            .filter(|series| !highlighted(series))
            .flat_map(|series| series.points.clone())
            .collect();
        let mine: Vec<(f64, f64)> =
            points.iter().filter(highlighted).flat_map(|series| series.points.clone()).collect();
        let scattered = |points, role| Curve { is_scatter: true, ..Curve::from_points(points, role) };
        let mut lines = vec![scattered(others, Role::Text), scattered(mine.clone(), Role::Series(0))];
        lines.extend(diagonal.map(|ends| Curve::from_points(ends.to_vec(), Role::Dim)));
        let sign = |(x, y): (f64, f64)| PointLabel { x, y, text: HIGHLIGHT_SYMBOL, role: Role::Series(0) };
        let signs: Vec<PointLabel> = mine.into_iter().map(sign).collect();
        let x = XAxis { format: units.0, required_values: &[] };
        let y = YAxis { unit: units.1, required_values: &[] };
        Plot { curves: &lines, band: None, marked_x: None, x: &x, y: &y }
            .draw_with_labels(canvas, area, &signs);
    }

    fn draw_scatter(
        &self,
        canvas: &mut Canvas<'_>,
        area: Rect,
        view: &ClassView<'_>,
        ranking: &[RankedStudent<'_>],
    ) {
        let found = scatter(view, ranking, self.part);
        let title = match &found {
            Some(scatter) => format!("{} by {}", scatter.figure, scatter.decision),
            None => "Decisions".to_owned(),
        };
        let inside = canvas.draw_pane_frame(
            area,
            &title,
            &self.highlighted_student_text(view, ranking, HIGHLIGHT_SYMBOL),
            false,
        );
        match found.filter(|scatter| !scatter.points.is_empty()) {
            Some(scatter) => {
                let unit = if scatter.figure == "cash" { AxisUnit::Dollars } else { AxisUnit::Number };
                self.draw_points(canvas, inside, &scatter.points, (&compact_number, unit), None);
            }
            None => canvas.draw_text(inside, " All students made the same decisions", Role::Dim),
        }
    }

    fn draw_guesses(
        &self,
        canvas: &mut Canvas<'_>,
        area: Rect,
        view: &ClassView<'_>,
        ranking: &[RankedStudent<'_>],
    ) {
        let all: Vec<ClassQuestion<'_>> = class_questions(view)
            .into_iter()
            .filter(|class_question| class_question.part == self.part && !class_question.answers.is_empty())
            .collect();
        let inside = canvas.draw_pane_frame(
            area,
            "Guesses",
            &self.highlighted_student_text(view, ranking, HIGHLIGHT_SYMBOL),
            false,
        );
        let Some(guesses) = all.get(self.question.min(all.len().saturating_sub(1))) else {
            return canvas.draw_text(inside, " No guesses", Role::Dim);
        };
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let number = match all.len() {
            1 => String::new(),
            all => format!("{}/{all} ", self.question + 1),
        };
        let question = wrap(&format!("{number}{}", guesses.question), inside.width as usize);
        let rows = (question.len() as u16).min(inside.height);
        for (row, line) in row_rects(inside).zip(&question) {
            canvas.draw_text(row, line, Role::Strong);
        }
        let rest = Rect { y: inside.y + rows, height: inside.height - rows, ..inside };
        if guesses.choices.is_empty() {
            self.draw_numeric_guesses(canvas, rest, guesses);
        } else {
            draw_choice_counts(canvas, rest, guesses);
        }
    }

    /// Draws guesses on the x axis and outcomes on the y axis.
    fn draw_numeric_guesses(&self, canvas: &mut Canvas<'_>, area: Rect, class_question: &ClassQuestion<'_>) {
        let points = class_question.points();
        let both = || class_question.answers.iter().flat_map(|answer| [answer.1, answer.2]);
        let (least, most) = both().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
            (least.min(value), most.max(value))
        });
        let head = Rect { height: 1.min(area.height), ..area };
        canvas.draw_text(head, "x: guess, y: outcome; exact guesses are on the line", Role::Dim);
        let chart = Rect { y: area.y + head.height, height: area.height - head.height, ..area };
        let diagonal = (most > least).then_some([(least, least), (most, most)]);
        self.draw_points(canvas, chart, &points, (&compact_number, AxisUnit::Number), diagonal);
    }
}

/// Draws the cells of a ranking row. Tries and hints are drawn only in wide windows.
fn draw_cells(canvas: &mut Canvas<'_>, row: Rect, cells: [&str; 6], is_wide: bool, role: Role) {
    let columns: [(u16, u16, Align); 6] = [
        (0, 3, Align::Right),
        (4, 8, Align::Left),
        (13, 7, Align::Right),
        (21, 5, Align::Right),
        (28, 6, Align::Right),
        (36, 6, Align::Right),
    ];
    for ((x, width, align), cell) in columns.into_iter().zip(cells).take(if is_wide { 6 } else { 4 }) {
        let place = Rect { x: row.x + x, width: width.min(row.width.saturating_sub(x)), ..row };
        canvas.draw_aligned(place, cell, role, align);
    }
}

fn draw_choice_counts(canvas: &mut Canvas<'_>, area: Rect, class_question: &ClassQuestion<'_>) {
    let mut rows = row_rects(area);
    for (number, choice) in (1..).zip(class_question.choices) {
        let taken = class_question.answers.iter().filter(|answer| answer.1 == f64::from(number)).count();
        let is_right = class_question.answers.iter().any(|answer| answer.2 == f64::from(number));
        let (sign, role) = if is_right { (" ✓", Role::Good) } else { ("", Role::Text) };
        let lines = wrap(&format!("{choice}{sign}"), area.width.saturating_sub(5) as usize);
        for (at, line) in lines.iter().enumerate() {
            let Some(row) = rows.next() else { return };
            if at == 0 {
                canvas.draw_aligned(
                    Rect { width: 3.min(row.width), ..row },
                    &taken.to_string(),
                    role,
                    Align::Right,
                );
            }
            canvas.draw_text(Rect { x: row.x + 5, width: row.width.saturating_sub(5), ..row }, line, role);
        }
    }
}

/// Draws the most common pitfall and the number of students with each pitfall.
fn draw_pitfalls(canvas: &mut Canvas<'_>, area: Rect, view: &ClassView<'_>) {
    let counts = pitfall_counts(view);
    let inside = canvas.draw_pane_frame(area, "Most common pitfall", "", false);
    let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
    let Some((most, others)) = counts.split_first() else {
        return canvas.draw_text(inside, "No pitfalls", Role::Dim);
    };
    let head = format!("{}, by {}", most.name, pluralize(most.students as u32, "student"));
    let mut lines = vec![(head, Role::Strong)];
    lines.extend(wrap(&most.explanation, inside.width as usize).into_iter().map(|line| (line, Role::Text)));
    lines.extend(
        others.iter().map(|pitfall_count| {
            (format!("{:>3}  {}", pitfall_count.students, pitfall_count.name), Role::Dim)
        }),
    );
    for (row, (line, role)) in row_rects(inside).zip(&lines) {
        canvas.draw_text(row, line, *role);
    }
}
