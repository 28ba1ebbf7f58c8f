//! Reports on all distributions, and on one distribution with its histogram.

use super::distribution::{DrawDistribution, Moments};
use super::histogram::Histogram;
use super::world_draw::{DrawContext, WorldDraw};
use super::world_draws;
use crate::lab_report::{
    AxisScale, CellValue, Column, Graph, GraphAxis, GraphForm, LabReport, LabTable, Measure, Series,
};
use novamind_base::formatting::grouped_number;
use novamind_base::statistics::SampleStatistics;
use novamind_report::plot::SPARKLINE_CHARS;

const HISTOGRAM_BINS: usize = 40;
/// Width of a small histogram, in characters.
const SMALL_HISTOGRAM_WIDTH: usize = 12;

/// Returns a report on all random draws, each drawn `draws` times for the first member of its family.
pub fn all_distributions_report(context: &DrawContext, draws: u64) -> LabReport {
    let columns = vec![
        Column::text("name", "name"),
        Column::text("law", "law"),
        Column::text("histogram", "draws"),
        Column::number("mean", "mean", Measure::Number(4)),
        Column::number("exact_mean", "exact", Measure::Number(4)),
        Column::number("std", "sd", Measure::Number(4)),
        Column::number("exact_std", "exact", Measure::Number(4)),
    ];
    let mut table = LabTable::new("laws", "Moments of the draws and exact moments", columns);
    let columns = ["name", "parameters", "source"].map(|name| Column::text(name, name));
    let mut sources = LabTable::new("parameters", "Parameters and their sources", columns.into());
    for world_draw in world_draws() {
        let Some((member, name)) = world_draw.family.members(&context.params).into_iter().next() else {
            continue;
        };
        let (draw_distribution, drawn) =
            ((world_draw.distribution)(&context.params, member), world_draw.draws(context, member, draws));
        let (sample, exact) = (SampleStatistics::from_values(&drawn), draw_distribution.moments());
        let shown =
            if name.is_empty() { world_draw.name.to_owned() } else { format!("{} {name}", world_draw.name) };
        let number =
            |value: f64| CellValue::NumberWithMeasure(value, Measure::Number(decimals_for_spread(exact.std)));
        table.rows.push(vec![
            CellValue::text(&shown),
            CellValue::text(draw_distribution.name()),
            CellValue::text(small_histogram(&Histogram::from_draws(&drawn, SMALL_HISTOGRAM_WIDTH))),
            number(sample.mean),
            number(exact.mean),
            number(sample.std),
            number(exact.std),
        ]);
        sources.rows.push(vec![
            CellValue::text(shown),
            CellValue::text(draw_distribution.describe_parameters()),
            CellValue::text(describe_source(world_draw)),
        ]);
    }
    let mut exhibit = LabReport::with_table(
        format!("Every distribution of the simulator, {} draws of each", grouped_number(draws as f64, 0)),
        table,
    );
    exhibit.tables.push(sources);
    exhibit
        .with_note("Draws use the simulator's functions; exact moments follow from the distribution. `lab distributions NAME` shows one draw with its histogram; `--of MEMBER` selects another group or tier.")
        .with_note("Two more random streams choose only texts: the wording of a post and the name of its author.")
}

/// Returns the number of decimals that shows three digits of a standard deviation.
fn decimals_for_spread(spread: f64) -> usize {
    if spread > 0.0 { (2.0 - libm::floor(libm::log10(spread))).clamp(0.0, 9.0) as usize } else { 2 }
}

/// Describes the parameters of a draw and the source files that contain it.
fn describe_source(world_draw: &WorldDraw) -> String {
    let mut files: Vec<&str> = world_draw.source_files.iter().map(|(file, _)| *file).collect();
    files.dedup();
    let keys = world_draw.parameters.join(", ");
    if keys.is_empty() { files.join(", ") } else { format!("{keys} ({})", files.join(", ")) }
}

fn small_histogram(histogram: &Histogram) -> String {
    let max = histogram.counts.iter().copied().max().unwrap_or(0).max(1);
    let level = |count: &u64| SPARKLINE_CHARS[((count * 7).div_ceil(max)).min(7) as usize];
    histogram.counts.iter().map(level).collect()
}

/// Returns a report on one draw for a member of its family: histogram, sample moments, exact moments and moments of
/// reference draws.
pub fn distribution_report(
    world_draw: &WorldDraw,
    (member, name): (usize, &str),
    context: &DrawContext,
    draws: u64,
) -> LabReport {
    let distribution = (world_draw.distribution)(&context.params, member);
    let drawn = world_draw.draws(context, member, draws);
    let columns = vec![
        Column::text("who", "source"),
        Column::number("draws", "draws", Measure::Count),
        Column::number("mean", "mean", Measure::Number(5)),
        Column::number("std", "sd", Measure::Number(5)),
        Column::number("mean_error", "error of mean, standard errors", Measure::Number(2)),
        Column::number("least", "least", Measure::Number(4)),
        Column::number("most", "most", Measure::Number(4)),
    ];
    let mut table = LabTable::new("moments", "", columns);
    table.rows.push(moment_row("simulator", &drawn, &distribution));
    table.rows.push(moment_row("rand_distr", &distribution.reference_draws(draws), &distribution));
    let Moments { mean, std } = distribution.moments();
    let exact =
        [CellValue::text("exact"), CellValue::Missing, CellValue::number(mean), CellValue::number(std)];
    table.rows.push(
        exact.into_iter().chain([CellValue::Missing, CellValue::Missing, CellValue::Missing]).collect(),
    );
    let of = if name.is_empty() { String::new() } else { format!(" of {name}") };
    let mut exhibit =
        LabReport::with_table(format!("{}{of}: {}", world_draw.name, world_draw.description), table);
    exhibit.graphs.push(histogram_graph(world_draw, &Histogram::from_draws(&drawn, HISTOGRAM_BINS)));
    exhibit.notes.push(format!(
        "Distribution: {}, {}.",
        distribution.name(),
        distribution.describe_parameters()
    ));
    exhibit.notes.push(format!("Parameters: {}.", describe_source(world_draw)));
    let members: Vec<String> = world_draw
        .family
        .members(&context.params)
        .into_iter()
        .map(|(_, name)| name)
        .filter(|name| !name.is_empty())
        .collect();
    if !members.is_empty() {
        exhibit.notes.push(format!("Possible values of --of: {}.", members.join(", ")));
    }
    exhibit
}

fn moment_row(who: &str, drawn: &[f64], distribution: &DrawDistribution) -> Vec<CellValue> {
    let (sample, exact) = (SampleStatistics::from_values(drawn), distribution.moments());
    let error = exact.std / (sample.count.max(1) as f64).sqrt();
    let off = (error > 0.0).then(|| (sample.mean - exact.mean) / error);
    vec![
        CellValue::text(who),
        CellValue::number(sample.count as f64),
        CellValue::number(sample.mean),
        CellValue::number(sample.std),
        CellValue::number(off),
        CellValue::number(drawn.iter().copied().fold(f64::INFINITY, f64::min)),
        CellValue::number(drawn.iter().copied().fold(f64::NEG_INFINITY, f64::max)),
    ]
}

fn histogram_graph(world_draw: &WorldDraw, histogram: &Histogram) -> Graph {
    let points = (0..histogram.counts.len())
        .map(|bin| (histogram.bin_center(bin), histogram.counts[bin] as f64))
        .collect();
    Graph {
        title: format!("Draws of {}", world_draw.name),
        summary: format!(
            "Histogram of {}; the outer bars include the extreme thousandths",
            world_draw.description
        ),
        x_axis: GraphAxis { label: "value", scale: AxisScale::Linear },
        y_axis: GraphAxis { label: "draws", scale: AxisScale::Linear },
        series: vec![Series { name: "draws".to_owned(), points }],
        form: GraphForm::Bars,
    }
}
