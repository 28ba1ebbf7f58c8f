//! The command palette: finds screens, tools, groups, queries, tables and commands by parts of their names.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Dialog, Outcome};
use crate::action::{ACTIONS, Action, Scope};
use crate::context::{Look, ScreenId};
use crate::effect::Effect;
use crate::keys::Keys;
use crate::lesson::why_closed;
use novamind_glossary::Subject;
use novamind_record::folder::library::Library;
use novamind_session::JournalEntry;
use novamind_tools::{CATALOGUE, Kind, ToolId};
use novamind_tui::canvas::{Align, Canvas, Click, centered, rows_of};
use novamind_tui::fuzzy::{self, Found};
use novamind_tui::theme::Role;
use novamind_tui::widgets::Field;
use novamind_tui::widgets::table::first_row;
use novamind_worker::company::Company;

const RECENT: usize = 5;

struct PaletteEntry {
    kind: &'static str,
    /// Code that selects the entry when typed completely; may be empty.
    code: &'static str,
    title: String,
    doc: String,
    keys: String,
    effect: Effect,
}

impl PaletteEntry {
    fn synonyms(&self) -> &'static [&'static str] {
        let Effect::Do(action) = &self.effect else { return &[] };
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

    /// Returns how well the typed text matches the name; less is better.
    fn closeness(&self, typed: &str, in_title: bool) -> Closeness {
        let typed = typed.to_lowercase();
        let title = self.title.to_lowercase();
        let words = || title.split(|letter: char| !letter.is_alphanumeric());
        match () {
            () if title.starts_with(&typed) => Closeness::Prefix,
            () if words().any(|word| word.starts_with(&typed)) => Closeness::Word,
            () if title.contains(&typed) => Closeness::Word,
            () if self.synonyms().iter().any(|word| word.starts_with(&typed)) => Closeness::Word,
            () if in_title => Closeness::Letters,
            () => Closeness::Text,
        }
    }

    /// Ranks actions before queries, and queries before texts.
    fn order(&self) -> usize {
        ["tool", "command", "group", "query", "table", "term"]
            .iter()
            .position(|kind| *kind == self.kind)
            .unwrap_or(usize::MAX)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Closeness {
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
pub struct Palette {
    entries: Vec<PaletteEntry>,
    recent: Vec<ToolId>,
    field: Field,
    /// Matching entries, the best first, with the positions of matched letters.
    found: Vec<Found>,
    selected: usize,
}

impl Palette {
    /// Lists everything that can be chosen now.
    pub fn new(keys: &Keys, company: &Company, library: &Library) -> Palette {
        let mut palette = Palette {
            entries: entries(keys, company, library),
            recent: recent(company),
            field: Field::default(),
            found: Vec::new(),
            selected: 0,
        };
        palette.find();
        palette
    }

    /// Restricts the palette to participants of a study, and adds withdrawal.
    pub fn of_participant(mut self, has_tour: bool) -> Palette {
        let kept = |action: Action| match action {
            Action::LeaveRun | Action::WriteReport => false,
            Action::Tour | Action::TourSkip | Action::TourClose => has_tour,
            _ => true,
        };
        self.entries.retain(|entry| !matches!(entry.effect, Effect::Do(action) if !kept(action)));
        let entry = Action::Withdraw.entry();
        self.entries.push(PaletteEntry {
            kind: "command",
            code: "",
            title: entry.title.to_owned(),
            doc: entry.doc.to_owned(),
            keys: String::new(),
            effect: Effect::Do(Action::Withdraw),
        });
        self.find();
        self
    }

    fn find(&mut self) {
        let typed = self.field.text().trim();
        let all = self.entries.iter().map(|entry| (entry.title.as_str(), entry.doc.as_str()));
        self.found = fuzzy::find(typed, all);
        let coded = self
            .entries
            .iter()
            .position(|entry| !entry.code.is_empty() && entry.code.eq_ignore_ascii_case(typed));
        if let Some(at) = coded.filter(|at| self.found.iter().all(|(found, _)| found != at)) {
            self.found.push((at, Vec::new()));
        }
        let named = (0..self.entries.len())
            .filter(|at| !typed.is_empty() && self.entries[*at].closeness(typed, false) == Closeness::Word)
            .filter(|at| self.found.iter().all(|(found, _)| found != at));
        let named: Vec<Found> = named.map(|at| (at, Vec::new())).collect();
        self.found.extend(named);
        // An exact code ranks first. Tools, commands and screens whose names contain the typed text as a word rank
        // before queries and texts; scattered letters rank lower, words of a description last. Without input,
        // recently used tools come first.
        let entries = &self.entries;
        let recent = |at: usize| match typed.is_empty() {
            true => self.recent.iter().position(|tool| tool.name() == entries[at].title),
            false => None,
        };
        self.found.sort_by_cached_key(|(at, letters)| {
            let entry = &entries[*at];
            if typed.is_empty() {
                return (recent(*at).unwrap_or(usize::MAX), 0, Closeness::Prefix);
            }
            if entry.code.eq_ignore_ascii_case(typed) {
                return (0, 0, Closeness::Prefix);
            }
            let closeness = entry.closeness(typed, !letters.is_empty());
            // An exact name of a screen or a group ranks first.
            let whole = entry.order() < 3 && entry.title.eq_ignore_ascii_case(typed);
            let tier = match closeness {
                _ if whole => 1,
                Closeness::Prefix | Closeness::Word => 2,
                Closeness::Letters => 3,
                Closeness::Text => 4,
            };
            (tier, entry.order(), closeness)
        });
        self.selected = 0;
    }

    fn choose(&self) -> Outcome {
        match self.found.get(self.selected) {
            Some((at, _)) => Outcome::close_with(vec![Effect::BeginPath, self.entries[*at].effect.clone()]),
            None => Outcome::stay(),
        }
    }
}

/// Returns recently called tools, the newest first, without duplicates.
fn recent(company: &Company) -> Vec<ToolId> {
    let mut tools = Vec::new();
    for entry in company.journal.iter().rev() {
        let JournalEntry::Call { tool, .. } = entry else { continue };
        if !tools.contains(tool) {
            tools.push(*tool);
        }
        if tools.len() == RECENT {
            break;
        }
    }
    tools
}

fn why_not(effect: &Effect, company: &Company) -> Option<&'static str> {
    let acts = |tool: &ToolId| tool.spec().kind.acts();
    match effect {
        Effect::Do(Action::NextWeek | Action::Undo | Action::Redo) if company.replayed => {
            Some("this is a replay")
        }
        Effect::ShowTool(tool) if acts(tool) && company.replayed => Some("this is a replay"),
        Effect::Do(Action::NextWeek | Action::Undo | Action::Redo) if !company.is_running() => {
            Some("the run has ended")
        }
        Effect::Do(Action::Report) if company.weeks.is_empty() => Some("no week has run yet"),
        Effect::ShowTool(tool) if acts(tool) && !company.is_running() => Some("the run has ended"),
        _ => None,
    }
}

fn is_outside_lesson(effect: &Effect, company: &Company) -> bool {
    let screen = |action: Action| ScreenId::ALL.into_iter().find(|screen| screen.action() == action);
    match effect {
        Effect::ShowTool(tool) => !company.has_tool(*tool),
        Effect::Do(action) => screen(*action).is_some_and(|screen| why_closed(screen, company).is_some()),
        _ => false,
    }
}

fn entries(keys: &Keys, company: &Company, library: &Library) -> Vec<PaletteEntry> {
    let everywhere = |scope: Scope| scope == Scope::Global || (scope == Scope::Viewer && company.replayed);
    let hidden = |action: Action| match action {
        Action::Xray | Action::Breakpoints | Action::HiddenValues => !company.may_look_inside,
        Action::Lesson | Action::LessonPage => company.lesson.is_none(),
        _ => false,
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
            effect: Effect::Do(entry.action),
        })
        .collect();
    let callable = CATALOGUE.iter().map(|tool| tool.spec()).filter(|spec| spec.kind != Kind::Time);
    list.extend(callable.map(|spec| PaletteEntry {
        kind: "tool",
        code: spec.code,
        title: spec.name().to_owned(),
        doc: spec.summary.to_owned(),
        keys: spec.code.to_owned(),
        effect: Effect::ShowTool(spec.id),
    }));
    list.extend(company.seen.known_groups.iter().map(|group| PaletteEntry {
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
        doc: query.what.clone(),
        keys: String::new(),
        effect: Effect::RunSql(query.sql.clone()),
    }));
    list.extend(novamind_database::tables().iter().map(|table| PaletteEntry {
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
        } else if let Some(why) = why_not(&entry.effect, company) {
            entry.doc = format!("not now, {why}: {}", entry.doc);
        }
    }
    list
}

impl Dialog for Palette {
    fn what(&self) -> String {
        "palette".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Field]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Commit, Action::Discard]
    }

    fn act(&mut self, action: Action, _: &Look<'_>) -> Outcome {
        let last = self.found.len().saturating_sub(1);
        match action {
            Action::Commit => return self.choose(),
            Action::Discard => return Outcome::close(),
            Action::CommitDown | Action::CommitNext => self.selected = (self.selected + 1).min(last),
            Action::CommitPrevious => self.selected = self.selected.saturating_sub(1),
            _ => {}
        }
        Outcome::stay()
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Outcome {
        if self.field.key(key) {
            self.find();
        }
        Outcome::stay()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Outcome {
        self.field.insert(text);
        self.find();
        Outcome::stay()
    }

    fn click(&mut self, row: usize, _: &Look<'_>) -> Outcome {
        self.selected = row.min(self.found.len().saturating_sub(1));
        self.choose()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, _: &Look<'_>) {
        let own =
            centered(area, 120.min(area.width.saturating_sub(2)), 24.min(area.height.saturating_sub(2)));
        canvas.clear(own, Role::Text);
        let note = format!("{} of {}", self.found.len(), self.entries.len());
        let inside = canvas.pane(own, "Palette", &note, true);
        let line = Rect { height: 1.min(inside.height), ..inside };
        canvas.text(line, "›", Role::Key);
        self.field.draw(canvas, Rect { x: line.x + 2, width: line.width.saturating_sub(2), ..line });
        let list = Rect { y: inside.y + 1, height: inside.height.saturating_sub(1), ..inside };
        if self.found.is_empty() {
            canvas.text(list, "no match", Role::Dim);
        }
        let from = first_row(self.selected, list.height as usize, self.found.len());
        for (row, (place, (at, letters))) in rows_of(list).zip(self.found.iter().enumerate().skip(from)) {
            self.draw_entry(canvas, row, *at, letters, place == self.selected);
            canvas.click(row, Click::Row(0, place));
        }
        canvas.pane_keys(own, "type to search · up/down select · enter choose · esc close");
    }
}

impl Palette {
    fn draw_entry(&self, canvas: &mut Canvas<'_>, row: Rect, at: usize, letters: &[u32], selected: bool) {
        let entry = &self.entries[at];
        let role = |other| if selected { Role::Selection } else { other };
        if selected {
            let style = canvas.style(Role::Selection);
            canvas.buffer.set_style(row.intersection(canvas.buffer.area), style);
        }
        canvas.text(Rect { width: 8.min(row.width), ..row }, entry.kind, role(Role::Dim));
        let titles = if row.width >= 100 { 36 } else { 24 };
        let title = Rect { x: row.x + 9, width: titles.min(row.width.saturating_sub(9)), ..row };
        fuzzy::draw_title(canvas, title, &entry.title, letters, [role(Role::Text), role(Role::Key)]);
        let doc = Rect { x: row.x + titles + 10, width: row.width.saturating_sub(titles + 20), ..row };
        canvas.text(doc, &entry.doc, role(Role::Text));
        let keys = Rect { x: row.right().saturating_sub(9), width: 9.min(row.width), ..row };
        canvas.aligned(keys, &entry.keys, role(Role::Key), Align::Right);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::company;

    #[test]
    fn a_code_finds_its_tool_before_anything_else() {
        let mut palette = Palette::new(&Keys::shipped(), &company(), &Library::shipped());
        for spec in CATALOGUE.iter().map(|tool| tool.spec()).filter(|spec| spec.kind != Kind::Time) {
            for typed in [spec.code.to_owned(), format!(" {} ", spec.code.to_lowercase())] {
                palette.field = Field::of(typed);
                palette.find();
                let first = palette.found.first().map(|(at, _)| palette.entries[*at].title.as_str());
                assert_eq!(first, Some(spec.name()));
            }
        }
        palette.field = Field::of("sql");
        palette.find();
        let first = palette.found.first().map(|(at, _)| palette.entries[*at].title.as_str());
        assert_eq!(first, Some("SQL"), "a screen keeps its name");
    }

    #[test]
    fn what_acts_stands_first_and_words_before_letters() {
        let mut palette = Palette::new(&Keys::shipped(), &company(), &Library::shipped());
        let mut found = |typed: &str| {
            palette.field = Field::of(typed.to_owned());
            palette.find();
            let of = |(at, _): &Found| (palette.entries[*at].kind, palette.entries[*at].title.clone());
            palette.found.iter().map(of).collect::<Vec<_>>()
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
    fn tools_used_last_stand_first_and_what_cannot_be_done_says_why() {
        let mut session = crate::test_kit::session();
        let fresh = Palette::new(&Keys::shipped(), &Company::of(&session), &Library::shipped());
        let report = fresh.entries.iter().find(|entry| entry.title == "last week").expect("a command");
        assert!(report.doc.starts_with("not now, no week has run yet: "), "{}", report.doc);
        for (tool, arguments) in [("set_prices", r#"{"A": 12}"#), ("set_capacity_tier", r#"{"tier": 2}"#)] {
            let arguments = serde_json::from_str(arguments).expect("JSON");
            session.call(tool, &arguments, novamind_record::trajectory::record::Via::Form).expect(tool);
        }
        let palette = Palette::new(&Keys::shipped(), &Company::of(&session), &Library::shipped());
        let first: Vec<&str> =
            palette.found.iter().take(2).map(|(at, _)| palette.entries[*at].title.as_str()).collect();
        assert_eq!(first, ["set_capacity_tier", "set_prices"]);
    }
}
