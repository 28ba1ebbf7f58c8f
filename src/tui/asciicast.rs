//! Writes frames as an asciicast recording, version 2, for terminal players (<https://docs.asciinema.org>).

use std::time::Duration;

use ratatui::backend::{Backend, CrosstermBackend};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use serde_json::json;

/// Escape sequence that hides the cursor and clears the window.
const INITIAL_SEQUENCE: &str = "\u{1b}[?25l\u{1b}[0m\u{1b}[2J";

/// A recording of frames. Each frame is stored as its differences from the previous frame.
pub struct Asciicast {
    lines: String,
    last_frame: Buffer,
    time: Duration,
}

impl Asciicast {
    /// Starts a recording of a window of the given size, in columns and rows.
    pub fn new((columns, rows): (u16, u16), title: &str) -> Asciicast {
        // The recording needs colors even if the terminal of this process has no colors.
        crossterm::style::force_color_output(true);
        let header = json!({
            "version": 2, "width": columns, "height": rows, "title": title, "env": { "TERM": "xterm-256color" },
        });
        let mut recording = Asciicast {
            lines: format!("{header}\n"),
            last_frame: Buffer::empty(Rect::new(0, 0, columns, rows)),
            time: Duration::ZERO,
        };
        recording.write(INITIAL_SEQUENCE);
        recording
    }

    /// Adds a frame and the time for which it is shown.
    ///
    /// # Errors
    /// The frame cannot be written as terminal output.
    pub fn add_frame(&mut self, frame: &Buffer, display_time: Duration) -> std::io::Result<()> {
        let mut bytes = Vec::new();
        CrosstermBackend::new(&mut bytes).draw(self.last_frame.diff(frame).into_iter())?;
        self.write(&String::from_utf8_lossy(&bytes));
        self.last_frame = frame.clone();
        self.time += display_time;
        Ok(())
    }

    /// Returns the recording as text. The last frame is shown for its full duration.
    pub fn finish(mut self) -> String {
        self.write("");
        self.lines
    }

    fn write(&mut self, output: &str) {
        self.lines += &format!("{}\n", json!([self.time.as_secs_f64(), "o", output]));
    }
}

#[cfg(test)]
mod tests {
    use ratatui::style::{Color, Style};
    use std::num::NonZero;

    use serde_json::Value;

    use super::*;
    use crate::frame_export::frame_text;

    #[test]
    fn frames_are_written_with_their_times() {
        let size = (20, 3);
        let area = Rect::new(0, 0, size.0, size.1);
        let mut frames = Vec::new();
        for words in ["first ─ frame", "second", "Ω ▌ third"] {
            let mut frame = Buffer::empty(area);
            frame.set_string(1, 1, words, Style::new().fg(Color::Red));
            frames.push(frame);
        }
        let mut recording = Asciicast::new(size, "a title");
        for frame in &frames {
            recording.add_frame(frame, Duration::from_millis(1500)).expect("it is written");
        }
        let recording = recording.finish();
        let lines: Vec<Value> =
            recording.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        assert_eq!(
            (&lines[0]["version"], &lines[0]["width"], &lines[0]["height"]),
            (&2.into(), &20.into(), &3.into())
        );
        let times: Vec<f64> = lines[1..].iter().filter_map(|line| line[0].as_f64()).collect();
        assert_eq!(times, [0.0, 0.0, 1.5, 3.0, 4.5]);
        let side = |length| NonZero::new(length).expect("a side");
        let mut screen = vt100::Parser::new(side(size.1), side(size.0), 0);
        let mut seen = Vec::new();
        for line in &lines[1..] {
            screen.process(line[2].as_str().expect("output").as_bytes());
            seen.push(screen.screen().contents());
        }
        let trimmed =
            |text: &str| text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n").trim_end().to_owned();
        for (frame, seen) in frames.iter().zip(&seen[1..]) {
            assert_eq!(trimmed(seen), trimmed(&frame_text(frame)));
        }
        assert!(recording.contains("[38;5;1;"), "{recording}");
    }
}
