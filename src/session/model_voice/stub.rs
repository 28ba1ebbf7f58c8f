//! A stub of a language model for tests: a thread that answers over HTTP.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use serde_json::{Value, json};

use novamind_record::folder::configuration::Configuration;
use novamind_voice::model::settings::ModelSettings;

/// The behavior of a stub model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StubBehavior {
    /// Return correct responses.
    Correct,
    /// Return correct responses after three seconds.
    Late,
    /// Return too few texts and scores.
    TooFew,
    /// Return a response that is not an array.
    NotJson,
    /// Return HTTP status 500.
    ServerError,
}

/// A stub of a language model; stops on drop.
pub struct StubModel {
    port: u16,
    requests: Arc<Mutex<Vec<Value>>>,
    is_stopped: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl StubModel {
    /// Starts a stub on a free port.
    pub fn start(behavior: StubBehavior) -> StubModel {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("an address").port();
        let (asked, stopped) = (Arc::new(Mutex::new(Vec::new())), Arc::new(AtomicBool::new(false)));
        let (values, stop) = (asked.clone(), stopped.clone());
        let thread = std::thread::spawn(move || {
            for stream in listener.incoming() {
                if stop.load(Ordering::SeqCst) {
                    return;
                }
                // The client may have closed the connection.
                let _ = stream.and_then(|stream| serve_request(stream, behavior, &values));
            }
        });
        StubModel { port, requests: asked, is_stopped: stopped, thread: Some(thread) }
    }

    /// Returns a configuration whose language model is the stub.
    pub fn configuration(&self, judge: bool, words: bool, seconds: u32) -> Configuration {
        let settings = ModelSettings {
            endpoint: format!("http://127.0.0.1:{}/v1", self.port),
            model: "stub".to_owned(),
            key_variable: None,
            seconds_a_week: seconds,
            judge,
            words,
        };
        Configuration { voice: Some(settings), ..Configuration::bundled() }
    }

    /// Returns the requests that the stub has received.
    pub fn requests(&self) -> Vec<Value> {
        self.requests.lock().expect("not poisoned").clone()
    }
}

impl Drop for StubModel {
    fn drop(&mut self) {
        self.is_stopped.store(true, Ordering::SeqCst);
        let _ = TcpStream::connect(("127.0.0.1", self.port));
        self.thread.take().map(JoinHandle::join);
    }
}

fn serve_request(
    stream: TcpStream,
    behavior: StubBehavior,
    values: &Mutex<Vec<Value>>,
) -> std::io::Result<()> {
    let mut reader = BufReader::new(stream);
    let mut length = 0;
    loop {
        let mut line = String::new();
        if reader.read_line(&mut line)? == 0 || line.trim().is_empty() {
            break;
        }
        let header = line.to_lowercase();
        length =
            header.strip_prefix("content-length:").map_or(length, |text| text.trim().parse().unwrap_or(0));
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body)?;
    let asked: Value = serde_json::from_slice(&body)?;
    let material = asked["messages"][1]["content"].as_str().unwrap_or_default();
    let material: Value = serde_json::from_str(material)?;
    values.lock().expect("not poisoned").push(asked);
    let mut texts = correct_answer(&material);
    match behavior {
        StubBehavior::Late => std::thread::sleep(Duration::from_secs(3)),
        StubBehavior::TooFew => drop(texts.pop()),
        StubBehavior::Correct | StubBehavior::NotJson | StubBehavior::ServerError => {}
    }
    let content = match behavior {
        StubBehavior::NotJson => "Certainly! Here are the posts.".to_owned(),
        _ => Value::from(texts).to_string(),
    };
    let status = if behavior == StubBehavior::ServerError { "500 Internal Server Error" } else { "200 OK" };
    let body = json!({ "choices": [{ "message": { "role": "assistant", "content": content } }] }).to_string();
    let head = format!(
        "HTTP/1.1 {status}\r\ncontent-type: application/json\r\ncontent-length: {}\r\nconnection: close\r\n\r\n",
        body.len()
    );
    reader.get_mut().write_all(format!("{head}{body}").as_bytes())
}

/// Returns scores of 0.8 for groups, or post texts with a prefix.
fn correct_answer(material: &Value) -> Vec<Value> {
    let score =
        |group: &Value| json!({ "group": group["group"], "score": 0.8, "reason": "It speaks to me." });
    let reworded = |post: &Value| Value::from(format!("Well: {}", post["text"].as_str().unwrap_or_default()));
    match material["groups"].as_array() {
        Some(groups) => groups.iter().map(score).collect(),
        None => material.as_array().into_iter().flatten().map(reworded).collect(),
    }
}
