//! List of runs: open, compare, give up, delete.

use ratatui::layout::Rect;

use super::home::draw_run;
use super::{Menu, Previews};
use crate::action::Action;
use crate::agreement::{Agreement, READ_FIRST};
use crate::effect::Effect;
use novamind_base::notation::{dollars, grouped};
use novamind_record::folder::preview::RunPreview;
use novamind_record::folder::runs::RunSummary;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Ended;
use novamind_session::{Access, Goal, NewRun};
use novamind_tui::canvas::{Canvas, centered, rows_of};
use novamind_tui::text::{count, wrapped};
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::zero_if_near;
use novamind_tui::widgets::{Axis, Cell, Column, Line, Side, Unit, chart};
use novamind_worker::message::Instead;
use novamind_worker::request::{Recorded, Request};

/// An action that needs confirmation because it cannot be undone.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Asked {
    GiveUp(String),
    Delete(String),
    /// An alternative for a run that does not open, with the reason.
    Instead(Instead, String),
    /// Whether a participant agrees to a text before their run starts.
    Agree(Box<NewRun>, Agreement),
}

/// State of a run that a server is playing. Opening it asks whether to watch.
const BY_PROGRAM: &str = "played by a program";

pub(super) const MOST_COMPARED: usize = 6;

pub(super) fn columns() -> Vec<Column> {
    vec![
        Column::words("run").at_most(10),
        Column::words("state").at_most(20),
        Column::numbers("cash"),
        Column::words("mode"),
        Column::numbers("seed").at_most(12),
        Column::words("scenario").at_most(20),
        Column::words("played").at_most(16),
        Column::words("participant").at_most(16),
        Column::words("created").at_most(16),
    ]
}

fn row(run: &RunSummary, marked: bool) -> Vec<Cell> {
    let mark = if marked { "●" } else { " " };
    let name = Cell::words(format!("{mark} {}", run.id)).role(if marked { Role::Key } else { Role::Text });
    if run.problem.is_some() {
        return vec![name, Cell::words("cannot be read").role(Role::Bad)];
    }
    let role = match run.ended {
        None => Role::Text,
        Some(Ended::Horizon | Ended::Lesson) => Role::Good,
        Some(Ended::Bankruptcy) => Role::Bad,
        Some(Ended::Abandoned) => Role::Dim,
    };
    vec![
        name,
        Cell::words(if run.is_served { BY_PROGRAM.to_owned() } else { state(run) }).role(role),
        Cell::number(run.cash, dollars(run.cash)),
        Cell::words(run.mode.map_or("", Mode::id)),
        Cell::number(run.seed as f64, run.seed.to_string()),
        Cell::words(run.scenario.as_str()),
        Cell::words(minute(&run.played)).role(Role::Dim),
        Cell::words(run.participant.as_deref().unwrap_or("–")),
        Cell::words(minute(&run.created)).role(Role::Dim),
    ]
}

impl Menu {
    pub(super) fn renew_table(&mut self) {
        let rows = self.list().iter().map(|run| row(run, self.marked.contains(&run.id))).collect();
        self.table.set_rows(rows);
    }

    pub(super) fn chosen(&self) -> Option<&RunSummary> {
        self.table.selected().and_then(|at| self.list().get(at))
    }

    pub(super) fn act_on_runs(&mut self, action: Action) -> Vec<Effect> {
        if self.table.act(action, super::PAGE) {
            return self.read_chosen();
        }
        match action {
            Action::Open => {
                return self
                    .chosen()
                    .map(|run| Effect::Request(Request::Open(run.id.clone(), Access::Write)))
                    .into_iter()
                    .collect();
            }
            Action::ReplayRun => return self.replay(self.chosen()),
            Action::MarkRun => return self.mark(),
            Action::CompareRuns => return self.compare(),
            Action::EndRun => {
                match self.chosen().filter(|run| run.ended.is_none() && run.problem.is_none()) {
                    Some(run) => self.asked = Some(Asked::GiveUp(run.id.clone())),
                    None => return vec![Effect::Complain("This run is already over".to_owned())],
                }
            }
            Action::DeleteRun => self.asked = self.chosen().map(|run| Asked::Delete(run.id.clone())),
            Action::Close => self.go_home(),
            _ => {}
        }
        Vec::new()
    }

    /// Opens the playback of a run.
    pub(super) fn replay(&self, run: Option<&RunSummary>) -> Vec<Effect> {
        let replay = |run: &RunSummary| {
            let recorded = Recorded::Run(run.id.clone());
            vec![Effect::Request(Request::Replay { recorded, goal: Goal::First, follow: false })]
        };
        run.map(replay).unwrap_or_default()
    }

    fn mark(&mut self) -> Vec<Effect> {
        let Some(run) = self.chosen().filter(|run| run.problem.is_none()) else { return Vec::new() };
        let id = run.id.clone();
        match self.marked.iter().position(|own| *own == id) {
            Some(at) => {
                self.marked.remove(at);
            }
            None if self.marked.len() == MOST_COMPARED => {
                return vec![Effect::Complain(format!(
                    "{MOST_COMPARED} runs are marked; more cannot be compared"
                ))];
            }
            None => self.marked.push(id),
        }
        self.renew_table();
        let mut effects = self.act_on_runs(Action::Down);
        effects.extend(self.read_marked());
        effects
    }

    /// Requests the missing previews of the marked runs.
    fn read_marked(&mut self) -> Vec<Effect> {
        let marked = self.marked.clone();
        marked.into_iter().filter_map(|id| self.read(&id)).collect()
    }

    fn compare(&mut self) -> Vec<Effect> {
        if self.marked.len() < 2 {
            return vec![Effect::Complain("Mark two or more runs first".to_owned())];
        }
        let effects = self.read_marked();
        self.page = super::MenuPage::Compare;
        effects
    }

    pub(super) fn read_chosen(&mut self) -> Vec<Effect> {
        let id = self.chosen().filter(|run| run.problem.is_none()).map(|run| run.id.clone());
        id.and_then(|id| self.read(&id)).into_iter().collect()
    }

    /// Handles the answer to a confirmation.
    pub(super) fn answer(&mut self, action: Action) -> Vec<Effect> {
        match (action, self.asked.take()) {
            (Action::Confirm, Some(Asked::GiveUp(id))) => vec![Effect::Request(Request::EndRun(id))],
            (Action::Confirm, Some(Asked::Delete(id))) => vec![Effect::Request(Request::DeleteRun(id))],
            (Action::Confirm, Some(Asked::Instead(Instead::Watch(id), _))) => {
                vec![Effect::Request(Request::Replay {
                    recorded: Recorded::Run(id),
                    goal: Goal::Last,
                    follow: true,
                })]
            }
            (Action::Confirm, Some(Asked::Instead(Instead::Rescue(id), _))) => {
                vec![Effect::Request(Request::Rescue(id))]
            }
            (Action::Agree, Some(Asked::Agree(new, text))) => match text.given() {
                Some(given) => {
                    vec![Effect::Request(Request::Create(Box::new(NewRun {
                        agreed: Some(given.now()),
                        ..*new
                    })))]
                }
                None => {
                    self.asked = Some(Asked::Agree(new, text));
                    vec![Effect::Complain(READ_FIRST.to_owned())]
                }
            },
            (Action::Decline | Action::Close, Some(Asked::Agree(..))) => {
                vec![Effect::Say("No run was started, and nothing was recorded".to_owned())]
            }
            (action, Some(Asked::Agree(new, mut text))) => {
                text.scroll(action);
                self.asked = Some(Asked::Agree(new, text));
                Vec::new()
            }
            (Action::Cancel, _) => Vec::new(),
            (_, asked) => {
                self.asked = asked;
                Vec::new()
            }
        }
    }

    fn question(&self) -> Option<(&'static str, String)> {
        let id = match self.asked.as_ref()? {
            Asked::GiveUp(id) | Asked::Delete(id) => id,
            Asked::Instead(..) | Asked::Agree(..) => return None,
        };
        let run = self.list().iter().find(|run| run.id == *id)?;
        let stand = format!("day {} of {}, {}", run.day, run.days, dollars(run.cash));
        let give_up = matches!(self.asked, Some(Asked::GiveUp(_)));
        Some(match give_up {
            true => (
                "Give up",
                format!(
                    "Run {id} is at {stand}. Giving up ends it for good, without a score. You can still open it and branch from it."
                ),
            ),
            false => (
                "Delete",
                format!(
                    "Run {id} is at {stand}. Deleting it removes its record and everything in its folder for good."
                ),
            ),
        })
    }

    /// Draws the question about a run that does not open, over any page.
    pub(super) fn draw_instead(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let (instead, problem) = match &self.asked {
            Some(Asked::Instead(instead, problem)) => (instead, problem),
            Some(Asked::Agree(_, text)) => {
                let (agree, decline) = ("y I agree, the session begins", "n I do not agree");
                return text.draw(canvas, area, "Before the session", agree, decline);
            }
            _ => return,
        };
        let (title, offer) = match instead {
            // Consent is shown as a text.
            Instead::Agree(_) => return,
            Instead::Watch(_) => {
                ("Read-only", "Watch it here, read-only? Changes made elsewhere appear here.")
            }
            Instead::Rescue(_) => {
                ("Damaged", "Recover the undamaged part as a branch? The damaged run is not changed.")
            }
        };
        let width = 76.min(area.width);
        let mut lines = wrapped(problem, width.saturating_sub(4) as usize);
        lines.push(String::new());
        let offered = wrapped(offer, width.saturating_sub(4) as usize);
        let from = lines.len();
        lines.extend(offered);
        let own = centered(area, width, lines.len() as u16 + 4);
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, title, "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        // The question stays visible even if the reason is long.
        let room = inside.height.saturating_sub(1) as usize;
        let skipped = lines.len().saturating_sub(room);
        let shown = lines.iter().enumerate().skip(if room < lines.len() { skipped } else { 0 });
        for (row, (at, line)) in rows_of(inside).zip(shown) {
            canvas.text(row, line, if at < from { Role::Warning } else { Role::Strong });
        }
        canvas.pane_keys(own, "y yes · esc no");
    }

    pub(super) fn draw_runs(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let for_detail = if area.height >= 16 { (area.height * 2 / 5).max(9) } else { 0 };
        let above = Rect { height: area.height - for_detail, ..area };
        let below = Rect { y: above.bottom(), height: for_detail, ..area };
        let note = match (self.table.note(), self.marked.len()) {
            (note, 0) => note,
            (note, marked) if note.is_empty() => format!("{marked} marked"),
            (note, marked) => format!("{note} · {marked} marked"),
        };
        let inside = canvas.pane(above, "Runs", &note, self.asked.is_none());
        self.table.draw(canvas, inside, self.asked.is_none(), 0);
        if self.list().is_empty() {
            let row = Rect { y: inside.y + 1, height: 1.min(inside.height.saturating_sub(1)), ..inside };
            canvas.text(row, "No runs left. Close this page and start one.", Role::Dim);
        }
        match (self.question(), self.chosen()) {
            (Some((title, text)), _) => {
                // Over the list if there is no room for a separate pane.
                let place = if for_detail > 0 { below } else { area };
                canvas.clear(place, Role::Text);
                let inside = canvas.pane(place, title, "", true);
                let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
                for (row, line) in rows_of(inside).zip(wrapped(&text, inside.width as usize)) {
                    canvas.text(row, &line, Role::Warning);
                }
            }
            (None, Some(run)) if for_detail > 0 => {
                draw_run(canvas, below, &format!("Run {}", run.id), run, &self.previews)
            }
            _ => {}
        }
    }
}

/// Returns the progress of a run.
pub(super) fn state(run: &RunSummary) -> String {
    match run.ended {
        _ if run.problem.is_some() => "cannot be read".to_owned(),
        None => format!("day {} of {}", run.day, run.days),
        Some(Ended::Horizon) => format!("finished day {}", run.day),
        Some(Ended::Bankruptcy) => format!("bankrupt day {}", run.day),
        Some(Ended::Abandoned) => format!("given up day {}", run.day),
        Some(Ended::Lesson) => format!("lesson over day {}", run.day),
    }
}

fn minute(at: &str) -> String {
    at.get(..16).unwrap_or("").replace('T', " ")
}

pub(super) fn facts(
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
                    grouped(preview.subscribers as f64, 0),
                    count(preview.seats as f64, "seat")
                ),
            ),
        );
        facts.insert(2, ("revenue", format!("{} a month", dollars(preview.recurring_revenue))));
    }
    if run.is_served {
        facts.push(("now", BY_PROGRAM.to_owned()));
    }
    if let Some(participant) = &run.participant {
        facts.push(("participant", participant.clone()));
    }
    facts.push(("last played", minute(&run.played)));
    facts
}

/// Draws the cash curve of a run, or the reason why there is none.
pub(super) fn draw_preview(
    canvas: &mut Canvas<'_>,
    area: Rect,
    preview: Option<&Result<RunPreview, String>>,
    unreadable: bool,
) {
    match preview {
        Some(Ok(preview)) if preview.cash.len() > 1 => draw_curves(canvas, area, &[(0, preview)]),
        Some(Ok(_)) => canvas.text(area, "No week has been simulated yet", Role::Dim),
        Some(Err(problem)) => canvas.text(area, &format!("! {problem}"), Role::Bad),
        None if unreadable => {}
        None => canvas.text(area, "reading the run …", Role::Dim),
    }
}

/// Draws curves of cash by day, in the color of each number.
pub(super) fn draw_curves(canvas: &mut Canvas<'_>, area: Rect, previews: &[(usize, &RunPreview)]) {
    let points =
        |preview: &RunPreview| preview.cash.iter().map(|(day, cash)| (f64::from(*day), *cash)).collect();
    let lines: Vec<Line> = previews
        .iter()
        .map(|(number, preview)| Line::through(points(preview), Role::Series(*number)))
        .collect();
    let values = previews.iter().flat_map(|(_, preview)| preview.cash.iter().map(|point| point.1));
    let zero = zero_if_near(values);
    let x = Axis { write: &|day| format!("day {day:.0}"), holds: &[0.0] };
    chart(canvas, area, &lines, &x, &Side { unit: Unit::Dollars, holds: zero });
}

/// Returns a preview that has arrived.
pub(super) fn known<'a>(previews: &'a Previews, id: &str) -> Option<&'a RunPreview> {
    previews.get(id)?.as_ref()?.as_ref().ok()
}
