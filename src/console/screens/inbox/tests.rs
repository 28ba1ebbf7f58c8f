use serde_json::{Value, json};

use super::outcomes::OutcomesPane;
use super::sending::offer_economics;
use super::*;
use crate::keys::KeyBindings;
use crate::screens::Screen;
use crate::test_kit::{
    draw_at_all_sizes, handle_action, loaded_screen, new_company, screen_text, session_with_negotiations,
    zoomed_text,
};
use novamind_database::{Cell as Datum, number_at};
use novamind_record::trajectory::record::Via;
use novamind_session::WaitingThread;
use novamind_session::identifiers::Plan;
use novamind_tools::{Answer, DealResult, DealResults, ToolId};
use novamind_tui::chord::Chord;

/// Returns a company with waiting threads. Every third enterprise is a subscriber with an individual price.
fn crowded_company(threads: u32) -> (DisplayedCompany, QueryResult, QueryResult) {
    let mut company = new_company();
    company.observation.day = 70;
    company.settings.insert(
        ToolId::SetPrices,
        json!({"A": 14.0, "B": 32.0, "C": 55.0}).as_object().cloned().expect("an object"),
    );
    let (mut turns, mut firms) = (Vec::new(), Vec::new());
    for number in 1..=threads {
        let asks = number % 3 == 0;
        company.observation.waiting.push(WaitingThread {
            thread: number,
            customer: 1000 + number,
            group: ["E1", "E2", "E3"][number as usize % 3],
            seats: 50 + number,
            kind: if asks { "churn_prevention" } else { "new_lead" },
            turn: if asks { 3 } else { 0 },
            offers_so_far: u32::from(asks),
            last_offer: if asks { vec![(Plan::B, 30.0)] } else { Vec::new() },
            asked: asks.then_some(20.0),
            days_left: number % 7 + 1,
        });
        let text = |text: &str| Datum::Text(text.to_owned());
        let int = |value: u32| Datum::Integer(i64::from(value));
        let row = |turn: u32, sender: &str, words: &str, offer: &str| {
            let kind = if asks { "churn_prevention" } else { "new_lead" };
            let cells = [text(sender), text(words), text(offer), int(60 + turn), int(50 + number), text("")];
            [int(number), int(1000 + number), text(kind), int(turn)]
                .into_iter()
                .chain(cells)
                .collect::<Vec<_>>()
        };
        turns.push(row(0, "system", "", "{}"));
        if asks {
            turns.push(row(1, "customer", "The price no longer fits.", "{}"));
            turns.push(row(
                2,
                "agent",
                "",
                r#"[{"plan": "B", "price_per_seat": 30.0, "contract_months": 1}]"#,
            ));
            turns.push(row(3, "customer", "At $20.00 for plan B we stay.", r#"{"price": 20.0}"#));
        }
        let words = ["E1", "logistics", "mid-sized", "formal", "by committee", "cost", "lead", "pending"];
        let mut firm = vec![int(1000 + number)];
        firm.extend(words.map(text));
        firm.extend([Datum::Real(0.0), int(60)]);
        firms.push(firm);
    }
    turns.reverse();
    (
        company,
        QueryResult { rows: turns, ..QueryResult::default() },
        QueryResult { rows: firms, ..QueryResult::default() },
    )
}

fn crowded_screen() -> (Inbox, DisplayedCompany) {
    crowded_screen_with(200)
}

#[test]
fn scrolled_columns_keep_the_names() {
    let (mut screen, company) = crowded_screen();
    for (width, height) in [(60, 13), (80, 21), (120, 37)] {
        handle_action(&mut screen, Action::Down, &company);
        (0..11).for_each(|_| drop(handle_action(&mut screen, Action::Right, &company)));
        let text = screen_text(&screen, &company, width, height);
        let head = text.lines().find(|line| line.contains("needs quota")).unwrap_or_default();
        assert!(head.contains("enterprise"), "{width}×{height}:\n{text}");
    }
}

fn crowded_screen_with(threads: u32) -> (Inbox, DisplayedCompany) {
    let (company, turns, firms) = crowded_company(threads);
    let mut screen = Inbox::default();
    let keys = KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 20 };
    screen.apply_rows(Reading::EnterpriseTurns, &turns, &context);
    screen.apply_rows(Reading::Companies, &firms, &context);
    (screen, company)
}

/// Sends keys to the screen as the console does. Quoted words are typed. Returns the effects of the last key and the
/// number of keys.
fn press(screen: &mut Inbox, company: &DisplayedCompany, keys: &str) -> (Vec<Effect>, usize) {
    let known = KeyBindings::bundled();
    let context = ScreenContext { company, keys: &known, page_rows: 20 };
    let (mut effects, mut count) = (Vec::new(), 0);
    for word in keys.split(' ') {
        let typed = word.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\''));
        let chords: Vec<String> = match typed {
            Some(text) => text.chars().map(|letter| letter.to_string()).collect(),
            None => vec![word.to_owned()],
        };
        for chord in chords {
            let chord = Chord::parse(&chord).expect("a key");
            let scopes = screen.scopes();
            let text = scopes[0].is_text() && chord.is_printable();
            effects = match known.action(&scopes, chord).filter(|_| !text) {
                Some(action) => screen.handle_action(action, &context),
                None => screen.handle_key(&chord.to_event(), &context),
            };
            count += 1;
        }
    }
    (effects, count)
}

fn sent_deals(effects: &[Effect]) -> Vec<Value> {
    match effects {
        [Effect::ConfirmCall { arguments, .. }] => arguments["deals"].as_array().expect("deals").clone(),
        other => panic!("no tool call: {other:?}"),
    }
}

/// Updates the company and the screen as if all deals had been sent successfully.
fn apply_answers(screen: &mut Inbox, company: &mut DisplayedCompany, deals: &[Value]) {
    let customers: Vec<u32> = deals.iter().map(|deal| deal[0].as_u64().expect("a number") as u32).collect();
    company.observation.waiting.retain(|thread| !customers.contains(&thread.customer));
    let done = |customer_id: u32| DealResult::Done { customer_id, success: true };
    let results = DealResults { results: customers.into_iter().map(done).collect() };
    let keys = KeyBindings::bundled();
    let context = ScreenContext { company, keys: &keys, page_rows: 20 };
    screen.on_company_change(&context);
    let news = Response::ToolCalled(
        ToolId::SendEnterpriseDeal,
        Ok(Box::new(Answer::SendEnterpriseDeal(results))),
        std::sync::Arc::new(company.clone()),
    );
    screen.handle_response(&news, &context);
}

#[test]
fn two_hundred_threads_are_answered_in_under_forty_keys() {
    let (mut screen, mut company) = crowded_screen();
    // Offer subscribers 3 % more than they ask, and offer leads plan B at 90 % of the list price or plan C at 85 %.
    let (effects, mut keys) = press(&mut screen, &company, "/ 'reten' enter a t e '103' ctrl-s");
    let sent = sent_deals(&effects);
    assert_eq!((sent.len(), &sent[0][1]), (66, &json!([["B", 20.6]])));
    assert!(matches!(&effects[0], Effect::ConfirmCall { text, .. } if text.starts_with("66 enterprises, ")));
    apply_answers(&mut screen, &mut company, &sent);
    keys += 1;
    assert_eq!(screen.marked.len(), 0);
    let (_, more) = press(&mut screen, &company, "esc esc a");
    keys += more;
    assert_eq!(screen.marked.len(), 134);
    let (effects, more) = press(&mut screen, &company, "e p p p '90' b b down p p p '85' ctrl-s");
    keys += more + 1;
    let sent = sent_deals(&effects);
    assert_eq!(sent.len(), 134, "{:?}", screen.bulk_offer);
    apply_answers(&mut screen, &mut company, &sent);
    assert!(screen.rows.is_empty());
    assert!(keys < 40, "{keys} keys");
}

#[test]
fn rules_answer_every_thread_after_one_confirmation() {
    let (mut screen, company) = crowded_screen();
    let rules = "'accept\u{a0}asked>=20;\u{a0}offer\u{a0}where\u{a0}group=E1:\u{a0}B\u{a0}85,C\u{a0}list*0.9;\u{a0}reject\u{a0}seats<60'";
    press(&mut screen, &company, &format!("R ctrl-n {rules}"));
    let text = screen_text(&screen, &company, 120, 37);
    for words in ["Rules", "accept asked>=20: 66 enterprises", "Preview for 72", "$20.00 → B $20.00"] {
        assert!(text.replace('\u{a0}', " ").contains(words), "{words} in\n{text}");
    }
    let (effects, _) = press(&mut screen, &company, "ctrl-s");
    let [Effect::ConfirmCalls { calls, text }] = &effects[..] else { panic!("{effects:?}") };
    let sizes: Vec<(ToolId, usize)> =
        calls.iter().map(|(tool, call)| (*tool, call["deals"].as_array().expect("deals").len())).collect();
    // The customer numbers of leads of E1 are divisible by three, and all leads have asked for an offer.
    assert_eq!(sizes, [(ToolId::SendEnterpriseDeal, 66), (ToolId::RejectEnterpriseDeal, 6)]);
    assert!(text.contains("128 unanswered"), "{text}");
    assert_eq!(
        screen.last_rule_answers(&company).as_ref(),
        Some(&(calls.clone(), text.clone())),
        "the rules are kept"
    );
    press(&mut screen, &company, "esc R");
    for (width, height) in [(60, 13), (80, 21), (120, 37), (200, 57)] {
        let text = screen_text(&screen, &company, width, height);
        assert!(
            text.contains("seats<60"),
            "rules that were sent are shown again: {width}x{height} in\n{text}"
        );
        assert!(text.contains("$20.00 → B $20.00"), "offer to an enterprise: {width}x{height} in\n{text}");
    }
    press(&mut screen, &company, "tab");
    assert_eq!(
        (screen.focus, screen.scopes()[0].is_text()),
        (InboxPane::Thread, false),
        "tab focuses the preview"
    );
    press(&mut screen, &company, "R");
    assert_eq!((screen.focus, screen.scopes()[0].is_text()), (InboxPane::Offer, true), "R focuses the rules");
    let (effects, _) = press(&mut screen, &company, "ctrl-n 'ofer' ctrl-s");
    assert!(matches!(&effects[..], [Effect::ShowError(text)] if text.contains("did you mean offer")));
    draw_at_all_sizes(&mut screen, &company);
}

#[test]
fn answering_a_thread_selects_the_next_one() {
    let (mut screen, mut company) = crowded_screen();
    let mut seen = BTreeSet::new();
    for _ in 0..200 {
        let customer = screen.selected_thread().expect("a thread").customer;
        assert!(seen.insert(customer));
        let (effects, _) = press(&mut screen, &company, "ctrl-s");
        let sent = sent_deals(&effects);
        assert_eq!(sent[0][0], json!(customer));
        let price = if customer % 1000 % 3 == 0 { json!([["B", 20.0]]) } else { json!([["B", 32.0]]) };
        assert_eq!(sent[0][1], price);
        apply_answers(&mut screen, &mut company, &sent);
    }
    let (effects, _) = press(&mut screen, &company, "ctrl-s");
    assert!(matches!(&effects[..], [Effect::ShowError(_)]), "{effects:?}");
}

#[test]
fn draft_is_kept_for_its_thread() {
    let (mut screen, company) = crowded_screen();
    press(&mut screen, &company, "e '95' down");
    assert_eq!(screen.current_offer(&company).0[0].value, 95.0);
    press(&mut screen, &company, "esc down");
    assert_ne!(screen.current_offer(&company).0[0].value, 95.0);
    press(&mut screen, &company, "up");
    assert_eq!(screen.current_offer(&company).0[0].value, 95.0);
    assert!(screen.has_unsent_text());
    press(&mut screen, &company, "e '7' esc");
    assert_eq!(screen.current_offer(&company).0[0].value, 95.0, "cancelled input is discarded");
    let (effects, _) = press(&mut screen, &company, "enter 'x'");
    assert!(matches!(&effects[..], [Effect::ShowError(_)]) && screen.value_field.is_some());
}

#[test]
fn rejection_names_the_lost_revenue() {
    let (mut screen, company) = crowded_screen();
    press(&mut screen, &company, "a");
    let (effects, _) = press(&mut screen, &company, "x");
    let [Effect::ConfirmCall { tool: ToolId::RejectEnterpriseDeal, text, .. }] = &effects[..] else {
        panic!("{effects:?}")
    };
    assert!(text.contains("134 new leads") && text.contains("lost for good"), "{text}");
    assert!(text.contains("66 subscribers stay"), "{text}");
    assert_eq!(sent_deals(&effects).len(), 200);
}

#[test]
fn screen_shows_list_thread_offer_and_preview() {
    let (mut screen, company) = crowded_screen();
    for (width, height) in [(80, 21), (120, 37), (200, 57)] {
        let text = screen_text(&screen, &company, width, height);
        for words in
            ["200 waiting for you", "left", "enterprise", "no.", "new lead", "Your offer", "per seat"]
        {
            assert!(text.contains(words), "{words} at {width}x{height} in\n{text}");
        }
    }
    press(&mut screen, &company, "a");
    for (width, height) in [(80, 21), (120, 37), (200, 57)] {
        let text = screen_text(&screen, &company, width, height);
        for words in ["Bulk offer for 200", "Preview for 200", "200 marked", "→ B $32.00", "200 enterprises"]
        {
            assert!(text.contains(words), "{words} at {width}x{height} in\n{text}");
        }
    }
    draw_at_all_sizes(&mut screen, &company);
    screen.set_focused_pane(InboxPane::List);
    press(&mut screen, &company, "a / '1003' enter");
    let text = screen_text(&screen, &company, 120, 37);
    for words in
        ["#1003", "offered B $30.00", "At $20.00 for plan B", "formal", "asked price $20.00", "theirs"]
    {
        assert!(text.contains(words), "{words} in\n{text}");
    }
    draw_at_all_sizes(&mut screen, &company);
}

#[test]
fn empty_inbox_explains_how_leads_arrive() {
    let company = new_company();
    let mut screen = Inbox::default();
    for width in [80, 120, 200] {
        let text = screen_text(&screen, &company, width, 37);
        assert!(
            text.contains("No enterprise has asked for an offer yet")
                && text.contains("set_targeted_ad_spend"),
            "{text}"
        );
    }
    for pane in 0..screen.pane_count() {
        screen.set_focus(pane);
        let text = zoomed_text(&screen, &company, 80, 21);
        assert!(text.contains("No enterprise has asked") && !text.contains("shows more"), "pane {pane}: {text}");
    }
    for action in
        [Action::SendOffer, Action::RejectOffer, Action::InboxRules].into_iter().chain(THREAD_ACTIONS)
    {
        assert!(
            matches!(&handle_action(&mut screen, action, &company)[..], [Effect::ShowError(_)]),
            "{action:?}"
        );
    }
    draw_at_all_sizes(&mut screen, &company);
}

#[test]
fn answered_enterprise_stays_in_the_list() {
    let mut session = session_with_negotiations();
    let before = DisplayedCompany::from_session(&session);
    let mut screen: Inbox = loaded_screen(&mut session, &before);
    assert_eq!(screen.rows.len(), before.observation.waiting.len());
    let first = screen.selected_thread().expect("a thread").clone();
    assert_eq!(first.messages.first().map(|turn| turn.sender.as_str()), Some("system"));
    assert!(screen.threads.enterprise(first.customer).is_some_and(|firm| firm.group == first.group));
    let [Effect::EditSql(sql)] = &handle_action(&mut screen, Action::InboxSql, &before)[..] else {
        panic!("no query")
    };
    assert_eq!(session.query(sql).expect("rows").rows.len(), first.messages.len());
    let [Effect::ConfirmCall { tool, arguments, text }] =
        &handle_action(&mut screen, Action::SendOffer, &before)[..]
    else {
        panic!("no call")
    };
    assert!(text.starts_with(&format!("Offer to {}, ", first.customer_label())), "{text}");
    assert!(text.contains("plan C at $55.00 per seat: ") && text.contains("cannot be taken back"), "{text}");
    session.call(tool, arguments, Via::Form).expect("sent");
    let after = DisplayedCompany::from_session(&session);
    let mut screen: Inbox = loaded_screen(&mut session, &after);
    assert_eq!(screen.rows.len(), before.observation.waiting.len() - 1);
    handle_action(&mut screen, Action::NextThreadView, &after);
    let thread = screen.selected_thread().expect("the answered thread");
    assert_eq!((thread.customer, thread.state), (first.customer, ThreadState::WaitingForCustomer));
    assert_eq!(thread.last_offer(), [(Plan::C, 55.0)]);
    assert_eq!(thread.seats, first.seats);
    let effects = handle_action(&mut screen, Action::SendOffer, &after);
    assert!(
        matches!(&effects[..], [Effect::ConfirmCall { text, .. }] if text.contains("uses up another turn"))
    );
}

#[test]
fn offer_shows_margin_and_source_of_usage() {
    let mut session = session_with_negotiations();
    let company = DisplayedCompany::from_session(&session);
    let mut screen: Inbox = loaded_screen(&mut session, &company);
    let thread = screen.selected_thread().expect("a thread").clone();
    let money = offer_economics(&thread, &[(Plan::C, 55.0)], &plan_economics(&company, &screen.usage))[0];
    let margin = novamind_base::formatting::percent(money.margin().expect("a margin"), 0);
    let compute = novamind_base::formatting::dollars(money.compute_cost.expect("compute"));
    let text = screen_text(&screen, &company, 120, 37);
    for words in ["compute", "margin", &margin, &compute, "units/seat/day", " left "] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
    assert!(screen_text(&screen, &company, 200, 57).contains("vs. ask"));
    let small = screen_text(&screen, &company, 80, 21);
    assert!(small.contains(&format!("C est. compute {compute}/mo, margin {margin}")), "{small}");
    let keys = KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 20 };
    for focus in 0..Screen::pane_count(&screen) {
        screen.set_focus(focus);
        let figure = screen.figure(&context).expect("a figure");
        session
            .query(&figure.sql.expect("rows"))
            .unwrap_or_else(|refusal| panic!("{}: {refusal}", figure.title));
    }
    screen.set_focused_pane(InboxPane::List);
    let turns = screen.figure(&context).and_then(|figure| figure.sql).expect("rows");
    assert_eq!(session.query(&turns).expect("rows").rows.len(), thread.messages.len());
}

/// Returns a run in which leads received first offers with several plans and prices over three weeks. Some leads
/// received two offers.
fn run_with_first_offers() -> novamind_session::Session {
    let mut session = session_with_negotiations();
    for week in 0..3 {
        for (at, thread) in session.company().observe().waiting.into_iter().enumerate() {
            let offer = [json!([["C", 16.5]]), json!([["B", 12.0], ["C", 16.5]]), json!([["C", 129.99]])];
            let deals = json!({ "deals": [[thread.customer, offer[(at + week) % 3]]] });
            session.call("send_enterprise_deal", &deals, Via::Form).expect("sent");
        }
        let forecasts = session.company().naive_forecasts();
        session.advance("as planned", &forecasts, Via::Form, &mut |_| {}).expect("a week");
    }
    session
}

#[test]
fn first_offer_outcomes_agree_with_turns_and_subscriptions() {
    let mut session = run_with_first_offers();
    let company = DisplayedCompany::from_session(&session);
    let mut screen: Inbox = loaded_screen(&mut session, &company);
    let effects = handle_action(&mut screen, Action::InboxOutcomes, &company);
    assert!(matches!(&effects[..], [Effect::Read(Reading::FirstOffers)]), "{effects:?}");
    assert!(screen_text(&screen, &company, 80, 21).contains("reading …"));
    let keys = KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 20 };
    let rows = session.query(Reading::FirstOffers.sql()).expect("rows");
    screen.apply_rows(Reading::FirstOffers, &rows, &context);
    let cells: Vec<Vec<String>> = {
        let table = OutcomesPane.table(&screen).expect("a table");
        table.rows().iter().map(|row| row.iter().map(|cell| cell.text.clone()).collect()).collect()
    };
    assert!(cells.len() >= 5, "{cells:?}");
    let mut threads = 0.0;
    for (at, row) in cells.iter().enumerate() {
        let number = |text: &str| parse_number(&text.replace(',', "")).expect("a number");
        let (low, high) = row[3].split_once('–').expect("a band");
        let of_row = format!(
            "FROM customers JOIN subscriptions USING (customer_id) JOIN (
                 SELECT thread_id, customer_id, offer_json ->> '$[0].plan' || coalesce('+' || (offer_json ->> '$[1].plan'), '')
                     || coalesce('+' || (offer_json ->> '$[2].plan'), '') AS offered, min(day) AS day,
                     offer_json ->> '$[0].price_per_seat' AS price
                 FROM enterprise_turns WHERE sender = 'agent' AND thread_type = 'new_lead' AND turn_number = 1
                 GROUP BY thread_id
             ) AS offer USING (customer_id)
             LEFT JOIN (SELECT DISTINCT thread_id, 1 AS yes FROM enterprise_turns WHERE close_reason = 'accepted') AS deal
                 USING (thread_id)
             WHERE group_id = '{}' AND offered = '{}' AND price BETWEEN {} AND {} AND day >= {} AND day < {}",
            row[1],
            row[2],
            number(low),
            number(high),
            7.0 * (number(&row[0]) - 1.0),
            7.0 * number(&row[0]),
        );
        let mut count = |condition: &str| {
            let rows = session.query(&format!("SELECT count(*) {of_row} {condition}")).expect("a count");
            number_at(&rows.rows[0], 0)
        };
        let (all, signed) = (count(""), count("AND deal.yes"));
        assert_eq!(number(&row[4]), all, "{row:?}");
        assert_eq!(number(&row[5]), signed, "{row:?}");
        assert_eq!(row[6], format!("{:.1} %", 100.0 * signed / all), "{row:?}");
        assert_eq!(number(&row[7]), count("AND deal.yes IS NULL AND status <> 'lead'"), "{row:?}");
        assert_eq!(number(&row[8]), count("AND deal.yes IS NULL AND status = 'lead'"), "{row:?}");
        threads += all;
        // The query for a row returns the threads of the row.
        OutcomesPane.table_mut(&mut screen).expect("a table").select(at);
        let sql = screen.figure(&context).and_then(|figure| figure.sql).expect("rows");
        let behind = session.query(&sql).expect("rows");
        assert_eq!(behind.rows.len() as f64, all, "{row:?}");
        assert_eq!(behind.rows.iter().map(|turn_row| number_at(turn_row, 5)).sum::<f64>(), signed, "{row:?}");
    }
    let first = "SELECT count(DISTINCT thread_id) FROM enterprise_turns WHERE sender = 'agent' AND thread_type = 'new_lead'";
    assert_eq!(threads, number_at(&session.query(first).expect("a count").rows[0], 0));
    let led = handle_action(&mut screen, Action::Open, &company);
    assert!(
        matches!(&led[..], [Effect::RunSql(sql)] if sql == include_str!("../../../../assets/queries/first-offers.sql"))
    );
    for (width, height) in [(60, 13), (80, 21), (120, 37), (200, 57)] {
        let text = screen_text(&screen, &company, width, height);
        // Columns that do not fit are counted.
        let last = if [60, 120].contains(&width) { ["signed", " →"] } else { ["share", &cells[0][6]] };
        for words in ["y first offer and week", "$/seat", "threads", "Your offer"].into_iter().chain(last) {
            assert!(text.contains(words), "{words} at {width}x{height} in\n{text}");
        }
    }
    draw_at_all_sizes(&mut screen, &company);
}

#[test]
fn outcomes_replace_the_list_until_closed() {
    let (mut screen, company) = crowded_screen();
    press(&mut screen, &company, "O");
    assert_eq!((screen.focus, Screen::escape_depth(&screen)), (InboxPane::Outcomes, 1));
    screen.set_focused_pane(InboxPane::Offer);
    press(&mut screen, &company, "esc");
    assert_eq!(screen.focus, InboxPane::Outcomes, "esc returns from the offer to the outcomes");
    for marks in ["space", "a"] {
        assert!(matches!(&press(&mut screen, &company, marks).0[..], [Effect::ShowError(_)]));
    }
    assert_eq!(screen.marked.len(), 0);
    for closes in ["esc", "O", "o"] {
        press(&mut screen, &company, closes);
        assert_eq!((screen.focus, Screen::escape_depth(&screen)), (InboxPane::List, 0), "{closes}");
        press(&mut screen, &company, "O");
    }
    screen.apply_rows(
        Reading::FirstOffers,
        &QueryResult::default(),
        &ScreenContext { company: &company, keys: &KeyBindings::bundled(), page_rows: 20 },
    );
    assert!(screen_text(&screen, &company, 60, 13).contains("No new lead has been sent an offer yet"));
    screen.show_thread(7, &company);
    assert_eq!(screen.focus, InboxPane::List);
}

#[test]
fn thousands_of_marked_threads_are_answered_at_once() {
    let (mut screen, mut company) = crowded_screen_with(3_500);
    press(&mut screen, &company, "a");
    assert_eq!(screen.marked.len(), 3_500);
    press(&mut screen, &company, "a");
    // Offers are sent to the first half of the threads while the first thread is selected. The list then shows the
    // second half of the threads.
    let (effects, _) =
        press(&mut screen, &company, "R ctrl-n 'offer\u{a0}where\u{a0}customer<2750:\u{a0}B\u{a0}85' ctrl-s");
    let [Effect::ConfirmCalls { calls, .. }] = &effects[..] else { panic!("{effects:?}") };
    let sent = calls[0].1["deals"].as_array().expect("deals").clone();
    assert_eq!(sent.len(), 1_749);
    let next = screen.table.visible_rows().iter().filter_map(|row| screen.thread_in_row(*row)).nth(1_749);
    apply_answers(&mut screen, &mut company, &sent);
    assert_eq!((screen.rows.len(), screen.selected_thread().map(|thread| thread.number)), (1_751, next));
}

fn confirmation(effects: &[Effect]) -> &str {
    match effects {
        [Effect::ConfirmCall { text, .. }] => text,
        other => panic!("no tool call: {other:?}"),
    }
}

#[test]
fn offer_written_for_one_thread_becomes_the_bulk_offer() {
    let (mut screen, company) = crowded_screen_with(3);
    // Plan C at $45 for the selected thread. Then all threads are marked.
    press(&mut screen, &company, "p b e '45' enter esc a");
    let offer = screen.current_offer(&company);
    assert_eq!(offer.describe([0.0; 3]), "plan C at $45.00", "{offer:?}");
    let (effects, _) = press(&mut screen, &company, "ctrl-s");
    assert!(sent_deals(&effects).iter().all(|deal| deal[1] == json!([["C", 45.0]])), "{effects:?}");
    let text = confirmation(&effects);
    assert!(text.contains("All receive plan C at $45.00.") && !text.contains("replaces"), "{text}");
    // A change of the bulk offer does not hide that an offer was written for one thread.
    let written = screen.selected_thread().expect("a thread").customer_label();
    let (effects, _) = press(&mut screen, &company, "e '50' ctrl-s");
    let text = confirmation(&effects);
    assert!(text.contains(&format!("It replaces what you wrote for {written}.")), "{text}");
    // An offer that is written later starts the next bulk offer.
    press(&mut screen, &company, "esc esc a e '39' enter esc a");
    assert_eq!(screen.current_offer(&company).describe([0.0; 3]), "plan C at $39.00");
}

#[test]
fn first_plan_is_the_one_that_can_suit_the_enterprise() {
    let (mut screen, company) = crowded_screen_with(2);
    assert!(screen.current_offer(&company).describe([0.0; 3]).starts_with("plan B at 100%"));
    let mut session = session_with_negotiations();
    let known = DisplayedCompany::from_session(&session);
    let loaded: Inbox = loaded_screen(&mut session, &known);
    let thread = loaded.selected_thread().expect("a thread").clone();
    let fit = known.fit(Group::parse(&thread.group).expect("a group")).expect("a known group");
    let usage = thread.waiting_thread.as_ref().expect("it waits").required_quota;
    assert_eq!(Some(loaded.suitable_plan(&thread, &known)), fit.cheapest_suitable_plan(usage));
    // A subscriber keeps its plan, and a plan that the enterprise named comes first.
    let subscriber = |screen: &Inbox, company: &DisplayedCompany| {
        let mut thread = screen.selected_thread().expect("a thread").clone();
        thread.customer = 1002;
        screen.suitable_plan(&thread, company)
    };
    let (_, _, mut firms) = crowded_company(2);
    firms.rows[1][7] = Datum::Text("subscribed".to_owned());
    firms.rows[1][8] = Datum::Text("C".to_owned());
    let keys = KeyBindings::bundled();
    screen.apply_rows(
        Reading::Companies,
        &firms,
        &ScreenContext { company: &company, keys: &keys, page_rows: 20 },
    );
    assert_eq!(subscriber(&screen, &company), Plan::C);
}

#[test]
fn bulk_confirmation_names_offers_at_a_loss() {
    let mut session = session_with_negotiations();
    let company = DisplayedCompany::from_session(&session);
    let mut screen: Inbox = loaded_screen(&mut session, &company);
    assert!(screen.rows.len() > 1, "several threads");
    let (effects, _) = press(&mut screen, &company, "a b e '0.01' ctrl-s");
    let text = confirmation(&effects);
    let first = screen.targets()[0].customer_label();
    assert!(text.contains(&format!("Estimated loss after compute: {first} ")), "{text}");
    assert!(text.contains("$0.01 (-") && text.contains("at an estimated loss"), "{text}");
    let (effects, _) = press(&mut screen, &company, "e '900' ctrl-s");
    assert!(!confirmation(&effects).contains("loss"), "{}", confirmation(&effects));
}

#[test]
fn terms_name_the_deal_of_the_current_price() {
    let enterprise = |deal_day| model::Enterprise {
        plan: "C".to_owned(),
        price: 55.0,
        since_day: 46,
        deal_day,
        ..model::Enterprise::default()
    };
    for deal_day in [None, Some(46)] {
        assert_eq!(enterprise(deal_day).describe_terms(), "plan C at $55.00 since day 46");
    }
    assert_eq!(
        enterprise(Some(60)).describe_terms(),
        "plan C at $55.00 since the deal of day 60; subscriber since day 46"
    );
}

#[test]
fn accepted_offer_is_not_an_asked_price() {
    let turn = |price: Option<f64>, closing_reason: &str| novamind_rules::Turn {
        number: 2,
        sender: "customer".to_owned(),
        text: "We accept plan C at $48.00.".to_owned(),
        offers: Vec::new(),
        price,
        day: 3,
        closing_reason: closing_reason.to_owned(),
    };
    let thread = |messages| Thread { messages, ..Thread::default() };
    assert_eq!(thread(vec![turn(Some(48.0), "accepted")]).asked_price(), None);
    let asked = thread(vec![turn(Some(40.0), ""), turn(Some(48.0), "accepted")]);
    assert_eq!(asked.asked_price().map(|(_, price)| price), Some(40.0));
}

#[test]
fn first_turn_names_the_kind_of_the_thread() {
    let (mut screen, company) = crowded_screen();
    press(&mut screen, &company, "/ 'reten' enter");
    let text = screen_text(&screen, &company, 120, 37);
    assert!(text.contains("considers cancelling its subscription"), "{text}");
    assert!(!text.contains("asks for an offer"), "{text}");
}
