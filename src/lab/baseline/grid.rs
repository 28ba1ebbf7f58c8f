//! Grids of policies: axes with levels, every combination of which is a policy (docs/laboratory/baseline.md#own-grids).

use serde::Deserialize;
use toml::{Spanned, Table, Value};

use crate::exhibit::column_name;
use crate::policy::{Policy, PolicyError};
use novamind_world::params::ParameterSource;

/// Most combinations of a grid.
pub const MOST: usize = 2_000;

/// What stands between the levels of a combination.
const BETWEEN_LEVELS: &str = " / ";

/// A grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Name.
    pub name: String,
    /// What it varies, and why.
    pub description: String,
    /// Names of the axes.
    pub axes: Vec<String>,
    /// The combinations, the last axis fastest.
    pub configurations: Vec<GridPoint>,
}

/// A combination of levels.
#[derive(Debug, Clone, PartialEq)]
pub struct GridPoint {
    /// Names of its levels, one for each axis.
    pub levels: Vec<String>,
    /// What plays.
    pub policy: Policy,
}

impl GridPoint {
    /// Its levels in a line.
    pub fn label(&self) -> String {
        self.levels.join(BETWEEN_LEVELS)
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

/// A level with where it stands in its file.
struct GridLevel {
    name: String,
    set: Table,
    calls: Vec<Value>,
    span: std::ops::Range<usize>,
}

impl Grid {
    /// A shipped grid by its name, or the one of a file: anything with a separator, or ending in .toml.
    ///
    /// # Errors
    /// There is none, or it is wrong.
    pub fn find(name: &str) -> Result<Grid, PolicyError> {
        let wrong =
            |problem: String| PolicyError { source: name.to_owned(), line: None, problem, is_unknown: false };
        if name.ends_with(".toml") || name.contains(std::path::is_separator) {
            let text = std::fs::read_to_string(name).map_err(|error| wrong(error.to_string()))?;
            return Grid::parse(&ParameterSource { name: name.to_owned(), text });
        }
        match novamind_assets::grids().into_iter().find(|(shipped, _)| *shipped == name) {
            Some((_, text)) => {
                let file = format!("configs/grids/{name}.toml");
                Grid::parse(&ParameterSource { name: file, text: text.to_owned() })
            }
            None => {
                let known: Vec<&str> = novamind_assets::grids().into_iter().map(|(name, _)| name).collect();
                let problem = format!("there is no such grid; there are {}, and files", known.join(", "));
                Err(PolicyError { is_unknown: true, ..wrong(problem) })
            }
        }
    }

    /// Reads a grid.
    ///
    /// # Errors
    /// Unknown keys, axes without levels, levels of one name, combinations that are no policy, and too many of them.
    pub fn parse(source: &ParameterSource) -> Result<Grid, PolicyError> {
        let reader = Reader(source);
        let file: GridFile =
            toml::from_str(&source.text).map_err(|error| reader.at(error.span(), error.message()))?;
        let base = file.policy.map(|policy| (policy.span(), policy.into_inner()));
        let mut axes: Vec<(String, Vec<GridLevel>)> = Vec::new();
        for axis in file.axis {
            let span = axis.span();
            let axis = axis.into_inner();
            let column = column_name(&axis.name);
            if !is_label(&axis.name)
                || column.is_empty()
                || COLUMNS_OF_TABLES.contains(&column.as_str())
                || axes.iter().any(|(name, _)| column_name(name) == column)
            {
                return Err(reader.at(
                    Some(span),
                    &format!(
                        "axes have names with letters or digits, each another one and none of {}; a name {LABEL}",
                        COLUMNS_OF_TABLES.join(", ")
                    ),
                ));
            }
            let levels = reader.levels(&axis.name, axis.level, span)?;
            axes.push((axis.name, levels));
        }
        let count = axes.iter().map(|(_, levels)| levels.len()).product::<usize>();
        if axes.is_empty() || count > MOST {
            return Err(
                reader.at(None, &format!("a grid has 1 to {MOST} combinations, this one has {count}"))
            );
        }
        reader.check_base(base.as_ref())?;
        let base = base.map(|(_, table)| table).unwrap_or_default();
        let points = (0..count).map(|number| reader.point(number, &axes, &base, &file.name));
        Ok(Grid {
            configurations: points.collect::<Result<_, _>>()?,
            axes: axes.into_iter().map(|(name, _)| name).collect(),
            name: file.name,
            description: file.description,
        })
    }
}

/// What a name is.
const LABEL: &str = "is one line of text without \" / \", which stands between the levels of a combination";

/// Names of columns that the tables have besides the axes.
const COLUMNS_OF_TABLES: [&str; 13] = [
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

/// Whether a name can stand in a label of a combination, and be found there again.
fn is_label(name: &str) -> bool {
    !name.trim().is_empty()
        && !name.contains(BETWEEN_LEVELS)
        && !name.chars().any(|letter| letter.is_control() || ['\u{2028}', '\u{2029}'].contains(&letter))
}

/// Reads the parts of a file and says where they are wrong.
struct Reader<'a>(&'a ParameterSource);

impl Reader<'_> {
    fn at(&self, span: Option<std::ops::Range<usize>>, problem: &str) -> PolicyError {
        let text = &self.0.text;
        PolicyError {
            source: self.0.name.clone(),
            line: span.map(|span| text[..span.start.min(text.len())].matches('\n').count() + 1),
            problem: problem.to_owned(),
            is_unknown: false,
        }
    }

    fn levels(
        &self,
        axis: &str,
        entries: Vec<Spanned<LevelEntry>>,
        span: std::ops::Range<usize>,
    ) -> Result<Vec<GridLevel>, PolicyError> {
        let mut levels: Vec<GridLevel> = Vec::new();
        for entry in entries {
            let span = entry.span();
            let LevelEntry { name, set, call } = entry.into_inner();
            if levels.iter().any(|own| own.name == name) {
                let problem = format!("axis {axis} has two levels of the name {name}");
                return Err(self.at(Some(span), &problem));
            }
            if !is_label(&name) {
                return Err(self.at(Some(span), &format!("axis {axis}: the name of a level {LABEL}")));
            }
            levels.push(GridLevel { name, set, calls: call, span });
        }
        if levels.is_empty() {
            return Err(self.at(Some(span), &format!("axis {axis} has no level")));
        }
        Ok(levels)
    }

    /// What all combinations have in common must be right by itself.
    fn check_base(&self, base: Option<&(std::ops::Range<usize>, Table)>) -> Result<(), PolicyError> {
        let Some((span, table)) = base else { return Ok(()) };
        let told = policy_of(table.clone(), "policy").map_err(|problem| (span.clone(), problem));
        told.map(drop).map_err(|(span, problem)| self.located(span, &problem))
    }

    /// The combination of a number, the last axis fastest.
    fn point(
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
            lay_over(&mut table, level.set.clone());
            if !level.calls.is_empty() {
                let calls = table.entry("call").or_insert_with(|| Value::Array(Vec::new()));
                if let Value::Array(calls) = calls {
                    calls.extend(level.calls.iter().cloned());
                }
            }
            // Whatever is wrong now came with this level.
            let checked = policy_of(table.clone(), grid);
            checked.map_err(|problem| {
                self.located(level.span.clone(), &format!("level {}: {problem}", level.name))
            })?;
        }
        let levels: Vec<String> = chosen.iter().map(|level| level.name.clone()).collect();
        let policy =
            policy_of(table, &levels.join(BETWEEN_LEVELS)).map_err(|problem| self.at(None, &problem))?;
        Ok(GridPoint { levels, policy })
    }

    /// A problem at the key it names in quotes, on the first line from a place on that begins with it; else at the place.
    fn located(&self, span: std::ops::Range<usize>, problem: &str) -> PolicyError {
        let mut error = self.at(Some(span.clone()), problem);
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

/// Lays a table over another, key by key.
fn lay_over(below: &mut Table, above: Table) {
    for (key, value) in above {
        match (below.get_mut(&key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => lay_over(below, above),
            (_, value) => drop(below.insert(key, value)),
        }
    }
}

/// The policy of a table.
fn policy_of(mut table: Table, name: &str) -> Result<Policy, String> {
    table.insert("name".to_owned(), Value::String(name.to_owned()));
    let text = toml::to_string(&table).map_err(|error| error.to_string())?;
    Policy::parse(&ParameterSource { name: name.to_owned(), text }).map_err(|error| error.problem)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Grid, PolicyError> {
        Grid::parse(&ParameterSource { name: "grid.toml".to_owned(), text: text.to_owned() })
    }

    #[test]
    fn the_paper_has_24_configurations_that_all_differ() {
        let grid = Grid::find("paper").expect("a grid");
        assert_eq!((grid.axes.len(), grid.configurations.len()), (4, 24));
        let labels: Vec<String> = grid.configurations.iter().map(GridPoint::label).collect();
        assert_eq!(
            (labels[0].as_str(), labels[23].as_str()),
            ("cheap / S1 / light / $100K", "mid / S1+S3 / heavy / $300K")
        );
        let of = |label: &str| {
            let own = grid.configurations.iter().find(|own| own.label() == label).expect("a configuration");
            own.policy.rule_based.clone()
        };
        // The published best one is what the routine does by itself.
        assert_eq!(of("mid / S1 / heavy / $100K"), Some(crate::policy::RuleBased::default()));
        for (at, own) in grid.configurations.iter().enumerate() {
            let same = |other: &&GridPoint| other.policy.rule_based == own.policy.rule_based;
            assert_eq!(grid.configurations.iter().filter(same).count(), 1, "{}", labels[at]);
        }
    }

    #[test]
    fn calls_of_levels_are_added_to_those_of_the_base() {
        let grid = Grid::find("content-ads").expect("a grid");
        assert_eq!(grid.configurations.len(), 6);
        let last = &grid.configurations[5].policy;
        let tools: Vec<&str> = last.calls.iter().map(|call| call.tool.as_str()).collect();
        assert_eq!(tools, ["set_targeted_ad_spend", "set_targeted_dev_spend"]);
    }

    #[test]
    fn wrong_grids_name_line_and_key() {
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
            (format!("name = \"g\"\n{level}{level}"), Some(6), "each another one"),
            (format!("name = \"g\"\n[policy.rule_based]\nprice = 1\n{level}"), Some(3), "price"),
            (format!("name = \"g\"\n{level}sets = {{}}\n"), Some(6), "sets"),
        ] {
            let error = parse(&text).expect_err(&text);
            assert_eq!(error.line, line, "{text}: {error}");
            assert!(error.problem.contains(part), "{text}: {error}");
        }
        let missing = Grid::find("nothing").expect_err("no such grid");
        assert!(missing.problem.contains("paper"), "{missing}");
    }
}
