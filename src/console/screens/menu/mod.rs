//! Start menu: continue, new run, runs, comparison, published results, tour, quit.

mod class;
mod compare;
mod form;
mod home;
mod lessons;
mod paper;
mod path_form;
mod runs;
#[cfg(test)]
pub(crate) mod tests;

use std::collections::BTreeMap;

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;

use crate::action::{Action, Scope};
use crate::agreement::Agreement;
use crate::effect::Effect;
use crate::tour;
use class::ClassPage;
use form::{ROWS, RunForm};
use home::HomeEntry;
use lessons::LessonList;
use novamind_course::CollectedClass;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::preview::RunPreview;
use novamind_record::folder::runs::RunSummary;
use novamind_record::mode::Mode;
use novamind_report::class::Shown;
use novamind_session::Access;
use novamind_tui::canvas::{Align, Canvas};
use novamind_tui::theme::Role;
use novamind_tui::widgets::Table;
use novamind_worker::asking::Pending;
use novamind_worker::folder::PreviewQuestion;
use novamind_worker::message::Instead;
use novamind_worker::request::Request;
use path_form::{PathForm, PathWanted};
use runs::Asked;

/// Window height below which the page has no blank row above it.
const LOW: u16 = 26;

const PAGE: u16 = 10;

/// Previews of runs by name; `None` while a preview is read.
type Previews = BTreeMap<String, Option<Result<RunPreview, String>>>;

/// The start menu.
pub struct Menu {
    page: MenuPage,
    runs: Option<Result<Vec<RunSummary>, String>>,
    /// Index of the selection on list pages.
    selected: usize,
    form: RunForm,
    table: Table,
    /// Runs marked for comparison, in order of marking.
    marked: Vec<String>,
    previews: Previews,
    reading: Vec<Pending<PreviewQuestion>>,
    asked: Option<Asked>,
    /// Actions received before the runs were listed. The choices of the start page depend on the runs.
    early: Vec<Action>,
    /// Lessons, read when their page was opened.
    lessons: LessonList,
    path: PathForm,
    class: Option<Box<ClassPage>>,
    configuration: Configuration,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum MenuPage {
    Home,
    NewRun,
    Lessons,
    Runs,
    Compare,
    Paper,
    Path,
    Class,
}

impl Menu {
    /// Creates the menu before the runs are known.
    pub fn new(configuration: &Configuration) -> Menu {
        Menu {
            page: MenuPage::Home,
            runs: None,
            selected: 0,
            form: RunForm::new(configuration),
            table: Table::new(runs::columns()),
            marked: Vec::new(),
            previews: Previews::new(),
            reading: Vec::new(),
            asked: None,
            early: Vec::new(),
            lessons: LessonList::default(),
            path: PathForm::new(PathWanted::Class),
            class: None,
            configuration: configuration.clone(),
        }
    }

    /// Stores the list of runs, requests the preview of the last one, and runs the delayed actions.
    pub fn take(&mut self, runs: Result<Vec<RunSummary>, String>) -> Vec<Effect> {
        let choice = self.chosen_choice();
        self.runs = Some(runs);
        if self.page == MenuPage::Home {
            // Select the same choice at its new position.
            let same = self.choices().iter().position(|(own, ..)| Some(*own) == choice);
            self.selected = same.unwrap_or(0);
        }
        let known: Vec<String> = self.list().iter().map(|run| run.id.clone()).collect();
        self.marked.retain(|id| known.contains(id));
        // Runs may have progressed since.
        self.previews.clear();
        self.reading.clear();
        self.asked = None;
        self.renew_table();
        let last = self.list().first().filter(|run| run.problem.is_none()).map(|run| run.id.clone());
        let mut effects: Vec<Effect> = last.and_then(|id| self.read(&id)).into_iter().collect();
        if self.page == MenuPage::Runs {
            effects.extend(self.read_chosen());
        }
        for action in std::mem::take(&mut self.early) {
            effects.extend(self.act(action));
        }
        effects
    }

    fn chosen_choice(&self) -> Option<HomeEntry> {
        self.choices().get(self.selected).map(|choice| choice.0)
    }

    /// Collects previews that have arrived.
    pub fn take_answers(&mut self) {
        for (run, preview) in self.reading.iter_mut().filter_map(Pending::try_take) {
            self.previews.insert(run.id, Some(preview.map_err(|refusal| refusal.message)));
        }
        self.reading.retain(Pending::is_waiting);
    }

    /// Reports that a run could not be started or opened, and asks what to do instead.
    pub fn refused(&mut self, problem: String, instead: Option<Instead>) {
        // A request for consent is not an error.
        let refused = (!matches!(instead, Some(Instead::Agree(..)))).then(|| problem.clone());
        self.asked = instead.map(|instead| match instead {
            Instead::Agree(new) => Asked::Agree(new, Agreement::new(problem)),
            instead => Asked::Instead(instead, problem),
        });
        self.path.refused = refused.clone();
        self.form.refused = refused;
    }

    /// Shows the results of a class.
    pub fn show_class(&mut self, class: CollectedClass, shown: Shown) {
        self.early.clear();
        self.class = Some(Box::new(ClassPage::new(class, shown)));
        self.page = MenuPage::Class;
    }

    /// Requests the preview of a run, unless it is known or requested.
    fn read(&mut self, id: &str) -> Option<Effect> {
        if self.previews.contains_key(id) {
            return None;
        }
        self.previews.insert(id.to_owned(), None);
        let (pending, ask) = Pending::asking(PreviewQuestion { id: id.to_owned() });
        self.reading.push(pending);
        Some(Effect::Ask(ask))
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

    /// Returns the unfinished run of the tour, if there is one.
    pub fn practice(&self) -> Option<&str> {
        let begun = |run: &&RunSummary| {
            run.scenario == tour::scenario()
                && run.ended.is_none()
                && run.problem.is_none()
                && run.mode != Some(Mode::Baseline)
        };
        self.list().iter().find(begun).map(|run| run.id.as_str())
    }

    /// Returns the last index on list pages.
    fn last(&self) -> usize {
        let rows = match self.page {
            MenuPage::Home => self.choices().len(),
            MenuPage::NewRun => ROWS.len(),
            MenuPage::Paper => paper::ranked(self.list()).len(),
            MenuPage::Lessons => self.lessons.count(),
            MenuPage::Runs | MenuPage::Compare | MenuPage::Path | MenuPage::Class => 1,
        };
        rows.saturating_sub(1)
    }

    /// Returns the scopes of the page.
    pub fn scopes(&self) -> Vec<Scope> {
        match self.page {
            _ if matches!(self.asked, Some(Asked::Agree(..))) => vec![Scope::Visit, Scope::List],
            _ if self.asked.is_some() => vec![Scope::Dialog],
            MenuPage::Runs if self.table.is_typing() => vec![Scope::Field],
            MenuPage::NewRun if self.form.is_typing() => vec![Scope::Field],
            MenuPage::Path => vec![Scope::Field],
            MenuPage::Class => vec![Scope::Class, Scope::List],
            MenuPage::NewRun | MenuPage::Lessons | MenuPage::Compare | MenuPage::Paper => vec![Scope::List],
            MenuPage::Home | MenuPage::Runs => vec![Scope::Menu, Scope::List],
        }
    }

    /// Returns the footer actions.
    pub fn hints(&self) -> Vec<Action> {
        match self.page {
            _ if matches!(self.asked, Some(Asked::Agree(..))) => vec![Action::Agree, Action::Decline],
            _ if self.asked.is_some() => vec![Action::Confirm, Action::Cancel],
            MenuPage::Home if self.latest().is_none() => vec![Action::Open, Action::NewRun, Action::Quit],
            MenuPage::Home => vec![Action::Open, Action::NewRun, Action::ContinueRun, Action::Quit],
            MenuPage::NewRun if self.form.is_typing() => vec![Action::Commit, Action::Discard],
            MenuPage::Path => vec![Action::Commit, Action::Discard],
            MenuPage::Class => self.class.as_ref().map(|page| page.hints()).unwrap_or_default(),
            MenuPage::NewRun => vec![Action::Open, Action::Left, Action::Right, Action::Close],
            MenuPage::Runs if self.table.is_typing() => vec![Action::Commit, Action::Discard],
            MenuPage::Runs => vec![
                Action::Open,
                Action::ReplayRun,
                Action::MarkRun,
                Action::CompareRuns,
                Action::EndRun,
                Action::DeleteRun,
                Action::Close,
                Action::Filter,
                Action::Sort,
            ],
            MenuPage::Lessons => vec![Action::Open, Action::Up, Action::Down, Action::Close],
            MenuPage::Compare | MenuPage::Paper => vec![Action::Close, Action::Quit],
        }
    }

    fn place(&mut self) -> &mut usize {
        match self.page {
            MenuPage::NewRun => &mut self.form.at,
            _ => &mut self.selected,
        }
    }

    fn go_home(&mut self) {
        (self.page, self.selected) = (MenuPage::Home, 0);
    }

    /// Runs an action.
    pub fn act(&mut self, action: Action) -> Vec<Effect> {
        if self.asked.is_some() {
            return self.answer(action);
        }
        match (action, self.page) {
            (Action::NewRun, _) => self.open_form(),
            (_, MenuPage::Home) if self.runs.is_none() => self.early.push(action),
            (Action::ContinueRun, _) => return self.open_latest(),
            (Action::ReplayRun, MenuPage::Home) => return self.replay(self.list().first()),
            (_, MenuPage::Runs) => return self.act_on_runs(action),
            (Action::Close | Action::Discard, MenuPage::Compare) => self.page = MenuPage::Runs,
            (Action::Close | Action::Discard, _) => self.go_home(),
            (Action::Left | Action::Right, MenuPage::NewRun) => {
                self.form.turn(action == Action::Right);
                self.form.read_terms(&self.configuration);
            }
            (Action::Open | Action::Commit, MenuPage::NewRun) => return self.form.enter(),
            (Action::Open, MenuPage::Home) => return self.choose(),
            (Action::Commit, MenuPage::Path) => return self.path.enter(),
            (_, MenuPage::Class) => {
                if let Some(page) = &mut self.class {
                    page.act(action);
                }
            }
            (Action::Open, MenuPage::Lessons) => return self.lessons.begin(self.selected),
            _ => self.walk(action),
        }
        Vec::new()
    }

    fn walk(&mut self, action: Action) {
        let (last, page) = (self.last(), PAGE as usize);
        let place = self.place();
        *place = match action {
            Action::Up | Action::CommitPrevious => place.saturating_sub(1),
            Action::Down | Action::CommitDown | Action::CommitNext => *place + 1,
            Action::PageUp => place.saturating_sub(page),
            Action::PageDown => *place + page,
            Action::First => 0,
            Action::Last => last,
            _ => *place,
        }
        .min(last);
    }

    fn open_form(&mut self) {
        self.early.clear();
        self.page = MenuPage::NewRun;
        self.form = RunForm::new(&self.configuration);
        self.form.read_terms(&self.configuration);
    }

    fn open_latest(&self) -> Vec<Effect> {
        match self.latest() {
            Some(run) => vec![Effect::Request(Request::Open(run.id.clone(), Access::Write))],
            None => vec![Effect::Complain("No unfinished run. Start one with n.".to_owned())],
        }
    }

    fn choose(&mut self) -> Vec<Effect> {
        match self.chosen_choice() {
            Some(HomeEntry::Continue) => return self.open_latest(),
            Some(HomeEntry::Tour) => return vec![Effect::StartTour],
            Some(HomeEntry::New) => self.open_form(),
            Some(HomeEntry::Lessons) => {
                self.lessons = LessonList::of(&self.configuration);
                (self.page, self.selected) = (MenuPage::Lessons, 0);
            }
            Some(HomeEntry::Handout) => self.ask_path(PathWanted::Handout),
            Some(HomeEntry::Class) => self.ask_path(PathWanted::Class),
            Some(HomeEntry::Runs) => return self.open_runs(),
            Some(HomeEntry::Compare) => {
                let mut effects = self.open_runs();
                effects.push(Effect::Say("Mark two or more, then compare".to_owned()));
                return effects;
            }
            Some(HomeEntry::Paper) => (self.page, self.selected) = (MenuPage::Paper, 0),
            Some(HomeEntry::Quit) => return vec![Effect::Do(Action::Quit)],
            None => {}
        }
        Vec::new()
    }

    fn ask_path(&mut self, wanted: PathWanted) {
        self.path = PathForm::new(wanted);
        self.page = MenuPage::Path;
    }

    fn open_runs(&mut self) -> Vec<Effect> {
        self.page = MenuPage::Runs;
        self.read_chosen()
    }

    /// Handles a typed key.
    pub fn key(&mut self, key: &KeyEvent) -> Vec<Effect> {
        match self.page {
            MenuPage::NewRun => self.form.key(key),
            MenuPage::Path => self.path.key(key),
            MenuPage::Runs if self.table.is_typing() => self.table.edit_filter(|field| {
                field.key(key);
            }),
            _ if key.code == KeyCode::Char('q') && self.asked.is_none() => {
                return vec![Effect::Do(Action::Quit)];
            }
            _ => {}
        }
        Vec::new()
    }

    /// Handles pasted text.
    pub fn paste(&mut self, text: &str) {
        match self.page {
            MenuPage::NewRun => self.form.paste(text),
            MenuPage::Path => self.path.paste(text),
            MenuPage::Runs => self.table.edit_filter(|field| field.insert(text.trim())),
            _ => {}
        }
    }

    /// Handles a click on a row: the first selects it, the second opens it.
    pub fn click(&mut self, row: usize) -> Vec<Effect> {
        if self.asked.is_some() {
            return Vec::new();
        }
        if self.page == MenuPage::Runs {
            let before = self.table.selected();
            self.table.select_place(row);
            let again = before == self.table.selected();
            return if again { self.act(Action::Open) } else { self.read_chosen() };
        }
        if let (MenuPage::Class, Some(page)) = (self.page, &mut self.class) {
            page.light(row);
            return Vec::new();
        }
        let row = row.min(self.last());
        let again = *self.place() == row;
        *self.place() = row;
        if again && !(self.page == MenuPage::NewRun && row < ROWS.len() - 1) {
            self.act(Action::Open)
        } else {
            Vec::new()
        }
    }

    /// Draws the page below the program name.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        if let (MenuPage::Class, Some(page)) = (self.page, &self.class) {
            page.draw(canvas, area);
            return self.draw_instead(canvas, area);
        }
        let version = concat!("version ", env!("CARGO_PKG_VERSION"), " ");
        let name = Rect { x: area.x + 2, y: area.y + 1, width: area.width.saturating_sub(3), height: 1 };
        canvas.text(name, "▲  N O V A M I N D", Role::Title);
        canvas.aligned(name, version, Role::Dim, Align::Right);
        let line = Rect { x: name.x + 3, y: name.y + 1, width: name.width.saturating_sub(3), ..name };
        canvas.text(line, "one company, five hundred days, every decision yours", Role::Dim);
        // Low windows give the last blank row to the page.
        let above = if area.height < LOW { 3 } else { 4 };
        let body = Rect {
            x: area.x + 2,
            y: area.y + above,
            width: area.width.saturating_sub(4),
            height: area.height.saturating_sub(above),
        };
        match self.page {
            MenuPage::Home => self.draw_home(canvas, body),
            MenuPage::NewRun => self.form.draw(canvas, body),
            MenuPage::Lessons => self.lessons.draw(canvas, body, self.selected),
            MenuPage::Runs => self.draw_runs(canvas, body),
            MenuPage::Compare => self.draw_compare(canvas, body),
            MenuPage::Paper => self.draw_paper(canvas, body),
            MenuPage::Path => self.path.draw(canvas, body),
            MenuPage::Class => {}
        }
        self.draw_instead(canvas, body);
    }
}
