//! State of the console: messages become actions, actions change the state and produce orders for the worker.
//!
//! The state never blocks, reads a file or draws. Slow work is returned as an [`Order`], and its result arrives as a
//! message.

mod activity_log;
mod breadcrumbs;
mod busy;
mod columns;
mod drafts;
mod exit;
mod external_editor;
mod guide;
mod ineffective_key;
mod input;
mod layers;
mod lesson;
mod orders;
mod overlay;
mod own_commands;
mod pages;
mod pause_screen;
mod playback;
mod responses;
mod settings;
mod study;
mod time_limits;

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use ratatui::layout::Rect;

use super::action::{Action, Scope};
use super::attention::{EditSource, PresenceWatch, Stopwatch, TypingLog};
use super::context::{EditorDocument, ScreenContext, ScreenId};
use super::dialogs::Dialog;
use super::dialogs::next_week::NextWeekDialog;
use super::effect::Effect;
use super::hosted::hosted_keys;
use super::keys::KeyBindings;
use super::own_commands::{OwnCommands, ProgramCall};
use super::playback::PlaybackViewer;
use super::screens::menu::StartMenu;
use super::screens::{Screen, Screens};
use super::study_pages::{StudyPage, StudyState};
use super::tour::Tour;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::query_library::QueryLibrary;
use novamind_report::RunReport;
use novamind_report::opponents::PlayOpponentsFn;
use novamind_session::TimeLeft;
use novamind_tui::canvas::Click;
use novamind_tui::chord::Chord;
use novamind_tui::glyphs::Glyphs;
use novamind_tui::theme::Theme;
use novamind_tui::widgets::ColumnLayout;
use novamind_worker::Job;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::message::{Message, SimulatedDay};
use novamind_worker::preferences::Preferences;
use novamind_worker::question::{OutgoingQuestion, Pending};
use novamind_worker::request::Request;
use novamind_worker::screen_queries::Reading;

pub use busy::BusyState;
use exit::ExitTarget;
pub use layers::Layer;
use layers::Layers;
pub use pause_screen::PauseScreen;
pub use settings::Settings;

const MAX_SCREEN_HISTORY: usize = 50;

/// Work that the application requests from the main loop and the worker threads.
pub enum Order {
    /// Send a job to the session thread.
    Job(Job),
    /// Send the question of a page to the worker. The flag is true while other work is running.
    Ask(OutgoingQuestion, bool),
    /// Stop the user's query and other running work of the user.
    CancelQuery,
    /// Copy text to the clipboard of the terminal.
    Copy(String),
    /// Write files with these paths and contents.
    Write(Vec<(PathBuf, Vec<u8>)>),
    /// Save a named query. The strings are the name, the title and the statement of the query.
    SaveQuery(Configuration, [String; 3]),
    /// Run an external program of the user.
    RunProgram(ProgramCall),
    /// Open a text in the user's editor.
    OpenEditor(EditorDocument),
    /// Redraw the whole window.
    Redraw,
    /// Capture the mouse (`true`) or leave the mouse to the terminal (`false`).
    Mouse(bool),
    /// Exit, with an exit code and a text to print.
    Exit(u8, Option<String>),
}

impl Order {
    /// Returns whether the order is executed in a hosted session. Orders that write files of the user's choice or start
    /// programs are dropped, regardless of what requested them.
    fn is_executed_in_hosted_session(&self) -> bool {
        match self {
            Order::Job(Job::SavePreferences(_))
            | Order::Write(_)
            | Order::SaveQuery(..)
            | Order::RunProgram(_)
            | Order::OpenEditor(_) => false,
            Order::Job(_)
            | Order::Ask(..)
            | Order::CancelQuery
            | Order::Copy(_)
            | Order::Redraw
            | Order::Mouse(_)
            | Order::Exit(..) => true,
        }
    }
}

/// A status message in the footer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatusMessage {
    /// The text of the message.
    pub text: String,
    /// Whether the message reports an error or a rejection.
    pub is_error: bool,
}

/// Progress of a simulation of several days.
#[derive(Debug, Clone, Copy)]
pub struct SimulationProgress {
    /// The day before the first simulated day.
    pub from: u32,
    /// The last day to simulate.
    pub to: u32,
    /// The day that was simulated last.
    pub current: u32,
    /// Figures of the current day, if that day was simulated for the first time.
    pub figures: Option<SimulatedDay>,
}

impl SimulationProgress {
    /// Returns the progress before the first day is simulated.
    pub fn new(from: u32, to: u32) -> SimulationProgress {
        SimulationProgress { from, to, current: from, figures: None }
    }
}

/// The part of the program that the user is in.
pub enum Stage {
    /// The start menu.
    Menu(Box<StartMenu>),
    /// An open run.
    Run(Box<Run>),
    /// A page of a study.
    Study(Box<StudyPage>),
}

/// A run that is open in the console.
pub struct Run {
    /// The displayed state of the company.
    pub company: Arc<DisplayedCompany>,
    /// The current screen.
    pub screen: ScreenId,
    /// Screens shown before the current screen, the latest last.
    pub back_history: Vec<ScreenId>,
    /// Breadcrumbs: the screens from which the current screen was opened, the latest last.
    breadcrumbs: Vec<breadcrumbs::Breadcrumb>,
    /// Screens that were left with `back`, the latest last.
    pub forward_history: Vec<ScreenId>,
    /// Whether the focused pane fills the screen.
    pub zoomed: bool,
    shown_since: Option<Duration>,
    previous_screen: Option<ScreenId>,
    /// The open object: its screen, kind and name.
    selected: Option<(ScreenId, &'static str, String)>,
    /// All screens of the run.
    pub screens: Screens,
    /// The next-week dialog.
    pub next_week: NextWeekDialog,
    /// The run report, after the run has ended and the report was built.
    pub run_report: Option<Arc<RunReport>>,
    /// Screen queries requested since the run last changed.
    pub requested_queries: BTreeMap<Reading, Pending<Reading>>,
    /// The tour, while it is shown.
    pub tour: Option<Tour>,
    /// Playback state, if a recorded run is being replayed.
    pub playback: Option<PlaybackViewer>,
    /// State of the lesson that the run belongs to.
    pub lesson: lesson::LessonState,
    overlay: overlay::HiddenValuesOverlay,
    /// Remaining time until each time limit.
    pub time_left: Vec<TimeLeft>,
    /// Reason why the database is behind the run; `None` if the database is up to date.
    pub database_error: Option<String>,
}

impl Run {
    /// Shows a screen, and marks the items of the previous and the new screen as seen.
    fn set_screen(&mut self, screen: ScreenId) {
        self.screens.get_mut(self.screen).mark_seen();
        self.screen = screen;
        self.zoomed = false;
        self.screens.get_mut(screen).mark_seen();
    }
}

/// State of the console.
pub struct App {
    /// Colors of the console.
    pub theme: Theme,
    /// Key bindings.
    pub keys: KeyBindings,
    /// Characters that are used to draw charts.
    pub glyphs: Glyphs,
    /// Whether the console captures the mouse.
    pub mouse: bool,
    themes: Vec<Theme>,
    configuration: Configuration,
    library: QueryLibrary,
    /// Commands of the user.
    own_commands: OwnCommands,
    /// Lines of an own command that are being executed.
    own_lines: own_commands::LineQueue,
    resume_command: String,
    /// Whether the session runs on a server, for a participant who uses only the screen.
    pub is_hosted: bool,
    /// The part of the program that the user is in.
    pub stage: Stage,
    /// Dialogs, the topmost last.
    pub layers: Layers,
    /// The screen shown while the clock is stopped.
    pub pause_screen: Option<PauseScreen>,
    /// Stopwatch that measures active time.
    pub stopwatch: Stopwatch,
    presence: PresenceWatch,
    typing_log: TypingLog,
    edit_source: EditSource,
    explained_term: Option<String>,
    /// Whether the study has an experimenter's code.
    pub has_code: bool,
    drafts: drafts::DraftState,
    /// The status message in the footer.
    pub status: Option<StatusMessage>,
    /// Work that the user waits for.
    pub busy: Option<BusyState>,
    /// Chords of an unfinished key sequence.
    pub pending_chords: Vec<Chord>,
    /// Whether a text is open in the user's editor.
    is_editing_externally: bool,
    key_effects: ineffective_key::KeyEffects,
    opponents: PlayOpponentsFn,
    exit_target: Option<ExitTarget>,
    /// The initial screen of the run that is being opened, if not the default.
    initial_screen: Option<ScreenId>,
    /// Whether the run is drawn for a projector.
    pub is_projected: bool,
    starts_tour: bool,
    study: Option<StudyState>,
    time_limit: time_limits::TimeLimitState,
    /// Layouts of the columns by the name of the table.
    column_layouts: BTreeMap<String, ColumnLayout>,
    /// Clickable areas of the last frame.
    pub clicks: Vec<(Rect, Click)>,
    /// Rows of the focused list in the last frame.
    pub page_rows: u16,
    /// Columns and rows of the window in the last frame.
    pub window: (u16, u16),
    orders: Vec<Order>,
}

impl App {
    /// Returns a console in its start menu.
    pub fn new(settings: Settings) -> App {
        let menu = Box::new(StartMenu::new(&settings.configuration));
        let library = QueryLibrary::load(&settings.configuration);
        let column_layouts = Preferences::load(&settings.configuration).tables;
        let own_commands = match settings.hosted {
            true => OwnCommands::default(),
            false => OwnCommands::load(&settings.configuration, &settings.keys, &library),
        };
        let status = own_commands.problem_summary().map(|text| StatusMessage { text, is_error: true });
        App {
            library,
            own_commands,
            own_lines: own_commands::LineQueue::default(),
            theme: settings.theme,
            keys: if settings.hosted { hosted_keys(settings.keys) } else { settings.keys },
            is_hosted: settings.hosted,
            glyphs: settings.glyphs,
            mouse: true,
            themes: crate::themes::all_themes(&settings.configuration),
            configuration: settings.configuration,
            resume_command: settings.resume_command,
            stage: Stage::Menu(menu),
            layers: Layers::default(),
            pause_screen: None,
            stopwatch: Stopwatch::default(),
            presence: PresenceWatch::default(),
            typing_log: TypingLog::default(),
            edit_source: EditSource::Typed,
            explained_term: None,
            has_code: false,
            drafts: drafts::DraftState::default(),
            status,
            busy: None,
            pending_chords: Vec::new(),
            is_editing_externally: false,
            key_effects: ineffective_key::KeyEffects::default(),
            opponents: settings.opponents,
            exit_target: None,
            initial_screen: None,
            is_projected: false,
            starts_tour: false,
            study: None,
            time_limit: time_limits::TimeLimitState::default(),
            column_layouts,
            clicks: Vec::new(),
            page_rows: 10,
            window: (0, 0),
            orders: vec![Order::Job(Job::Execute(Request::ListRuns))],
        }
    }

    /// Opens or creates a run in place of the start menu.
    pub fn start(&mut self, effect: Effect) {
        self.execute_effects(vec![effect]);
    }

    /// Handles a message. Orders that result from the message are collected for [`App::take_orders`].
    pub fn handle_message(&mut self, message: Message) {
        match message {
            Message::Input(event) => self.handle_input(event),
            Message::Response(news) => self.handle_response(news),
            Message::Delivered(delivery) => {
                delivery.deliver();
                self.take_answers();
            }
            Message::EditorClosed(result) => self.finish_external_edit(result),
            Message::Signal(number) => self.exit_run(ExitTarget::Signal(number)),
            Message::RedrawDue => {
                if self.busy.as_ref().is_some_and(|busy| busy.is_stopping_script) {
                    self.orders.push(Order::CancelQuery);
                }
                self.handle_time();
            }
        }
        self.advance_tour();
        self.enforce_week_limit();
        self.show_due_questions();
        self.apply_column_layouts();
        self.record_user_state();
    }

    /// Removes and returns all collected orders.
    pub fn take_orders(&mut self) -> Vec<Order> {
        let mut orders = std::mem::take(&mut self.orders);
        if self.is_hosted {
            orders.retain(Order::is_executed_in_hosted_session);
        }
        orders
    }

    /// Removes and returns the orders for the session thread. Other orders stay collected.
    pub fn take_jobs(&mut self) -> Vec<Job> {
        let (jobs, others) = self.take_orders().into_iter().partition(|order| matches!(order, Order::Job(_)));
        self.orders = others;
        let job = |order: Order| if let Order::Job(job) = order { Some(job) } else { None };
        Vec::into_iter(jobs).filter_map(job).collect()
    }

    /// Returns the open run.
    pub fn run(&self) -> Option<&Run> {
        match &self.stage {
            Stage::Run(run) => Some(run),
            Stage::Menu(_) | Stage::Study(_) => None,
        }
    }

    /// Returns whether the user waits for a query, a script or a week. The footer shows the elapsed time.
    pub fn is_waiting(&self) -> bool {
        self.busy.is_some() || self.run().is_some_and(|run| run.screens.sql.is_running())
    }

    /// Returns the scopes of the focused pane or dialog, the innermost first.
    pub fn scopes(&self) -> Vec<Scope> {
        let mut scopes = match (self.layers.top(), &self.stage) {
            (Some(Layer::Dialog(dialog)), _) => return dialog.scopes(),
            (Some(Layer::NextWeek), Stage::Run(run)) => return run.next_week.scopes(),
            (_, Stage::Menu(menu)) => return menu.scopes(),
            (_, Stage::Study(page)) => return page.scopes(),
            (None, Stage::Run(run)) => run.scopes(),
        };
        scopes.push(Scope::Global);
        scopes
    }

    /// Returns whether keys type characters: the focused pane or dialog is in edit mode.
    pub fn is_editing_text(&self) -> bool {
        self.scopes().first().is_some_and(|scope| scope.is_text())
    }

    /// Returns the actions to show in the footer.
    pub fn hints(&self) -> Vec<Action> {
        match (self.layers.top(), &self.stage) {
            (Some(Layer::Dialog(dialog)), Stage::Run(run)) => dialog.hints_in_context(&ScreenContext {
                company: &run.company,
                keys: &self.keys,
                page_rows: self.page_rows,
            }),
            (Some(Layer::Dialog(dialog)), _) => dialog.hints(),
            (Some(Layer::NextWeek), Stage::Run(run)) => run.next_week.hints(),
            (_, Stage::Menu(menu)) => menu.hints(),
            (_, Stage::Study(page)) => page.hints(),
            (None, Stage::Run(run)) => run.hints(),
        }
    }

    fn show_status(&mut self, text: impl Into<String>) {
        self.status = Some(StatusMessage { text: text.into(), is_error: false });
    }

    fn show_error(&mut self, text: impl Into<String>) {
        self.status = Some(StatusMessage { text: text.into(), is_error: true });
    }

    fn show_screen(&mut self, screen: ScreenId) {
        if self.reject_closed_screen(screen) {
            return;
        }
        let Stage::Run(run) = &mut self.stage else { return };
        if run.screen != screen {
            run.back_history.push(run.screen);
            if run.back_history.len() > MAX_SCREEN_HISTORY {
                run.back_history.remove(0);
            }
            run.forward_history.clear();
            self.switch_screen(screen);
        }
        self.request_screen_data();
    }

    fn go_back(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        run.clear_breadcrumbs();
        match run.back_history.pop() {
            Some(screen) => {
                run.forward_history.push(run.screen);
                self.switch_screen(screen);
                self.request_screen_data();
            }
            None => self.show_error("nothing to go back to"),
        }
    }

    fn go_forward(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        run.clear_breadcrumbs();
        match run.forward_history.pop() {
            Some(screen) => {
                run.back_history.push(run.screen);
                self.switch_screen(screen);
                self.request_screen_data();
            }
            None => self.show_error("nothing to go forward to"),
        }
    }

    fn switch_screen(&mut self, screen: ScreenId) {
        self.record_view();
        if let Stage::Run(run) = &mut self.stage {
            // Leaving a screen ends an edit, so that the digit keys show screens again when the user returns.
            let left = run.screens.get_mut(run.screen);
            let pane = left.focused_index();
            left.set_focus(pane);
            run.previous_screen = Some(run.screen);
            run.set_screen(screen);
        }
    }

    /// Requests the data of the current screen that is missing or outdated.
    fn request_screen_data(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        for reading in run.screens.get(run.screen).screen_queries() {
            if let Entry::Vacant(place) = run.requested_queries.entry(*reading) {
                let ask = place.insert(Pending::default()).ask(*reading);
                self.orders.push(Order::Ask(ask, self.busy.is_some()));
            }
        }
        let effects = self.with_screen(|screen, context| screen.request_data(context)).unwrap_or_default();
        self.execute_effects(effects);
        self.request_hidden_values();
    }

    fn with_screen<T>(&mut self, work: impl FnOnce(&mut dyn Screen, &ScreenContext<'_>) -> T) -> Option<T> {
        let Stage::Run(run) = &mut self.stage else { return None };
        let company = run.company.clone();
        let context = ScreenContext { company: &company, keys: &self.keys, page_rows: self.page_rows };
        Some(work(run.screens.get_mut(run.screen), &context))
    }
}
