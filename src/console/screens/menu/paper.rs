//! Published results, ranked, together with the finished runs on this machine.

use ratatui::layout::Rect;

use super::Menu;
use novamind_base::notation::{compact, dollars};
use novamind_record::folder::runs::RunSummary;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Ended;
use novamind_report::comparable::{Obstacle, RunTerms, not_ranked_in_words};
use novamind_report::ranking::{published, published_terms};
use novamind_tui::canvas::{Align, Canvas, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::table::first_row;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ranked {
    name: String,
    cash: f64,
    note: String,
    own: bool,
}

/// Returns all results, best first.
pub(super) fn ranked(runs: &[RunSummary]) -> Vec<Ranked> {
    let paper = published();
    let baseline = Ranked {
        name: "Rule-based baseline".to_owned(),
        cash: paper.rule_based_baseline,
        note: String::new(),
        own: false,
    };
    let mut results = vec![baseline];
    results.extend(paper.agent.iter().map(|agent| Ranked {
        name: agent.name.clone(),
        cash: agent.best_cash,
        note: format!("{} of {} bankrupt", agent.bankruptcies, agent.runs),
        own: false,
    }));
    results.extend(runs.iter().filter(|run| obstacles(run).is_some_and(|own| own.is_empty())).map(|run| {
        Ranked {
            name: format!("You · {}", run.id),
            cash: if run.ended == Some(Ended::Bankruptcy) { 0.0 } else { run.cash },
            note: format!("{} · seed {}", run.mode.map_or("", Mode::id), run.seed),
            own: true,
        }
    }));
    results.sort_by(|left, right| right.cash.total_cmp(&left.cash).then_with(|| left.name.cmp(&right.name)));
    results
}

/// Returns the reasons why a run is not ranked; `None` if the run has no score.
fn obstacles(run: &RunSummary) -> Option<Vec<Obstacle>> {
    let has_score = matches!(run.ended, Some(Ended::Horizon | Ended::Bankruptcy | Ended::Lesson));
    (has_score && run.problem.is_none()).then(|| RunTerms::of_summary(run).obstacles())
}

impl Menu {
    pub(super) fn draw_paper(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let results = ranked(self.list());
        let own = results.iter().filter(|result| result.own).count();
        let note = if own > 0 { format!("{own} of yours") } else { String::new() };
        let inside = canvas.pane(area, "Published results and yours", &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let lines = wrapped(&format!("{}\n{}", self.yours(own), source()), inside.width as usize);
        let list = Rect { height: inside.height.saturating_sub(lines.len() as u16 + 1), ..inside };
        let most = results.first().map_or(1.0, |result| result.cash.max(1.0));
        let from = first_row(self.selected, list.height as usize, results.len());
        for (row, (at, result)) in rows_of(list).zip(results.iter().enumerate().skip(from)) {
            draw_result(canvas, row, at, result, most);
        }
        let used = list.height + 1;
        let below = Rect { y: inside.y + used, height: inside.height.saturating_sub(used), ..inside };
        for (row, line) in rows_of(below).zip(lines) {
            canvas.text(row, &line, Role::Dim);
        }
    }

    /// Explains which runs are ranked, and why others are not.
    fn yours(&self, ranked: usize) -> String {
        let finished: Vec<Vec<Obstacle>> = self.list().iter().filter_map(obstacles).collect();
        match (ranked, not_ranked_in_words(&finished)) {
            (_, Some(left_out)) => left_out,
            (0, None) => "Finish a 500-day run to appear here.".to_owned(),
            (_, None) => "Yours are marked; a bankrupt run counts as $0.".to_owned(),
        }
    }
}

/// Returns the source of the published results.
fn source() -> String {
    let bound = compact(published().estimated_upper_bound);
    format!("{}, best cash of three runs each. Estimated upper bound: ${bound}.", published_terms())
}

fn draw_result(canvas: &mut Canvas<'_>, row: Rect, at: usize, result: &Ranked, most: f64) {
    let role = if result.own { Role::Key } else { Role::Text };
    let place =
        |x: u16, width: u16| Rect { x: row.x + x, width: width.min(row.width.saturating_sub(x)), ..row };
    let mark = if result.own { "▌" } else { " " };
    canvas.text(place(0, 1), mark, role);
    canvas.aligned(place(1, 2), &(at + 1).to_string(), Role::Dim, Align::Right);
    canvas.text(place(4, 22), &result.name, role);
    canvas.aligned(place(27, 13), &dollars(result.cash), role, Align::Right);
    canvas.text(place(41, 20), &result.note, Role::Dim);
    let room = row.width.saturating_sub(62);
    let length = (f64::from(room) * (result.cash / most).clamp(0.0, 1.0)).round() as usize;
    let bar = "█".repeat(length.max(usize::from(result.cash > 0.0)));
    canvas.text(place(62, room), &bar, if result.own { Role::Key } else { Role::Series(0) });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::screens::menu::tests::summary;

    #[test]
    fn own_runs_stand_where_their_cash_puts_them() {
        let finished = |id: &str, cash: f64, days: u32, ended: Option<Ended>| RunSummary {
            cash,
            days,
            day: days,
            ended,
            ..summary(id)
        };
        let runs = [
            finished("rich", 1e9, 500, Some(Ended::Horizon)),
            finished("short", 1e9, 70, Some(Ended::Horizon)),
            RunSummary { starting_cash: 2e6, ..finished("gift", 1e9, 500, Some(Ended::Horizon)) },
            RunSummary {
                scenario: "competitor-off".to_owned(),
                ..finished("alone", 1e9, 500, Some(Ended::Horizon))
            },
            finished("open", 1e9, 500, None),
            finished("ruin", -5.0, 500, Some(Ended::Bankruptcy)),
        ];
        let results = ranked(&runs);
        let why: Vec<Option<usize>> = runs.iter().map(|run| obstacles(run).map(|own| own.len())).collect();
        assert_eq!(why, [Some(0), Some(1), Some(1), Some(1), None, Some(0)]);
        assert_eq!((results[0].name.as_str(), results[0].own), ("You · rich", true));
        assert_eq!(results.iter().filter(|result| result.own).count(), 2);
        let ruin = results.iter().find(|result| result.name == "You · ruin").expect("the bankrupt run");
        assert!(ruin.cash.abs() < 1e-9);
        assert!(results.is_sorted_by(|left, right| left.cash >= right.cash));
    }
}
