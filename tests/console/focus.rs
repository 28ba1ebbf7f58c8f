//! The focused pane: display, keys, and the state that is kept when the focus changes.

use novamind::tui::glyphs::Glyphs;
use novamind::tui::theme::Theme;

use super::harness::Console;

#[test]
fn focus_is_visible_without_color() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    for theme in ["dark", "light", "high-contrast", "mono"] {
        console.app.theme = Theme::bundled(theme).expect("a theme");
        for screen in ["1", "2", "3", "4", "5", "6", "7", "8", "0"] {
            console.press(screen);
            let letters = console.screen();
            let corners = letters.matches('┏').count();
            assert_eq!(corners, 1, "{theme}, screen {screen}: exactly one pane has the focus\n{letters}");
            assert!(letters.contains('┌'), "{theme}, screen {screen}: another pane does not\n{letters}");
        }
    }
    console.app.glyphs = Glyphs::Ascii;
    console.press("1");
    let letters = console.screen();
    assert!(letters.is_ascii() && letters.contains("#=") && letters.contains("+-"), "{letters}");
}

#[test]
fn help_starts_with_the_focused_pane() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (80, 24));
    console.press("8 ?");
    console.assert_shows("Keys: Tools › Tools");
    console.press("esc enter ?");
    console.assert_shows("Keys: Tools › set_prices");
    let screen = console.screen();
    let first = screen.lines().find(|line| line.contains("pane  ")).expect("a row of the pane");
    assert!(first.contains("enter, e") && screen.contains("Type a value in"), "{screen}");
    console.press("esc ; m ; m g o ?");
    console.assert_shows("Keys: Overview › ");
    console.press("esc");
}

#[test]
fn submitting_a_zoomed_form_keeps_the_screen() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (80, 24));
    console.press("8 enter z enter '14' enter ctrl-s");
    console.assert_shows("set_prices · pricing");
    console.assert_shows("✓ ");
    assert!(!console.screen().contains("set_model_tiers"), "the list is not shown");
    // The form still has the focus, and the next value is typed into the form.
    console.press("up enter '15' ctrl-s");
    console.assert_shows("set_prices · pricing");
    console.press("z esc");
    console.assert_shows("set_model_tiers");
}

#[test]
fn breadcrumbs_are_shown_and_esc_goes_back() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (80, 24));
    // Navigates from a group in the list to the form of its development spending, and back.
    console.press("3 down enter");
    console.assert_shows("Customers › S2 › Go to");
    console.press("tab");
    console.assert_shows("Customers › Fit of S2");
    console.press("shift-tab down enter");
    console.assert_shows("› S2 › set_targeted_dev_spend");
    // Esc first ends typing or clears a filter, and only then goes back.
    console.press("enter '5' esc");
    console.assert_shows("› S2 › set_targeted_dev_spend");
    console.press("esc");
    console.assert_shows("Customers › S2 › Go to");
    console.press("esc");
    console.assert_shows("Leads per $1,000");
    assert!(!console.screen().contains("Customers ›"), "the list is reached");
    // An action item opens its form. After the form is sent, esc returns to the action item.
    console.press("1 enter");
    console.assert_shows("Overview › set_prices");
    console.press("enter '14' enter ctrl-s esc");
    console.assert_shows("Action needed");
    // A figure opens its source rows, and the source rows open their query.
    console.advance_week();
    console.press("esc 2 f");
    console.assert_shows("Cash › ");
    console.press("o");
    console.assert_shows("Cash › Result");
    console.press("esc");
    console.assert_shows("Ledger of week 1");
    // Choosing a screen by its key clears the breadcrumbs.
    console.press("3 enter enter 8");
    assert!(!console.screen().contains("Customers ›"));
    for size in [(60, 16), (120, 40), (200, 60)] {
        console.size = size;
        console.press("1 3 esc enter enter");
        console.assert_shows("› S2 › set_targeted_ad_spend");
        console.press("esc esc");
    }
}
