//! Classes in the start menu: opening a handout by its path, and viewing a collected class.

use std::path::Path;
use std::sync::Arc;

use novamind::course::{
    Class, ClassCollection, CollectionInput, Handout, HandoutSource, Lesson, submit_guess,
};
use novamind::record::trajectory::record::Via;
use novamind::rules::calls_for_waiting_threads;
use novamind::session::{Access, Session};
use novamind::tui::theme::Theme;
use serde_json::json;

use super::harness::Console;

const SMALL: (u16, u16) = (80, 24);
const WIDE: (u16, u16) = (120, 40);

fn create_class(folder: &Path, students: u32) -> Class {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/three-weeks.toml");
    let lesson = HandoutSource::Lesson(Arc::new(Lesson::from_file(&path).expect("a lesson")));
    Class::create(folder, &lesson, students).expect("a class")
}

/// Plays a handout to its end at a price.
fn play_handout(handout: &Path, runs: &Path, price: f64) {
    let handout = Handout::read(handout).expect("a handout");
    let run = handout.ensure_run(runs).expect("a run");
    let folder = runs.join("participants").join(&handout.label).join(run);
    let mut session = Session::open(&folder, Access::Write, true).expect("it opens");
    let prices = json!({"A": price, "B": price * 2.5, "C": price * 6.25});
    session.call("set_prices", &prices, Via::Script).expect("prices");
    while session.ended().is_none() {
        let _ = submit_guess(&mut session, if price < 20.0 { 2.0 } else { 1.0 });
        let forecasts = session.company().naive_forecasts();
        session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    }
}

/// Selects an entry on the first page of the start menu.
fn choose_menu_entry(console: &mut Console, entry: &str) {
    for _ in 0..12 {
        if console.screen().contains(&format!("› {entry}")) {
            return console.press("enter");
        }
        console.press("down");
    }
    panic!("the menu has no {entry}:\n{}", console.screen());
}

fn enter(console: &mut Console, text: &str) {
    console.press(&format!("'{text}' enter"));
}

#[test]
fn start_menu_opens_and_resumes_a_handout() {
    let place = tempfile::tempdir().expect("a folder");
    let (folder, runs) = (place.path().join("class"), place.path().join("runs"));
    create_class(&folder, 2);
    let mut console = Console::start(&runs, SMALL);
    choose_menu_entry(&mut console, "Handout");
    console.assert_shows("Handout file");
    console.press("enter");
    console.assert_shows("Type a path");
    enter(&mut console, "nothing.nm");
    console.assert_shows("nothing.nm");
    assert!(console.app.run().is_none());
    console.press("esc");
    choose_menu_entry(&mut console, "Handout");
    let path = folder.join("S01.nm").display().to_string();
    enter(&mut console, &path);
    console.assert_shows("Three weeks");
    let run_folder =
        |console: &Console| console.app.run().expect("a run").company.folder.clone().expect("a folder");
    let first = run_folder(&console);
    assert!(first.starts_with(runs.join("participants/S01")), "{}", first.display());
    // The menu lists the student's runs, and the same handout resumes its run.
    console.press("esc ; q");
    console.assert_shows("1 on this machine");
    choose_menu_entry(&mut console, "Handout");
    enter(&mut console, &path);
    assert_eq!(run_folder(&console), first);
    // A different student uses the same computer.
    console.press("esc ; q");
    choose_menu_entry(&mut console, "Handout");
    enter(&mut console, &folder.join("S02.nm").display().to_string());
    assert!(run_folder(&console).starts_with(runs.join("participants/S02")));
    console.press("esc q");
    let left = console.exit.clone().expect("the program has exited");
    assert!(
        left.1.expect("an exit message").contains("Resume the run with `novamind --as S02 --run latest`")
    );
}

#[test]
fn handout_of_another_student_is_rejected() {
    let place = tempfile::tempdir().expect("a folder");
    let (folder, runs) = (place.path().join("class"), place.path().join("runs/participants/S02"));
    create_class(&folder, 2);
    let mut console = Console::start(&runs, SMALL);
    choose_menu_entry(&mut console, "Handout");
    enter(&mut console, &folder.join("S01.nm").display().to_string());
    console.assert_shows("this is the handout of S01, but this folder has the runs of S02");
    assert!(console.app.run().is_none() && !runs.with_file_name("S01").exists());
}

#[test]
fn start_menu_shows_a_class() {
    let place = tempfile::tempdir().expect("a folder");
    let (folder, runs) = (place.path().join("class"), place.path().join("runs"));
    let class = create_class(&folder, 7);
    let mut console = Console::start(&place.path().join("own"), WIDE);
    choose_menu_entry(&mut console, "Class");
    let path = folder.display().to_string();
    enter(&mut console, &path);
    console.assert_shows("nothing was collected in");
    for (number, student) in class.students.iter().enumerate().take(6) {
        play_handout(&folder.join(format!("{}.nm", student.label)), &runs, 8.0 + 6.0 * number as f64);
    }
    let sources = CollectionInput { class: &class, folder: &folder, places: &[runs] };
    ClassCollection::collect(&sources, calls_for_waiting_threads, &mut |_, _| {}).expect("collected");
    console.press("enter");
    let mut pictures = String::new();
    for (keys, size) in [("", WIDE), ("down down d f", WIDE), ("h", SMALL), ("tab", SMALL), ("tab", SMALL)] {
        console.size = size;
        console.press(keys);
        let letters: Vec<String> = ["dark", "light"]
            .into_iter()
            .map(|theme| {
                console.app.theme = Theme::bundled(theme).expect("a theme");
                console.screen()
            })
            .collect();
        assert_eq!(letters[0], letters[1], "a theme changes the text");
        pictures += &format!("{keys} {}×{}\n{}\n", size.0, size.1, letters[0]);
    }
    assert!(pictures.contains("6 of 7"), "{pictures}");
    insta::assert_snapshot!("class", pictures);
    console.press("esc");
    console.assert_shows("› ");
    assert!(!console.screen().contains("Ranking"));
}
