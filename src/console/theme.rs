//! Colours by meaning, read from `configs/themes/*.toml`.

use ratatui::style::{Color, Modifier, Style};
use serde::Deserialize;

use novamind_session::Configuration;

/// What a piece of the screen means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    /// Ordinary text.
    Text,
    /// Less important.
    Dim,
    /// More important.
    Strong,
    /// Titles of panes.
    Title,
    /// Borders.
    Border,
    /// Border of the focused pane.
    Focus,
    /// Selected row of the focused list.
    Selection,
    /// Selected row of another list.
    SelectionIdle,
    /// Names of the screens.
    Tab,
    /// The screen that is shown.
    TabHere,
    /// Keys.
    Key,
    /// Better than before.
    Good,
    /// Worse than before, refused.
    Bad,
    /// Needs the person.
    Warning,
    /// Heads of columns.
    Header,
    /// Where text is typed.
    Field,
    /// Differs from what holds.
    Changed,
    /// Lines of charts, by number.
    Series(usize),
    /// Intervals of forecasts.
    Fan,
    /// SQL keywords.
    Keyword,
    /// SQL texts.
    SqlText,
    /// SQL numbers.
    Number,
    /// SQL comments.
    Comment,
}

#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct RoleStyle {
    fg: Option<Color>,
    bg: Option<Color>,
    bold: bool,
    dim: bool,
    reverse: bool,
    underline: bool,
}

impl RoleStyle {
    fn style(self) -> Style {
        let modifiers = [
            (self.bold, Modifier::BOLD),
            (self.dim, Modifier::DIM),
            (self.reverse, Modifier::REVERSED),
            (self.underline, Modifier::UNDERLINED),
        ];
        let held = modifiers.into_iter().filter(|(on, _)| *on).map(|(_, modifier)| modifier);
        Style { fg: self.fg, bg: self.bg, ..Style::new() }
            .add_modifier(held.fold(Modifier::empty(), |all, one| all | one))
    }
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    text: RoleStyle,
    dim: RoleStyle,
    strong: RoleStyle,
    title: RoleStyle,
    border: RoleStyle,
    focus: RoleStyle,
    selection: RoleStyle,
    selection_idle: RoleStyle,
    tab: RoleStyle,
    tab_here: RoleStyle,
    key: RoleStyle,
    good: RoleStyle,
    bad: RoleStyle,
    warning: RoleStyle,
    header: RoleStyle,
    field: RoleStyle,
    changed: RoleStyle,
    series: Vec<RoleStyle>,
    fan: RoleStyle,
    keyword: RoleStyle,
    string: RoleStyle,
    number: RoleStyle,
    comment: RoleStyle,
}

/// A set of colours.
#[derive(Debug, Clone)]
pub struct Theme {
    /// Name.
    pub name: String,
    looks: File,
}

impl Theme {
    /// A theme by name; a person's file goes before the shipped one.
    ///
    /// # Errors
    /// There is none of this name, or its file is wrong.
    pub fn find(name: &str, configuration: &Configuration) -> Result<Theme, String> {
        let own = configuration.file(format!("themes/{name}.toml")).map_err(|error| error.to_string())?;
        if let Some(source) = own {
            return Theme::parse(name, &source.text).map_err(|problem| format!("{}: {problem}", source.name));
        }
        match novamind_assets::themes().into_iter().find(|(shipped, _)| *shipped == name) {
            Some((_, text)) => Theme::parse(name, text),
            None => {
                let own = configuration.names("themes");
                let known: Vec<&str> = novamind_assets::themes()
                    .into_iter()
                    .map(|(shipped, _)| shipped)
                    .chain(own.iter().map(String::as_str))
                    .collect();
                Err(format!("there is no theme {name}; there are {}", known.join(", ")))
            }
        }
    }

    /// Every theme that can be read, the shipped ones first. A person's broken file is left out: [`Theme::find`] tells
    /// what is wrong with it.
    pub fn all(configuration: &Configuration) -> Vec<Theme> {
        let own = configuration.names("themes");
        let shipped: Vec<&str> = novamind_assets::themes().into_iter().map(|(name, _)| name).collect();
        let others = own.iter().map(String::as_str).filter(|own| !shipped.contains(own));
        shipped
            .iter()
            .copied()
            .chain(others)
            .filter_map(|name| Theme::find(name, configuration).ok())
            .collect()
    }

    fn parse(name: &str, text: &str) -> Result<Theme, String> {
        let looks: File = toml::from_str(text).map_err(|error| error.to_string())?;
        if looks.series.is_empty() {
            return Err("series needs at least one entry".to_owned());
        }
        Ok(Theme { name: name.to_owned(), looks })
    }

    /// Whether so many series can be told apart by colour alone.
    pub fn colours_apart(&self, count: usize) -> bool {
        let colours = || (0..count).map(|number| self.style(Role::Series(number)).fg);
        colours().enumerate().all(|(at, own)| own.is_some() && colours().take(at).all(|other| other != own))
    }

    /// The style of a meaning.
    pub fn style(&self, role: Role) -> Style {
        let looks = &self.looks;
        let look = match role {
            Role::Text => looks.text,
            Role::Dim => looks.dim,
            Role::Strong => looks.strong,
            Role::Title => looks.title,
            Role::Border => looks.border,
            Role::Focus => looks.focus,
            Role::Selection => looks.selection,
            Role::SelectionIdle => looks.selection_idle,
            Role::Tab => looks.tab,
            Role::TabHere => looks.tab_here,
            Role::Key => looks.key,
            Role::Good => looks.good,
            Role::Bad => looks.bad,
            Role::Warning => looks.warning,
            Role::Header => looks.header,
            Role::Field => looks.field,
            Role::Changed => looks.changed,
            Role::Series(number) => looks.series[number % looks.series.len()],
            Role::Fan => looks.fan,
            Role::Keyword => looks.keyword,
            Role::SqlText => looks.string,
            Role::Number => looks.number,
            Role::Comment => looks.comment,
        };
        look.style()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_themes_are_read_and_mono_has_no_colour() {
        for (name, _) in novamind_assets::themes() {
            Theme::find(name, &Configuration::shipped()).expect(name);
        }
        let mono = Theme::find("mono", &Configuration::shipped()).expect("mono");
        for role in [Role::Bad, Role::Selection, Role::Series(3), Role::TabHere] {
            assert_eq!((mono.style(role).fg, mono.style(role).bg), (None, None));
        }
        assert!(!mono.colours_apart(2));
        // Colour 8 is the background on many palettes: no words stand in it.
        for name in ["dark", "light"] {
            let theme = Theme::find(name, &Configuration::shipped()).expect(name);
            for role in [Role::Text, Role::Dim, Role::Tab, Role::Key, Role::Header, Role::Comment] {
                assert_ne!(theme.style(role).fg, Some(Color::DarkGray), "{name} {role:?}");
            }
            assert!(theme.colours_apart(12), "{name}: one colour a category");
        }
        let problem = Theme::find("pink", &Configuration::shipped()).expect_err("no theme");
        assert!(problem.contains("dark, high-contrast, light, mono"), "{problem}");
    }
}
