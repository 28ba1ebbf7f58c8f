//! `novamind lab study` and `novamind lab merge`: large studies, whole or in shards.

use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use clap::Args;

use super::experiments::{PlayOptions, run_experiment_part};
use super::output::OutputOptions;
use crate::cli::output_file::{is_same_file, write_file};
use crate::cli::runs::to_csv;
use crate::cli::{Context, Failure, print};
use crate::lab::study::{
    Shard, ShardHeader, ShardSet, StudyPlan, column_names, describe_size, equal_arm_warnings,
    equal_outcome_warnings, parse_shard, rows, study_summary,
};
use crate::report::pluralize;

#[derive(Debug, Args)]
pub struct Options {
    /// File with policies, scenarios, overrides and seeds
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Write one row per run and day instead of one row per run
    #[arg(long)]
    daily: bool,
    /// Play only this shard, for example 2/4; all shards together make up the study
    #[arg(long, value_name = "I/N", value_parser = parse_shard, requires = "out", conflicts_with_all = ["json", "csv", "svg"])]
    shard: Option<Shard>,
    /// File for the rows; the terminal then shows a summary of the arms [default: standard output]. With --shard:
    /// folder for all shards
    #[arg(long, value_name = "PATH")]
    out: Option<PathBuf>,
    /// Show the runs that would be played, without playing them
    #[arg(long, conflicts_with_all = ["shard", "out", "json", "csv", "svg"])]
    check: bool,
    #[command(flatten)]
    play: PlayOptions,
    #[command(flatten)]
    output: OutputOptions,
}

#[derive(Debug, Args)]
pub struct MergeOptions {
    /// Shards of one study, or folders that contain shards
    #[arg(required = true, value_name = "DIR|FILE")]
    shards: Vec<PathBuf>,
    /// File for the rows [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Runs `lab study`.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let plan = StudyPlan::read(&options.file, options.daily, &context.configuration)
        .map_err(|error| Failure::unreadable(error.to_string()))?;
    let runs = plan.experiment.arms.len() * plan.experiment.seeds.len();
    check_output_paths(options)?;
    print_warnings(&equal_arm_warnings(&plan, &context.configuration)?);
    if options.check {
        return print(&format!(
            "{}: {}, {}\n",
            plan.name,
            describe_size(&plan),
            pluralize(runs as u32, "run")
        ));
    }
    let digest = plan.digest(&context.configuration)?;
    let part = options.shard.unwrap_or(Shard { shard: 1, of: 1 });
    if let (Some(_), Some(folder)) = (options.shard, &options.out) {
        // Report an unwritable folder now rather than after hours of play.
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::failed(format!("{}: {error}", folder.display())))?;
    }
    let numbers = part.run_numbers(runs);
    let kept = results_file(context, &plan, &digest, options.shard)?;
    let results = run_experiment_part(&kept, &plan.experiment, &numbers, &options.play, context)?;
    let mut text = to_csv(&[column_names(&plan)])?;
    for (number, result) in numbers.iter().zip(&results) {
        text += &to_csv(&rows(&plan, *number, result))?;
    }
    let kept = "the finished runs are saved; repeat the command to continue";
    match (&options.out, options.shard) {
        (None, _) if options.output.prints_rows() => {
            print_warnings(&equal_outcome_warnings(&plan, &results));
            print(&text)
        }
        (None, _) => options.output.show(&study_summary(&plan, &results)),
        (Some(file), None) => {
            write_file(file, Some(kept), |out| out.write_all(text.as_bytes()))?;
            options.output.show(&study_summary(&plan, &results))
        }
        (Some(folder), Some(part)) => {
            let file = folder.join(ShardHeader::file_name(&plan.name, part));
            text = ShardHeader::with_checksum(&plan.name, &digest, part, &text);
            write_file(&file, Some(kept), |out| out.write_all(text.as_bytes()))?;
            print(&format!(
                "shard {part}: {} in {}\n",
                pluralize(numbers.len() as u32, "run"),
                file.display()
            ))
        }
    }
}

fn print_warnings(warnings: &[String]) {
    warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
}

/// Checks that no output replaces the study file or another output.
fn check_output_paths(options: &Options) -> Result<(), Failure> {
    let graphs = options.output.graph_file();
    for (name, place) in [("--out", options.out.as_deref()), ("--svg", graphs)] {
        if place.is_some_and(|place| is_same_file(place, &options.file)) {
            let problem = format!("{name} is the study file itself, which would be overwritten");
            return Err(Failure::usage(problem));
        }
    }
    match (&options.out, graphs) {
        (Some(rows), Some(graphs)) if is_same_file(rows, graphs) => {
            Err(Failure::usage("--out and --svg name the same file: give two different files"))
        }
        _ => Ok(()),
    }
}

/// Returns the path of the file that caches the results of a study or shard. Programs that play different
/// shards at the same time use different files.
fn results_file(
    context: &Context,
    plan: &StudyPlan,
    digest: &str,
    shard: Option<Shard>,
) -> Result<PathBuf, Failure> {
    let part = shard.map_or(String::new(), |shard| format!(".{}-of-{}", shard.shard, shard.of));
    Ok(context.laboratory_folder()?.join("studies").join(format!(
        "{}.{}{part}.jsonl",
        plan.name,
        &digest[..12]
    )))
}

/// Runs `lab merge`.
pub fn merge_shards(options: &MergeOptions) -> Result<(), Failure> {
    let shards = ShardSet::find(&options.shards).map_err(|error| Failure::failed(error.to_string()))?;
    match &options.out {
        Some(file) if shards.files().iter().any(|shard| is_same_file(shard, file)) => Err(Failure::usage(
            format!("{} is one of the shards, which would be overwritten", file.display()),
        )),
        Some(file) => write_file(file, Some("the shards are unchanged"), |out| shards.write(out)),
        None => {
            let mut out = BufWriter::new(io::stdout().lock());
            match shards.write(&mut out).and_then(|()| out.flush()) {
                Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Err(Failure::broken_pipe()),
                Err(error) => Err(Failure::failed(error.to_string())),
                Ok(()) => Ok(()),
            }
        }
    }
}
