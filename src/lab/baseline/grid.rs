//! Policy grids. Each combination of levels, one per axis, is a policy (docs/laboratory/baseline.md#custom-grids).

use serde::Deserialize;
use toml::{Spanned, Table, Value};

use crate::lab_report::column_name;
use crate::policy::{Policy, PolicyError};
use novamind_world::params::ParameterSource;

/// Maximum number of combinations in a grid.
pub const MAX_COMBINATIONS: usize = 2_000;

/// Separator between the names of the levels in a label.
const LEVEL_SEPARATOR: &str = " / ";

/// A grid of policies.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicyGrid {
    /// Name of the grid.
    pub name: String,
    /// Description of the grid, which reports repeat as a note; empty if the file has none.
    pub description: String,
    /// Names of the axes, in the order of the file.
    pub axes: Vec<String>,
    /// Combinations of levels, ordered so that the last axis varies fastest.
    pub configurations: Vec<GridPoint>,
}

/// A combination of one level per axis.
#[derive(Debug, Clone, PartialEq)]
pub struct GridPoint {
    /// Names of the levels, one per axis.
    pub levels: Vec<String>,
    /// Policy of the combination.
    pub policy: Policy,
}

impl GridPoint {
    /// Returns the names of the levels, joined by the separator.
    pub fn label(&self) -> String {
        self.levels.join(LEVEL_SEPARATOR)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GridFile {
    name: String,
    #[serde(default)]
    description: String,
    #[serde(default)]
    policy: Option<Spanned<Table>>,
    axis: Vec<Spanned<AxisEntry>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisEntry {
    name: String,
    level: Vec<Spanned<LevelEntry>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LevelEntry {
    name: String,
    #[serde(default)]
    set: Table,
    #[serde(default)]
    call: Vec<Value>,
}

/// A level with its position in the file.
struct GridLevel {
    name: String,
    set: Table,
    calls: Vec<Value>,
    span: std::ops::Range<usize>,
}

impl PolicyGrid {
    /// Returns a bundled grid by name, or reads a file if `name` contains a path separator or ends in .toml.
    ///
    /// # Errors
    /// Fails if the grid does not exist or is invalid.
    pub fn find(name: &str) -> Result<PolicyGrid, PolicyError> {
        let wrong =
            |problem: String| PolicyError { source: name.to_owned(), line: None, problem, is_unknown: false };
        if name.ends_with(".toml") || name.contains(std::path::is_separator) {
            let text = std::fs::read_to_string(name).map_err(|error| wrong(error.to_string()))?;
            return PolicyGrid::parse(&ParameterSource { name: name.to_owned(), text });
        }
        match novamind_assets::grids().into_iter().find(|(bundled, _)| *bundled == name) {
            Some((_, text)) => {
                let file = format!("configs/grids/{name}.toml");
                PolicyGrid::parse(&ParameterSource { name: file, text: text.to_owned() })
            }
            None => {
                let known: Vec<&str> = novamind_assets::grids().into_iter().map(|(name, _)| name).collect();
                let problem = format!("unknown grid; use {}, or the path of a TOML file", known.join(", "));
                Err(PolicyError { is_unknown: true, ..wrong(problem) })
            }
        }
    }

    /// Parses a grid from TOML.
    ///
    /// # Errors
    /// Fails on unknown keys, axes without levels, duplicate level names, invalid policies, and too many combinations.
    pub fn parse(source: &ParameterSource) -> Result<PolicyGrid, PolicyError> {
        let reader = GridReader(source);
        let file: GridFile =
            toml::from_str(&source.text).map_err(|error| reader.error_at(error.span(), error.message()))?;
        let base = file.policy.map(|policy| (policy.span(), policy.into_inner()));
        let mut axes: Vec<(String, Vec<GridLevel>)> = Vec::new();
        for axis in file.axis {
            let span = axis.span();
            let axis = axis.into_inner();
            let column = column_name(&axis.name);
            if !is_valid_label_part(&axis.name)
                || column.is_empty()
                || RESERVED_COLUMNS.contains(&column.as_str())
                || axes.iter().any(|(name, _)| column_name(name) == column)
            {
                return Err(reader.error_at(
                    Some(span),
                    &format!(
                        "axis names need letters or digits, must be unique and must not be {}; a name {NAME_REQUIREMENT}",
                        RESERVED_COLUMNS.join(", ")
                    ),
                ));
            }
            let levels = reader.read_levels(&axis.name, axis.level, span)?;
            axes.push((axis.name, levels));
        }
        let count = axes.iter().map(|(_, levels)| levels.len()).product::<usize>();
        if axes.is_empty() || count > MAX_COMBINATIONS {
            return Err(reader.error_at(
                None,
                &format!("a grid has 1 to {MAX_COMBINATIONS} combinations, this one has {count}"),
            ));
        }
        reader.check_base(base.as_ref())?;
        let base = base.map(|(_, table)| table).unwrap_or_default();
        let points = (0..count).map(|number| reader.build_point(number, &axes, &base, &file.name));
        Ok(PolicyGrid {
            configurations: points.collect::<Result<_, _>>()?,
            axes: axes.into_iter().map(|(name, _)| name).collect(),
            name: file.name,
            description: file.description,
        })
    }
}

/// Requirement for the names of axes and levels, worded for error messages.
const NAME_REQUIREMENT: &str =
    "is one line of text without \" / \", which separates the levels of a combination";

/// Column names that reports use, and that axes must therefore not use.
const RESERVED_COLUMNS: [&str; 13] = [
    "seed",
    "cash",
    "survival",
    "bankrupt",
    "peak",
    "peak_day",
    "median_cash",
    "median_cash_interval",
    "lower_quartile",
    "upper_quartile",
    "first",
    "place",
    "equal",
];

/// Returns whether a name can be part of a label without ambiguity.
fn is_valid_label_part(name: &str) -> bool {
    !name.trim().is_empty()
        && !name.contains(LEVEL_SEPARATOR)
        && !name.chars().any(|letter| letter.is_control() || ['\u{2028}', '\u{2029}'].contains(&letter))
}

/// A reader of a grid file that locates errors in the file.
struct GridReader<'a>(&'a ParameterSource);

impl GridReader<'_> {
    fn error_at(&self, span: Option<std::ops::Range<usize>>, problem: &str) -> PolicyError {
        let text = &self.0.text;
        PolicyError {
            source: self.0.name.clone(),
            line: span.map(|span| text[..span.start.min(text.len())].matches('\n').count() + 1),
            problem: problem.to_owned(),
            is_unknown: false,
        }
    }

    fn read_levels(
        &self,
        axis: &str,
        entries: Vec<Spanned<LevelEntry>>,
        span: std::ops::Range<usize>,
    ) -> Result<Vec<GridLevel>, PolicyError> {
        let mut levels: Vec<GridLevel> = Vec::new();
        for entry in entries {
            let span = entry.span();
            let LevelEntry { name, set, call } = entry.into_inner();
            if levels.iter().any(|grid_level| grid_level.name == name) {
                let problem = format!("axis {axis} has two levels named {name}");
                return Err(self.error_at(Some(span), &problem));
            }
            if !is_valid_label_part(&name) {
                return Err(self
                    .error_at(Some(span), &format!("axis {axis}: the name of a level {NAME_REQUIREMENT}")));
            }
            levels.push(GridLevel { name, set, calls: call, span });
        }
        if levels.is_empty() {
            return Err(self.error_at(Some(span), &format!("axis {axis} has no levels")));
        }
        Ok(levels)
    }

    // Checks that the part that all combinations share is a valid policy.
    fn check_base(&self, base: Option<&(std::ops::Range<usize>, Table)>) -> Result<(), PolicyError> {
        let Some((span, table)) = base else { return Ok(()) };
        let parsed = parse_policy(table.clone(), "policy").map_err(|problem| (span.clone(), problem));
        parsed.map(drop).map_err(|(span, problem)| self.error_at_key(span, &problem))
    }

    /// Returns the combination with an index. The last axis varies fastest.
    fn build_point(
        &self,
        number: usize,
        axes: &[(String, Vec<GridLevel>)],
        base: &Table,
        grid: &str,
    ) -> Result<GridPoint, PolicyError> {
        let (mut left, mut chosen) = (number, Vec::new());
        for (_, levels) in axes.iter().rev() {
            chosen.push(&levels[left % levels.len()]);
            left /= levels.len();
        }
        chosen.reverse();
        let mut table = base.clone();
        for level in &chosen {
            merge_into(&mut table, level.set.clone());
            if !level.calls.is_empty() {
                let calls = table.entry("call").or_insert_with(|| Value::Array(Vec::new()));
                if let Value::Array(calls) = calls {
                    calls.extend(level.calls.iter().cloned());
                }
            }
            // The policy was valid with the previous levels, so the error is in this level.
            let checked = parse_policy(table.clone(), grid);
            checked.map_err(|problem| {
                self.error_at_key(level.span.clone(), &format!("level {}: {problem}", level.name))
            })?;
        }
        let levels: Vec<String> = chosen.iter().map(|level| level.name.clone()).collect();
        let policy = parse_policy(table, &levels.join(LEVEL_SEPARATOR))
            .map_err(|problem| self.error_at(None, &problem))?;
        Ok(GridPoint { levels, policy })
    }

    /// Locates an error at the first line after the start of `span` that begins with the key quoted in the message.
    /// If no line matches, locates the error at `span`.
    fn error_at_key(&self, span: std::ops::Range<usize>, problem: &str) -> PolicyError {
        let mut error = self.error_at(Some(span.clone()), problem);
        let text = self.0.text.get(span.start..).unwrap_or_default();
        let key = problem.split('`').nth(1).unwrap_or_default();
        let names = |line: &str| {
            let mut words = line.split(|sign: char| !(sign.is_alphanumeric() || sign == '_'));
            !key.is_empty() && words.any(|word| word == key)
        };
        if let (Some(line), Some(below)) = (error.line, text.lines().position(names)) {
            error.line = Some(line + below);
        }
        error
    }
}

/// Merges the keys of `above` into `below`, recursively.
fn merge_into(below: &mut Table, above: Table) {
    for (key, value) in above {
        match (below.get_mut(&key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => merge_into(below, above),
            (_, value) => drop(below.insert(key, value)),
        }
    }
}

fn parse_policy(mut table: Table, name: &str) -> Result<Policy, String> {
    table.insert("name".to_owned(), Value::String(name.to_owned()));
    let text = toml::to_string(&table).map_err(|error| error.to_string())?;
    Policy::parse(&ParameterSource { name: name.to_owned(), text }).map_err(|error| error.problem)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<PolicyGrid, PolicyError> {
        PolicyGrid::parse(&ParameterSource { name: "grid.toml".to_owned(), text: text.to_owned() })
    }

    #[test]
    fn paper_grid_has_24_distinct_configurations() {
        let grid = PolicyGrid::find("paper").expect("a grid");
        assert_eq!((grid.axes.len(), grid.configurations.len()), (4, 24));
        let labels: Vec<String> = grid.configurations.iter().map(GridPoint::label).collect();
        assert_eq!(
            (labels[0].as_str(), labels[23].as_str()),
            ("cheap / S1 / light / $100K", "mid / S1+S3 / heavy / $300K")
        );
        let of = |label: &str| {
            let grid_point =
                grid.configurations.iter().find(|point| point.label() == label).expect("a configuration");
            grid_point.policy.rule_based.clone()
        };
        // The best published configuration equals the default values of the routine.
        assert_eq!(of("mid / S1 / heavy / $100K"), Some(crate::policy::RuleBased::default()));
        for (at, grid_point) in grid.configurations.iter().enumerate() {
            let same = |other: &&GridPoint| other.policy.rule_based == grid_point.policy.rule_based;
            assert_eq!(grid.configurations.iter().filter(same).count(), 1, "{}", labels[at]);
        }
    }

    #[test]
    fn level_calls_extend_base_calls() {
        let grid = PolicyGrid::find("content-ads").expect("a grid");
        assert_eq!(grid.configurations.len(), 6);
        let last = &grid.configurations[5].policy;
        let tools: Vec<&str> = last.calls.iter().map(|call| call.tool.as_str()).collect();
        assert_eq!(tools, ["set_targeted_ad_spend", "set_targeted_dev_spend"]);
    }

    #[test]
    fn invalid_grids_name_line_and_key() {
        let level = "[[axis]]\nname = \"a\"\n[[axis.level]]\nname = \"x\"\n";
        for (text, line, part) in [
            ("name = \"g\"\nwhat = 1\n".to_owned(), Some(2), "what"),
            ("name = \"g\"\naxis = []\n".to_owned(), None, "combinations"),
            (
                format!("name = \"g\"\n{level}set = {{ rule_based = {{ price_bok = \"mid\" }} }}\n"),
                Some(6),
                "price_bok",
            ),
            (
                format!("name = \"g\"\n{level}\n[axis.level.set.rule_based]\nspend = \"huge\"\n"),
                Some(4),
                "light, medium",
            ),
            (
                format!("name = \"g\"\n{level}[[axis.level.call]]\nday = 3\ntool = \"set_prices\"\n"),
                Some(4),
                "decision day",
            ),
            (format!("name = \"g\"\n{level}[[axis.level]]\nname = \"x\"\n"), Some(6), "two levels"),
            (format!("name = \"g\"\n{level}[[axis.level]]\nname = \"\"\n"), Some(6), "one line of text"),
            (format!("name = \"g\"\n{level}{level}"), Some(6), "must be unique"),
            (format!("name = \"g\"\n[policy.rule_based]\nprice = 1\n{level}"), Some(3), "price"),
            (format!("name = \"g\"\n{level}sets = {{}}\n"), Some(6), "sets"),
        ] {
            let error = parse(&text).expect_err(&text);
            assert_eq!(error.line, line, "{text}: {error}");
            assert!(error.problem.contains(part), "{text}: {error}");
        }
        let missing = PolicyGrid::find("nothing").expect_err("unknown grid");
        assert!(missing.problem.contains("paper"), "{missing}");
    }
}
