//! The page at the end of a run: rank among published results or the causes of a bankruptcy, the cash curve, and
//! playing statistics.

use std::sync::Arc;

use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::Line as TextLine;
use unicode_width::UnicodeWidthStr;

use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_base::formatting::{dollars, grouped_number, percent};
use novamind_record::rules::ResultsDisclosure;
use novamind_record::trajectory::record::RunEndReason;
use novamind_report::measures::{BehaviorMeasures, BestTriedChannelSpend, MIN_CHANNEL_LEADS};
use novamind_report::ranking::{Ranking, ResultOrigin, published_targeted_share_range, rank_score};
use novamind_report::{RunReport, card_to_svg, card_to_text};
use novamind_session::{ForecastScore, SeekTarget};
use novamind_tui::canvas::{Canvas, centered_rect, truncate_to_width};
use novamind_tui::text::{first_fitting, wrap};
use novamind_tui::theme::Role;
use novamind_tui::widgets::{AxisUnit, Curve, XAxis, YAxis, draw_chart};
use novamind_worker::company::DisplayedCompany;
use novamind_worker::request::{RecordSource, Request};

const MAX_PAGE_WIDTH: u16 = 124;
const MIN_TWO_COLUMN_SIZE: (u16, u16) = (104, 26);
const NAME_WIDTH: usize = 22;

const FINAL_PAGE_ACTIONS: [Action; 7] = [
    Action::WriteRunReport,
    Action::WriteRunCard,
    Action::ReplayFromStart,
    Action::WhatIf,
    Action::Opponents,
    Action::StayInRun,
    Action::ToMenu,
];

fn hides_result(company: &DisplayedCompany) -> bool {
    company.rules.hides_result(company.observation.ended.is_some())
}

/// Opens the run in playback at a position.
fn open_replay(company: &DisplayedCompany, goal: SeekTarget) -> DialogResponse {
    match (&company.folder, company.is_playback) {
        (_, true) => DialogResponse::confirm_with(vec![Effect::Seek(goal)]),
        (Some(_), _) => {
            let recorded = RecordSource::Run(company.observation.run.clone());
            DialogResponse::stay_with(vec![Effect::Request(Request::Replay {
                recorded,
                goal,
                follow: false,
            })])
        }
        (None, _) => {
            let text = "cannot replay: this run is in memory and has no record";
            DialogResponse::stay_with(vec![Effect::ShowError(text.to_owned())])
        }
    }
}

/// The page at the end of a run.
pub struct FinalPage {
    /// The run report, or `None` while the ledger is being read.
    run_report: Option<Arc<RunReport>>,
    /// Whether the page is followed by the next page of a study.
    is_study: bool,
}

impl FinalPage {
    /// Opens the final page of a finished run.
    pub fn new(report: Option<Arc<RunReport>>) -> FinalPage {
        FinalPage { run_report: report, is_study: false }
    }

    /// Returns the page for a participant, followed by the next page of a study.
    pub fn for_participant(self) -> FinalPage {
        FinalPage { is_study: true, ..self }
    }

    fn actions(&self) -> &'static [Action] {
        if self.is_study { &[Action::Continue] } else { &FINAL_PAGE_ACTIONS }
    }
}

impl Dialog for FinalPage {
    fn record_name(&self) -> String {
        "final page".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        if self.is_study { vec![Scope::Study] } else { vec![Scope::FinalPage] }
    }

    fn hints(&self) -> Vec<Action> {
        self.actions().to_vec()
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::ReplayFromStart => open_replay(context.company, SeekTarget::First),
            Action::WhatIf => DialogResponse::confirm_with(vec![Effect::Execute(Action::Branches)]),
            Action::Opponents if !hides_result(context.company) => {
                DialogResponse::stay_with(vec![Effect::ShowOpponents])
            }
            Action::ToMenu => DialogResponse::confirm_with(vec![Effect::Execute(Action::LeaveRun)]),
            Action::StayInRun | Action::Continue => DialogResponse::close(),
            Action::WriteRunCard if !hides_result(context.company) => self.write_card(),
            Action::WriteRunReport => {
                DialogResponse::stay_with(vec![Effect::Request(Request::RenderReportFiles)])
            }
            _ => DialogResponse::stay(),
        }
    }

    fn set_run_report(&mut self, report: &Arc<RunReport>) {
        self.run_report = Some(report.clone());
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let company = context.company;
        let dialog_area = centered_rect(area, MAX_PAGE_WIDTH.min(area.width), 42.min(area.height));
        canvas.clear(dialog_area, Role::Text);
        if hides_result(company) {
            return self.draw_without_result(canvas, area, context);
        }
        let inside = canvas.draw_pane_frame(dialog_area, &headline(company), "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        if inside.width >= MIN_TWO_COLUMN_SIZE.0 && inside.height >= MIN_TWO_COLUMN_SIZE.1 {
            let [left, right] = Layout::horizontal([Constraint::Percentage(55), Constraint::Fill(1)])
                .spacing(3)
                .areas(inside);
            let lines = self.lines(canvas, company, left.width, left.height);
            canvas.draw_lines(left, &lines);
            self.draw_curve_and_highlights(canvas, right, company);
        } else {
            let lines = self.lines(canvas, company, inside.width, inside.height);
            canvas.draw_lines(inside, &lines);
            let used = lines.len() as u16 + 1;
            let below = Rect { y: inside.y + used, height: inside.height.saturating_sub(used), ..inside };
            draw_cash(canvas, below, company);
        }
        canvas.draw_pane_keys(dialog_area, &context.hints(self.actions()));
    }
}

impl FinalPage {
    fn draw_without_result(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        canvas.clear(area, Role::Text);
        let dialog_area = centered_rect(area, 60, 6);
        let practice = context.company.study.as_ref().is_some_and(|study| study.practice);
        let (title, text) = match practice {
            true => ("The practice has ended", "The practice does not count. The session is next."),
            false => ("The run has ended", "This study does not show the result."),
        };
        let inside = canvas.draw_pane_frame(dialog_area, title, "", true);
        let row = Rect { x: inside.x + 1, y: inside.y + 1, width: inside.width.saturating_sub(2), height: 1 };
        canvas.draw_text(row.intersection(inside), text, Role::Text);
        canvas.draw_pane_keys(dialog_area, &context.hints(self.actions()));
    }

    fn write_card(&self) -> DialogResponse {
        let Some(report) = &self.run_report else {
            return DialogResponse::stay_with(vec![Effect::ShowError(
                "the ledger is still being read".to_owned(),
            )]);
        };
        let files = [("card.txt", card_to_text(report)), ("card.svg", card_to_svg(report))];
        DialogResponse::stay_with(
            files.map(|(name, text)| Effect::Write(name.to_owned(), text.into_bytes())).to_vec(),
        )
    }

    fn lines<'a>(
        &self,
        canvas: &Canvas<'_>,
        company: &DisplayedCompany,
        width: u16,
        height: u16,
    ) -> Vec<TextLine<'a>> {
        let roomy = height >= MIN_TWO_COLUMN_SIZE.1;
        let mut parts: Vec<Vec<TextLine<'a>>> = Vec::new();
        parts.extend(self.bankruptcy_lines(canvas, width, roomy));
        let ranking = rank_score(company.observation.score, &company.observation);
        // The explanation of a bankruptcy is shown before the ranking.
        let best = match (roomy, company.observation.ended) {
            (_, Some(RunEndReason::Bankruptcy)) => usize::from(roomy),
            (true, _) => 8,
            (false, _) => 3,
        };
        let published = company.rules.results == ResultsDisclosure::Published;
        if published {
            parts.push(ranking_lines(canvas, &ranking, width, best, roomy));
        }
        parts.push(match &self.run_report {
            Some(report) => {
                let shares =
                    published_targeted_share_range(company.observation.generation).filter(|_| published);
                measure_lines(canvas, &report.measures, width, roomy, shares)
            }
            None => vec![TextLine::from(canvas.span("reading the ledger …", Role::Dim))],
        });
        if roomy
            && !self.is_study
            && let Some(folder) = &company.folder
        {
            let text = format!("Reports are written to {}", folder.display());
            let lines = wrap(&text, width as usize).into_iter();
            parts.push(lines.map(|line| TextLine::from(canvas.span(line, Role::Dim))).collect());
        }
        let mut lines = Vec::new();
        for part in parts {
            if !lines.is_empty() {
                lines.push(TextLine::default());
            }
            lines.extend(part);
        }
        lines
    }

    /// Explains a bankruptcy: the turning point and the main costs.
    fn bankruptcy_lines<'a>(
        &self,
        canvas: &Canvas<'_>,
        width: u16,
        roomy: bool,
    ) -> Option<Vec<TextLine<'a>>> {
        let bankruptcy = self.run_report.as_ref()?.bankruptcy.as_ref()?;
        let texts = wrap(&bankruptcy.turning_points.join(" "), width as usize);
        let mut lines: Vec<TextLine<'a>> =
            texts.into_iter().map(|line| TextLine::from(canvas.span(line, Role::Text))).collect();
        if bankruptcy.costs.is_empty() {
            return Some(lines);
        }
        lines.push(TextLine::from(canvas.span("Where the money went", Role::Header)));
        let room = (width as usize).saturating_sub(NAME_WIDTH + 20).min(40);
        let max = bankruptcy.costs.iter().map(|cost| cost.share).fold(0.0, f64::max);
        for cost in bankruptcy.costs.iter().take(if roomy { 6 } else { 3 }) {
            let bar = "█".repeat((cost.share / max * room as f64).round() as usize);
            lines.push(TextLine::from(vec![
                canvas.span(format!("{:<NAME_WIDTH$}", cost.name), Role::Dim),
                canvas.span(
                    format!("{:>12} {:>4}  ", grouped_number(cost.dollars, 0), percent(cost.share, 0)),
                    Role::Text,
                ),
                canvas.span(bar, Role::Series(1)),
            ]));
        }
        Some(lines)
    }

    /// Draws the cash curve, and the highlights of the run below the curve.
    fn draw_curve_and_highlights(&self, canvas: &mut Canvas<'_>, area: Rect, company: &DisplayedCompany) {
        let highlights = self.run_report.as_ref().map_or(&[][..], |report| report.highlights.as_slice());
        let list = (highlights.len() as u16 + 2).min(area.height / 2);
        let [above, below] = Layout::vertical([Constraint::Fill(1), Constraint::Length(list)]).areas(area);
        draw_cash(canvas, above, company);
        if highlights.is_empty() {
            return;
        }
        let line = |one: &novamind_report::highlights::Highlight| {
            TextLine::from(vec![
                canvas.span(format!("day {:>3}  ", one.day), Role::Dim),
                canvas.span(one.text.clone(), Role::Text),
            ])
        };
        let mut lines = vec![TextLine::default(), TextLine::from(canvas.span("Highlights", Role::Header))];
        lines.extend(highlights.iter().map(line));
        canvas.draw_lines(below, &lines);
    }
}

fn draw_cash(canvas: &mut Canvas<'_>, area: Rect, company: &DisplayedCompany) {
    let cash = [Curve::from_values(&company.cash_by_day, Role::Series(0))];
    let x = XAxis { format: &|day| format!("day {day:.0}"), required_values: &[0.0] };
    draw_chart(canvas, area, &cash, &x, &YAxis { unit: AxisUnit::Dollars, required_values: &[0.0] });
}

fn headline(company: &DisplayedCompany) -> String {
    let seen = &company.observation;
    match seen.ended {
        Some(RunEndReason::Horizon) => format!("Day {}. You end with {}.", seen.day, dollars(seen.cash)),
        Some(RunEndReason::Bankruptcy) => {
            format!("Day {}. The company is bankrupt; the score is $0.", seen.day)
        }
        Some(RunEndReason::Abandoned) => format!("Day {}. The run was given up and has no score.", seen.day),
        Some(RunEndReason::Lesson) => {
            format!("Day {}. The lesson ends with {}.", seen.day, dollars(seen.cash))
        }
        None => format!("Day {}", seen.day),
    }
}

fn ranking_lines<'a>(
    canvas: &Canvas<'_>,
    ranking: &Ranking,
    width: u16,
    best: usize,
    roomy: bool,
) -> Vec<TextLine<'a>> {
    let max = ranking.entries.iter().map(|place| place.cash).fold(1.0, f64::max);
    let room = (width as usize).saturating_sub(49).min(50);
    let mut lines: Vec<TextLine<'a>> = wrap(&ranking.describe(), width as usize)
        .into_iter()
        .map(|line| TextLine::from(canvas.span(line, Role::Header)))
        .collect();
    for place in ranking.top_and_neighbors(best, 1) {
        let is_this_run = place.origin == ResultOrigin::ThisRun;
        let role = if is_this_run { Role::Good } else { Role::Text };
        let bar = "█".repeat(((place.cash.max(0.0) / max) * room as f64).round() as usize);
        lines.push(TextLine::from(vec![
            canvas.span(if is_this_run { "▌ " } else { "  " }, role),
            canvas.span(format!("{:<21}{:>12}", place.name, grouped_number(place.cash, 0)), role),
            canvas.span(format!("{:>10}  ", format_days(place.horizon_days)), Role::Dim),
            canvas.span(bar, if is_this_run { Role::Good } else { Role::Series(0) }),
        ]));
    }
    if let Some(caveat) = &ranking.caveat {
        match roomy {
            true => {
                let caveat_lines = wrap(caveat, width as usize).into_iter();
                lines.extend(caveat_lines.map(|line| TextLine::from(canvas.span(line, Role::Dim))));
            }
            false if best > 0 => {
                // If there is little space, only the first part of the caveat is shown. It describes the publication.
                let first = caveat.split("; ").next().unwrap_or_default().to_owned();
                let text = first_fitting([caveat.clone(), first], width as usize);
                lines.push(TextLine::from(canvas.span(text, Role::Dim)));
            }
            // After a bankruptcy, the explanation of the bankruptcy uses the space.
            false => {}
        }
    }
    lines
}

/// Formats the last day of a ranked result: `504 days`, or an empty text if the day is not published.
fn format_days(days: Option<u32>) -> String {
    days.map_or(String::new(), |days| format!("{days} days"))
}

fn measure_lines<'a>(
    canvas: &Canvas<'_>,
    measures: &BehaviorMeasures,
    width: u16,
    roomy: bool,
    published_shares: Option<(f64, f64)>,
) -> Vec<TextLine<'a>> {
    let room = (width as usize).saturating_sub(NAME_WIDTH);
    let long = if roomy { 2 * room } else { room };
    let targeted = measures.targeted_development.map_or("–".to_owned(), |share| match published_shares {
        Some((min, max)) => {
            format!("{} · published agents {} to {}", percent(share, 0), percent(min, 0), percent(max, 0))
        }
        None => percent(share, 0),
    });
    let (planning, words) = (measures.planning.planning_each, measures.planning.words_each);
    let named: [(&str, String); 5] = [
        ("forecasts", calibration_text(&measures.forecasts, long)),
        (
            "ads on best channel",
            first_fitting(measures.channels.as_ref().map_or_else(Vec::new, best_channel_texts), long),
        ),
        ("targeted development", targeted),
        ("tools", tool_use_text(measures, long)),
        (
            "planning",
            first_fitting(
                [
                    format!("{planning:.1} of {words:.0} words in a mean rationale are planning words"),
                    format!("{planning:.1} of {words:.0} are planning words"),
                ],
                long,
            ),
        ),
    ];
    let mut lines = Vec::new();
    for (name, value) in named {
        let texts = if roomy { wrap(&value, room) } else { vec![truncate_to_width(&value, room)] };
        for (at, text) in texts.into_iter().enumerate() {
            let name = if at == 0 { name } else { "" };
            lines.push(TextLine::from(vec![
                canvas.span(format!("{name:<NAME_WIDTH$}"), Role::Dim),
                canvas.span(text, Role::Text),
            ]));
        }
    }
    lines
}

/// Formats the forecast coverage and the typical error by horizon, shortened to fit.
fn calibration_text(scores: &[ForecastScore], room: usize) -> String {
    let scored = || scores.iter().filter(|score| score.scored > 0);
    let inside = |score: &ForecastScore| percent(f64::from(score.covered) / f64::from(score.scored), 0);
    let long = scored().map(|score| {
        format!(
            "{} wk {} in range, {} error",
            score.horizon_days / 7,
            inside(score),
            percent(score.mean_error, 0)
        )
    });
    let long = long.collect::<Vec<_>>().join(" · ");
    if long.is_empty() {
        return "no forecast is due yet".to_owned();
    }
    if long.width() <= room {
        return long;
    }
    let short = scored().map(|score| format!("{} wk {}", score.horizon_days / 7, inside(score)));
    format!("in range: {}", short.collect::<Vec<_>>().join(" · "))
}

/// Describes the share of ads on the best channel, or why the share is unknown. Returns the longer wording first.
fn best_channel_texts(skill: &BestTriedChannelSpend) -> Vec<String> {
    let first = skill.groups.iter().find_map(|group| Some((group, group.best.as_ref()?)));
    match (skill.share, first) {
        (Some(share), Some((group, best))) => {
            let channel = best.channel.replace('_', " ");
            let share = percent(share, 0);
            vec![format!("{share} · {}: {channel}, best of {} tried", group.group, group.tried), share]
        }
        _ if skill.groups.iter().all(|group| group.tried == 1) => {
            vec!["– · no group had more than one channel".to_owned(), "– · one channel per group".to_owned()]
        }
        _ => vec![format!("– · no channel brought {MIN_CHANNEL_LEADS} leads")],
    }
}

/// Describes the calls per week and as many of the most used tools as fit.
fn tool_use_text(measures: &BehaviorMeasures, room: usize) -> String {
    let mut text = format!("{:.1} calls per week", measures.tools.per_week);
    for (tool, calls) in &measures.tools.tools {
        let more = format!(" · {tool} {calls}×");
        if text.width() + more.width() > room {
            break;
        }
        text += &more;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dialogs::dialog_text;
    use novamind_report::test_kit;
    use novamind_session::Session;

    fn page(session: &Session) -> (FinalPage, DisplayedCompany) {
        (
            FinalPage::new(Some(Arc::new(RunReport::from_session(session)))),
            DisplayedCompany::from_session(session),
        )
    }

    #[test]
    fn finished_run_shows_score_rank_curve_and_measures() {
        let (page, company) = page(&test_kit::finished_run());
        let small = dialog_text(&page, &company, 80, 21);
        let large = dialog_text(&page, &company, 120, 37);
        for (text, name) in [(&small, "80×24"), (&large, "120×40")] {
            for part in [
                "Day 35. You end with $",
                "not ranked: 35 days instead of 500",
                "Rule-based baseline",
                "1 wk ",
                "ads on best channel",
                "best of 2",
                "targeted development  97%",
                "calls per week",
                "planning words",
                "day 0",
                "r report",
            ] {
                assert!(text.contains(part), "{part} is missing at {name}:\n{text}");
            }
        }
        assert!(large.contains("Highlights") && large.contains("peak cash"), "{large}");
    }

    #[test]
    fn bankrupt_run_shows_day_costs_and_turning_point() {
        let (page, company) = page(&test_kit::bankrupt_run());
        for (width, height) in [(80, 21), (120, 37)] {
            let text = dialog_text(&page, &company, width, height);
            for part in [
                "The company is bankrupt; the score is $0.",
                "Where the money went",
                "development and R&D",
                "No week was",
                "not ranked",
                "ads on best channel",
                "planning words",
            ] {
                assert!(text.contains(part), "{part} is missing at {width}×{height}:\n{text}");
            }
        }
    }

    #[test]
    fn page_shows_that_the_ledger_is_being_read() {
        let company = DisplayedCompany::from_session(&test_kit::finished_run());
        let text = dialog_text(&FinalPage::new(None), &company, 80, 21);
        assert!(text.contains("reading the ledger") && !text.contains("▌ You"), "{text}");
    }

    #[test]
    fn page_is_drawn_at_every_size() {
        for session in [test_kit::finished_run(), test_kit::bankrupt_run()] {
            let (page, company) = page(&session);
            for (width, height) in
                (0..130).step_by(26).flat_map(|width| (0..44).step_by(6).map(move |height| (width, height)))
            {
                dialog_text(&page, &company, width, height);
            }
        }
    }
}
