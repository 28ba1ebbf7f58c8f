//! Keys, clicks and pasted text.

use crossterm::event::{Event, KeyEvent, KeyEventKind, MouseButton, MouseEvent, MouseEventKind};
use ratatui::layout::Position;

use super::{App, ExitTarget, Layer, Order, Stage};
use crate::action::{Action, Scope};
use crate::attention::EditSource;
use crate::context::{Figure, ScreenContext, ScreenId};
use crate::dialogs::help::HelpDialog;
use crate::dialogs::palette::CommandPalette;
use crate::dialogs::text_dialog::TextDialog;
use crate::dialogs::week_report::WeekReportDialog;
use crate::dialogs::{Dialog, DialogResponse};
use crate::effect::Effect;
use crate::hosted;
use crate::keys::KeyMeaning;
use novamind_tui::canvas::Click;
use novamind_tui::chord::Chord;
use novamind_tui::text::format_number;
use novamind_worker::Job;
use novamind_worker::preferences::Preferences;
use novamind_worker::request::Request;

const SCRIPT_STOP_ACTIONS: [Action; 3] = [Action::Close, Action::LeaveEditor, Action::Discard];

impl App {
    pub(super) fn dispatch_event(&mut self, event: Event) {
        match event {
            Event::Key(key) if key.kind != KeyEventKind::Release => self.handle_key(key),
            Event::Paste(text) => {
                self.pending_chords.clear();
                self.paste(&text);
            }
            Event::Mouse(mouse) => {
                self.pending_chords.clear();
                self.handle_mouse(mouse);
            }
            _ => {}
        }
    }

    fn handle_key(&mut self, key: KeyEvent) {
        self.status = None;
        let orders = self.orders.len();
        let chord = Chord::from_event(&key);
        let pressed = self.pending_chords.iter().copied().chain([chord]).collect();
        self.execute_key(key, chord);
        self.note_handled_key(pressed, self.orders.len() > orders);
    }

    fn execute_key(&mut self, key: KeyEvent, chord: Chord) {
        let scopes = self.scopes();
        let typing = self.is_editing_text();
        if chord.is_escape() && self.stop_seeking() {
            return;
        }
        if !self.pending_chords.is_empty() {
            return self.continue_key_sequence(chord);
        }
        let action = if typing && chord.is_text_input() {
            // The bindings of the text field take precedence over the bindings of the surrounding scopes.
            let texts: Vec<Scope> = scopes.iter().copied().filter(|scope| scope.is_text()).collect();
            let text_action = self.keys.action(&texts, chord);
            let works_while_typing = |action: &Action| matches!(action, Action::Complete | Action::NextStep);
            let plain = chord.is_printable();
            text_action.or_else(|| {
                self.keys.action(&scopes, chord).filter(|action| works_while_typing(action) && !plain)
            })
        } else {
            let bound_action = self.priority_action(chord).or_else(|| self.keys.action(&scopes, chord));
            bound_action.or_else(|| self.always_available_action(chord))
        };
        match action {
            Some(action) => self.handle_action(action),
            None if !typing && self.starts_key_sequence(&scopes, chord) => {
                self.pending_chords.push(chord);
            }
            None if !typing && self.handle_own_key(&[chord]) => {}
            None => self.forward_key(&key),
        }
    }

    /// Returns whether a chord starts a key sequence of these scopes. In a dialog, the sequences of screens are read
    /// completely too, so that no key of them reaches the dialog.
    fn starts_key_sequence(&self, scopes: &[Scope], chord: Chord) -> bool {
        let is_prefix = |scopes: &[Scope]| self.keys.meaning(scopes, &[chord]) == KeyMeaning::Prefix;
        is_prefix(scopes)
            || !self.layers.is_empty()
                && self.keys.meaning(scopes, &[chord]) == KeyMeaning::Unbound
                && is_prefix(&[Scope::Global])
    }

    /// Handles a chord that continues a key sequence.
    fn continue_key_sequence(&mut self, chord: Chord) {
        self.pending_chords.push(chord);
        match self.keys.meaning(&self.scopes(), &self.pending_chords) {
            KeyMeaning::Prefix => {}
            KeyMeaning::Action(action) => {
                self.pending_chords.clear();
                self.handle_action(action);
            }
            KeyMeaning::Unbound if self.handle_own_key(&self.pending_chords.clone()) => {}
            KeyMeaning::Unbound => {
                let pressed = std::mem::take(&mut self.pending_chords);
                if !chord.is_escape() {
                    let reason = self.reason_without_effect(&pressed);
                    self.show_error(reason);
                }
            }
        }
    }

    /// Returns the action that takes precedence over the bindings of the top dialog.
    fn priority_action(&self, chord: Chord) -> Option<Action> {
        let global = self.keys.action(&[Scope::Global], chord)?;
        let takes_precedence = match self.layers.top()? {
            Layer::Dialog(dialog) => dialog.overrides_dialog_keys(global),
            Layer::NextWeek => global == Action::Help,
        };
        takes_precedence.then_some(global)
    }

    /// Returns an action that works even while a dialog is open. Quitting and redrawing must always be possible.
    fn always_available_action(&self, chord: Chord) -> Option<Action> {
        let always =
            [Action::Quit, Action::Redraw, Action::TourContinue, Action::TourBack, Action::TourClose];
        let global = self.keys.action(&[Scope::Global], chord)?;
        (always.contains(&global) && !chord.is_text_input()).then_some(global)
    }

    fn forward_key(&mut self, key: &KeyEvent) {
        if self.layers.is_empty() {
            match &mut self.stage {
                Stage::Menu(menu) => {
                    let effects = menu.handle_key(key);
                    self.execute_effects(effects);
                }
                Stage::Study(page) => {
                    let effects = page.handle_key(key);
                    self.execute_effects(effects);
                }
                Stage::Run(_) => {
                    let effects = self
                        .with_screen(|screen, context| screen.handle_key(key, context))
                        .unwrap_or_default();
                    self.execute_effects(effects);
                }
            }
        } else {
            self.update_dialog(|dialog, screen_context| dialog.handle_key(key, screen_context));
        }
    }

    fn paste(&mut self, text: &str) {
        if !self.layers.is_empty() {
            return self.update_dialog(|dialog, context| dialog.paste(text, context));
        }
        match &mut self.stage {
            Stage::Menu(menu) => menu.paste(text),
            Stage::Study(page) => page.paste(text),
            Stage::Run(_) => {
                let effects = self
                    .with_screen(|screen, screen_context| screen.paste(text, screen_context))
                    .unwrap_or_default();
                self.execute_effects(effects);
            }
        }
    }

    fn handle_mouse(&mut self, mouse: MouseEvent) {
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
            return self.handle_action(if fits { scroll } else { action });
        }
        let hit = self.clicks.iter().rev().find(|(area, _)| area.contains(at)).map(|(_, click)| *click);
        self.status = None;
        match hit {
            Some(Click::Command(command)) => {
                if let Some(action) = Action::from_command(command) {
                    self.handle_action(action);
                }
            }
            Some(Click::Row(_, row)) if !self.layers.is_empty() => {
                self.update_dialog(|dialog, context| dialog.handle_click(row, context));
            }
            Some(Click::Row(pane, row)) => self.handle_row_click(pane, row),
            Some(Click::Pane(pane)) if self.layers.is_empty() => {
                self.with_screen(|screen, _| screen.set_focus(pane));
            }
            _ => {}
        }
    }

    fn handle_row_click(&mut self, pane: usize, row: usize) {
        if let Stage::Menu(menu) = &mut self.stage {
            let effects = menu.handle_click(row);
            return self.execute_effects(effects);
        }
        let clicked = self.with_screen(|screen, context| {
            screen.set_focus(pane);
            screen.handle_click(pane, row, context)
        });
        self.execute_effects(clicked.unwrap_or_default());
    }

    pub(super) fn handle_action(&mut self, action: Action) {
        let global = action.entry().scope == Scope::Global;
        self.edit_source = EditSource::Filled;
        if !self.keys.is_available(action) {
            return self.show_error(format!("{}: {}", action.entry().title, hosted::NOT_AVAILABLE));
        }
        match action {
            Action::Quit => return self.quit(),
            Action::Redraw => return self.orders.push(Order::Redraw),
            Action::TourContinue => return self.continue_tour(),
            Action::TourBack => return self.return_to_previous_tour_step(),
            Action::TourClose => return self.close_tour(),
            Action::ExternalEditor => return self.open_external_editor(),
            // Participants can withdraw without answering the open questions.
            Action::Withdraw if matches!(self.stage, Stage::Run(_)) => return self.leave_to_withdraw(),
            _ => {}
        }
        if let (Action::Help, Some(Layer::NextWeek), Stage::Run(run)) =
            (action, self.layers.top(), &self.stage)
        {
            let help = HelpDialog::for_dialog(&run.next_week, &self.keys);
            return self.open_dialog(help);
        }
        if !self.layers.is_empty() {
            return self.update_dialog(|dialog, context| dialog.handle_action(action, context));
        }
        if let Some(busy) = self.busy.as_mut().filter(|busy| busy.is_script())
            && SCRIPT_STOP_ACTIONS.contains(&action)
        {
            busy.is_stopping_script = true;
            return self.orders.push(Order::CancelQuery);
        }
        if let Stage::Menu(menu) = &mut self.stage {
            let effects = menu.handle_action(action);
            return self.execute_effects(effects);
        }
        if let Stage::Study(page) = &mut self.stage {
            let effects = page.handle_action(action);
            return self.execute_effects(effects);
        }
        if self.reject_in_playback(action) {
            return;
        }
        if action.entry().scope == Scope::Playback {
            return self.handle_playback_action(action);
        }
        if global {
            return self.handle_global_action(action);
        }
        if self.go_back_to_breadcrumb(action) {
            return;
        }
        let effects = self
            .with_screen(|screen, screen_context| screen.handle_action(action, screen_context))
            .unwrap_or_default();
        self.execute_effects(effects);
    }

    pub(super) fn update_dialog(
        &mut self,
        work: impl FnOnce(&mut dyn Dialog, &ScreenContext<'_>) -> DialogResponse,
    ) {
        let Stage::Run(run) = &mut self.stage else { return };
        let company = run.company.clone();
        let context = ScreenContext { company: &company, keys: &self.keys, page_rows: self.page_rows };
        let outcome = match self.layers.top_mut() {
            Some(Layer::NextWeek) => work(&mut run.next_week, &context),
            Some(Layer::Dialog(dialog)) => work(dialog.as_mut(), &context),
            None => return,
        };
        if outcome.closes {
            self.close_layer(outcome.is_confirmed);
        } else {
            self.record_dialog_step();
        }
        self.execute_effects(outcome.effects);
    }

    pub(super) fn open_dialog(&mut self, dialog: impl Dialog + 'static) {
        self.push_layer(Layer::Dialog(Box::new(dialog)));
    }

    fn handle_global_action(&mut self, action: Action) {
        if let Some(screen) = ScreenId::ALL.into_iter().find(|screen| screen.action() == action) {
            if let Stage::Run(run) = &mut self.stage {
                run.clear_breadcrumbs();
                run.screens.get_mut(screen).show_first_view();
            }
            return self.show_screen(screen);
        }
        match action {
            Action::Palette => {
                if let Stage::Run(run) = &self.stage {
                    let palette = CommandPalette::new(&self.keys, &run.company, &self.library);
                    let palette = match &self.study {
                        Some(visit) => palette.for_participant(visit.has_tour()),
                        None => palette.with_own_commands(&self.own_commands, &run.company),
                    };
                    self.open_dialog(palette);
                }
            }
            Action::Help => self.open_help(),
            Action::NextWeek => self.open_next_week(),
            Action::Changes => self.open_changes(),
            Action::Dashboard => {
                if let Stage::Run(run) = &self.stage {
                    let text = run.company.observation.dashboard.clone();
                    self.open_dialog(TextDialog::new("Weekly dashboard", text));
                }
            }
            Action::Report => self.open_report(),
            Action::WriteReport => self.execute_effects(vec![Effect::Request(Request::RenderReportFiles)]),
            Action::Undo => self.execute_effects(vec![Effect::Request(Request::Undo)]),
            Action::Redo => self.execute_effects(vec![Effect::Request(Request::Redo)]),
            Action::FocusNext | Action::FocusPrevious => self.move_focus(action == Action::FocusNext),
            Action::Back => self.go_back(),
            Action::Explain => self.open_explanation(),
            Action::Why => self.open_selected_causes(),
            Action::Branches => self.show_branches(),
            Action::Breakpoints => self.show_breakpoints(),
            Action::HiddenValues => self.toggle_hidden_values(),
            Action::Curves => self.show_curve(None),
            Action::Glossary => self.open_glossary(),
            Action::Lesson => self.toggle_lesson_task(),
            Action::LessonPage => self.open_lesson_page(),
            Action::Tour => self.resume_tour(),
            Action::Forward => self.go_forward(),
            Action::Zoom => self.toggle_zoom(),
            Action::Rows => self.open_selected_rows(),
            Action::Columns => self.open_column_chooser(),
            Action::NextTheme => self.switch_theme(),
            Action::NextMarker => {
                self.glyphs = self.glyphs.next();
                self.show_status(format!("charts use {}", self.glyphs.label()));
                self.save_preferences(Preferences { marker: Some(self.glyphs), ..Preferences::default() });
            }
            Action::Mouse => self.toggle_mouse(),
            Action::StopClock => self.request_clock_stop(),
            Action::LeaveRun => self.exit_run(ExitTarget::Menu),
            _ => {}
        }
    }

    fn open_help(&mut self) {
        let Stage::Run(run) = &self.stage else { return };
        let context = ScreenContext { company: &run.company, keys: &self.keys, page_rows: self.page_rows };
        let replay = run.playback.is_some();
        let help =
            HelpDialog::new(run.screen, &run.screens.get(run.screen).pane_keys(&context), replay, &self.keys);
        self.open_dialog(help);
    }

    fn move_focus(&mut self, forward: bool) {
        self.with_screen(|screen, _| {
            let panes = screen.pane_count();
            let step = if forward { 1 } else { panes - 1 };
            screen.set_focus((screen.focused_index() + step) % panes);
        });
    }

    fn toggle_zoom(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        if run.screens.get(run.screen).pane_count() < 2 {
            return self.show_error("this screen has only one pane");
        }
        run.zoomed = !run.zoomed;
    }

    fn selected_figure(&mut self) -> Option<Figure> {
        let found = self.with_screen(|screen, context| screen.figure(context)).flatten();
        if found.is_none() {
            self.show_error("no figure selected; choose a pane with tab and a row with the arrows");
        }
        found
    }

    fn open_selected_rows(&mut self) {
        if let Some(figure) = self.selected_figure() {
            self.show_source_rows(figure);
        }
    }

    fn open_selected_causes(&mut self) {
        if let Some(figure) = self.selected_figure() {
            self.show_causes(figure);
        }
    }

    fn show_breakpoints(&mut self) {
        if let Stage::Run(run) = &mut self.stage {
            run.clear_breadcrumbs();
            run.screens.xray.show_breakpoints();
        }
        self.show_screen(ScreenId::Xray);
    }

    fn switch_theme(&mut self) {
        let here = self.themes.iter().position(|theme| theme.name == self.theme.name);
        let next = here.map_or(0, |at| (at + 1) % self.themes.len().max(1));
        if let Some(theme) = self.themes.get(next) {
            self.theme = theme.clone();
            let name = self.theme.name.clone();
            self.show_status(format!("theme: {name}"));
            self.save_preferences(Preferences { theme: Some(name), ..Preferences::default() });
        }
    }

    pub(super) fn save_preferences(&mut self, chosen: Preferences) {
        self.orders.push(Order::Job(Job::SavePreferences(chosen)));
    }

    fn toggle_mouse(&mut self) {
        self.mouse = !self.mouse;
        self.orders.push(Order::Mouse(self.mouse));
        self.show_status(if self.mouse {
            "mouse on: click to select; shift-drag selects text"
        } else {
            "mouse off: the terminal selects text"
        });
    }

    fn open_next_week(&mut self) {
        if self.has_due_questions() {
            // Questions of the study open as soon as no dialog covers the run.
            return;
        }
        let Stage::Run(run) = &mut self.stage else { return };
        match &self.busy {
            Some(busy) if busy.is_script() => {
                return self.show_error("a script is running; run the week when it has ended");
            }
            Some(_) => return self.show_error("a week is running; the report opens when the week is done"),
            None => {}
        }
        if !run.company.is_running() {
            return self.show_final_page();
        }
        if self.handle_next_week_in_lesson() {
            return;
        }
        let Stage::Run(run) = &mut self.stage else { return };
        run.next_week.reopen(run.screens.tools.tools_with_drafts(), run.company.is_baseline());
        self.push_layer(Layer::NextWeek);
    }

    fn open_report(&mut self) {
        let Stage::Run(run) = &self.stage else { return };
        match run.company.last_week.is_some() {
            true => self.open_dialog(WeekReportDialog::new(None)),
            false => self.show_error("no week has run yet; run a week with n"),
        }
    }

    fn open_changes(&mut self) {
        let Stage::Run(run) = &self.stage else { return };
        let seen = &run.company.observation;
        let width = seen.changes.iter().map(|change| change.setting.to_string().len()).max().unwrap_or(0);
        let line = |change: &novamind_session::SettingChange| {
            format!(
                "{:<width$}  {:>12} → {:<12} {}",
                change.setting.to_string(),
                format_number(change.old),
                format_number(change.new),
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
        self.open_dialog(TextDialog::new("Changes of this week", lines.join("\n")));
    }
}
