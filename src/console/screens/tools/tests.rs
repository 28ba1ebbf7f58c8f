use serde_json::json;

use super::*;
use crate::action::Scope;
use crate::keys::Keys;
use crate::screens::Screen;
use crate::test_kit::{act, company, drawn, on_screen, played, shown, sweep};
use novamind_record::trajectory::record::Via;
use novamind_session::identifiers::Plan;
use novamind_tools::{Refusal, ToolId};
use novamind_tui::chord::Chord;
use novamind_worker::request::Request;

/// Types into the form of a tool. Named keys are pressed, other strings are typed.
fn typed(tool: ToolId, keys: &[&str]) -> (Tools, Vec<Effect>) {
    let (company, bindings) = (company(), Keys::shipped());
    let look = Look { company: &company, keys: &bindings, page: 10 };
    let mut tools = Tools::default();
    tools.show(tool, &company);
    let mut effects = Vec::new();
    for key in keys {
        let chord = Chord::parse(key).expect(key);
        let event = chord.event();
        let text = tools.scopes()[0].is_text() && chord.is_text();
        let scopes: Vec<Scope> =
            tools.scopes().into_iter().filter(|scope| !text || scope.is_text()).collect();
        effects = match bindings.action(&scopes, chord) {
            Some(action) => tools.act(action, &look),
            None => tools.key(&event, &look),
        };
    }
    (tools, effects)
}

#[test]
fn enter_edits_a_cell_and_arrows_go_on_in_the_next() {
    let (_, effects) =
        typed(ToolId::SetPrices, &["enter", "1", "2", "down", "2", "5", "down", "5", "5", "ctrl-s"]);
    let Some(Effect::Request(Request::Call { tool, arguments })) = effects.first() else {
        panic!("{effects:?}")
    };
    assert_eq!((*tool, arguments), (ToolId::SetPrices, &json!({"A": 12, "B": 25, "C": 55})));
}

#[test]
fn down_in_the_last_row_goes_on_typing_there() {
    let (tools, _) =
        typed(ToolId::SetPrices, &["enter", "1", "2", "down", "2", "5", "down", "5", "down", "5"]);
    let form = tools.seen_form().expect("a form");
    assert!(form.is_typing());
    assert_eq!(form.sheet.arguments(), Ok(json!({"A": 12, "B": 25, "C": 55})));
}

#[test]
fn a_second_reset_brings_the_draft_back() {
    let keys = ["enter", "1", "2", "down", "2", "5", "enter", "r"];
    let (tools, said) = typed(ToolId::SetPrices, &keys);
    assert!(!tools.holds_unsent_text());
    assert!(matches!(&said[..], [Effect::Say(text)] if text.starts_with("2 values discarded")), "{said:?}");
    let (tools, said) = typed(ToolId::SetPrices, &[&keys[..], &["r"]].concat());
    assert_eq!(tools.seen_form().expect("a form").sheet.arguments(), Ok(json!({"A": 12, "B": 25})));
    assert!(matches!(said.last(), Some(Effect::Say(text)) if text == "2 values restored"), "{said:?}");
    let (_, said) = typed(ToolId::SetPrices, &["r"]);
    assert!(matches!(&said[..], [Effect::Complain(_)]), "{said:?}");
}

#[test]
fn an_empty_cell_says_that_it_has_nothing_to_copy() {
    let (_, said) = typed(ToolId::SetTargetedAdSpend, &["="]);
    assert!(matches!(&said[..], [Effect::Complain(text)] if text.contains("empty")), "{said:?}");
}

#[test]
fn tab_leaves_the_last_cell_as_it_was_typed_and_a_form_opens_at_its_first() {
    let (mut tools, _) =
        typed(ToolId::SetPrices, &["enter", "1", "2", "tab", "2", "5", "tab", "5", "5", "tab"]);
    let form = tools.seen_form().expect("a form");
    assert!(!form.is_typing());
    assert_eq!(form.sheet.arguments(), Ok(json!({"A": 12, "B": 25, "C": 55})));
    assert_eq!(tools.place_path().as_deref(), Some("C"));
    tools.show(ToolId::SetPrices, &company());
    assert_eq!(tools.place_path().as_deref(), Some("A"));
}

#[test]
fn leaving_the_form_ends_typing_and_keeps_what_was_typed() {
    let (mut tools, _) = typed(ToolId::SetPrices, &["enter", "1", "2", "down", "backspace"]);
    assert!(tools.seen_form().is_some_and(Form::is_typing));
    // A click on the list while a number is empty in the form.
    tools.focus_on(ToolsPane::List);
    let form = tools.seen_form().expect("a form");
    assert!(!form.is_typing(), "enter must start typing, not end it");
    assert_eq!(form.sheet.arguments(), Ok(json!({"A": 12})), "a cleared number is not sent");
    let (mut tools, _) = typed(ToolId::SetPrices, &["enter", "1", "2"]);
    tools.focus_on(ToolsPane::List);
    assert_eq!(tools.typed_arguments(), Some(json!({"A": 12})));
}

#[test]
fn a_digit_begins_a_number_and_letters_type_nothing() {
    let (tools, _) = typed(ToolId::SetPrices, &["9", "5", "enter", "2"]);
    assert_eq!(tools.seen_form().expect("a form").sheet.arguments(), Ok(json!({"A": 95, "B": 2})));
    let (tools, _) = typed(ToolId::SetPrices, &["9", "5", "esc"]);
    assert!(!tools.seen_form().expect("a form").sheet.is_changed(), "esc restores the previous value");
    let (tools, _) = typed(ToolId::SetTargetedAdSpend, &["v", "t"]);
    let form = tools.seen_form().expect("a form");
    assert!(!form.is_typing() && !form.sheet.is_changed(), "{:?}", form.sheet.arguments());
}

#[test]
fn one_quota_is_changed_alone_and_an_emptied_number_stays_what_it_was() {
    let mut session = played(1);
    let company = Company::of(&session);
    let keys = Keys::shipped();
    let look = Look { company: &company, keys: &keys, page: 10 };
    let mut tools: Tools = shown(&mut session, &company);
    tools.show(ToolId::SetUsageQuotas, &company);
    let press = |tools: &mut Tools, key: &str| {
        let chord = Chord::parse(key).expect(key);
        let typed = tools.scopes()[0].is_text() && chord.is_printable();
        match keys.action(&tools.scopes(), chord).filter(|_| !typed) {
            Some(action) => tools.act(action, &look),
            None => tools.key(&chord.event(), &look),
        }
    };
    for key in ["down", "enter", "9", "0", "0", "down", "backspace", "enter"] {
        press(&mut tools, key);
    }
    let effects = press(&mut tools, "ctrl-s");
    let [Effect::Request(Request::Call { tool, arguments })] = &effects[..] else { panic!("{effects:?}") };
    assert_eq!(arguments, &json!({"A": 60_000, "B": 900, "C": 1_200_000}));
    session.call(tool, arguments, Via::Form).expect("all three quotas were sent");
}

#[test]
fn after_a_call_the_keys_are_those_of_the_list_again() {
    let (mut tools, _) = typed(ToolId::SetPrices, &["enter", "1", "2", "enter"]);
    let (company, keys) = (company(), Keys::shipped());
    let look = Look { company: &company, keys: &keys, page: 10 };
    let refused = Refusal::at("A", "price_not_positive", "no");
    tools.hear(&News::Called(ToolId::SetPrices, Err(refused), company.clone().into()), &look);
    assert_eq!(tools.focus, ToolsPane::Form, "a rejected call keeps the focus in its form");
    let set = played(0).call("set_prices", &json!({"A": 12}), Via::Form).expect("a price");
    tools.hear(&News::Called(ToolId::SetPrices, Ok(set.into()), company.clone().into()), &look);
    assert_eq!((tools.focus, tools.scopes()), (ToolsPane::List, vec![Scope::List]));
    assert!(tools.seen_form().expect("a form").answer.is_some());
    tools.hear(&News::Restored("undone", Ok(Vec::new()), company.clone().into()), &look);
    assert!(tools.seen_form().expect("a form").answer.is_none(), "an undo invalidates the answer");
}

#[test]
fn deals_are_typed_as_json_and_asked_about_before_they_go_out() {
    let keys = [
        "enter", "[", "[", "7", ",", "[", "[", "\"", "B", "\"", ",", "3", "0", "]", "]", "]", "]", "enter",
        "ctrl-s",
    ];
    let (tools, effects) = typed(ToolId::SendEnterpriseDeal, &keys);
    let Some(Effect::ConfirmCall { tool, arguments, text }) = effects.first() else { panic!("{effects:?}") };
    assert_eq!((*tool, arguments), (ToolId::SendEnterpriseDeal, &json!({"deals": [[7, [["B", 30]]]]})));
    assert!(text.contains("cannot be undone"), "{text}");
    assert!(tools.holds_unsent_text());
    let (_, effects) = typed(ToolId::SendEnterpriseDeal, &["enter", "[", "7", "enter", "ctrl-s"]);
    assert!(
        matches!(&effects[..], [Effect::Complain(text)] if text.starts_with("deals: enter a list")),
        "{effects:?}"
    );
    let (_, effects) = typed(ToolId::RejectEnterpriseDeal, &["ctrl-s"]);
    assert!(
        matches!(&effects[..], [Effect::Request(Request::Call { .. })]),
        "the tool names the missing argument: {effects:?}"
    );
}

#[test]
fn escape_brings_back_what_was_there() {
    let (tools, _) = typed(ToolId::SetPrices, &["enter", "1", "2", "enter", "up", "enter", "9", "9", "esc"]);
    assert_eq!(tools.seen_form().expect("a form").sheet.arguments(), Ok(json!({"A": 12})));
}

#[test]
fn the_same_value_goes_down_a_column() {
    // The value of the focused cell, or of the cell that enter has just left.
    for keys in [&["right", "enter", "4", "0", "enter", "up", "="][..], &["right", "4", "0", "enter", "="]] {
        let (tools, _) = typed(ToolId::SetTargetedAdSpend, keys);
        let arguments = tools.seen_form().expect("a form").sheet.arguments().expect("numbers");
        let matrix = arguments["targeted_spend"].as_object().expect("a matrix");
        assert_eq!(matrix.len(), 5);
        assert!(matrix.values().all(|groups| groups == &json!({"S2": 40})), "{matrix:?}");
    }
    let (_, said) = typed(ToolId::SetTargetedAdSpend, &["right", "4", "0", "enter", "down", "="]);
    assert!(matches!(&said[..], [Effect::Complain(text)] if text.contains("empty")), "{said:?}");
}

#[test]
fn a_form_without_changes_is_not_sent_and_a_wrong_cell_is_named() {
    let (_, effects) = typed(ToolId::SetPrices, &["ctrl-s"]);
    assert!(matches!(&effects[..], [Effect::Complain(text)] if text.contains("Nothing has changed")));
    let (_, effects) = typed(ToolId::SetPrices, &["enter", "1", "-", "ctrl-s"]);
    assert!(matches!(&effects[..], [Effect::Complain(text)] if text.starts_with("A: enter a number")));
}

#[test]
fn drafts_stay_when_another_tool_is_looked_at() {
    let (mut tools, _) = typed(ToolId::SetPrices, &["enter", "1", "2", "enter"]);
    let (company, keys) = (company(), Keys::shipped());
    let look = Look { company: &company, keys: &keys, page: 10 };
    tools.show(ToolId::SetDailySpend, &company);
    tools.renew(&look);
    tools.show(ToolId::SetPrices, &company);
    assert_eq!(tools.seen_form().expect("a form").sheet.arguments(), Ok(json!({"A": 12})));
    assert!(tools.holds_unsent_text());
}

#[test]
fn a_draft_shows_old_and_new_and_is_offered_again_after_esc() {
    let (_, company, mut tools) = on_screen::<Tools>(2);
    tools.show(ToolId::SetPrices, &company);
    let keys = Keys::shipped();
    let look = Look { company: &company, keys: &keys, page: 10 };
    for key in ["enter", "1", "4", "enter", "esc"] {
        let chord = Chord::parse(key).expect(key);
        match keys.action(&tools.scopes(), chord) {
            Some(action) => tools.act(action, &look),
            None => tools.key(&chord.event(), &look),
        };
    }
    assert_eq!(tools.focus, ToolsPane::List, "esc leaves the form");
    for (width, height) in [(120, 37), (200, 57)] {
        let text = drawn(&tools, &company, width, height);
        for words in [
            "* 1 draft",
            " *set_prices",
            "PRC",
            "* draft, kept until sent or reset: A 12 → 14",
            "Takes effect on day 15.",
        ] {
            assert!(text.contains(words), "{words} in\n{text}");
        }
    }
    let effects = act(&mut tools, Action::Open, &company);
    assert!(effects.is_empty() && tools.holds_unsent_text());
    act(&mut tools, Action::ResetForm, &company);
    assert!(!tools.holds_unsent_text());
}

#[test]
fn a_matrix_says_what_its_sums_were_and_what_a_channel_brought() {
    let (mut session, company, mut tools) = on_screen::<Tools>(5);
    tools.show(ToolId::SetTargetedAdSpend, &company);
    let form = tools.form(&company).expect("a form");
    let place = form.sheet.place_of("targeted_spend.content_marketing.S1").expect("a cell");
    form.at = place;
    form.sheet.slot_mut(place).expect("a slot").draft = Some(Field::of("900"));
    let rows = session
        .query("SELECT sum(leads_generated), sum(spend) FROM ad_channel_leads WHERE channel_id = 'content_marketing' AND day > 7")
        .expect("rows")
        .rows;
    let leads = novamind_database::number_at(&rows[0], 0);
    let spend = novamind_database::number_at(&rows[0], 1);
    let leads_in_words = novamind_base::notation::grouped(leads, 0);
    let words = format!("content_marketing × S1, last four weeks: {leads_in_words} leads for");
    let text = drawn(&tools, &company, 200, 57);
    let rate = format!("S1 {:.0}", leads / spend * 1000.0);
    for words in
        [words.as_str(), "was (+150)", "leads/$1k (yours)", &rate, "content_marketing × S1 750 → 900"]
    {
        assert!(text.contains(words), "{words} in\n{text}");
    }
    assert!(!drawn(&tools, &company, 80, 21).contains("(yours)"));
    tools.focus_on(ToolsPane::Form);
    sweep(&mut tools, &company);
}

#[test]
fn calls_of_the_week_and_drafts_go_to_a_file() {
    let mut session = played(1);
    session.call("set_prices", &json!({"A": 13}), Via::Form).expect("prices");
    let company = Company::of(&session);
    let mut tools: Tools = shown(&mut session, &company);
    tools.show(ToolId::SetCapacityTier, &company);
    let form = tools.form(&company).expect("a form");
    let place = form.at;
    form.sheet.slot_mut(place).expect("a slot").draft = Some(Field::of("3"));
    let effects = act(&mut tools, Action::SaveCalls, &company);
    let [Effect::Write(name, contents)] = &effects[..] else { panic!("{effects:?}") };
    let text = String::from_utf8(contents.clone()).expect("text");
    assert_eq!(name, "calls.txt");
    let lines: Vec<&str> = text.lines().skip(1).collect();
    let calls = [
        "pricing.set_prices({\"A\": 13})",
        "# not sent yet",
        "infrastructure.set_capacity_tier({\"tier\": 3})",
    ];
    assert_eq!(lines, calls);
}

#[test]
fn a_field_names_its_term_and_its_history() {
    let (mut session, company, mut tools) = on_screen::<Tools>(3);
    let keys = Keys::shipped();
    let look = Look { company: &company, keys: &keys, page: 10 };
    let mut asked = std::collections::BTreeSet::new();
    for tool in CATALOGUE {
        let spec = tool.spec();
        tools.show(spec.id, &company);
        let places = tools.seen_form().map_or(Vec::new(), |form| form.sheet.places().collect());
        for place in places {
            tools.form(&company).expect("a form").at = place;
            let figure = tools.figure(&look).expect("a figure");
            let (own, argument) = figure.term.split_once('.').expect("tool.argument");
            assert!(
                own == spec.name() && spec.arguments.iter().any(|it| it.name == argument),
                "{}",
                figure.term
            );
            if let Some(sql) = figure.sql.filter(|sql| asked.insert(sql.clone())) {
                session.query(&sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
            }
        }
        tools.focus_on(ToolsPane::List);
        assert_eq!(tools.figure(&look).expect("a figure").term, spec.name());
    }
    tools.show(ToolId::SetPrices, &company);
    tools.form(&company).expect("a form").at = Default::default();
    let figure = tools.figure(&look).expect("a figure");
    assert_eq!(figure.term, "set_prices.A");
    let rows = session.query(&figure.sql.expect("rows")).expect("rows").rows;
    assert_eq!(novamind_database::number_at(rows.last().expect("a row"), 1), 12.0);
}

#[test]
fn forms_show_figures_and_never_the_names_of_parameters() {
    let company = company();
    let mut tools = Tools::default();
    for spec in CATALOGUE.iter().map(|tool| tool.spec()) {
        tools.show(spec.id, &company);
        let text = drawn(&tools, &company, 200, 120);
        let named = |after: &str| after.split(['}', ' ']).next().is_some_and(|name| name.contains('.'));
        let raw = text.split('{').skip(1).any(named);
        assert!(!raw, "{}: {text}", spec.name());
    }
    tools.show(ToolId::SetTargetedAdSpend, &company);
    assert!(drawn(&tools, &company, 200, 57).contains("$0.50 for every lead"));
}

#[test]
fn a_matrix_keeps_its_totals_and_marks_the_columns_beyond_its_edges() {
    let company = company();
    let look_at = |column: usize| {
        let mut keys = vec!["right"; column];
        keys.push("enter");
        let (tools, _) = typed(ToolId::SetTargetedAdSpend, &keys);
        let text = drawn(&tools, &company, 80, 21);
        text.lines().find(|line| line.contains("total")).expect("a head").to_owned()
    };
    let (first, last) = (look_at(0), look_at(5));
    assert!(first.contains('›') && !first.contains('‹') && first.contains("S1"), "{first}");
    assert!(last.contains('‹') && !last.contains('›') && last.contains("E3"), "{last}");
}

#[test]
fn the_keys_of_a_form_say_that_enter_edits() {
    let (tools, _) = typed(ToolId::SetPrices, &[]);
    let text = drawn(&tools, &company(), 120, 37);
    assert!(text.contains("enter edit the value") && !text.contains("type a number"), "{text}");
    let (tools, _) = typed(ToolId::SetPrices, &["enter"]);
    assert!(!drawn(&tools, &company(), 120, 37).contains("enter edit"));
}

#[test]
fn columns_of_projects_stand_apart() {
    let lines = reference::reference(ToolId::StartResearchProject, &company());
    assert!(lines.len() > 10, "{lines:?}");
    let ends = lines[0].find("cost").expect("a column") + "cost".len();
    for line in &lines[1..] {
        let (cost, after) = (&line[..ends], &line[ends..]);
        assert!(cost.ends_with(|last: char| last.is_ascii_digit()) && after.starts_with("  "), "{line}");
        assert!(cost.contains("  $"), "{line}");
    }
}

#[test]
fn a_small_window_shows_every_value_and_the_margin_of_every_plan() {
    let (_, company, mut screen) = on_screen::<Tools>(6);
    let sold: Vec<&str> = Plan::ALL
        .into_iter()
        .filter(|plan| screen.sales.of_plan(*plan).usage().is_some())
        .map(Plan::id)
        .collect();
    assert!(sold.len() >= 2, "{sold:?}");
    for tool in [ToolId::SetPrices, ToolId::SetModelTiers, ToolId::SetUsageQuotas] {
        for draft in [json!({}), json!({"A": 4, "B": 3, "C": 5})] {
            screen.prefill(tool, &draft, &company);
            screen.focus_on(ToolsPane::Form);
            for (width, height) in [(60, 13), (80, 21), (120, 37), (200, 57)] {
                let text = drawn(&screen, &company, width, height);
                let holds =
                    |words: &[&str]| text.lines().any(|line| words.iter().all(|word| line.contains(word)));
                let at = format!("{tool} {draft} at {width}x{height} in\n{text}");
                for plan in ["A", "B", "C"] {
                    let now = novamind_tui::text::number(company.setting(tool, plan));
                    assert!(holds(&[&format!(" {plan}  "), &now]), "value of {plan}: {at}");
                }
                for plan in &sold {
                    assert!(holds(&[&format!(" {plan} "), "paid $", "%"]), "margin of {plan}: {at}");
                }
            }
        }
    }
}

#[test]
fn code_is_written_in_lines_and_pasted_as_it_is() {
    let keys = ["enter", "#", "space", "p", "enter", "x"];
    let (tools, _) = typed(ToolId::PythonExec, &keys);
    assert_eq!(tools.scopes()[0], Scope::Editor);
    let text = drawn(&tools, &company(), 80, 21);
    assert!(text.contains("code, line 2 of 2"), "{text}");
    let (_, effects) = typed(ToolId::PythonExec, &[&keys[..], &["ctrl-s"]].concat());
    let [Effect::Request(Request::Call { arguments, .. })] = &effects[..] else { panic!("{effects:?}") };
    assert_eq!(arguments["code"], "# p\nx");
    // Reopened, the form has the code and shows its number of lines.
    let (mut tools, _) = typed(ToolId::PythonExec, &[&keys[..], &["esc"]].concat());
    let (company, bindings) = (company(), Keys::shipped());
    let text = drawn(&tools, &company, 80, 21);
    assert!(text.contains("# p … 2 lines"), "{text}");
    let look = Look { company: &company, keys: &bindings, page: 10 };
    // The output is shown below the code until the code changes.
    let said = json!({"returncode": 0, "stdout": "first\nsecond\n", "stderr": ""});
    tools.forms.get_mut(&ToolId::PythonExec).expect("a form").answer = Some(Ok(said));
    let text = drawn(&tools, &company, 80, 21);
    assert!(text.contains("answered") && text.contains("first") && text.contains("second"), "{text}");
    assert_eq!(tools.unsent(), [ToolId::PythonExec]);
    tools.act(Action::Apply, &look);
    assert!(tools.unsent().is_empty(), "it was sent");
    tools.act(Action::ResetForm, &look);
    tools.paste("# python\nfor day in range(2):\n    print(day)\n", &look);
    let effects = tools.act(Action::Apply, &look);
    let [Effect::Request(Request::Call { arguments, .. })] = &effects[..] else { panic!("{effects:?}") };
    assert_eq!(arguments["code"], "# python\nfor day in range(2):\n    print(day)\n");
}
