//! NovaMind console: a terminal program in which you run a simulated AI subscription company for 500 days. You get
//! exactly the information and controls that software agents get in the CEO-Bench benchmark.
//!
//! # Crates
//!
//! The root package contains the command line, [`cli`]. Its library re-exports the crates of the workspace for tests and for
//! documentation. `docs/architecture.md` lists the contents and the allowed imports of each crate.
//!
//! * [`world::day::step_day`] lists the steps of a day in order, one line per mechanism.
//! * Mechanisms emit events ([`world::events`]). `database` converts the events to rows, and `voice` words messages and posts.
//! * A tool is a specification ([`tools::ToolSpec`]) and a pure plan. A call is first planned, then written to disk as a line of
//!   the trajectory, then applied, and finally confirmed. Applying a call cannot fail.
//! * `database` and the results of tools determine which information a player may see. Hidden state leaves a session only
//!   through a [`session::InspectionPermit`], in debug runs and finished runs.
//! * Parameters are stored in `configs/`. A scenario overrides some parameters.
//! * Random draws depend on keys, not on generator state ([`world::random`]). The same version, seed and actions produce
//!   identical results on any number of threads and any machine.
//!
//! # A week in ten lines
//!
//! ```
//! use novamind::record::folder::configuration::Configuration;
//! use novamind::record::trajectory::record::Via;
//! use novamind::session::{NewRun, Session};
//! use serde_json::json;
//!
//! let mut run = Session::create(NewRun { seed: Some(7), ..NewRun::default() }, &Configuration::bundled())?;
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

use novamind_base::{formatting, statistics};
#[doc(inline)]
pub use novamind_console as console;
#[doc(inline)]
pub use novamind_course as course;
#[doc(inline)]
pub use novamind_database as database;
#[doc(inline)]
pub use novamind_glossary as glossary;
#[cfg(all(feature = "server", unix))]
#[doc(inline)]
pub use novamind_host as host;
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
