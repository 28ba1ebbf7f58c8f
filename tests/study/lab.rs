//! The study: its protocol, its three machines, and the commands of the experimenter.

use std::fs;
use std::path::PathBuf;

use novamind::study::Study;

use crate::support::home::{Home, ProgramOutput};

/// A lab that runs a study on three machines.
pub struct StudyLab {
    home: Home,
}

/// Names of the machines.
pub const MACHINES: [&str; 3] = ["m1", "m2", "m3"];

const PROTOCOL: &str = r#"
name = "twelve"
title = "Four weeks"
[world]
scenario = "short"
days = 28
[seeds]
plan = "assigned"
[practice]
offer = "none"
[session]
pause_reason = true
[limits]
week_minutes = 10
warning_minutes = 1
at_limit = "naive"
[record]
drafts = "text"
"#;

const QUESTIONNAIRE_BEFORE_FIRST_WEEK: &str = r#"
title = "About you"
when = "before"
[[question]]
id = "experience"
text = "How much experience do you have?"
form = "likert"
points = 7
required = true
"#;

const WEEK: &str = r#"
title = "This week"
when = "weeks"
weeks = [2]
[[question]]
id = "check"
text = "Choose the second option."
form = "attention"
options = ["first", "second"]
expected = "second"
required = true
"#;

const BREAK: &str = r#"
title = "After the break"
when = "break"
[[question]]
id = "spoke"
text = "Did you speak to anybody about the study?"
form = "choice"
options = ["no", "yes"]
required = true
"#;

const END: &str = r#"
title = "The end"
when = "end"
[[question]]
id = "strategy"
text = "What did you try?"
form = "text"
most = 40
required = true
"#;

impl StudyLab {
    /// Creates the study and its machines without runs.
    pub fn new() -> StudyLab {
        let lab = StudyLab { home: Home::new() };
        let folder = lab.study();
        fs::create_dir_all(folder.join("questions")).expect("a folder");
        let write = |name: &str, text: &str| fs::write(folder.join(name), text).expect("written");
        write("study.toml", PROTOCOL);
        write("consent.md", "# Taking part\n\nEverything you do is recorded.\n");
        write("questions/1-before.toml", QUESTIONNAIRE_BEFORE_FIRST_WEEK);
        write("questions/2-week.toml", WEEK);
        write("questions/3-break.toml", BREAK);
        write("questions/4-end.toml", END);
        let row = |person: u64| {
            let condition = if person % 2 == 1 { "odd" } else { "even" };
            format!("P{person:02},{condition},{},{person}\n", 40 + person % 3)
        };
        write(
            "assignment.csv",
            &("label,condition,seed,order\n".to_owned() + &(1..=12).map(row).collect::<String>()),
        );
        lab.command(&["study", "check", &folder.display().to_string()]);
        lab
    }

    fn path(&self, name: &str) -> PathBuf {
        self.home.0.path().join(name)
    }

    pub fn study(&self) -> PathBuf {
        self.path("study")
    }

    pub fn machine(&self, name: &str) -> PathBuf {
        self.path(name)
    }

    pub fn read_study(&self) -> Study {
        Study::load(&self.study()).expect("a study")
    }

    /// Returns the command that runs the program on a machine.
    pub fn program(&self, machine: &str) -> std::process::Command {
        let mut command = self.home.program();
        command.env("NOVAMIND_RUNS", self.machine(machine)).arg("--study").arg(self.study());
        command
    }

    fn command(&self, arguments: &[&str]) -> ProgramOutput {
        self.home.run(arguments)
    }

    /// Runs a command with the folders of all machines as arguments.
    fn run_on_all_machines(&self, before: &[&str], after: &[&str]) -> ProgramOutput {
        let machines = MACHINES.map(|name| self.machine(name).display().to_string());
        let machines: Vec<&str> = machines.iter().map(String::as_str).collect();
        self.command(&[before, &machines, after].concat())
    }

    pub fn tables_folder(&self) -> PathBuf {
        self.path("data")
    }

    pub fn collect(&self) -> ProgramOutput {
        let (data, study) = (self.tables_folder().display().to_string(), self.study().display().to_string());
        self.run_on_all_machines(&["study", "collect"], &["--out", &data, "--protocol", &study])
    }

    /// Writes anonymized tables and returns their folder.
    pub fn anonymise(&self) -> PathBuf {
        let (public, secret) = (self.path("public"), self.path("secret"));
        let path = |path: &PathBuf| path.display().to_string();
        self.command(&[
            "study",
            "anonymise",
            &path(&self.tables_folder()),
            "--out",
            &path(&public),
            "--secret",
            &path(&secret),
        ]);
        public
    }

    /// Audits the honest sessions, which must not cause findings.
    pub fn assert_audit_finds_nothing(&self) {
        let study = self.study().display().to_string();
        let program_output = self.run_on_all_machines(&["study", "audit", &study], &[]);
        assert_eq!(program_output.exit_code, 0, "{}{}", program_output.stdout, program_output.stderr);
        assert!(program_output.stdout.contains("No findings."), "{}", program_output.stdout);
    }
}
