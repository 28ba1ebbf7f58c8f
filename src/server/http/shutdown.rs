//! Signals that ask a server to stop.

use std::io;
use std::sync::Arc;

use tokio::sync::Notify;

/// Waits for SIGINT, SIGTERM and SIGHUP, where there are none for ctrl-c, and for a request to stop.
pub struct Shutdown {
    request: Arc<Notify>,
    #[cfg(unix)]
    signals: [tokio::signal::unix::Signal; 3],
}

impl Shutdown {
    /// From now on such a signal no longer ends the program at once.
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

    /// From now on ctrl-c no longer ends the program at once.
    #[cfg(not(unix))]
    pub fn listen() -> io::Result<Shutdown> {
        Ok(Shutdown { request: Arc::default() })
    }

    /// What a request to stop notifies.
    pub fn asking(&self) -> Arc<Notify> {
        self.request.clone()
    }

    /// Returns when the server is asked to stop.
    #[cfg(unix)]
    pub async fn asked(&mut self) {
        let [interrupt, terminate, hangup] = &mut self.signals;
        tokio::select! {
            _ = interrupt.recv() => {}
            _ = terminate.recv() => {}
            _ = hangup.recv() => {}
            () = self.request.notified() => {}
        }
    }

    /// Returns when the server is asked to stop.
    #[cfg(not(unix))]
    pub async fn asked(&mut self) {
        tokio::select! {
            _ = tokio::signal::ctrl_c() => {}
            () = self.request.notified() => {}
        }
    }
}
