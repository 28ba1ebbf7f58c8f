//! Colors: texts have the style of their palette role in every theme.

use novamind::tui::theme::{Role, Theme};

use super::company::copy_played_run;
use super::harness::Console;

/// Asserts that the first occurrence of a text on the screen has the style of a role.
#[track_caller]
fn assert_role(console: &mut Console, words: &str, role: Role) {
    let buffer = console.draw();
    let characters: Vec<char> = words.chars().collect();
    let symbol = |x: u16, y: u16| buffer[(x, y)].symbol().chars().next().unwrap_or(' ');
    let is_text_at = |x: u16, y: u16| {
        let has_room = usize::from(buffer.area.width - x) >= characters.len();
        has_room && characters.iter().enumerate().all(|(at, letter)| symbol(x + at as u16, y) == *letter)
    };
    let mut places = (0..buffer.area.height).flat_map(|y| (0..buffer.area.width).map(move |x| (x, y)));
    let place = places.find(|(x, y)| is_text_at(*x, *y));
    let Some((x, y)) = place else { panic!("{words} is not shown:\n{}", console.screen()) };
    let (style, expected) = (buffer[(x, y)].style(), console.app.theme.style(role));
    let same = expected.fg.is_none_or(|colour| style.fg == Some(colour))
        && expected.bg.is_none_or(|colour| style.bg == Some(colour))
        && style.add_modifier.contains(expected.add_modifier);
    assert!(same, "{}, {words}: {style:?}, not {expected:?}", console.app.theme.name);
}

#[test]
fn text_has_the_expected_palette_role() {
    let runs = tempfile::tempdir().expect("a folder");
    copy_played_run("crisis.toml", 42, 210, runs.path());
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    for theme in ["dark", "light", "high-contrast"] {
        console.app.theme = Theme::bundled(theme).expect("a theme");
        console.press("7");
        assert_role(&mut console, "7 Market", Role::ActiveTab);
        assert_role(&mut console, "2 Cash", Role::Tab);
        assert_role(&mut console, "▼", Role::Bad);
        assert_role(&mut console, "Groups", Role::Title);
        assert_role(&mut console, "next study", Role::Header);
        assert_role(&mut console, "S1  ", Role::Selection);
        assert_role(&mut console, "S2  ", Role::Text);
        console.press("8 enter enter '7' enter");
        assert_role(&mut console, "→", Role::Changed);
        console.press("esc esc 9 i 'SELECT' _ '12' _ 'AS' _ 'x' esc");
        assert_role(&mut console, "SELECT 12", Role::Keyword);
        assert_role(&mut console, "12 AS x", Role::Number);
        console.press("1");
    }
}
