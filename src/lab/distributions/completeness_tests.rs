//! Tests that the table lists every draw of the simulator with the correct distribution.

use std::collections::BTreeMap;
use std::path::Path;

use super::*;
use novamind_world::params::{Params, bundled_sources};
use novamind_world::random::{Part, Streams};

/// Names of the methods that draw from a random stream.
const DRAW_METHODS: [&str; 12] = [
    ".uniform(",
    ".between(",
    ".integer(",
    ".index(",
    ".bernoulli(",
    ".standard_normal(",
    ".normal(",
    ".exponential(",
    ".log_normal(",
    ".poisson(",
    ".fill(",
    "bernoulli_from_word(",
];

/// Counts the draws in source code, excluding comments and tests. `.index()` without an argument is not a draw.
fn count_draws(text: &str) -> usize {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let in_line = |line: &str| {
        DRAW_METHODS
            .iter()
            .map(|way| {
                let after = line.match_indices(way).map(|(at, _)| &line[at + way.len()..]);
                after.filter(|rest| !(*way == ".index(" && rest.starts_with(')'))).count()
            })
            .sum::<usize>()
    };
    lines.map(in_line).sum()
}

/// Counts the draws in the source files of a folder, by path. `slice.fill(value)` is not a draw.
fn collect_drawing_files(folder: &Path, below: &Path, found: &mut BTreeMap<String, usize>) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        let name = path.strip_prefix(below).expect("below").to_string_lossy().into_owned();
        if path.is_dir() {
            collect_drawing_files(&path, below, found);
        } else if name.ends_with(".rs") && !name.contains("test") && !name.starts_with("random") {
            let draws = count_draws(&std::fs::read_to_string(&path).expect("a source"));
            if draws > 0 {
                found.insert(name, draws);
            }
        }
    }
}

#[test]
fn every_simulator_draw_is_in_the_table() {
    let below = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../src/world");
    let mut found = BTreeMap::new();
    collect_drawing_files(&below, &below, &mut found);
    let mut listed: BTreeMap<String, usize> = BTreeMap::new();
    for (file, draws) in world_draws().flat_map(|world_draw| world_draw.source_files) {
        *listed.entry((*file).to_owned()).or_default() += draws;
    }
    assert_eq!(listed, found, "left: the table, right: draws in src/world");
    assert!(found.values().sum::<usize>() > 70, "sources were read");
}

#[test]
fn every_random_part_is_in_the_table() {
    // The parts that draw the wording of a post and the name of an author affect no numbers.
    let words = [Part::Voice, Part::PersonaTemplate];
    for part in Part::ALL.iter().filter(|part| !words.contains(part)) {
        assert!(world_draws().any(|world_draw| world_draw.part == *part), "{} is missing", part.name());
    }
}

#[test]
fn draw_names_are_unique_and_parameters_exist() {
    let tables: toml::Table = bundled_sources()
        .iter()
        .flat_map(|source| source.text.parse::<toml::Table>().expect("parameters"))
        .collect();
    let mut names: Vec<&str> = world_draws().map(|world_draw| world_draw.name).collect();
    for draw in world_draws() {
        for key in draw.parameters {
            let (table, name) = key.split_once('.').expect("table.key");
            let there = match tables.get(table) {
                Some(toml::Value::Table(table)) => table.contains_key(name),
                Some(toml::Value::Array(rows)) => rows.iter().any(|row| row.get(name).is_some()),
                _ => false,
            };
            assert!(there, "{} names {key}", draw.name);
        }
    }
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
}

/// Checks that the sample moments agree with the exact moments. The tolerance corresponds to a false alarm rate of
/// about 1 in 10,000.
#[test]
fn simulator_draws_match_their_distributions() {
    const DRAWS: u64 = 20_000;
    let context = DrawContext { params: Params::bundled(), streams: Streams::new(84) };
    for world_draw in world_draws() {
        let members = world_draw.family.members(&context.params);
        let (first, last) = (&members[0], &members[members.len() - 1]);
        for (member, name) in [first, last] {
            let draws = world_draw.draws(&context, *member, DRAWS);
            let exact = (world_draw.distribution)(&context.params, *member).moments();
            let count = DRAWS as f64;
            let mean = draws.iter().sum::<f64>() / count;
            let power = |power: f64| {
                draws.iter().map(|draw| libm::pow((draw - exact.mean).abs(), power)).sum::<f64>() / count
            };
            let (spread, fourth) = (power(2.0), power(4.0));
            let what = format!("{} {name}: {exact:?}, drawn {mean} {}", world_draw.name, spread.sqrt());
            assert!((mean - exact.mean).abs() <= 4.5 * exact.std / count.sqrt() + 1e-12, "{what}");
            let error = ((fourth - spread * spread).max(0.0) / count).sqrt();
            assert!((spread - exact.std * exact.std).abs() <= 4.5 * error + 1e-12, "{what}");
        }
    }
}
