//! `novamind bench`: measures the speed of the simulator on this machine.

mod console;
#[cfg(feature = "server")]
mod http;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use clap::Args;
use serde_json::{Value, json};

use super::run::progress_bar;
use super::{Context, Failure, print};
use crate::formatting::grouped_number;
use crate::lab::benchmark::{
    BenchCase, BenchContext, BenchFigure, BenchUnit, CASES, Samples, TargetVerdict, calibration_seconds,
};
use crate::statistics::median;

#[derive(Debug, Args)]
pub struct Options {
    /// Number of repetitions; the median is reported
    #[arg(long, default_value = "5", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100))]
    runs: u32,
    /// Measure only this benchmark; can be repeated
    #[arg(long, value_name = "NAME", value_parser = all_cases().map(|case| case.name).collect::<Vec<_>>())]
    only: Vec<String>,
    /// Run one repetition, and skip benchmarks that take minutes
    #[arg(long, conflicts_with = "runs")]
    quick: bool,
    /// Scenario of the measured runs; targets are defined for `default` [default: default]
    #[arg(long, value_name = "NAME")]
    scenario: Option<String>,
    /// Folder for the measured runs [default: the system's temporary folder]
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    /// Measure one benchmark in this process and print its samples.
    #[arg(long, hide = true)]
    measure: bool,
}

fn all_cases() -> impl Iterator<Item = &'static BenchCase> {
    #[cfg(feature = "server")]
    let served = http::CASES;
    #[cfg(not(feature = "server"))]
    let served: &[BenchCase] = &[];
    CASES.iter().chain(console::CASES).chain(served)
}

impl Options {
    fn repetitions(&self) -> usize {
        if self.quick { 1 } else { self.runs as usize }
    }

    fn selected_cases(&self) -> Vec<&'static BenchCase> {
        let named = |case: &&BenchCase| self.only.iter().any(|name| name == case.name);
        let asked_for = |case: &&BenchCase| {
            if self.only.is_empty() { !(self.quick && case.is_slow) } else { named(case) }
        };
        all_cases().filter(asked_for).collect()
    }
}

struct BenchRow {
    case: &'static str,
    figure: &'static BenchFigure,
    samples: Vec<f64>,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    options.scenario.as_ref().map(|name| context.configuration.load_scenario(name)).transpose()?;
    let scratch = ScratchFolder::create(options.folder.as_deref())?;
    let cases = options.selected_cases();
    if options.measure {
        let bench = BenchContext {
            repetitions: options.repetitions(),
            scratch_folder: scratch.0.clone(),
            configuration: context.configuration.clone(),
            scenario: options.scenario.clone(),
        };
        return measure_in_process(&cases, &bench);
    }
    let loops: Vec<f64> = (0..options.repetitions()).map(|_| calibration_seconds()).collect();
    let calibration = median(&loops).unwrap_or(f64::NAN);
    if !options.json {
        print(&report_header(calibration, options.repetitions(), options.scenario.as_deref()))?;
    }
    let progress = progress_bar(cases.len() as u64, "cases");
    let mut rows = Vec::new();
    for case in cases {
        progress.set_message(case.name);
        let measured = measure(case, options, &scratch.0);
        progress.inc(1);
        for (figure, samples) in case.figures.iter().zip(measured?) {
            let row = BenchRow { case: case.name, figure, samples };
            if !options.json {
                progress.suspend(|| print(&format_row(&row, calibration)))?;
            }
            rows.push(row);
        }
    }
    progress.finish_and_clear();
    if options.json {
        print(&(to_json(&rows, calibration, options.scenario.as_deref()) + "\n"))
    } else {
        Ok(())
    }
}

/// A temporary folder that is removed when the value is dropped.
struct ScratchFolder(PathBuf);

impl ScratchFolder {
    fn create(parent: Option<&Path>) -> Result<ScratchFolder, Failure> {
        let parent = parent.map_or_else(std::env::temp_dir, Path::to_owned);
        let folder = parent.join(format!("novamind-bench-{}", std::process::id()));
        std::fs::create_dir_all(&folder)
            .map_err(|error| Failure::failed(format!("{}: {error}", folder.display())))?;
        Ok(ScratchFolder(folder))
    }
}

impl Drop for ScratchFolder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Runs the benchmarks in this process, and prints their samples for the parent process.
fn measure_in_process(cases: &[&BenchCase], bench: &BenchContext) -> Result<(), Failure> {
    for case in cases {
        let samples = (case.measure)(bench).map_err(|error| Failure::failed(error.to_string()))?;
        print(&format!("{}\n", json!(samples)))?;
    }
    Ok(())
}

/// Runs a benchmark in child processes, because peak memory can be measured only for a whole process.
fn measure(case: &BenchCase, options: &Options, scratch: &Path) -> Result<Samples, Failure> {
    let repetitions = options.repetitions();
    let (processes, each) = if case.needs_new_process { (repetitions, 1) } else { (1, repetitions) };
    let mut all: Samples = vec![Vec::new(); case.figures.len()];
    for _ in 0..processes {
        for (samples, more) in
            all.iter_mut().zip(measure_in_child(case, each, options.scenario.as_deref(), scratch)?)
        {
            samples.extend(more);
        }
    }
    Ok(all)
}

fn measure_in_child(
    case: &BenchCase,
    repetitions: usize,
    scenario: Option<&str>,
    scratch: &Path,
) -> Result<Samples, Failure> {
    let failed = |problem: String| Failure::failed(format!("{}: {problem}", case.name));
    let program = std::env::current_exe().map_err(|error| failed(error.to_string()))?;
    let output = Command::new(program)
        .args(["bench", "--measure", "--only", case.name, "--runs", &repetitions.to_string(), "--folder"])
        .arg(scratch)
        .args(scenario.into_iter().flat_map(|name| ["--scenario", name]))
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| failed(error.to_string()))?;
    if !output.status.success() {
        return Err(failed("the measurement failed".to_owned()));
    }
    serde_json::from_slice(&output.stdout).map_err(|error| failed(error.to_string()))
}

fn thread_count() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

fn report_header(calibration: f64, repetitions: usize, scenario: Option<&str>) -> String {
    let scenario = scenario.map_or(String::new(), |name| format!(" · scenario {name}"));
    let repetitions_text =
        if repetitions == 1 { "one repetition".to_owned() } else { format!("medians of {repetitions}") };
    format!(
        "novamind {} · {} threads · {repetitions_text} · calibration loop {calibration:.3} s{scenario}\n\n{:<66} {:>10} {:>9} {:>9}  {:<14} {:>9}\n",
        env!("CARGO_PKG_VERSION"),
        thread_count(),
        "",
        "measured",
        "target",
        "stretch",
        "verdict",
        "/ loop"
    )
}

fn format_row(row: &BenchRow, calibration: f64) -> String {
    let BenchRow { figure, .. } = row;
    let value = median(&row.samples);
    let written =
        |value: Option<f64>| value.map_or_else(String::new, |value| format_value(value, figure.unit));
    let ratio = calibration_ratio(value, figure.unit, calibration)
        .map_or_else(String::new, |ratio| format!("{ratio:.3e}"));
    let text = format!(
        "{:<66} {:>10} {:>9} {:>9}  {:<14} {ratio:>9}",
        figure.name,
        written(value),
        written(figure.target),
        written(figure.stretch),
        figure.verdict(value),
    );
    text.trim_end().to_owned() + "\n"
}

/// Formats a value with its unit, to about three digits.
fn format_value(value: f64, unit: BenchUnit) -> String {
    let decimals = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{} {}", grouped_number(value, decimals), unit.symbol())
}

/// Returns a time divided by the time of the calibration loop.
fn calibration_ratio(value: Option<f64>, unit: BenchUnit, calibration: f64) -> Option<f64> {
    Some(value? * unit.seconds_per_unit()? / calibration)
}

fn to_json(rows: &[BenchRow], calibration: f64, scenario: Option<&str>) -> String {
    let row = |row: &BenchRow| {
        let value = median(&row.samples);
        let verdict: TargetVerdict = row.figure.verdict(value);
        json!({
            "case": row.case,
            "name": row.figure.name,
            "unit": row.figure.unit,
            "measured": value,
            "samples": row.samples,
            "target": row.figure.target,
            "stretch": row.figure.stretch,
            "verdict": verdict,
            "ratio": calibration_ratio(value, row.figure.unit, calibration),
        })
    };
    let all: Vec<Value> = rows.iter().map(row).collect();
    let report = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "threads": thread_count(),
        "scenario": scenario,
        "calibration_seconds": calibration,
        "figures": all,
    });
    serde_json::to_string_pretty(&report).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn format_value_prints_about_three_digits() {
        assert_eq!(format_value(2.345, BenchUnit::Seconds), "2.35 s");
        assert_eq!(format_value(23.45, BenchUnit::Milliseconds), "23.4 ms");
        assert_eq!(format_value(1288.49, BenchUnit::Megabytes), "1,288 MB");
    }

    #[test]
    fn calibration_ratio_is_defined_only_for_times() {
        assert_eq!(calibration_ratio(Some(500.0), BenchUnit::Milliseconds, 0.25), Some(2.0));
        assert_eq!(calibration_ratio(Some(500.0), BenchUnit::Megabytes, 0.25), None);
        assert_eq!(calibration_ratio(None, BenchUnit::Seconds, 0.25), None);
    }
}
