//! Keys, clicks and pasted text.

use crossterm::event::{Event, KeyEvent, KeyEventKind, MouseButton, MouseEvent, MouseEventKind};
use ratatui::layout::Position;

use super::{App, Closing, Layer, Order, Stage};
use crate::action::{Action, Scope};
use crate::attention::Edit;
use crate::context::{Figure, Look, ScreenId};
use crate::dialogs::help::Help;
use crate::dialogs::palette::Palette;
use crate::dialogs::reader::Reader;
use crate::dialogs::report::Report;
use crate::dialogs::{Dialog, Outcome};
use crate::effect::Effect;
use crate::keys::Meaning;
use novamind_tui::canvas::Click;
use novamind_tui::chord::{Chord, written};
use novamind_tui::text::number;
use novamind_worker::Job;
use novamind_worker::preferences::Preferences;
use novamind_worker::request::Request;

const STOPS_SCRIPT: [Action; 3] = [Action::Close, Action::LeaveEditor, Action::Discard];

impl App {
    pub(super) fn input(&mut self, event: Event) {
        match event {
            Event::Key(key) if key.kind != KeyEventKind::Release => self.key(key),
            Event::Paste(text) => {
                self.pending.clear();
                self.paste(&text);
            }
            Event::Mouse(mouse) => {
                self.pending.clear();
                self.pointer(mouse);
            }
            _ => {}
        }
    }

    fn key(&mut self, key: KeyEvent) {
        self.note = None;
        let scopes = self.scopes();
        let typing = scopes.first().is_some_and(|scope| scope.is_text());
        let chord = Chord::of(&key);
        if chord.is_escape() && self.stop_on_the_way() {
            return;
        }
        if !self.pending.is_empty() {
            return self.go_on(chord);
        }
        if chord.begins_number() && self.takes_numbers() {
            return self.typed(&key);
        }
        let action = if typing && chord.is_text() {
            // The bindings of the text field take precedence over those of the surrounding scopes.
            let texts: Vec<Scope> = scopes.iter().copied().filter(|scope| scope.is_text()).collect();
            let own = self.keys.action(&texts, chord);
            let goes_on = |action: &Action| matches!(action, Action::Complete | Action::NextStep);
            let plain = chord.is_printable();
            own.or_else(|| self.keys.action(&scopes, chord).filter(|action| goes_on(action) && !plain))
        } else {
            let own = self.before_dialogs(chord).or_else(|| self.keys.action(&scopes, chord));
            own.or_else(|| self.anywhere(chord))
        };
        match action {
            Some(action) => self.act(action),
            None if !typing && self.keys.meaning(&scopes, &[chord]) == Meaning::Begin => {
                self.pending.push(chord);
            }
            None => self.typed(&key),
        }
    }

    /// Returns whether a digit starts a number in the focused place. Playback has no editable cells.
    fn takes_numbers(&self) -> bool {
        let run = self.run().filter(|run| self.layers.is_empty() && run.viewer.is_none());
        run.is_some_and(|run| run.screens.get(run.here).takes_numbers())
    }

    /// Handles a chord that continues a key sequence.
    fn go_on(&mut self, chord: Chord) {
        self.pending.push(chord);
        match self.keys.meaning(&self.scopes(), &self.pending) {
            Meaning::Begin => {}
            Meaning::Action(action) => {
                self.pending.clear();
                self.act(action);
            }
            Meaning::Nothing => {
                let pressed = written(&std::mem::take(&mut self.pending));
                if !chord.is_escape() {
                    self.complain(format!("{pressed} is not bound here"));
                }
            }
        }
    }

    /// Returns the action that takes precedence over the bindings of the top dialog.
    fn before_dialogs(&self, chord: Chord) -> Option<Action> {
        let global = self.keys.action(&[Scope::Global], chord)?;
        let goes_before = match self.layers.last()? {
            Layer::Dialog(dialog) => dialog.goes_before(global),
            Layer::Filing => global == Action::Help,
        };
        goes_before.then_some(global)
    }

    /// Returns an action that is available even over a dialog: quitting and redrawing must always be possible.
    fn anywhere(&self, chord: Chord) -> Option<Action> {
        let always = [Action::Quit, Action::Redraw, Action::TourSkip, Action::TourClose];
        let global = self.keys.action(&[Scope::Global], chord)?;
        (always.contains(&global) && !chord.is_text()).then_some(global)
    }

    fn typed(&mut self, key: &KeyEvent) {
        if self.layers.is_empty() {
            match &mut self.stage {
                Stage::Menu(menu) => {
                    let effects = menu.key(key);
                    self.follow(effects);
                }
                Stage::Visit(page) => {
                    let effects = page.key(key);
                    self.follow(effects);
                }
                Stage::Run(_) => {
                    let effects = self.with_screen(|screen, look| screen.key(key, look)).unwrap_or_default();
                    self.follow(effects);
                }
            }
        } else {
            self.in_dialog(|dialog, look| dialog.key(key, look));
        }
    }

    fn paste(&mut self, text: &str) {
        if !self.layers.is_empty() {
            return self.in_dialog(|dialog, look| dialog.paste(text, look));
        }
        match &mut self.stage {
            Stage::Menu(menu) => menu.paste(text),
            Stage::Visit(page) => page.paste(text),
            Stage::Run(_) => {
                let effects = self.with_screen(|screen, look| screen.paste(text, look)).unwrap_or_default();
                self.follow(effects);
            }
        }
    }

    fn pointer(&mut self, mouse: MouseEvent) {
        let at = Position::new(mouse.column, mouse.row);
        let wheel = match mouse.kind {
            MouseEventKind::ScrollUp => Some(Action::Up),
            MouseEventKind::ScrollDown => Some(Action::Down),
            MouseEventKind::Down(MouseButton::Left) => None,
            _ => return,
        };
        if let Some(action) = wheel {
            let scroll = if action == Action::Up { Action::ScrollUp } else { Action::ScrollDown };
            let fits = !self.layers.is_empty() && self.scopes().contains(&Scope::Dialog);
            return self.act(if fits { scroll } else { action });
        }
        let hit = self.clicks.iter().rev().find(|(area, _)| area.contains(at)).map(|(_, click)| *click);
        self.note = None;
        match hit {
            Some(Click::Do(command)) => {
                if let Some(action) = Action::of(command) {
                    self.act(action);
                }
            }
            Some(Click::Row(_, row)) if !self.layers.is_empty() => {
                self.in_dialog(|dialog, look| dialog.click(row, look));
            }
            Some(Click::Row(pane, row)) => self.click_row(pane, row),
            Some(Click::Pane(pane)) if self.layers.is_empty() => {
                self.with_screen(|screen, _| screen.set_focus(pane));
            }
            _ => {}
        }
    }

    fn click_row(&mut self, pane: usize, row: usize) {
        if let Stage::Menu(menu) = &mut self.stage {
            let effects = menu.click(row);
            return self.follow(effects);
        }
        let clicked = self.with_screen(|screen, look| {
            screen.set_focus(pane);
            screen.click(pane, row, look)
        });
        self.follow(clicked.unwrap_or_default());
    }

    pub(super) fn act(&mut self, action: Action) {
        let global = action.entry().scope == Scope::Global;
        self.edit = Edit::Filled;
        match action {
            Action::Quit => return self.quit(),
            Action::Redraw => return self.orders.push(Order::Redraw),
            Action::TourSkip => return self.skip_step(),
            Action::TourClose => return self.close_tour(),
            // Available over questions too: participants can withdraw without answering them.
            Action::Withdraw if matches!(self.stage, Stage::Run(_)) => return self.withdraw(),
            _ => {}
        }
        if let (Action::Help, Some(Layer::Filing), Stage::Run(run)) =
            (action, self.layers.last(), &self.stage)
        {
            let help = Help::of_dialog(&run.filing, &self.keys);
            return self.open(help);
        }
        if !self.layers.is_empty() {
            return self.in_dialog(|dialog, look| dialog.act(action, look));
        }
        if let Some(busy) = self.busy.as_mut().filter(|busy| busy.is_script())
            && STOPS_SCRIPT.contains(&action)
        {
            busy.stops_script = true;
            return self.orders.push(Order::CancelQuery);
        }
        if let Stage::Menu(menu) = &mut self.stage {
            let effects = menu.act(action);
            return self.follow(effects);
        }
        if let Stage::Visit(page) = &mut self.stage {
            let effects = page.act(action);
            return self.follow(effects);
        }
        if self.refuses_in_replay(action) {
            return;
        }
        if action.entry().scope == Scope::Viewer {
            return self.act_in_viewer(action);
        }
        if global {
            return self.act_globally(action);
        }
        if self.goes_back_along(action) {
            return;
        }
        let effects = self.with_screen(|screen, look| screen.act(action, look)).unwrap_or_default();
        self.follow(effects);
    }

    pub(super) fn in_dialog(&mut self, work: impl FnOnce(&mut dyn Dialog, &Look<'_>) -> Outcome) {
        let Stage::Run(run) = &mut self.stage else { return };
        let company = run.company.clone();
        let look = Look { company: &company, keys: &self.keys, page: self.page };
        let outcome = match self.layers.last_mut() {
            Some(Layer::Filing) => work(&mut run.filing, &look),
            Some(Layer::Dialog(dialog)) => work(dialog.as_mut(), &look),
            None => return,
        };
        if outcome.close {
            self.close_layer(outcome.confirmed);
        } else {
            self.note_step();
        }
        self.follow(outcome.effects);
    }

    pub(super) fn open(&mut self, dialog: impl Dialog + 'static) {
        self.lay(Layer::Dialog(Box::new(dialog)));
    }

    fn act_globally(&mut self, action: Action) {
        if let Some(screen) = ScreenId::ALL.into_iter().find(|screen| screen.action() == action) {
            if let Stage::Run(run) = &mut self.stage {
                run.forget_trail();
            }
            return self.show(screen);
        }
        match action {
            Action::Palette => {
                if let Stage::Run(run) = &self.stage {
                    let palette = Palette::new(&self.keys, &run.company, &self.library);
                    let palette = match &self.visit {
                        Some(visit) => palette.of_participant(visit.has_tour()),
                        None => palette,
                    };
                    self.open(palette);
                }
            }
            Action::Help => self.show_help(),
            Action::NextWeek => self.file(),
            Action::Changes => self.show_changes(),
            Action::Dashboard => {
                if let Stage::Run(run) = &self.stage {
                    let text = run.company.seen.dashboard.clone();
                    self.open(Reader::new("Weekly dashboard", text));
                }
            }
            Action::Report => self.show_report(),
            Action::WriteReport => self.follow(vec![Effect::Request(Request::WriteReport)]),
            Action::Undo => self.follow(vec![Effect::Request(Request::Undo)]),
            Action::Redo => self.follow(vec![Effect::Request(Request::Redo)]),
            Action::FocusNext | Action::FocusPrevious => self.move_focus(action == Action::FocusNext),
            Action::Back => self.back(),
            Action::Explain => self.explain(),
            Action::Why => self.show_why(),
            Action::Branches => self.show_branches(),
            Action::Breakpoints => self.show_breakpoints(),
            Action::HiddenValues => self.toggle_hidden_values(),
            Action::Curves => self.show_curve(None),
            Action::Glossary => self.show_glossary(),
            Action::Lesson => self.toggle_lesson(),
            Action::LessonPage => self.show_lesson(),
            Action::Tour => self.show_tour(),
            Action::Forward => self.forward(),
            Action::Zoom => self.zoom(),
            Action::Rows => self.show_rows(),
            Action::NextTheme => self.next_theme(),
            Action::NextMarker => {
                self.glyphs = self.glyphs.next();
                self.say(format!("charts use {}", self.glyphs.words()));
                self.remember(Preferences { marker: Some(self.glyphs), ..Preferences::default() });
            }
            Action::Mouse => self.hand_over_mouse(),
            Action::StopClock => self.ask_to_stop_clock(),
            Action::LeaveRun => self.leave(Closing::ToMenu),
            _ => {}
        }
    }

    fn show_help(&mut self) {
        let Stage::Run(run) = &self.stage else { return };
        let look = Look { company: &run.company, keys: &self.keys, page: self.page };
        let replay = run.viewer.is_some();
        let help = Help::new(run.here, &run.screens.get(run.here).pane_keys(&look), replay, &self.keys);
        self.open(help);
    }

    fn move_focus(&mut self, forward: bool) {
        self.with_screen(|screen, _| {
            let panes = screen.panes();
            let step = if forward { 1 } else { panes - 1 };
            screen.set_focus((screen.focus() + step) % panes);
        });
    }

    fn zoom(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        if run.screens.get(run.here).panes() < 2 {
            return self.complain("this screen has only one pane");
        }
        run.zoomed = !run.zoomed;
    }

    fn selected_figure(&mut self) -> Option<Figure> {
        let found = self.with_screen(|screen, look| screen.figure(look)).flatten();
        if found.is_none() {
            self.complain("no figure selected; choose a pane with tab and a row with the arrows");
        }
        found
    }

    fn show_rows(&mut self) {
        if let Some(figure) = self.selected_figure() {
            self.show_rows_of(figure);
        }
    }

    fn show_why(&mut self) {
        if let Some(figure) = self.selected_figure() {
            self.ask_why(figure);
        }
    }

    fn show_breakpoints(&mut self) {
        if let Stage::Run(run) = &mut self.stage {
            run.forget_trail();
            run.screens.xray.show_breakpoints();
        }
        self.show(ScreenId::Xray);
    }

    fn next_theme(&mut self) {
        let here = self.themes.iter().position(|theme| theme.name == self.theme.name);
        let next = here.map_or(0, |at| (at + 1) % self.themes.len().max(1));
        if let Some(theme) = self.themes.get(next) {
            self.theme = theme.clone();
            let name = self.theme.name.clone();
            self.say(format!("theme: {name}"));
            self.remember(Preferences { theme: Some(name), ..Preferences::default() });
        }
    }

    fn remember(&mut self, chosen: Preferences) {
        self.orders.push(Order::Job(Job::Remember(chosen)));
    }

    fn hand_over_mouse(&mut self) {
        self.mouse = !self.mouse;
        self.orders.push(Order::Mouse(self.mouse));
        self.say(if self.mouse {
            "mouse on: click to select; shift-drag selects text"
        } else {
            "mouse off: the terminal selects text"
        });
    }

    fn file(&mut self) {
        if self.owes_answers() {
            // Questions of the study open as soon as no dialog covers the run.
            return;
        }
        let Stage::Run(run) = &mut self.stage else { return };
        match &self.busy {
            Some(busy) if busy.is_script() => {
                return self.complain("a script is running; run the week when it has ended");
            }
            Some(_) => return self.complain("a week is running; its report opens when it is done"),
            None => {}
        }
        if !run.company.is_running() {
            return self.show_end();
        }
        if self.files_in_lesson() {
            return;
        }
        let Stage::Run(run) = &mut self.stage else { return };
        run.filing.reopen(run.screens.tools.unsent(), run.company.is_baseline());
        self.lay(Layer::Filing);
    }

    fn show_report(&mut self) {
        let Stage::Run(run) = &self.stage else { return };
        match run.company.week.is_some() {
            true => self.open(Report::new(None)),
            false => self.complain("no week has run yet; run one with n"),
        }
    }

    fn show_changes(&mut self) {
        let Stage::Run(run) = &self.stage else { return };
        let seen = &run.company.seen;
        let width = seen.changes.iter().map(|change| change.setting.to_string().len()).max().unwrap_or(0);
        let line = |change: &novamind_session::Change| {
            format!(
                "{:<width$}  {:>12} → {:<12} {}",
                change.setting.to_string(),
                number(change.old),
                number(change.new),
                change.setting.unit().unwrap_or_default()
            )
        };
        let mut lines: Vec<String> =
            seen.changes.iter().map(line).chain(seen.purchases.iter().cloned()).collect();
        if lines.is_empty() {
            lines.push("No changes since last week.".to_owned());
        } else {
            lines.push(String::new());
            lines.push("u undoes the last setting, U redoes it. Purchases cannot be undone.".to_owned());
        }
        self.open(Reader::new("Changes of this week", lines.join("\n")));
    }
}
