//! Ranking of the published results and the finished runs on this machine.

use ratatui::layout::Rect;

use super::StartMenu;
use novamind_base::formatting::{compact_number, dollars};
use novamind_record::folder::runs::RunSummary;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::RunEndReason;
use novamind_report::ranking::{
    PublishedAgent, describe_published_conditions, format_horizon, published_results,
};
use novamind_report::ranking_eligibility::{RankingCriteria, RankingObstacle, explain_unranked_runs};
use novamind_tui::canvas::{Align, Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct RankedResult {
    name: String,
    rank: Option<usize>,
    cash: f64,
    note: String,
    is_own: bool,
}

/// Returns the published results of release 1 and the user's results, the best first, then the published results that
/// are not ranked.
pub(super) fn rank_results(runs: &[RunSummary]) -> Vec<RankedResult> {
    let published = published_results();
    let baseline = RankedResult {
        name: "Rule-based baseline".to_owned(),
        rank: None,
        cash: published.rule_based_baseline,
        note: String::new(),
        is_own: false,
    };
    let mut results = vec![baseline];
    let row = |agent: &PublishedAgent, note: String| RankedResult {
        name: agent.name.clone(),
        rank: None,
        cash: agent.best_cash,
        note: format!("{} of {} bankrupt · {note}", agent.bankruptcies, agent.runs),
        is_own: false,
    };
    let days = |agent: &PublishedAgent| format!("{} days", format_horizon(agent.horizon_days));
    results.extend(published.paper().agent.iter().map(|agent| row(agent, days(agent))));
    results.extend(
        runs.iter()
            .filter(|run| {
                ranking_obstacles(run).is_some_and(|ranking_obstacles| ranking_obstacles.is_empty())
            })
            .map(|run| RankedResult {
                name: format!("You · {}", run.id),
                rank: None,
                cash: if run.ended == Some(RunEndReason::Bankruptcy) { 0.0 } else { run.cash },
                note: format!("{} · seed {} · {} days", run.mode.map_or("", Mode::id), run.seed, run.days),
                is_own: true,
            }),
    );
    results.sort_by(|left, right| right.cash.total_cmp(&left.cash).then_with(|| left.name.cmp(&right.name)));
    results.iter_mut().enumerate().for_each(|(at, result)| result.rank = Some(at + 1));
    results.extend(published.unranked_agents().map(|agent| row(agent, "generation not stated".to_owned())));
    results
}

/// Returns the reasons why a run is not ranked, or `None` if the run has no score.
fn ranking_obstacles(run: &RunSummary) -> Option<Vec<RankingObstacle>> {
    let has_score =
        matches!(run.ended, Some(RunEndReason::Horizon | RunEndReason::Bankruptcy | RunEndReason::Lesson));
    (has_score && run.problem.is_none()).then(|| RankingCriteria::from_summary(run).obstacles())
}

impl StartMenu {
    pub(super) fn draw_published_results(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let results = rank_results(self.runs());
        let number = results.iter().filter(|result| result.is_own).count();
        let note = if number > 0 { format!("{number} of your runs") } else { String::new() };
        let inside = canvas.draw_pane_frame(area, "Published results and yours", &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let lines =
            wrap(&format!("{}\n{}", self.own_results_text(number), source_text()), inside.width as usize);
        let list = Rect { height: inside.height.saturating_sub(lines.len() as u16 + 1), ..inside };
        let max = results.first().map_or(1.0, |result| result.cash.max(1.0));
        let from = canvas.scroll_to_row(list, self.selected, results.len());
        for (row, result) in row_rects(list).zip(results.iter().skip(from)) {
            draw_result(canvas, row, result, max);
        }
        let used = list.height + 1;
        let below = Rect { y: inside.y + used, height: inside.height.saturating_sub(used), ..inside };
        for (row, line) in row_rects(below).zip(lines) {
            canvas.draw_text(row, &line, Role::Dim);
        }
    }

    /// Explains why runs are not ranked, or how the user's ranked runs are marked.
    fn own_results_text(&self, ranked: usize) -> String {
        let finished: Vec<Vec<RankingObstacle>> = self.runs().iter().filter_map(ranking_obstacles).collect();
        match (ranked, explain_unranked_runs(&finished)) {
            (_, Some(left_out)) => left_out,
            (0, None) => "Finish a 500-day run to appear here.".to_owned(),
            (_, None) => "Your runs are marked; bankrupt runs count as $0.".to_owned(),
        }
    }
}

/// Describes the source and the conditions of the published results.
fn source_text() -> String {
    let bound = compact_number(published_results().estimated_upper_bound);
    format!(
        "{}, best cash of three runs each.\nEstimated upper bound: ${bound}. {}.",
        describe_published_conditions(),
        published_results().explain_unranked_agents()
    )
}

fn draw_result(canvas: &mut Canvas<'_>, row: Rect, result: &RankedResult, max: f64) {
    let role = if result.is_own { Role::Key } else { Role::Text };
    let place =
        |x: u16, width: u16| Rect { x: row.x + x, width: width.min(row.width.saturating_sub(x)), ..row };
    let mark = if result.is_own { "▌" } else { " " };
    let rank = result.rank.map_or("–".to_owned(), |rank| rank.to_string());
    canvas.draw_text(place(0, 1), mark, role);
    canvas.draw_aligned(place(1, 2), &rank, Role::Dim, Align::Right);
    canvas.draw_text(place(4, 22), &result.name, role);
    canvas.draw_aligned(place(27, 13), &dollars(result.cash), role, Align::Right);
    canvas.draw_text(place(41, 31), &result.note, Role::Dim);
    let room = row.width.saturating_sub(73);
    let length = (f64::from(room) * (result.cash / max).clamp(0.0, 1.0)).round() as usize;
    let bar = "█".repeat(length.max(usize::from(result.cash > 0.0)));
    canvas.draw_text(place(73, room), &bar, if result.is_own { Role::Key } else { Role::Series(0) });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::screens::menu::tests::summary;

    #[test]
    fn own_runs_are_ranked_among_published_results() {
        let finished = |id: &str, cash: f64, days: u32, ended: Option<RunEndReason>| RunSummary {
            cash,
            days,
            day: days,
            ended,
            ..summary(id)
        };
        let runs = [
            finished("rich", 1e9, 500, Some(RunEndReason::Horizon)),
            finished("short", 1e9, 70, Some(RunEndReason::Horizon)),
            RunSummary { starting_cash: 2e6, ..finished("gift", 1e9, 500, Some(RunEndReason::Horizon)) },
            RunSummary {
                scenario: "competitor-off".to_owned(),
                ..finished("alone", 1e9, 500, Some(RunEndReason::Horizon))
            },
            finished("open", 1e9, 500, None),
            finished("ruin", -5.0, 500, Some(RunEndReason::Bankruptcy)),
        ];
        let results = rank_results(&runs);
        let why: Vec<Option<usize>> = runs
            .iter()
            .map(|run| ranking_obstacles(run).map(|ranking_obstacles| ranking_obstacles.len()))
            .collect();
        assert_eq!(why, [Some(0), Some(1), Some(1), Some(1), None, Some(0)]);
        assert_eq!((results[0].name.as_str(), results[0].is_own), ("You · rich", true));
        assert_eq!(results.iter().filter(|result| result.is_own).count(), 2);
        let ranked_result =
            results.iter().find(|result| result.name == "You · ruin").expect("the bankrupt run");
        assert!(ranked_result.cash.abs() < 1e-9);
        let (ranked, others): (Vec<&RankedResult>, Vec<&RankedResult>) =
            results.iter().partition(|result| result.rank.is_some());
        assert!(ranked.is_sorted_by(|left, right| left.cash >= right.cash));
        let names: Vec<&str> = others.iter().map(|result| result.name.as_str()).collect();
        assert_eq!(names, ["Kimi K3", "Grok 4.6", "Grok 4.5"]);
    }
}
