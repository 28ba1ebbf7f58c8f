//! NovaMind console: a terminal in which a person runs a simulated AI subscription company for 500 days, with exactly
//! the information and controls that software agents get in the CEO-Bench benchmark.
//!
//! # Crates
//!
//! The root package holds the command line, [`cli`]. Its library re-exports the crates of the workspace for tests and for
//! documentation. `docs/architecture.md` names what each crate contains and which crates it may import.
//!
//! * A day is a list: [`world::day::step_day`] reads as the order of the day, one line per mechanism.
//! * Mechanisms push facts ([`world::events`]); `database` turns them into rows, `voice` some into words.
//! * A tool is data ([`tools::Spec`]) and a pure plan. A call is planned, its line is on the disk, then it is applied,
//!   which cannot fail: memory is never ahead of the trajectory, the trajectory never ahead of what was confirmed.
//! * What a player may see is decided in `database` and in tool answers; hidden state leaves a
//!   session only through a [`session::Look`], in debug runs and once a run is over.
//! * Numbers live in `configs/`; a scenario overrides some of them.
//! * Chance is keyed, not stateful ([`world::random`]): same version, seed and actions give the same bits on any number
//!   of threads and any machine.
//!
//! # A week in ten lines
//!
//! ```
//! use novamind::record::folder::configuration::Configuration;
//! use novamind::record::trajectory::record::Via;
//! use novamind::session::{NewRun, Session};
//! use serde_json::json;
//!
//! let mut run = Session::create(NewRun { seed: Some(7), ..NewRun::default() }, &Configuration::shipped())?;
//! run.call("set_prices", &json!({"A": 16, "B": 34, "C": 70}), Via::Script)?;
//! run.call("set_usage_quotas", &json!({"A": 150, "B": 400, "C": 900}), Via::Script)?;
//! run.call("set_targeted_ad_spend", &json!({"targeted_spend": {"social_media": {"S2": 700}}}), Via::Script)?;
//! let forecasts = run.company().naive_forecasts();
//! let week = run.advance("the shop opens", &forecasts, Via::Script, &mut |_day| {})?;
//! let rows = run.query("SELECT count(*) FROM customers")?;
//! println!("{}\n{:?}", week.dashboard, rows.rows);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod cli;

use novamind_assets as shipped;
use novamind_base::{notation, statistics};
#[doc(inline)]
pub use novamind_console as console;
#[doc(inline)]
pub use novamind_course as course;
#[doc(inline)]
pub use novamind_database as database;
#[doc(inline)]
pub use novamind_glossary as glossary;
#[doc(inline)]
pub use novamind_insight as insight;
#[doc(inline)]
pub use novamind_lab as lab;
#[doc(inline)]
pub use novamind_plain as plain;
#[doc(inline)]
pub use novamind_record as record;
#[doc(inline)]
pub use novamind_report as report;
#[doc(inline)]
pub use novamind_rules as rules;
#[cfg(feature = "server")]
#[doc(inline)]
pub use novamind_server as server;
#[doc(inline)]
pub use novamind_session as session;
#[doc(inline)]
pub use novamind_study as study;
#[doc(inline)]
pub use novamind_tools as tools;
#[doc(inline)]
pub use novamind_tui as tui;
#[doc(inline)]
pub use novamind_voice as voice;
#[doc(inline)]
pub use novamind_worker as worker;
#[doc(inline)]
pub use novamind_world as world;
