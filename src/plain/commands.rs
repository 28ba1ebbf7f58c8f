//! The commands of plain mode and their answers (docs/interfaces/plain-mode.md#commands).

mod asked;
mod breakpoints;
mod check;
mod curve;
mod difference;
mod groups;
mod help;
mod inbox;
mod lesson;
mod memo;
mod parameters;
mod queries;
mod readings;
mod report;
mod rules;
mod thread;
mod whatif;
mod why;
mod words;
mod xray;

use std::io;

use serde_json::{Value, json};

pub use readings::change as change_line;
use words::{explain, glossary};

use super::answers::Answer;
use super::grammar::{self, Argument, Line, Problem, as_object};
use super::lines::Lines;
use super::next;
use super::signals::{Phase, Watch};
use novamind_base::nearest;
use novamind_database::text::table;
use novamind_insight::{Causes, LastRead, WhatIf};
use novamind_record::folder::library::Library;
use novamind_record::trajectory::record::{Activity, Help, QuerySource, Select, Via};
use novamind_report::research::late_in_words;
use novamind_session::{Change, RunDatabase, Session, rows_as_json};
use novamind_study::CodeCheck;
use novamind_tools::{AnyTool, Kind, Module, ToolId};

/// Commands that simulate a week: the plain-mode command and the names of the tool.
const NEXT: [&str; 3] = ["next", "next-week", "next_week"];

/// Commands that are not tools, with their help. Aliases have no help.
const COMMANDS: &[(&str, &str)] = &[
    ("sql", "sql SELECT …             query the database (also: query)"),
    ("queries", "queries [NAME]           list the library of queries, or run one of them"),
    (
        "next",
        "next \"WHY\" naive          submit a rationale and forecasts, simulate a week (also: next-week)",
    ),
    ("dashboard", "dashboard                show the dashboard of the last week"),
    ("status", "status                   show run, day, cash, runway, subscribers and waiting threads"),
    (
        "inbox",
        "inbox [all] [where …]    list threads that wait for an answer; inbox NUMBER shows the thread of one company",
    ),
    ("thread", "thread NUMBER            show one thread, turn by turn"),
    (
        "rules",
        "rules [send] RULES       preview what rules would send to waiting threads; with send, send it",
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
    ("check", "check CALL               preview the effect and cost of a call without making it"),
    ("undo", "undo                     undo the last setting of this week"),
    ("redo", "redo                     redo what undo reverted"),
    ("history", "history [N]              list the last N confirmed actions and weeks (20)"),
    ("report", "report [week|run]        report on the last week, or on the whole run"),
    (
        "why",
        "why FIGURE [WEEK]        compute how much each cause changed a figure of a week: why churn(S1) 44",
    ),
    ("whatif", "whatif from WEEK: EDITS   re-simulate with other decisions; whatif WEEK lists the decisions"),
    ("memo", "memo [TEXT]              show the notes of the run, or add a line"),
    ("tools", "tools [NAME]             list the tools, or show one of them"),
    ("tables", "tables [NAME]            list the tables, or show one of them"),
    ("explain", "explain TERM             explain a term, tool, argument, table or column (also: what)"),
    ("glossary", "glossary [WORD]          list all terms, or those that contain a word"),
    ("vars", "vars                     show the current day, as get_vars returns it"),
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
        "lens CUSTOMER [DAY]      the same: show the state of a customer, and what would have changed its decision",
    ),
    (
        "break",
        "break [CONDITION]        the same: stop run when a condition becomes true; list; break clear N|all removes",
    ),
    ("run", "run DAYS [until …]       debug: simulate days until a breakpoint or the condition becomes true"),
    (
        "since",
        "since [CONDITION|N]      debug and finished runs: show since when a condition or a breakpoint is true or false",
    ),
    ("find", "find CONDITION           the same: list the days on which a condition became true"),
    (
        "who",
        "who FIGURE [DAY]         the same: list the mechanisms that changed a figure on a day: who reputation(S3) 84, who cash",
    ),
    ("diff", "diff DAY DAY             the same: list the differences between the ends of two days"),
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
    ("quit", "quit                     leave; everything confirmed is saved (also: exit)"),
    ("query", ""),
    ("next-week", ""),
    ("what", ""),
    // Names of earlier versions.
    ("again", ""),
    ("back", ""),
];

/// Commands that only show something. Their use is recorded.
const LOOKS: &[&str] = &[
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
    /// The run.
    pub session: Session,
    library: Library,
    watch: Watch,
    /// Whether a person types and can be asked.
    pub(super) prompts: bool,
    /// Checks the experimenter's code. `None` if there is no experimenter.
    pub(super) code_check: Option<CodeCheck>,
    /// Whether the player is a participant of a study, for whom some commands are not available.
    pub(super) leads_participant: bool,
    /// Simulations of the last `why` question.
    causes_kept: LastRead<Causes>,
    /// Simulations of the last `whatif` question.
    branches_kept: LastRead<WhatIf>,
}

impl Interpreter {
    /// Creates an interpreter. `prompts` states that a person types and can be asked.
    pub fn new(mut session: Session, library: Library, watch: Watch, prompts: bool) -> Interpreter {
        session.answer_companies_by(novamind_rules::answers_to_companies);
        Interpreter {
            session,
            library,
            watch,
            prompts,
            code_check: None,
            leads_participant: false,
            causes_kept: LastRead::default(),
            branches_kept: LastRead::default(),
        }
    }

    /// Executes a line. Returns `None` for empty lines and comments.
    ///
    /// # Errors
    /// Reading the answer to a question fails.
    pub fn answer(&mut self, line: &str, input: &mut Lines) -> io::Result<Option<Answer>> {
        let parsed = grammar::parse(line);
        if let Ok(line) = &parsed
            && let Some(refused) = self.refuse_while_stopped(line)
        {
            return Ok(Some(refused));
        }
        let answer = match parsed {
            Ok(Line::Empty) => return Ok(None),
            Ok(Line::Text { word, .. }) if word == "check" => self.check(line).unwrap_or_else(usage),
            Ok(Line::Text { word, rest }) => self.text(&word, &rest, line),
            Ok(Line::Call { word, arguments, .. }) if NEXT.contains(&word.as_str()) => {
                self.next(&arguments, input)?
            }
            Ok(Line::Call { word, column, arguments }) => self.command(&word, column, &arguments),
            Err(problem) => usage(problem),
        };
        Ok(Some(answer.naming_the_word_in(line)))
    }

    /// Executes a command that takes the rest of its line as text.
    fn text(&mut self, word: &str, rest: &str, line: &str) -> Answer {
        // Columns are counted in the whole line.
        let column = line.trim_end().chars().count() - rest.chars().count() + 1;
        match word {
            "inbox" => self.inbox_where(rest, column),
            "memo" if rest.is_empty() => self.show_memo(),
            "memo" => self.add_to_memo(rest),
            "explain" | "what" => self.explain(word, rest),
            "glossary" => glossary(rest, &self.session),
            "rules" => self.rules(rest, column),
            "xray" => self.hidden_tables(rest, column),
            "why" => self.why(rest, column).unwrap_or_else(usage),
            "whatif" => self.what_if(rest, column).unwrap_or_else(usage),
            "pause" => self.pause(rest),
            "break" => self.breakpoint(rest, column).unwrap_or_else(usage),
            "run" => self.run_days(rest, column).unwrap_or_else(usage),
            "since" | "back" => self.back(word, rest, column).unwrap_or_else(usage),
            "find" => self.find_days(rest, column).unwrap_or_else(usage),
            "who" => self.who(rest, column).unwrap_or_else(usage),
            "resume" => self.resume(rest),
            _ => self.query(&grammar::statement(rest), QuerySource::Typed),
        }
    }

    fn query(&mut self, sql: &str, via: QuerySource) -> Answer {
        let answer =
            self.session.complete_database().and_then(RunDatabase::interrupt).and_then(|interrupt| {
                // From here on a signal stops this query, even though it has not started.
                let ticket = interrupt.ticket();
                self.watch.enter_query(interrupt);
                self.session.query_as(Some(ticket), sql, via)
            });
        self.watch.enter(Phase::Working);
        match answer {
            Ok(rows) => Answer::done("sql", table(&rows), Value::Object(rows_as_json(&rows))),
            Err(refusal) => Answer::refused("sql", refusal),
        }
    }

    fn explain(&mut self, word: &str, rest: &str) -> Answer {
        let answer = explain(word, rest, &self.session.numbers());
        if let Ok(subject) = novamind_glossary::find(rest) {
            let help = Help { term: subject.name(), place: "plain".to_owned() };
            self.session.activity().note(Activity::Help(help));
        }
        answer
    }

    /// Records that the player viewed something.
    fn note_look(&mut self, word: &str, arguments: &[Argument]) {
        let words = arguments.iter().map(|argument| match &argument.value {
            Value::String(text) => text.clone(),
            other => other.to_string(),
        });
        let which = std::iter::once(word.to_owned()).chain(words).collect::<Vec<_>>().join(" ");
        let (screen, what) = ("plain".to_owned(), "command".to_owned());
        self.session.activity().note(Activity::Select(Select { screen, what, which }));
    }

    fn next(&mut self, arguments: &[Argument], input: &mut Lines) -> io::Result<Answer> {
        let filing = match next::read(arguments, &self.session, self.prompts) {
            Ok(next::Filing::Ask) => match next::ask(&self.session, input)? {
                Some(filing) => filing,
                None => {
                    let text = "cancelled; no day has passed".to_owned();
                    return Ok(Answer::done("next", text, json!({ "cancelled": true })));
                }
            },
            Ok(filing) => filing,
            Err(problem) => return Ok(usage(problem)),
        };
        Ok(next::run(&mut self.session, filing))
    }

    fn command(&mut self, word: &str, column: usize, arguments: &[Argument]) -> Answer {
        let outcome = match word {
            "quit" | "exit" => none(arguments).map(|()| Answer::Quit),
            "dashboard" => none(arguments).map(|()| self.dashboard()),
            "status" => none(arguments).map(|()| self.status()),
            "inbox" => self.inbox(arguments),
            "thread" => self.thread(arguments),
            "changes" => none(arguments).map(|()| self.changes()),
            "needs" => none(arguments).map(|()| self.needs()),
            "fit" => name(arguments).and_then(|name| self.fit(name, arguments)),
            "leads" => name(arguments).and_then(|name| self.leads(name, arguments)),
            "curve" => self.curve(arguments),
            "undo" => none(arguments).map(|()| self.undo()),
            "redo" => none(arguments).map(|()| self.redo()),
            "vars" => none(arguments).map(|()| self.call_named(ToolId::GetVars, &json!({}))),
            "help" => {
                let (numbers, led) = (self.session.numbers(), self.leads_participant);
                name(arguments).and_then(|name| help::help(name, arguments, &numbers, led))
            }
            "tools" => {
                name(arguments).and_then(|name| readings::tools(name, arguments, &self.session.numbers()))
            }
            "queries" => name(arguments).and_then(|name| match name {
                Some(name) => self.named_query(name, arguments),
                None => Ok(self.queries()),
            }),
            "tables" => name(arguments).and_then(|name| readings::tables(name, arguments)),
            "report" => name(arguments).and_then(|what| self.report(what, arguments)),
            "history" => count(arguments).map(|count| self.history(count.unwrap_or(20))),
            "branch" => self.branch(arguments),
            "lesson" => self.lesson(arguments),
            "guess" => self.guess(arguments),
            "hint" => none(arguments).map(|()| self.hint()),
            "retry" | "again" => self.again(word, arguments),
            "debrief" => none(arguments).map(|()| self.debrief()),
            "branches" => none(arguments).map(|()| self.branches()),
            "xray" => self.xray(arguments),
            "lens" => self.lens(arguments),
            "diff" => self.difference(arguments),
            "set" => self.set(arguments),
            "step" => count(arguments).map(|days| self.step(days.unwrap_or(1))),
            _ => self.call(word, column, arguments),
        };
        if outcome.is_ok() && LOOKS.contains(&word) {
            self.note_look(word, arguments);
        }
        outcome.unwrap_or_else(usage)
    }

    /// Calls a tool by its name, with or without its module.
    fn call(&mut self, word: &str, column: usize, arguments: &[Argument]) -> Result<Answer, Problem> {
        let tool = tool_called(word).ok_or_else(|| self.unknown_tool(word, column, arguments))?;
        let arguments = read_arguments(tool, arguments)?;
        Ok(self.call_named(tool.spec().id, &arguments))
    }

    fn call_named(&mut self, tool: ToolId, arguments: &Value) -> Answer {
        match self.call_stoppable(tool, arguments) {
            Ok(data) if tool.runs_code() => queries::of_script(tool, &data),
            Ok(data) => {
                let shown = groups::with_ranges(&self.session, &data);
                let answer = Answer::call_shown(tool.name(), data.to_json(), shown);
                answer.with_notes(&self.late_projects(&data))
            }
            Err(refusal) => Answer::refused(tool.name(), refusal),
        }
    }

    /// Returns a warning if the started project ends after the last day.
    fn late_projects(&self, started: &novamind_tools::Answer) -> Vec<String> {
        let novamind_tools::Answer::StartResearchProject(started) = started else { return Vec::new() };
        let last_day = self.session.manifest().days;
        let is_late = started.expected_completion_day > last_day;
        is_late
            .then(|| late_in_words(&started.project_id, started.expected_completion_day, last_day))
            .into_iter()
            .collect()
    }

    fn undo(&mut self) -> Answer {
        match self.session.undo(Via::Plain) {
            Ok(back) => Answer::done("undo", in_words("undone", &back), json!({ "taken_back": back })),
            Err(refusal) => Answer::refused("undo", refusal),
        }
    }

    fn redo(&mut self) -> Answer {
        match self.session.redo(Via::Plain) {
            Ok(again) => Answer::done("redo", in_words("redone", &again), json!({ "set_again": again })),
            Err(refusal) => Answer::refused("redo", refusal),
        }
    }

    fn step(&mut self, days: u32) -> Answer {
        match self.session.step(days, &mut |_| {}) {
            Ok(week) => next::report("step", &self.session, &week),
            Err(refusal) => Answer::refused("step", refusal),
        }
    }
}

/// Returns the tool of a name, with or without its module. `next_week` and `query` are separate commands.
fn tool_called(word: &str) -> Option<&'static dyn AnyTool> {
    let (module, name) = match word.split_once('.') {
        Some((module, name)) => (Some(module), name),
        None => (None, word),
    };
    let fits = |module: &str, own: Module| own.id() == module;
    novamind_tools::find(name)
        .filter(|tool| tool.spec().kind != Kind::Time && tool.spec().name() != "query")
        .filter(|tool| module.is_none_or(|module| fits(module, tool.spec().module)))
}

/// Reads the arguments of a call. The error includes an example call.
fn read_arguments(tool: &'static dyn AnyTool, arguments: &[Argument]) -> Result<Value, Problem> {
    as_object(arguments, only_required(tool)).map_err(|problem| {
        let (spec, text) = (tool.spec(), problem.text);
        Problem { text: format!("{text}; example: {} {}", spec.name(), spec.example), ..problem }
    })
}

/// Lists the restored changes, one per line.
fn in_words(what: &str, changes: &[Change]) -> String {
    let lines: String = changes.iter().map(|change| format!("{}\n", readings::change(change))).collect();
    format!("{what}\n{lines}")
}

/// Returns the argument that may be given without its name: the only required one, the whole object, or the only one.
fn only_required(tool: &'static dyn AnyTool) -> Option<&'static str> {
    let mut required = tool.spec().arguments.iter().filter(|argument| argument.required);
    let only = required.next().filter(|_| required.next().is_none()).map(|argument| argument.name);
    let sole = match tool.spec().arguments {
        [argument] => Some(argument.name),
        _ => None,
    };
    only.or(tool.spec().whole).or(sole)
}

fn unknown(word: &str, column: usize) -> Problem {
    let commands = COMMANDS.iter().map(|(name, _)| *name);
    let tools = novamind_tools::CATALOGUE.iter().map(|tool| tool.spec().name());
    let name = word.rsplit('.').next().unwrap_or(word);
    if novamind_tools::find(name).is_some_and(|tool| tool.spec().kind == Kind::Time) {
        let text = format!(
            "{word} is not a command in plain mode; next \"WHY\" naive simulates a week, and help next \
             explains more"
        );
        return Problem { text, column };
    }
    let near = nearest(name, commands.chain(tools));
    let help = if near.is_empty() {
        "; help lists them all".to_owned()
    } else {
        format!("; did you mean {}?", near.join(" or "))
    };
    Problem { text: format!("{word} is not a command{help}"), column }
}

fn usage(problem: Problem) -> Answer {
    Answer::usage(problem.text, problem.column)
}

fn problem(arguments: &[Argument], text: &str) -> Problem {
    Problem::of(arguments, text)
}

fn none(arguments: &[Argument]) -> Result<(), Problem> {
    match arguments {
        [] => Ok(()),
        _ => Err(problem(arguments, "this command takes no arguments")),
    }
}

/// Parses at most one name.
fn name(arguments: &[Argument]) -> Result<Option<&str>, Problem> {
    match arguments {
        [] => Ok(None),
        [Argument { key: None, value: Value::String(name), .. }] => Ok(Some(name)),
        _ => Err(problem(arguments, "this command takes at most one name")),
    }
}

/// Parses at most one whole number from 1.
fn count(arguments: &[Argument]) -> Result<Option<u32>, Problem> {
    let number = |value: &Value| {
        value.as_u64().filter(|number| *number > 0).and_then(|number| u32::try_from(number).ok())
    };
    match arguments {
        [] => Ok(None),
        [Argument { key: None, value, .. }] if number(value).is_some() => Ok(number(value)),
        _ => Err(problem(arguments, "this command takes at most one argument, a whole number from 1")),
    }
}
