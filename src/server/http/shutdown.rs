//! Waits for signals and requests that stop the server.

use std::io;
use std::sync::Arc;

use tokio::sync::Notify;

/// Waits for a request to stop, and for SIGINT, SIGTERM or SIGHUP (ctrl-c on other systems).
pub struct Shutdown {
    request: Arc<Notify>,
    #[cfg(unix)]
    signals: [tokio::signal::unix::Signal; 3],
}

impl Shutdown {
    /// Starts to listen for signals. After this call, these signals no longer end the program immediately.
    #[cfg(unix)]
    pub fn listen() -> io::Result<Shutdown> {
        use tokio::signal::unix::{SignalKind, signal};
        let one = |kind| signal(kind);
        Ok(Shutdown {
            request: Arc::default(),
            signals: [
                one(SignalKind::interrupt())?,
                one(SignalKind::terminate())?,
                one(SignalKind::hangup())?,
            ],
        })
    }

    /// Starts to listen for ctrl-c. After this call, ctrl-c no longer ends the program immediately.
    #[cfg(not(unix))]
    pub fn listen() -> io::Result<Shutdown> {
        Ok(Shutdown { request: Arc::default() })
    }

    /// Returns the notifier that requests use to stop the server.
    pub fn stop_notifier(&self) -> Arc<Notify> {
        self.request.clone()
    }

    /// Completes when a signal or a request stops the server.
    #[cfg(unix)]
    pub async fn wait(&mut self) {
        let [interrupt, terminate, hangup] = &mut self.signals;
        tokio::select! {
            _ = interrupt.recv() => {}
            _ = terminate.recv() => {}
            _ = hangup.recv() => {}
            () = self.request.notified() => {}
        }
    }

    /// Completes when a signal or a request stops the server.
    #[cfg(not(unix))]
    pub async fn wait(&mut self) {
        tokio::select! {
            _ = tokio::signal::ctrl_c() => {}
            () = self.request.notified() => {}
        }
    }
}
