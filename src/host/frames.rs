//! Messages between `novamind host attach` and the host on the Unix socket: a kind, a length and a content.

use std::io;

use serde::{Deserialize, Serialize};
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};

/// Maximum length of a content, bytes.
const MAX_CONTENT_BYTES: usize = 1 << 20;

/// A message from the client.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum ClientMessage {
    /// The first message: the session that the user wants, and the size of the window.
    Hello { label: Option<String>, columns: u16, rows: u16 },
    /// The answer to [`HostMessage::AskForCode`].
    Code { label: String, code: String },
    /// Keys.
    Input(#[serde(with = "text_bytes")] Vec<u8>),
    /// The size of the window changed.
    Resize { columns: u16, rows: u16 },
    /// The client needs the whole screen.
    Redraw,
}

/// A message from the host.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum HostMessage {
    /// The account is shared: the user has to enter label and code.
    AskForCode,
    /// The client is attached.
    Attached { label: String },
    /// Bytes for the terminal.
    Output(#[serde(with = "text_bytes")] Vec<u8>),
    /// A message for the user.
    Notice(String),
    /// The last message: the session was closed.
    Closed(String),
    /// The last message: the client is not allowed to attach, or cannot attach now.
    Refused(String),
}

/// Bytes as a JSON text whose characters are the bytes.
mod text_bytes {
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(bytes: &[u8], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&bytes.iter().map(|byte| char::from(*byte)).collect::<String>())
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<u8>, D::Error> {
        let text = String::deserialize(deserializer)?;
        let byte = |character| u8::try_from(character).map_err(serde::de::Error::custom);
        text.chars().map(byte).collect()
    }
}

/// Sends a message.
///
/// # Errors
/// The connection is closed.
pub(crate) async fn send(to: &mut (impl AsyncWrite + Unpin), message: &impl Serialize) -> io::Result<()> {
    let content = serde_json::to_vec(message)?;
    let length = u32::try_from(content.len()).map_err(io::Error::other)?;
    to.write_all(&[&length.to_be_bytes(), content.as_slice()].concat()).await?;
    to.flush().await
}

/// Receives a message.
///
/// # Errors
/// The connection is closed, or the message is too long or malformed.
pub(crate) async fn receive<T: for<'de> Deserialize<'de>>(
    from: &mut (impl AsyncRead + Unpin),
) -> io::Result<T> {
    let length = from.read_u32().await? as usize;
    if length > MAX_CONTENT_BYTES {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "the message is too long"));
    }
    let mut content = vec![0; length];
    from.read_exact(&mut content).await?;
    Ok(serde_json::from_slice(&content)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_keep_all_bytes() {
        let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a runtime");
        let sent = HostMessage::Output((0..=255).collect());
        let mut buffer = Vec::new();
        runtime.block_on(send(&mut buffer, &sent)).expect("sent");
        let received: HostMessage = runtime.block_on(receive(&mut buffer.as_slice())).expect("received");
        assert_eq!(received, sent);
        let too_long = [0xff; 8];
        assert!(runtime.block_on(receive::<HostMessage>(&mut too_long.as_slice())).is_err());
    }
}
