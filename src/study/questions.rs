//! Questionnaires of a study. Each questionnaire is a file `questions/*.toml` in the folder of the study.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use novamind_world::params::ParameterError;

/// A questionnaire: questions that are asked together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Questionnaire {
    /// Name of the questionnaire: its file name without extension.
    #[serde(skip)]
    pub name: String,
    /// Heading of the questionnaire.
    pub title: String,
    /// Text that is shown before the first question.
    #[serde(default)]
    pub introduction: String,
    /// Occasion on which the questionnaire is asked.
    pub when: Occasion,
    /// Weeks after which the questionnaire is asked, if `when = "weeks"`.
    #[serde(default)]
    pub weeks: Vec<u32>,
    /// Questions of the questionnaire in order.
    #[serde(rename = "question")]
    pub questions: Vec<Question>,
}

/// Occasion on which a questionnaire is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Occasion {
    /// Before the first week of the session.
    Before,
    /// After the weeks in [`Questionnaire::weeks`].
    Weeks,
    /// When the participant continues after stopping the clock or leaving.
    Break,
    /// After the session has ended.
    End,
}

/// A question of a questionnaire.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Question {
    /// Name of the question, which consists of letters, digits and underscores.
    pub id: String,
    /// Text of the question.
    pub text: String,
    /// Format of the answer.
    #[serde(flatten)]
    pub form: AnswerFormat,
    /// Whether the question must be answered.
    #[serde(default)]
    pub required: bool,
}

/// Format of the answer to a question.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "form", rename_all = "lowercase")]
pub enum AnswerFormat {
    /// A point on a scale.
    Likert {
        /// Number of points of the scale, 2 to 11.
        points: u32,
        /// Label of the first point.
        #[serde(default)]
        low: String,
        /// Label of the last point.
        #[serde(default)]
        high: String,
    },
    /// A number.
    Number {
        /// Smallest valid number.
        #[serde(default)]
        min: Option<f64>,
        /// Largest valid number.
        #[serde(default)]
        max: Option<f64>,
        /// Unit of the number.
        #[serde(default)]
        unit: String,
    },
    /// A choice of one or several options.
    Choice {
        /// Texts of the options.
        options: Vec<String>,
        /// Whether several options can be chosen.
        #[serde(default)]
        several: bool,
    },
    /// Free text.
    Text {
        /// Maximum number of characters.
        #[serde(default = "default_max_characters")]
        most: u32,
    },
    /// An attention check, in which one option is the expected answer.
    Attention {
        /// Texts of the options.
        options: Vec<String>,
        /// The option that is the expected answer.
        expected: String,
    },
}

fn default_max_characters() -> u32 {
    2000
}

impl AnswerFormat {
    /// Returns the identifier of the format in records.
    pub fn id(&self) -> &'static str {
        match self {
            AnswerFormat::Likert { .. } => "likert",
            AnswerFormat::Number { .. } => "number",
            AnswerFormat::Choice { .. } => "choice",
            AnswerFormat::Text { .. } => "text",
            AnswerFormat::Attention { .. } => "attention",
        }
    }

    /// Returns the options that are shown to the participant. Returns an empty list for numbers and text.
    pub fn options(&self) -> Vec<String> {
        match self {
            AnswerFormat::Likert { points, .. } => (1..=*points).map(|point| point.to_string()).collect(),
            AnswerFormat::Choice { options, .. } | AnswerFormat::Attention { options, .. } => options.clone(),
            AnswerFormat::Number { .. } | AnswerFormat::Text { .. } => Vec::new(),
        }
    }

    /// Parses a typed answer.
    ///
    /// # Errors
    /// Returns a description of a valid answer if the answer is invalid.
    pub fn parse_answer(&self, typed: &str) -> Result<Value, String> {
        let typed = typed.trim();
        match self {
            AnswerFormat::Likert { points, .. } => match typed.parse::<u32>() {
                Ok(point) if (1..=*points).contains(&point) => Ok(json!(point)),
                _ => Err(format!("a number from 1 to {points}")),
            },
            AnswerFormat::Number { min, max, unit } => {
                let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
                let number = typed.replace('_', "").parse::<f64>().ok().filter(|number| number.is_finite());
                let above = |number: &f64| min.is_none_or(|min| *number >= min);
                let below = |number: &f64| max.is_none_or(|max| *number <= max);
                number.filter(above).filter(below).map(|number| json!(number)).ok_or_else(|| {
                    match (min, max) {
                        (Some(min), Some(max)) => format!("a number from {min} to {max}{unit}"),
                        (Some(min), None) => format!("a number of at least {min}{unit}"),
                        (None, Some(max)) => format!("a number of at most {max}{unit}"),
                        (None, None) => format!("a number{unit}"),
                    }
                })
            }
            AnswerFormat::Choice { options, several: true } => {
                let chosen: Option<Vec<&String>> =
                    typed.split(',').map(|one| option_by_number_or_text(options, one.trim())).collect();
                chosen
                    .filter(|chosen| !chosen.is_empty())
                    .map(|chosen| json!(chosen))
                    .ok_or_else(|| format!("numbers from 1 to {}, with commas", options.len()))
            }
            AnswerFormat::Choice { options, several: false } | AnswerFormat::Attention { options, .. } => {
                let none = || format!("a number from 1 to {}", options.len());
                option_by_number_or_text(options, typed).map(|option| json!(option)).ok_or_else(none)
            }
            AnswerFormat::Text { most } => match typed.chars().count() {
                0 => Err("a few words".to_owned()),
                length if length as u64 > u64::from(*most) => Err(format!("at most {most} characters")),
                _ => Ok(json!(typed)),
            },
        }
    }

    /// Returns whether the answer is free text.
    pub fn is_free_text(&self) -> bool {
        matches!(self, AnswerFormat::Text { .. })
    }

    /// Returns whether an attention check was answered as expected, or `None` for other formats.
    pub fn matches_expected(&self, value: &Value) -> Option<bool> {
        match self {
            AnswerFormat::Attention { expected, .. } => Some(value.as_str() == Some(expected)),
            _ => None,
        }
    }

    fn allowed_keys(&self) -> &'static [&'static str] {
        match self {
            AnswerFormat::Likert { .. } => &["points", "low", "high"],
            AnswerFormat::Number { .. } => &["min", "max", "unit"],
            AnswerFormat::Choice { .. } => &["options", "several"],
            AnswerFormat::Text { .. } => &["most"],
            AnswerFormat::Attention { .. } => &["options", "expected"],
        }
    }

    fn check(&self) -> Result<(), String> {
        match self {
            AnswerFormat::Likert { points, .. } if !(2..=11).contains(points) => {
                Err("a scale has 2 to 11 points".to_owned())
            }
            AnswerFormat::Number { min: Some(min), max: Some(max), .. } if min > max => {
                Err(format!("min {min} is above max {max}"))
            }
            AnswerFormat::Choice { options, .. } | AnswerFormat::Attention { options, .. }
                if options.len() < 2 =>
            {
                Err("at least two options are required".to_owned())
            }
            AnswerFormat::Attention { options, expected } if !options.contains(expected) => {
                Err(format!("the expected answer {expected:?} is not one of the options"))
            }
            _ => Ok(()),
        }
    }
}

/// Finds an option by its number, counted from 1, or by its text.
fn option_by_number_or_text<'a>(options: &'a [String], typed: &str) -> Option<&'a String> {
    let numbered = typed.parse::<usize>().ok().and_then(|number| options.get(number.checked_sub(1)?));
    numbered.or_else(|| options.iter().find(|option| option.eq_ignore_ascii_case(typed)))
}

impl Questionnaire {
    /// Parses the text of a questionnaire file.
    ///
    /// # Errors
    /// Returns an error that names the first problem, its line and its key.
    pub fn parse(path: &Path, text: &str) -> Result<Questionnaire, ParameterError> {
        let source = path.display().to_string();
        let read: Questionnaire =
            toml::from_str(text).map_err(|error| ParameterError::from_toml(&source, text, &error))?;
        let name = path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let questionnaire = Questionnaire { name, ..read };
        if (questionnaire.when == Occasion::Weeks) == questionnaire.weeks.is_empty() {
            return Err(ParameterError::for_key(
                &source,
                text,
                "weeks",
                "weeks = [N, …] is required with when = \"weeks\" and not allowed otherwise",
            ));
        }
        let tables = text.parse::<toml::Table>().unwrap_or_default();
        let tables = tables.get("question").and_then(toml::Value::as_array).cloned().unwrap_or_default();
        let mut known = std::collections::BTreeSet::new();
        for (question, table) in questionnaire.questions.iter().zip(&tables) {
            let texts = [&["id", "text", "form", "required"], question.form.allowed_keys()].concat();
            let unknown = table
                .as_table()
                .into_iter()
                .flat_map(toml::Table::keys)
                .find(|key| !texts.contains(&key.as_str()));
            if let Some(key) = unknown {
                let problem = format!(
                    "{}: {key} is not a key of this form; its keys are {}",
                    question.id,
                    texts.join(", ")
                );
                return Err(ParameterError::for_key(&source, text, key, problem));
            }
            let fits = |letter: u8| letter.is_ascii_alphanumeric() || letter == b'_';
            if question.id.is_empty() || !question.id.bytes().all(fits) {
                let problem = format!(
                    "{:?} is not a valid name of a question: use letters, digits and underscores",
                    question.id
                );
                return Err(ParameterError::for_key(&source, text, "question", problem));
            }
            if !known.insert(&question.id) {
                return Err(ParameterError::for_key(
                    &source,
                    text,
                    "question",
                    format!("{} occurs twice", question.id),
                ));
            }
            let problem = |problem: String| {
                ParameterError::for_key(&source, text, "question", format!("{}: {problem}", question.id))
            };
            question.form.check().map_err(problem)?;
        }
        Ok(questionnaire)
    }

    /// Returns whether the questionnaire is asked after a week. Weeks are counted from 1.
    pub fn is_due_after(&self, week: u32) -> bool {
        self.when == Occasion::Weeks && self.weeks.contains(&week)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse_questionnaire(text: &str) -> Result<Questionnaire, String> {
        Questionnaire::parse(Path::new("questions/effort.toml"), text).map_err(|error| error.to_string())
    }

    const SAMPLE_QUESTIONNAIRE: &str = r#"
title = "Effort"
when = "weeks"
weeks = [4, 12]
[[question]]
id = "effort"
text = "How hard was this week?"
form = "likert"
points = 7
low = "easy"
high = "hard"
required = true
[[question]]
id = "check"
text = "Choose the second option."
form = "attention"
options = ["first", "second"]
expected = "second"
[[question]]
id = "tools"
text = "What helped?"
form = "choice"
options = ["SQL", "forms", "notes"]
several = true
[[question]]
id = "cash"
text = "Cash at the end?"
form = "number"
min = 0.0
"#;

    #[test]
    fn parse_answer_depends_on_the_format() {
        let effort = parse_questionnaire(SAMPLE_QUESTIONNAIRE).expect("it reads");
        assert_eq!(effort.name, "effort");
        assert!(effort.is_due_after(4) && !effort.is_due_after(5));
        let value = |at: usize, typed: &str| effort.questions[at].form.parse_answer(typed);
        assert_eq!(value(0, "7"), Ok(json!(7)));
        assert_eq!(value(0, "8"), Err("a number from 1 to 7".to_owned()));
        assert_eq!(value(1, "2"), Ok(json!("second")));
        assert_eq!(effort.questions[1].form.matches_expected(&json!("first")), Some(false));
        assert_eq!(value(2, "1, notes"), Ok(json!(["SQL", "notes"])));
        assert!(value(2, "1, none").is_err());
        assert_eq!(value(3, "1_000"), Ok(json!(1000.0)));
        assert!(value(3, "-1").is_err() && value(3, "inf").is_err());
    }

    #[test]
    fn parse_errors_name_the_question() {
        for (from, to, part) in [
            ("points = 7", "points = 1", "2 to 11"),
            ("expected = \"second\"", "expected = \"third\"", "not one of the options"),
            ("weeks = [4, 12]", "", "weeks"),
            ("id = \"check\"", "id = \"effort\"", "twice"),
            ("when = \"weeks\"", "when = \"sometimes\"", "line 3"),
            ("low = \"easy\"", "lowest = \"easy\"", "lowest is not a key of this form"),
        ] {
            let error = parse_questionnaire(&SAMPLE_QUESTIONNAIRE.replace(from, to)).expect_err(to);
            assert!(error.contains(part), "{error}");
        }
    }
}
