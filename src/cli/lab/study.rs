//! `novamind lab study` and `novamind lab merge`: large studies, whole or in shards.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::Args;

use super::experiments::{PlayOptions, conduct_some};
use super::output::OutputOptions;
use crate::cli::runs::as_csv;
use crate::cli::{Context, Failure, print};
use crate::lab::study::{Shard, ShardHead, Shards, StudyPlan, head, parse_shard, rows, size, summary};
use crate::report::count;

/// Options of `lab study`.
#[derive(Debug, Args)]
pub struct Options {
    /// File that names policies, scenarios, overrides and seeds.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// A row for each run and day, not only for each run.
    #[arg(long)]
    daily: bool,
    /// Play only this part of it, as 2/4; all parts together are the study.
    #[arg(long, value_name = "I/N", value_parser = parse_shard, requires = "out")]
    shard: Option<Shard>,
    /// File of the rows, and the arms are told in the terminal [default: the rows go to standard output]; with --shard, the
    /// folder of all shards.
    #[arg(long, value_name = "PATH")]
    out: Option<PathBuf>,
    /// Tell what would be played, and play nothing.
    #[arg(long, conflicts_with_all = ["shard", "out"])]
    check: bool,
    #[command(flatten)]
    play: PlayOptions,
    #[command(flatten)]
    output: OutputOptions,
}

/// Options of `lab merge`.
#[derive(Debug, Args)]
pub struct MergeOptions {
    /// Shards of one study, or folders of them.
    #[arg(required = true, value_name = "DIR|FILE")]
    shards: Vec<PathBuf>,
    /// File of the rows [default: standard output].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Runs `lab study`.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let plan = StudyPlan::read(&options.file, options.daily, &context.configuration)
        .map_err(|error| Failure::unreadable(error.to_string()))?;
    let runs = plan.experiment.arms.len() * plan.experiment.seeds.len();
    let is_own_file = |out: &PathBuf| {
        out.canonicalize().is_ok_and(|out| options.file.canonicalize().is_ok_and(|file| file == out))
    };
    if options.out.as_ref().is_some_and(is_own_file) {
        return Err(Failure::usage("--out names the study file itself, which the rows would replace"));
    }
    if options.check {
        return print(&format!("{}: {}, {}\n", plan.name, size(&plan), count(runs as u32, "run")));
    }
    let digest = plan.digest(&context.configuration)?;
    let part = options.shard.unwrap_or(Shard { shard: 1, of: 1 });
    if let (Some(_), Some(folder)) = (options.shard, &options.out) {
        // A folder that cannot be written is better known before hours of play than after them.
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::failed(format!("{}: {error}", folder.display())))?;
    }
    let numbers = part.numbers(runs);
    let kept = kept_in(context, &plan, &digest, options.shard)?;
    let results = conduct_some(&kept, &plan.experiment, &numbers, &options.play, context)?;
    let mut text = as_csv(&[head(&plan)])?;
    for (number, result) in numbers.iter().zip(&results) {
        text += &as_csv(&rows(&plan, *number, result))?;
    }
    let kept = "the runs are kept, and the same command goes on";
    match (&options.out, options.shard) {
        (None, _) if options.output.is_of_rows() => print(&text),
        (None, _) => options.output.show(&summary(&plan, &results)),
        (Some(file), None) => {
            write(file, kept, |out| out.write_all(text.as_bytes()))?;
            options.output.show(&summary(&plan, &results))
        }
        (Some(folder), Some(part)) => {
            let file = folder.join(ShardHead::file_name(&plan.name, part));
            text = ShardHead::sealed(&plan.name, &digest, part, &text);
            write(&file, kept, |out| out.write_all(text.as_bytes()))?;
            print(&format!("shard {part}: {} in {}\n", count(numbers.len() as u32, "run"), file.display()))
        }
    }
}

/// The file in which a study, or a shard of it, keeps its runs: one for each program that may write at the same time.
fn kept_in(
    context: &Context,
    plan: &StudyPlan,
    digest: &str,
    shard: Option<Shard>,
) -> Result<PathBuf, Failure> {
    let part = shard.map_or(String::new(), |own| format!(".{}-of-{}", own.shard, own.of));
    Ok(context.laboratory()?.join("studies").join(format!("{}.{}{part}.jsonl", plan.name, &digest[..12])))
}

/// Runs `lab merge`.
pub fn merge(options: &MergeOptions) -> Result<(), Failure> {
    let shards = Shards::of(&options.shards).map_err(|error| Failure::failed(error.to_string()))?;
    match &options.out {
        Some(file) => write(file, "the shards are as they were", |out| shards.write(out)),
        None => {
            let mut out = BufWriter::new(io::stdout().lock());
            match shards.write(&mut out).and_then(|()| out.flush()) {
                Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Err(Failure::quiet()),
                Err(error) => Err(Failure::failed(error.to_string())),
                Ok(()) => Ok(()),
            }
        }
    }
}

/// Writes a file so that it is whole or not there.
fn write(
    place: &Path,
    safe: &str,
    rows: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), Failure> {
    let name = place.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let draft = place.with_file_name(format!(".{name}.draft"));
    // A device or a pipe is written to, and never replaced.
    let is_special = std::fs::metadata(place).is_ok_and(|found| !found.is_file());
    let target = if is_special { place } else { &draft };
    let written = File::create(target).and_then(|file| {
        let mut file = BufWriter::new(file);
        rows(&mut file)?;
        let file = file.into_inner()?;
        if is_special {
            return Ok(());
        }
        file.sync_all()?;
        std::fs::rename(&draft, place)
    });
    written.map_err(|error| {
        let _ = std::fs::remove_file(&draft);
        Failure::failed(format!("{}: {error}; it was not written, {safe}", place.display()))
    })
}
