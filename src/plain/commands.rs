//! Executes the commands of plain mode (docs/interfaces/plain-mode.md#commands).

mod breakpoints;
mod check;
mod curve;
mod debug_commands;
mod difference;
mod explanations;
mod groups;
mod help;
mod inbox;
mod lesson;
mod notes;
mod offers;
mod overview;
mod parameters;
mod queries;
mod report;
mod rules;
mod thread;
mod whatif;
mod why;
mod xray;

use std::io;

use serde_json::{Value, json};

use explanations::{explain, glossary};
pub use overview::describe_setting_change;

use super::advance;
use super::grammar::{self, Argument, ParseError, ParsedLine, arguments_to_object};
use super::line_source::LineSource;
use super::response::CommandResponse;
use super::signals::{Phase, SignalWatch};
use novamind_base::similar_names;
use novamind_database::text::format_result;
use novamind_insight::{AnalysisCache, CauseAnalysis, WhatIf};
use novamind_record::folder::query_library::QueryLibrary;
use novamind_record::trajectory::record::{Activity, HelpRequest, ObjectSelection, QuerySource, Via};
use novamind_report::research::describe_late_project;
use novamind_session::{RunDatabase, Session, SettingChange, rows_to_json};
use novamind_study::CodeCheck;
use novamind_tools::{AnyTool, Rejection, ToolId, ToolKind, ToolModule};

/// Names of the command that simulates a week, in plain mode and as a tool.
const NEXT_WEEK_COMMANDS: [&str; 3] = ["next", "next-week", "next_week"];

/// Commands that are not tools, with their help. Aliases of commands have no help.
const COMMANDS: &[(&str, &str)] = &[
    ("sql", "sql SELECT …             query the database (also: query)"),
    ("queries", "queries [NAME]           list the queries of the library, or run one query"),
    (
        "next",
        "next \"WHY\" naive          submit a rationale and forecasts, simulate a week (also: next-week)",
    ),
    ("dashboard", "dashboard                show the dashboard of the last week"),
    ("status", "status                   show run, day, cash, runway, subscribers and waiting threads"),
    (
        "inbox",
        "inbox [all] [where …]    list threads that wait for an answer; with the NUMBER of an enterprise, show its thread",
    ),
    ("thread", "thread NUMBER            show one thread, turn by turn"),
    (
        "rules",
        "rules [send] RULES       preview the replies of rules to waiting threads; with send, send the replies",
    ),
    (
        "needs",
        "needs                    list problems that need action, urgent ones first, then by money at risk, each with a call that addresses it",
    ),
    ("fit", "fit [GROUP]              compare the requirements of each group with the plans"),
    (
        "leads",
        "leads [GROUP]            show leads by group, paid and by word of mouth, and the cost per lead and per first bill",
    ),
    (
        "curve",
        "curve GROUP [PRICE QUALITY] show the quality that leads require at a price, and the expected result of a price and a quality",
    ),
    ("changes", "changes                  list settings changed since the last week"),
    ("check", "check CALL               preview the effect and cost of a tool call"),
    ("undo", "undo                     undo the last setting of this week"),
    ("redo", "redo                     apply again the setting that undo reverted"),
    ("history", "history [N]              list the last N confirmed actions and weeks (20)"),
    ("report", "report [week|run]        report on the last week, or on the whole run"),
    (
        "why",
        "why FIGURE [WEEK]        compute how much each cause changed a figure of a week, for example why churn(S1) 44",
    ),
    ("whatif", "whatif from WEEK: EDITS   re-simulate with other decisions; whatif WEEK lists the decisions"),
    ("memo", "memo [TEXT]              show the notes of the run, or add a line"),
    ("tools", "tools [NAME]             list the tools, or show one tool"),
    ("tables", "tables [NAME]            list the tables, or show one table"),
    ("explain", "explain TERM             explain a term, tool, argument, table or column (also: what)"),
    ("glossary", "glossary [WORD]          list all terms, or the terms that contain a word"),
    ("vars", "vars                     show the current day, like the tool get_vars"),
    (
        "branch",
        "branch WEEK [keep]       continue in a branch from the start of that week; keep: with the decisions made since",
    ),
    ("branches", "branches                 show the tree of related branches"),
    ("step", "step [DAYS]              debug: simulate single days (1)"),
    (
        "xray",
        "xray VIEW …              debug and finished runs: show hidden state; help xray lists the views",
    ),
    (
        "lens",
        "lens CUSTOMER [DAY]      debug and finished runs: show the state of a customer, and what would have changed its decision",
    ),
    (
        "break",
        "break [CONDITION]        debug and finished runs: list the breakpoints, or set one; break clear N|all removes them",
    ),
    ("run", "run DAYS [until …]       debug: simulate days until a breakpoint or the condition becomes true"),
    (
        "since",
        "since [CONDITION|N]      debug and finished runs: show since when a condition or a breakpoint has been true or false",
    ),
    (
        "find",
        "find CONDITION           debug and finished runs: list the days on which a condition became true",
    ),
    (
        "who",
        "who FIGURE [DAY]         debug and finished runs: list the mechanisms that changed a figure on a day, for example who reputation(S3) 84, or who cash",
    ),
    (
        "diff",
        "diff DAY DAY             debug and finished runs: list the differences between the ends of two days",
    ),
    (
        "lesson",
        "lesson [next]            lessons: show the task, its goals and their values; next: start the next part",
    ),
    ("guess", "guess ANSWER             lessons: answer the question of the step"),
    ("hint", "hint                     lessons: show the next hint of the step"),
    ("debrief", "debrief                  lessons: compare a finished part with the reference plays"),
    ("retry", "retry [STEP]             lessons: restart a step"),
    (
        "set",
        "set KEY VALUE [from DAY] debug: set a parameter; set alone lists the differences from the scenario",
    ),
    ("help", "help [NAME]              show this list, or help on one command, tool or table"),
    ("pause", "pause [REASON]           stop the clock for a break; then only resume, help and quit work"),
    ("resume", "resume                   restart the clock"),
    ("quit", "quit                     leave; all confirmed actions are saved (also: exit)"),
    ("query", ""),
    ("next-week", ""),
    ("what", ""),
];

/// Commands that are available in hosted sessions, except tools. A command that is in neither this list nor the list
/// in the tests is not available, and a test fails.
const HOSTED_COMMANDS: &[&str] = &[
    "sql",
    "queries",
    "next",
    "dashboard",
    "status",
    "inbox",
    "thread",
    "rules",
    "needs",
    "fit",
    "leads",
    "curve",
    "changes",
    "check",
    "undo",
    "redo",
    "history",
    "report",
    "memo",
    "tools",
    "tables",
    "explain",
    "glossary",
    "vars",
    "help",
    "pause",
    "resume",
    "quit",
    "query",
    "next-week",
    "what",
];

/// Returns whether a command is available in hosted sessions.
fn is_hosted_command(name: &str) -> bool {
    HOSTED_COMMANDS.contains(&name)
}

/// Commands that only show information. The use of these commands is recorded as activity.
const READ_COMMANDS: &[&str] = &[
    "dashboard",
    "status",
    "inbox",
    "thread",
    "changes",
    "needs",
    "fit",
    "leads",
    "curve",
    "history",
    "report",
    "branches",
    "tools",
    "tables",
    "queries",
    "help",
];

/// Executes commands on a session.
pub struct Interpreter {
    /// Session of the run that the player plays.
    pub session: Session,
    library: QueryLibrary,
    watch: SignalWatch,
    /// Whether a user types the lines and can answer questions.
    pub(super) is_interactive: bool,
    /// Function that checks the experimenter's code; `None` if no code is defined.
    pub(super) code_check: Option<CodeCheck>,
    /// Whether the player is a participant of a study, for whom some commands are not available.
    pub(super) is_participant: bool,
    /// Whether the session is hosted, so that only [`HOSTED_COMMANDS`] and tools are available.
    pub(super) is_hosted: bool,
    /// Whether the participant answers questions after the last week, before the result is shown.
    pub(super) has_final_questions: bool,
    /// The response to the last week, which is shown after the final questions.
    pub(super) held_result: Option<CommandResponse>,
    /// Cached simulations for the last `why` question.
    cached_causes: AnalysisCache<CauseAnalysis>,
    /// Cached simulations for the last `whatif` question.
    cached_branches: AnalysisCache<WhatIf>,
}

impl Interpreter {
    /// Creates an interpreter for a session. `prompts` states whether a user types the lines and can answer
    /// questions.
    pub fn new(
        mut session: Session,
        library: QueryLibrary,
        watch: SignalWatch,
        prompts: bool,
    ) -> Interpreter {
        session.set_rule_evaluator(novamind_rules::calls_for_waiting_threads);
        Interpreter {
            session,
            library,
            watch,
            is_interactive: prompts,
            code_check: None,
            is_participant: false,
            is_hosted: false,
            has_final_questions: false,
            held_result: None,
            cached_causes: AnalysisCache::default(),
            cached_branches: AnalysisCache::default(),
        }
    }

    /// Executes an input line. Returns `None` for empty lines and comments.
    ///
    /// # Errors
    /// The player's answer to a question cannot be read.
    pub fn execute_line(
        &mut self,
        line: &str,
        input: &mut LineSource,
    ) -> io::Result<Option<CommandResponse>> {
        let parsed = grammar::parse_line(line);
        if let Ok(line) = &parsed
            && let Some(refused) = self.reject_while_paused(line).or_else(|| self.reject_if_hosted(line))
        {
            return Ok(Some(refused));
        }
        let answer = match parsed {
            Ok(ParsedLine::Empty) => return Ok(None),
            Ok(ParsedLine::TextCommand { word, .. }) if word == "check" => {
                self.check_command(line).unwrap_or_else(syntax_error)
            }
            Ok(ParsedLine::TextCommand { word, rest }) => self.execute_text_command(&word, &rest, line),
            Ok(ParsedLine::Call { word, arguments, .. }) if NEXT_WEEK_COMMANDS.contains(&word.as_str()) => {
                self.next_week(&arguments, input)?
            }
            Ok(ParsedLine::Call { word, column, arguments }) => {
                self.execute_command(&word, column, &arguments)
            }
            Err(problem) => syntax_error(problem),
        };
        Ok(Some(answer.with_word_from(line)))
    }

    /// Executes a command whose argument is the rest of the line.
    fn execute_text_command(&mut self, word: &str, rest: &str, line: &str) -> CommandResponse {
        // Errors report columns of the whole line.
        let column = line.trim_end().chars().count() - rest.chars().count() + 1;
        match grammar::current_name(word) {
            "inbox" => self.run_inbox_query(rest, column),
            "memo" if rest.is_empty() => self.show_notes(),
            "memo" => self.add_note(rest),
            "explain" | "what" => self.explain(word, rest),
            "glossary" => glossary(rest, &self.session),
            "rules" => self.rules_command(rest, column),
            "xray" => self.query_hidden_tables(rest, column),
            "why" => self.run_why(rest, column).unwrap_or_else(syntax_error),
            "whatif" => self.execute_what_if(rest, column).unwrap_or_else(syntax_error),
            "pause" => self.pause(rest),
            "break" => self.breakpoint_command(rest, column).unwrap_or_else(syntax_error),
            "run" => self.run_days(rest, column).unwrap_or_else(syntax_error),
            "since" => self.run_since(word, rest, column).unwrap_or_else(syntax_error),
            "find" => self.run_find(rest, column).unwrap_or_else(syntax_error),
            "who" => self.run_who(rest, column).unwrap_or_else(syntax_error),
            "resume" => self.resume(rest),
            _ => self.execute_query(&grammar::sql_statement(rest), QuerySource::Typed),
        }
    }

    fn execute_query(&mut self, sql: &str, via: QuerySource) -> CommandResponse {
        let answer = self.session.up_to_date_database().and_then(RunDatabase::interrupt_handle).and_then(
            |interrupt| {
                // After the ticket is issued, a signal stops the query even if the query has not started.
                let ticket = interrupt.issue_ticket();
                self.watch.enter_query(interrupt);
                self.session.query_as(Some(ticket), sql, via)
            },
        );
        self.watch.set_phase(Phase::Working);
        match answer {
            Ok(rows) => {
                CommandResponse::success("sql", format_result(&rows), Value::Object(rows_to_json(&rows)))
            }
            Err(rejection) => CommandResponse::rejected("sql", rejection),
        }
    }

    fn explain(&mut self, word: &str, rest: &str) -> CommandResponse {
        let answer = explain(word, rest, &self.session.numbers());
        if let Ok(subject) = novamind_glossary::find_subject(rest) {
            let help = HelpRequest { term: subject.name(), place: "plain".to_owned() };
            self.session.activity().record(Activity::Help(help));
        }
        answer
    }

    /// Records a read-only command and its arguments as activity of the player.
    fn record_view(&mut self, word: &str, arguments: &[Argument]) {
        let words = arguments.iter().map(|argument| match &argument.value {
            Value::String(text) => text.clone(),
            other => other.to_string(),
        });
        let which = std::iter::once(word.to_owned()).chain(words).collect::<Vec<_>>().join(" ");
        let (screen, what) = ("plain".to_owned(), "command".to_owned());
        self.session.activity().record(Activity::Select(ObjectSelection { screen, what, which }));
    }

    fn next_week(&mut self, arguments: &[Argument], input: &mut LineSource) -> io::Result<CommandResponse> {
        let day = self.session.day();
        let filing = match advance::parse_next_week_input(arguments, &self.session, self.is_interactive) {
            Ok(advance::NextWeekInput::Ask) => {
                match advance::ask_next_week_input(&mut self.session, input)? {
                    Some(filing) => filing,
                    None => {
                        let text = "cancelled; no day has passed".to_owned();
                        return Ok(CommandResponse::success("next", text, json!({ "cancelled": true })));
                    }
                }
            }
            Ok(filing) => filing,
            Err(problem) => return Ok(syntax_error(problem)),
        };
        // The time for the week may have ended while the player was typing.
        let limits = self.check_limits();
        match limits.into_iter().reduce(CommandResponse::followed_by) {
            Some(response) if self.session.day() != day || self.session.log().is_clock_stopped() => {
                Ok(response)
            }
            Some(response) => Ok(response.followed_by(self.advance(filing))),
            None => Ok(self.advance(filing)),
        }
    }

    /// Submits the week and simulates it. The result of the last week is held back until the participant has answered
    /// the final questions.
    pub(super) fn advance(&mut self, filing: advance::NextWeekInput) -> CommandResponse {
        let response = advance::advance_week(&mut self.session, filing);
        if self.session.ended().is_none() || !self.has_final_questions || !response.is_success() {
            return response;
        }
        self.held_result = Some(response);
        let text = "the run has ended; please answer the last questions".to_owned();
        CommandResponse::success("next", text, json!({ "ended": true }))
    }

    /// Rejects commands that are not available in hosted sessions.
    fn reject_if_hosted(&self, line: &ParsedLine) -> Option<CommandResponse> {
        let word = match line {
            ParsedLine::Empty => return None,
            ParsedLine::TextCommand { word, .. } | ParsedLine::Call { word, .. } => {
                grammar::current_name(word)
            }
        };
        let is_command = COMMANDS.iter().any(|(name, _)| *name == word);
        (self.is_hosted && is_command && !is_hosted_command(word)).then(|| {
            let text = format!("{word} is not available in a hosted session");
            CommandResponse::rejected(word, Rejection::new("not_available", text))
        })
    }

    fn execute_command(&mut self, word: &str, column: usize, arguments: &[Argument]) -> CommandResponse {
        let outcome = match grammar::current_name(word) {
            "quit" | "exit" => expect_no_arguments(arguments).map(|()| CommandResponse::Quit),
            "dashboard" => expect_no_arguments(arguments).map(|()| self.dashboard()),
            "status" => expect_no_arguments(arguments).map(|()| self.status()),
            "inbox" => self.run_inbox(arguments),
            "thread" => self.thread_command(arguments),
            "changes" => expect_no_arguments(arguments).map(|()| self.changes()),
            "needs" => expect_no_arguments(arguments).map(|()| self.action_needed()),
            "fit" => optional_name(arguments).and_then(|name| self.fit(name, arguments)),
            "leads" => optional_name(arguments).and_then(|name| self.leads(name, arguments)),
            "curve" => self.curve(arguments),
            "undo" => expect_no_arguments(arguments).map(|()| self.undo()),
            "redo" => expect_no_arguments(arguments).map(|()| self.redo()),
            "vars" => {
                expect_no_arguments(arguments).map(|()| self.call_tool_by_id(ToolId::GetVars, &json!({})))
            }
            "help" => {
                let numbers = self.session.numbers();
                let audience = help::Audience { led: self.is_participant, hosted: self.is_hosted };
                optional_name(arguments).and_then(|name| help::help(name, arguments, &numbers, audience))
            }
            "tools" => optional_name(arguments)
                .and_then(|name| overview::tools_command(name, arguments, &self.session.numbers())),
            "queries" => optional_name(arguments).and_then(|name| match name {
                Some(name) => self.run_named_query(name, arguments),
                None => Ok(self.list_queries()),
            }),
            "tables" => optional_name(arguments).and_then(|name| {
                overview::tables_command(name, arguments, self.session.numbers().interface())
            }),
            "report" => optional_name(arguments).and_then(|what| self.report(what, arguments)),
            "history" => optional_count(arguments).map(|count| self.history(count.unwrap_or(20))),
            "branch" => self.create_branch(arguments),
            "lesson" => self.lesson_command(arguments),
            "guess" => self.run_guess(arguments),
            "hint" => expect_no_arguments(arguments).map(|()| self.run_hint()),
            "retry" => self.restart_step(word, arguments),
            "debrief" => expect_no_arguments(arguments).map(|()| self.debrief()),
            "branches" => expect_no_arguments(arguments).map(|()| self.show_branches()),
            "xray" => self.xray_command(arguments),
            "lens" => self.show_customer(arguments),
            "diff" => self.difference(arguments),
            "set" => self.set_parameter(arguments),
            "step" => optional_count(arguments).map(|days| self.step(days.unwrap_or(1))),
            _ => self.call_tool(word, column, arguments),
        };
        if outcome.is_ok() && READ_COMMANDS.contains(&word) {
            self.record_view(word, arguments);
        }
        outcome.unwrap_or_else(syntax_error)
    }

    /// Calls a tool by its name, which may be preceded by the name of its module.
    fn call_tool(
        &mut self,
        word: &str,
        column: usize,
        arguments: &[Argument],
    ) -> Result<CommandResponse, ParseError> {
        let tool = find_tool(word).ok_or_else(|| self.record_unknown_tool(word, column, arguments))?;
        let arguments = parse_call_arguments(tool, arguments)?;
        Ok(self.call_tool_by_id(tool.spec().id, &arguments))
    }

    fn call_tool_by_id(&mut self, tool: ToolId, arguments: &Value) -> CommandResponse {
        let planned = self.planned_offers(tool, arguments);
        match self.call_cancellable(tool, arguments) {
            Ok(data) if tool.executes_code() => queries::script_response(tool, &data),
            Ok(data) => {
                let shown = groups::answer_with_ranges(&self.session, &data);
                let answer = CommandResponse::tool_result(tool.name(), data.to_json(), shown);
                let offers = self.describe_offers(&planned.sent_in(&data));
                answer.with_notes(&self.late_project_warnings(&data)).with_notes(&offers)
            }
            Err(rejection) => CommandResponse::rejected(tool.name(), rejection),
        }
    }

    /// Returns a warning if a started R&D project ends after the last day.
    fn late_project_warnings(&self, started: &novamind_tools::Answer) -> Vec<String> {
        let novamind_tools::Answer::StartResearchProject(started) = started else { return Vec::new() };
        let last_day = self.session.manifest().days;
        let is_late = started.expected_completion_day > last_day;
        is_late
            .then(|| describe_late_project(&started.project_id, started.expected_completion_day, last_day))
            .into_iter()
            .collect()
    }

    fn undo(&mut self) -> CommandResponse {
        match self.session.undo(Via::Plain) {
            Ok(back) => CommandResponse::success(
                "undo",
                describe_changes("undone", &back),
                json!({ "taken_back": back }),
            ),
            Err(rejection) => CommandResponse::rejected("undo", rejection),
        }
    }

    fn redo(&mut self) -> CommandResponse {
        match self.session.redo(Via::Plain) {
            Ok(setting_changes) => CommandResponse::success(
                "redo",
                describe_changes("redone", &setting_changes),
                json!({ "set_again": setting_changes }),
            ),
            Err(rejection) => CommandResponse::rejected("redo", rejection),
        }
    }

    fn step(&mut self, days: u32) -> CommandResponse {
        match self.session.step(days, &mut |_| {}) {
            Ok(week) => advance::week_response("step", &self.session, &week),
            Err(rejection) => CommandResponse::rejected("step", rejection),
        }
    }
}

/// Parses a line that calls a tool. Does not accept `next_week` and `query`, which are separate commands.
///
/// # Errors
/// The line is not a tool call. The message describes the problem.
pub fn parse_tool_call(line: &str) -> Result<(ToolId, Value), String> {
    let parsed = grammar::parse_line(line).map_err(|problem| problem.text)?;
    let ParsedLine::Call { word, column, arguments } = parsed else {
        return Err("write one call of a tool, for example set_prices B=30".to_owned());
    };
    let Some(tool) = find_tool(&word) else {
        return Err(match COMMANDS.iter().any(|(name, _)| *name == grammar::current_name(&word)) {
            true => format!("{word} is a command of plain mode. Only calls of tools are possible here."),
            false => unknown_command(&word, column).text,
        });
    };
    let arguments = parse_call_arguments(tool, &arguments).map_err(|problem| problem.text)?;
    Ok((tool.spec().id, arguments))
}

/// Finds a tool by its name, which may be preceded by the name of its module. Does not find `next_week` and
/// `query`, which are separate commands.
fn find_tool(word: &str) -> Option<&'static dyn AnyTool> {
    let (module, name) = match word.split_once('.') {
        Some((module, name)) => (Some(module), name),
        None => (None, word),
    };
    let fits = |module: &str, tool_module: ToolModule| tool_module.id() == module;
    novamind_tools::find(name)
        .filter(|tool| tool.spec().kind != ToolKind::Time && tool.spec().name() != "query")
        .filter(|tool| module.is_none_or(|module| fits(module, tool.spec().module)))
}

/// Converts the arguments of a tool call to a JSON object. Errors include an example call.
fn parse_call_arguments(tool: &'static dyn AnyTool, arguments: &[Argument]) -> Result<Value, ParseError> {
    arguments_to_object(arguments, tool.spec().positional_argument()).map_err(|problem| {
        let (spec, text) = (tool.spec(), problem.text);
        ParseError { text: format!("{text}; example: {} {}", spec.name(), spec.example), ..problem }
    })
}

/// Formats a heading and the restored changes, one per line.
fn describe_changes(what: &str, changes: &[SettingChange]) -> String {
    let lines: String =
        changes.iter().map(|change| format!("{}\n", overview::describe_setting_change(change))).collect();
    format!("{what}\n{lines}")
}

fn unknown_command(word: &str, column: usize) -> ParseError {
    let commands = COMMANDS.iter().chain(&grammar::FORMER_NAMES).map(|(name, _)| *name);
    let tools = novamind_tools::CATALOGUE.iter().map(|tool| tool.spec().name());
    let name = word.rsplit('.').next().unwrap_or(word);
    if novamind_tools::find(name).is_some_and(|tool| tool.spec().kind == ToolKind::Time) {
        let text = format!(
            "{word} is not a command in plain mode. To simulate a week, type: next \"WHY\" naive. For help, type: help next"
        );
        return ParseError { text, column };
    }
    let near = similar_names(name, commands.chain(tools));
    let help = if near.is_empty() {
        "; type help to list all commands".to_owned()
    } else {
        format!("; did you mean {}?", near.join(" or "))
    };
    ParseError { text: format!("{word} is not a command{help}"), column }
}

fn syntax_error(problem: ParseError) -> CommandResponse {
    CommandResponse::syntax_error(problem.text, problem.column)
}

fn argument_error(arguments: &[Argument], text: &str) -> ParseError {
    ParseError::at_first_argument(arguments, text)
}

fn expect_no_arguments(arguments: &[Argument]) -> Result<(), ParseError> {
    match arguments {
        [] => Ok(()),
        _ => Err(argument_error(arguments, "this command takes no arguments")),
    }
}

/// Parses an optional name as the only argument.
fn optional_name(arguments: &[Argument]) -> Result<Option<&str>, ParseError> {
    match arguments {
        [] => Ok(None),
        [Argument { key: None, value: Value::String(name), .. }] => Ok(Some(name)),
        _ => Err(argument_error(arguments, "this command takes at most one name")),
    }
}

/// Parses an optional whole number of at least 1 as the only argument.
fn optional_count(arguments: &[Argument]) -> Result<Option<u32>, ParseError> {
    let number = |value: &Value| {
        value.as_u64().filter(|number| *number > 0).and_then(|number| u32::try_from(number).ok())
    };
    match arguments {
        [] => Ok(None),
        [Argument { key: None, value, .. }] if number(value).is_some() => Ok(number(value)),
        _ => Err(argument_error(arguments, "this command takes at most one argument, a whole number from 1")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Commands that are not available in hosted sessions: they create or open other runs, show hidden state, belong
    /// to lessons or debug runs, or simulate the run again.
    const CLOSED_COMMANDS: &[&str] = &[
        "why", "whatif", "branch", "branches", "step", "xray", "lens", "break", "run", "since", "find",
        "who", "diff", "lesson", "guess", "hint", "debrief", "retry", "set",
    ];

    #[test]
    fn every_command_is_in_exactly_one_hosted_list() {
        for (name, _) in COMMANDS {
            let lists = [HOSTED_COMMANDS, CLOSED_COMMANDS].map(|list| list.contains(name));
            assert_ne!(lists[0], lists[1], "{name}: add it to one of the two lists");
        }
        let is_command = |name: &&&str| COMMANDS.iter().any(|(command, _)| *command == **name);
        let all = HOSTED_COMMANDS.iter().chain(CLOSED_COMMANDS);
        assert_eq!(all.filter(is_command).count(), HOSTED_COMMANDS.len() + CLOSED_COMMANDS.len());
    }
}
