//! Comparison of a finished run with strong policies on the same scenario and seed.

use ratatui::layout::Rect;
use ratatui::text::Line as TextLine;

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use novamind_base::notation::dollars;
use novamind_record::trajectory::record::Ended;
use novamind_report::opponents::{Opponent, Opponents, PlayOpponents};
use novamind_tools::Refusal;
use novamind_tui::canvas::{Canvas, centered};
use novamind_tui::text::{fitting, wrapped};
use novamind_tui::theme::Role;
use novamind_worker::asking::{Ask, Pending};
use novamind_worker::company::Company;
use novamind_worker::questions::OpponentsQuestion;

const SIZE: (u16, u16) = (96, 16);
/// Columns before the bars: mark, name, score.
const NAMED: usize = 38;

/// The opponents page.
#[derive(Default)]
pub struct OpponentsPage {
    found: Option<Result<Opponents, Refusal>>,
    asked: Pending<OpponentsQuestion>,
}

impl OpponentsPage {
    /// Requests the opponents, which `play` simulates.
    pub fn new(play: PlayOpponents) -> (OpponentsPage, Ask) {
        let (asked, ask) = Pending::asking(OpponentsQuestion(play));
        (OpponentsPage { found: None, asked }, ask)
    }
}

impl Dialog for OpponentsPage {
    fn what(&self) -> String {
        "opponents".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Dialog]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Cancel]
    }

    fn act(&mut self, action: Action, _: &Look<'_>) -> Outcome {
        if action == Action::Cancel { Outcome::close() } else { Outcome::stay() }
    }

    fn take_answers(&mut self) {
        if let Some((_, found)) = self.asked.try_take() {
            self.found = Some(found);
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let own = centered(area, SIZE.0.min(area.width), SIZE.1.min(area.height));
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, "Opponents", "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        canvas.pane_keys(own, &look.hints(&self.hints()));
        let width = inside.width as usize;
        let (role, told) = match &self.found {
            None => (Role::Warning, "simulating the strong policies from day 0 …".to_owned()),
            Some(Err(refusal)) => (Role::Bad, refusal.message.clone()),
            Some(Ok(opponents)) => (Role::Dim, opponents.in_words()),
        };
        let mut lines: Vec<TextLine<'_>> =
            wrapped(&told, width).into_iter().map(|line| TextLine::from(canvas.span(line, role))).collect();
        if let Some(Ok(opponents)) = &self.found {
            lines.push(TextLine::default());
            lines.extend(ranked(canvas, look.company, opponents, width));
        }
        canvas.lines(inside, &lines);
    }
}

/// Ranks the policies, and the run if it has a score.
fn ranked<'a>(
    canvas: &Canvas<'_>,
    company: &Company,
    opponents: &Opponents,
    width: usize,
) -> Vec<TextLine<'a>> {
    let seen = &company.seen;
    let own = match seen.ended {
        Some(Ended::Bankruptcy) => Some((0.0, format!("bankrupt on day {}", seen.day))),
        Some(Ended::Horizon | Ended::Lesson) => Some((seen.cash, dollars(seen.cash))),
        Some(Ended::Abandoned) | None => None,
    };
    let policy = |one: &Opponent| (one.policy.clone(), one.score(), one.in_words(), false);
    let mut rows: Vec<_> = opponents.policies.iter().map(policy).collect();
    if let Some((score, told)) = own {
        rows.insert(opponents.ahead_of(score), ("You".to_owned(), score, told, true));
    }
    let most = rows.iter().map(|row| row.1).fold(1.0, f64::max);
    let room = width.saturating_sub(NAMED) as f64;
    let line = |(name, score, told, is_own): (String, f64, String, bool)| {
        let role = if is_own { Role::Good } else { Role::Text };
        let bar = "█".repeat((score.max(0.0) / most * room).round() as usize);
        let mark = if is_own { "▌ " } else { "  " };
        let told = fitting([told], width.saturating_sub(22));
        TextLine::from(vec![
            canvas.span(format!("{mark}{name:<20}"), role),
            canvas.span(format!("{told:>14}  "), role),
            canvas.span(bar, if is_own { Role::Good } else { Role::Series(0) }),
        ])
    };
    rows.into_iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dialogs::picture;
    use novamind_report::test_kit;

    fn page(found: Result<Opponents, Refusal>) -> OpponentsPage {
        OpponentsPage { found: Some(found), ..OpponentsPage::default() }
    }

    fn opponent(policy: &str, cash: f64, is_bankrupt: bool) -> Opponent {
        Opponent { policy: policy.to_owned(), day: 35, cash, is_bankrupt, stopped: None }
    }

    #[test]
    fn the_run_stands_among_its_opponents() {
        let company = Company::of(&test_kit::finished());
        let own = company.seen.cash;
        let policies = vec![
            opponent("ads-first", own * 2.0, false),
            opponent("baseline", own / 2.0, false),
            opponent("harvest-late", -12.0, true),
        ];
        let page = page(Ok(Opponents { day: 35, policies }));
        for (width, height) in [(60, 14), (80, 22), (120, 38)] {
            let text = picture(&page, &company, width, height);
            let at = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part} is missing:\n{text}"));
            assert!(at("ads-first") < at("▌ You") && at("▌ You") < at("baseline"), "{text}");
            assert!(at(&dollars(own)) > 0 && at("bankrupt on day 35") > at("harvest-late"), "{text}");
        }
    }

    #[test]
    fn it_says_what_it_waits_for_and_why_there_is_nothing_in_windows_of_every_size() {
        let company = Company::of(&test_kit::ruined());
        let waits = OpponentsPage::default();
        assert!(picture(&waits, &company, 60, 14).contains("simulating the strong policies"));
        let refused = page(Err(Refusal::new("not_possible", "parameters were set")));
        assert!(picture(&refused, &company, 60, 14).contains("parameters were set"));
        for (width, height) in
            (0..130).step_by(26).flat_map(|width| (0..44).step_by(8).map(move |height| (width, height)))
        {
            picture(&waits, &company, width, height);
            picture(&refused, &company, width, height);
        }
    }
}
