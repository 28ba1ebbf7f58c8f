//! The start page with its choices and the state of the last run.

use ratatui::layout::Rect;

use super::runs::{draw_preview, progress_label, run_facts};
use super::{RunPreviews, StartMenu};
use novamind_base::formatting::dollars;
use novamind_record::folder::runs::RunSummary;
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum HomeEntry {
    Continue,
    Tour,
    New,
    Lessons,
    Handout,
    Class,
    Runs,
    Compare,
    PublishedResults,
    Quit,
}

/// Minimum width of the window for showing the last run next to the choices.
const MIN_WIDTH_FOR_LAST_RUN: u16 = 76;

impl StartMenu {
    /// Returns the choices of the page. The list is empty until the runs are known, because the runs determine the
    /// first choice.
    pub(super) fn entries(&self) -> Vec<(HomeEntry, &'static str, String)> {
        let mut choices = Vec::new();
        if self.runs.is_none() {
            return choices;
        }
        let count = self.runs().len();
        if let Some(run) = self.last_played_run() {
            let title = if run.ended.is_none() { "Continue" } else { "Open last run" };
            choices.push((HomeEntry::Continue, title, run_summary(run)));
        }
        let words = match self.tour_run() {
            Some(_) => "Continues its run",
            None => "New here? Five minutes in a company",
        };
        let tour = (HomeEntry::Tour, "Tour", words.to_owned());
        let known = matches!(self.runs, Some(Ok(_)));
        let newcomer = known && count == 0;
        if newcomer {
            choices.push(tour.clone());
        }
        choices.push((HomeEntry::New, "New run", "500 days from one million dollars".to_owned()));
        if count > 0 {
            let text =
                if count == 1 { "1 on this machine".to_owned() } else { format!("{count} on this machine") };
            choices.push((HomeEntry::Runs, "Runs", text));
        }
        if count > 1 {
            choices.push((HomeEntry::Compare, "Compare runs", "Two or more runs side by side".to_owned()));
        }
        choices.push((HomeEntry::PublishedResults, "Paper table", "Published results and yours".to_owned()));
        if !newcomer {
            choices.push(tour);
        }
        choices.push((HomeEntry::Lessons, "Lessons", "One idea each, 12 to 25 minutes".to_owned()));
        choices.push((HomeEntry::Handout, "Handout", "Your file, such as S07.nm".to_owned()));
        choices.push((HomeEntry::Class, "Class", "Your students' results".to_owned()));
        choices.push((HomeEntry::Quit, "Quit", "Confirmed actions are saved".to_owned()));
        choices
    }

    pub(super) fn draw_home(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let left = if area.width >= MIN_WIDTH_FOR_LAST_RUN {
            (area.width * 2 / 5).clamp(36, 48)
        } else {
            area.width
        };
        let used = self.draw_entries(canvas, Rect { width: left, ..area });
        if area.width >= MIN_WIDTH_FOR_LAST_RUN {
            let right = Rect { x: area.x + left + 1, width: area.width - left - 1, ..area };
            self.draw_last_run(canvas, right);
        } else {
            let below = Rect { y: area.y + used, height: area.height.saturating_sub(used), ..area };
            if below.height >= 4 {
                self.draw_last_run(canvas, below);
            }
        }
    }

    /// Draws the choices and returns the number of rows.
    fn draw_entries(&self, canvas: &mut Canvas<'_>, area: Rect) -> u16 {
        let choices = self.entries();
        let count = choices.len() as u16;
        let each = [3, 2].into_iter().find(|each| count * each <= area.height).unwrap_or(1);
        for (at, (_, title, detail)) in choices.iter().enumerate() {
            let y = area.y + at as u16 * each;
            if y >= area.bottom() {
                break;
            }
            let row = Rect { y, height: 1, ..area };
            let here = at == self.selected;
            if here {
                canvas.clear(row, Role::Selection);
            }
            let mark = if here { "›" } else { " " };
            canvas.draw_text(
                row,
                &format!("{mark} {title}"),
                if here { Role::Selection } else { Role::Strong },
            );
            let place = match each {
                1 => Rect { x: row.x + 16, width: row.width.saturating_sub(16), ..row },
                _ => Rect { x: row.x + 2, y: row.y + 1, width: row.width.saturating_sub(2), ..row },
            };
            let role = if here && each == 1 { Role::Selection } else { Role::Dim };
            canvas.draw_text(place, detail, role);
            canvas.register_click(Rect { height: each.min(area.bottom() - y), ..row }, Click::Row(0, at));
        }
        count * each
    }

    fn draw_last_run(&self, canvas: &mut Canvas<'_>, area: Rect) {
        match &self.runs {
            None => {
                let inside = canvas.draw_pane_frame(area, "Last run", "", false);
                canvas.draw_text(inside, " looking for runs …", Role::Dim);
            }
            Some(Err(problem)) => {
                let inside = canvas.draw_pane_frame(area, "Runs", "", false);
                for (row, line) in row_rects(inside).zip(wrap(&format!("! {problem}"), inside.width as usize))
                {
                    canvas.draw_text(row, &line, Role::Bad);
                }
            }
            Some(Ok(list)) => match list.first() {
                Some(run) => draw_run(canvas, area, "Last run", run, &self.previews),
                None => draw_welcome(canvas, area),
            },
        }
    }
}

pub(super) fn draw_run(
    canvas: &mut Canvas<'_>,
    area: Rect,
    title: &str,
    run: &RunSummary,
    previews: &RunPreviews,
) {
    let inside = canvas.draw_pane_frame(area, title, &progress_label(run), false);
    let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
    let known = previews.get(&run.id).and_then(Option::as_ref);
    let facts = run_facts(run, known);
    let is_flat = inside.width >= 70 && inside.height < 14;
    let (above, below) = if is_flat {
        let left = Rect { width: 42, ..inside };
        (left, Rect { x: inside.x + 43, width: inside.width - 43, ..inside })
    } else {
        let used = (facts.len() as u16 + 1).min(inside.height);
        (inside, Rect { y: inside.y + used, height: inside.height - used, ..inside })
    };
    for (row, (name, value)) in row_rects(above).zip(&facts) {
        canvas.draw_text(Rect { width: 13.min(row.width), ..row }, name, Role::Dim);
        let place = Rect { x: row.x + 13, width: row.width.saturating_sub(13), ..row };
        canvas.draw_text(place, value, Role::Text);
    }
    draw_preview(canvas, below, known, run.problem.is_some());
}

fn draw_welcome(canvas: &mut Canvas<'_>, area: Rect) {
    let inside = canvas.draw_pane_frame(area, "About", "", false);
    let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
    let parts = [
        "You run a company that sells an AI subscription. The company starts with a million dollars and no customers.",
        "Once a week you set prices, models, quotas, capacity, advertising and development, answer enterprises, and \
         forecast your cash. Then seven days are simulated.",
        "Customers, competitors and the economy react. Screens and tables show all available information.",
        "Your score is the cash after the last day. If cash falls below zero, the run ends.",
        "You can quit at any time. Confirmed actions are saved.",
    ];
    let text = parts.join("\n\n");
    for (row, line) in row_rects(inside).zip(wrap(&text, inside.width as usize)) {
        canvas.draw_text(row, &line, Role::Text);
    }
}

fn run_summary(run: &RunSummary) -> String {
    format!("{} · {}", progress_label(run), dollars(run.cash))
}
