//! Benchmarks of the console.

use crate::console::app::Settings;
use crate::console::benchmark;
use crate::console::keys::KeyBindings;
use crate::console::themes;
use crate::lab::benchmark::{
    BenchCase, BenchContext, BenchError, BenchFigure, BenchUnit, Samples, save_large_company,
};
use crate::lab::play_opponents;
use crate::tui::glyphs::Glyphs;

/// Number of weeks per repetition. A repetition times several hundred key presses.
const WEEKS: usize = 6;

pub const CASES: &[BenchCase] = &[
    BenchCase {
        name: "frame",
        figures: &[BenchFigure::with_target(
            "first frame of the console",
            BenchUnit::Milliseconds,
            100.0,
            None,
        )],
        needs_new_process: true,
        is_slow: false,
        measure: measure_first_frame,
    },
    BenchCase {
        name: "keys",
        figures: &[
            BenchFigure::with_target(
                "key press to frame during a week, 200×60: 99th percentile",
                BenchUnit::Milliseconds,
                16.0,
                None,
            ),
            BenchFigure::without_target(
                "key press to frame during a week, 200×60: median",
                BenchUnit::Milliseconds,
            ),
        ],
        needs_new_process: false,
        is_slow: false,
        measure: measure_keys,
    },
];

fn settings(bench: &BenchContext) -> Result<Settings, BenchError> {
    let configuration = bench.configuration.clone();
    Ok(Settings {
        theme: themes::find_theme("dark", &configuration).map_err(BenchError::new)?,
        keys: KeyBindings::with_user_file(&configuration).map_err(BenchError::new)?,
        glyphs: Glyphs::Braille,
        configuration,
        runs: bench.scratch_folder.clone(),
        resume_command: String::new(),
        lists_all_participants: false,
        hosted: false,
        opponents: play_opponents,
    })
}

fn measure_first_frame(bench: &BenchContext) -> Result<Samples, BenchError> {
    let once = |_| Ok(benchmark::measure_first_frame(|| settings(bench))? * 1e3);
    Ok(vec![(0..bench.repetitions).map(once).collect::<Result<_, BenchError>>()?])
}

fn measure_keys(bench: &BenchContext) -> Result<Samples, BenchError> {
    let run = save_large_company(bench)?;
    let mut seconds =
        benchmark::measure_keys_during_weeks(settings(bench)?, &run, WEEKS * bench.repetitions)?;
    seconds.sort_by(f64::total_cmp);
    let at = |share: f64| -> Vec<f64> {
        let place = (seconds.len() as f64 * share).ceil() as usize;
        seconds.get(place.saturating_sub(1)).map(|value| value * 1e3).into_iter().collect()
    };
    Ok(vec![at(0.99), at(0.5)])
}
