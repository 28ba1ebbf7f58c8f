//! Comparison of runs with the golden figures of the released simulator (docs/interfaces/golden.md).

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::metrics::MetricValue;
use novamind_base::statistics::{SampleStatistics, median};

/// The key of a compared cell: figure, group, checkpoint day.
type CellKey = (String, String, u32);

/// The golden figures of the released simulator under one policy.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReferenceFigures {
    /// Name of the policy.
    pub policy: String,
    /// Mean, standard deviation and number of seeds, by cell.
    pub cells: BTreeMap<CellKey, SampleStatistics>,
    /// Values of all seeds, by cell; empty if the reference does not contain these values. Figures that are compared as
    /// logarithms need them.
    per_seed: BTreeMap<CellKey, Vec<f64>>,
}

/// The reason why reference figures cannot be read.
#[derive(Debug)]
pub struct GoldenError {
    path: PathBuf,
    problem: String,
}

impl fmt::Display for GoldenError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {}", self.path.display(), self.problem)
    }
}

impl std::error::Error for GoldenError {}

/// Figures with compound growth, which are compared as ln(1 + x).
const LOG_COMPARED_FIGURES: [&str; 17] = [
    "subs",
    "subs_total",
    "individual_subs",
    "plan_subs",
    "leads_cum",
    "leads_expected_cum",
    "network_leads_cum",
    "new_leads_cum",
    "new_leads_m30",
    "new_individual_leads_cum",
    "new_subs_cum",
    "new_individual_subscribers_cum",
    "total_usage_cum",
    "total_usage_m30",
    "payments_received_cum",
    "mrr",
    "lost_leads_cum",
];

/// Figures that are shown but excluded from the verdict. The satisfaction of churned authors differs by design.
const EXCLUDED_FIGURES: [&str; 1] = ["posts_customer_cum"];

/// Minimum number of seeds that a compared cell must have.
const MIN_SEEDS: usize = 5;

impl ReferenceFigures {
    /// Returns the last checkpoint day of the reference.
    pub fn last_day(&self) -> u32 {
        self.cells.keys().map(|(_, _, day)| *day).max().unwrap_or(0)
    }

    /// Returns the checkpoint days of the reference, in ascending order.
    pub fn days(&self) -> Vec<u32> {
        let days: BTreeSet<u32> = self.cells.keys().map(|(_, _, day)| *day).collect();
        days.into_iter().collect()
    }
}

/// Reads the reference figures of a policy: `<policy>.csv` from a folder, and `per_seed/<policy>.csv` if it exists.
///
/// # Errors
/// Fails if the policy's file is missing or is not a table of figures.
pub fn read_reference(folder: &Path, policy: &str) -> Result<ReferenceFigures, GoldenError> {
    let path = folder.join(format!("{policy}.csv"));
    let mut reference = ReferenceFigures { policy: policy.to_owned(), ..ReferenceFigures::default() };
    for row in read_table(&path, &["figure", "group", "day", "n_seeds", "mean", "std"])? {
        let [figure, group, day, seeds, mean, std] = row;
        let number = |text: &str| text.parse::<f64>().ok();
        let parsed = (day.parse().ok(), seeds.parse().ok(), number(&mean), number(&std).or(Some(0.0)));
        let (Some(day), Some(count), Some(mean), Some(std)) = parsed else {
            return Err(GoldenError {
                path,
                problem: format!("{figure} {group} {day} is not a row of figures"),
            });
        };
        reference.cells.insert((figure, group, day), SampleStatistics { count, mean, std });
    }
    let path = folder.join("per_seed").join(format!("{policy}.csv"));
    if path.exists() {
        for row in read_table(&path, &["figure", "group", "day", "value"])? {
            let [figure, group, day, value] = row;
            if let (Ok(day), Ok(value)) = (day.parse(), value.parse()) {
                reference.per_seed.entry((figure, group, day)).or_default().push(value);
            }
        }
    }
    Ok(reference)
}

/// File in a reference folder that contains facts about the whole reference.
const REFERENCE_FILE: &str = "reference.toml";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ReferenceFile {
    /// Scenario that reproduces the measured release.
    scenario: String,
}

/// Returns the scenario that a reference folder's `reference.toml` names, or `None` if the folder has no such file.
///
/// # Errors
/// Fails if the file cannot be read or is invalid.
pub fn read_reference_scenario(folder: &Path) -> Result<Option<String>, GoldenError> {
    let path = folder.join(REFERENCE_FILE);
    if !path.exists() {
        return Ok(None);
    }
    let wrong = |problem: String| GoldenError { path: path.clone(), problem };
    let text = std::fs::read_to_string(&path).map_err(|error| wrong(error.to_string()))?;
    let file: ReferenceFile = toml::from_str(&text).map_err(|error| wrong(error.message().to_owned()))?;
    Ok(Some(file.scenario))
}

fn read_table<const WIDTH: usize>(
    path: &Path,
    columns: &[&str; WIDTH],
) -> Result<Vec<[String; WIDTH]>, GoldenError> {
    let wrong = |problem: String| GoldenError { path: path.to_owned(), problem };
    let mut reader = csv::Reader::from_path(path).map_err(|error| wrong(error.to_string()))?;
    let headers = reader.headers().map_err(|error| wrong(error.to_string()))?.clone();
    let mut places = [0; WIDTH];
    for (place, column) in places.iter_mut().zip(columns) {
        let found = headers.iter().position(|header| header == *column);
        *place = found.ok_or_else(|| wrong(format!("column {column} is missing")))?;
    }
    let rows = reader.records().map(|record| {
        let record = record.map_err(|error| wrong(error.to_string()))?;
        Ok(places.map(|place| record.get(place).unwrap_or_default().to_owned()))
    });
    rows.collect()
}

/// A compared cell: one figure of a group on a checkpoint day.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedCell {
    /// Name of the figure, as listed in docs/interfaces/golden.md#figures.
    pub figure: String,
    /// Group of the figure; empty for the whole company.
    pub group: String,
    /// Checkpoint day of the cell.
    pub day: u32,
    /// Statistics of the figure in the reference.
    pub reference: SampleStatistics,
    /// Statistics of the figure in the new runs.
    pub measured: SampleStatistics,
    /// Difference between the two means, in standard errors.
    pub z: f64,
}

/// The comparison of new runs with the reference under one policy.
#[derive(Debug, Clone, PartialEq)]
pub struct GoldenComparison {
    /// Name of the policy.
    pub policy: String,
    /// Cells that are included in the verdict.
    pub cells: Vec<ComparedCell>,
    /// Cells that are shown but excluded from the verdict.
    pub excluded: Vec<ComparedCell>,
    /// Reference figures that are missing in the new runs.
    pub missing: Vec<String>,
}

/// Compares new runs with a reference. `runs` contains the figures of each seed.
pub fn compare_with_reference(reference: &ReferenceFigures, runs: &[Vec<MetricValue>]) -> GoldenComparison {
    let mut values_by_cell: BTreeMap<(&str, &str, u32), Vec<f64>> = BTreeMap::new();
    for figure in runs.iter().flatten() {
        values_by_cell.entry((figure.figure, figure.group, figure.day)).or_default().push(figure.value);
    }
    let mut comparison = GoldenComparison {
        policy: reference.policy.clone(),
        cells: vec![],
        excluded: vec![],
        missing: vec![],
    };
    let mut missing = BTreeSet::new();
    let countable = reference.cells.iter().filter(|(_, sample)| sample.count >= MIN_SEEDS);
    for (cell @ (figure, group, day), sample) in countable {
        let Some(values) = values_by_cell.get(&(figure.as_str(), group.as_str(), *day)) else {
            let known = values_by_cell.keys().any(|(text, split, _)| text == figure && split == group);
            if !known {
                missing.insert(if group.is_empty() { figure.clone() } else { format!("{figure} {group}") });
            }
            continue;
        };
        let logarithms =
            LOG_COMPARED_FIGURES.contains(&figure.as_str()).then(|| reference.per_seed.get(cell)).flatten();
        let (sample_statistics, statistics) = match logarithms {
            Some(singles) => (
                SampleStatistics::from_values(&log1p_values(singles)),
                SampleStatistics::from_values(&log1p_values(values)),
            ),
            None => (*sample, SampleStatistics::from_values(values)),
        };
        let compared = ComparedCell {
            figure: figure.clone(),
            group: group.clone(),
            day: *day,
            reference: *sample,
            measured: SampleStatistics::from_values(values),
            z: z_score(&sample_statistics, &statistics),
        };
        if EXCLUDED_FIGURES.contains(&figure.as_str()) {
            comparison.excluded.push(compared);
        } else {
            comparison.cells.push(compared);
        }
    }
    comparison.missing = missing.into_iter().collect();
    comparison
}

fn log1p_values(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| libm::log1p(value.max(0.0))).collect()
}

/// Returns the difference of two means in standard errors. Returns 0 if the relative difference is at most a
/// millionth. Otherwise returns ±99 if neither sample varies.
fn z_score(reference: &SampleStatistics, sample_statistics: &SampleStatistics) -> f64 {
    let difference = sample_statistics.mean - reference.mean;
    if difference.abs() < 1e-9 + 1e-6 * reference.mean.abs() {
        return 0.0;
    }
    let variance = |sample: &SampleStatistics| sample.std * sample.std / sample.count.max(1) as f64;
    let error = (variance(reference) + variance(sample_statistics)).sqrt();
    if error == 0.0 { 99.0f64.copysign(difference) } else { difference / error }
}

impl GoldenComparison {
    /// Returns the share of cells whose |z| is below a bound.
    pub fn share_below(&self, bound: f64) -> f64 {
        let below = self.cells.iter().filter(|cell| cell.z.abs() < bound).count();
        below as f64 / self.cells.len().max(1) as f64
    }

    /// Returns the figures with at least five cells and |median z| above 3.5, each with its median z.
    pub fn suspect_figures(&self) -> Vec<(String, f64)> {
        let mut by_figure: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        self.cells.iter().for_each(|cell| by_figure.entry(&cell.figure).or_default().push(cell.z));
        by_figure
            .into_iter()
            .filter(|(_, scores)| scores.len() >= 5)
            .filter_map(|(figure, scores)| Some((figure.to_owned(), median(&scores)?)))
            .filter(|(_, middle)| middle.abs() > 3.5)
            .collect()
    }

    /// Returns a line of text for each figure, with the number of cells, the median z and the cell with the
    /// largest |z|.
    pub fn figure_lines(&self) -> Vec<String> {
        let mut by_figure: BTreeMap<&str, Vec<&ComparedCell>> = BTreeMap::new();
        self.cells.iter().for_each(|cell| by_figure.entry(&cell.figure).or_default().push(cell));
        let line = |(figure, cells): (&str, Vec<&ComparedCell>)| {
            let scores: Vec<f64> = cells.iter().map(|cell| cell.z).collect();
            let worst = cells.iter().max_by(|left, right| left.z.abs().total_cmp(&right.z.abs()))?;
            let middle = median(&scores)?;
            let (mean, error, value) = (worst.reference.mean, worst.standard_error(), worst.measured.mean);
            let place = format!("{} day {}", worst.group, worst.day);
            Some(format!(
                "{figure:<32} {:>3} cells  median z {middle:>6.2}  worst {:>6.2} ({}: {mean:.4} \u{b1} {error:.4}, measured {value:.4})",
                cells.len(),
                worst.z,
                place.trim_start()
            ))
        };
        by_figure.into_iter().filter_map(line).collect()
    }

    /// Returns the `count` cells with the largest |z|.
    pub fn most_different(&self, count: usize) -> Vec<&ComparedCell> {
        let mut cells: Vec<&ComparedCell> = self.cells.iter().collect();
        cells.sort_by(|left, right| right.z.abs().total_cmp(&left.z.abs()));
        cells.truncate(count);
        cells
    }
}

impl ComparedCell {
    fn standard_error(&self) -> f64 {
        self.reference.std / (self.reference.count.max(1) as f64).sqrt()
    }
}

impl fmt::Display for ComparedCell {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let error = self.standard_error();
        write!(
            formatter,
            "{:<32} {:<18} day {:>3}  {:>16.6} ± {:<14.6} {:>16.6}  z {:>7.2}",
            self.figure, self.group, self.day, self.reference.mean, error, self.measured.mean, self.z
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(mean: f64, std: f64, count: usize) -> SampleStatistics {
        SampleStatistics { count, mean, std }
    }

    #[test]
    fn z_score_is_in_standard_errors() {
        assert_eq!(z_score(&sample(10.0, 2.0, 4), &sample(12.0, 0.0, 24)), 2.0);
        assert_eq!(z_score(&sample(10.0, 0.0, 4), &sample(10.000001, 0.0, 4)), 0.0);
        assert_eq!(z_score(&sample(10.0, 0.0, 4), &sample(9.0, 0.0, 4)), -99.0);
    }

    #[test]
    fn consistent_deviation_is_suspect_and_missing_figures_are_named() {
        let days = [30, 60, 90, 120, 150];
        let mut reference = ReferenceFigures { policy: "x".to_owned(), ..ReferenceFigures::default() };
        for day in days {
            reference.cells.insert(("cash".to_owned(), String::new(), day), sample(100.0, 1.0, 8));
            reference.cells.insert(("mrr".to_owned(), String::new(), day), sample(5.0, 1.0, 8));
            reference.cells.insert(("pmi".to_owned(), String::new(), day), sample(5.0, 1.0, 4));
            reference.cells.insert(("subs".to_owned(), "S1".to_owned(), day), sample(5.0, 1.0, 8));
        }
        let run = |shift: f64| -> Vec<MetricValue> {
            days.iter()
                .flat_map(|&day| {
                    let figure = |figure, value| MetricValue { day, figure, group: "", value };
                    [figure("cash", 103.0 + shift), figure("mrr", 5.0 + shift)]
                })
                .collect()
        };
        let comparison = compare_with_reference(&reference, &[run(-0.5), run(0.5), run(0.0)]);
        assert_eq!(comparison.cells.len(), 10);
        assert_eq!(
            comparison.suspect_figures().iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
            ["cash"]
        );
        assert_eq!(comparison.missing, ["subs S1"]);
        assert_eq!(comparison.share_below(3.0), 0.5);
        assert_eq!(comparison.most_different(1)[0].figure, "cash");
        let lines = comparison.figure_lines();
        assert!(
            lines.len() == 2 && lines[0].starts_with("cash ") && lines[0].contains("5 cells"),
            "{lines:?}"
        );
    }

    #[test]
    fn only_compounding_figures_are_log_compared() {
        // ln(1 + x) is 1 to 5 in the reference and 2 to 6 in the runs. The difference of the means is 1, and the
        // variance of each mean is 2.5 / 5.
        let singles = |first: i32| (first..first + 5).map(|power| libm::expm1(f64::from(power)));
        let mut reference = ReferenceFigures { policy: "x".to_owned(), ..ReferenceFigures::default() };
        for figure in ["subs_total", "cash"] {
            let cell = (figure.to_owned(), String::new(), 30);
            reference.cells.insert(cell.clone(), sample(4.0, 0.0, 5));
            reference.per_seed.insert(cell, singles(1).collect());
        }
        let run = |value: f64| -> Vec<MetricValue> {
            ["subs_total", "cash"].map(|figure| MetricValue { day: 30, figure, group: "", value }).to_vec()
        };
        let comparison = compare_with_reference(&reference, &singles(2).map(run).collect::<Vec<_>>());
        let z = |figure: &str| {
            comparison.cells.iter().find(|cell| cell.figure == figure).expect("it is compared").z
        };
        assert!((z("subs_total") - 1.0).abs() < 1e-12, "{}", z("subs_total"));
        let values: Vec<f64> = singles(2).collect();
        let mean = values.iter().sum::<f64>() / 5.0;
        let variance = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / 4.0;
        assert!((z("cash") - (mean - 4.0) / (variance / 5.0).sqrt()).abs() < 1e-12, "{}", z("cash"));
    }
}
