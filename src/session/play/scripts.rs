//! What is kept with a run besides its company: calculations and scripts, and running them.
//!
//! Both are read-only SQL under the guard and the limits of a query. What is kept follows from the calls of the
//! trajectory; what calculations said before a week stands in its `advance` line, so a resumed run shows the same
//! dashboard.

use std::time::Duration;

use super::surroundings::Calculated;
use crate::database::{self, text};
use crate::session::state::Session;
use crate::tools::{Kept, Notebook, NotebookChange, Refusal, Script, ScriptOutput};

/// Characters of output that a script may give.
const MOST_OUTPUT: usize = 5000;
/// Characters of warnings and hints that a script may give.
const MOST_REMARKS: usize = 2000;

/// What statements said.
#[derive(Debug, Default)]
struct Output {
    results: String,
    remarks: String,
}

impl Output {
    fn add(&mut self, rows: &database::Rows) {
        if self.results.len() <= 4 * MOST_OUTPUT {
            self.results += &text::columns(rows);
        }
        for remark in [&rows.warning, &rows.hint].into_iter().flatten() {
            if self.remarks.len() <= 4 * MOST_REMARKS {
                self.remarks += &format!("{remark}\n");
            }
        }
    }
}

/// The first characters of a text.
fn first(text: &str, most: usize) -> String {
    text.chars().take(most).collect()
}

impl Session {
    /// Calculations and scripts of the run.
    pub fn notebook(&self) -> &Notebook {
        &self.surroundings.notebook
    }

    /// What the calculations said before the last week.
    pub fn calculated(&self) -> &[Calculated] {
        &self.history.calculated
    }

    /// The answer of a tool that runs statements.
    ///
    /// # Errors
    /// `script_failed`, `script_timeout`, naming the statement.
    pub(in crate::session) fn run_statements(&mut self, script: &Script) -> Result<ScriptOutput, Refusal> {
        let output = self.output_of(&script.code, Duration::from_secs_f64(script.seconds))?;
        Ok(ScriptOutput {
            returncode: 0,
            stdout: first(&output.results, MOST_OUTPUT),
            stderr: first(&output.remarks, MOST_REMARKS),
        })
    }

    fn output_of(&mut self, code: &str, time: Duration) -> Result<Output, Refusal> {
        let limits = self.query_limits();
        let connection =
            self.connection().map_err(|refusal| Refusal::new("script_failed", refusal.message))?;
        let mut output = Output::default();
        match connection.run_script(code, limits, time, |rows| output.add(&rows)) {
            Ok(()) => Ok(output),
            Err(stopped) => {
                let refusal = Refusal::from(stopped.error);
                let code = if refusal.code == "sql_timeout" { "script_timeout" } else { "script_failed" };
                let (number, why) = (stopped.statement, refusal.message);
                let message = format!("statement {number}: {why}; the ones before it changed nothing either");
                Err(Refusal::at("code", code, message))
            }
        }
    }

    /// Runs all calculations on the company as it is. One that fails says why and does not keep the week.
    pub(in crate::session) fn run_calculations(&mut self) -> Vec<Calculated> {
        let entries = self.surroundings.notebook.statements(Kept::Calculation).entries().to_vec();
        let time = self.query_limits().time;
        let shown = self.simulation.params.limits.dashboard_calculation_max_chars as usize;
        let run = |(name, code): (String, String)| {
            let output = match self.output_of(&code, time) {
                Ok(output) => output.results,
                Err(refusal) => format!("failed: {}", refusal.message),
            };
            Calculated { name, output: first(&output, shown) }
        };
        entries.into_iter().map(run).collect()
    }

    /// Keeps or forgets what an accepted call asks for.
    pub(in crate::session) fn keep(&mut self, change: &NotebookChange) {
        self.surroundings.notebook.apply(change);
    }
}
