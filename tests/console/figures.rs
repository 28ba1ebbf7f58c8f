//! One definition per figure. A number that is shown with a figure's name must equal the value in the database, on
//! every screen and in plain mode, reports and the dashboard. New texts that show a figure with one of these names are
//! compared as well.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use super::company::copy_played_run;
use super::harness::Console;

/// A young company, a company with enterprise deals, and a company with losses: policy, seed, and last days of two weeks.
const PLAYED_COMPANIES: [(&str, u64, [u32; 2]); 3] =
    [("opening.toml", 7, [7, 28]), ("companies.toml", 11, [35, 84]), ("crisis.toml", 5, [28, 70])];

/// Window sizes in which the screens are read.
const SIZES: [(u16, u16); 2] = [(80, 24), (200, 57)];

/// Plain-mode commands, which are run once with text output and once with JSON output.
const PLAIN_COMMANDS: &str = "status\ndashboard\nneeds\ninbox\nchanges\nreport week\nreport run\n";

/// A figure: the names with which it is shown, and its query. `#` in a name stands for the number if it is not at the
/// end. `{from}` and `{to}` in a query are the days of the week. If the query is empty, only the shown numbers are
/// compared with each other.
struct Figure(&'static [&'static str], &'static str);

/// Maximum relative difference between sums of the same amounts in different orders.
const SUM_TOLERANCE: f64 = 1e-12;

/// Figures whose sign depends on whether they are listed among costs.
const COST_FIGURES: [&str; 6] =
    ["running costs", "compute", "advertising", "operations", "development", "lead costs"];

const FIGURES: [Figure; 29] = [
    Figure(&["cash", "cash at week's end", "cash is"], "SELECT sum(amount) FROM ledger"),
    Figure(
        &["cash change", "cash change #, of it", CASH_CHANGE],
        "SELECT sum(amount) FROM ledger WHERE {in_week}",
    ),
    Figure(
        &["subscribers", "individual subscribers", "subs"],
        "SELECT count(*) FROM subscriptions JOIN customers USING (customer_id) WHERE status = 'subscribed' \
         AND customer_type = 'small'",
    ),
    Figure(
        &["seats", "enterprise seats", "enterprise subscribed seats"],
        "SELECT total(seat_count) FROM subscriptions JOIN customers USING (customer_id) WHERE status = 'subscribed' \
         AND customer_type = 'large'",
    ),
    Figure(
        &["recurring revenue", "recurring $/month"],
        "SELECT total(effective_price * seat_count) FROM subscriptions WHERE status = 'subscribed'",
    ),
    Figure(
        &["payments"],
        "SELECT total(amount) FROM ledger WHERE category = 'subscription_payment' AND {in_week}",
    ),
    Figure(
        &["running costs"],
        "SELECT -total(amount) FROM ledger WHERE category IN \
         ('compute', 'capacity', 'operations', 'development', 'advertising') AND {in_week}",
    ),
    Figure(&["compute"], "SELECT -total(amount) FROM ledger WHERE category = 'compute' AND {in_week}"),
    Figure(
        &["advertising"],
        "SELECT -total(amount) FROM ledger WHERE category = 'advertising' AND {in_week}",
    ),
    Figure(&["operations"], "SELECT -total(amount) FROM ledger WHERE category = 'operations' AND {in_week}"),
    Figure(
        &["development"],
        "SELECT -total(amount) FROM ledger WHERE category = 'development' AND {in_week}",
    ),
    Figure(
        &["individual leads", "new individual leads"],
        "SELECT count(*) FROM customers WHERE customer_type = 'small' AND created_day BETWEEN {from} AND {to}",
    ),
    Figure(
        &["enterprise leads", "new enterprise leads", "offer requests"],
        "SELECT count(*) FROM enterprise_turns WHERE thread_type = 'new_lead' AND turn_number = 0 \
         AND day BETWEEN {from} AND {to}",
    ),
    Figure(
        &["new subscribers", "new individual subscribers"],
        "SELECT count(*) FROM subscriptions JOIN customers USING (customer_id) WHERE customer_type = 'small' \
         AND start_day BETWEEN {from} AND {to} AND status IN ('subscribed', 'cancelled')",
    ),
    Figure(
        &["new seats", "new enterprise seats", "new enterprise subscribed seats"],
        "SELECT total(seat_count) FROM subscriptions JOIN customers USING (customer_id) WHERE customer_type = 'large' \
         AND start_day BETWEEN {from} AND {to} AND status IN ('subscribed', 'cancelled')",
    ),
    Figure(
        &["cancellations"],
        "SELECT count(*) FROM subscriptions JOIN customers USING (customer_id) WHERE customer_type = 'small' \
         AND status = 'cancelled' AND end_day BETWEEN {from} AND {to}",
    ),
    Figure(
        &["companies lost", "enterprise lost", "enterprises lost"],
        "SELECT count(*) FROM subscriptions JOIN customers USING (customer_id) WHERE customer_type = 'large' \
         AND status = 'cancelled' AND end_day BETWEEN {from} AND {to}",
    ),
    Figure(
        &["conversion"],
        "SELECT 1.0 * (SELECT count(*) FROM subscriptions JOIN customers USING (customer_id) \
         WHERE customer_type = 'small' AND start_day BETWEEN {from} AND {to} AND status IN ('subscribed', 'cancelled')) \
         / (SELECT count(*) FROM customers WHERE customer_type = 'small' AND created_day BETWEEN {from} AND {to})",
    ),
    Figure(&["runway", "cash should last", "cash should last at least"], ""),
    Figure(&["upgrades"], ""),
    Figure(&["downgrades"], ""),
    Figure(
        &["usage", "usage, units"],
        "SELECT sum(total_usage_units) FROM service_day WHERE day BETWEEN {from} AND {to}",
    ),
    Figure(
        &["the busiest day used # units", "the busiest day of the week used # units"],
        "SELECT max(total_usage_units) FROM service_day WHERE day BETWEEN {from} AND {to}",
    ),
    Figure(
        &["overload, peak", "overload (peak)", "overload peak"],
        "SELECT max(max(0.0, 1.0 * total_usage_units / capacity_units - 1)) FROM service_day \
         WHERE day BETWEEN {from} AND {to}",
    ),
    Figure(
        &["outage, minutes", "outage: yes (", "downtime minutes"],
        "SELECT total(downtime_minutes) FROM service_day WHERE day BETWEEN {from} AND {to}",
    ),
    Figure(
        &["latency, peak ms", "p95 latency (peak)", "p95 ms peak"],
        "SELECT max(p95_ms) FROM service_day WHERE day BETWEEN {from} AND {to}",
    ),
    Figure(
        &["error rate, peak", "error rate (peak)", "error rate peak"],
        "SELECT max(error_rate) FROM service_day WHERE day BETWEEN {from} AND {to}",
    ),
    Figure(
        &["open issues", "issues # open"],
        "SELECT count(DISTINCT customer_id) FROM issues JOIN subscriptions USING (customer_id) \
         WHERE issues.status = 'open' AND subscriptions.status = 'subscribed'",
    ),
    Figure(
        &["# waiting for you", "# awaiting your response", "# enterprises wait for an answer"],
        "SELECT count(*) FROM (SELECT max(turn_number), day, sender, closed FROM enterprise_turns \
         GROUP BY thread_id HAVING sender <> 'agent' AND closed = 0 AND day > {to} - 7)",
    ),
];

/// Internal name of the cash change that is shown next to cash, with an arrow or in parentheses.
const CASH_CHANGE: &str = "what cash did";

/// Names with a different meaning in a table of the product screen: the service table lists the outage minutes of single days.
const OTHER_TABLE_FIGURES: [(&str, &str); 1] = [("screen 4", "outage, minutes")];

/// A number that was parsed from text, and its rounding error.
#[derive(Debug, Clone, Copy)]
struct ShownNumber {
    value: f64,
    rounding: f64,
}

/// Parses a number at the start of a text: sign, dollars, digits, k, M, B or %. Returns the rest of the text.
fn parse_number(text: &str) -> Option<(ShownNumber, &str)> {
    let mut rest = text;
    let mut sign = 1.0;
    for mark in ["▲ ", "+", "-", "−", "$", "-"] {
        if let Some(after) = rest.strip_prefix(mark) {
            rest = after;
            sign *= if ["-", "−"].contains(&mark) { -1.0 } else { 1.0 };
        }
    }
    let end =
        rest.find(|letter: char| !letter.is_ascii_digit() && !",.".contains(letter)).unwrap_or(rest.len());
    let digits = rest[..end].trim_end_matches([',', '.']);
    let after = &rest[digits.len()..];
    let plain = digits.replace(',', "");
    let value: f64 = plain.parse().ok()?;
    let decimals = plain.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let (scale, after) = match after.chars().next() {
        Some('k') => (1e3, &after[1..]),
        Some('M') => (1e6, &after[1..]),
        Some('B') => (1e9, &after[1..]),
        Some('%') => (0.01, &after[1..]),
        _ => (1.0, after),
    };
    let rounding = (0..decimals).fold(0.5001 * scale, |half, _| half / 10.0);
    Some((ShownNumber { value: sign * scale * value, rounding }, after))
}

/// Returns the number that follows a name, or that is at the position of `#` in the name.
fn shown_value(name: &str, cell: &str) -> Option<ShownNumber> {
    let (before, after) = name.split_once('#').unwrap_or((name, ""));
    let (before, low) = (before.trim_end(), cell.to_lowercase());
    // Byte positions must match, so a text whose lowercase form has a different length is skipped.
    if low.len() != cell.len() {
        return None;
    }
    if before.is_empty() {
        let (shown_number, left) = parse_number(cell.trim_start_matches([' ', '-', '!', '*']))?;
        return left.starts_with(after).then_some(shown_number);
    }
    let mut from = 0;
    while let Some(at) = low[from..].find(before).map(|at| at + from) {
        from = at + before.len();
        let prefix = low[..at].trim_end_matches(['*', '"']);
        let word = prefix.ends_with(|letter: char| letter.is_alphanumeric() || "'-_".contains(letter));
        let phrase = prefix
            .strip_suffix(' ')
            .is_some_and(|prefix| prefix.ends_with(|last: char| last.is_alphanumeric()));
        if word || phrase {
            continue;
        }
        let rest = cell[from..].trim_start_matches(['"', '*', ':', '|', ' ', '─']);
        let Some((mut shown_number, mut left)) = parse_number(rest) else { continue };
        if let Some((new, after)) =
            left.trim_start().strip_prefix("→ ").and_then(|next| parse_number(next.trim_start()))
        {
            (shown_number, left) = (new, after);
        }
        // A value per day is a rate and not the figure. A number that is directly followed by other characters belongs
        // to a longer name.
        let rate = [" $/day", " units/day"].iter().any(|unit| left.starts_with(unit));
        let change = after.is_empty() && left.starts_with(", of it");
        let ends = left.chars().next().is_none_or(|next| " ,;.|)│".contains(next));
        if ends && !rate && !change && left.starts_with(after) {
            return Some(shown_number);
        }
    }
    None
}

/// Parses the change next to cash, `▼ $9.86k` or `(-$9,857 over the last week)`.
fn shown_cash_change(cell: &str) -> Option<ShownNumber> {
    let cash = cell.trim().strip_prefix("cash").or_else(|| cell.trim().strip_prefix("Cash"))?;
    let cash = cash.strip_prefix(" at week's end").unwrap_or(cash);
    let (_, rest) = parse_number(cash.trim_start_matches([' ', '─']))?;
    let rest = rest.trim_start();
    let fell = rest.strip_prefix("▼ ");
    let (shown_number, _) = parse_number(fell.or(rest.strip_prefix("▲ ")).or(rest.strip_prefix('('))?)?;
    Some(if fell.is_some() {
        ShownNumber { value: -shown_number.value, ..shown_number }
    } else {
        shown_number
    })
}

/// Splits a line into independent parts. Cash in the header is a separate part.
fn split_cells(part: &str) -> impl Iterator<Item = &str> {
    let at = part.find("   cash ").unwrap_or(0);
    [&part[..at], &part[at..]].into_iter().flat_map(|part| part.split(" | "))
}

/// Returns every figure that a text shows, as the index of the figure, the number and the line.
fn shown_figures(text: &str) -> Vec<(usize, ShownNumber, String)> {
    let mut found = Vec::new();
    for line in text.lines() {
        // Changes after the semicolon are changes of the figure's components.
        let line = line.split(';').next().unwrap_or_default();
        for cell in line.split(['│', '┃', '┌', '┐', '└', '·']).flat_map(split_cells) {
            for (figure, Figure(names, _)) in FIGURES.iter().enumerate() {
                let numbers = names.iter().filter_map(|name| match *name {
                    CASH_CHANGE => shown_cash_change(cell),
                    name => shown_value(name, cell),
                });
                found.extend(numbers.map(|shown_number| (figure, shown_number, cell.trim().to_owned())));
            }
        }
    }
    found
}

/// Runs plain mode and returns its output.
fn plain_output(runs: &Path, options: &[&str], lines: &str) -> String {
    let mut child = Command::new(env!("CARGO_BIN_EXE_novamind"))
        .env("NOVAMIND_RUNS", runs)
        .env("NOVAMIND_CONFIG", runs.join("configuration"))
        .args(["play", "--plain", "--run", "latest"])
        .args(options)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    child.stdin.take().expect("a pipe").write_all(lines.as_bytes()).expect("it reads");
    let output = child.wait_with_output().expect("it ends");
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Returns the HTML report of a run as text, with one line per table row.
fn report_page(runs: &Path) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_novamind"))
        .env("NOVAMIND_RUNS", runs)
        .args(["report", "latest", "--format", "html"])
        .output()
        .expect("the program starts");
    let html = String::from_utf8(output.stdout).expect("UTF-8");
    let (mut text, mut rest) = (String::new(), html.as_str());
    while let Some((before, after)) = rest.split_once('<') {
        // Drawings contain no text.
        let drawn = ["svg", "style"].into_iter().find(|drawn| after.starts_with(drawn));
        let end = drawn.and_then(|drawn| after.find(&format!("</{drawn}>"))).map_or(0, |at| at + 1);
        let tag = after[end..].split_once('>').map_or("", |(tag, _)| tag);
        text += before;
        text += if ["/tr", "/p", "/li", "/h1", "/h2", "/h3"].contains(&tag) { "\n" } else { " " };
        rest = &after[end + tag.len() + 1..];
    }
    text
}

/// Returns the value of every figure in the database, `None` for figures without a query.
fn database_figures(runs: &Path, day: u32) -> Vec<Option<f64>> {
    let in_week = novamind::session::ledger_weeks_condition_sql(day.div_ceil(7), day.div_ceil(7));
    let statement = |sql: &str| {
        let sql = sql.replace("{in_week}", &in_week);
        sql.replace("{from}", &(day - 6).to_string()).replace("{to}", &day.to_string())
    };
    let asked: Vec<String> =
        FIGURES.iter().filter(|figure| !figure.1.is_empty()).map(|figure| statement(figure.1)).collect();
    let lines: String = asked.iter().map(|sql| format!("sql {sql}\n")).collect();
    let text = plain_output(runs, &["--json"], &lines);
    let answers = text.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).expect("JSON"));
    let mut rows = answers.filter_map(|answer| {
        let row = answer.pointer("/data/rows/0")?.as_object()?;
        Some(row.values().next()?.as_f64().unwrap_or(0.0))
    });
    let next =
        |figure: &Figure| (!figure.1.is_empty()).then(|| rows.next().unwrap_or_else(|| panic!("{text}")));
    FIGURES.iter().map(next).collect()
}

/// Returns all texts that show figures of a company, each with the name of its source.
fn shown_texts(runs: &Path, day: u32) -> Vec<(String, String)> {
    let mut all = vec![("plain".to_owned(), plain_output(runs, &[], PLAIN_COMMANDS))];
    let json = plain_output(runs, &["--json"], "status\n");
    all.push(("JSON".to_owned(), json.replace(",\"", "\n\"").replace('_', " ")));
    all.push(("HTML".to_owned(), report_page(runs)));
    let today = format!("· day {day} ·");
    for size in SIZES {
        let mut console = Console::in_latest_run(runs, size);
        for key in ["1", "2", "3", "4", "5", "6", "7", "8", "9", "0"] {
            console.press(key);
            // The journal also lists the cash of earlier weeks.
            let screen = console.screen();
            let is_now = |line: &&str| key != "0" || !line.contains("· day ") || line.contains(&today);
            let lines: Vec<&str> = screen.lines().filter(is_now).collect();
            all.push((format!("screen {key} at {size:?}"), lines.join("\n")));
        }
        console.press("1 w");
        all.push((format!("report of the week at {size:?}"), console.screen()));
    }
    all
}

#[test]
fn figures_with_the_same_name_have_the_same_value() {
    let mut places: BTreeMap<usize, usize> = BTreeMap::new();
    let mut wrong = Vec::new();
    for (policy, seed, days) in PLAYED_COMPANIES {
        for day in days {
            let runs = tempfile::tempdir().expect("a folder");
            copy_played_run(policy, seed, day, runs.path());
            let values = database_figures(runs.path(), day);
            let mut first: BTreeMap<usize, ShownNumber> = BTreeMap::new();
            for (place, text) in shown_texts(runs.path(), day) {
                for (figure, shown_number, line) in shown_figures(&text) {
                    let other =
                        |(table, name): &(&str, &str)| place.starts_with(table) && line.starts_with(name);
                    if OTHER_TABLE_FIGURES.iter().any(other) {
                        continue;
                    }
                    *places.entry(figure).or_default() += 1;
                    let cost = COST_FIGURES.contains(&FIGURES[figure].0[0]);
                    // The report names the changes of components, with their signs.
                    let is_component = FIGURES[figure].0.iter().any(|name| {
                        ["+", "-"].iter().any(|sign| line.to_lowercase().contains(&format!("{name} {sign}$")))
                    });
                    if cost && is_component && place.starts_with("report of the week") {
                        continue;
                    }
                    let sign = |value: f64| if cost { value.abs() } else { value };
                    let other = *first.entry(figure).or_insert(shown_number);
                    let (should, leeway) = match values[figure] {
                        Some(value) => (value, 0.0),
                        None => (other.value, other.rounding),
                    };
                    if (sign(shown_number.value) - sign(should)).abs()
                        > shown_number.rounding + leeway + SUM_TOLERANCE * should.abs()
                    {
                        wrong.push(format!("{policy} day {day}, {place}: {line:?}; it is {should}"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for (figure, Figure(names, _)) in FIGURES.iter().enumerate() {
        let count = places.get(&figure).copied().unwrap_or(0);
        assert!(count > 1, "{names:?} is compared in {count} places");
    }
}

#[test]
fn shown_figures_parses_numbers_in_context() {
    let of = |text: &str| -> Vec<(&str, f64)> {
        let named = |(figure, shown_number, _): (usize, ShownNumber, String)| {
            (FIGURES[figure].0[0], shown_number.value)
        };
        shown_figures(text).into_iter().map(named).collect()
    };
    let top = " NovaMind  day 49/84 · wk 7/12   cash $952k ▼ $9.86k   runway to end";
    assert_eq!(of(top), [("cash", 952_000.0), ("cash change", -9_860.0)]);
    assert_eq!(of("┌ Cash ───── $952,425 ▲ $9 ┐"), [("cash", 952_425.0), ("cash change", 9.0)]);
    assert_eq!(of("cash $9 (-$7 over the last week)"), [("cash", 9.0), ("cash change", -7.0)]);
    assert_eq!(of("subscribers 65 → 150; of it 7"), [("subscribers", 150.0)]);
    assert_eq!(of("New Individual Subscribers: 3"), [("new subscribers", 3.0)]);
    assert_eq!(of("! 4 enterprises wait for an answer (9 seats)"), [("# waiting for you", 4.0)]);
    assert_eq!(of("operations: 0 → 100 $/day · cash should last 12 to 19 weeks"), [("runway", 12.0)]);
}
