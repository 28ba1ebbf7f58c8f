//! Reads input lines. Joins continued lines, removes byte order marks and carriage returns, and rejects lines
//! that are too long or not UTF-8.

use std::io::{self, BufRead, Read as _};

/// Maximum length of a line in bytes.
const MAX_LINE_BYTES: usize = 1 << 20;

/// The result of reading a logical line, which may consist of several joined lines.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum InputLine {
    /// A line without its line ending. Continued lines are joined by line breaks.
    Line(String),
    /// A line that cannot be read, with the reason.
    Unreadable(String),
    /// The input has ended.
    End,
}

/// A source of input lines that counts lines.
pub struct Input<R> {
    source: R,
    line_count: u32,
}

impl<R: BufRead> Input<R> {
    /// Creates an input that reads from a source.
    pub fn new(source: R) -> Input<R> {
        Input { source, line_count: 0 }
    }

    /// Returns the number of the next line, counted from 1.
    pub fn next_number(&self) -> u32 {
        self.line_count + 1
    }

    /// Reads a logical line, including its continuation lines.
    ///
    /// # Errors
    /// The source cannot be read.
    pub fn read_line(&mut self) -> io::Result<InputLine> {
        let mut whole: Option<String> = None;
        loop {
            let text = match self.read_physical_line()? {
                InputLine::Line(text) => text,
                InputLine::End => return Ok(whole.map_or(InputLine::End, InputLine::Line)),
                unreadable => return Ok(unreadable),
            };
            let joined = match whole.take() {
                Some(before) => before + "\n" + &text,
                None => text,
            };
            if joined.len() > MAX_LINE_BYTES {
                return Ok(InputLine::Unreadable("the line is longer than 1 MiB".to_owned()));
            }
            match joined.strip_suffix('\\') {
                Some(rest) => whole = Some(rest.to_owned()),
                None => return Ok(InputLine::Line(joined)),
            }
        }
    }

    /// Reads one line of the source, without continuation lines.
    fn read_physical_line(&mut self) -> io::Result<InputLine> {
        let mut bytes = Vec::new();
        let limit = MAX_LINE_BYTES as u64 + 2;
        if self.source.by_ref().take(limit).read_until(b'\n', &mut bytes)? == 0 {
            return Ok(InputLine::End);
        }
        self.line_count += 1;
        let complete = bytes.last() == Some(&b'\n');
        if !complete && bytes.len() as u64 == limit {
            self.skip_line()?;
            return Ok(InputLine::Unreadable("the line is longer than 1 MiB".to_owned()));
        }
        if complete {
            bytes.pop();
            if bytes.last() == Some(&b'\r') {
                bytes.pop();
            }
        }
        match String::from_utf8(bytes) {
            Ok(text) if self.line_count == 1 => {
                Ok(InputLine::Line(text.trim_start_matches('\u{feff}').to_owned()))
            }
            Ok(text) => Ok(InputLine::Line(text)),
            Err(_) => Ok(InputLine::Unreadable("the line is not UTF-8".to_owned())),
        }
    }

    fn skip_line(&mut self) -> io::Result<()> {
        loop {
            let (used, done) = {
                let buffer = self.source.fill_buf()?;
                match buffer.iter().position(|byte| *byte == b'\n') {
                    Some(at) => (at + 1, true),
                    None => (buffer.len(), buffer.is_empty()),
                }
            };
            self.source.consume(used);
            if done {
                return Ok(());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_all_lines(bytes: &[u8]) -> Vec<(u32, InputLine)> {
        let mut input = Input::new(bytes);
        let mut found = Vec::new();
        loop {
            let number = input.next_number();
            match input.read_line().expect("bytes do not fail") {
                InputLine::End => return found,
                read => found.push((number, read)),
            }
        }
    }

    fn line(number: u32, text: &str) -> (u32, InputLine) {
        (number, InputLine::Line(text.to_owned()))
    }

    #[test]
    fn lines_are_numbered_joined_and_cleaned() {
        let found = read_all_lines("\u{feff}one\r\ntwo \\\nthree\n\nlast".as_bytes());
        assert_eq!(found, [line(1, "one"), line(2, "two \nthree"), line(4, ""), line(5, "last")]);
        assert_eq!(read_all_lines(b"end\\"), [line(1, "end")]);
        assert_eq!(read_all_lines(b""), []);
    }

    #[test]
    fn read_line_continues_after_unreadable_lines() {
        let mut bytes = vec![b'x'; MAX_LINE_BYTES + 5];
        bytes.extend(b"\nok\n\xff\xfe\nok\n");
        let found = read_all_lines(&bytes);
        assert!(matches!(&found[0].1, InputLine::Unreadable(problem) if problem.contains("1 MiB")));
        assert_eq!(found[1], line(2, "ok"));
        assert!(matches!(&found[2].1, InputLine::Unreadable(problem) if problem.contains("UTF-8")));
        assert_eq!(found[3], line(4, "ok"));
    }
}
