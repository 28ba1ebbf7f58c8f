//! State of the console: messages become actions, actions change the state and produce orders for the worker.
//!
//! Nothing here blocks, reads a file or draws. Slow work is an [`Order`]; its result returns as a message.

mod busy;
mod guide;
mod input;
mod layers;
mod leaving;
mod lesson;
mod limits;
mod news;
mod orders;
mod overlay;
mod pages;
mod record;
mod settings;
mod stopped;
mod trail;
mod unsent;
mod viewer;
mod visit;

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use ratatui::layout::Rect;

use super::action::{Action, Scope};
use super::attention::{Edit, PresenceWatch, Stopwatch, Typing};
use super::context::{Look, ScreenId};
use super::dialogs::Dialog;
use super::dialogs::filing::FilingDialog;
use super::effect::Effect;
use super::keys::Keys;
use super::screens::menu::Menu;
use super::screens::{Screen, Screens};
use super::tour::Tour;
use super::viewer::Viewer;
use super::visit::{VisitPage, VisitState};
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::library::Library;
use novamind_report::Story;
use novamind_report::opponents::PlayOpponents;
use novamind_session::TimeLeft;
use novamind_study::CodeCheck;
use novamind_tui::canvas::Click;
use novamind_tui::chord::Chord;
use novamind_tui::glyphs::Glyphs;
use novamind_tui::theme::Theme;
use novamind_worker::Job;
use novamind_worker::asking::{Ask, Pending};
use novamind_worker::company::Company;
use novamind_worker::message::{DayTold, Message};
use novamind_worker::readings::Reading;
use novamind_worker::request::Request;

pub use busy::Busy;
pub use layers::Layer;
use layers::Layers;
use leaving::Closing;
pub use settings::Settings;
pub use stopped::Cover;

const SCREENS_KEPT: usize = 50;

/// Work outside the console state.
pub enum Order {
    /// Work for the session thread.
    Job(Job),
    /// A question of a page, and whether days are being simulated: queries do not wait for the simulation.
    Ask(Ask, bool),
    /// Stop the user's query and other running work of the user.
    CancelQuery,
    /// Copy text to the clipboard of the terminal.
    Copy(String),
    /// Write files.
    Write(Vec<(PathBuf, Vec<u8>)>),
    /// Save a query: its name, its title, the statement.
    SaveQuery(Configuration, [String; 3]),
    /// Redraw the whole window.
    Redraw,
    /// Capture the mouse, or leave it to the terminal.
    Mouse(bool),
    /// Exit, with an exit code and a text to print.
    Exit(u8, Option<String>),
}

/// A status message in the footer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// The text.
    pub text: String,
    /// Whether it reports an error or a rejection.
    pub bad: bool,
}

/// Progress of a simulation of several days.
#[derive(Debug, Clone, Copy)]
pub struct DaysRun {
    /// The day before the first simulated day.
    pub from: u32,
    /// Last day.
    pub to: u32,
    /// The day that was simulated last.
    pub now: u32,
    /// Figures of that day, if it was simulated for the first time.
    pub told: Option<DayTold>,
}

impl DaysRun {
    /// Returns the progress before the first day.
    pub fn between(from: u32, to: u32) -> DaysRun {
        DaysRun { from, to, now: from, told: None }
    }
}

/// The part of the program that the user is in.
pub enum Stage {
    /// The start menu.
    Menu(Box<Menu>),
    /// A run.
    Run(Box<Run>),
    /// A page of a study.
    Visit(Box<VisitPage>),
}

/// A run that is open in the console.
pub struct Run {
    /// The company as displayed.
    pub company: Arc<Company>,
    /// The current screen.
    pub here: ScreenId,
    /// Screens shown before, the latest last.
    pub before: Vec<ScreenId>,
    /// Places from which the current one was opened, the latest last.
    trail: Vec<trail::Stop>,
    /// Screens that were left with `back`, the latest last.
    pub after: Vec<ScreenId>,
    /// Whether the focused pane fills the screen.
    pub zoomed: bool,
    shown: Option<Duration>,
    came_from: Option<ScreenId>,
    /// The open object: its screen, kind and name.
    selected: Option<(ScreenId, &'static str, String)>,
    /// All screens.
    pub screens: Screens,
    /// The next-week dialog.
    pub filing: FilingDialog,
    /// The run report, after the run has ended and the report was built.
    pub story: Option<Arc<Story>>,
    /// Readings requested since the run last changed.
    pub asked: BTreeMap<Reading, Pending<Reading>>,
    /// The tour, while it is shown.
    pub tour: Option<Tour>,
    /// Playback state, if the run is a recorded one.
    pub viewer: Option<Viewer>,
    /// State of the lesson that the run belongs to.
    pub lesson: lesson::LessonView,
    overlay: overlay::Overlay,
    /// Time left until each time limit.
    pub time_left: Vec<TimeLeft>,
    /// Why the database is behind, if it is.
    pub behind: Option<String>,
}

impl Run {
    /// Both screens count as viewed.
    fn go_to(&mut self, screen: ScreenId) {
        self.screens.get_mut(self.here).looked_at();
        self.here = screen;
        self.zoomed = false;
        self.screens.get_mut(screen).looked_at();
    }
}

/// The console.
pub struct App {
    /// Colors.
    pub theme: Theme,
    /// Keys.
    pub keys: Keys,
    /// Characters that charts are drawn with.
    pub glyphs: Glyphs,
    /// Whether the console captures the mouse.
    pub mouse: bool,
    themes: Vec<Theme>,
    configuration: Configuration,
    library: Library,
    again: String,
    /// The part of the program that the user is in.
    pub stage: Stage,
    /// Dialogs, the topmost last.
    pub layers: Layers,
    /// The screen shown while the clock is stopped.
    pub cover: Option<Cover>,
    /// Measures active time.
    pub stopwatch: Stopwatch,
    presence: PresenceWatch,
    typing: Typing,
    edit: Edit,
    term: Option<String>,
    /// Checks the experimenter's code; `None` outside a study with a code.
    pub code_check: Option<CodeCheck>,
    unsent: unsent::TextsKept,
    /// The status message.
    pub note: Option<Note>,
    /// Work that the user waits for.
    pub busy: Option<Busy>,
    /// Chords of an unfinished key sequence.
    pub pending: Vec<Chord>,
    opponents: PlayOpponents,
    closing: Option<Closing>,
    /// The initial screen of the run that is being opened, if not the default.
    opens_on: Option<ScreenId>,
    /// Whether the run is drawn for a projector.
    pub is_projected: bool,
    tour_planned: bool,
    visit: Option<VisitState>,
    limit: limits::LimitTold,
    /// Clickable areas of the last frame.
    pub clicks: Vec<(Rect, Click)>,
    /// Rows of the focused list in the last frame.
    pub page: u16,
    /// Columns and rows of the window in the last frame.
    pub window: (u16, u16),
    orders: Vec<Order>,
}

impl App {
    /// Returns a console in its start menu.
    pub fn new(settings: Settings) -> App {
        let menu = Box::new(Menu::new(&settings.configuration));
        let library = Library::of(&settings.configuration);
        App {
            library,
            theme: settings.theme,
            keys: settings.keys,
            glyphs: settings.glyphs,
            mouse: true,
            themes: crate::themes::all(&settings.configuration),
            configuration: settings.configuration,
            again: settings.again,
            stage: Stage::Menu(menu),
            layers: Layers::default(),
            cover: None,
            stopwatch: Stopwatch::default(),
            presence: PresenceWatch::default(),
            typing: Typing::default(),
            edit: Edit::Typed,
            term: None,
            code_check: None,
            unsent: unsent::TextsKept::default(),
            note: None,
            busy: None,
            pending: Vec::new(),
            opponents: settings.opponents,
            closing: None,
            opens_on: None,
            is_projected: false,
            tour_planned: false,
            visit: None,
            limit: limits::LimitTold::default(),
            clicks: Vec::new(),
            page: 10,
            window: (0, 0),
            orders: vec![Order::Job(Job::Do(Request::ListRuns))],
        }
    }

    /// Opens or creates a run in place of the start menu.
    pub fn start_with(&mut self, effect: Effect) {
        self.follow(vec![effect]);
    }

    /// Handles a message. Outside work is collected for [`App::take_orders`].
    pub fn update(&mut self, message: Message) {
        match message {
            Message::Input(event) => self.take_input(event),
            Message::News(news) => self.news(news),
            Message::Arrived(delivery) => {
                delivery.deliver();
                self.take_answers();
            }
            Message::Signal(number) => self.leave(Closing::BySignal(number)),
            Message::Time => {
                if self.busy.as_ref().is_some_and(|busy| busy.stops_script) {
                    self.orders.push(Order::CancelQuery);
                }
                self.pass_time();
            }
        }
        self.settle_tour();
        self.settle_limit();
        self.settle_visit();
        self.settle_record();
    }

    /// Returns the orders since the last call.
    pub fn take_orders(&mut self) -> Vec<Order> {
        std::mem::take(&mut self.orders)
    }

    /// Returns the orders for the session thread; other orders stay.
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
            Stage::Menu(_) | Stage::Visit(_) => None,
        }
    }

    /// Returns whether the user waits for a query, a script or a week, whose elapsed time is displayed.
    pub fn is_waiting(&self) -> bool {
        self.busy.is_some() || self.run().is_some_and(|run| run.screens.sql.is_running())
    }

    /// Returns the scopes of the focused place, the innermost first.
    pub fn scopes(&self) -> Vec<Scope> {
        let mut scopes = match (self.layers.last(), &self.stage) {
            (Some(Layer::Dialog(dialog)), _) => return dialog.scopes(),
            (Some(Layer::Filing), Stage::Run(run)) => return run.filing.scopes(),
            (_, Stage::Menu(menu)) => return menu.scopes(),
            (_, Stage::Visit(page)) => return page.scopes(),
            (None, Stage::Run(run)) => run.scopes(),
        };
        scopes.push(Scope::Global);
        scopes
    }

    /// Returns the actions to show in the footer.
    pub fn hints(&self) -> Vec<Action> {
        match (self.layers.last(), &self.stage) {
            (Some(Layer::Dialog(dialog)), Stage::Run(run)) => {
                dialog.hints_here(&Look { company: &run.company, keys: &self.keys, page: self.page })
            }
            (Some(Layer::Dialog(dialog)), _) => dialog.hints(),
            (Some(Layer::Filing), Stage::Run(run)) => run.filing.hints(),
            (_, Stage::Menu(menu)) => menu.hints(),
            (_, Stage::Visit(page)) => page.hints(),
            (None, Stage::Run(run)) => run.hints(),
        }
    }

    fn say(&mut self, text: impl Into<String>) {
        self.note = Some(Note { text: text.into(), bad: false });
    }

    fn complain(&mut self, text: impl Into<String>) {
        self.note = Some(Note { text: text.into(), bad: true });
    }

    fn show(&mut self, screen: ScreenId) {
        if self.is_kept_shut(screen) {
            return;
        }
        let Stage::Run(run) = &mut self.stage else { return };
        if run.here != screen {
            run.before.push(run.here);
            if run.before.len() > SCREENS_KEPT {
                run.before.remove(0);
            }
            run.after.clear();
            self.move_to(screen);
        }
        self.load();
    }

    fn back(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        run.forget_trail();
        match run.before.pop() {
            Some(screen) => {
                run.after.push(run.here);
                self.move_to(screen);
                self.load();
            }
            None => self.complain("nothing to go back to"),
        }
    }

    fn forward(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        run.forget_trail();
        match run.after.pop() {
            Some(screen) => {
                run.before.push(run.here);
                self.move_to(screen);
                self.load();
            }
            None => self.complain("nothing to go forward to"),
        }
    }

    fn move_to(&mut self, screen: ScreenId) {
        self.close_view();
        if let Stage::Run(run) = &mut self.stage {
            run.came_from = Some(run.here);
            run.go_to(screen);
        }
    }

    /// Requests the data of the current screen that is missing or outdated.
    fn load(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        for reading in run.screens.get(run.here).readings() {
            if let Entry::Vacant(place) = run.asked.entry(*reading) {
                let ask = place.insert(Pending::default()).ask(*reading);
                self.orders.push(Order::Ask(ask, self.busy.is_some()));
            }
        }
        let asks = self.with_screen(|screen, look| screen.ask_run(look)).unwrap_or_default();
        self.follow(asks);
        self.ask_hidden_values();
    }

    fn with_screen<T>(&mut self, work: impl FnOnce(&mut dyn Screen, &Look<'_>) -> T) -> Option<T> {
        let Stage::Run(run) = &mut self.stage else { return None };
        let company = run.company.clone();
        let look = Look { company: &company, keys: &self.keys, page: self.page };
        Some(work(run.screens.get_mut(run.here), &look))
    }
}
