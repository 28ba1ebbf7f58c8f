//! A recorded run on the screen: where it is, whether it plays and how fast, what was decided there.

mod activities;
mod pane;
mod strip;
pub mod told;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

pub use pane::EntriesShown;

use novamind_session::PlaybackPosition;

/// Pauses between two weeks, in milliseconds, and how fast that is.
const SPEEDS: [(u64, &str); 6] = [
    (4_000, "¼ week a second"),
    (2_000, "½ week a second"),
    (1_000, "1 week a second"),
    (500, "2 weeks a second"),
    (200, "5 weeks a second"),
    (0, "full speed"),
];

/// A replay on the screen.
pub struct Viewer {
    /// Where it is.
    pub place: PlaybackPosition,
    /// It goes on by itself.
    pub playing: bool,
    /// The decisions stand beside the screen, where there is room.
    pub shows_decisions: bool,
    /// It was sent somewhere.
    pub goes: bool,
    /// Stops it on the way.
    pub stop: Arc<AtomicBool>,
    /// The next week was asked for.
    pub ordered: bool,
    speed: usize,
    /// Rows by which the person has scrolled the decisions away from where the replay is.
    scroll: i32,
}

impl Viewer {
    /// Columns from which the decisions have room beside the screen.
    pub const BESIDE: u16 = 120;

    /// A replay that stands still.
    pub fn new(place: PlaybackPosition) -> Viewer {
        Viewer {
            place,
            playing: false,
            shows_decisions: true,
            goes: false,
            stop: Arc::default(),
            ordered: false,
            speed: 2,
            scroll: 0,
        }
    }

    /// It has got somewhere, as asked or by itself.
    pub fn arrive(&mut self, place: PlaybackPosition, asked: bool) {
        if place.line != self.place.line {
            self.scroll = 0;
        }
        self.place = place;
        self.ordered = false;
        if asked {
            self.goes = false;
        }
    }

    /// One step faster or slower.
    pub fn change_speed(&mut self, faster: bool) {
        let speed = if faster { self.speed + 1 } else { self.speed.saturating_sub(1) };
        self.speed = speed.min(SPEEDS.len() - 1);
    }

    /// How fast it plays.
    pub fn speed_in_words(&self) -> &'static str {
        SPEEDS[self.speed].1
    }

    /// Between two weeks.
    pub fn pause(&self) -> Duration {
        Duration::from_millis(SPEEDS[self.speed].0)
    }

    /// Scrolls the decisions.
    pub fn scroll_by(&mut self, rows: i32) {
        self.scroll = (self.scroll + rows).clamp(-10_000, 10_000);
    }
}
