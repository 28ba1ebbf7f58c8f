//! Benchmark cases of the console.

use crate::console::app::Settings;
use crate::console::keys::Keys;
use crate::console::speed;
use crate::console::themes;
use crate::lab::bench::{Bench, BenchError, BenchFigure, Case, Samples, Unit, keep_a_large_company};
use crate::lab::play_opponents;
use crate::tui::glyphs::Glyphs;

/// Weeks whose keys are measured in each repetition: several hundred keys.
const WEEKS: usize = 6;

pub const CASES: &[Case] = &[
    Case {
        name: "frame",
        figures: &[BenchFigure::aimed("first frame of the console", Unit::Milliseconds, 100.0, None)],
        fresh: true,
        long: false,
        measure: first_frame,
    },
    Case {
        name: "keys",
        figures: &[
            BenchFigure::aimed(
                "key to frame while a week runs, 200×60: 99 of 100",
                Unit::Milliseconds,
                16.0,
                None,
            ),
            BenchFigure::shown("key to frame while a week runs, 200×60: median", Unit::Milliseconds),
        ],
        fresh: false,
        long: false,
        measure: keys,
    },
];

fn settings(bench: &Bench) -> Result<Settings, BenchError> {
    let configuration = bench.configuration.clone();
    Ok(Settings {
        theme: themes::find("dark", &configuration).map_err(BenchError::new)?,
        keys: Keys::of_user(&configuration).map_err(BenchError::new)?,
        glyphs: Glyphs::Braille,
        configuration,
        runs: bench.scratch.clone(),
        again: String::new(),
        lists_everybody: false,
        opponents: play_opponents,
    })
}

fn first_frame(bench: &Bench) -> Result<Samples, BenchError> {
    let once = |_| Ok(speed::first_frame(|| settings(bench))? * 1e3);
    Ok(vec![(0..bench.repetitions).map(once).collect::<Result<_, BenchError>>()?])
}

fn keys(bench: &Bench) -> Result<Samples, BenchError> {
    let run = keep_a_large_company(bench)?;
    let mut seconds = speed::keys_during_weeks(settings(bench)?, &run, WEEKS * bench.repetitions)?;
    seconds.sort_by(f64::total_cmp);
    let at = |share: f64| -> Vec<f64> {
        let place = (seconds.len() as f64 * share).ceil() as usize;
        seconds.get(place.saturating_sub(1)).map(|value| value * 1e3).into_iter().collect()
    };
    Ok(vec![at(0.99), at(0.5)])
}
