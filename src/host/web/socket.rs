//! The connection of a participant's page: output of the session as binary messages, everything else as JSON.
//!
//! `assets/terminal.js` is the other end.

use std::time::{Duration, Instant};

use axum::extract::ws::{CloseFrame, Message, WebSocket, close_code};
use serde::{Deserialize, Serialize};
use tokio::time::timeout;

use super::WebHost;
use crate::attachment::{AttachError, Attachment, ClientKind, CloseReason, Output, WindowSize};

/// Maximum size of a message from a page. A page divides longer texts.
pub(super) const MAX_MESSAGE_BYTES: usize = 256 << 10;
/// Number of bytes that may be on their way to a page. Until the page has displayed them, the session collects output, and a
/// page that is much too slow gets the current screen instead.
const MAX_BYTES_IN_FLIGHT: u64 = 64 << 10;
/// Interval between messages that show the page and the host that the connection exists.
const ALIVE_INTERVAL: Duration = Duration::from_secs(2);
/// Time without a message from the page after which the connection is considered lost.
const SILENCE_LIMIT: Duration = Duration::from_secs(10);

/// A message from the page.
#[derive(Debug, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum PageMessage {
    /// The first message.
    Hello(Hello),
    /// Typed or pasted text, or an event of the mouse.
    Input { number: u64, text: String },
    /// The size of the window has changed.
    Size { columns: u16, rows: u16 },
    /// Number of bytes of output that the page has displayed since it connected.
    Displayed { bytes: u64 },
    /// The answer to [`HostMessage::Alive`].
    Alive,
}

#[derive(Debug, Deserialize)]
struct Hello {
    /// Label of the participant for whom the page was loaded.
    label: String,
    /// Identifier of the page, which it draws when it is loaded.
    client: String,
    /// Whether the page reconnects automatically, not because the participant opened it.
    resume: bool,
    columns: u16,
    rows: u16,
}

/// A message to the page.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum HostMessage {
    /// The page is attached. `acknowledged` is the number of the last input that the host received from this page.
    /// `continues` is false if the session was started again since then.
    Welcome { acknowledged: u64, continues: bool },
    /// The host has received all inputs up to this number.
    Acknowledged { number: u64 },
    /// A text to be shown above the terminal.
    Notice { text: String },
    /// The page is detached and must not reconnect automatically, except after `paused` and `shutdown`.
    Closed { reason: &'static str, text: String },
    /// The connection exists.
    Alive,
}

/// Serves the connection of a page until one side closes it.
pub(super) async fn serve_page(mut socket: WebSocket, host: WebHost, label: Option<String>, address: String) {
    // A page without a valid cookie is refused before it can keep the connection open.
    let Some(label) = label else { return close(&mut socket, signed_out()).await };
    let Ok(Some(Ok(Message::Text(text)))) = timeout(SILENCE_LIMIT, socket.recv()).await else { return };
    let Ok(PageMessage::Hello(hello)) = serde_json::from_str(text.as_str()) else { return };
    match attach(&host, &hello, label, address).await {
        Ok(attachment) => {
            Connection::new(socket, host, hello, attachment).run().await;
        }
        Err(closed) => close(&mut socket, closed).await,
    }
}

async fn attach(
    host: &WebHost,
    hello: &Hello,
    label: String,
    address: String,
) -> Result<Attachment, HostMessage> {
    if label != hello.label {
        return Err(signed_out());
    }
    let has_client =
        host.sessions().statuses().iter().any(|status| status.label == label && status.client.is_some());
    if hello.resume && has_client && !host.inputs().is_latest_client(&label, &hello.client) {
        return Err(closed_message(&CloseReason::TakenOver));
    }
    let size = WindowSize::clamped(hello.columns, hello.rows);
    host.sessions().attach(&label, ClientKind::Browser(address), size).await.map_err(|error| {
        let reason = match error {
            AttachError::Paused => "paused",
            AttachError::Shutdown => "shutdown",
            AttachError::CannotStart(_) => "failed",
            AttachError::UnknownLabel | AttachError::Ended(_) => "finished",
        };
        HostMessage::Closed { reason, text: error.to_string() }
    })
}

fn signed_out() -> HostMessage {
    let text = "This window is no longer signed in, because another link was opened in this browser or the link was \
                replaced. Everything is saved. Open your link again, or ask the experimenter.";
    HostMessage::Closed { reason: "signed_out", text: text.to_owned() }
}

fn closed_message(reason: &CloseReason) -> HostMessage {
    let name = match reason {
        CloseReason::TakenOver => "taken_over",
        CloseReason::Ended => "ended",
        CloseReason::Paused => "paused",
        CloseReason::Shutdown => "shutdown",
        CloseReason::Failed => "failed",
    };
    HostMessage::Closed { reason: name, text: reason.to_string() }
}

async fn close(socket: &mut WebSocket, message: HostMessage) {
    let text = serde_json::to_string(&message).unwrap_or_default();
    let _ = timeout(SILENCE_LIMIT, async {
        socket.send(Message::Text(text.into())).await?;
        socket.send(Message::Close(Some(CloseFrame { code: close_code::NORMAL, reason: "".into() }))).await
    })
    .await;
}

/// An attached page.
struct Connection {
    socket: WebSocket,
    host: WebHost,
    hello: Hello,
    attachment: Attachment,
    sent_bytes: u64,
    displayed_bytes: u64,
    last_message: Instant,
}

/// The connection was lost, or the page does not follow the protocol.
struct Disconnected;

impl Connection {
    fn new(socket: WebSocket, host: WebHost, hello: Hello, attachment: Attachment) -> Connection {
        Connection {
            socket,
            host,
            hello,
            attachment,
            sent_bytes: 0,
            displayed_bytes: 0,
            last_message: Instant::now(),
        }
    }

    async fn run(mut self) {
        let (acknowledged, continues) = self.host.inputs().begin(
            &self.hello.label,
            &self.hello.client,
            self.attachment.process_number(),
            self.hello.resume,
        );
        let mut alive = tokio::time::interval(ALIVE_INTERVAL);
        let mut result = self.send(&HostMessage::Welcome { acknowledged, continues }).await;
        while result.is_ok() {
            let is_ready = self.sent_bytes - self.displayed_bytes < MAX_BYTES_IN_FLIGHT;
            result = tokio::select! {
                message = self.socket.recv() => match message {
                    Some(Ok(message)) => self.receive(message).await,
                    Some(Err(_)) | None => Err(Disconnected),
                },
                output = self.attachment.next_output(), if is_ready => match output {
                    Output::Closed(reason) => return close(&mut self.socket, closed_message(&reason)).await,
                    Output::Notice(notice) => self.send(&HostMessage::Notice { text: notice.to_string() }).await,
                    Output::Bytes(bytes) => {
                        self.sent_bytes += bytes.len() as u64;
                        self.send_message(Message::Binary(bytes.into())).await
                    }
                },
                _ = alive.tick() => match self.last_message.elapsed() > SILENCE_LIMIT {
                    true => Err(Disconnected),
                    false => self.send(&HostMessage::Alive).await,
                },
            };
        }
    }

    async fn receive(&mut self, message: Message) -> Result<(), Disconnected> {
        self.last_message = Instant::now();
        let text = match message {
            Message::Text(text) => text,
            Message::Ping(_) | Message::Pong(_) => return Ok(()),
            Message::Binary(_) | Message::Close(_) => return Err(Disconnected),
        };
        match serde_json::from_str(text.as_str()).map_err(|_| Disconnected)? {
            PageMessage::Input { number, text } => {
                let Hello { label, client, .. } = &self.hello;
                if self.host.inputs().is_new(label, client, self.attachment.process_number(), number) {
                    self.attachment.send_input(text.as_bytes());
                }
                self.send(&HostMessage::Acknowledged { number }).await
            }
            PageMessage::Size { columns, rows } => {
                self.attachment.resize(WindowSize::clamped(columns, rows));
                Ok(())
            }
            PageMessage::Displayed { bytes } => {
                self.displayed_bytes = bytes.clamp(self.displayed_bytes, self.sent_bytes);
                Ok(())
            }
            PageMessage::Alive => Ok(()),
            PageMessage::Hello(_) => Err(Disconnected),
        }
    }

    async fn send(&mut self, message: &HostMessage) -> Result<(), Disconnected> {
        let text = serde_json::to_string(message).map_err(|_| Disconnected)?;
        self.send_message(Message::Text(text.into())).await
    }

    async fn send_message(&mut self, message: Message) -> Result<(), Disconnected> {
        match timeout(SILENCE_LIMIT, self.socket.send(message)).await {
            Ok(Ok(())) => Ok(()),
            Ok(Err(_)) | Err(_) => Err(Disconnected),
        }
    }
}
