//! HTML of the experimenter's page.

use std::time::Duration;

use axum::response::Html;

use super::admin::{MAX_TEXT_CHARACTERS, RunProgress, SessionRow};
use super::pages::escape;
use crate::SessionState;

/// Interval at which the table is loaded again, in seconds.
const REFRESH_SECONDS: u32 = 5;

/// Returns the page that asks for the code.
pub(super) fn sign_in(problem: Option<&str>) -> Html<String> {
    let problem = problem.map_or(String::new(), |text| {
        format!(r#"<p class="outcome failed" role="alert">{}</p>"#, escape(text))
    });
    let body = format!(
        r#"<main class="sign-in"><h1>Sessions of this host</h1>{problem}
<form method="post" action="/admin/sign-in">
<label for="code">Code of the experimenter</label>
<input id="code" name="code" type="password" autocomplete="current-password" required autofocus>
<button>Open</button>
</form></main>"#
    );
    page("Sessions of this host", "", &body)
}

/// Returns the table of all sessions, which the browser loads again after a few seconds.
pub(super) fn overview(study: &str, rows: &[SessionRow], form_token: &str) -> Html<String> {
    let connected = rows.iter().filter(|row| row.client.is_some()).count();
    let started = rows.iter().filter(|row| row.run.is_some()).count();
    let lines = rows.iter().map(table_row).collect::<String>();
    let study = escape(study);
    let body = format!(
        r#"<header><h1>{study}</h1>
<form method="post" action="/admin/sign-out"><input type="hidden" name="form_token" value="{form_token}"><button>Sign out</button></form></header>
<p>{connected} of {} connected · {started} started. <span class="note">Updates every {REFRESH_SECONDS} s. Choose a label to send a message, or to pause or end the session.</span></p>
<div class="scroll"><table>
<thead><tr><th>Label</th><th>State</th><th>Run</th><th class="number">Week</th><th class="number">Connected</th><th class="number">Last key</th><th class="number">Last action</th><th class="number">Since start</th><th>Problems</th></tr></thead>
<tbody>
{lines}</tbody></table></div>"#,
        rows.len()
    );
    let head = format!(r#"<meta http-equiv="refresh" content="{REFRESH_SECONDS}">"#);
    page(&format!("{study}: sessions"), &head, &body)
}

fn table_row(row: &SessionRow) -> String {
    let label = escape(&row.label);
    let (class, state) = describe_state(row);
    let ago =
        |time: Option<Duration>| time.map_or(String::new(), |time| format!("{} ago", format_time(time)));
    let run = row.run.as_ref();
    let week = run.map_or(String::new(), |run| format!("{} of {}", run.week, run.weeks));
    format!(
        r#"<tr><td><a href="/admin/session/{label}">{label}</a></td><td class="{class}">{state}</td><td>{}</td><td class="number">{week}</td><td class="number">{}</td><td class="number">{}</td><td class="number">{}</td><td class="number">{}</td><td class="problem">{}</td></tr>
"#,
        run.map_or("not started", describe_run),
        row.connected_for.map_or(String::new(), format_time),
        ago(row.idle_for),
        ago(run.map(|run| run.last_action)),
        run.map_or(String::new(), |run| format_time(run.elapsed)),
        escape(&run.map_or(String::new(), |run| run.problems.join("; "))),
    )
}

fn describe_state(row: &SessionRow) -> (&'static str, String) {
    match &row.state {
        SessionState::Paused => ("stopped", "paused".to_owned()),
        SessionState::Ended(_) => ("stopped", "ended by the experimenter".to_owned()),
        SessionState::Open => match &row.client {
            Some(client) => ("connected", format!("connected: {}", escape(client))),
            None => ("", "not connected".to_owned()),
        },
    }
}

fn describe_run(run: &RunProgress) -> &'static str {
    use novamind_study::SessionState::{Idle, Left, Over, Paused, Plays, Stopped};
    match (run.is_practice, run.state) {
        (true, Over) => "practice, finished",
        (true, _) => "practice",
        (false, Plays) => "session",
        (false, Idle) => "session, idle",
        (false, Paused) => "session, clock stopped",
        (false, Left) => "session, left",
        (false, Stopped) => "session, interrupted",
        (false, Over) => "session, finished",
    }
}

/// Returns the page of one session with its actions.
pub(super) fn session(
    row: &SessionRow,
    form_token: &str,
    outcome: Option<Result<&str, String>>,
) -> Html<String> {
    let label = escape(&row.label);
    let outcome = match outcome {
        None => String::new(),
        Some(Ok(text)) => format!(r#"<p class="outcome" role="status">{}</p>"#, escape(text)),
        Some(Err(problem)) => format!(r#"<p class="outcome failed" role="alert">{}</p>"#, escape(&problem)),
    };
    let form = |action: &str, fields: &str, button: &str| {
        format!(
            r#"<form method="post"><input type="hidden" name="form_token" value="{form_token}"><input type="hidden" name="action" value="{action}">{fields}<button>{button}</button></form>"#
        )
    };
    let message = format!(
        r#"<label for="message">Text, at most {MAX_TEXT_CHARACTERS} characters</label><textarea id="message" name="text" rows="3" maxlength="{MAX_TEXT_CHARACTERS}" required></textarea>"#
    );
    let message = form("message", &message, "Send the message");
    let reason = format!(
        r#"<label for="reason">Reason, which the participant is shown</label><input id="reason" name="text" type="text" maxlength="{MAX_TEXT_CHARACTERS}" required>"#
    );
    let end = form("end", &reason, "End the session");
    let actions = match &row.state {
        SessionState::Open => format!(
            "<section><h2>Message</h2><p>The message is shown above the terminal until the participant closes it. \
             The participant must be connected.</p>{message}</section>\
             <section><h2>Pause</h2><p>The program saves and closes. The participant cannot continue until you resume the session.</p>{}</section>\
             <section><h2>End</h2><p>The program saves and closes. The participant cannot continue. This cannot be undone.</p>{end}</section>",
            form("pause", "", "Pause the session")
        ),
        SessionState::Paused => format!(
            "<section><h2>Resume</h2><p>The session is paused. After you resume it, the participant continues where the session was.</p>{}</section>\
             <section><h2>End</h2><p>The participant cannot continue. This cannot be undone.</p>{end}</section>",
            form("resume", "", "Resume the session")
        ),
        SessionState::Ended(reason) => {
            format!(
                "<section><h2>Ended</h2><p>The session was ended with this reason: {}</p></section>",
                escape(reason)
            )
        }
    };
    let (class, state) = describe_state(row);
    let run = row.run.as_ref().map_or("not started".to_owned(), |run| {
        format!("{}, week {} of {}", describe_run(run), run.week, run.weeks)
    });
    let body = format!(
        r#"<header><h1>Session {label}</h1><a href="/admin">All sessions</a></header>
{outcome}
<dl><dt>State</dt><dd class="{class}">{state}</dd><dt>Run</dt><dd>{run}</dd></dl>
{actions}"#
    );
    page(&format!("Session {label}"), "", &body)
}

/// Formats a time with its two largest units, for example `2 h 5 min`.
fn format_time(time: Duration) -> String {
    let seconds = time.as_secs();
    match seconds {
        0..60 => format!("{seconds} s"),
        60..3600 => format!("{} min", seconds / 60),
        3600..86_400 => format!("{} h {} min", seconds / 3600, seconds % 3600 / 60),
        _ => format!("{} d {} h", seconds / 86_400, seconds % 86_400 / 3600),
    }
}

/// Returns a page. All arguments are HTML.
fn page(title: &str, head: &str, body: &str) -> Html<String> {
    Html(format!(
        r#"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="/assets/admin.css">
{head}
</head>
<body>
{body}
</body>
</html>
"#
    ))
}
