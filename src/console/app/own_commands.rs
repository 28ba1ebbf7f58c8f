//! Own commands of the user: keys, availability, and the execution of their lines.

use std::collections::VecDeque;

use super::{App, Layer, Order, Stage};
use crate::context::ScreenId;
use crate::dialogs::confirm::ConfirmDialog;
use crate::dialogs::text_dialog::TextDialog;
use crate::effect::Effect;
use crate::own_commands::{ExternalProgram, OwnAction, OwnKeyMeaning, ProgramCall, own_commands_refusal};
use novamind_tools::ToolId;
use novamind_tui::chord::Chord;
use novamind_tui::text::format_count;

/// Lines of an own command that have not been answered yet, the running line first.
#[derive(Debug, Default)]
pub struct LineQueue {
    name: String,
    count: usize,
    lines: VecDeque<(ToolId, serde_json::Value)>,
}

impl App {
    /// Handles keys that have no other meaning. Returns whether the keys belong to an own command.
    pub(super) fn handle_own_key(&mut self, pressed: &[Chord]) -> bool {
        if !self.layers.is_empty() || self.run().is_none() {
            return false;
        }
        match self.own_commands.meaning(pressed) {
            Some(OwnKeyMeaning::Prefix) => self.pending_chords = pressed.to_vec(),
            Some(OwnKeyMeaning::Command(at)) => {
                self.pending_chords.clear();
                self.run_own_command(at);
            }
            None => return false,
        }
        true
    }

    pub(super) fn run_own_command(&mut self, at: usize) {
        let (Some(command), Some(run)) = (self.own_commands.commands.get(at).cloned(), self.run()) else {
            return;
        };
        if let Some(reason) = own_commands_refusal(&run.company, self.has_participant()) {
            return self.show_error(format!("{}: {reason}", command.name));
        }
        match command.action {
            OwnAction::Query(sql) => self.execute_effects(vec![Effect::RunSql(sql)]),
            OwnAction::Program(program) => self.start_program(command.name, program),
            _ if self.is_playback() => self.show_playback_error(),
            OwnAction::Rules(rules) => {
                let mut effects = Vec::new();
                self.open_linked_screen(ScreenId::Inbox, |run| {
                    effects = run.screens.inbox.show_rules(&rules, &run.company);
                });
                self.execute_effects(effects);
            }
            OwnAction::Lines(lines) => {
                let texts: Vec<&str> = lines.iter().map(|(line, ..)| line.as_str()).collect();
                let text =
                    format!("Execute {}?\n{}", format_count(lines.len() as f64, "line"), texts.join("\n"));
                let confirm = ConfirmDialog::new(command.name, text, vec![Effect::RunLines(at)]);
                self.push_layer(Layer::Dialog(Box::new(confirm)));
            }
        }
    }

    fn start_program(&mut self, name: String, program: ExternalProgram) {
        let Stage::Run(run) = &self.stage else { return };
        let rows = run.screens.get(run.screen).list_rows(program.gets_all_rows);
        let Some(rows) = rows.filter(|rows| !rows.is_empty()) else {
            return self.show_error(format!(
                "{name}: no row is selected. Choose a list with tab, then press the key again."
            ));
        };
        let input = if program.gets_json { rows.to_json() } else { rows.to_csv() };
        let run = run.company.observation.run.clone();
        self.show_status(format!("{name} is running …"));
        self.orders.push(Order::RunProgram(ProgramCall { name, program, input, run }));
    }

    pub(super) fn show_program_end(&mut self, end: Result<(String, String), String>) {
        match end {
            Ok((title, text)) if matches!(self.stage, Stage::Run(_)) => {
                self.push_layer(Layer::Dialog(Box::new(TextDialog::new(title, text))));
            }
            Ok((title, _)) => self.show_status(format!("{title} has ended")),
            Err(problem) => self.show_error(problem),
        }
    }

    /// Sends the first line of an own command. Each next line is sent after the line before it was accepted.
    pub(super) fn run_lines(&mut self, at: usize) {
        let Some(command) = self.own_commands.commands.get(at) else { return };
        let OwnAction::Lines(lines) = &command.action else { return };
        if self.busy.is_some() || !self.own_lines.lines.is_empty() {
            return self.show_error("other work is running; no line was executed. Try again afterwards");
        }
        let calls = lines.iter().map(|(_, tool, arguments)| (*tool, arguments.clone()));
        self.own_lines = LineQueue { name: command.name.clone(), count: lines.len(), lines: calls.collect() };
        self.send_first_line();
    }

    fn send_first_line(&mut self) {
        if let Some((tool, arguments)) = self.own_lines.lines.front().cloned() {
            self.execute_effects(vec![Effect::call(tool, arguments)]);
        }
    }

    /// Sends the next line after an accepted call. After a rejection, no other line is sent.
    pub(super) fn continue_lines(&mut self, tool: ToolId, is_accepted: bool) {
        if self.own_lines.lines.front().is_none_or(|(running, _)| *running != tool) {
            return;
        }
        self.own_lines.lines.pop_front();
        let LineQueue { name, count, .. } = &self.own_lines;
        let (name, count, left) = (name.clone(), *count, self.own_lines.lines.len());
        if !is_accepted {
            self.own_lines.lines.clear();
            let reason = self.status.as_ref().map_or(String::new(), |status| status.text.clone());
            // The reason is last, because the footer can cut off the end, and the form of the tool repeats the reason.
            let rest = if left == 0 { String::new() } else { format!(", {left} not executed") };
            return self
                .show_error(format!("{name}: rejected line {} of {count}{rest}: {reason}", count - left));
        }
        match left {
            0 => self.show_status(format!("{name}: {} done", format_count(count as f64, "line"))),
            _ => self.send_first_line(),
        }
    }
}
