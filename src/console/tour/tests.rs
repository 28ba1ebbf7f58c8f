//! Tests of the steps, their texts and figures, and of the runs in which steps are omitted.

use serde_json::{Value, json};

use super::steps::{Need, Sight};
use super::*;
use crate::action::Scope;
use crate::context::ScreenId;
use crate::dialogs::{DialogContent, DialogView};
use crate::test_kit::{new_company, render_rows};
use novamind_database::Cell;
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_report::fit::RangePosition;
use novamind_session::Session;
use novamind_session::identifiers::{Group, Plan};
use novamind_worker::company::DisplayedCompany;

/// Returns the facts for the Overview screen without a dialog.
fn facts(company: &DisplayedCompany) -> TourFacts<'_> {
    TourFacts {
        company,
        screen: ScreenId::Overview,
        scopes: vec![Scope::List, Scope::Global],
        is_typing: false,
        has_dialog: false,
        dialog: None,
        next_week: NextWeekFacts::default(),
        customers: CustomersFacts::default(),
        form: None,
        shows_cancellations: false,
    }
}

/// Plays the run of the tour through its calls and weeks up to a number of weeks.
fn played_tour(weeks: usize) -> Session {
    let mut run = Session::create(tour_run(), &Configuration::bundled()).expect("a run");
    for step in steps() {
        let Goal::Set { set, value, .. } = &step.goal else { continue };
        if *set == novamind_tools::ToolId::SetDailySpend {
            advance_to(&mut run, weeks.min(5));
            if weeks <= 5 {
                break;
            }
        }
        let value: f64 = value.parse().expect("a number");
        let arguments = match set.name() {
            "set_usage_quotas" => json!({"A": value, "B": 0, "C": 0}),
            "set_targeted_ad_spend" => json!({"targeted_spend": {"social_media": {"S1": value}}}),
            "set_daily_spend" => json!({"operations": value}),
            _ => json!({"A": value}),
        };
        run.call(set.name(), &arguments, Via::Script).unwrap_or_else(|error| panic!("{set:?}: {error}"));
    }
    advance_to(&mut run, weeks);
    run
}

fn advance_to(run: &mut Session, weeks: usize) {
    while run.weeks().len() < weeks {
        let forecasts = run.company().naive_forecasts();
        run.advance("the tour", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    }
}

fn titles(company: &DisplayedCompany) -> Vec<&'static str> {
    steps().iter().filter(|step| step.applies_to(company)).map(|step| step.title.as_str()).collect()
}

#[test]
fn tour_texts_have_existing_names_and_fit_small_windows() {
    let keys = KeyBindings::bundled();
    assert!((12..=15).contains(&steps().len()), "{}", steps().len());
    for weeks in [0, 1, 5, 6] {
        let company = DisplayedCompany::from_session(&played_tour(weeks));
        for (at, step) in steps().iter().enumerate() {
            let text = insert_figures(&step.text, &company);
            let needs_weeks = ["signed", "leads", "cancelled", "issues", "subscribers"];
            let has_week =
                weeks > 0 || !needs_weeks.iter().any(|name| step.text.contains(&format!("[{name}]")));
            assert!(!text.contains('–') || !has_week, "{}: unknown figure in {text}", step.title);
            for name in
                step.text.split('{').skip(1).filter_map(|rest| rest.split_once('}')).map(|(name, _)| name)
            {
                let is_parameter =
                    name.contains('.') && !company.numbers.substitute(&format!("{{{name}}}")).contains('{');
                assert!(
                    is_parameter || ACTIONS.iter().any(|entry| entry.name == name),
                    "{}: {name}",
                    step.title
                );
            }
            let mut tour = Tour { step: Some(at), ..Tour::default() };
            if !tour.update(&facts(&company), &keys) || tour.step != Some(at) {
                continue;
            }
            for (width, most) in [(60, 6), (80, 5), (120, 4)] {
                assert!(tour.height(width) <= most, "{}: {:?}", step.title, tour.lines(width));
                let shown = render_rows(width, tour.height(width), |canvas, area| tour.draw(canvas, area));
                let shown = shown.join(" ");
                assert!(shown.contains("Tour · ") && shown.contains("→ "), "{shown}");
                assert!(!shown.contains('{') && !shown.contains('[') && !shown.contains('…'), "{shown}");
                let words = shown.split_whitespace().collect::<Vec<_>>().join(" ");
                for group in tour.key_groups() {
                    assert!(words.contains(&group.label()), "{}: {words}", group.label());
                }
            }
        }
    }
}

#[test]
fn step_that_is_read_ends_only_when_the_user_continues() {
    let company = new_company();
    let keys = KeyBindings::bundled();
    let mut tour = Tour::default();
    let overview = facts(&company);
    for _ in 0..3 {
        assert!(tour.update(&overview, &keys));
        assert_eq!((tour.title(), tour.is_seen), ("The idea", true));
    }
    tour.continue_to_next_step();
    assert!(tour.update(&overview, &keys));
    assert_eq!((tour.title(), tour.is_seen), ("The curve", false));
    let dialog = |is_shown| TourFacts {
        has_dialog: true,
        dialog: Some(DialogView::new(DialogContent::Curve, is_shown)),
        ..facts(&company)
    };
    tour.update(&dialog(false), &keys);
    assert!(!tour.is_seen, "the curve has not arrived");
    tour.update(&dialog(true), &keys);
    assert!(tour.is_seen);
    tour.update(&overview, &keys);
    assert_eq!((tour.title(), tour.is_seen), ("The curve", true), "the user may look at other things");
}

#[test]
fn returning_user_resumes_after_the_last_reached_goal() {
    let keys = KeyBindings::bundled();
    for (weeks, title) in [(0, "A week"), (1, "The report"), (5, "Who cancelled"), (6, "Why")] {
        let company = DisplayedCompany::from_session(&played_tour(weeks));
        let mut tour = Tour::default();
        assert!(tour.update(&facts(&company), &keys));
        assert_eq!(tour.title(), title, "after {weeks} weeks");
    }
    let mut tour = Tour::default();
    let company = new_company();
    for _ in steps() {
        assert!(tour.update(&facts(&company), &keys));
        tour.continue_to_next_step();
    }
    assert!(!tour.update(&facts(&company), &keys), "no step is left");
}

#[test]
fn steps_without_permission_or_time_are_omitted() {
    let full = titles(&new_company());
    assert_eq!(full.len(), steps().len());
    let baseline = NewRunMode::company(Mode::Baseline, None);
    let shown = titles(&baseline);
    assert!(
        !shown.contains(&"Why") && !shown.contains(&"What if") && shown.contains(&"Who cancelled"),
        "{shown:?}"
    );
    let short = titles(&NewRunMode::company(Mode::Sandbox, Some(28)));
    assert_eq!(short.last(), Some(&"Help"));
    for title in ["Four more weeks", "Who cancelled", "A change", "Why", "What if"] {
        assert!(!short.contains(&title), "{short:?}");
    }
    let needs = |title: &str| {
        steps().iter().any(|step| step.title == title && step.needs == Some(Need::Resimulation))
    };
    assert!(needs("Why") && needs("What if"));
}

struct NewRunMode;

impl NewRunMode {
    fn company(mode: Mode, days: Option<u32>) -> DisplayedCompany {
        let is_baseline = mode == Mode::Baseline;
        let new = novamind_session::NewRun {
            mode,
            days,
            participant: is_baseline.then(|| "P01".to_owned()),
            ..novamind_session::NewRun::default()
        };
        DisplayedCompany::from_session(&Session::create(new, &Configuration::bundled()).expect("a run"))
    }
}

#[test]
fn covering_dialog_is_closed_before_keys_are_shown() {
    let company = new_company();
    let keys = KeyBindings::bundled();
    let covered =
        TourFacts { has_dialog: true, scopes: vec![Scope::Field], is_typing: true, ..facts(&company) };
    for at in 0..steps().len() {
        let mut tour = Tour { step: Some(at), ..Tour::default() };
        tour.update(&covered, &keys);
        let notations: Vec<String> = tour.key_groups().iter().map(KeyGroup::notation).collect();
        assert_eq!(notations, ["esc"], "{}", tour.title());
    }
    let number_pane = TourFacts { scopes: vec![Scope::Form, Scope::List, Scope::Global], ..facts(&company) };
    let mut tour = Tour { step: Some(2), ..Tour::default() };
    tour.update(&number_pane, &keys);
    assert_eq!(tour.key_groups()[0].notation(), "g u", "a digit would start a number");
}

#[test]
fn claims_of_the_tour_are_true_in_its_run() {
    let run = played_tour(0);
    let group = Group::parse("S1").expect("a group");
    let company = DisplayedCompany::from_session(&run);
    assert_eq!(claims::example_group(&company), Some(group));
    let fit = company.fit(group).expect("S1 is known");
    assert!(fit.budget.position_of(9.0) == RangePosition::Below, "a low price: {:?}", fit.budget);
    assert!(fit.usage.position_of(400.0) == RangePosition::Above, "more than S1 uses: {:?}", fit.usage);
    let default = DisplayedCompany::from_session(
        &Session::create(tour_run(), &Configuration::bundled()).expect("a run"),
    );
    let quality = |company: &DisplayedCompany| company.fit(group).expect("known").plans[Plan::A].quality;
    assert!((quality(&default) - 0.12).abs() < 1e-9, "the quality of a new company with default parameters");
    assert!(quality(&company) > quality(&default), "the model raises quality");

    let first = DisplayedCompany::from_session(&played_tour(1)).weeks[0];
    assert!(first.new_individual_leads > 100 && first.new_individual_subscribers > 20, "{first:?}");
    assert!(
        first.new_individual_subscribers * 2 < first.new_individual_leads,
        "most do not sign up: {first:?}"
    );

    let mut run = played_tour(5);
    let weeks = run.weeks().to_vec();
    assert!(weeks[..4].iter().all(|week| week.cancellations == 0), "the first decide in week 5");
    assert!(weeks[4].cancellations > 20 && weeks[4].open_issues > 100, "{:?}", weeks[4]);
    let library = novamind_record::folder::query_library::QueryLibrary::bundled();
    let query = library.queries().iter().find(|query| query.name == "issues-of-leavers").expect("a query");
    let rows = run.query(&query.sql).expect("rows").rows;
    assert_eq!(rows.len(), weeks[4].cancellations as usize);
    let open = |row: &Vec<Cell>| matches!(row[6], Cell::Integer(count) if count > 0);
    let with_issues = rows.iter().filter(|row| open(row)).count();
    assert!(with_issues * 10 > rows.len() * 9, "{with_issues} of {} waited for support", rows.len());

    let changed = played_tour(6).weeks()[5];
    assert!(changed.cancellations < weeks[4].cancellations, "{changed:?}");
    let settings: Value = json!({"operations": 300});
    assert!(run.call("set_daily_spend", &settings, Via::Script).is_ok());
    assert!(Sight::Help.dialog().is_some());
}

#[test]
fn step_accepts_only_the_value_that_it_asks_for() {
    let keys = KeyBindings::bundled();
    let mut run = Session::create(tour_run(), &Configuration::bundled()).expect("a run");
    let mut tour = Tour { step: Some(3), ..Tour::default() };
    let mut texts = Vec::new();
    for prices in [json!({"C": 9}), json!({"A": 90}), json!({"A": 10})] {
        run.call("set_prices", &prices, Via::Script).expect("prices");
        let company = DisplayedCompany::from_session(&run);
        assert!(tour.update(&facts(&company), &keys));
        texts.push((tour.title(), tour.shown.text.clone()));
    }
    assert_eq!(texts[0].0, "A price");
    assert_eq!(texts[0].1, "You set something else: plan A is 0, and this step needs 9.");
    assert_eq!(texts[1].1, "You set something else: plan A is 90, and this step needs 9.");
    assert_eq!(texts[2].0, "A model", "a price close to the proposed one is accepted");
    let ads = json!({"targeted_spend": {"social_media": {"S1": 5}}});
    run.call("set_targeted_ad_spend", &ads, Via::Script).expect("ads");
    let company = DisplayedCompany::from_session(&run);
    let mut tour = Tour { step: Some(6), ..Tour::default() };
    assert!(tour.update(&facts(&company), &keys));
    assert_eq!(tour.shown.text, "You set something else: social_media, S1 is 5, and this step needs 500.");
}

#[test]
fn user_can_go_back_to_a_reached_step() {
    let keys = KeyBindings::bundled();
    let company = DisplayedCompany::from_session(&played_tour(1));
    let mut tour = Tour::default();
    tour.update(&facts(&company), &keys);
    assert_eq!(tour.title(), "The report");
    for title in ["A week", "Leads"] {
        assert!(tour.go_back(&company));
        assert!(tour.update(&facts(&company), &keys));
        assert_eq!(tour.title(), title);
        assert_eq!(tour.key_groups()[0].effect, "continue");
        assert!(tour.is_step_done(&company));
    }
    tour.continue_to_next_step();
    tour.update(&facts(&company), &keys);
    assert_eq!(tour.title(), "The report", "reached steps are skipped again");
    let mut tour = Tour::default();
    let new = new_company();
    tour.update(&facts(&new), &keys);
    assert!(!tour.go_back(&new), "the first step");
    let mut tour = Tour { step: Some(3), ..Tour::default() };
    tour.update(&facts(&new), &keys);
    assert!(!tour.is_step_done(&new), "no price is set");
}

#[test]
fn keys_inside_the_form_lead_to_its_first_cell() {
    let company = new_company();
    let keys = KeyBindings::bundled();
    let form = FormFacts { tool: Some(novamind_tools::ToolId::SetPrices), ..FormFacts::default() };
    let inside = TourFacts {
        screen: ScreenId::Tools,
        scopes: vec![Scope::Form, Scope::List, Scope::Global],
        form: Some(form),
        ..facts(&company)
    };
    let mut tour = Tour { step: Some(3), ..Tour::default() };
    tour.update(&inside, &keys);
    let labels: Vec<String> = tour.key_groups().iter().map(KeyGroup::label).collect();
    assert!(labels[0].ends_with("(first row)") && !labels.concat().contains("set_prices"), "{labels:?}");
}
