//! Open issues by group and age.

use std::collections::BTreeMap;

use ratatui::layout::Rect;

use super::model::Ages;
use crate::console::canvas::{Canvas, rows_of};
use crate::console::theme::Role;
use crate::console::widgets::spark::bar;
use crate::notation::grouped;

/// One line on issues.
pub fn summary(issues: &BTreeMap<String, Ages>) -> String {
    let all: f64 = issues.values().flatten().sum();
    let old: f64 = issues.values().map(|ages| ages[2] + ages[3]).sum();
    format!("{} open, {} of them for 8 days or more", grouped(all, 0), grouped(old, 0))
}

/// Draws one group in a row, and all of them in the last.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, issues: &BTreeMap<String, Ages>, from: usize) {
    let line = |name: &str, cells: [String; 5]| {
        let [young, week, fortnight, old, all] = cells;
        format!("{name:<8}{young:>9}{week:>9}{fortnight:>9}{old:>9}{all:>9}")
    };
    let head = ["to 3 d", "4-7 d", "8-14 d", "15+ d", "all"].map(str::to_owned);
    canvas.text(area, &line("group", head), Role::Header);
    if area.height < 2 {
        return;
    }
    if issues.is_empty() {
        let below = Rect { y: area.y + 1, height: 1, ..area };
        canvas.text(below, "no customer waits for support", Role::Dim);
        return;
    }
    let cells = |ages: &Ages| {
        let [young, week, fortnight, old] = *ages;
        [young, week, fortnight, old, ages.iter().sum()].map(|count| match count {
            0.0 => "–".to_owned(),
            count => grouped(count, 0),
        })
    };
    let mut all: Ages = [0.0; 4];
    for ages in issues.values() {
        all.iter_mut().zip(ages).for_each(|(sum, count)| *sum += count);
    }
    let whole = all.iter().sum::<f64>().max(1.0);
    let lines = std::iter::once(("all", &all))
        .chain(issues.iter().map(|(group, ages)| (group.as_str(), ages)).skip(from));
    let below = Rect { y: area.y + 1, height: area.height - 1, ..area };
    for (row, (name, ages)) in rows_of(below).zip(lines) {
        let role = match (name, ages[3] > 0.0) {
            ("all", _) => Role::Strong,
            (_, true) => Role::Warning,
            _ => Role::Text,
        };
        canvas.text(row, &line(name, cells(ages)), role);
        if row.width > 66 && name != "all" {
            let width = (row.width - 56).min(24);
            let place = Rect { x: row.x + 55, width, ..row };
            canvas.text(place, &bar(ages.iter().sum::<f64>() / whole, width as usize), Role::Series(0));
        }
    }
}
