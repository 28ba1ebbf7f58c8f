//! The page at the end of a run: rank among published results or the causes of a bankruptcy, the cash curve, and
//! playing statistics.

use std::sync::Arc;

use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::Line as TextLine;
use unicode_width::UnicodeWidthStr;

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use novamind_base::notation::{dollars, grouped, percent};
use novamind_record::rules::ResultsShown;
use novamind_record::trajectory::record::Ended;
use novamind_report::measures::{ChannelSkill, ENOUGH_LEADS, Measures};
use novamind_report::ranking::{Standing, Whose, published_targeted_shares, standing};
use novamind_report::{Story, card_as_svg, card_as_text};
use novamind_session::{ForecastScore, Goal};
use novamind_tui::canvas::{Canvas, centered, fit};
use novamind_tui::text::{fitting, wrapped};
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Axis, Line, Side, Unit, chart};
use novamind_worker::company::Company;
use novamind_worker::request::{Recorded, Request};

const WIDEST: u16 = 124;
const TWO_COLUMNS: (u16, u16) = (104, 26);
const NAMES: usize = 22;

const KEYS: [Action; 7] = [
    Action::ReportOfRun,
    Action::CardOfRun,
    Action::ReplayOfRun,
    Action::WhatIf,
    Action::Opponents,
    Action::StayInRun,
    Action::ToMenu,
];

fn hides_result(company: &Company) -> bool {
    company.rules.hide_result(company.seen.ended.is_some())
}

/// Opens a moment of the run in playback.
fn replay(company: &Company, goal: Goal) -> Outcome {
    match (&company.folder, company.replayed) {
        (_, true) => Outcome::close_with(vec![Effect::Go(goal)]),
        (Some(_), _) => {
            let recorded = Recorded::Run(company.seen.run.clone());
            Outcome::with(vec![Effect::Request(Request::Replay { recorded, goal, follow: false })])
        }
        (None, _) => {
            let text = "cannot replay: this run is in memory and has no record";
            Outcome::with(vec![Effect::Complain(text.to_owned())])
        }
    }
}

/// The final page.
pub struct FinalPage {
    /// The run report, or `None` while the ledger is read.
    story: Option<Arc<Story>>,
    /// Whether it leads a participant to the next page of a study.
    led: bool,
}

impl FinalPage {
    /// Opens the page of a finished run.
    pub fn new(story: Option<Arc<Story>>) -> FinalPage {
        FinalPage { story, led: false }
    }

    /// Makes it lead to the next page of a study.
    pub fn leading_on(self) -> FinalPage {
        FinalPage { led: true, ..self }
    }

    fn keys(&self) -> &'static [Action] {
        if self.led { &[Action::GoOn] } else { &KEYS }
    }
}

impl Dialog for FinalPage {
    fn what(&self) -> String {
        "final page".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        if self.led { vec![Scope::Visit] } else { vec![Scope::Final] }
    }

    fn hints(&self) -> Vec<Action> {
        self.keys().to_vec()
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        match action {
            Action::ReplayOfRun => replay(look.company, Goal::First),
            Action::WhatIf => Outcome::close_with(vec![Effect::Do(Action::Branches)]),
            Action::Opponents if !hides_result(look.company) => Outcome::with(vec![Effect::ShowOpponents]),
            Action::ToMenu => Outcome::close_with(vec![Effect::Do(Action::LeaveRun)]),
            Action::StayInRun | Action::GoOn => Outcome::close(),
            Action::CardOfRun if !hides_result(look.company) => self.card(),
            Action::ReportOfRun => Outcome::with(vec![Effect::Request(Request::WriteReport)]),
            _ => Outcome::stay(),
        }
    }

    fn take_story(&mut self, story: &Arc<Story>) {
        self.story = Some(story.clone());
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let company = look.company;
        let own = centered(area, WIDEST.min(area.width), 42.min(area.height));
        canvas.clear(own, Role::Text);
        if hides_result(company) {
            return self.draw_over(canvas, area, look);
        }
        let inside = canvas.pane(own, &headline(company), "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        if inside.width >= TWO_COLUMNS.0 && inside.height >= TWO_COLUMNS.1 {
            let [left, right] = Layout::horizontal([Constraint::Percentage(55), Constraint::Fill(1)])
                .spacing(3)
                .areas(inside);
            let lines = self.lines(canvas, company, left.width, left.height);
            canvas.lines(left, &lines);
            self.draw_right(canvas, right, company);
        } else {
            let lines = self.lines(canvas, company, inside.width, inside.height);
            canvas.lines(inside, &lines);
            let used = lines.len() as u16 + 1;
            let below = Rect { y: inside.y + used, height: inside.height.saturating_sub(used), ..inside };
            draw_cash(canvas, below, company);
        }
        canvas.pane_keys(own, &look.hints(self.keys()));
    }
}

impl FinalPage {
    fn draw_over(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.clear(area, Role::Text);
        let own = centered(area, 60, 6);
        let practice = look.company.study.as_ref().is_some_and(|study| study.practice);
        let (title, said) = match practice {
            true => ("The practice has ended", "It does not count. The session comes next."),
            false => ("The run has ended", "This study does not show the result."),
        };
        let inside = canvas.pane(own, title, "", true);
        let row = Rect { x: inside.x + 1, y: inside.y + 1, width: inside.width.saturating_sub(2), height: 1 };
        canvas.text(row.intersection(inside), said, Role::Text);
        canvas.pane_keys(own, &look.hints(self.keys()));
    }

    fn card(&self) -> Outcome {
        let Some(story) = &self.story else {
            return Outcome::with(vec![Effect::Complain("the ledger is still being read".to_owned())]);
        };
        let files = [("card.txt", card_as_text(story)), ("card.svg", card_as_svg(story))];
        Outcome::with(files.map(|(name, text)| Effect::Write(name.to_owned(), text.into_bytes())).to_vec())
    }

    fn lines<'a>(
        &self,
        canvas: &Canvas<'_>,
        company: &Company,
        width: u16,
        height: u16,
    ) -> Vec<TextLine<'a>> {
        let roomy = height >= TWO_COLUMNS.1;
        let mut parts: Vec<Vec<TextLine<'a>>> = Vec::new();
        parts.extend(self.ruin(canvas, width, roomy));
        let standing = standing(company.seen.score, &company.seen);
        // A bankruptcy is explained before it is ranked.
        let best = match (roomy, company.seen.ended) {
            (_, Some(Ended::Bankruptcy)) => usize::from(roomy),
            (true, _) => 8,
            (false, _) => 3,
        };
        let published = company.rules.results == ResultsShown::Published;
        if published {
            parts.push(ranking(canvas, &standing, width, best, roomy));
        }
        parts.push(match &self.story {
            Some(story) => facts(canvas, &story.measures, width, roomy, published),
            None => vec![TextLine::from(canvas.span("reading the ledger …", Role::Dim))],
        });
        if roomy
            && !self.led
            && let Some(folder) = &company.folder
        {
            let text = format!("Reports are written to {}", folder.display());
            let lines = wrapped(&text, width as usize).into_iter();
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

    /// Explains a bankruptcy: the last turn, and the main costs.
    fn ruin<'a>(&self, canvas: &Canvas<'_>, width: u16, roomy: bool) -> Option<Vec<TextLine<'a>>> {
        let ruin = self.story.as_ref()?.ruin.as_ref()?;
        let told = wrapped(&ruin.turned.join(" "), width as usize);
        let mut lines: Vec<TextLine<'a>> =
            told.into_iter().map(|line| TextLine::from(canvas.span(line, Role::Text))).collect();
        if ruin.costs.is_empty() {
            return Some(lines);
        }
        lines.push(TextLine::from(canvas.span("Where the money went", Role::Header)));
        let room = (width as usize).saturating_sub(NAMES + 20).min(40);
        let most = ruin.costs.iter().map(|cost| cost.share).fold(0.0, f64::max);
        for cost in ruin.costs.iter().take(if roomy { 6 } else { 3 }) {
            let bar = "█".repeat((cost.share / most * room as f64).round() as usize);
            lines.push(TextLine::from(vec![
                canvas.span(format!("{:<NAMES$}", cost.name), Role::Dim),
                canvas.span(
                    format!("{:>12} {:>4}  ", grouped(cost.dollars, 0), percent(cost.share, 0)),
                    Role::Text,
                ),
                canvas.span(bar, Role::Series(1)),
            ]));
        }
        Some(lines)
    }

    /// Draws the cash curve with the highlights below.
    fn draw_right(&self, canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
        let highlights = self.story.as_ref().map_or(&[][..], |story| story.highlights.as_slice());
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
        canvas.lines(below, &lines);
    }
}

fn draw_cash(canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
    let cash = [Line::of(&company.cash_by_day, Role::Series(0))];
    let x = Axis { write: &|day| format!("day {day:.0}"), holds: &[0.0] };
    chart(canvas, area, &cash, &x, &Side { unit: Unit::Dollars, holds: &[0.0] });
}

fn headline(company: &Company) -> String {
    let seen = &company.seen;
    match seen.ended {
        Some(Ended::Horizon) => format!("Day {}. You end with {}.", seen.day, dollars(seen.cash)),
        Some(Ended::Bankruptcy) => format!("Day {}. The company is bankrupt; the score is $0.", seen.day),
        Some(Ended::Abandoned) => format!("Day {}. The run was given up; it has no score.", seen.day),
        Some(Ended::Lesson) => format!("Day {}. The lesson ends with {}.", seen.day, dollars(seen.cash)),
        None => format!("Day {}", seen.day),
    }
}

fn ranking<'a>(
    canvas: &Canvas<'_>,
    standing: &Standing,
    width: u16,
    best: usize,
    roomy: bool,
) -> Vec<TextLine<'a>> {
    let most = standing.places.iter().map(|place| place.cash).fold(1.0, f64::max);
    let room = (width as usize).saturating_sub(39).min(50);
    let mut lines: Vec<TextLine<'a>> = wrapped(&standing.in_words(), width as usize)
        .into_iter()
        .map(|line| TextLine::from(canvas.span(line, Role::Header)))
        .collect();
    for place in standing.around(best, 1) {
        let own = place.whose == Whose::Own;
        let role = if own { Role::Good } else { Role::Text };
        let bar = "█".repeat(((place.cash.max(0.0) / most) * room as f64).round() as usize);
        lines.push(TextLine::from(vec![
            canvas.span(if own { "▌ " } else { "  " }, role),
            canvas.span(format!("{:<21}{:>12}  ", place.name, grouped(place.cash, 0)), role),
            canvas.span(bar, if own { Role::Good } else { Role::Series(0) }),
        ]));
    }
    if let Some(caveat) = &standing.caveat {
        match roomy {
            true => {
                let told = wrapped(caveat, width as usize).into_iter();
                lines.extend(told.map(|line| TextLine::from(canvas.span(line, Role::Dim))));
            }
            false if best > 0 => {
                // The publication comes first; differences of this run are in the header.
                let first = caveat.split("; ").next().unwrap_or_default().to_owned();
                let told = fitting([caveat.clone(), first], width as usize);
                lines.push(TextLine::from(canvas.span(told, Role::Dim)));
            }
            // A bankruptcy uses the space.
            false => {}
        }
    }
    lines
}

fn facts<'a>(
    canvas: &Canvas<'_>,
    measures: &Measures,
    width: u16,
    roomy: bool,
    published: bool,
) -> Vec<TextLine<'a>> {
    let room = (width as usize).saturating_sub(NAMES);
    let long = if roomy { 2 * room } else { room };
    let (least, most) = published_targeted_shares();
    let targeted = measures.targeted_development.map_or("–".to_owned(), |share| match published {
        true => {
            format!("{} · published agents {} to {}", percent(share, 0), percent(least, 0), percent(most, 0))
        }
        false => percent(share, 0),
    });
    let planning = format!("{:.1} planning words", measures.planning.planning_each);
    let words = measures.planning.words_each;
    let named: [(&str, String); 5] = [
        ("forecasts", calibration(&measures.forecasts, long)),
        (
            "ads on best channel",
            fitting(measures.channels.as_ref().map_or_else(Vec::new, best_channel), long),
        ),
        ("targeted development", targeted),
        ("tools", tools(measures, long)),
        (
            "planning",
            fitting(
                [format!("{planning} in a rationale of {words:.0}"), format!("{planning} of {words:.0}")],
                long,
            ),
        ),
    ];
    let mut lines = Vec::new();
    for (name, value) in named {
        let told = if roomy { wrapped(&value, room) } else { vec![fit(&value, room)] };
        for (at, text) in told.into_iter().enumerate() {
            let name = if at == 0 { name } else { "" };
            lines.push(TextLine::from(vec![
                canvas.span(format!("{name:<NAMES$}"), Role::Dim),
                canvas.span(text, Role::Text),
            ]));
        }
    }
    lines
}

/// Formats coverage and typical error by horizon, shortened to fit.
fn calibration(scores: &[ForecastScore], room: usize) -> String {
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
        return "none is due yet".to_owned();
    }
    if long.width() <= room {
        return long;
    }
    let short = scored().map(|score| format!("{} wk {}", score.horizon_days / 7, inside(score)));
    format!("in range: {}", short.collect::<Vec<_>>().join(" · "))
}

/// Describes the share of ads on the best channel, or why it is unknown; the longer wording first.
fn best_channel(skill: &ChannelSkill) -> Vec<String> {
    let first = skill.groups.iter().find_map(|group| Some((group, group.best.as_ref()?)));
    match (skill.share, first) {
        (Some(share), Some((group, best))) => {
            let channel = best.channel.replace('_', " ");
            let share = percent(share, 0);
            vec![format!("{share} · {}: {channel} of {} tried", group.group, group.tried), share]
        }
        _ if skill.groups.iter().all(|group| group.tried == 1) => {
            vec!["– · no group had more than one channel".to_owned(), "– · one channel per group".to_owned()]
        }
        _ => vec![format!("– · no channel brought {ENOUGH_LEADS} leads")],
    }
}

/// Lists calls per week and the most used tools, as many as fit.
fn tools(measures: &Measures, room: usize) -> String {
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
    use crate::dialogs::picture;
    use novamind_report::test_kit;
    use novamind_session::Session;

    fn page(session: &Session) -> (FinalPage, Company) {
        (FinalPage::new(Some(Arc::new(Story::of(session)))), Company::of(session))
    }

    #[test]
    fn a_finished_run_shows_score_rank_curve_and_measures_at_both_sizes() {
        let (page, company) = page(&test_kit::finished());
        let small = picture(&page, &company, 80, 21);
        let large = picture(&page, &company, 120, 37);
        for (text, name) in [(&small, "80×24"), (&large, "120×40")] {
            for part in [
                "Day 35. You end with $",
                "not ranked: 35 days instead of 500",
                "Rule-based baseline",
                "1 wk ",
                "ads on best channel",
                "of 2 tried",
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
    fn a_ruined_run_says_when_what_it_went_to_and_what_turned() {
        let (page, company) = page(&test_kit::ruined());
        for (width, height) in [(80, 21), (120, 37)] {
            let text = picture(&page, &company, width, height);
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
    fn before_the_story_is_told_the_page_says_so() {
        let company = Company::of(&test_kit::finished());
        let text = picture(&FinalPage::new(None), &company, 80, 21);
        assert!(text.contains("reading the ledger") && !text.contains("▌ You"), "{text}");
    }

    #[test]
    fn it_draws_in_windows_of_every_size() {
        for session in [test_kit::finished(), test_kit::ruined()] {
            let (page, company) = page(&session);
            for (width, height) in
                (0..130).step_by(26).flat_map(|width| (0..44).step_by(6).map(move |height| (width, height)))
            {
                picture(&page, &company, width, height);
            }
        }
    }
}
