//! The command palette: finds screens, tools, groups, queries, tables and commands by parts of their names.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Dialog, DialogResponse};
use crate::action::{ACTIONS, Action, Scope};
use crate::context::{ScreenContext, ScreenId};
use crate::effect::Effect;
use crate::keys::KeyBindings;
use crate::lesson::closed_reason;
use crate::own_commands::{COMMANDS_FILE, OwnCommand, OwnCommands, own_commands_refusal};
use novamind_glossary::Subject;
use novamind_record::folder::query_library::QueryLibrary;
use novamind_session::JournalEntry;
use novamind_tools::{CATALOGUE, ToolId, ToolKind};
use novamind_tui::canvas::{Align, Canvas, Click, centered_rect, row_rects};
use novamind_tui::fuzzy::{self, FuzzyMatch};
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;
use novamind_worker::company::DisplayedCompany;

const MAX_RECENT_TOOLS: usize = 5;

struct PaletteEntry {
    kind: &'static str,
    /// Code that selects the entry when the user types the complete code. Entries without a code have an empty text.
    code: &'static str,
    title: String,
    doc: String,
    keys: String,
    effect: Effect,
}

impl PaletteEntry {
    fn synonyms(&self) -> &'static [&'static str] {
        let Effect::Execute(action) = &self.effect else { return &[] };
        match action {
            Action::WriteReport => &["export", "save", "markdown", "html", "print"],
            Action::Journal => &["memo", "notes", "log", "history"],
            Action::Sql => &["export", "csv", "database", "pivot", "count"],
            Action::NextTheme => &["light", "dark", "colours", "colors", "contrast"],
            Action::NextMarker => &["ascii", "braille"],
            Action::LeaveRun => &["menu", "home", "save"],
            Action::Quit => &["exit", "save"],
            Action::Undo => &["revert"],
            Action::StopClock => &["pause", "break", "rest", "clock"],
            Action::NextWeek => &["advance", "simulate"],
            Action::Dashboard => &["figures"],
            _ => &[],
        }
    }

    /// Returns how well the typed text matches the name. Lower ranks are better.
    fn match_rank(&self, typed: &str, in_title: bool) -> MatchRank {
        let typed = typed.to_lowercase();
        let title = self.title.to_lowercase();
        let words = || title.split(|letter: char| !letter.is_alphanumeric());
        match () {
            () if title.starts_with(&typed) => MatchRank::Prefix,
            () if words().any(|word| word.starts_with(&typed)) => MatchRank::Word,
            () if title.contains(&typed) => MatchRank::Word,
            () if self.synonyms().iter().any(|word| word.starts_with(&typed)) => MatchRank::Word,
            () if in_title => MatchRank::Letters,
            () => MatchRank::Text,
        }
    }

    /// Returns the rank of the entry's kind: actions before queries, and queries before texts.
    fn kind_rank(&self) -> usize {
        ["tool", "command", "own", "group", "query", "table", "term"]
            .iter()
            .position(|kind| *kind == self.kind)
            .unwrap_or(usize::MAX)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum MatchRank {
    /// The name starts with the typed text.
    Prefix,
    /// A word or synonym starts with the typed text.
    Word,
    /// The name contains the letters in order.
    Letters,
    /// The description contains the typed text.
    Text,
}

/// The command palette.
pub struct CommandPalette {
    entries: Vec<PaletteEntry>,
    recent: Vec<ToolId>,
    field: TextField,
    /// Matching entries with the positions of the matched letters. The best match is first.
    matches: Vec<FuzzyMatch>,
    selected: usize,
}

impl CommandPalette {
    /// Opens the palette with all entries that are available in the current state.
    pub fn new(keys: &KeyBindings, company: &DisplayedCompany, library: &QueryLibrary) -> CommandPalette {
        let mut palette = CommandPalette {
            entries: all_entries(keys, company, library),
            recent: recent_tools(company),
            field: TextField::default(),
            matches: Vec::new(),
            selected: 0,
        };
        palette.update_matches();
        palette
    }

    /// Removes entries that participants of a study may not use, and adds the entry for withdrawing from the study.
    pub fn for_participant(mut self, has_tour: bool) -> CommandPalette {
        let kept = |action: Action| match action {
            Action::LeaveRun | Action::WriteReport => false,
            Action::Tour | Action::TourContinue | Action::TourBack | Action::TourClose => has_tour,
            _ => true,
        };
        self.entries.retain(|entry| !matches!(entry.effect, Effect::Execute(action) if !kept(action)));
        let entry = Action::Withdraw.entry();
        self.entries.push(PaletteEntry {
            kind: "command",
            code: "",
            title: entry.title.to_owned(),
            doc: entry.doc.to_owned(),
            keys: String::new(),
            effect: Effect::Execute(Action::Withdraw),
        });
        self.update_matches();
        self
    }

    /// Adds the commands of the user.
    pub fn with_own_commands(mut self, own: &OwnCommands, company: &DisplayedCompany) -> CommandPalette {
        let refusal = own_commands_refusal(company, false);
        let entry = |(at, command): (usize, &OwnCommand)| PaletteEntry {
            kind: "own",
            code: "",
            title: command.name.clone(),
            doc: match refusal {
                Some(reason) => format!("unavailable ({reason}): {}", command.describe()),
                None => command.describe(),
            },
            keys: command.key_label(),
            effect: Effect::RunOwnCommand(at),
        };
        self.entries.extend(own.commands.iter().enumerate().map(entry));
        self.entries.extend(own.problems.iter().map(|problem| {
            // A problem begins with its file and line.
            let (title, doc) = problem.split_once(": ").unwrap_or((COMMANDS_FILE, problem));
            PaletteEntry {
                kind: "error",
                code: "",
                title: title.to_owned(),
                doc: doc.to_owned(),
                keys: String::new(),
                effect: Effect::ShowText(COMMANDS_FILE.to_owned(), problem.clone()),
            }
        }));
        self.update_matches();
        self
    }

    fn update_matches(&mut self) {
        let typed = self.field.text().trim();
        let all = self.entries.iter().map(|entry| (entry.title.as_str(), entry.doc.as_str()));
        self.matches = fuzzy::find(typed, all);
        let coded = self
            .entries
            .iter()
            .position(|entry| !entry.code.is_empty() && entry.code.eq_ignore_ascii_case(typed));
        if let Some(at) = coded.filter(|at| self.matches.iter().all(|(found, _)| found != at)) {
            self.matches.push((at, Vec::new()));
        }
        let named = (0..self.entries.len())
            .filter(|at| !typed.is_empty() && self.entries[*at].match_rank(typed, false) == MatchRank::Word)
            .filter(|at| self.matches.iter().all(|(found, _)| found != at));
        let named: Vec<FuzzyMatch> = named.map(|at| (at, Vec::new())).collect();
        self.matches.extend(named);
        // An exact code ranks first. Tools, commands and screens whose names contain the typed text as a word rank
        // before queries and texts. Matches of scattered letters rank lower, and matches in descriptions rank last.
        // Without input, recently used tools are first.
        let entries = &self.entries;
        let recent = |at: usize| match typed.is_empty() {
            true => self.recent.iter().position(|tool| tool.name() == entries[at].title),
            false => None,
        };
        self.matches.sort_by_cached_key(|(at, letters)| {
            let entry = &entries[*at];
            if typed.is_empty() {
                return (recent(*at).unwrap_or(usize::MAX), 0, MatchRank::Prefix);
            }
            if entry.code.eq_ignore_ascii_case(typed) {
                return (0, 0, MatchRank::Prefix);
            }
            let closeness = entry.match_rank(typed, !letters.is_empty());
            // A tool, command or group whose name is exactly the typed text ranks before all other names.
            let whole = entry.kind_rank() < 4 && entry.title.eq_ignore_ascii_case(typed);
            let tier = match closeness {
                _ if whole => 1,
                MatchRank::Prefix | MatchRank::Word => 2,
                MatchRank::Letters => 3,
                MatchRank::Text => 4,
            };
            (tier, entry.kind_rank(), closeness)
        });
        self.selected = 0;
    }

    fn run_selected(&self) -> DialogResponse {
        match self.matches.get(self.selected) {
            Some((at, _)) => {
                DialogResponse::confirm_with(vec![Effect::ClearBreadcrumbs, self.entries[*at].effect.clone()])
            }
            None => DialogResponse::stay(),
        }
    }
}

/// Returns recently called tools, the newest first, without duplicates.
fn recent_tools(company: &DisplayedCompany) -> Vec<ToolId> {
    let mut tools = Vec::new();
    for entry in company.journal.iter().rev() {
        let JournalEntry::Call { tool, .. } = entry else { continue };
        if !tools.contains(tool) {
            tools.push(*tool);
        }
        if tools.len() == MAX_RECENT_TOOLS {
            break;
        }
    }
    tools
}

fn unavailable_reason(effect: &Effect, company: &DisplayedCompany) -> Option<&'static str> {
    let acts = |tool: &ToolId| tool.spec().kind.changes_company();
    match effect {
        Effect::Execute(Action::NextWeek | Action::Undo | Action::Redo) if company.is_playback => {
            Some("this is a replay")
        }
        Effect::ShowTool(tool) if acts(tool) && company.is_playback => Some("this is a replay"),
        Effect::Execute(Action::NextWeek | Action::Undo | Action::Redo) if !company.is_running() => {
            Some("the run has ended")
        }
        Effect::Execute(Action::Report) if company.weeks.is_empty() => Some("no week has run yet"),
        Effect::ShowTool(tool) if acts(tool) && !company.is_running() => Some("the run has ended"),
        _ => None,
    }
}

fn is_outside_lesson(effect: &Effect, company: &DisplayedCompany) -> bool {
    let screen = |action: Action| ScreenId::ALL.into_iter().find(|screen| screen.action() == action);
    match effect {
        Effect::ShowTool(tool) => !company.has_tool(*tool),
        Effect::Execute(action) => {
            screen(*action).is_some_and(|screen| closed_reason(screen, company).is_some())
        }
        _ => false,
    }
}

fn all_entries(keys: &KeyBindings, company: &DisplayedCompany, library: &QueryLibrary) -> Vec<PaletteEntry> {
    let everywhere =
        |scope: Scope| scope == Scope::Global || (scope == Scope::Playback && company.is_playback);
    let hidden = |action: Action| match action {
        Action::Xray | Action::Breakpoints | Action::HiddenValues => !company.can_inspect,
        Action::Lesson | Action::LessonPage => company.lesson.is_none(),
        action => !keys.is_available(action),
    };
    let commands = ACTIONS
        .iter()
        .filter(|entry| everywhere(entry.scope) && entry.action != Action::Palette && !hidden(entry.action));
    let mut list: Vec<PaletteEntry> = commands
        .map(|entry| PaletteEntry {
            kind: "command",
            code: "",
            title: entry.title.to_owned(),
            doc: entry.doc.to_owned(),
            keys: keys.label(entry.action).unwrap_or_default(),
            effect: Effect::Execute(entry.action),
        })
        .collect();
    let callable = CATALOGUE.iter().map(|tool| tool.spec()).filter(|spec| spec.kind != ToolKind::Time);
    list.extend(callable.map(|spec| PaletteEntry {
        kind: "tool",
        code: spec.code,
        title: spec.name().to_owned(),
        doc: spec.summary.to_owned(),
        keys: spec.code.to_owned(),
        effect: Effect::ShowTool(spec.id),
    }));
    list.extend(company.observation.known_groups.iter().map(|group| PaletteEntry {
        kind: "group",
        code: "",
        title: group.id().to_owned(),
        doc: "customers of this group by status".to_owned(),
        keys: String::new(),
        effect: Effect::EditSql(format!(
            "SELECT s.status, s.plan, count(*) AS customers, sum(s.seat_count) AS seats\nFROM customers c JOIN subscriptions s USING (customer_id)\nWHERE c.group_id = '{}' GROUP BY 1, 2 ORDER BY 1, 2",
            group.id()
        )),
    }));
    list.extend(library.queries().iter().map(|query| PaletteEntry {
        kind: "query",
        code: "",
        title: query.title.clone(),
        doc: query.description.clone(),
        keys: String::new(),
        effect: Effect::RunSql(query.sql.clone()),
    }));
    list.extend(novamind_database::tables(company.numbers.interface()).iter().map(|table| PaletteEntry {
        kind: "table",
        code: "",
        title: table.name.clone(),
        doc: table.description.clone(),
        keys: String::new(),
        effect: Effect::EditSql(format!("SELECT * FROM {} LIMIT 100", table.name)),
    }));
    list.extend(novamind_glossary::terms().iter().map(|term| PaletteEntry {
        kind: "term",
        code: "",
        title: term.title.clone(),
        doc: term.text.clone(),
        keys: String::new(),
        effect: Effect::Explain(Subject::Term(term)),
    }));
    for entry in &mut list {
        if is_outside_lesson(&entry.effect, company) {
            entry.doc = format!("not in this lesson: {}", entry.doc);
        } else if let Some(why) = unavailable_reason(&entry.effect, company) {
            entry.doc = format!("unavailable ({why}): {}", entry.doc);
        }
    }
    list
}

impl Dialog for CommandPalette {
    fn record_name(&self) -> String {
        "palette".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Field]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Commit, Action::Discard]
    }

    fn handle_action(&mut self, action: Action, _: &ScreenContext<'_>) -> DialogResponse {
        let last = self.matches.len().saturating_sub(1);
        match action {
            Action::Commit => return self.run_selected(),
            Action::Discard => return DialogResponse::close(),
            Action::CommitDown | Action::CommitNext => self.selected = (self.selected + 1).min(last),
            Action::CommitPrevious => self.selected = self.selected.saturating_sub(1),
            _ => {}
        }
        DialogResponse::stay()
    }

    fn handle_key(&mut self, key: &KeyEvent, _: &ScreenContext<'_>) -> DialogResponse {
        if self.field.handle_key(key) {
            self.update_matches();
        }
        DialogResponse::stay()
    }

    fn paste(&mut self, text: &str, _: &ScreenContext<'_>) -> DialogResponse {
        self.field.insert(text);
        self.update_matches();
        DialogResponse::stay()
    }

    fn handle_click(&mut self, row: usize, _: &ScreenContext<'_>) -> DialogResponse {
        self.selected = row.min(self.matches.len().saturating_sub(1));
        self.run_selected()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, _: &ScreenContext<'_>) {
        let dialog_area =
            centered_rect(area, 120.min(area.width.saturating_sub(2)), 24.min(area.height.saturating_sub(2)));
        canvas.clear(dialog_area, Role::Text);
        let note = format!("{} of {}", self.matches.len(), self.entries.len());
        let inside = canvas.draw_pane_frame(dialog_area, "Palette", &note, true);
        let line = Rect { height: 1.min(inside.height), ..inside };
        canvas.draw_text(line, "›", Role::Key);
        self.field.draw(canvas, Rect { x: line.x + 2, width: line.width.saturating_sub(2), ..line });
        let list = Rect { y: inside.y + 1, height: inside.height.saturating_sub(1), ..inside };
        if self.matches.is_empty() {
            canvas.draw_text(list, "no match", Role::Dim);
        }
        let from = canvas.scroll_to_row(list, self.selected, self.matches.len());
        for (row, (place, (at, letters))) in row_rects(list).zip(self.matches.iter().enumerate().skip(from)) {
            self.draw_entry(canvas, row, *at, letters, place == self.selected);
            canvas.register_click(row, Click::Row(0, place));
        }
        canvas.draw_pane_keys(dialog_area, "type to search · up/down select · enter choose · esc close");
    }
}

impl CommandPalette {
    fn draw_entry(&self, canvas: &mut Canvas<'_>, row: Rect, at: usize, letters: &[u32], selected: bool) {
        let entry = &self.entries[at];
        let role = |other| if selected { Role::Selection } else { other };
        if selected {
            let style = canvas.style(Role::Selection);
            canvas.buffer.set_style(row.intersection(canvas.buffer.area), style);
        }
        canvas.draw_text(Rect { width: 8.min(row.width), ..row }, entry.kind, role(Role::Dim));
        let titles = if row.width >= 100 { 36 } else { 24 };
        let title = Rect { x: row.x + 9, width: titles.min(row.width.saturating_sub(9)), ..row };
        fuzzy::draw_title(canvas, title, &entry.title, letters, [role(Role::Text), role(Role::Key)]);
        let doc = Rect { x: row.x + titles + 10, width: row.width.saturating_sub(titles + 20), ..row };
        canvas.draw_text(doc, &entry.doc, role(Role::Text));
        let keys = Rect { x: row.right().saturating_sub(9), width: 9.min(row.width), ..row };
        canvas.draw_aligned(keys, &entry.keys, role(Role::Key), Align::Right);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::new_company;

    #[test]
    fn tool_codes_rank_first() {
        let mut palette =
            CommandPalette::new(&KeyBindings::bundled(), &new_company(), &QueryLibrary::bundled());
        for spec in CATALOGUE.iter().map(|tool| tool.spec()).filter(|spec| spec.kind != ToolKind::Time) {
            for typed in [spec.code.to_owned(), format!(" {} ", spec.code.to_lowercase())] {
                palette.field = TextField::with_text(typed);
                palette.update_matches();
                let first = palette.matches.first().map(|(at, _)| palette.entries[*at].title.as_str());
                assert_eq!(first, Some(spec.name()));
            }
        }
        palette.field = TextField::with_text("sql");
        palette.update_matches();
        let first = palette.matches.first().map(|(at, _)| palette.entries[*at].title.as_str());
        assert_eq!(first, Some("SQL"), "a screen keeps its name");
    }

    #[test]
    fn matches_are_ranked_by_kind_and_by_words() {
        let mut palette =
            CommandPalette::new(&KeyBindings::bundled(), &new_company(), &QueryLibrary::bundled());
        let mut found = |typed: &str| {
            palette.field = TextField::with_text(typed.to_owned());
            palette.update_matches();
            let of = |(at, _): &FuzzyMatch| (palette.entries[*at].kind, palette.entries[*at].title.clone());
            palette.matches.iter().map(of).collect::<Vec<_>>()
        };
        for (typed, first) in [
            ("quota", "set_usage_quotas"),
            ("price", "set_prices"),
            ("tier", "set_capacity_tier"),
            ("research", "start_research_project"),
            ("memo", "Journal"),
            ("light", "next theme"),
        ] {
            let all = found(typed);
            assert!(all.iter().take(3).any(|(_, title)| title == first), "{typed}: {:?}", &all[..4]);
            let term = all.iter().position(|(kind, _)| *kind == "term").unwrap_or(usize::MAX);
            assert!(all.iter().position(|(_, title)| title == first) < Some(term), "{typed}: {all:?}");
        }
        for (typed, command) in [("export", "write the report"), ("save", "quit")] {
            let all = found(typed);
            assert!(all.iter().take(4).any(|(_, title)| title == command), "{typed}: {:?}", &all[..6]);
        }
    }

    #[test]
    fn unavailable_entries_show_a_reason() {
        let mut session = crate::test_kit::new_session();
        let fresh = CommandPalette::new(
            &KeyBindings::bundled(),
            &DisplayedCompany::from_session(&session),
            &QueryLibrary::bundled(),
        );
        let report = fresh.entries.iter().find(|entry| entry.title == "last week").expect("a command");
        assert!(report.doc.starts_with("unavailable (no week has run yet): "), "{}", report.doc);
        for (tool, arguments) in [("set_prices", r#"{"A": 12}"#), ("set_capacity_tier", r#"{"tier": 2}"#)] {
            let arguments = serde_json::from_str(arguments).expect("JSON");
            session.call(tool, &arguments, novamind_record::trajectory::record::Via::Form).expect(tool);
        }
        let palette = CommandPalette::new(
            &KeyBindings::bundled(),
            &DisplayedCompany::from_session(&session),
            &QueryLibrary::bundled(),
        );
        let first: Vec<&str> =
            palette.matches.iter().take(2).map(|(at, _)| palette.entries[*at].title.as_str()).collect();
        assert_eq!(first, ["set_capacity_tier", "set_prices"]);
    }
}
