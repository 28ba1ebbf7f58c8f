//! List of runs, in which the user can open, compare, give up and delete runs.

use ratatui::layout::Rect;

use super::home::draw_run;
use super::{RunPreviews, StartMenu};
use crate::action::Action;
use crate::consent::{ConsentText, UNREAD_ERROR};
use crate::effect::Effect;
use novamind_base::formatting::{dollars, grouped_number};
use novamind_record::folder::preview::RunPreview;
use novamind_record::folder::runs::RunSummary;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::RunEndReason;
use novamind_session::{Access, NewRun, SeekTarget};
use novamind_tui::canvas::{Canvas, centered_rect, row_rects};
use novamind_tui::text::{format_count, wrap};
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::zero_if_near;
use novamind_tui::widgets::{AxisUnit, Curve, TableCell, TableColumn, XAxis, YAxis, draw_chart};
use novamind_worker::message::OpenFallback;
use novamind_worker::request::{RecordSource, Request};

/// A question that the user must answer before the menu continues.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum MenuQuestion {
    EndRun(String),
    Delete(String),
    /// Whether to use an alternative for a run that does not open. The text contains the reason.
    OpenError(OpenFallback, String),
    /// Whether the participant agrees to the consent text before the run starts.
    Consent(Box<NewRun>, ConsentText),
}

/// State of a run that another program is playing. If the user opens the run, the menu offers to watch the run.
const PLAYED_BY_PROGRAM: &str = "played by a program";

pub(super) const MAX_COMPARED_RUNS: usize = 6;

pub(super) fn columns() -> Vec<TableColumn> {
    vec![
        TableColumn::text("run").with_max_width(10),
        TableColumn::text("state").with_max_width(20),
        TableColumn::numeric("cash"),
        TableColumn::text("mode"),
        TableColumn::numeric("seed").with_max_width(12),
        TableColumn::text("scenario").with_max_width(20),
        TableColumn::text("played").with_max_width(16),
        TableColumn::text("participant").with_max_width(16),
        TableColumn::text("created").with_max_width(16),
    ]
}

fn row(run: &RunSummary, marked: bool) -> Vec<TableCell> {
    let mark = if marked { "●" } else { " " };
    let name = TableCell::from_text(format!("{mark} {}", run.id)).with_role(if marked {
        Role::Key
    } else {
        Role::Text
    });
    if run.problem.is_some() {
        return vec![name, TableCell::from_text("cannot be read").with_role(Role::Bad)];
    }
    let role = match run.ended {
        None => Role::Text,
        Some(RunEndReason::Horizon | RunEndReason::Lesson) => Role::Good,
        Some(RunEndReason::Bankruptcy) => Role::Bad,
        Some(RunEndReason::Abandoned) => Role::Dim,
    };
    vec![
        name,
        TableCell::from_text(if run.is_served { PLAYED_BY_PROGRAM.to_owned() } else { progress_label(run) })
            .with_role(role),
        TableCell::from_number(run.cash, dollars(run.cash)),
        TableCell::from_text(run.mode.map_or("", Mode::id)),
        TableCell::from_number(run.seed as f64, run.seed.to_string()),
        TableCell::from_text(run.scenario.as_str()),
        TableCell::from_text(format_to_minute(&run.played)).with_role(Role::Dim),
        TableCell::from_text(run.participant.as_deref().unwrap_or("–")),
        TableCell::from_text(format_to_minute(&run.created)).with_role(Role::Dim),
    ]
}

impl StartMenu {
    pub(super) fn rebuild_table(&mut self) {
        let rows = self.runs().iter().map(|run| row(run, self.marked.contains(&run.id))).collect();
        self.table.set_rows(rows);
    }

    pub(super) fn selected_run(&self) -> Option<&RunSummary> {
        self.table.selected().and_then(|at| self.runs().get(at))
    }

    pub(super) fn handle_runs_action(&mut self, action: Action) -> Vec<Effect> {
        if self.table.handle_action(action, super::PAGE_ROWS) {
            return self.request_selected_preview();
        }
        match action {
            Action::Open => {
                return self
                    .selected_run()
                    .map(|run| Effect::Request(Request::Open(run.id.clone(), Access::Write)))
                    .into_iter()
                    .collect();
            }
            Action::ReplayRun => return self.replay_effects(self.selected_run()),
            Action::MarkRun => return self.toggle_mark(),
            Action::CompareRuns => return self.open_comparison(),
            Action::EndRun => {
                match self.selected_run().filter(|run| run.ended.is_none() && run.problem.is_none()) {
                    Some(run) => self.question = Some(MenuQuestion::EndRun(run.id.clone())),
                    None => return vec![Effect::ShowError("This run is already over".to_owned())],
                }
            }
            Action::DeleteRun => {
                self.question = self.selected_run().map(|run| MenuQuestion::Delete(run.id.clone()))
            }
            Action::Close => self.go_home(),
            _ => {}
        }
        Vec::new()
    }

    /// Returns the effects that open a run in playback.
    pub(super) fn replay_effects(&self, run: Option<&RunSummary>) -> Vec<Effect> {
        let replay = |run: &RunSummary| {
            let recorded = RecordSource::Run(run.id.clone());
            vec![Effect::Request(Request::Replay { recorded, goal: SeekTarget::First, follow: false })]
        };
        run.map(replay).unwrap_or_default()
    }

    fn toggle_mark(&mut self) -> Vec<Effect> {
        let Some(run) = self.selected_run().filter(|run| run.problem.is_none()) else { return Vec::new() };
        let id = run.id.clone();
        match self.marked.iter().position(|text| *text == id) {
            Some(at) => {
                self.marked.remove(at);
            }
            None if self.marked.len() == MAX_COMPARED_RUNS => {
                return vec![Effect::ShowError(format!("you can compare at most {MAX_COMPARED_RUNS} runs"))];
            }
            None => self.marked.push(id),
        }
        self.rebuild_table();
        let mut effects = self.handle_runs_action(Action::Down);
        effects.extend(self.request_marked_previews());
        effects
    }

    /// Requests the previews of the marked runs that are missing.
    fn request_marked_previews(&mut self) -> Vec<Effect> {
        let marked = self.marked.clone();
        marked.into_iter().filter_map(|id| self.request_preview(&id)).collect()
    }

    fn open_comparison(&mut self) -> Vec<Effect> {
        if self.marked.len() < 2 {
            return vec![Effect::ShowError("Mark two or more runs first".to_owned())];
        }
        let effects = self.request_marked_previews();
        self.page = super::MenuPage::Compare;
        effects
    }

    pub(super) fn request_selected_preview(&mut self) -> Vec<Effect> {
        let id = self.selected_run().filter(|run| run.problem.is_none()).map(|run| run.id.clone());
        id.and_then(|id| self.request_preview(&id)).into_iter().collect()
    }

    /// Handles the user's answer to the open question.
    pub(super) fn answer_question(&mut self, action: Action) -> Vec<Effect> {
        match (action, self.question.take()) {
            (Action::Confirm, Some(MenuQuestion::EndRun(id))) => vec![Effect::Request(Request::EndRun(id))],
            (Action::Confirm, Some(MenuQuestion::Delete(id))) => {
                vec![Effect::Request(Request::DeleteRun(id))]
            }
            (Action::Confirm, Some(MenuQuestion::OpenError(OpenFallback::Watch(id), _))) => {
                vec![Effect::Request(Request::Replay {
                    recorded: RecordSource::Run(id),
                    goal: SeekTarget::Last,
                    follow: true,
                })]
            }
            (Action::Confirm, Some(MenuQuestion::OpenError(OpenFallback::Recover(id), _))) => {
                vec![Effect::Request(Request::Recover(id))]
            }
            (Action::Agree, Some(MenuQuestion::Consent(new, text))) => match text.consent() {
                Some(consent_given) => {
                    vec![Effect::Request(Request::Create(Box::new(NewRun {
                        agreed: Some(consent_given.agree_now()),
                        ..*new
                    })))]
                }
                None => {
                    self.question = Some(MenuQuestion::Consent(new, text));
                    vec![Effect::ShowError(UNREAD_ERROR.to_owned())]
                }
            },
            (Action::Decline | Action::Close, Some(MenuQuestion::Consent(..))) => {
                vec![Effect::ShowStatus("No run was started, and nothing was recorded".to_owned())]
            }
            (action, Some(MenuQuestion::Consent(new, mut text))) => {
                text.handle_scroll(action);
                self.question = Some(MenuQuestion::Consent(new, text));
                Vec::new()
            }
            (Action::Cancel, _) => Vec::new(),
            (_, menu_question) => {
                self.question = menu_question;
                Vec::new()
            }
        }
    }

    fn question_text(&self) -> Option<(&'static str, String)> {
        let id = match self.question.as_ref()? {
            MenuQuestion::EndRun(id) | MenuQuestion::Delete(id) => id,
            MenuQuestion::OpenError(..) | MenuQuestion::Consent(..) => return None,
        };
        let run = self.runs().iter().find(|run| run.id == *id)?;
        let run_progress = format!("day {} of {}, {}", run.day, run.days, dollars(run.cash));
        let give_up = matches!(self.question, Some(MenuQuestion::EndRun(_)));
        Some(match give_up {
            true => (
                "Give up",
                format!(
                    "Run {id} is at {run_progress}. Giving up ends the run for good, without a score. You can still open it and branch from it."
                ),
            ),
            false => (
                "Delete",
                format!(
                    "Run {id} is at {run_progress}. Deleting the run permanently removes its record and everything in its folder."
                ),
            ),
        })
    }

    /// Draws the question about a run that does not open, over the current page.
    pub(super) fn draw_open_error(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let (instead, problem) = match &self.question {
            Some(MenuQuestion::OpenError(instead, problem)) => (instead, problem),
            Some(MenuQuestion::Consent(_, text)) => {
                let (agree, decline) = ("y I agree, the session begins", "n I do not agree");
                return text.draw(canvas, area, "Before the session", agree, decline);
            }
            _ => return,
        };
        let (title, offer) = match instead {
            // The consent question is drawn by the consent text.
            OpenFallback::AskConsent(_) => return,
            OpenFallback::Watch(_) => {
                ("Read-only", "Watch the run here, read-only? Changes made elsewhere appear here.")
            }
            OpenFallback::Recover(_) => {
                ("Damaged", "Recover the undamaged part as a branch? The damaged run is not changed.")
            }
        };
        let width = 76.min(area.width);
        let mut lines = wrap(problem, width.saturating_sub(4) as usize);
        lines.push(String::new());
        let offered = wrap(offer, width.saturating_sub(4) as usize);
        let from = lines.len();
        lines.extend(offered);
        let dialog_area = centered_rect(area, width, lines.len() as u16 + 4);
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, title, "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        // If the reason is long, its first lines are omitted so that the question stays visible.
        let room = inside.height.saturating_sub(1) as usize;
        let skipped = lines.len().saturating_sub(room);
        let shown = lines.iter().enumerate().skip(if room < lines.len() { skipped } else { 0 });
        for (row, (at, line)) in row_rects(inside).zip(shown) {
            canvas.draw_text(row, line, if at < from { Role::Warning } else { Role::Strong });
        }
        canvas.draw_pane_keys(dialog_area, "y yes · esc no");
    }

    pub(super) fn draw_runs(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let for_detail = if area.height >= 16 { (area.height * 2 / 5).max(9) } else { 0 };
        let above = Rect { height: area.height - for_detail, ..area };
        let below = Rect { y: above.bottom(), height: for_detail, ..area };
        let note = match (self.table.summary(), self.marked.len()) {
            (note, 0) => note,
            (note, marked) if note.is_empty() => format!("{marked} marked"),
            (note, marked) => format!("{note} · {marked} marked"),
        };
        let inside = canvas.draw_pane_frame(above, "Runs", &note, self.question.is_none());
        self.table.draw(canvas, inside, self.question.is_none(), 0);
        if self.runs().is_empty() {
            let row = Rect { y: inside.y + 1, height: 1.min(inside.height.saturating_sub(1)), ..inside };
            canvas.draw_text(row, "No runs left. Close this page and start one.", Role::Dim);
        }
        match (self.question_text(), self.selected_run()) {
            (Some((title, text)), _) => {
                // The question is drawn over the list if there is no space for a separate pane.
                let place = if for_detail > 0 { below } else { area };
                canvas.clear(place, Role::Text);
                let inside = canvas.draw_pane_frame(place, title, "", true);
                let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
                for (row, line) in row_rects(inside).zip(wrap(&text, inside.width as usize)) {
                    canvas.draw_text(row, &line, Role::Warning);
                }
            }
            (None, Some(run)) if for_detail > 0 => {
                draw_run(canvas, below, &format!("Run {}", run.id), run, &self.previews)
            }
            _ => {}
        }
    }
}

/// Describes the progress or the end of a run.
pub(super) fn progress_label(run: &RunSummary) -> String {
    match run.ended {
        _ if run.problem.is_some() => "cannot be read".to_owned(),
        None => format!("day {} of {}", run.day, run.days),
        Some(RunEndReason::Horizon) => format!("finished day {}", run.day),
        Some(RunEndReason::Bankruptcy) => format!("bankrupt day {}", run.day),
        Some(RunEndReason::Abandoned) => format!("given up day {}", run.day),
        Some(RunEndReason::Lesson) => format!("lesson end day {}", run.day),
    }
}

fn format_to_minute(at: &str) -> String {
    at.get(..16).unwrap_or("").replace('T', " ")
}

pub(super) fn run_facts(
    run: &RunSummary,
    preview: Option<&Result<RunPreview, String>>,
) -> Vec<(&'static str, String)> {
    if let Some(problem) = &run.problem {
        return vec![("problem", problem.clone())];
    }
    let mode = run.mode.map_or("", Mode::id);
    let mut facts = vec![
        ("cash", dollars(run.cash)),
        ("run", format!("{} · {mode} · seed {}", run.id, run.seed)),
        ("scenario", run.scenario.clone()),
    ];
    if let Some(Ok(preview)) = preview {
        facts.insert(
            1,
            (
                "subscribers",
                format!(
                    "{} · {}",
                    grouped_number(preview.subscribers as f64, 0),
                    format_count(preview.seats as f64, "seat")
                ),
            ),
        );
        facts.insert(2, ("revenue", format!("{} a month", dollars(preview.recurring_revenue))));
    }
    if run.is_served {
        facts.push(("now", PLAYED_BY_PROGRAM.to_owned()));
    }
    if let Some(participant) = &run.participant {
        facts.push(("participant", participant.clone()));
    }
    facts.push(("last played", format_to_minute(&run.played)));
    facts
}

/// Draws the cash curve of a run, or the reason why there is no curve.
pub(super) fn draw_preview(
    canvas: &mut Canvas<'_>,
    area: Rect,
    preview: Option<&Result<RunPreview, String>>,
    unreadable: bool,
) {
    match preview {
        Some(Ok(preview)) if preview.cash.len() > 1 => draw_curves(canvas, area, &[(0, preview)]),
        Some(Ok(_)) => canvas.draw_text(area, "No week has been simulated yet", Role::Dim),
        Some(Err(problem)) => canvas.draw_text(area, &format!("! {problem}"), Role::Bad),
        None if unreadable => {}
        None => canvas.draw_text(area, "reading the run …", Role::Dim),
    }
}

/// Draws curves of cash by day. The number of each curve selects its color.
pub(super) fn draw_curves(canvas: &mut Canvas<'_>, area: Rect, previews: &[(usize, &RunPreview)]) {
    let points =
        |preview: &RunPreview| preview.cash.iter().map(|(day, cash)| (f64::from(*day), *cash)).collect();
    let lines: Vec<Curve> = previews
        .iter()
        .map(|(number, preview)| Curve::from_points(points(preview), Role::Series(*number)))
        .collect();
    let values = previews.iter().flat_map(|(_, preview)| preview.cash.iter().map(|point| point.1));
    let zero = zero_if_near(values);
    let x = XAxis { format: &|day| format!("day {day:.0}"), required_values: &[0.0] };
    draw_chart(canvas, area, &lines, &x, &YAxis { unit: AxisUnit::Dollars, required_values: zero });
}

/// Returns the preview of a run, if the preview has arrived.
pub(super) fn loaded_preview<'a>(previews: &'a RunPreviews, id: &str) -> Option<&'a RunPreview> {
    previews.get(id)?.as_ref()?.as_ref().ok()
}
