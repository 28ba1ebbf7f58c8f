//! Pages for participants.

use std::time::Instant;

use axum::Extension;
use axum::extract::{Path, State};
use axum::http::header::{CONTENT_SECURITY_POLICY, RETRY_AFTER, SET_COOKIE};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{Html, IntoResponse, Response};

use super::WebHost;
use super::request_guard::{CheckedRequest, PARTICIPANT_COOKIE, cookie, set_cookie};
use crate::access::random_text;
use crate::audit::AuditEvent;

/// Answers a link with a token: stores the token in a cookie and opens the terminal, so that the token leaves the address.
///
/// A redirect would not do: browsers send no `SameSite=Strict` cookie after a redirect if the link was on another site, for
/// example in an email. The page that this function returns is a page of the host, so its request for `/` has the cookie.
pub(super) async fn open_link(
    State(host): State<WebHost>,
    Extension(request): Extension<CheckedRequest>,
    Path(token): Path<String>,
) -> Response {
    let now = Instant::now();
    if host.sessions().label_for_token(&token).is_none() {
        // A valid token is never delayed, so that one participant cannot lock out others who share an address.
        if let Some(delay) = host.wrong_tokens().delay(request.client, now) {
            let text = "Too many wrong links were opened from this network. Wait a minute, then open your link again.";
            let page = message_page("Too many attempts", text);
            let seconds = delay.as_secs() + 1;
            return (StatusCode::TOO_MANY_REQUESTS, [(RETRY_AFTER, seconds.to_string())], page)
                .into_response();
        }
        host.wrong_tokens().record_failure(request.client, now);
        host.sessions().record(&AuditEvent::WrongToken { address: request.client.to_string() });
        return (StatusCode::NOT_FOUND, unknown_link()).into_response();
    }
    let cookie = set_cookie(PARTICIPANT_COOKIE, &token, "/", request.is_secure);
    let page = page(
        "Opening the session",
        r#"<meta http-equiv="refresh" content="0;url=/">"#,
        r#"<main class="message"><p>Opening your session … <a href="/">Open it now</a></p></main>"#,
        "",
    );
    ([(SET_COOKIE, cookie)], page).into_response()
}

/// Answers `/` with the terminal of the participant whose token is in the cookie.
pub(super) async fn terminal_page(
    State(host): State<WebHost>,
    Extension(request): Extension<CheckedRequest>,
    head: HeaderMap,
) -> Response {
    let Some(token) = cookie(&head, PARTICIPANT_COOKIE) else {
        let text = "Open the link that you were given. The link opens your session in this window.";
        return message_page("Open your link", text).into_response();
    };
    let Some(label) = host.sessions().label_for_token(token) else {
        return (StatusCode::FORBIDDEN, unknown_link()).into_response();
    };
    let Ok(nonce) = random_text::<16>() else {
        return StatusCode::INTERNAL_SERVER_ERROR.into_response();
    };
    let head = r#"<link rel="stylesheet" href="/assets/xterm.css">"#;
    let body = format!(
        r##"<div id="notice" role="status" hidden><span id="notice-text"></span><button id="notice-close" type="button">Close</button></div>
<div id="connection" role="status" hidden>The connection was lost. Connecting again … Everything is saved.</div>
<div id="terminal"></div>
<div id="keys" aria-label="Keys"><button type="button" data-key="esc">Esc</button><button type="button" data-key="tab">Tab</button><button type="button" data-key="left">←</button><button type="button" data-key="up">↑</button><button type="button" data-key="down">↓</button><button type="button" data-key="right">→</button><button type="button" data-key="enter">Enter</button><button type="button">?</button><button type="button">:</button><button type="button">;</button></div>
<div id="dialog" role="dialog" aria-labelledby="dialog-text" hidden><div><p id="dialog-text"></p><button id="dialog-button" type="button"></button></div></div>
<noscript><main class="message"><p>The terminal needs JavaScript. Allow scripts of this page, then reload it.</p></main></noscript>
<script src="/assets/xterm.js"></script>
<script src="/assets/addon-fit.js"></script>
<script src="/assets/addon-unicode-graphemes.js"></script>
<script src="/assets/addon-webgl.js"></script>
<script src="/assets/terminal.js" nonce="{nonce}"></script>"##
    );
    let attributes = format!(r#" class="terminal" data-label="{}""#, escape(&label));
    // Browsers differ in whether 'self' includes WebSocket addresses.
    let protocol = if request.is_secure { "wss" } else { "ws" };
    let policy = format!(
        "default-src 'none'; script-src 'self'; style-src 'self' 'nonce-{nonce}'; style-src-attr 'unsafe-inline'; \
         connect-src 'self' {protocol}://{}; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
        request.host
    );
    ([(CONTENT_SECURITY_POLICY, policy)], page("NovaMind", head, &body, &attributes)).into_response()
}

fn unknown_link() -> Html<String> {
    let text = "This link is not valid, or it has been replaced by a new one. Check that you copied the whole link, or ask \
                the experimenter for a new link. Everything that you confirmed in your session is saved.";
    message_page("Unknown link", text)
}

/// Returns a page with a heading and a text.
pub(super) fn message_page(title: &str, text: &str) -> Html<String> {
    let (title, text) = (escape(title), escape(text));
    page(&title, "", &format!(r#"<main class="message"><h1>{title}</h1><p>{text}</p></main>"#), "")
}

/// Returns a page. All arguments are HTML.
fn page(title: &str, head: &str, body: &str, body_attributes: &str) -> Html<String> {
    Html(format!(
        r#"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="/assets/terminal.css">
{head}
</head>
<body{body_attributes}>
{body}
</body>
</html>
"#
    ))
}

/// Escapes characters that have a meaning in HTML texts and attributes.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            _ => escaped.push(character),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_escaped() {
        assert_eq!(escape(r#"<a href="x">'&'</a>"#), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
        assert!(message_page("<b>", "<script>").0.contains("&lt;script&gt;"));
    }
}
