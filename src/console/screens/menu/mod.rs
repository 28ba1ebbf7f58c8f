//! The start menu: continue a run, start a run, list and compare runs, show published results, start the tour, and
//! quit.

mod class;
mod compare;
mod home;
mod lessons;
mod new_run_form;
mod path_form;
mod published_results;
mod runs;
#[cfg(test)]
pub(crate) mod tests;

use std::collections::BTreeMap;

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;

use crate::action::{Action, Scope};
use crate::consent::ConsentText;
use crate::effect::Effect;
use crate::tour;
use class::ClassPage;
use home::HomeEntry;
use lessons::LessonList;
use new_run_form::{FORM_ROWS, NewRunForm};
use novamind_course::CollectedClass;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::preview::RunPreview;
use novamind_record::folder::runs::RunSummary;
use novamind_record::mode::Mode;
use novamind_report::class::ClassDisplayOptions;
use novamind_session::Access;
use novamind_tui::canvas::{Align, Canvas};
use novamind_tui::theme::Role;
use novamind_tui::widgets::Table;
use novamind_worker::message::OpenFallback;
use novamind_worker::question::Pending;
use novamind_worker::request::Request;
use novamind_worker::run_folders::PreviewQuestion;
use path_form::{PathForm, PathPurpose};
use runs::MenuQuestion;

/// Minimum window height for a blank row above the page.
const MIN_HEIGHT_FOR_MARGIN: u16 = 26;

const PAGE_ROWS: u16 = 10;

/// Previews of runs by run id. The value is `None` while the preview is being read.
type RunPreviews = BTreeMap<String, Option<Result<RunPreview, String>>>;

/// The start menu.
pub struct StartMenu {
    page: MenuPage,
    runs: Option<Result<Vec<RunSummary>, String>>,
    /// Index of the selected row on pages with a list.
    selected: usize,
    form: NewRunForm,
    table: Table,
    /// Runs marked for comparison, in order of marking.
    marked: Vec<String>,
    previews: RunPreviews,
    reading: Vec<Pending<PreviewQuestion>>,
    question: Option<MenuQuestion>,
    /// Actions that were received before the list of runs arrived. The choices of the start page depend on that list.
    deferred_actions: Vec<Action>,
    /// Lessons, which are read when the lessons page is opened.
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
    PublishedResults,
    PathForm,
    Class,
}

impl StartMenu {
    /// Returns a menu whose list of runs has not arrived yet.
    pub fn new(configuration: &Configuration) -> StartMenu {
        StartMenu {
            page: MenuPage::Home,
            runs: None,
            selected: 0,
            form: NewRunForm::new(configuration),
            table: Table::new(runs::columns()),
            marked: Vec::new(),
            previews: RunPreviews::new(),
            reading: Vec::new(),
            question: None,
            deferred_actions: Vec::new(),
            lessons: LessonList::default(),
            path: PathForm::new(PathPurpose::Class),
            class: None,
            configuration: configuration.clone(),
        }
    }

    /// Stores the list of runs, requests the preview of the last run, and executes the deferred actions.
    pub fn set_runs(&mut self, runs: Result<Vec<RunSummary>, String>) -> Vec<Effect> {
        let choice = self.selected_entry();
        self.runs = Some(runs);
        if self.page == MenuPage::Home {
            // The selected choice stays selected at its new position.
            let same = self.entries().iter().position(|(home_entry, ..)| Some(*home_entry) == choice);
            self.selected = same.unwrap_or(0);
        }
        let known: Vec<String> = self.runs().iter().map(|run| run.id.clone()).collect();
        self.marked.retain(|id| known.contains(id));
        // Runs may have progressed since their previews were read.
        self.previews.clear();
        self.reading.clear();
        self.question = None;
        self.rebuild_table();
        let last = self.runs().first().filter(|run| run.problem.is_none()).map(|run| run.id.clone());
        let mut effects: Vec<Effect> = last.and_then(|id| self.request_preview(&id)).into_iter().collect();
        if self.page == MenuPage::Runs {
            effects.extend(self.request_selected_preview());
        }
        for action in std::mem::take(&mut self.deferred_actions) {
            effects.extend(self.handle_action(action));
        }
        effects
    }

    fn selected_entry(&self) -> Option<HomeEntry> {
        self.entries().get(self.selected).map(|choice| choice.0)
    }

    /// Stores the previews that have arrived.
    pub fn take_answers(&mut self) {
        for (run, preview) in self.reading.iter_mut().filter_map(Pending::try_take) {
            self.previews.insert(run.id, Some(preview.map_err(|rejection| rejection.message)));
        }
        self.reading.retain(Pending::is_waiting);
    }

    /// Reports that a run could not be started or opened, and offers an alternative.
    pub fn show_open_error(&mut self, problem: String, instead: Option<OpenFallback>) {
        // A request for consent is not an error.
        let refused = (!matches!(instead, Some(OpenFallback::AskConsent(..)))).then(|| problem.clone());
        self.question = instead.map(|instead| match instead {
            OpenFallback::AskConsent(new) => MenuQuestion::Consent(new, ConsentText::new(problem)),
            instead => MenuQuestion::OpenError(instead, problem),
        });
        self.path.rejection = refused.clone();
        self.form.rejection = refused;
    }

    /// Shows the results of a class.
    pub fn show_class(&mut self, class: CollectedClass, display_options: ClassDisplayOptions) {
        self.deferred_actions.clear();
        self.class = Some(Box::new(ClassPage::new(class, display_options)));
        self.page = MenuPage::Class;
    }

    /// Requests the preview of a run, unless the preview is known or already requested.
    fn request_preview(&mut self, id: &str) -> Option<Effect> {
        if self.previews.contains_key(id) {
            return None;
        }
        self.previews.insert(id.to_owned(), None);
        let (pending, ask) = Pending::with_question(PreviewQuestion { id: id.to_owned() });
        self.reading.push(pending);
        Some(Effect::Ask(ask))
    }

    fn runs(&self) -> &[RunSummary] {
        match &self.runs {
            Some(Ok(list)) => list,
            _ => &[],
        }
    }

    /// Returns the run that was played last, finished or not.
    fn last_played_run(&self) -> Option<&RunSummary> {
        self.runs().iter().find(|run| run.problem.is_none())
    }

    /// Returns the id of the unfinished run of the tour, if there is one.
    pub fn tour_run(&self) -> Option<&str> {
        let started = |run: &&RunSummary| {
            tour::is_tour_run(&run.scenario, run.seed, run.days)
                && run.ended.is_none()
                && run.problem.is_none()
                && run.mode != Some(Mode::Baseline)
        };
        self.runs().iter().find(started).map(|run| run.id.as_str())
    }

    /// Returns the last index of the list on the current page.
    fn last_index(&self) -> usize {
        let rows = match self.page {
            MenuPage::Home => self.entries().len(),
            MenuPage::NewRun => FORM_ROWS.len(),
            MenuPage::PublishedResults => published_results::rank_results(self.runs()).len(),
            MenuPage::Lessons => self.lessons.len(),
            MenuPage::Runs | MenuPage::Compare | MenuPage::PathForm | MenuPage::Class => 1,
        };
        rows.saturating_sub(1)
    }

    /// Returns the scopes of the current page.
    pub fn scopes(&self) -> Vec<Scope> {
        match self.page {
            _ if matches!(self.question, Some(MenuQuestion::Consent(..))) => vec![Scope::Study, Scope::List],
            _ if self.question.is_some() => vec![Scope::Dialog],
            MenuPage::Runs if self.table.is_filter_open() => vec![Scope::Field],
            MenuPage::NewRun if self.form.is_typing() => vec![Scope::Field],
            MenuPage::PathForm => vec![Scope::Field],
            MenuPage::Class => vec![Scope::Class, Scope::List],
            MenuPage::NewRun | MenuPage::Lessons | MenuPage::Compare | MenuPage::PublishedResults => {
                vec![Scope::List]
            }
            MenuPage::Home | MenuPage::Runs => vec![Scope::Menu, Scope::List],
        }
    }

    /// Returns the actions to show in the footer.
    pub fn hints(&self) -> Vec<Action> {
        match self.page {
            _ if matches!(self.question, Some(MenuQuestion::Consent(..))) => {
                vec![Action::Agree, Action::Decline]
            }
            _ if self.question.is_some() => vec![Action::Confirm, Action::Cancel],
            MenuPage::Home if self.last_played_run().is_none() => {
                vec![Action::Open, Action::NewRun, Action::Quit]
            }
            MenuPage::Home => vec![Action::Open, Action::NewRun, Action::ContinueRun, Action::Quit],
            MenuPage::NewRun if self.form.is_typing() => vec![Action::Commit, Action::Discard],
            MenuPage::PathForm => vec![Action::Commit, Action::Discard],
            MenuPage::Class => self.class.as_ref().map(|page| page.hints()).unwrap_or_default(),
            MenuPage::NewRun => vec![Action::Open, Action::Left, Action::Right, Action::Close],
            MenuPage::Runs if self.table.is_filter_open() => vec![Action::Commit, Action::Discard],
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
            MenuPage::Compare | MenuPage::PublishedResults => vec![Action::Close, Action::Quit],
        }
    }

    fn selection_mut(&mut self) -> &mut usize {
        match self.page {
            MenuPage::NewRun => &mut self.form.selected_row,
            _ => &mut self.selected,
        }
    }

    fn go_home(&mut self) {
        (self.page, self.selected) = (MenuPage::Home, 0);
    }

    /// Handles an action on the current page.
    pub fn handle_action(&mut self, action: Action) -> Vec<Effect> {
        if self.question.is_some() {
            return self.answer_question(action);
        }
        match (action, self.page) {
            (Action::NewRun, _) => self.open_form(),
            (_, MenuPage::Home) if self.runs.is_none() => self.deferred_actions.push(action),
            (Action::ContinueRun, _) => return self.open_latest(),
            (Action::ReplayRun, MenuPage::Home) => return self.replay_effects(self.runs().first()),
            (_, MenuPage::Runs) => return self.handle_runs_action(action),
            (Action::Close | Action::Discard, MenuPage::Compare) => self.page = MenuPage::Runs,
            (Action::Discard, MenuPage::NewRun) if self.form.is_typing() => self.form.discard_edit(),
            (Action::Close | Action::Discard, _) => self.go_home(),
            (Action::Left | Action::Right, MenuPage::NewRun) => {
                self.form.change_choice(action == Action::Right);
                self.form.read_terms(&self.configuration);
            }
            (Action::Open | Action::Commit, MenuPage::NewRun) => {
                let effects = self.form.accept_row();
                self.form.read_terms(&self.configuration);
                return effects;
            }
            (Action::Open, MenuPage::Home) => return self.activate(),
            (Action::Commit, MenuPage::PathForm) => return self.path.open_path(),
            (_, MenuPage::Class) => {
                if let Some(page) = &mut self.class {
                    page.handle_action(action);
                }
            }
            (Action::Open, MenuPage::Lessons) => return self.lessons.start_lesson(self.selected),
            _ => self.move_selection(action),
        }
        Vec::new()
    }

    fn move_selection(&mut self, action: Action) {
        self.form.commit_edit();
        let (last, page) = (self.last_index(), PAGE_ROWS as usize);
        let place = self.selection_mut();
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
        self.deferred_actions.clear();
        self.page = MenuPage::NewRun;
        self.form = NewRunForm::new(&self.configuration);
        self.form.read_terms(&self.configuration);
    }

    fn open_latest(&self) -> Vec<Effect> {
        match self.last_played_run() {
            Some(run) => vec![Effect::Request(Request::Open(run.id.clone(), Access::Write))],
            None => vec![Effect::ShowError("No run yet. Start one with n.".to_owned())],
        }
    }

    fn activate(&mut self) -> Vec<Effect> {
        match self.selected_entry() {
            Some(HomeEntry::Continue) => return self.open_latest(),
            Some(HomeEntry::Tour) => return vec![Effect::StartTour],
            Some(HomeEntry::New) => self.open_form(),
            Some(HomeEntry::Lessons) => {
                self.lessons = LessonList::load(&self.configuration);
                (self.page, self.selected) = (MenuPage::Lessons, 0);
            }
            Some(HomeEntry::Handout) => self.open_path_form(PathPurpose::Handout),
            Some(HomeEntry::Class) => self.open_path_form(PathPurpose::Class),
            Some(HomeEntry::Runs) => return self.open_runs(),
            Some(HomeEntry::Compare) => {
                let mut effects = self.open_runs();
                effects.push(Effect::ShowStatus("Mark two or more runs, then compare".to_owned()));
                return effects;
            }
            Some(HomeEntry::PublishedResults) => (self.page, self.selected) = (MenuPage::PublishedResults, 0),
            Some(HomeEntry::Quit) => return vec![Effect::Execute(Action::Quit)],
            None => {}
        }
        Vec::new()
    }

    fn open_path_form(&mut self, wanted: PathPurpose) {
        self.path = PathForm::new(wanted);
        self.page = MenuPage::PathForm;
    }

    fn open_runs(&mut self) -> Vec<Effect> {
        self.page = MenuPage::Runs;
        self.request_selected_preview()
    }

    /// Handles a key that is typed into a field.
    pub fn handle_key(&mut self, key: &KeyEvent) -> Vec<Effect> {
        match self.page {
            MenuPage::NewRun => return self.form.handle_key(key),
            MenuPage::PathForm => self.path.handle_key(key),
            MenuPage::Runs if self.table.is_filter_open() => self.table.edit_filter(|field| {
                field.handle_key(key);
            }),
            _ if key.code == KeyCode::Char('q') && self.question.is_none() => {
                return vec![Effect::Execute(Action::Quit)];
            }
            _ => {}
        }
        Vec::new()
    }

    /// Handles text that is pasted into a field.
    pub fn paste(&mut self, text: &str) {
        match self.page {
            MenuPage::NewRun => self.form.paste(text),
            MenuPage::PathForm => self.path.paste(text),
            MenuPage::Runs => self.table.edit_filter(|field| field.insert(text.trim())),
            _ => {}
        }
    }

    /// Handles a click on a row. The first click selects the row, and the second click opens it.
    pub fn handle_click(&mut self, row: usize) -> Vec<Effect> {
        if self.question.is_some() {
            return Vec::new();
        }
        if self.page == MenuPage::Runs {
            let before = self.table.selected();
            self.table.select_visible_row(row);
            let again = before == self.table.selected();
            return if again { self.handle_action(Action::Open) } else { self.request_selected_preview() };
        }
        if let (MenuPage::Class, Some(page)) = (self.page, &mut self.class) {
            page.highlight(row);
            return Vec::new();
        }
        let row = row.min(self.last_index());
        self.form.commit_edit();
        let again = *self.selection_mut() == row;
        *self.selection_mut() = row;
        if again && !(self.page == MenuPage::NewRun && row < FORM_ROWS.len() - 1) {
            self.handle_action(Action::Open)
        } else {
            Vec::new()
        }
    }

    /// Draws the current page below the program name.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        if let (MenuPage::Class, Some(page)) = (self.page, &self.class) {
            page.draw(canvas, area);
            return self.draw_open_error(canvas, area);
        }
        let version = concat!("version ", env!("CARGO_PKG_VERSION"), " ");
        let name = Rect { x: area.x + 2, y: area.y + 1, width: area.width.saturating_sub(3), height: 1 };
        canvas.draw_text(name, "▲  N O V A M I N D", Role::Title);
        canvas.draw_aligned(name, version, Role::Dim, Align::Right);
        let line = Rect { x: name.x + 3, y: name.y + 1, width: name.width.saturating_sub(3), ..name };
        canvas.draw_text(line, "one company, five hundred days, every decision yours", Role::Dim);
        // In small windows, the page uses the last blank row.
        let above = if area.height < MIN_HEIGHT_FOR_MARGIN { 3 } else { 4 };
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
            MenuPage::PublishedResults => self.draw_published_results(canvas, body),
            MenuPage::PathForm => self.path.draw(canvas, body),
            MenuPage::Class => {}
        }
        self.draw_open_error(canvas, body);
    }
}
