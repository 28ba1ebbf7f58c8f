//! Table of all distributions, and one distribution with its histogram.

use super::histogram::Histogram;
use super::law::{Law, Moments};
use super::world_draw::{Luck, WorldDraw};
use super::world_draws;
use crate::exhibit::{
    AxisScale, Column, Datum, Exhibit, Graph, GraphAxis, GraphForm, Measure, Series, Tabulation,
};
use novamind_base::notation::grouped;
use novamind_base::statistics::Sample;
use novamind_report::plot::LEVELS;

const BINS: usize = 40;
/// Characters of a small histogram.
const SMALL: usize = 12;

/// Returns all distributions, each drawn `draws` times for the first member of its family.
pub fn all_laws(luck: &Luck, draws: u64) -> Exhibit {
    let columns = vec![
        Column::words("name", "name"),
        Column::words("law", "law"),
        Column::words("histogram", "draws"),
        Column::numbers("mean", "mean", Measure::Number(4)),
        Column::numbers("exact_mean", "exact", Measure::Number(4)),
        Column::numbers("std", "sd", Measure::Number(4)),
        Column::numbers("exact_std", "exact", Measure::Number(4)),
    ];
    let mut laws = Tabulation::new("laws", "Moments of the draws and exact moments", columns);
    let columns = ["name", "parameters", "source"].map(|name| Column::words(name, name));
    let mut sources = Tabulation::new("parameters", "Parameters and their sources", columns.into());
    for own in world_draws() {
        let Some((member, name)) = own.family.members(&luck.params).into_iter().next() else { continue };
        let (law, drawn) = ((own.law)(&luck.params, member), own.draws(luck, member, draws));
        let (sample, exact) = (Sample::of(&drawn), law.moments());
        let shown = if name.is_empty() { own.name.to_owned() } else { format!("{} {name}", own.name) };
        let number = |value: f64| Datum::Measured(value, Measure::Number(decimals(exact.std)));
        laws.rows.push(vec![
            Datum::words(&shown),
            Datum::words(law.name()),
            Datum::words(small(&Histogram::of(&drawn, SMALL))),
            number(sample.mean),
            number(exact.mean),
            number(sample.std),
            number(exact.std),
        ]);
        sources.rows.push(vec![
            Datum::words(shown),
            Datum::words(law.parameters()),
            Datum::words(source(own)),
        ]);
    }
    let mut exhibit = Exhibit::of(
        format!("Every distribution of the simulator, {} draws of each", grouped(draws as f64, 0)),
        laws,
    );
    exhibit.tables.push(sources);
    exhibit
        .with_note("Draws use the simulator's functions; exact moments follow from the distribution. `lab distributions NAME` shows one with its histogram, `--of MEMBER` another group or tier.")
        .with_note("Two more streams choose only words: the wording of a post and the name of its author.")
}

/// Returns the decimals that show three digits of a spread.
fn decimals(spread: f64) -> usize {
    if spread > 0.0 { (2.0 - libm::floor(libm::log10(spread))).clamp(0.0, 9.0) as usize } else { 2 }
}

/// Returns the parameters and the files that draw.
fn source(own: &WorldDraw) -> String {
    let mut files: Vec<&str> = own.sites.iter().map(|(file, _)| *file).collect();
    files.dedup();
    let keys = own.keys.join(", ");
    if keys.is_empty() { files.join(", ") } else { format!("{keys} ({})", files.join(", ")) }
}

fn small(histogram: &Histogram) -> String {
    let most = histogram.counts.iter().copied().max().unwrap_or(0).max(1);
    let level = |count: &u64| LEVELS[((count * 7).div_ceil(most)).min(7) as usize];
    histogram.counts.iter().map(level).collect()
}

/// Returns a distribution for one member of its family: histogram, sample moments, exact moments and moments of reference draws.
pub fn one_law(own: &WorldDraw, (member, name): (usize, &str), luck: &Luck, draws: u64) -> Exhibit {
    let law = (own.law)(&luck.params, member);
    let drawn = own.draws(luck, member, draws);
    let columns = vec![
        Column::words("who", "source"),
        Column::numbers("draws", "draws", Measure::Count),
        Column::numbers("mean", "mean", Measure::Number(5)),
        Column::numbers("std", "sd", Measure::Number(5)),
        Column::numbers("mean_error", "error of mean, standard errors", Measure::Number(2)),
        Column::numbers("least", "least", Measure::Number(4)),
        Column::numbers("most", "most", Measure::Number(4)),
    ];
    let mut table = Tabulation::new("moments", "", columns);
    table.rows.push(row("simulator", &drawn, &law));
    table.rows.push(row("rand_distr", &law.reference(draws), &law));
    let Moments { mean, std } = law.moments();
    let exact = [Datum::words("exact"), Datum::Missing, Datum::number(mean), Datum::number(std)];
    table.rows.push(exact.into_iter().chain([Datum::Missing, Datum::Missing, Datum::Missing]).collect());
    let of = if name.is_empty() { String::new() } else { format!(" of {name}") };
    let mut exhibit = Exhibit::of(format!("{}{of}: {}", own.name, own.what), table);
    exhibit.graphs.push(histogram_graph(own, &Histogram::of(&drawn, BINS)));
    exhibit.notes.push(format!("Distribution: {}, {}.", law.name(), law.parameters()));
    exhibit.notes.push(format!("Parameters: {}.", source(own)));
    let members: Vec<String> = own
        .family
        .members(&luck.params)
        .into_iter()
        .map(|(_, name)| name)
        .filter(|name| !name.is_empty())
        .collect();
    if !members.is_empty() {
        exhibit.notes.push(format!("Values of --of: {}.", members.join(", ")));
    }
    exhibit
}

fn row(who: &str, drawn: &[f64], law: &Law) -> Vec<Datum> {
    let (sample, exact) = (Sample::of(drawn), law.moments());
    let error = exact.std / (sample.count.max(1) as f64).sqrt();
    let off = (error > 0.0).then(|| (sample.mean - exact.mean) / error);
    vec![
        Datum::words(who),
        Datum::number(sample.count as f64),
        Datum::number(sample.mean),
        Datum::number(sample.std),
        Datum::number(off),
        Datum::number(drawn.iter().copied().fold(f64::INFINITY, f64::min)),
        Datum::number(drawn.iter().copied().fold(f64::NEG_INFINITY, f64::max)),
    ]
}

fn histogram_graph(own: &WorldDraw, histogram: &Histogram) -> Graph {
    let points = (0..histogram.counts.len())
        .map(|bin| (histogram.middle(bin), histogram.counts[bin] as f64))
        .collect();
    Graph {
        title: format!("Draws of {}", own.name),
        summary: format!("Histogram of {}; the outer bars include the extreme thousandths", own.what),
        across: GraphAxis { label: "value", scale: AxisScale::Linear },
        up: GraphAxis { label: "draws", scale: AxisScale::Linear },
        series: vec![Series { name: "draws".to_owned(), points }],
        form: GraphForm::Bars,
    }
}
