//! Tests of the page of a class: selection, plots, hidden names.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use super::*;
use crate::test_kit::render_rows;
use novamind_course::{
    Class, ClassCollection, ClassRun, Evidence, HandoutSource, Lesson, RunVerdict, StepEvidence,
};

/// Returns a class whose students have set prices of 10 and more. The last student has not finished.
fn collected_class(students: u32) -> CollectedClass {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/three-weeks.toml");
    let lesson = Arc::new(Lesson::from_file(&path).expect("a lesson"));
    let place = tempfile::tempdir().expect("a folder");
    let folder = place.path().join("class");
    let class = Class::create(&folder, &HandoutSource::Lesson(lesson.clone()), students).expect("a class");
    let runs = class.students.iter().enumerate().map(|(at, student)| {
        let evidence = evidence(&lesson, at);
        let verdict =
            if at + 1 == students as usize { RunVerdict::NotFinished } else { RunVerdict::Finished };
        ClassRun {
            label: student.label.clone(),
            run: student.run.clone(),
            created: "2026-11-20T10:00:00Z".to_owned(),
            source: std::path::PathBuf::new(),
            verdict,
            evidence,
        }
    });
    let runs: Vec<ClassRun> = runs.collect();
    let good = evidence(&lesson, 0);
    let collection = ClassCollection {
        references: vec![
            serde_json::from_value(serde_json::json!({ "evidence": good })).expect("a reference"),
        ],
        runs,
        findings: Vec::new(),
        superseded: 0,
        others: 0,
    };
    CollectedClass { class, lesson: Some(lesson), collection }
}

fn evidence(lesson: &Lesson, at: usize) -> Evidence {
    let worth = 1e6 - 3e4 * at as f64;
    let goal =
        || serde_json::from_value(serde_json::json!({ "value": worth, "met": at < 3 })).expect("a goal");
    let step = |lesson_step: &novamind_course::LessonStep| StepEvidence {
        guess: lesson_step.guess.as_ref().map(|_| 1.0 + (at % 2) as f64),
        outcome: lesson_step.guess.as_ref().map(|_| 1.0),
        goals: lesson_step.goals.iter().map(|_| goal()).collect(),
    };
    Evidence {
        part: 1,
        seed: 1,
        day: 21,
        is_over: true,
        tries: 1 + (at % 3) as u32,
        steps: lesson.plan.parts[0].steps.iter().map(step).collect(),
        pitfalls: lesson
            .plan
            .pitfalls
            .iter()
            .filter(|_| at % 2 == 1)
            .map(|pitfall| pitfall.name.clone())
            .collect(),
        cash: vec![(0, 1e6), (7, 1e6 - 1e4 * at as f64), (14, worth), (21, worth)],
        decisions: BTreeMap::from([
            ("price A".to_owned(), 10.0 + at as f64),
            ("price B".to_owned(), 20.0 + (at / 2) as f64),
            ("price C".to_owned(), 55.0),
        ]),
        figures: BTreeMap::from([
            ("cash".to_owned(), worth),
            ("subscribers".to_owned(), 100.0 * at as f64),
            ("R&D".to_owned(), 0.0),
        ]),
        ..Evidence::default()
    }
}

fn page(students: u32) -> ClassPage {
    ClassPage::new(collected_class(students), ClassDisplayOptions::default())
}

fn page_text(page: &ClassPage, width: u16, height: u16) -> String {
    render_rows(width, height, |canvas, area| page.draw(canvas, area)).join("\n")
}

#[test]
fn up_and_down_keys_highlight_another_student() {
    let mut page = page(12);
    let first = page_text(&page, 120, 39);
    for part in
        ["Ranking", "11 of 12", "S01 selected", "cash by price A", "S01 ◆", "Guesses", "Most common pitfall"]
    {
        assert!(first.contains(part), "{part} is missing in\n{first}");
    }
    page.handle_action(Action::Down);
    assert!(page_text(&page, 120, 39).contains("S02 selected"));
    page.handle_action(Action::Last);
    assert!(page_text(&page, 120, 39).contains("S11 selected"), "S12 has not finished");
    page.handle_action(Action::Down);
    assert!(page_text(&page, 120, 39).contains("S11 selected"));
    page.handle_action(Action::PageUp);
    assert!(page_text(&page, 120, 39).contains("S01 selected"));
    page.highlight(4);
    assert_eq!(page.shown.highlighted_student.as_deref(), Some("S05"));
}

#[test]
fn keys_cycle_through_differing_decisions_and_figures() {
    let mut page = page(6);
    page.handle_action(Action::ClassDecision);
    page.handle_action(Action::ClassFigure);
    assert!(page_text(&page, 120, 39).contains("subscribers by price B"));
    page.handle_action(Action::ClassDecision);
    page.handle_action(Action::ClassFigure);
    assert!(
        page_text(&page, 120, 39).contains("cash by price A"),
        "price C and R&D are equal for all students"
    );
}

#[test]
fn hidden_names_are_not_drawn() {
    for (width, height) in [(80, 23), (120, 39)] {
        let mut page = page(12);
        assert!(page_text(&page, width, height).contains("S03"));
        page.handle_action(Action::HideNames);
        for _ in 0..3 {
            let hidden = page_text(&page, width, height);
            assert!(!hidden.contains("S0") && !hidden.contains("S1"), "{hidden}");
            assert!(hidden.contains("no. 3"), "{hidden}");
            page.handle_action(Action::ClassView);
        }
        page.handle_action(Action::HideNames);
        assert!(page_text(&page, width, height).contains("S03"));
    }
}

#[test]
fn small_window_shows_one_lower_pane_at_a_time() {
    let mut page = page(12);
    for part in ["cash by price A", "Guesses", "Most common pitfall", "cash by price A"] {
        let screen = page_text(&page, 80, 23);
        assert!(screen.contains(part) && screen.contains("Cash by day"), "{part} is missing in\n{screen}");
        page.handle_action(Action::ClassView);
    }
}

#[test]
fn page_is_drawn_at_every_size() {
    for students in [1, 2, 30] {
        let mut page = page(students);
        for below in 0..3 {
            for width in (0..140).step_by(33) {
                for height in (0..50).step_by(7) {
                    page_text(&page, width, height);
                }
            }
            page.handle_action(Action::ClassView);
            page.question = below;
        }
    }
}
