//! Signals and requests that stop a server.

use std::io;
use std::sync::Arc;

use tokio::sync::Notify;

/// Waits for SIGINT, SIGTERM and SIGHUP, or ctrl-c on other systems, and for a request to stop.
pub struct Shutdown {
    request: Arc<Notify>,
    #[cfg(unix)]
    signals: [tokio::signal::unix::Signal; 3],
}

impl Shutdown {
    /// Starts listening. From now on these signals do not end the program at once.
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

    /// Starts listening. From now on ctrl-c does not end the program at once.
    #[cfg(not(unix))]
    pub fn listen() -> io::Result<Shutdown> {
        Ok(Shutdown { request: Arc::default() })
    }

    /// Returns the notification for a request to stop.
    pub fn stop_notifier(&self) -> Arc<Notify> {
        self.request.clone()
    }

    /// Completes when the server is asked to stop.
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

    /// Completes when the server is asked to stop.
    #[cfg(not(unix))]
    pub async fn wait(&mut self) {
        tokio::select! {
            _ = tokio::signal::ctrl_c() => {}
            () = self.request.notified() => {}
        }
    }
}
