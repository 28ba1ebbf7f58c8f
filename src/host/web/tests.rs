//! Tests of the web server over real connections. A shell script plays the part of the program.

use std::collections::HashMap;
use std::time::Duration;

use axum::http::Request;
use axum::http::header::{COOKIE, HOST, ORIGIN};
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::handshake::client::generate_key;
use tokio_tungstenite::tungstenite::protocol::Message;

use super::{FREE_WRONG_TOKENS, WebOptions, serve_web};
use crate::SessionState;
use crate::process::SessionProgram;
use crate::sessions::Sessions;
use crate::tests::with_study_sessions;
use novamind_study::CodeDigest;

const ADMIN_CODE: &str = "correct horse";

/// A running web server, and the tokens of its participants.
struct Web {
    port: u16,
    sessions: Sessions,
    tokens: HashMap<String, String>,
}

/// An answer: status, headers and body.
struct Answer {
    status: u16,
    head: String,
    body: String,
}

impl Answer {
    /// Returns the value of a header, or an empty text.
    fn header(&self, name: &str) -> &str {
        let lines = self.head.lines().filter_map(|line| line.split_once(": "));
        lines
            .filter(|(found, _)| found.eq_ignore_ascii_case(name))
            .map(|(_, value)| value)
            .next()
            .unwrap_or_default()
    }

    fn cookie(&self) -> String {
        self.header("set-cookie").split(';').next().unwrap_or_default().to_owned()
    }
}

fn with_web(test: impl AsyncFnOnce(&mut Web)) {
    let code = CodeDigest::from_code(ADMIN_CODE, "salt");
    with_study_sessions(SessionProgram::ABSENCE_LIMIT, Some(code), async |sessions| {
        let labels: Vec<String> = sessions.folder().labels().map(str::to_owned).collect();
        let issued = sessions.access().issue(&labels).expect("links");
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let bound = listener.local_addr().expect("an address");
        let options = WebOptions { public: None, trusted_proxies: Vec::new() };
        let server = tokio::spawn(serve_web(listener, bound, sessions.clone(), options));
        let tokens = issued.into_iter().map(|one| (one.label, one.token)).collect();
        test(&mut Web { port: bound.port(), sessions, tokens }).await;
        server.abort();
    });
}

impl Web {
    async fn request(&self, method: &str, path: &str, head: &[(&str, &str)], body: &str) -> Answer {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).await.expect("connected");
        let mut text =
            format!("{method} {path} HTTP/1.1\r\nConnection: close\r\nContent-Length: {}\r\n", body.len());
        if !head.iter().any(|(name, _)| *name == "Host") {
            text += &format!("Host: 127.0.0.1:{}\r\n", self.port);
        }
        for (name, value) in head {
            text += &format!("{name}: {value}\r\n");
        }
        text += &format!("\r\n{body}");
        stream.write_all(text.as_bytes()).await.expect("sent");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).await.expect("answered");
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let (head, body) = answer.split_once("\r\n\r\n").expect("a head");
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        Answer { status, head: head.to_owned(), body: body.to_owned() }
    }

    async fn get(&self, path: &str, cookie: &str) -> Answer {
        self.request("GET", path, &[("Cookie", cookie)], "").await
    }

    /// Sends a form as a page of the host does.
    async fn post(&self, path: &str, cookie: &str, form: &str) -> Answer {
        let origin = format!("http://127.0.0.1:{}", self.port);
        let kind = ("Content-Type", "application/x-www-form-urlencoded");
        self.request("POST", path, &[("Cookie", cookie), ("Origin", &origin), kind], form).await
    }

    fn participant_cookie(&self, label: &str) -> String {
        format!("novamind-session={}", self.tokens[label])
    }

    /// Connects a page. `origin` is the site of the page.
    async fn connect(&self, label: &str, origin: &str) -> Option<Page> {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).await.expect("connected");
        let request = Request::builder()
            .uri(format!("ws://127.0.0.1:{}/socket", self.port))
            .header(HOST, format!("127.0.0.1:{}", self.port))
            .header(ORIGIN, origin)
            .header(COOKIE, self.participant_cookie(label))
            .header("Connection", "Upgrade")
            .header("Upgrade", "websocket")
            .header("Sec-WebSocket-Version", "13")
            .header("Sec-WebSocket-Key", generate_key())
            .body(())
            .expect("a request");
        let socket = tokio_tungstenite::client_async(request, stream).await.ok()?.0;
        Some(Page { socket, output: String::new() })
    }

    /// Connects a page and sends its first message.
    async fn open(&self, label: &str, client: &str, resume: bool) -> Page {
        let origin = format!("http://127.0.0.1:{}", self.port);
        let mut page = self.connect(label, &origin).await.expect("a connection");
        page.send(json!({"type": "hello", "label": label, "client": client, "resume": resume, "columns": 80, "rows": 24}))
            .await;
        page
    }

    async fn sign_in(&self) -> (String, String) {
        let answer = self.post("/admin/sign-in", "", "code=correct+horse").await;
        assert_eq!(answer.status, 303, "{}", answer.body);
        let cookie = answer.cookie();
        let page = self.get("/admin", &cookie).await.body;
        let token = page.split(r#"name="form_token" value=""#).nth(1).and_then(|rest| rest.split('"').next());
        (cookie, token.expect("a token").to_owned())
    }

    fn audit_log(&self) -> String {
        std::fs::read_to_string(self.sessions.folder().path().join(crate::AUDIT_FILE)).expect("a log")
    }
}

/// The page of a participant.
struct Page {
    socket: WebSocketStream<TcpStream>,
    /// All output that was received.
    output: String,
}

impl Page {
    async fn send(&mut self, message: Value) {
        use futures_util::SinkExt;
        self.socket.send(Message::text(message.to_string())).await.expect("sent");
    }

    async fn input(&mut self, number: u64, text: &str) {
        self.send(json!({"type": "input", "number": number, "text": text})).await;
    }

    /// Reads messages until one has this type. Collects output on the way.
    async fn read(&mut self, kind: &str) -> Value {
        use futures_util::StreamExt;
        loop {
            let message = tokio::time::timeout(Duration::from_secs(20), self.socket.next()).await;
            match message.expect("a message in time").expect("a message").expect("a valid message") {
                Message::Binary(bytes) => self.output += &String::from_utf8_lossy(&bytes),
                Message::Text(text) => {
                    let message: Value = serde_json::from_str(text.as_str()).expect("JSON");
                    if message["type"] == kind {
                        return message;
                    }
                    assert_ne!(message["type"], "closed", "instead of {kind}: {message}");
                }
                other => panic!("{other:?} instead of {kind}"),
            }
        }
    }

    /// Reads messages until the output contains a text.
    async fn read_output(&mut self, part: &str) {
        use futures_util::StreamExt;
        while !self.output.contains(part) {
            let message = tokio::time::timeout(Duration::from_secs(20), self.socket.next()).await;
            if let Message::Binary(bytes) = message.expect("in time").expect("a message").expect("valid") {
                self.output += &String::from_utf8_lossy(&bytes);
            }
        }
    }
}

#[test]
fn link_stores_the_token_in_a_cookie_and_opens_the_terminal() {
    with_web(async |web| {
        let opened = web.get(&format!("/s/{}", web.tokens["P01"]), "").await;
        assert_eq!(opened.status, 200);
        let cookie = opened.header("set-cookie");
        assert!(cookie.ends_with("; Path=/; HttpOnly; SameSite=Strict"), "{cookie}");
        assert!(opened.body.contains(r#"content="0;url=/""#) && !opened.body.contains(&web.tokens["P01"]));
        let terminal = web.get("/", &opened.cookie()).await;
        assert!(terminal.status == 200 && terminal.body.contains(r#"data-label="P01""#));
        assert!(!terminal.body.contains(&web.tokens["P01"]));
        let policy = terminal.header("content-security-policy");
        assert!(policy.contains("default-src 'none'; script-src 'self';"), "{policy}");
        for answer in [&opened, &terminal] {
            assert_eq!(answer.header("referrer-policy"), "no-referrer");
            assert_eq!(answer.header("cache-control"), "no-store");
            assert_eq!(answer.header("x-frame-options"), "DENY");
        }
        assert!(web.get("/", "").await.body.contains("Open the link that you were given"));
        let renewed = web.sessions.access().issue(&["P01".to_owned()]).expect("a link");
        assert_eq!(web.get("/", &opened.cookie()).await.status, 403, "a replaced link is not valid");
        assert_eq!(web.get(&format!("/s/{}", renewed[0].token), "").await.status, 200);
    });
}

#[test]
fn wrong_tokens_are_recorded_and_limited_and_valid_ones_are_not() {
    with_web(async |web| {
        for _ in 0..=FREE_WRONG_TOKENS {
            assert_eq!(web.get("/s/0123456789abcdef0123456789abcdef", "").await.status, 404);
        }
        let limited = web.get("/s/0123456789abcdef0123456789abcdef", "").await;
        assert!(limited.status == 429 && limited.header("retry-after").parse::<u64>().is_ok());
        assert_eq!(web.get(&format!("/s/{}", web.tokens["P01"]), "").await.status, 200);
        assert_eq!(web.audit_log().matches("wrong_token").count(), FREE_WRONG_TOKENS as usize + 1);
    });
}

#[test]
fn requests_of_other_sites_are_refused() {
    with_web(async |web| {
        let cookie = web.participant_cookie("P01");
        let head = [("Host", "evil.example"), ("Cookie", cookie.as_str())];
        assert_eq!(web.request("GET", "/", &head, "").await.status, 403);
        assert!(web.connect("P01", "https://evil.example").await.is_none());
        let kind = ("Content-Type", "application/x-www-form-urlencoded");
        for head in [&[kind][..], &[kind, ("Origin", "null")], &[kind, ("Origin", "https://evil.example")]] {
            assert_eq!(web.request("POST", "/admin/sign-in", head, "code=correct+horse").await.status, 403);
        }
    });
}

#[test]
fn assets_are_compressed_and_confirmed() {
    with_web(async |web| {
        let script = web.get("/assets/terminal.js", "").await;
        assert_eq!((script.status, script.header("content-encoding")), (200, "gzip"));
        assert_eq!(script.header("content-type"), "text/javascript; charset=utf-8");
        let tag = [("If-None-Match", script.header("etag"))];
        assert_eq!(web.request("GET", "/assets/terminal.js", &tag, "").await.status, 304);
        assert_eq!(web.get("/assets/..%2fmod.rs", "").await.status, 404);
    });
}

#[test]
fn inputs_sent_again_after_a_reconnect_act_once() {
    with_web(async |web| {
        let mut page = web.open("P01", "a", false).await;
        assert_eq!(
            page.read("welcome").await,
            json!({"type": "welcome", "acknowledged": 0, "continues": true})
        );
        page.read_output("ready P01 24 80").await;
        page.input(1, "one\n").await;
        assert_eq!(page.read("acknowledged").await["number"], 1);
        page.input(2, "two\n").await;
        page.read_output("got two").await;
        drop(page);
        // The acknowledgement of 2 was lost, so the page sends 2 again, and 3 for the first time.
        let mut page = web.open("P01", "a", true).await;
        assert_eq!(
            page.read("welcome").await,
            json!({"type": "welcome", "acknowledged": 2, "continues": true})
        );
        page.input(2, "two\n").await;
        page.input(3, "three\n").await;
        page.read_output("got three").await;
        assert_eq!(page.output.matches("got two").count(), 1, "{}", page.output);
    });
}

#[test]
fn second_page_takes_over_and_the_first_does_not_return_by_itself() {
    with_web(async |web| {
        let mut first = web.open("P01", "a", false).await;
        first.read_output("ready").await;
        let mut second = web.open("P01", "b", false).await;
        second.read("welcome").await;
        assert_eq!(first.read("closed").await["reason"], "taken_over");
        let mut returning = web.open("P01", "a", true).await;
        assert_eq!(returning.read("closed").await["reason"], "taken_over");
        second.input(1, "still here\n").await;
        second.read_output("got still here").await;
        let mut chosen = web.open("P01", "a", false).await;
        chosen.read("welcome").await;
        assert_eq!(second.read("closed").await["reason"], "taken_over");
    });
}

#[test]
fn page_of_another_participant_is_signed_out() {
    with_web(async |web| {
        let origin = format!("http://127.0.0.1:{}", web.port);
        let mut page = web.connect("P02", &origin).await.expect("a connection");
        let hello = json!({"type": "hello", "label": "P01", "client": "a", "resume": true, "columns": 80, "rows": 24});
        page.send(hello).await;
        assert_eq!(page.read("closed").await["reason"], "signed_out");
        assert!(web.sessions.statuses().iter().all(|status| status.client.is_none()));
    });
}

#[test]
fn output_waits_until_the_page_has_displayed_it() {
    with_web(async |web| {
        let mut page = web.open("P01", "a", false).await;
        page.read_output("ready").await;
        let line = "x".repeat(4000);
        for number in 1..=40 {
            page.input(number, &format!("{line}\n")).await;
        }
        page.input(41, "last\n").await;
        while page.read("acknowledged").await["number"] != 41 {}
        // The page displays nothing, so it gets at most the bytes that may be on their way, and the last part of a message.
        page.read("alive").await;
        page.read("alive").await;
        assert!(page.output.len() < 2 * (64 << 10), "{}", page.output.len());
        assert!(!page.output.contains("got last"));
        let bytes = page.output.len();
        page.send(json!({"type": "displayed", "bytes": bytes})).await;
        page.read_output("got last").await;
    });
}

#[test]
fn admin_code_is_checked_with_a_growing_delay() {
    with_web(async |web| {
        let page = web.get("/admin", "").await;
        assert!(
            page.status == 200
                && page.body.contains("Code of the experimenter")
                && !page.body.contains("P01")
        );
        // With `no-referrer`, browsers send the origin `null` with forms.
        assert_eq!(page.header("referrer-policy"), "same-origin");
        assert_eq!(web.get("/admin/session/P01", "").await.status, 303);
        for _ in 0..3 {
            assert_eq!(web.post("/admin/sign-in", "", "code=wrong").await.status, 403);
        }
        let waiting = web.post("/admin/sign-in", "", "code=correct+horse").await;
        assert!(waiting.status == 429 && waiting.header("set-cookie").is_empty());
        assert_eq!(web.audit_log().matches("wrong_admin_code").count(), 3);
    });
}

#[test]
fn admin_actions_need_the_form_token_and_are_recorded() {
    with_web(async |web| {
        let (cookie, token) = web.sign_in().await;
        assert!(web.get("/admin", &cookie).await.body.contains("/admin/session/P02"));
        let pause = |token: &str| format!("form_token={token}&action=pause");
        for (cookie, token, status) in
            [("", token.as_str(), 303), (&cookie, "", 403), (&cookie, "wrong", 403)]
        {
            assert_eq!(web.post("/admin/session/P01", cookie, &pause(token)).await.status, status);
        }
        assert_eq!(web.sessions.state("P01"), SessionState::Open);
        assert!(!web.audit_log().contains("\"act\""));

        let mut page = web.open("P01", "a", false).await;
        page.read_output("ready").await;
        let message = format!("form_token={token}&action=message&text=Lunch+%3Cb%3E");
        assert_eq!(web.post("/admin/session/P01", &cookie, &message).await.status, 200);
        assert_eq!(page.read("notice").await["text"], "Message from the experimenter: Lunch <b>");
        assert_eq!(web.post("/admin/session/P01", &cookie, &pause(&token)).await.status, 200);
        assert_eq!(page.read("closed").await["reason"], "paused");
        assert_eq!(web.open("P01", "a", true).await.read("closed").await["reason"], "paused");
        let resume = format!("form_token={token}&action=resume");
        assert_eq!(web.post("/admin/session/P01", &cookie, &resume).await.status, 200);
        web.open("P01", "a", true).await.read("welcome").await;

        let end = |reason: &str| format!("form_token={token}&action=end&text={reason}");
        assert_eq!(web.post("/admin/session/P01", &cookie, &end("")).await.status, 409);
        assert_eq!(web.post("/admin/session/P01", &cookie, &end("ill")).await.status, 200);
        let closed = web.open("P01", "a", false).await.read("closed").await;
        assert!(
            closed["reason"] == "finished"
                && closed["text"].as_str().is_some_and(|text| text.ends_with(": ill"))
        );
        let log = web.audit_log();
        let actions = ["message", "pause", "resume", "end"].map(|action| format!(r#""action":"{action}""#));
        assert!(actions.iter().all(|action| log.matches(action).count() == 1), "{log}");

        let sign_out = format!("form_token={token}");
        assert_eq!(web.post("/admin/sign-out", &cookie, &sign_out).await.status, 303);
        assert!(!web.get("/admin", &cookie).await.body.contains("P02"));
    });
}
