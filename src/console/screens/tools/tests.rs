use serde_json::json;

use super::*;
use crate::action::Scope;
use crate::keys::KeyBindings;
use crate::screens::Screen;
use crate::test_kit::{handle_action, new_company, screen_text, played_screen, played_session, loaded_screen, draw_at_all_sizes};
use novamind_record::trajectory::record::Via;
use novamind_session::identifiers::Plan;
use novamind_tools::{Rejection, ToolId};
use novamind_tui::chord::Chord;
use novamind_worker::request::Request;

/// Enters keys into the form of a tool. Named keys are pressed, and other strings are typed.
fn form_after_keys(tool: ToolId, keys: &[&str]) -> (Tools, Vec<Effect>) {
    let (company, bindings) = (new_company(), KeyBindings::bundled());
    let context = ScreenContext { company: &company, keys: &bindings, page_rows: 10 };
    let mut tools = Tools::default();
    tools.show_tool(tool, &company);
    let mut effects = Vec::new();
    for key in keys {
        let chord = Chord::parse(key).expect(key);
        let event = chord.to_event();
        let text = tools.scopes()[0].is_text() && chord.is_text_input();
        let scopes: Vec<Scope> =
            tools.scopes().into_iter().filter(|scope| !text || scope.is_text()).collect();
        effects = match bindings.action(&scopes, chord) {
            Some(action) => tools.handle_action(action, &context),
            None => tools.handle_key(&event, &context),
        };
    }
    (tools, effects)
}

#[test]
fn down_arrow_continues_typing_in_the_next_cell() {
    let (_, effects) =
        form_after_keys(ToolId::SetPrices, &["enter", "1", "2", "down", "2", "5", "down", "5", "5", "ctrl-s"]);
    let Some(Effect::Request(Request::Call { tool, arguments })) = effects.first() else {
        panic!("{effects:?}")
    };
    assert_eq!((*tool, arguments), (ToolId::SetPrices, &json!({"A": 12, "B": 25, "C": 55})));
}

#[test]
fn down_in_the_last_row_continues_typing() {
    let (tools, _) =
        form_after_keys(ToolId::SetPrices, &["enter", "1", "2", "down", "2", "5", "down", "5", "down", "5"]);
    let form = tools.visible_form().expect("a form");
    assert!(form.is_typing());
    assert_eq!(form.sheet.arguments(), Ok(json!({"A": 12, "B": 25, "C": 55})));
}

#[test]
fn second_reset_restores_the_draft() {
    let keys = ["enter", "1", "2", "down", "2", "5", "enter", "r"];
    let (tools, effects) = form_after_keys(ToolId::SetPrices, &keys);
    assert!(!tools.has_unsent_text());
    assert!(matches!(&effects[..], [Effect::ShowStatus(text)] if text.starts_with("2 values discarded")), "{effects:?}");
    let (tools, effects) = form_after_keys(ToolId::SetPrices, &[&keys[..], &["r"]].concat());
    assert_eq!(tools.visible_form().expect("a form").sheet.arguments(), Ok(json!({"A": 12, "B": 25})));
    assert!(matches!(effects.last(), Some(Effect::ShowStatus(text)) if text == "2 values restored"), "{effects:?}");
    let (_, effects) = form_after_keys(ToolId::SetPrices, &["r"]);
    assert!(matches!(&effects[..], [Effect::ShowError(_)]), "{effects:?}");
}

#[test]
fn copying_an_empty_cell_shows_an_error() {
    let (_, effects) = form_after_keys(ToolId::SetTargetedAdSpend, &["="]);
    assert!(matches!(&effects[..], [Effect::ShowError(text)] if text.contains("empty")), "{effects:?}");
}

#[test]
fn tab_keeps_the_typed_value() {
    let (mut tools, _) =
        form_after_keys(ToolId::SetPrices, &["enter", "1", "2", "tab", "2", "5", "tab", "5", "5", "tab"]);
    let form = tools.visible_form().expect("a form");
    assert!(!form.is_typing());
    assert_eq!(form.sheet.arguments(), Ok(json!({"A": 12, "B": 25, "C": 55})));
    assert_eq!(tools.focused_path().as_deref(), Some("C"));
    tools.show_tool(ToolId::SetPrices, &new_company());
    assert_eq!(tools.focused_path().as_deref(), Some("A"));
}

#[test]
fn leaving_the_form_keeps_the_draft() {
    let (mut tools, _) = form_after_keys(ToolId::SetPrices, &["enter", "1", "2", "down", "backspace"]);
    assert!(tools.visible_form().is_some_and(ToolForm::is_typing));
    // The user clicks on the list while a number in the form is empty.
    tools.set_focused_pane(ToolsPane::List);
    let form = tools.visible_form().expect("a form");
    assert!(!form.is_typing(), "enter must start typing, not end it");
    assert_eq!(form.sheet.arguments(), Ok(json!({"A": 12})), "a cleared number is not sent");
    let (mut tools, _) = form_after_keys(ToolId::SetPrices, &["enter", "1", "2"]);
    tools.set_focused_pane(ToolsPane::List);
    assert_eq!(tools.typed_arguments(), Some(json!({"A": 12})));
}

#[test]
fn typing_starts_only_with_the_edit_key() {
    let (tools, _) = form_after_keys(ToolId::SetPrices, &["enter", "9", "5", "enter", "e", "2"]);
    assert_eq!(tools.visible_form().expect("a form").sheet.arguments(), Ok(json!({"A": 95, "B": 2})));
    let (tools, _) = form_after_keys(ToolId::SetPrices, &["enter", "9", "5", "esc"]);
    assert!(!tools.visible_form().expect("a form").sheet.is_changed(), "esc restores the previous value");
    for keys in [&["3", "5"][..], &["$"], &["-", "."], &["v", "t"], &["enter", "esc", "3"]] {
        let (tools, _) = form_after_keys(ToolId::SetTargetedAdSpend, keys);
        let form = tools.visible_form().expect("a form");
        assert!(!form.is_typing() && !form.sheet.is_changed(), "{keys:?}: {:?}", form.sheet.arguments());
    }
}

#[test]
fn changing_one_quota_keeps_the_others() {
    let mut session = played_session(1);
    let company = DisplayedCompany::from_session(&session);
    let keys = KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 10 };
    let mut tools: Tools = loaded_screen(&mut session, &company);
    tools.show_tool(ToolId::SetUsageQuotas, &company);
    let press = |tools: &mut Tools, key: &str| {
        let chord = Chord::parse(key).expect(key);
        let typed = tools.scopes()[0].is_text() && chord.is_printable();
        match keys.action(&tools.scopes(), chord).filter(|_| !typed) {
            Some(action) => tools.handle_action(action, &context),
            None => tools.handle_key(&chord.to_event(), &context),
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
fn focus_returns_to_the_list_after_a_call() {
    let (mut tools, _) = form_after_keys(ToolId::SetPrices, &["enter", "1", "2", "enter"]);
    let (company, keys) = (new_company(), KeyBindings::bundled());
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 10 };
    let refused = Rejection::for_field("A", "price_not_positive", "no");
    tools.handle_response(&Response::ToolCalled(ToolId::SetPrices, Err(refused), company.clone().into()), &context);
    assert_eq!(tools.focus, ToolsPane::Form, "a rejected call keeps the focus in its form");
    let set = played_session(0).call("set_prices", &json!({"A": 12}), Via::Form).expect("a price");
    tools.handle_response(&Response::ToolCalled(ToolId::SetPrices, Ok(set.into()), company.clone().into()), &context);
    assert_eq!((tools.focus, tools.scopes()), (ToolsPane::List, vec![Scope::List]));
    assert!(tools.visible_form().expect("a form").answer.is_some());
    tools.handle_response(&Response::SettingRestored("undone", Ok(Vec::new()), company.clone().into()), &context);
    assert!(tools.visible_form().expect("a form").answer.is_none(), "an undo invalidates the answer");
}

#[test]
fn deals_are_typed_as_json_and_confirmed() {
    let keys = [
        "enter", "[", "[", "7", ",", "[", "[", "\"", "B", "\"", ",", "3", "0", "]", "]", "]", "]", "enter",
        "ctrl-s",
    ];
    let (tools, effects) = form_after_keys(ToolId::SendEnterpriseDeal, &keys);
    let Some(Effect::ConfirmCall { tool, arguments, text }) = effects.first() else { panic!("{effects:?}") };
    assert_eq!((*tool, arguments), (ToolId::SendEnterpriseDeal, &json!({"deals": [[7, [["B", 30]]]]})));
    assert!(text.contains("cannot be undone"), "{text}");
    assert!(tools.has_unsent_text());
    let (_, effects) = form_after_keys(ToolId::SendEnterpriseDeal, &["enter", "[", "7", "enter", "ctrl-s"]);
    assert!(
        matches!(&effects[..], [Effect::ShowError(text)] if text.starts_with("deals: enter a list")),
        "{effects:?}"
    );
    let (_, effects) = form_after_keys(ToolId::RejectEnterpriseDeal, &["ctrl-s"]);
    assert!(
        matches!(&effects[..], [Effect::Request(Request::Call { .. })]),
        "the tool names the missing argument: {effects:?}"
    );
}

#[test]
fn escape_restores_the_previous_value() {
    let (tools, _) = form_after_keys(ToolId::SetPrices, &["enter", "1", "2", "enter", "up", "enter", "9", "9", "esc"]);
    assert_eq!(tools.visible_form().expect("a form").sheet.arguments(), Ok(json!({"A": 12})));
}

#[test]
fn copy_down_fills_the_column() {
    // The copied value is the value of the focused cell, or the value that was just accepted with enter.
    for keys in [&["right", "enter", "4", "0", "enter", "up", "="][..], &["right", "enter", "4", "0", "enter", "="]] {
        let (tools, _) = form_after_keys(ToolId::SetTargetedAdSpend, keys);
        let arguments = tools.visible_form().expect("a form").sheet.arguments().expect("numbers");
        let matrix = arguments["targeted_spend"].as_object().expect("a matrix");
        assert_eq!(matrix.len(), 5);
        assert!(matrix.values().all(|groups| groups == &json!({"S2": 40})), "{matrix:?}");
    }
    let (_, effects) = form_after_keys(ToolId::SetTargetedAdSpend, &["right", "enter", "4", "0", "enter", "down", "="]);
    assert!(matches!(&effects[..], [Effect::ShowError(text)] if text.contains("empty")), "{effects:?}");
}

#[test]
fn submitting_an_unchanged_or_invalid_form_shows_an_error() {
    let (_, effects) = form_after_keys(ToolId::SetPrices, &["ctrl-s"]);
    assert!(matches!(&effects[..], [Effect::ShowError(text)] if text.contains("Nothing has changed")));
    let (_, effects) = form_after_keys(ToolId::SetPrices, &["enter", "1", "-", "ctrl-s"]);
    assert!(matches!(&effects[..], [Effect::ShowError(text)] if text.starts_with("A: enter a number")));
}

#[test]
fn drafts_are_kept_when_another_tool_is_shown() {
    let (mut tools, _) = form_after_keys(ToolId::SetPrices, &["enter", "1", "2", "enter"]);
    let (company, keys) = (new_company(), KeyBindings::bundled());
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 10 };
    tools.show_tool(ToolId::SetDailySpend, &company);
    tools.on_company_change(&context);
    tools.show_tool(ToolId::SetPrices, &company);
    assert_eq!(tools.visible_form().expect("a form").sheet.arguments(), Ok(json!({"A": 12})));
    assert!(tools.has_unsent_text());
}

#[test]
fn draft_shows_old_and_new_values_and_is_kept_after_esc() {
    let (_, company, mut tools) = played_screen::<Tools>(2);
    tools.show_tool(ToolId::SetPrices, &company);
    let keys = KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 10 };
    for key in ["enter", "1", "4", "enter", "esc"] {
        let chord = Chord::parse(key).expect(key);
        match keys.action(&tools.scopes(), chord) {
            Some(action) => tools.handle_action(action, &context),
            None => tools.handle_key(&chord.to_event(), &context),
        };
    }
    assert_eq!(tools.focus, ToolsPane::List, "esc leaves the form");
    for (width, height) in [(120, 37), (200, 57)] {
        let text = screen_text(&tools, &company, width, height);
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
    let effects = handle_action(&mut tools, Action::Open, &company);
    assert!(effects.is_empty() && tools.has_unsent_text());
    handle_action(&mut tools, Action::ResetForm, &company);
    assert!(!tools.has_unsent_text());
}

#[test]
fn matrix_shows_current_totals_and_channel_leads() {
    let (mut session, company, mut tools) = played_screen::<Tools>(5);
    tools.show_tool(ToolId::SetTargetedAdSpend, &company);
    let form = tools.form(&company).expect("a form");
    let place = form.sheet.position_of_path("targeted_spend.content_marketing.S1").expect("a cell");
    form.focus = place;
    form.sheet.cell_mut(place).expect("a slot").draft = Some(TextField::with_text("900"));
    let rows = session
        .query("SELECT sum(leads_generated), sum(spend) FROM ad_channel_leads WHERE channel_id = 'content_marketing' AND day > 7")
        .expect("rows")
        .rows;
    let leads = novamind_database::number_at(&rows[0], 0);
    let spend = novamind_database::number_at(&rows[0], 1);
    let leads_in_words = novamind_base::formatting::grouped_number(leads, 0);
    let words = format!("content_marketing × S1, last four weeks: {leads_in_words} leads for");
    let text = screen_text(&tools, &company, 200, 57);
    let rate = format!("S1 {:.0}", leads / spend * 1000.0);
    for words in
        [words.as_str(), "was (+150)", "leads/$1k (yours)", &rate, "content_marketing × S1 750 → 900"]
    {
        assert!(text.contains(words), "{words} in\n{text}");
    }
    assert!(!screen_text(&tools, &company, 80, 21).contains("(yours)"));
    tools.set_focused_pane(ToolsPane::Form);
    draw_at_all_sizes(&mut tools, &company);
}

#[test]
fn calls_and_drafts_are_written_to_a_file() {
    let mut session = played_session(1);
    session.call("set_prices", &json!({"A": 13}), Via::Form).expect("prices");
    let company = DisplayedCompany::from_session(&session);
    let mut tools: Tools = loaded_screen(&mut session, &company);
    tools.show_tool(ToolId::SetCapacityTier, &company);
    let form = tools.form(&company).expect("a form");
    let place = form.focus;
    form.sheet.cell_mut(place).expect("a slot").draft = Some(TextField::with_text("3"));
    let effects = handle_action(&mut tools, Action::SaveCalls, &company);
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
fn focused_cell_has_a_term_and_a_history_query() {
    let (mut session, company, mut tools) = played_screen::<Tools>(3);
    let keys = KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 10 };
    let mut asked = std::collections::BTreeSet::new();
    for tool in CATALOGUE {
        let spec = tool.spec();
        tools.show_tool(spec.id, &company);
        let places = tools.visible_form().map_or(Vec::new(), |form| form.sheet.positions().collect());
        for place in places {
            tools.form(&company).expect("a form").focus = place;
            let figure = tools.figure(&context).expect("a figure");
            let (text, argument) = figure.term.split_once('.').expect("tool.argument");
            assert!(
                text == spec.name() && spec.arguments.iter().any(|it| it.name == argument),
                "{}",
                figure.term
            );
            if let Some(sql) = figure.sql.filter(|sql| asked.insert(sql.clone())) {
                session.query(&sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
            }
        }
        tools.set_focused_pane(ToolsPane::List);
        assert_eq!(tools.figure(&context).expect("a figure").term, spec.name());
    }
    tools.show_tool(ToolId::SetPrices, &company);
    tools.form(&company).expect("a form").focus = Default::default();
    let figure = tools.figure(&context).expect("a figure");
    assert_eq!(figure.term, "set_prices.A");
    let rows = session.query(&figure.sql.expect("rows")).expect("rows").rows;
    assert_eq!(novamind_database::number_at(rows.last().expect("a row"), 1), 12.0);
}

#[test]
fn forms_show_values_instead_of_parameter_names() {
    let company = new_company();
    let mut tools = Tools::default();
    for spec in CATALOGUE.iter().map(|tool| tool.spec()) {
        tools.show_tool(spec.id, &company);
        let text = screen_text(&tools, &company, 200, 120);
        let named = |after: &str| after.split(['}', ' ']).next().is_some_and(|name| name.contains('.'));
        let raw = text.split('{').skip(1).any(named);
        assert!(!raw, "{}: {text}", spec.name());
    }
    tools.show_tool(ToolId::SetTargetedAdSpend, &company);
    assert!(screen_text(&tools, &company, 200, 57).contains("$0.50 for every lead"));
}

#[test]
fn matrix_shows_totals_and_marks_hidden_columns() {
    let company = new_company();
    let look_at = |column: usize| {
        let mut keys = vec!["right"; column];
        keys.push("enter");
        let (tools, _) = form_after_keys(ToolId::SetTargetedAdSpend, &keys);
        let text = screen_text(&tools, &company, 80, 21);
        text.lines().find(|line| line.contains("total")).expect("a head").to_owned()
    };
    let (first, last) = (look_at(0), look_at(5));
    assert!(first.contains('›') && !first.contains('‹') && first.contains("S1"), "{first}");
    assert!(last.contains('‹') && !last.contains('›') && last.contains("E3"), "{last}");
}

#[test]
fn form_hints_say_that_enter_edits_the_value() {
    let (tools, _) = form_after_keys(ToolId::SetPrices, &[]);
    let text = screen_text(&tools, &new_company(), 120, 37);
    assert!(text.contains("enter edit the value") && !text.contains("type a number"), "{text}");
    let (tools, _) = form_after_keys(ToolId::SetPrices, &["enter"]);
    assert!(!screen_text(&tools, &new_company(), 120, 37).contains("enter edit"));
}

#[test]
fn project_columns_are_separated() {
    let lines = reference::reference_lines(ToolId::StartResearchProject, &new_company());
    assert!(lines.len() > 10, "{lines:?}");
    let ends = lines[0].find("cost").expect("a column") + "cost".len();
    for line in &lines[1..] {
        let (cost, after) = (&line[..ends], &line[ends..]);
        assert!(cost.ends_with(|last: char| last.is_ascii_digit()) && after.starts_with("  "), "{line}");
        assert!(cost.contains("  $"), "{line}");
    }
}

#[test]
fn filled_in_value_is_a_draft_only_if_the_user_changes_it() {
    let (_, company, mut screen) = played_screen::<Tools>(1);
    let tool = ToolId::SetCapacityTier;
    screen.prefill(tool, &json!({"tier": 5}), &company);
    screen.set_focused_pane(ToolsPane::Form);
    assert_eq!(screen.tools_with_drafts(), [tool]);
    let left = handle_action(&mut screen, Action::Close, &company);
    assert!(matches!(&left[..], [Effect::ShowStatus(text)] if text.contains("discarded")), "{left:?}");
    assert!(screen.tools_with_drafts().is_empty());
    screen.prefill(tool, &json!({"tier": 5}), &company);
    screen.set_focused_pane(ToolsPane::Form);
    handle_action(&mut screen, Action::EditCell, &company);
    screen.form(&company).expect("a form").paste("6");
    handle_action(&mut screen, Action::Commit, &company);
    assert!(handle_action(&mut screen, Action::Close, &company).is_empty());
    assert_eq!(screen.tools_with_drafts(), [tool], "the user changed the value");
}

#[test]
fn small_window_shows_all_values_and_plan_margins() {
    let (_, company, mut screen) = played_screen::<Tools>(6);
    let sold: Vec<&str> = Plan::ALL
        .into_iter()
        .filter(|plan| screen.sales.usage_of_plan(*plan).units_per_seat().is_some())
        .map(Plan::id)
        .collect();
    assert!(sold.len() >= 2, "{sold:?}");
    for tool in [ToolId::SetPrices, ToolId::SetModelTiers, ToolId::SetUsageQuotas] {
        for draft in [json!({}), json!({"A": 4, "B": 3, "C": 5})] {
            screen.prefill(tool, &draft, &company);
            screen.set_focused_pane(ToolsPane::Form);
            for (width, height) in [(60, 13), (80, 21), (120, 37), (200, 57)] {
                let text = screen_text(&screen, &company, width, height);
                let holds =
                    |words: &[&str]| text.lines().any(|line| words.iter().all(|word| line.contains(word)));
                let at = format!("{tool} {draft} at {width}x{height} in\n{text}");
                for plan in ["A", "B", "C"] {
                    let now = novamind_tui::text::format_number(company.current_setting(tool, plan));
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
fn price_form_shows_the_curve_and_both_conversions_at_the_drafted_prices() {
    use novamind_insight::CurveExplorer;
    use novamind_worker::page_questions::EstimatedCurveQuestion;

    let (session, company, mut screen) = played_screen::<Tools>(6);
    let keys = KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
    let asked = screen.request_data(&context);
    let group = crate::test_kit::only_question::<EstimatedCurveQuestion>(&asked).0;
    let leads = |fit: &novamind_report::fit::Fit| fit.measured.leads;
    let most = company.fits.iter().filter(|fit| !fit.group.is_enterprise()).map(leads).max();
    assert_eq!(company.fit(group).map(leads), most, "the group with the most leads");
    assert!(screen.request_data(&context).is_empty());
    screen.price_curve.set_answer(CurveExplorer::from_estimates(&session, group));
    screen.prefill(ToolId::SetPrices, &json!({}), &company);
    let current = screen_text(&screen, &company, 200, 57);
    screen.prefill(ToolId::SetPrices, &json!({"A": 400, "B": 401, "C": 402}), &company);
    let drafted = screen_text(&screen, &company, 200, 57);
    for text in [&current, &drafted] {
        for words in ["participation curve of", "measured ", "The estimate leaves out", "half"] {
            assert!(text.contains(words), "{words} in\n{text}");
        }
    }
    assert!(drafted.contains("at the drafted prices: estimated 0%"), "{drafted}");
    assert!(!current.contains("estimated 0%"), "{current}");
    let small = screen_text(&screen, &company, 80, 21);
    assert!(small.contains("paid $"), "margins have precedence: {small}");
    draw_at_all_sizes(&mut screen, &company);
}

#[test]
fn code_keeps_its_lines_when_pasted() {
    let keys = ["enter", "#", "space", "p", "enter", "x"];
    let (tools, _) = form_after_keys(ToolId::PythonExec, &keys);
    assert_eq!(tools.scopes()[0], Scope::Editor);
    let text = screen_text(&tools, &new_company(), 80, 21);
    assert!(text.contains("code, line 2 of 2"), "{text}");
    let (_, effects) = form_after_keys(ToolId::PythonExec, &[&keys[..], &["ctrl-s"]].concat());
    let [Effect::Request(Request::Call { arguments, .. })] = &effects[..] else { panic!("{effects:?}") };
    assert_eq!(arguments["code"], "# p\nx");
    // A reopened form still contains the code and shows its number of lines.
    let (mut tools, _) = form_after_keys(ToolId::PythonExec, &[&keys[..], &["esc"]].concat());
    let (company, bindings) = (new_company(), KeyBindings::bundled());
    let text = screen_text(&tools, &company, 80, 21);
    assert!(text.contains("# p … 2 lines"), "{text}");
    let context = ScreenContext { company: &company, keys: &bindings, page_rows: 10 };
    // The output is shown below the code until the code changes.
    let value = json!({"returncode": 0, "stdout": "first\nsecond\n", "stderr": ""});
    tools.forms.get_mut(&ToolId::PythonExec).expect("a form").answer = Some(Ok(value));
    let text = screen_text(&tools, &company, 80, 21);
    assert!(text.contains("answered") && text.contains("first") && text.contains("second"), "{text}");
    assert_eq!(tools.tools_with_drafts(), [ToolId::PythonExec]);
    tools.handle_action(Action::Apply, &context);
    assert!(tools.tools_with_drafts().is_empty(), "the call was sent");
    tools.handle_action(Action::ResetForm, &context);
    tools.paste("# python\nfor day in range(2):\n    print(day)\n", &context);
    let effects = tools.handle_action(Action::Apply, &context);
    let [Effect::Request(Request::Call { arguments, .. })] = &effects[..] else { panic!("{effects:?}") };
    assert_eq!(arguments["code"], "# python\nfor day in range(2):\n    print(day)\n");
}

#[test]
fn pages_show_the_complete_text_and_keep_the_focused_value() {
    let mut session = played_session(2);
    let company = DisplayedCompany::from_session(&session);
    let mut tools: Tools = loaded_screen(&mut session, &company);
    for tool in [ToolId::SetUsageQuotas, ToolId::SetModelTiers, ToolId::ListResearchProjects] {
        tools.show_tool(tool, &company);
        if tool == ToolId::ListResearchProjects {
            let answer = session.call(tool.spec().name(), &json!({}), Via::Form).map(Box::new);
            let keys = KeyBindings::bundled();
            let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
            tools.handle_response(&Response::ToolCalled(tool, answer, company.clone().into()), &context);
        }
        let mut seen = screen_text(&tools, &company, 80, 21);
        assert!(!seen.contains("in the list of tools"), "{seen}");
        let focus = tools.focused_path();
        for _ in 0..40 {
            handle_action(&mut tools, Action::PageDown, &company);
            seen += &screen_text(&tools, &company, 80, 21);
        }
        let form = tools.visible_form().expect("a form");
        assert_eq!((tools.focused_path(), form.text_page.number), (focus, form.text_page.last.get()), "{tool}");
        let keys = KeyBindings::bundled();
        let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
        let all = outcome::outcome_lines(form, &tools, &context, (76, outcome::DetailLevel::Full));
        for (line, _) in all.lines {
            assert!(seen.contains(line.trim_end()), "{tool}: {line} is missing:\n{seen}");
        }
        handle_action(&mut tools, Action::Down, &company);
        assert_eq!(tools.visible_form().map(|form| form.text_page.number), Some(0), "moving shows the values again");
    }
}
