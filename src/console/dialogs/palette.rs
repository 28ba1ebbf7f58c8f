//! The palette: screens, tools, groups, tables and commands, found by typing parts of their names.

use crossterm::event::KeyEvent;
use nucleo_matcher::pattern::{CaseMatching, Normalization, Pattern};
use nucleo_matcher::{Config, Matcher, Utf32Str};
use ratatui::layout::Rect;

use super::{Dialog, Outcome};
use crate::console::action::{ACTIONS, Action, Scope};
use crate::console::canvas::{Align, Canvas, Click, centered, rows_of};
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::keys::Keys;
use crate::console::screens::Look;
use crate::console::theme::Role;
use crate::console::widgets::Field;
use crate::console::widgets::table::first_row;
use crate::database;
use crate::glossary::{self, Subject};
use crate::tools::{CATALOGUE, Kind};

/// Something that can be chosen.
struct Entry {
    kind: &'static str,
    title: String,
    doc: String,
    keys: String,
    effect: Effect,
}

/// The palette.
pub struct Palette {
    entries: Vec<Entry>,
    field: Field,
    /// Entries that match, the best first, with the letters that matched.
    found: Vec<(usize, Vec<u32>)>,
    selected: usize,
}

impl Palette {
    /// Everything that can be chosen now.
    pub fn new(keys: &Keys, company: &Company) -> Palette {
        let mut palette = Palette {
            entries: entries(keys, company),
            field: Field::default(),
            found: Vec::new(),
            selected: 0,
        };
        palette.find();
        palette
    }

    fn find(&mut self) {
        let pattern = Pattern::parse(self.field.text(), CaseMatching::Smart, Normalization::Smart);
        let mut matcher = Matcher::new(Config::DEFAULT);
        let mut scored: Vec<(u32, usize, Vec<u32>)> = Vec::new();
        let mut letters = Vec::new();
        for (at, entry) in self.entries.iter().enumerate() {
            let mut places = Vec::new();
            let title = Utf32Str::new(&entry.title, &mut letters);
            if let Some(score) = pattern.indices(title, &mut matcher, &mut places) {
                scored.push((score * 2 + 1, at, places));
            } else if let Some(score) = pattern.score(Utf32Str::new(&entry.doc, &mut letters), &mut matcher) {
                scored.push((score, at, Vec::new()));
            }
        }
        scored.sort_by(|left, right| right.0.cmp(&left.0).then(left.1.cmp(&right.1)));
        self.found = scored.into_iter().map(|(_, at, places)| (at, places)).collect();
        self.selected = 0;
    }

    fn choose(&self) -> Outcome {
        match self.found.get(self.selected) {
            Some((at, _)) => Outcome::close_with(vec![self.entries[*at].effect.clone()]),
            None => Outcome::stay(),
        }
    }
}

fn entries(keys: &Keys, company: &Company) -> Vec<Entry> {
    let commands =
        ACTIONS.iter().filter(|entry| entry.scope == Scope::Global && entry.action != Action::Palette);
    let mut list: Vec<Entry> = commands
        .map(|entry| Entry {
            kind: "command",
            title: entry.title.to_owned(),
            doc: entry.doc.to_owned(),
            keys: keys.label(entry.action).unwrap_or_default(),
            effect: Effect::Do(entry.action),
        })
        .collect();
    let callable = CATALOGUE.iter().map(|tool| tool.spec()).filter(|spec| spec.kind != Kind::Time);
    list.extend(callable.map(|spec| Entry {
        kind: "tool",
        title: spec.name.to_owned(),
        doc: spec.summary.to_owned(),
        keys: String::new(),
        effect: Effect::ShowTool(spec.name),
    }));
    list.extend(company.seen.known_groups.iter().map(|group| Entry {
        kind: "group",
        title: group.id().to_owned(),
        doc: "customers of this group by status".to_owned(),
        keys: String::new(),
        effect: Effect::EditSql(format!(
            "SELECT s.status, s.plan, count(*) AS customers, sum(s.seat_count) AS seats\nFROM customers c JOIN subscriptions s USING (customer_id)\nWHERE c.group_id = '{}' GROUP BY 1, 2 ORDER BY 1, 2",
            group.id()
        )),
    }));
    list.extend(database::tables().iter().map(|table| Entry {
        kind: "table",
        title: table.name.clone(),
        doc: table.description.clone(),
        keys: String::new(),
        effect: Effect::EditSql(format!("SELECT * FROM {} LIMIT 100", table.name)),
    }));
    list.extend(glossary::terms().iter().map(|term| Entry {
        kind: "term",
        title: term.title.clone(),
        doc: term.text.clone(),
        keys: String::new(),
        effect: Effect::Explain(Subject::Term(term)),
    }));
    list
}

impl Dialog for Palette {
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
        let own = centered(area, 96.min(area.width.saturating_sub(2)), 24.min(area.height.saturating_sub(2)));
        canvas.clear(own, Role::Text);
        let note = format!("{} of {}", self.found.len(), self.entries.len());
        let inside = canvas.pane(own, "Palette", &note, true);
        let line = Rect { height: 1.min(inside.height), ..inside };
        canvas.text(line, "›", Role::Key);
        self.field.draw(canvas, Rect { x: line.x + 2, width: line.width.saturating_sub(2), ..line });
        let list = Rect { y: inside.y + 1, height: inside.height.saturating_sub(1), ..inside };
        if self.found.is_empty() {
            canvas.text(list, "nothing is called like that", Role::Dim);
        }
        let from = first_row(self.selected, list.height as usize, self.found.len());
        for (row, (place, (at, letters))) in rows_of(list).zip(self.found.iter().enumerate().skip(from)) {
            self.draw_entry(canvas, row, *at, letters, place == self.selected);
            canvas.click(row, Click::Row(0, place));
        }
        canvas.pane_keys(own, "type to find · up/down choose · enter take · esc close");
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
        let title = Rect { x: row.x + 9, width: 24.min(row.width.saturating_sub(9)), ..row };
        canvas.text(title, &entry.title, role(Role::Text));
        for (column, letter) in entry.title.chars().enumerate() {
            let cell = Rect { x: title.x + column as u16, width: 1, ..title };
            if letters.contains(&(column as u32)) && (column as u16) < title.width {
                canvas.text(cell, &letter.to_string(), role(Role::Key));
            }
        }
        let doc = Rect { x: row.x + 34, width: row.width.saturating_sub(44), ..row };
        canvas.text(doc, &entry.doc, role(Role::Dim));
        let keys = Rect { x: row.right().saturating_sub(9), width: 9.min(row.width), ..row };
        canvas.aligned(keys, &entry.keys, role(Role::Key), Align::Right);
    }
}
