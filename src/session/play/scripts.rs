//! What is kept with a run besides its company: calculations and scripts, and running them.
//!
//! Both are read-only SQL under the guard and the limits of a query, or Python that asks such queries. What is kept follows
//! from the calls of the trajectory; what calculations said before a week stands in its `advance` line, so a resumed run
//! shows the same dashboard, and runs nothing for it.

use std::time::{Duration, Instant};

use crate::ask::query_refusal;
use crate::python::refuse_unless_played;
use crate::state::Session;
use novamind_database::query::SQL_CANCELLED;
use novamind_database::text;
use novamind_record::trajectory::record::{Calculated, Via};
use novamind_tools::{
    Kept, Language, Notebook, NotebookChange, Refusal, Script, ScriptOutput, hint_at_python,
};

/// Characters of output that a script may give.
const MOST_OUTPUT: usize = 5000;
/// Characters of warnings and hints that a script may give.
const MOST_REMARKS: usize = 2000;

/// What is remarked of longer output.
const OUTPUT_IS_CUT: &str = "stdout is cut after 5,000 characters\n";

/// What code said.
#[derive(Debug, Default)]
pub(crate) struct Said {
    /// Results as tables, or what was printed.
    pub results: String,
    /// Warnings and hints.
    pub remarks: String,
}

impl Said {
    fn add(&mut self, rows: &novamind_database::Rows) {
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

    /// From here on no Python is started: what is called was decided elsewhere.
    pub fn keep_python_out(&mut self) {
        self.surroundings.keeps_python_out = true;
    }

    /// The answer of a tool that runs a script.
    ///
    /// # Errors
    /// `script_failed`, `script_timeout`, saying where.
    pub(crate) fn run_script(&mut self, script: &Script, via: Via) -> Result<ScriptOutput, Refusal> {
        let time = Duration::from_secs_f64(script.seconds);
        let said = match Language::of(&script.code) {
            Language::Sql => self.run_statements(&script.code, time)?,
            Language::Python => {
                self.refuse_python(via)?;
                self.run_python(&script.code, time, true)?
            }
        };
        let stdout = first(&said.results, MOST_OUTPUT);
        let cut = if stdout.len() < said.results.len() { OUTPUT_IS_CUT } else { "" };
        Ok(ScriptOutput {
            returncode: 0,
            stdout,
            stderr: first(&format!("{cut}{}", said.remarks), MOST_REMARKS),
        })
    }

    /// Refuses Python where nobody plays.
    fn refuse_python(&self, via: Via) -> Result<(), Refusal> {
        let is_played = !matches!(via, Via::Policy | Via::Branch | Via::Lesson);
        refuse_unless_played(is_played && !self.surroundings.keeps_python_out)
    }

    fn run_statements(&mut self, code: &str, time: Duration) -> Result<Said, Refusal> {
        let limits = self.query_limits();
        let connection =
            self.connection().map_err(|refusal| Refusal::new("script_failed", refusal.message))?;
        let mut said = Said::default();
        match connection.run_script(code, limits, time, |rows| said.add(&rows)) {
            Ok(()) => Ok(said),
            Err(stopped) => {
                let refusal = query_refusal(stopped.error);
                let was_stopped = ["sql_timeout", SQL_CANCELLED].contains(&refusal.code);
                let kind = if was_stopped { "script_timeout" } else { "script_failed" };
                let (number, why) = (stopped.statement, refusal.message);
                let hint = hint_at_python(code).map(|hint| format!("; {hint}")).unwrap_or_default();
                let message =
                    format!("statement {number}: {why}; the ones before it changed nothing either{hint}");
                Err(Refusal::at("code", kind, message))
            }
        }
    }

    /// Runs all calculations on the company as it is. One that fails says why and does not keep the week; all together have the
    /// time of one query, so that a week never waits longer for them.
    pub(crate) fn run_calculations(&mut self, via: Via) -> Vec<Calculated> {
        let entries = self.surroundings.notebook.statements(Kept::Calculation).entries().to_vec();
        let (most, started) = (self.query_limits().time, Instant::now());
        let shown = self.simulation.params.limits.dashboard_calculation_max_chars as usize;
        let run = |(name, code): (String, String)| {
            let time = most.saturating_sub(started.elapsed());
            let said = match Language::of(&code) {
                _ if time.is_zero() => {
                    let message =
                        format!("the calculations before it took the {} s of a week", most.as_secs());
                    Err(Refusal::new("script_timeout", message))
                }
                Language::Sql => self.run_statements(&code, time),
                // Nobody asks what it asks.
                Language::Python => {
                    self.refuse_python(via).and_then(|()| self.run_python(&code, time, false))
                }
            };
            let output = match said {
                Ok(said) => said.results,
                Err(refusal) => format!("failed: {}", refusal.message),
            };
            Calculated { name, output: first(&output, shown) }
        };
        entries.into_iter().map(run).collect()
    }

    /// Names the calculations in Python to whoever goes on with a run: somebody else may have registered them.
    pub(crate) fn name_python_calculations(&mut self) {
        let kept = self.surroundings.notebook.statements(Kept::Calculation).entries();
        let python = kept.iter().filter(|(_, code)| Language::of(code) == Language::Python);
        let names: Vec<&str> = python.map(|(name, _)| name.as_str()).collect();
        if !names.is_empty() && self.recorder.is_some() && self.history.ended.is_none() {
            let remark = format!("Calculations in Python run before each week: {}.", names.join(", "));
            self.remarks.push(remark);
        }
    }

    /// Keeps or forgets what an accepted call asks for.
    pub(crate) fn keep(&mut self, change: &NotebookChange) {
        self.surroundings.notebook.apply(change);
    }
}
