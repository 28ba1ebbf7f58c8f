//! Comparison of the hidden tables with the simulator state on every day.

use std::collections::BTreeMap;

use novamind::database::Cell;
use novamind::insight::{CustomerView, Inspect};
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Via;
use novamind::session::{DayReport, OfferResponse, Session};
use novamind::world::identifiers::{Channel, Group, Plan};
use novamind::world::market::economy::Dimension;

use super::{cell, integer, make_offers, play_until_several_groups_subscribe, query_hidden, run_in, text};
use crate::support::company::advance_week;

/// Expected rows by table, which are collected from the simulator after each day.
#[derive(Default)]
struct WatchedTables(BTreeMap<&'static str, Vec<Vec<Cell>>>);

impl WatchedTables {
    fn add_rows(&mut self, table: &'static str, row: Vec<Cell>) {
        self.0.entry(table).or_default().push(row);
    }

    fn add_expected_rows(&mut self, report: &DayReport<'_>) {
        let (xray, day) = (report.xray.expect("a debug run"), integer(report.figures.day));
        let (world, params) = (xray.world(), xray.params());
        for group in Group::all() {
            let id = text(group.id());
            let issues: usize = xray
                .blocks(group)
                .map(|block| block.open_issue_days.iter().filter(|days| **days > 0).count())
                .sum();
            let expectation = world.market.drift.expectation(group);
            let mean_values = xray.mean_satisfaction(group);
            let economy = |dimension| cell(xray.macro_multiplier(group, dimension));
            self.add_rows(
                "hidden.groups",
                vec![
                    day.clone(),
                    id.clone(),
                    integer(world.market.knowledge[group].level),
                    integer(xray.subscribers(group)),
                    cell(xray.reputation(group)),
                    cell(mean_values.map(|mean_values| mean_values.0)),
                    cell(mean_values.map(|mean_values| mean_values.1)),
                    integer(issues as i64),
                    cell(expectation.quality),
                    cell(expectation.c_max),
                    cell(world.product.quality(group, params)),
                    cell(world.product.group_bank[group]),
                    economy(Dimension::WillingnessToPay),
                    economy(Dimension::DealVelocity),
                    economy(Dimension::SeatCount),
                ],
            );
            let drift = &world.market.drift;
            let added = [drift.global_quality, drift.quality[group], drift.c_max[group]].map(cell);
            self.add_rows("hidden.drift", [vec![day.clone(), id.clone()], added.to_vec()].concat());
            if world.market.is_known(group) {
                let lead_factors = xray.lead_factors(group);
                let factors = [
                    lead_factors.reputation,
                    lead_factors.saturation,
                    lead_factors.calendar,
                    lead_factors.economy,
                    lead_factors.social,
                    lead_factors.surge,
                ];
                let paid = Channel::ALL.map(|channel| cell(lead_factors.paid[channel]));
                let arrivals = xray.facts().arrivals.iter().filter(|arrival| arrival.group == group).count();
                let mut row = [vec![day.clone(), id], factors.map(cell).to_vec(), paid.to_vec()].concat();
                row.extend([
                    cell(lead_factors.network),
                    cell(lead_factors.expected()),
                    integer(arrivals as i64),
                ]);
                self.add_rows("hidden.factors", row);
            }
        }
        let event = world.market.competitors.last().filter(|event| event.day == report.figures.day);
        self.add_rows(
            "hidden.competitors",
            vec![
                day.clone(),
                cell(world.product.shared_bank),
                cell(world.product.group_bank.iter().sum::<f64>()),
                cell(event.map(|event| event.boost)),
                cell(event.map(|event| event.sampled)),
                cell(event.map(|event| event.u)),
                event.map_or(Cell::Null, |event| integer(event.by_feedback)),
            ],
        );
        self.add_rows("hidden.pmi", vec![day, cell(world.market.economy.pmi)]);
    }
}

fn advance_watched_week(session: &mut Session, watched: &mut WatchedTables) {
    let forecasts = session.company().naive_forecasts();
    session
        .advance("wait", &forecasts, Via::Script, &mut |report: &DayReport<'_>| {
            watched.add_expected_rows(report)
        })
        .expect("a week");
}

#[test]
fn hidden_tables_match_the_state_of_each_day() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug, 200);
    play_until_several_groups_subscribe(&mut session);
    let mut watched = WatchedTables::default();
    // Queries the tables in several weeks, because each query extends the tables.
    for (week, asks) in (1..=20).zip([true, false, false, true, false, false, false].into_iter().cycle()) {
        advance_watched_week(&mut session, &mut watched);
        if !asks && week != 20 {
            continue;
        }
        for (table, expected) in &watched.0 {
            let rows = query_hidden(&mut session, &format!("SELECT * FROM {table} ORDER BY rowid"));
            let rows: Vec<_> = rows.iter().map(|row| &row[..expected[0].len()]).collect();
            let expected: Vec<_> = expected.iter().map(Vec::as_slice).take(5000).collect();
            assert_eq!(rows, expected, "{table} in week {week}");
        }
    }
    let events = query_hidden(&mut session, "SELECT count(boost), count(severity) FROM hidden.competitors");
    assert!(matches!(events[0][..], [Cell::Integer(some), Cell::Integer(same)] if some > 2 && some == same));
    let moved =
        query_hidden(&mut session, "SELECT 1 FROM hidden.drift WHERE global_quality > 0 AND c_max <> 0");
    assert!(!moved.is_empty(), "something has drifted");
    // PMI measurements are published 30 days later, as in the visible table.
    let sql = "SELECT count(*) FROM hidden.pmi AS own JOIN macroeconomic_conditions AS told \
               ON told.day = own.measured_day AND told.pmi_value = own.measured_pmi \
               AND told.pmi_trend = own.pmi_trend \
               AND told.cycle_phase = own.cycle_phase AND own.published = 0";
    assert!(matches!(query_hidden(&mut session, sql)[0][0], Cell::Integer(days) if days > 100));
    // The product of the factors equals the expected number of leads.
    let sql = "SELECT count(*), max(abs(reputation * saturation * calendar * economy * social * surge * (social_media \
               + search_ads + linkedin + content_marketing + referral_program + word_of_mouth) - expected) \
               / max(expected, 1)) FROM hidden.factors";
    let [Cell::Integer(days), Cell::Real(error)] = query_hidden(&mut session, sql)[0][..] else {
        panic!("two")
    };
    assert!(days > 800 && error < 1e-12, "{days} {error}");
}

/// Returns the expected rows of all subscribers from the simulator state.
fn expected_subscriber_rows(session: &Session) -> Vec<Vec<Cell>> {
    let xray = session.debug_hidden_state().expect("a debug run");
    let mut rows = Vec::new();
    for group in Group::all() {
        for block in xray.blocks(group) {
            rows.extend((0..block.len()).map(|at| {
                let subscriber = block.row(at);
                vec![
                    integer(subscriber.customer),
                    text(group.id()),
                    text(subscriber.plan.id()),
                    integer(subscriber.start_day),
                    cell(subscriber.satisfaction),
                    cell(subscriber.relationship),
                    integer(subscriber.open_issue_days),
                    cell(subscriber.steepness_left),
                    cell(subscriber.c_max),
                    cell(subscriber.q_min),
                    cell(subscriber.q_max),
                    cell(subscriber.required),
                    cell(subscriber.usage_demand),
                    cell(subscriber.seats),
                    cell(subscriber.effective_price),
                ]
            }));
        }
    }
    let number = |row: &Vec<Cell>| if let Cell::Integer(number) = row[0] { number } else { 0 };
    rows.sort_by_key(number);
    rows
}

const SUBSCRIBERS: &str = "SELECT customer_id, group_id, plan, start_day, satisfaction, relationship, open_issue_days, \
                           steepness_left, c_max, q_min, q_max, required_quality, usage_demand, seats, effective_price \
                           FROM hidden.customers WHERE standing = 'subscriber' ORDER BY customer_id";

#[test]
fn hidden_customers_match_the_requested_day() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug, 90);
    play_until_several_groups_subscribe(&mut session);
    let mut rows_by_day = BTreeMap::new();
    for _ in 0..5 {
        advance_week(&mut session);
        let current = expected_subscriber_rows(&session);
        assert_eq!(query_hidden(&mut session, SUBSCRIBERS), current, "day {}", session.day());
        rows_by_day.insert(session.day(), current);
        make_offers(&mut session);
    }
    session.step(3, &mut |_| {}).expect("days");
    rows_by_day.insert(session.day(), expected_subscriber_rows(&session));
    advance_week(&mut session);
    assert!(rows_by_day[&35].len() > 100, "{}", rows_by_day[&35].len());
    for (day, expected) in rows_by_day.iter().chain(rows_by_day.iter().rev()) {
        let rows = session.inspect().query_hidden_tables(SUBSCRIBERS, Some(*day)).expect("a result").rows;
        // A query returns at most 5,000 rows.
        assert_eq!(rows.len(), expected.len().min(5000), "day {day}");
        for (row, expected) in rows.iter().zip(expected) {
            assert_eq!(row, expected, "day {day}");
        }
    }
    // Rows of negotiating enterprises contain their status and can be joined with visible tables.
    let sql = "SELECT count(*), count(own.plan), count(reply_delay_mean), count(status) FROM hidden.customers AS own \
               JOIN subscriptions USING (customer_id) WHERE own.standing = 'lead'";
    let [Cell::Integer(leads), Cell::Integer(0), Cell::Integer(delays), Cell::Integer(known)] =
        query_hidden(&mut session, sql)[0][..]
    else {
        panic!("leads");
    };
    assert!(leads > 3 && leads == delays && leads == known, "{leads} {delays} {known}");
    // A tool call changes the current state, but not the state at the end of the previous day.
    let relationships = "SELECT customer_id, relationship FROM hidden.customers ORDER BY 1";
    session.step(7, &mut |_| {}).expect("days");
    let before = query_hidden(&mut session, relationships);
    make_offers(&mut session);
    let after = query_hidden(&mut session, relationships);
    let differ = before.iter().zip(&after).filter(|(one, other)| one != other).count();
    assert!(differ > 0, "late answers cost relationship");
    let day = session.day();
    advance_week(&mut session);
    assert_eq!(
        session.inspect().query_hidden_tables(relationships, Some(day)).expect("a result").rows,
        before
    );
}

#[test]
fn hidden_threads_match_the_customer_view() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug, 90);
    play_until_several_groups_subscribe(&mut session);
    // Queries the table of leads first, so that the re-simulation is ahead of the stored threads.
    for _ in 0..6 {
        advance_week(&mut session);
        make_offers(&mut session);
        query_hidden(&mut session, "SELECT 1 FROM hidden.groups");
    }
    query_hidden(&mut session, "SELECT 1 FROM hidden.threads");
    advance_week(&mut session);
    let sql = "SELECT day, thread_id, customer_id, c_max, turns_left, relationship, late_penalty, reply_day, quality_B, \
               accepts_below_B, would_name_B, answer, answer_plan, answer_price, kind FROM hidden.threads ORDER BY 1, 2";
    let rows = query_hidden(&mut session, sql);
    assert!(rows.len() > 200, "{}", rows.len());
    let mut answers = BTreeMap::new();
    for row in rows.iter().step_by(rows.len() / 60) {
        let number = |at: usize| match row[at] {
            Cell::Integer(number) => number as u32,
            ref other => panic!("{other:?}"),
        };
        let CustomerView::Enterprise(view) =
            session.inspect().customer_view(number(2), Some(number(0))).expect("a result")
        else {
            panic!("a company")
        };
        let thread_day = view
            .threads_on_shown_day()
            .find(|enterprise_thread_day| enterprise_thread_day.thread == number(1))
            .expect("its thread");
        let plan_state = thread_day.plans[Plan::B];
        let (answer, price) = match thread_day.answer {
            None => (Cell::Null, Cell::Null),
            Some(OfferResponse::Silence) => (text("silence"), Cell::Null),
            Some(OfferResponse::Accept(at)) => (text("accept"), cell(thread_day.offerings[at].price)),
            Some(OfferResponse::Counter(_, price)) => (text("counter"), cell(price)),
        };
        *answers.entry(format!("{answer:?}")).or_insert(0) += 1;
        let expected = vec![
            cell(thread_day.budget),
            integer(thread_day.remaining_turns),
            cell(thread_day.relationship),
            cell(thread_day.late_penalty),
            thread_day.reply_day.map_or(Cell::Null, integer),
            cell(plan_state.quality),
            cell((!plan_state.accepts_any_price).then_some(plan_state.accepts_below)),
            cell(plan_state.counter),
            answer,
        ];
        assert_eq!(row[3..12], expected[..], "{row:?}");
        assert_eq!((&row[13], &row[14]), (&price, &text(thread_day.kind.id())));
    }
    assert!(answers.len() > 2, "{answers:?}");
}
