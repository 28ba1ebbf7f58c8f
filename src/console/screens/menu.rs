//! The start menu: continue, a new run, the runs, quit.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;

use crate::console::action::{Action, Scope};
use crate::console::canvas::{Align, Canvas, Click, centered, rows_of};
use crate::console::effect::Effect;
use crate::console::text::wrapped;
use crate::console::theme::Role;
use crate::console::widgets::Field;
use crate::console::widgets::field::parse_number;
use crate::console::widgets::table::first_row;
use crate::notation::{dollars, grouped};
use crate::session::{Configuration, DEFAULT_SCENARIO, Ended, Mode, NewRun, RunSummary};

/// The start menu.
pub struct Menu {
    page: Page,
    runs: Option<Result<Vec<RunSummary>, String>>,
    selected: usize,
    form: Form,
    configuration: Configuration,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Page {
    Choices,
    NewRun,
    Runs,
}

/// Choices of the first page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Choice {
    Continue,
    New,
    Runs,
    Quit,
}

/// Fields of a new run.
struct Form {
    /// Names and titles of the scenarios.
    scenarios: Vec<(String, String)>,
    scenario: usize,
    mode: usize,
    seed: Field,
    days: Field,
    cash: Field,
    participant: Field,
    at: usize,
    problem: Option<String>,
}

/// Rows of the form: name and what it means.
const ROWS: [(&str, &str); 7] = [
    ("Scenario", "left and right choose another"),
    ("Mode", "what the run is for; it cannot be changed later"),
    ("Seed", "the same seed meets the same luck"),
    ("Days", "last day of the run, at least 7"),
    ("Starting cash", "dollars"),
    ("Participant", "a label for the record; may be left out"),
    ("Start", "enter begins the run"),
];

impl Form {
    fn new(configuration: &Configuration) -> Form {
        let title = |name: &String| {
            configuration.scenario(name).map_or_else(|error| error.to_string(), |own| own.title)
        };
        let scenarios: Vec<(String, String)> =
            configuration.scenarios().into_iter().map(|name| (name.clone(), title(&name))).collect();
        let scenario = scenarios.iter().position(|(name, _)| name == DEFAULT_SCENARIO).unwrap_or(0);
        Form {
            scenarios,
            scenario,
            mode: Mode::ALL.iter().position(|mode| *mode == Mode::Sandbox).unwrap_or(0),
            seed: Field::to_replace("42"),
            days: Field::default(),
            cash: Field::default(),
            participant: Field::default(),
            at: ROWS.len() - 1,
            problem: None,
        }
    }

    fn field(&mut self) -> Option<&mut Field> {
        match self.at {
            2 => Some(&mut self.seed),
            3 => Some(&mut self.days),
            4 => Some(&mut self.cash),
            5 => Some(&mut self.participant),
            _ => None,
        }
    }

    fn turn(&mut self, forward: bool) {
        let step =
            |at: usize, count: usize| if forward { (at + 1) % count } else { (at + count - 1) % count };
        match self.at {
            0 => self.scenario = step(self.scenario, self.scenarios.len()),
            1 => self.mode = step(self.mode, Mode::ALL.len()),
            _ => {}
        }
    }

    /// The run, or what is wrong with the form.
    fn read(&mut self) -> Result<NewRun, (usize, String)> {
        let whole = |field: &Field, row: usize, least: f64| match field.text().trim() {
            "" => Ok(None),
            text => parse_number(text)
                .filter(|number| *number >= least && number.fract() == 0.0 && *number < 9e15)
                .map(Some)
                .ok_or((row, format!("{} must be a whole number of at least {least}", ROWS[row].0))),
        };
        let seed = whole(&self.seed, 2, 0.0)?.map(|seed| seed as u64);
        let days = whole(&self.days, 3, 7.0)?.map(|days| days.min(f64::from(u32::MAX)) as u32);
        let cash = match self.cash.text().trim() {
            "" => None,
            text => Some(
                parse_number(text)
                    .filter(|cash| *cash > 0.0)
                    .ok_or((4, "starting cash must be dollars above 0".to_owned()))?,
            ),
        };
        let participant = self.participant.text().trim();
        Ok(NewRun {
            seed,
            days,
            cash,
            scenario: self
                .scenarios
                .get(self.scenario)
                .map_or(DEFAULT_SCENARIO, |own| own.0.as_str())
                .to_owned(),
            mode: Mode::ALL[self.mode],
            participant: (!participant.is_empty()).then(|| participant.to_owned()),
            ..NewRun::default()
        })
    }
}

impl Menu {
    /// The menu, before the runs are known.
    pub fn new(configuration: &Configuration) -> Menu {
        Menu {
            page: Page::Choices,
            runs: None,
            selected: 0,
            form: Form::new(configuration),
            configuration: configuration.clone(),
        }
    }

    /// Takes the list of runs.
    pub fn take(&mut self, runs: Result<Vec<RunSummary>, String>) {
        self.runs = Some(runs);
        self.selected = 0;
    }

    /// A run could not be started or opened.
    pub fn refused(&mut self, problem: String) {
        self.form.problem = Some(problem);
    }

    fn list(&self) -> &[RunSummary] {
        match &self.runs {
            Some(Ok(list)) => list,
            _ => &[],
        }
    }

    fn latest(&self) -> Option<&RunSummary> {
        self.list().iter().find(|run| run.ended.is_none() && run.problem.is_none())
    }

    fn choices(&self) -> Vec<(Choice, String, String)> {
        let mut choices = Vec::new();
        if let Some(run) = self.latest() {
            choices.push((Choice::Continue, "Continue".to_owned(), describe(run)));
        }
        choices.push((Choice::New, "New run".to_owned(), "500 days from one million dollars".to_owned()));
        if !self.list().is_empty() {
            choices.push((
                Choice::Runs,
                "Runs".to_owned(),
                match self.list().len() {
                    1 => "the one on this machine".to_owned(),
                    several => format!("all {several} on this machine"),
                },
            ));
        }
        choices.push((Choice::Quit, "Quit".to_owned(), String::new()));
        choices
    }

    fn rows(&self) -> usize {
        match self.page {
            Page::Choices => self.choices().len(),
            Page::NewRun => ROWS.len(),
            Page::Runs => self.list().len(),
        }
    }

    /// Scopes of the page.
    pub fn scopes(&self) -> Vec<Scope> {
        match self.page {
            Page::NewRun if (2..=5).contains(&self.form.at) => vec![Scope::Field],
            Page::NewRun => vec![Scope::List],
            _ => vec![Scope::Menu, Scope::List],
        }
    }

    /// Actions worth showing.
    pub fn hints(&self) -> Vec<Action> {
        match self.page {
            Page::Choices if self.latest().is_none() => vec![Action::Open, Action::NewRun, Action::Quit],
            Page::Choices => vec![Action::Open, Action::NewRun, Action::ContinueRun, Action::Quit],
            Page::NewRun => vec![Action::Open, Action::Left, Action::Right, Action::Close],
            Page::Runs => vec![Action::Open, Action::Close],
        }
    }

    fn place(&mut self) -> &mut usize {
        match self.page {
            Page::NewRun => &mut self.form.at,
            _ => &mut self.selected,
        }
    }

    /// Does an action.
    pub fn act(&mut self, action: Action) -> Vec<Effect> {
        let last = self.rows().saturating_sub(1);
        match action {
            Action::Up | Action::CommitPrevious => *self.place() = self.place().saturating_sub(1),
            Action::Down | Action::CommitDown | Action::CommitNext => {
                *self.place() = (*self.place() + 1).min(last)
            }
            Action::First => *self.place() = 0,
            Action::Last => *self.place() = last,
            Action::Left | Action::Right if self.page == Page::NewRun => {
                self.form.turn(action == Action::Right)
            }
            Action::NewRun => self.open_form(),
            Action::ContinueRun => return self.open_latest(),
            Action::Close | Action::Discard => {
                self.page = Page::Choices;
                self.selected = 0;
            }
            Action::Commit => return self.enter_in_form(),
            Action::Open => {
                return match self.page {
                    Page::Choices => self.choose(),
                    Page::NewRun => self.enter_in_form(),
                    Page::Runs => self.list().get(self.selected).map(open).into_iter().collect(),
                };
            }
            _ => {}
        }
        Vec::new()
    }

    fn enter_in_form(&mut self) -> Vec<Effect> {
        if self.form.at < ROWS.len() - 1 {
            self.form.at += 1;
            return Vec::new();
        }
        match self.form.read() {
            Ok(new) => {
                self.form.problem = None;
                vec![Effect::Create(Box::new(new))]
            }
            Err((row, problem)) => {
                self.form.at = row;
                self.form.problem = Some(problem);
                Vec::new()
            }
        }
    }

    fn open_form(&mut self) {
        self.page = Page::NewRun;
        self.form = Form::new(&self.configuration);
    }

    fn open_latest(&self) -> Vec<Effect> {
        match self.latest() {
            Some(run) => vec![open(run)],
            None => vec![Effect::Complain("there is no unfinished run; n starts one".to_owned())],
        }
    }

    fn choose(&mut self) -> Vec<Effect> {
        match self.choices().get(self.selected).map(|choice| choice.0) {
            Some(Choice::Continue) => return self.open_latest(),
            Some(Choice::New) => self.open_form(),
            Some(Choice::Runs) => (self.page, self.selected) = (Page::Runs, 0),
            Some(Choice::Quit) => return vec![Effect::Do(Action::Quit)],
            None => {}
        }
        Vec::new()
    }

    /// Takes a typed key.
    pub fn key(&mut self, key: &KeyEvent) -> Vec<Effect> {
        if self.page == Page::NewRun {
            self.form.problem = None;
            if let Some(field) = self.form.field() {
                field.key(key);
            }
        } else if key.code == KeyCode::Char('q') {
            return vec![Effect::Do(Action::Quit)];
        }
        Vec::new()
    }

    /// Takes pasted text.
    pub fn paste(&mut self, text: &str) {
        if self.page == Page::NewRun
            && let Some(field) = self.form.field()
        {
            field.insert(text.trim());
        }
    }

    /// A row was clicked: once selects, twice opens.
    pub fn click(&mut self, row: usize) -> Vec<Effect> {
        let row = row.min(self.rows().saturating_sub(1));
        let again = *self.place() == row;
        *self.place() = row;
        if again && !(self.page == Page::NewRun && row < ROWS.len() - 1) {
            self.act(Action::Open)
        } else {
            Vec::new()
        }
    }

    /// Draws the page.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let own = centered(area, 92.min(area.width), 21.min(area.height));
        let inside = canvas.pane(own, "NovaMind", concat!("version ", env!("CARGO_PKG_VERSION")), true);
        let inside = Rect { x: inside.x + 2, width: inside.width.saturating_sub(4), ..inside };
        canvas.text(inside, "Run a simulated AI subscription company for 500 days.", Role::Strong);
        let below = Rect { y: inside.y + 2, height: inside.height.saturating_sub(2), ..inside };
        match self.page {
            Page::Choices => self.draw_choices(canvas, below),
            Page::NewRun => self.draw_form(canvas, below),
            Page::Runs => self.draw_runs(canvas, below),
        }
    }

    fn draw_choices(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let choices = self.choices();
        for (at, (row, (_, title, detail))) in rows_of(area).zip(&choices).enumerate() {
            let role = if at == self.selected { Role::Selection } else { Role::Text };
            canvas.text(Rect { width: 16.min(row.width), ..row }, &format!(" {title:<15}"), role);
            canvas.text(
                Rect { x: row.x + 18, width: row.width.saturating_sub(18), ..row },
                detail,
                Role::Dim,
            );
            canvas.click(row, Click::Row(0, at));
        }
        let below = Rect {
            y: area.y + choices.len() as u16 + 1,
            height: area.height.saturating_sub(choices.len() as u16 + 1),
            ..area
        };
        match &self.runs {
            None => canvas.text(below, "looking for runs …", Role::Dim),
            Some(Err(problem)) => canvas.text(below, &format!("! {problem}"), Role::Bad),
            Some(Ok(_)) => {
                let text = "You set prices, models, quotas, capacity, advertising and development once a week; customers, \
                            rivals and the economy answer. Nothing you confirm is lost: quit whenever you like.";
                for (row, line) in rows_of(below).zip(wrapped(text, below.width as usize)) {
                    canvas.text(row, &line, Role::Dim);
                }
            }
        }
    }

    fn draw_form(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let form = &self.form;
        let value = |at: usize| match at {
            0 => form
                .scenarios
                .get(form.scenario)
                .map_or(String::new(), |(name, title)| format!("‹ {name} › {title}")),
            1 => format!("‹ {} › {}", Mode::ALL[form.mode], Mode::ALL[form.mode].purpose()),
            2 => form.seed.text().to_owned(),
            3 if form.days.is_empty() => "as the scenario says (500)".to_owned(),
            3 => form.days.text().to_owned(),
            4 if form.cash.is_empty() => "as the scenario says ($1,000,000)".to_owned(),
            4 => form.cash.text().to_owned(),
            5 => form.participant.text().to_owned(),
            _ => String::new(),
        };
        for (at, row) in rows_of(area).take(ROWS.len()).enumerate() {
            let here = at == form.at;
            let name = Rect { width: 15.min(row.width), ..row };
            canvas.text(
                name,
                &format!(" {:<14}", ROWS[at].0),
                if here { Role::Selection } else { Role::Text },
            );
            let place = Rect { x: row.x + 17, width: row.width.saturating_sub(17), ..row };
            let field = match at {
                2 => Some(&form.seed),
                3 => Some(&form.days),
                4 => Some(&form.cash),
                5 => Some(&form.participant),
                _ => None,
            };
            match field {
                Some(field) if here => field.draw(canvas, Rect { width: 30.min(place.width), ..place }),
                _ => canvas.text(
                    place,
                    &value(at),
                    if at >= 2 && field.is_some_and(Field::is_empty) { Role::Dim } else { Role::Text },
                ),
            }
            canvas.click(row, Click::Row(0, at));
        }
        let below = Rect {
            y: area.y + ROWS.len() as u16 + 1,
            height: area.height.saturating_sub(ROWS.len() as u16 + 1),
            ..area
        };
        match &form.problem {
            Some(problem) => {
                for (row, line) in rows_of(below).zip(wrapped(problem, below.width as usize)) {
                    canvas.text(row, &line, Role::Bad);
                }
            }
            None => canvas.text(below, ROWS[form.at].1, Role::Dim),
        }
    }

    fn draw_runs(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let from = first_row(self.selected, area.height as usize, self.list().len());
        for (row, (at, run)) in rows_of(area).zip(self.list().iter().enumerate().skip(from)) {
            let role = if at == self.selected { Role::Selection } else { Role::Text };
            canvas.clear(row, role);
            canvas.text(
                Rect { width: row.width.saturating_sub(18), ..row },
                &format!(" {}", describe(run)),
                role,
            );
            let when = run.played.get(..16).unwrap_or("").replace('T', " ");
            canvas.aligned(
                row,
                &format!("{when} "),
                if at == self.selected { role } else { Role::Dim },
                Align::Right,
            );
            canvas.click(row, Click::Row(0, at));
        }
    }
}

fn open(run: &RunSummary) -> Effect {
    Effect::Open(run.id.clone())
}

/// A run in a line.
fn describe(run: &RunSummary) -> String {
    if let Some(problem) = &run.problem {
        return format!("{} cannot be read: {problem}", run.id);
    }
    let mode = run.mode.map_or("", Mode::id);
    let state = match run.ended {
        None => format!("day {} of {}", run.day, run.days),
        Some(Ended::Horizon) => "finished".to_owned(),
        Some(Ended::Bankruptcy) => format!("bankrupt on day {}", run.day),
        Some(Ended::Abandoned) => format!("given up on day {}", run.day),
    };
    let participant = run.participant.as_ref().map_or(String::new(), |label| format!(" · {label}"));
    format!(
        "{state} · {} · {mode} · {} · seed {}{participant}",
        dollars(run.cash),
        run.scenario,
        grouped(run.seed as f64, 0)
    )
}
