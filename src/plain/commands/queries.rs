//! `queries`: lists the queries of the library, or runs one query.

use serde_json::{Value, json};

use super::super::grammar::{Argument, ParseError, arguments_to_object};
use super::super::response::CommandResponse;
use super::super::signals::Phase;
use super::{Interpreter, argument_error, unknown_command};
use novamind_record::folder::query_library::NamedQuery;
use novamind_record::trajectory::record::{QuerySource, Via};
use novamind_session::RunDatabase;
use novamind_tools::{Rejection, ToolId};

impl Interpreter {
    /// Executes `queries`.
    pub(super) fn list_queries(&self) -> CommandResponse {
        let queries = self.library.queries();
        let width = queries.iter().map(|query| query.name.chars().count()).max().unwrap_or(0);
        let line = |query: &NamedQuery| format!("{:<width$}  {}", query.name, query.title);
        let lines: Vec<String> = queries.iter().map(line).collect();
        let one = |query: &NamedQuery| json!({ "name": query.name, "title": query.title, "what": query.description });
        let data: Vec<Value> = queries.iter().map(one).collect();
        let text = format!("{}\nTo run a query, type: queries NAME", lines.join("\n"));
        CommandResponse::success("queries", text, json!({ "queries": data }))
    }

    /// Executes `queries NAME`.
    pub(super) fn run_named_query(
        &mut self,
        name: &str,
        arguments: &[Argument],
    ) -> Result<CommandResponse, ParseError> {
        let Some(query) = self.library.find(name) else {
            let near = self.library.similar_names(name);
            let help = if near.is_empty() {
                "type queries to list all queries".to_owned()
            } else {
                format!("did you mean {}?", near.join(" or "))
            };
            return Err(argument_error(arguments, &format!("there is no query {name}; {help}")));
        };
        let sql = query.sql.clone();
        Ok(self.execute_query(&sql, QuerySource::Library))
    }

    /// Records a call of an unknown tool if the unknown command has arguments.
    pub(super) fn record_unknown_tool(
        &mut self,
        word: &str,
        column: usize,
        arguments: &[Argument],
    ) -> ParseError {
        let args = arguments_to_object(arguments, None).ok().filter(|_| !arguments.is_empty());
        if let Some(args) = args.filter(|_| novamind_tools::find(word).is_none()) {
            // The rejection is ignored, because plain mode prints its own response, which also suggests
            // similar commands.
            let _ = self.session.call(word, &args, Via::Plain);
        }
        unknown_command(word, column)
    }

    /// Calls a tool. While the tool runs, a signal stops a long script or query.
    pub(super) fn call_cancellable(
        &mut self,
        tool: ToolId,
        arguments: &Value,
    ) -> Result<novamind_tools::Answer, Rejection> {
        if tool.executes_code()
            && let Ok(interrupt) = self.session.up_to_date_database().and_then(RunDatabase::interrupt_handle)
        {
            self.watch.enter_query(interrupt);
        }
        let answer = self.session.call(tool, arguments, Via::Plain);
        self.watch.set_phase(Phase::Working);
        answer
    }
}

/// Returns the response to a script: its standard output, then its standard error.
pub(super) fn script_response(tool: ToolId, answer: &novamind_tools::Answer) -> CommandResponse {
    let data = answer.to_json();
    let part = |name: &str| data[name].as_str().unwrap_or_default().trim_end().to_owned();
    let text = ["stdout", "stderr"].map(part).join("\n");
    CommandResponse::success(tool.name(), format!("ok {tool}\n{}", text.trim_end()), data)
}
