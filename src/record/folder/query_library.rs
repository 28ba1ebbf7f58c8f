//! Named queries: bundled queries, and the user's queries in the subfolder `queries` of the configuration folder.
//!
//! Comments at the start of a file describe the query, one per line:
//!
//! ```text
//! -- title: Retention by cohort
//! -- what: One sentence that describes the result.
//! -- chart: line x y [y …]
//! ```
//!
//! The `chart` line is optional. The named columns are then drawn as a `line` or `bar` chart.

use std::path::PathBuf;

use super::configuration::Configuration;
use crate::error::RunError;
use crate::files::{create_folder, write_atomically};
use novamind_base::similar_names;

const QUERIES_FOLDER: &str = "queries";

const MAX_NAME_CHARACTERS: usize = 60;

macro_rules! bundled_queries {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../assets/queries/", $name, ".sql")))),*]
    };
}

const BUNDLED_QUERIES: [(&str, &str); 48] = bundled_queries![
    "cash-by-week",
    "ledger-by-category",
    "costs-by-week",
    "cost-of-a-unit",
    "revenue-by-plan",
    "revenue-by-group",
    "prices-paid",
    "discounts-given",
    "biggest-accounts",
    "billing-waves",
    "in-app-ads",
    "growth-by-week",
    "acquisition-by-source",
    "cost-per-first-bill",
    "cost-per-lead",
    "advertising-and-growth",
    "leads-by-week-and-source",
    "choices-of-new-leads",
    "lost-leads",
    "retention-by-cohort",
    "retention-by-plan",
    "churn-by-tenure",
    "leavers-by-group",
    "issues-of-leavers",
    "usage-against-quota",
    "usage-by-group",
    "capacity-headroom",
    "service-by-week",
    "outage-days",
    "ageing-of-issues",
    "support-wait",
    "repeated-issues",
    "deal-outcomes",
    "first-offers",
    "deals-by-week",
    "negotiation-length",
    "companies-by-group",
    "companies-by-industry",
    "research-log",
    "forecast-error",
    "forecast-record",
    "our-posts",
    "public-talk",
    "economy",
    "what-we-know-of-groups",
    "prices-and-settings",
    "targeted-settings",
    "notices",
];

/// Kind of a query chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChartKind {
    /// Line chart with the x column as its axis.
    Line,
    /// Bar chart with one bar per row.
    Bar,
}

/// A chart of a query result: the kind of the chart and its column names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChartSpec {
    /// Whether lines or bars are drawn.
    pub kind: ChartKind,
    /// Name of the column for the x axis.
    pub x_column: String,
    /// Names of the drawn columns; at least one.
    pub y_columns: Vec<String>,
}

/// The fields in the leading comments of a statement.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct QueryHeader {
    /// Text of the `title` comment.
    pub title: Option<String>,
    /// Text of the `what` comment, which describes the query result.
    pub description: Option<String>,
    /// Chart of the `chart` comment; `None` if the comment is missing or invalid.
    pub chart: Option<ChartSpec>,
}

/// A named query.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedQuery {
    /// Name of the query file, without the extension.
    pub name: String,
    /// Text of the `title` comment, or the name with spaces if there is no title.
    pub title: String,
    /// Text of the `what` comment, which describes the query result; may be empty.
    pub description: String,
    /// SQL statement with its leading comments.
    pub sql: String,
    /// Whether the query is a file of the user.
    pub is_user_query: bool,
}

/// All named queries, in the order in which they are listed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QueryLibrary(Vec<NamedQuery>);

impl QueryHeader {
    /// Parses the leading comments of an SQL statement.
    pub fn parse(sql: &str) -> QueryHeader {
        let mut head = QueryHeader::default();
        for line in header_lines(sql) {
            let Some((word, value)) = line.trim_start_matches('-').split_once(':') else { continue };
            let value = value.trim();
            match word.trim() {
                "title" if !value.is_empty() => head.title = Some(value.to_owned()),
                "what" if !value.is_empty() => head.description = Some(value.to_owned()),
                "chart" => head.chart = ChartSpec::parse(value),
                _ => {}
            }
        }
        head
    }
}

/// Returns an SQL statement without its leading comments.
pub fn strip_header(sql: &str) -> &str {
    let head = header_lines(sql).count();
    sql.splitn(head + 1, '\n').nth(head).unwrap_or("")
}

fn header_lines(sql: &str) -> impl Iterator<Item = &str> {
    sql.lines().map(str::trim).take_while(|line| line.is_empty() || line.starts_with("--"))
}

impl ChartSpec {
    fn parse(text: &str) -> Option<ChartSpec> {
        let mut words = text.split_whitespace().map(str::to_owned);
        let kind = match words.next()?.as_str() {
            "line" => ChartKind::Line,
            "bar" => ChartKind::Bar,
            _ => return None,
        };
        let (x, ys) = (words.next()?, words.collect::<Vec<_>>());
        (!ys.is_empty()).then_some(ChartSpec { kind, x_column: x, y_columns: ys })
    }
}

impl NamedQuery {
    fn parse(name: &str, text: &str, is_user_query: bool) -> NamedQuery {
        let head = QueryHeader::parse(text);
        NamedQuery {
            name: name.to_owned(),
            title: head.title.unwrap_or_else(|| name.replace(['-', '_'], " ")),
            description: head.description.unwrap_or_default(),
            sql: text.trim().to_owned(),
            is_user_query,
        }
    }

    /// Returns the statement without its leading comments.
    pub fn body(&self) -> &str {
        strip_header(&self.sql)
    }
}

impl QueryLibrary {
    /// Returns the bundled queries.
    pub fn bundled() -> QueryLibrary {
        QueryLibrary(
            BUNDLED_QUERIES.iter().map(|(name, text)| NamedQuery::parse(name, text, false)).collect(),
        )
    }

    /// Loads the user's queries, then the bundled queries. A user's query replaces the bundled query of the same name.
    /// If a file cannot be read, its query has the error message as description.
    pub fn load(configuration: &Configuration) -> QueryLibrary {
        let load_query = |name: String| match configuration.read_file(format!("{QUERIES_FOLDER}/{name}.sql"))
        {
            Ok(source) => source.map(|source| NamedQuery::parse(&name, &source.text, true)),
            Err(error) => {
                Some(NamedQuery { description: error.to_string(), ..NamedQuery::parse(&name, "", true) })
            }
        };
        let mut all: Vec<NamedQuery> =
            configuration.file_names(QUERIES_FOLDER, ".sql").into_iter().filter_map(load_query).collect();
        for bundled in QueryLibrary::bundled().0 {
            if all.iter().all(|named_query| named_query.name != bundled.name) {
                all.push(bundled);
            }
        }
        QueryLibrary(all)
    }

    /// Returns the queries: the user's queries, then the bundled queries.
    pub fn queries(&self) -> &[NamedQuery] {
        &self.0
    }

    /// Returns the query with this name, if it exists.
    pub fn find(&self, name: &str) -> Option<&NamedQuery> {
        self.0.iter().find(|query| query.name == name)
    }

    /// Returns the query names that are similar to an unknown name.
    pub fn similar_names(&self, name: &str) -> Vec<&str> {
        similar_names(name, self.0.iter().map(|query| query.name.as_str()))
    }
}

/// Converts a typed query name to a file name: spaces become hyphens. Returns `None` if the name is too long or has
/// characters other than letters, digits, `-` and `_`.
pub fn to_file_name(typed: &str) -> Option<String> {
    let name = typed.split_whitespace().collect::<Vec<_>>().join("-").to_lowercase();
    let fits = |letter: char| letter.is_alphanumeric() || matches!(letter, '-' | '_');
    (!name.is_empty() && name.len() <= MAX_NAME_CHARACTERS && name.chars().all(fits)).then_some(name)
}

/// Saves a query of the user and returns the path of its file. Replaces a query with the same name. Adds a title
/// comment if the statement has no title.
///
/// # Errors
/// There is no configuration folder, or the file cannot be written.
pub fn save_query(
    configuration: &Configuration,
    name: &str,
    title: &str,
    sql: &str,
) -> Result<PathBuf, RunError> {
    let folder = configuration.folder.clone().unwrap_or_default().join(QUERIES_FOLDER);
    create_folder(&folder)?;
    let path = folder.join(format!("{name}.sql"));
    let head = match QueryHeader::parse(sql).title {
        Some(_) => String::new(),
        None => format!("-- title: {}\n", title.trim()),
    };
    write_atomically(&path, format!("{head}{}\n", sql.trim()).as_bytes())?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn header_comments_are_parsed() {
        let sql = "-- title: A b\n--what:  c: d.\n\n-- chart: bar x y z\nSELECT 1 -- title: no\n-- what: no";
        let head = QueryHeader::parse(sql);
        assert_eq!((head.title.as_deref(), head.description.as_deref()), (Some("A b"), Some("c: d.")));
        let chart = head.chart.expect("a chart");
        assert_eq!(
            (chart.kind, chart.x_column.as_str(), chart.y_columns.join(" ")),
            (ChartKind::Bar, "x", "y z".to_owned())
        );
        assert_eq!(QueryHeader::parse("SELECT 1"), QueryHeader::default());
        for wrong in ["pie x y", "line x", "line", ""] {
            assert_eq!(ChartSpec::parse(wrong), None, "{wrong}");
        }
        assert_eq!(NamedQuery::parse("x", sql, false).body(), "SELECT 1 -- title: no\n-- what: no");
        assert_eq!(NamedQuery::parse("x", "-- only", false).body(), "");
    }

    #[test]
    fn to_file_name_rejects_other_characters() {
        assert_eq!(to_file_name("  My best  Query_2 ").as_deref(), Some("my-best-query_2"));
        for wrong in ["", "  ", "../x", "a.b", "a/b", "a\u{0}b", &"x".repeat(61)] {
            assert_eq!(to_file_name(wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn user_queries_are_saved_and_take_precedence() {
        let folder = tempfile::tempdir().expect("a folder");
        let configuration = Configuration { folder: Some(folder.path().join("not-yet")), voice: None };
        assert_eq!(QueryLibrary::load(&configuration), QueryLibrary::bundled());
        save_query(&configuration, "mine", "Mine!", "SELECT 1").expect("saved");
        save_query(&configuration, "economy", "x", "-- title: Other\nSELECT 2").expect("saved");
        save_query(&configuration, "mine", "Mine!", "SELECT 3").expect("saved again");
        let library = QueryLibrary::load(&configuration);
        assert_eq!(library.queries().len(), BUNDLED_QUERIES.len() + 1);
        let mine = library.find("mine").expect("saved");
        assert_eq!((mine.title.as_str(), mine.body(), mine.is_user_query), ("Mine!", "SELECT 3", true));
        assert_eq!(library.find("economy").map(|named_query| named_query.title.as_str()), Some("Other"));
        assert_eq!(library.queries()[0].name, "economy", "user queries come first, by name");
        assert_eq!(library.similar_names("econmy"), ["economy"]);
    }

    #[test]
    fn unreadable_query_files_are_listed_with_the_error() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::create_dir(folder.path().join("queries")).expect("a folder");
        std::fs::write(folder.path().join("queries/broken.sql"), [0xff, 0xfe]).expect("a file");
        let library =
            QueryLibrary::load(&Configuration { folder: Some(folder.path().to_owned()), voice: None });
        let broken = library.find("broken").expect("it is listed");
        assert!(broken.description.contains("broken.sql") && broken.sql.is_empty(), "{broken:?}");
    }
}
