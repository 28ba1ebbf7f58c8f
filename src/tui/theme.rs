//! Colors by role, read from `configs/themes/*.toml`.

use ratatui::style::{Color, Modifier, Style};
use serde::Deserialize;

/// The role of a text or symbol on the screen, which determines its style.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    /// Text that has no special role.
    Text,
    /// Text that is less important than the text around it.
    Dim,
    /// Emphasized text.
    Strong,
    /// Titles of panes.
    Title,
    /// Borders of panes.
    Border,
    /// Border of the focused pane.
    Focus,
    /// Selected row of the focused list.
    Selection,
    /// Selected row of a list without the focus.
    InactiveSelection,
    /// Tabs of screens.
    Tab,
    /// Tab of the current screen.
    ActiveTab,
    /// Key labels.
    Key,
    /// Improvements and favorable values.
    Good,
    /// Deteriorations, unfavorable values and errors.
    Bad,
    /// Values and messages that require attention.
    Warning,
    /// Column headings.
    Header,
    /// Content of text fields.
    Field,
    /// Values that differ from the current setting.
    Changed,
    /// Series of a chart, by index. The colors repeat after the last color of the theme.
    Series(usize),
    /// Forecast ranges in charts.
    Fan,
    /// SQL keywords.
    Keyword,
    /// SQL strings.
    SqlString,
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
struct ThemeFile {
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

/// A color theme: the styles of all roles.
#[derive(Debug, Clone)]
pub struct Theme {
    /// Name of the theme file, without extension.
    pub name: String,
    styles: ThemeFile,
}

impl Theme {
    /// Returns the bundled theme with a name, or `None` if there is no such theme.
    pub fn bundled(name: &str) -> Option<Theme> {
        let (_, text) = novamind_assets::themes().into_iter().find(|(bundled, _)| *bundled == name)?;
        Some(Theme::parse(name, text).expect("a test parses the bundled themes"))
    }

    /// Parses the text of a theme file.
    ///
    /// # Errors
    /// The text is not TOML, a role is missing or unknown, or there is no color for series.
    pub fn parse(name: &str, text: &str) -> Result<Theme, String> {
        let role_styles: ThemeFile = toml::from_str(text).map_err(|error| error.to_string())?;
        if role_styles.series.is_empty() {
            return Err("series needs at least one entry".to_owned());
        }
        Ok(Theme { name: name.to_owned(), styles: role_styles })
    }

    /// Returns whether `count` series have different colors, so that they can be distinguished by color alone.
    pub fn has_distinct_series_colors(&self, count: usize) -> bool {
        let colours = || (0..count).map(|number| self.style(Role::Series(number)).fg);
        colours()
            .enumerate()
            .all(|(at, color)| color.is_some() && colours().take(at).all(|other| other != color))
    }

    /// Returns the style of a role.
    pub fn style(&self, role: Role) -> Style {
        let role_styles = &self.styles;
        let role_style = match role {
            Role::Text => role_styles.text,
            Role::Dim => role_styles.dim,
            Role::Strong => role_styles.strong,
            Role::Title => role_styles.title,
            Role::Border => role_styles.border,
            Role::Focus => role_styles.focus,
            Role::Selection => role_styles.selection,
            Role::InactiveSelection => role_styles.selection_idle,
            Role::Tab => role_styles.tab,
            Role::ActiveTab => role_styles.tab_here,
            Role::Key => role_styles.key,
            Role::Good => role_styles.good,
            Role::Bad => role_styles.bad,
            Role::Warning => role_styles.warning,
            Role::Header => role_styles.header,
            Role::Field => role_styles.field,
            Role::Changed => role_styles.changed,
            Role::Series(number) => role_styles.series[number % role_styles.series.len()],
            Role::Fan => role_styles.fan,
            Role::Keyword => role_styles.keyword,
            Role::SqlString => role_styles.string,
            Role::Number => role_styles.number,
            Role::Comment => role_styles.comment,
        };
        role_style.style()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bundled_themes_are_valid() {
        for (name, _) in novamind_assets::themes() {
            Theme::bundled(name).expect(name);
        }
        let mono = Theme::bundled("mono").expect("mono");
        for role in [Role::Bad, Role::Selection, Role::Series(3), Role::ActiveTab] {
            assert_eq!((mono.style(role).fg, mono.style(role).bg), (None, None));
        }
        assert!(!mono.has_distinct_series_colors(2));
        // These colors equal the background in many terminal palettes, dark or light, so no text uses them.
        for (name, invisible) in [("dark", Color::DarkGray), ("light", Color::Gray)] {
            let theme = Theme::bundled(name).expect(name);
            for role in [Role::Text, Role::Dim, Role::Tab, Role::Key, Role::Header, Role::Comment] {
                assert_ne!(theme.style(role).fg, Some(invisible), "{name} {role:?}");
            }
            assert!(theme.has_distinct_series_colors(12), "{name}: one color per category");
        }
        assert!(Theme::bundled("pink").is_none());
    }
}
