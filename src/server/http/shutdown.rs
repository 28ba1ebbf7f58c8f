//! Signals that ask a server to stop.

use std::io;

/// Waits for SIGINT, SIGTERM and SIGHUP; where there are none, for ctrl-c.
pub struct Shutdown {
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
        Ok(Shutdown {})
    }

    /// Returns when the server is asked to stop.
    #[cfg(unix)]
    pub async fn asked(&mut self) {
        let [interrupt, terminate, hangup] = &mut self.signals;
        tokio::select! {
            _ = interrupt.recv() => {}
            _ = terminate.recv() => {}
            _ = hangup.recv() => {}
        }
    }

    /// Returns when the server is asked to stop.
    #[cfg(not(unix))]
    pub async fn asked(&mut self) {
        let _ = tokio::signal::ctrl_c().await;
    }
}
