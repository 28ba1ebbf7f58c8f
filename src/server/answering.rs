//! Executes requests on the session, in the same way for all interfaces.

use serde_json::{Map, Value, json};

use super::request::{Answer, Request, Status};
use novamind_record::trajectory::record::{QuerySource, Via};
use novamind_session::{Session, WeekRequest, rows_as_json};
use novamind_tools::{Kept, Refusal, ToolId};

/// Tools for which older programs send null for omitted arguments.
const NULLS_ARE_LEFT_OUT: [ToolId; 3] = [ToolId::SetPrices, ToolId::SetModelTiers, ToolId::SetDailySpend];

/// Executes a request. `via` is the channel that the record names.
pub fn answer(session: &mut Session, request: Request, via: Via) -> Answer {
    match request {
        Request::Call { tool, args, request_id } => call(session, &tool, args, &request_id, via),
        Request::NextWeek { rationale, predictions, expected_day, request_id } => {
            let week = WeekRequest {
                rationale: &rationale,
                predictions: &predictions,
                expected_day: &expected_day,
                id: &request_id,
            };
            next_week(session, &week, via)
        }
        Request::Query { sql } => query(session, &sql),
        Request::Refused { tool, args, refusal } => {
            Answer::refused(Status::Refused, session.refuse_call(&tool, &args, via, refusal))
        }
        Request::Vars => Answer::plain(json!({ "current_day": session.day() })),
        Request::Dashboard => {
            Answer::plain(json!({ "dashboard": session.company().dashboard(), "day": session.day() }))
        }
        Request::GameStatus => game_status(session),
        Request::DailyScripts => Answer::data(json!({ "scripts": daily_scripts(session) })),
        Request::KeepDailyScript { name, content, request_id } => {
            keep_script(session, &json!({ "name": name, "code": content }), &request_id, via)
        }
        Request::ForgetDailyScript { name, request_id } => forget_script(session, name, &request_id, via),
        Request::Memo => match session.memo() {
            Ok(text) => Answer::data(json!({ "text": text })),
            Err(error) => Answer::wrong(Status::Failed, "not_read", error.to_string()),
        },
    }
}

fn call(session: &mut Session, tool: &str, mut args: Value, request_id: &Value, via: Via) -> Answer {
    if let Value::Object(fields) = &mut args
        && NULLS_ARE_LEFT_OUT.iter().any(|id| id.name() == tool)
    {
        fields.retain(|_, value| !value.is_null());
    }
    // The released simulator reads the arguments as the map by group, so a call without arguments clears it.
    if tool == ToolId::SetTargetedOpsSpend.name() && args.as_object().is_some_and(Map::is_empty) {
        args = json!({ "targeted_spend": {} });
    }
    match session.call_once(tool, &args, via, request_id) {
        Ok(data) => Answer::data(data),
        Err(refusal) if tool == ToolId::Query.name() => Answer::refused(Status::Refused, refusal),
        Err(refusal) => Answer::refused(Status::Done, refusal),
    }
}

fn next_week(session: &mut Session, request: &WeekRequest<'_>, via: Via) -> Answer {
    match session.advance_once(request, via) {
        Err(refusal) => Answer::refused(Status::Refused, refusal),
        Ok(week) => {
            let mut fields = Map::from_iter([
                ("day".to_owned(), week.figures.day.into()),
                ("dashboard".to_owned(), week.dashboard.clone().into()),
                ("cash".to_owned(), novamind_base::notation::json_number(week.figures.cash)),
                ("figures".to_owned(), Value::Object(week.figures.as_json())),
                ("ended".to_owned(), json!(week.ended)),
            ]);
            if let Some(remark) = week.remark {
                fields.insert("remark".to_owned(), remark.into());
            }
            Answer::done(fields)
        }
    }
}

fn query(session: &mut Session, sql: &Value) -> Answer {
    let Some(sql) = sql.as_str() else {
        return Answer::refused(Status::Refused, Refusal::at("sql", "sql_empty", "sql must be a text"));
    };
    match session.query_as(None, sql, QuerySource::Program) {
        Ok(rows) => Answer::done(rows_as_json(&rows)),
        Err(refusal) => Answer::refused(status_of_query(refusal.code), refusal),
    }
}

/// Returns the status with which the released server answers each kind of failed statement.
fn status_of_query(code: &str) -> Status {
    match code {
        "sql_empty" => Status::Refused,
        "sql_schema" | "sql_hidden_table" | "sql_hidden_column" | "sql_write" => Status::Forbidden,
        "sql_timeout" | "sql_cancelled" => Status::TimedOut,
        _ => Status::Failed,
    }
}

fn game_status(session: &Session) -> Answer {
    let seen = session.company().observe();
    Answer::plain(json!({
        "day": seen.day,
        "cash": seen.cash,
        "subscribers": seen.active_subscriptions(),
        "timed_out": false,
        "total_days": seen.last_day,
        "ended": session.ended(),
    }))
}

fn daily_scripts(session: &Session) -> Vec<Value> {
    let kept = session.notebook().statements(Kept::Script).entries();
    kept.iter().map(|(name, code)| json!({ "name": name, "size": code.len() })).collect()
}

fn keep_script(session: &mut Session, args: &Value, request_id: &Value, via: Via) -> Answer {
    match session.call_once(ToolId::RegisterScript, args, via, request_id) {
        Ok(answer) => Answer::data(json!({ "name": answer["name"], "registered": true })),
        Err(refusal) => Answer::refused(Status::Refused, refusal),
    }
}

fn forget_script(session: &mut Session, name: Value, request_id: &Value, via: Via) -> Answer {
    match session.call_once(ToolId::DeleteScript, &json!({ "name": name }), via, request_id) {
        Ok(_) => Answer::data(json!({ "removed": name })),
        Err(refusal) if refusal.code == "script_not_found" => Answer::refused(Status::Missing, refusal),
        Err(refusal) => Answer::refused(Status::Refused, refusal),
    }
}
