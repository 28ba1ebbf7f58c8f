//! Small pictures that illustrate glossary terms with figures that the player can see. If the run has no such figures,
//! a picture uses published parameters or an invented customer. No picture contains hidden values.

use super::fit::{Fit, fits};
use super::plot::{PlotSeries, plot_report};
use novamind_base::formatting::{compact_number, percent};
use novamind_insight::example_curve;
use novamind_record::figures::{WeekFigures, last_week_churn};
use novamind_session::identifiers::{ByGroup, Group, Plan};
use novamind_session::{DeliveredQuality, GroupWeek, Session};
use novamind_tools::ParameterNumbers;

const EXAMPLE_REPUTATION_CHANGE: f64 = 0.1;
/// Number of weeks for which the remaining share of a cohort is shown.
const COHORT_WEEKS: u32 = 26;
const MAX_BAR_WIDTH: f64 = 30.0;

/// Figures of a run that the player can see.
pub struct VisibleFigures<'a> {
    /// Figures of the company for every week.
    pub weeks: &'a [WeekFigures],
    /// Figures of every group for every week.
    pub group_weeks: &'a [ByGroup<GroupWeek>],
    /// Fit of every known group.
    pub fits: &'a [Fit],
    /// Delivered quality of every known group.
    pub quality: &'a [DeliveredQuality],
    /// Base quality, and the general bonus that development has added.
    pub quality_base: (f64, f64),
    /// Parameter values that the manual documents.
    pub numbers: &'a ParameterNumbers,
}

/// A picture that illustrates a glossary term.
#[derive(Debug, Clone, PartialEq)]
pub struct TermPicture {
    /// Sentence that explains what the picture shows.
    pub caption: String,
    /// The drawing; `None` if the run has no figures for it yet.
    pub drawing: Option<TermDrawing>,
}

/// Drawing of a picture as lines or bars.
#[derive(Debug, Clone, PartialEq)]
pub enum TermDrawing {
    /// Lines, points and a band in a chart with axes.
    Lines(TermLines),
    /// Bars with a name and an amount.
    Bars(Vec<(String, f64)>),
}

/// Lines, points and a band in a chart with axes.
#[derive(Debug, Clone, PartialEq)]
pub struct TermLines {
    /// Name and points of each line; the name can be empty.
    pub lines: Vec<(&'static str, Vec<(f64, f64)>)>,
    /// Shaded interval: horizontal position, lower endpoint and upper endpoint of each point.
    pub band: Vec<(f64, f64, f64)>,
    /// Plans that are drawn as points, with their horizontal and vertical positions.
    pub plans: Vec<(Plan, f64, f64)>,
    /// Unit of the horizontal axis.
    pub x_axis: TermXAxis,
}

/// What the horizontal axis counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TermXAxis {
    /// Amounts in dollars.
    Dollars,
    /// Number of weeks.
    Weeks,
    /// Shares from 0 to 1.
    Share,
}

/// Returns whether a term has a picture.
pub fn has_picture(term: &str) -> bool {
    matches!(
        term,
        "participation-curve"
            | "required-quality"
            | "fit"
            | "cohort"
            | "spill-over"
            | "quality-bank"
            | "network-source"
    )
}

/// Returns the picture of a glossary term, or `None` if the term has no picture.
pub fn term_picture(term: &str, seen: &VisibleFigures<'_>) -> Option<TermPicture> {
    Some(match term {
        "participation-curve" | "required-quality" => participation_curve(),
        "fit" => estimates_and_plans(seen.fits),
        "cohort" => cohort_retention(seen.weeks),
        "spill-over" => spillover(seen.numbers),
        "quality-bank" => quality_bank(seen),
        "network-source" => word_of_mouth(seen.group_weeks),
        _ => return None,
    })
}

fn line_drawing(lines: Vec<(&'static str, Vec<(f64, f64)>)>, across: TermXAxis) -> Option<TermDrawing> {
    Some(TermDrawing::Lines(TermLines { lines, band: Vec::new(), plans: Vec::new(), x_axis: across }))
}

fn participation_curve() -> TermPicture {
    TermPicture {
        caption: "Required quality by price, for an example customer with a budget of $50.".to_owned(),
        drawing: line_drawing(vec![("", example_curve())], TermXAxis::Dollars),
    }
}

/// Compares the plans with the estimates of that group of individuals whose estimates are the most precise.
fn estimates_and_plans(fits: &[Fit]) -> TermPicture {
    let individuals = fits.iter().filter(|fit| !fit.group.is_enterprise());
    let Some(fit) =
        individuals.min_by(|one, other| one.max_relative_error.total_cmp(&other.max_relative_error))
    else {
        return TermPicture { caption: "No group of individuals is known yet.".to_owned(), drawing: None };
    };
    let places =
        || Plan::ALL.into_iter().map(|plan| (plan, fit.plans[plan].lead_price, fit.plans[plan].quality));
    let right = places().map(|place| place.1).fold(fit.budget.most, f64::max) * 1.05;
    let top = places().map(|place| place.2).fold(fit.floor.most, f64::max) * 1.05;
    let upright = |at: f64| ("", vec![(at, 0.0), (at, top)]);
    TermPicture {
        caption: format!(
            "{}, estimates of day {}: plans by price and quality. Shaded: mean required quality. Vertical: mean budget.",
            fit.group, fit.study_day
        ),
        drawing: Some(TermDrawing::Lines(TermLines {
            lines: vec![upright(fit.budget.least), upright(fit.budget.most)],
            band: [0.0, right].map(|at| (at, fit.floor.least, fit.floor.most)).to_vec(),
            plans: places().collect(),
            x_axis: TermXAxis::Dollars,
        })),
    }
}

/// Draws the share of a cohort that remains after each week if the churn of the last week continues.
fn cohort_retention(weeks: &[WeekFigures]) -> TermPicture {
    let Some(churn) = last_week_churn(weeks) else {
        let caption = "Churn is unknown until a week that started with subscribers has run.".to_owned();
        return TermPicture { caption, drawing: None };
    };
    let left = |week: u32| (f64::from(week), libm::pow(1.0 - churn, f64::from(week)));
    TermPicture {
        caption: format!(
            "Share of a cohort that remains after each week, at last week's churn: {}.",
            percent(churn, 1)
        ),
        drawing: line_drawing(vec![("", (0..=COHORT_WEEKS).map(left).collect())], TermXAxis::Weeks),
    }
}

/// Draws how much of a reputation change reaches another group, depending on the influence of the first group on the
/// other.
fn spillover(numbers: &ParameterNumbers) -> TermPicture {
    let value = |key| numbers.value(key);
    let both = value("reputation.cross_group_spillover_factor").zip(value("reputation.cross_delta_min_abs"));
    let Some((factor, least)) = both else {
        return TermPicture { caption: String::new(), drawing: None };
    };
    let reaching = |influence: f64| {
        let transferred = EXAMPLE_REPUTATION_CHANGE * influence * factor;
        (influence, if transferred < least { 0.0 } else { transferred })
    };
    let points = (0..=100).map(|step| reaching(f64::from(step) / 100.0)).collect();
    TermPicture {
        caption: format!(
            "How much of a reputation change of {EXAMPLE_REPUTATION_CHANGE} reaches a group, by influence from 0 to 1."
        ),
        drawing: line_drawing(vec![("", points)], TermXAxis::Share),
    }
}

/// Draws the base quality and the added quality. Does not draw the share that competitors have copied, because it is
/// hidden.
fn quality_bank(seen: &VisibleFigures<'_>) -> TermPicture {
    let (base, shared) = seen.quality_base;
    let name_and_bonus = |delivered_quality: &DeliveredQuality| {
        (format!("added for {}", delivered_quality.group), delivered_quality.group_bonus)
    };
    let groups = seen.quality.iter().map(name_and_bonus).filter(|bonus| bonus.1 > 0.0);
    let first = [("base quality".to_owned(), base), ("added for all groups".to_owned(), shared)];
    TermPicture {
        caption: "Base quality and added quality. The share that competitors have copied is never shown."
            .to_owned(),
        drawing: Some(TermDrawing::Bars(first.into_iter().chain(groups).collect())),
    }
}

/// Draws the leads of all groups by week, separately for word of mouth and channels.
fn word_of_mouth(weeks: &[ByGroup<GroupWeek>]) -> TermPicture {
    if weeks.is_empty() {
        return TermPicture {
            caption: "No week has run yet, so there are no leads.".to_owned(),
            drawing: None,
        };
    }
    let by_week = |of: fn(&GroupWeek) -> u32| {
        let sum =
            |week: &ByGroup<GroupWeek>| Group::all().map(|group| f64::from(of(&week[group]))).sum::<f64>();
        weeks.iter().enumerate().map(|(at, week)| (at as f64 + 1.0, sum(week))).collect::<Vec<(f64, f64)>>()
    };
    TermPicture {
        caption: "Leads of all groups by week: by word of mouth, and through channels.".to_owned(),
        drawing: line_drawing(
            vec![
                ("paid", by_week(GroupWeek::paid_leads)),
                ("word of mouth", by_week(|week| week.word_of_mouth)),
            ],
            TermXAxis::Weeks,
        ),
    }
}

impl TermPicture {
    /// Returns the picture as lines of text.
    pub fn to_text(&self) -> String {
        let drawn = self.drawing.as_ref().map_or(String::new(), |drawing| match drawing {
            TermDrawing::Lines(term_lines) => term_lines.to_text(),
            TermDrawing::Bars(bars) => bars_to_text(bars),
        });
        format!("{}\n{drawn}", self.caption)
    }
}

impl TermLines {
    fn to_text(&self) -> String {
        let ends = |of: fn(&(f64, f64, f64)) -> f64| self.band.iter().map(|end| (end.0, of(end))).collect();
        let edges: [Vec<(f64, f64)>; 2] = [ends(|end| end.1), ends(|end| end.2)];
        let sign = |name: &str| name.chars().next().unwrap_or('*');
        let mut drawn: Vec<PlotSeries<'_>> =
            edges.iter().map(|points| PlotSeries { mark: ':', points, is_line: true }).collect();
        drawn.extend(self.lines.iter().map(|(name, points)| PlotSeries {
            mark: sign(name),
            points,
            is_line: true,
        }));
        let plans: Vec<[(f64, f64); 1]> = self.plans.iter().map(|(_, x, y)| [(*x, *y)]).collect();
        let letter = |plan: Plan| plan.id().chars().next().unwrap_or('?');
        drawn.extend(self.plans.iter().zip(&plans).map(|((plan, ..), points)| PlotSeries {
            mark: letter(*plan),
            points,
            is_line: false,
        }));
        let named = self.lines.iter().filter(|(name, _)| !name.is_empty());
        let legend: Vec<String> = named.map(|(name, _)| format!("{} {name}", sign(name))).collect();
        let legend = if legend.is_empty() { String::new() } else { format!("  {}\n", legend.join(" · ")) };
        plot_report(&drawn) + &legend
    }
}

fn bars_to_text(bars: &[(String, f64)]) -> String {
    let most = bars.iter().map(|bar| bar.1).fold(0.0, f64::max);
    let width = bars.iter().map(|bar| bar.0.chars().count()).max().unwrap_or(0);
    let line = |(name, value): &(String, f64)| {
        let cells = if most > 0.0 { (value.max(0.0) / most * MAX_BAR_WIDTH).round() as usize } else { 0 };
        format!("{name:<width$}  {:>7}  {}", compact_number(*value), "#".repeat(cells)).trim_end().to_owned()
            + "\n"
    };
    bars.iter().map(line).collect()
}

/// Returns the picture of a glossary term with the figures of a run, or `None` if the term has no picture.
pub fn term_picture_for_session(term: &str, session: &Session) -> Option<TermPicture> {
    if !has_picture(term) {
        return None;
    }
    let (fits, quality, numbers) = (fits(session), session.company().delivered_quality(), session.numbers());
    let seen = VisibleFigures {
        weeks: session.weeks(),
        group_weeks: session.company().group_weeks(),
        fits: &fits,
        quality: &quality,
        quality_base: session.company().base_quality(),
        numbers: &numbers,
    };
    term_picture(term, &seen)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit;

    fn picture(term: &str, weeks: usize) -> TermPicture {
        assert!(has_picture(term));
        term_picture_for_session(term, &test_kit::play_weeks(weeks))
            .unwrap_or_else(|| panic!("{term} has no picture"))
    }

    #[test]
    fn every_picture_exists_or_explains_its_absence() {
        for term in ["participation-curve", "required-quality", "fit", "spill-over", "quality-bank"] {
            let term_picture = picture(term, 0);
            assert!(
                term_picture.drawing.is_some() && term_picture.to_text().lines().count() > 2,
                "{term}: {term_picture:?}"
            );
        }
        for term in ["cohort", "network-source"] {
            let term_picture = picture(term, 0);
            assert!(
                term_picture.drawing.is_none() && term_picture.caption.contains("has run"),
                "{term}: {term_picture:?}"
            );
            assert!(picture(term, 4).drawing.is_some(), "{term}");
        }
        assert!(!has_picture("cash"));
    }

    #[test]
    fn term_pictures_show_the_run_figures() {
        let session = test_kit::play_weeks(3);
        let Some(TermDrawing::Lines(leads)) = picture("network-source", 3).drawing else {
            panic!("no lines")
        };
        let week = &session.company().group_weeks()[2];
        let all: u32 = Group::all().map(|group| week[group].leads).sum();
        let drawn: f64 = leads.lines.iter().map(|(_, points)| points[2].1).sum();
        assert_eq!((leads.lines[0].1.len(), drawn), (3, f64::from(all)));
        let Some(TermDrawing::Bars(bars)) = picture("quality-bank", 3).drawing else { panic!("no bars") };
        assert_eq!((bars[0].1, bars[1].1), session.company().base_quality());
        let Some(TermDrawing::Lines(fit)) = picture("fit", 3).drawing else { panic!("no lines") };
        assert_eq!(fit.plans.len(), 3);
        let text = picture("fit", 3).to_text();
        assert!(["A", "B", "C", ":"].iter().all(|sign| text.contains(sign)), "{text}");
    }

    #[test]
    fn spillover_picture_shows_no_spillover_if_influence_is_small() {
        let Some(TermDrawing::Lines(term_lines)) = picture("spill-over", 0).drawing else {
            panic!("no lines")
        };
        let points = &term_lines.lines[0].1;
        let numbers = ParameterNumbers::bundled();
        let value = |key: &str| numbers.value(key).expect("a number");
        let least = value("reputation.cross_delta_min_abs");
        assert!(points.iter().all(|(_, transferred)| *transferred == 0.0 || *transferred >= least));
        let most = EXAMPLE_REPUTATION_CHANGE * value("reputation.cross_group_spillover_factor");
        assert!((points[100].1 - most).abs() < 1e-12);
    }
}
