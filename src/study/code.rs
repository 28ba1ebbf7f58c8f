//! Checks of the experimenter's code, with a delay that grows with every wrong code.
//!
//! The list of visits records wrong codes, so a restart of the program does not shorten the delay.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::definition::Study;
use super::visit_log::{VISITS_FILE, VisitEvent, read_visits, record_rejected_code};
use novamind_record::clock::{now, parse_seconds};

/// Minimum length of an experimenter's code.
pub const MIN_CODE_CHARACTERS: usize = 8;

/// Wrong codes without a delay.
const FREE_ATTEMPTS: u32 = 5;
/// Longest delay, in seconds.
const MAX_DELAY_SECONDS: f64 = 600.0;
/// Time after which a wrong code no longer counts, in seconds.
const REMEMBERED_SECONDS: f64 = 3600.0;

/// The result of checking a code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CodeOutcome {
    /// The code is the experimenter's code.
    Right,
    /// The code is wrong. The attempt was recorded.
    Wrong,
    /// The code was not checked, because of earlier wrong codes. The next code is checked after this many seconds.
    Wait(u64),
    /// The study has no experimenter's code.
    NoCode,
}

impl CodeOutcome {
    /// Returns the message for a code that was not accepted. Returns an empty text for the right code.
    pub fn describe(self) -> String {
        match self {
            CodeOutcome::Right => String::new(),
            CodeOutcome::Wrong => "this is not the experimenter's code".to_owned(),
            CodeOutcome::Wait(seconds) => {
                format!("too many wrong codes: the code was not checked. Try again in {seconds} s")
            }
            CodeOutcome::NoCode => "this study has no experimenter's code".to_owned(),
        }
    }
}

/// A function that checks a code.
pub type CodeCheck = Arc<dyn Fn(&str) -> CodeOutcome + Send + Sync>;

impl Study {
    /// Checks the experimenter's code. `runs` is the machine's folder of runs, in which wrong codes are recorded.
    pub fn check_code(&self, runs: &Path, code: &str) -> CodeOutcome {
        let Some(digest) = &self.protocol.access.code else { return CodeOutcome::NoCode };
        match delay_seconds(&self.rejected_code_times(runs), parse_seconds(&now())) {
            0 if digest.matches(code.trim()) => CodeOutcome::Right,
            0 => {
                record_rejected_code(self, runs);
                CodeOutcome::Wrong
            }
            seconds => CodeOutcome::Wait(seconds),
        }
    }

    /// Returns a function that checks the experimenter's code, or `None` if the protocol has no code.
    pub fn code_check(&self, runs: &Path) -> Option<CodeCheck> {
        self.protocol.access.code.as_ref()?;
        let (study, runs): (Study, PathBuf) = (self.clone(), runs.to_owned());
        Some(Arc::new(move |code: &str| study.check_code(&runs, code)))
    }

    /// Returns the times of wrong codes, in seconds since the Unix epoch.
    fn rejected_code_times(&self, runs: &Path) -> Vec<f64> {
        let lines = read_visits(&runs.join(VISITS_FILE)).into_iter();
        let rejected =
            lines.filter(|line| line.study == self.digest && line.event == VisitEvent::CodeRefused);
        rejected.map(|line| parse_seconds(&line.at)).collect()
    }
}

/// Returns the seconds after which the next code is checked. The delay doubles with each wrong code of the last hour.
fn delay_seconds(rejected: &[f64], now: f64) -> u64 {
    // A time in the future was written before the clock was set back.
    let recent = || rejected.iter().filter(|at| now - **at < REMEMBERED_SECONDS);
    let count = recent().count() as u32;
    let Some(last) = recent().copied().reduce(f64::max).filter(|_| count >= FREE_ATTEMPTS) else { return 0 };
    let delay = f64::from(1u32 << (count - FREE_ATTEMPTS).min(20)).min(MAX_DELAY_SECONDS);
    (last.min(now) + delay - now).max(0.0).ceil() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delay_doubles_with_each_wrong_code_and_ends_after_an_hour() {
        assert_eq!(delay_seconds(&[], 100.0), 0);
        assert_eq!(delay_seconds(&[99.0; 4], 100.0), 0);
        assert_eq!(delay_seconds(&[97.0, 97.0, 97.0, 98.0, 100.0], 100.0), 1);
        assert_eq!(delay_seconds(&[96.0, 97.0, 97.0, 97.0, 98.0, 100.0], 100.0), 2);
        assert_eq!(delay_seconds(&[100.0; 10], 100.0), 32);
        assert_eq!(delay_seconds(&[100.0; 10], 132.0), 0, "the delay has ended");
        assert_eq!(delay_seconds(&[100.0; 40], 100.0), 600);
        assert_eq!(delay_seconds(&[100.0; 40], 3700.0), 0);
        // Setting the clock back does not remove the delay.
        assert_eq!(delay_seconds(&[5000.0; 10], 100.0), 32);
    }
}
