//! State of the console: a message becomes an action, an action changes state, orders go to the threads behind.
//!
//! Nothing here waits, reads a file or draws. What takes time is an [`Order`]; its result comes back as news.

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

/// Screens that back remembers.
const SCREENS_KEPT: usize = 50;

/// Something for the outside of the console.
pub enum Order {
    /// Work for the session's thread.
    Job(Job),
    /// A question of a page, and whether days are being simulated: a query does not wait for them.
    Ask(Ask, bool),
    /// Stop the user's query and what runs for the user.
    CancelQuery,
    /// Put text into the clipboard of the terminal.
    Copy(String),
    /// Write files.
    Write(Vec<(PathBuf, Vec<u8>)>),
    /// Save a query: its name, its title, the statement.
    SaveQuery(Configuration, [String; 3]),
    /// Draw everything again.
    Redraw,
    /// Use the mouse, or leave it to the terminal.
    Mouse(bool),
    /// Leave, with an exit code and what to print on the way.
    Exit(u8, Option<String>),
}

/// What the person is told in the last line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// Words.
    pub text: String,
    /// Something was refused or went wrong.
    pub bad: bool,
}

/// Days that are simulated one after the other.
#[derive(Debug, Clone, Copy)]
pub struct DaysRun {
    /// Day before the first one.
    pub from: u32,
    /// Last day.
    pub to: u32,
    /// Day that was simulated last.
    pub now: u32,
    /// What it came to, where that is news.
    pub told: Option<DayTold>,
}

impl DaysRun {
    /// None is simulated yet.
    pub fn between(from: u32, to: u32) -> DaysRun {
        DaysRun { from, to, now: from, told: None }
    }
}

/// Where the person is.
pub enum Stage {
    /// In the start menu.
    Menu(Box<Menu>),
    /// In a run.
    Run(Box<Run>),
    /// On a page of a study.
    Visit(Box<VisitPage>),
}

/// A run on the screen.
pub struct Run {
    /// What there is to see.
    pub company: Arc<Company>,
    /// The screen that is shown.
    pub here: ScreenId,
    /// Screens shown before, the last one last.
    pub before: Vec<ScreenId>,
    /// Places from which what is shown was opened, the last one last.
    trail: Vec<trail::Stop>,
    /// Screens that were left with back, the last one last.
    pub after: Vec<ScreenId>,
    /// The focused pane has the whole screen.
    pub zoomed: bool,
    /// Since when it is shown, or the week is this one.
    shown: Option<Duration>,
    /// The screen that was left for it.
    came_from: Option<ScreenId>,
    /// The object that was open last: its screen, what it is, and which.
    selected: Option<(ScreenId, &'static str, String)>,
    /// Every screen.
    pub screens: Screens,
    /// The dialog before a week.
    pub filing: FilingDialog,
    /// The story of the run, once it is over and was told.
    pub story: Option<Arc<Story>>,
    /// What was asked of the database since the run has changed last.
    pub asked: BTreeMap<Reading, Pending<Reading>>,
    /// The first steps, while they are shown.
    pub tour: Option<Tour>,
    /// The run is a recorded one that is played again.
    pub viewer: Option<Viewer>,
    /// What the person has of the lesson it belongs to.
    pub lesson: lesson::LessonView,
    /// Whether true values stand on the screens.
    overlay: overlay::Overlay,
    /// Time that is left to each limit of the rules.
    pub time_left: Vec<TimeLeft>,
    /// Why the database is behind, while it is.
    pub behind: Option<String>,
}

impl Run {
    /// Changes the screen; what was to be seen on both counts as seen.
    fn go_to(&mut self, screen: ScreenId) {
        self.screens.get_mut(self.here).looked_at();
        self.here = screen;
        self.zoomed = false;
        self.screens.get_mut(screen).looked_at();
    }
}

/// The console.
pub struct App {
    /// Colours.
    pub theme: Theme,
    /// Keys.
    pub keys: Keys,
    /// What is drawn with.
    pub glyphs: Glyphs,
    /// Whether the program has the mouse.
    pub mouse: bool,
    themes: Vec<Theme>,
    configuration: Configuration,
    /// Named queries.
    library: Library,
    /// The command that goes on with the newest run.
    again: String,
    /// Where the person is.
    pub stage: Stage,
    /// Dialogs, the topmost last.
    pub layers: Layers,
    /// What lies over everything while the clock is stopped.
    pub cover: Option<Cover>,
    /// Time as the person has it.
    pub stopwatch: Stopwatch,
    presence: PresenceWatch,
    typing: Typing,
    /// Where the last change of a text came from.
    edit: Edit,
    /// The term that is explained.
    term: Option<String>,
    /// Says whether a word is the experimenter's code; none where there is no experimenter.
    pub code_check: Option<CodeCheck>,
    /// Texts as they were kept last, and when they are kept again.
    unsent: unsent::TextsKept,
    /// The last line.
    pub note: Option<Note>,
    /// What the person waits for.
    pub busy: Option<Busy>,
    /// Keys that were pressed and begin something.
    pub pending: Vec<Chord>,
    /// What plays the opponents of a run.
    opponents: PlayOpponents,
    /// What is to follow when the run is closed.
    closing: Option<Closing>,
    /// The screen on which the run that is being opened begins, where that is not the usual one.
    opens_on: Option<ScreenId>,
    /// The run that is watched is drawn to be read from far away.
    pub is_projected: bool,
    /// The run that is being started shows the tour.
    tour_planned: bool,
    /// The study whose participants are led.
    visit: Option<VisitState>,
    /// What was told of time limits.
    limit: limits::LimitTold,
    /// What could be clicked in the last frame.
    pub clicks: Vec<(Rect, Click)>,
    /// Rows that the focused list showed in the last frame.
    pub page: u16,
    /// Columns and rows of the window in the last frame.
    pub window: (u16, u16),
    orders: Vec<Order>,
}

impl App {
    /// The console in its start menu.
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

    /// Opens or creates a run instead of showing the menu.
    pub fn start_with(&mut self, effect: Effect) {
        self.follow(vec![effect]);
    }

    /// Takes a message; what has to be done outside is collected for [`App::take_orders`].
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

    /// What has to be done outside since the last time.
    pub fn take_orders(&mut self) -> Vec<Order> {
        std::mem::take(&mut self.orders)
    }

    /// The work for the session's thread of it; other orders stay.
    pub fn take_jobs(&mut self) -> Vec<Job> {
        let (jobs, others) = self.take_orders().into_iter().partition(|order| matches!(order, Order::Job(_)));
        self.orders = others;
        let job = |order: Order| if let Order::Job(job) = order { Some(job) } else { None };
        Vec::into_iter(jobs).filter_map(job).collect()
    }

    /// The run on the screen.
    pub fn run(&self) -> Option<&Run> {
        match &self.stage {
            Stage::Run(run) => Some(run),
            Stage::Menu(_) | Stage::Visit(_) => None,
        }
    }

    /// Whether the person waits: for a query, a script, a week. What is waited for shows how long it has taken.
    pub fn is_waiting(&self) -> bool {
        self.busy.is_some() || self.run().is_some_and(|run| run.screens.sql.is_running())
    }

    /// Scopes of the place that has the focus, the innermost first.
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

    /// Actions worth showing in the last line.
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

    /// Shows a screen.
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

    /// Asks the database for what the screen shows and is not known yet, or no longer true.
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

    /// The screen that is shown, and what it may look at.
    fn with_screen<T>(&mut self, work: impl FnOnce(&mut dyn Screen, &Look<'_>) -> T) -> Option<T> {
        let Stage::Run(run) = &mut self.stage else { return None };
        let company = run.company.clone();
        let look = Look { company: &company, keys: &self.keys, page: self.page };
        Some(work(run.screens.get_mut(run.here), &look))
    }
}
