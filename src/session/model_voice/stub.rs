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

/// The behavior of a stub.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Manner {
    /// Correct answers.
    Well,
    /// Correct answers after three seconds.
    Late,
    /// Too few texts and scores.
    Short,
    /// An answer that is not an array.
    Chatty,
    /// Status 500.
    Broken,
}

/// A stub of a language model; stops on drop.
pub struct Stub {
    port: u16,
    asked: Arc<Mutex<Vec<Value>>>,
    stopped: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Stub {
    /// Starts a stub on its own port.
    pub fn start(manner: Manner) -> Stub {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("an address").port();
        let (asked, stopped) = (Arc::new(Mutex::new(Vec::new())), Arc::new(AtomicBool::new(false)));
        let (heard, stop) = (asked.clone(), stopped.clone());
        let thread = std::thread::spawn(move || {
            for stream in listener.incoming() {
                if stop.load(Ordering::SeqCst) {
                    return;
                }
                // The client may have closed the connection.
                let _ = stream.and_then(|stream| answer(stream, manner, &heard));
            }
        });
        Stub { port, asked, stopped, thread: Some(thread) }
    }

    /// Returns a configuration that names the stub.
    pub fn named(&self, judge: bool, words: bool, seconds: u32) -> Configuration {
        let settings = ModelSettings {
            endpoint: format!("http://127.0.0.1:{}/v1", self.port),
            model: "stub".to_owned(),
            key_variable: None,
            seconds_a_week: seconds,
            judge,
            words,
        };
        Configuration { voice: Some(settings), ..Configuration::shipped() }
    }

    /// Returns the requests so far.
    pub fn asked(&self) -> Vec<Value> {
        self.asked.lock().expect("not poisoned").clone()
    }
}

impl Drop for Stub {
    fn drop(&mut self) {
        self.stopped.store(true, Ordering::SeqCst);
        let _ = TcpStream::connect(("127.0.0.1", self.port));
        self.thread.take().map(JoinHandle::join);
    }
}

fn answer(stream: TcpStream, manner: Manner, heard: &Mutex<Vec<Value>>) -> std::io::Result<()> {
    let mut reader = BufReader::new(stream);
    let mut length = 0;
    loop {
        let mut line = String::new();
        if reader.read_line(&mut line)? == 0 || line.trim().is_empty() {
            break;
        }
        let header = line.to_lowercase();
        length = header.strip_prefix("content-length:").map_or(length, |own| own.trim().parse().unwrap_or(0));
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body)?;
    let asked: Value = serde_json::from_slice(&body)?;
    let material = asked["messages"][1]["content"].as_str().unwrap_or_default();
    let material: Value = serde_json::from_str(material)?;
    heard.lock().expect("not poisoned").push(asked);
    let mut said = well(&material);
    match manner {
        Manner::Late => std::thread::sleep(Duration::from_secs(3)),
        Manner::Short => drop(said.pop()),
        Manner::Well | Manner::Chatty | Manner::Broken => {}
    }
    let content = match manner {
        Manner::Chatty => "Certainly! Here are the posts.".to_owned(),
        _ => Value::from(said).to_string(),
    };
    let status = if manner == Manner::Broken { "500 Internal Server Error" } else { "200 OK" };
    let body = json!({ "choices": [{ "message": { "role": "assistant", "content": content } }] }).to_string();
    let head = format!(
        "HTTP/1.1 {status}\r\ncontent-type: application/json\r\ncontent-length: {}\r\nconnection: close\r\n\r\n",
        body.len()
    );
    reader.get_mut().write_all(format!("{head}{body}").as_bytes())
}

/// Scores of 0.8 for groups, a prefix for the texts of posts.
fn well(material: &Value) -> Vec<Value> {
    let score =
        |group: &Value| json!({ "group": group["group"], "score": 0.8, "reason": "It speaks to me." });
    let reworded = |post: &Value| Value::from(format!("Well: {}", post["text"].as_str().unwrap_or_default()));
    match material["groups"].as_array() {
        Some(groups) => groups.iter().map(score).collect(),
        None => material.as_array().into_iter().flatten().map(reworded).collect(),
    }
}
