//! Texts and tables for what-if comparisons.

use serde_json::Value;

use super::decision_words::{decision_name, describe_value_changes, describe_values};
use super::formatting::{describe_first_change, pluralize};
use super::why::{format_figure, format_signed_change};
use novamind_base::formatting::{compact_number, escape_control_characters, short_dollars};
use novamind_base::statistics::Interval;
use novamind_insight::{
    BranchComparison, BranchFigure, BranchFigures, CallDifference, DecisionEdit, Futures,
    ParameterDifference, RelatedRun,
};
use novamind_record::figures::FigureUnit;
use novamind_session::EnterpriseNames;
use novamind_tools::{ToolId, ToolKind, find};

// Name of the branch without edits. Its simulation can continue beyond the end of the record, with unchanged settings.
const UNCHANGED_BRANCH_NAME: &str = "your decisions unchanged";

/// Returns the name of a branch: a list of its edits.
pub fn branch_name(edits: &[DecisionEdit]) -> String {
    match edits {
        [] => UNCHANGED_BRANCH_NAME.to_owned(),
        edits => edits.iter().map(DecisionEdit::to_string).collect::<Vec<_>>().join("; "),
    }
}

/// How texts name decisions.
#[derive(Clone, Copy)]
pub enum DecisionNotation<'a> {
    /// As tool calls with line numbers, like the edits of plain mode.
    Calls,
    /// In words, as names and values.
    Words(&'a EnterpriseNames),
}

impl DecisionNotation<'_> {
    fn name(self, tool: ToolId) -> &'static str {
        match self {
            DecisionNotation::Calls => tool.name(),
            DecisionNotation::Words(_) => decision_name(tool),
        }
    }

    fn call(self, tool: ToolId, args: &Value) -> String {
        match self {
            DecisionNotation::Calls => format!("{} {args}", tool.name()),
            DecisionNotation::Words(names) => {
                format!("{} {}", decision_name(tool), describe_values(tool, args, names))
                    .trim_end()
                    .to_owned()
            }
        }
    }

    fn changed_call(self, tool: ToolId, recorded: &Value, edited: &Value) -> String {
        match (self, recorded.as_object()) {
            (DecisionNotation::Words(names), Some(before)) if tool.spec().kind == ToolKind::Setting => {
                format!("{} {}", decision_name(tool), describe_value_changes(tool, before, edited, names))
            }
            (DecisionNotation::Words(names), _) => {
                format!("{} → {}", self.call(tool, recorded), describe_values(tool, edited, names))
            }
            (DecisionNotation::Calls, _) => format!("{} → {edited}", self.call(tool, recorded)),
        }
    }

    fn line(self, line: u64) -> String {
        match self {
            DecisionNotation::Calls => format!(" (line {line})"),
            DecisionNotation::Words(_) => String::new(),
        }
    }
}

/// Describes the compared period.
pub fn period(comparison: &BranchComparison, days_per_week: u32) -> String {
    let BranchComparison { from, until, .. } = comparison;
    let (first, last) = (from / days_per_week + 1, until.div_ceil(days_per_week));
    format!("re-simulation of weeks {first} to {last} (days {} to {until}), same random draws", from + 1)
}

/// Describes the compared period, and which of its weeks were not played.
pub fn heading(comparison: &BranchComparison, days_per_week: u32) -> String {
    let note =
        unplayed_weeks_line(comparison, days_per_week).map_or(String::new(), |line| format!("; {line}"));
    format!("{}{note}", period(comparison, days_per_week))
}

/// Describes the simulated weeks that the run has not completed. Returns `None` if there are none.
pub fn unplayed_weeks_line(comparison: &BranchComparison, days_per_week: u32) -> Option<String> {
    let weeks = unplayed_weeks(comparison, days_per_week)?;
    Some(format!("{weeks}: no further decisions, settings unchanged"))
}

/// Names the simulated weeks that the run has not completed: `weeks 6 to 12 are not played yet`.
fn unplayed_weeks(comparison: &BranchComparison, days_per_week: u32) -> Option<String> {
    let BranchComparison { from, until, recorded_until, .. } = comparison;
    let (first, last) = (recorded_until.max(from) / days_per_week + 1, until.div_ceil(days_per_week));
    (recorded_until < until).then(|| match first == last {
        true => format!("week {last} is not played yet"),
        false => format!("weeks {first} to {last} are not played yet"),
    })
}

/// Describes a branch: its number, its name, and the first day on which it differs from the unchanged run. For the
/// unchanged run, names the weeks that were not played instead of a day.
pub fn branch_line(comparison: &BranchComparison, number: usize, name: &str, days_per_week: u32) -> String {
    let Some(branch) = comparison.branches.get(number) else { return String::new() };
    let since = match (branch.first_different_day, branch.edits.is_empty()) {
        (_, true) => {
            unplayed_weeks(comparison, days_per_week).map_or(String::new(), |weeks| format!("; {weeks}"))
        }
        (Some(day), _) => format!(" · differs from day {day}"),
        (None, _) => " · identical on every day".to_owned(),
    };
    format!("{number}  {name}{since}")
}

/// Lists the changed decisions of a branch, the decisions that are now rejected, and the rejected decisions that would
/// now be accepted.
pub fn describe_decisions(
    branch: &BranchFigures,
    days_per_week: u32,
    notation: DecisionNotation<'_>,
) -> Vec<String> {
    let week = |day: u32| day / days_per_week + 1;
    let differing = group_equal_differences(&branch.call_differences)
        .into_iter()
        .map(|calls| describe_call_differences(&calls, week, notation));
    let parameters = branch.parameter_differences.iter().map(|parameter_difference| {
        describe_parameter_difference(parameter_difference, week(parameter_difference.day))
    });
    let refused = branch.rejected.iter().map(|decision| {
        let name = find(&decision.name).map_or(decision.name.as_str(), |tool| notation.name(tool.spec().id));
        let verb = match notation {
            DecisionNotation::Calls => "is rejected",
            DecisionNotation::Words(_) => "rejected",
        };
        format!("week {}: {name} {verb}: {}", week(decision.day), decision.rejection.message)
    });
    let possible = branch.newly_accepted.iter().map(|(line, day, tool)| {
        let line_text = match notation {
            DecisionNotation::Calls => format!(" of line {line}"),
            DecisionNotation::Words(_) => String::new(),
        };
        format!(
            "week {}: {}{line_text} was rejected and would now be accepted; it is skipped",
            week(*day),
            notation.name(*tool)
        )
    });
    parameters
        .chain(differing)
        .chain(refused)
        .chain(possible)
        .map(|line| escape_control_characters(&line).into_owned())
        .collect()
}

fn describe_parameter_difference(parameter_difference: &ParameterDifference, week: u32) -> String {
    let ParameterDifference { key, recorded: was, edited: is, .. } = parameter_difference;
    match (was, is) {
        (_, Some(is)) => format!("week {week}: {key} is set to {is}"),
        (Some(was), None) => format!("week {week}: {key} is not set to {was}"),
        (None, None) => format!("week {week}: {key}"),
    }
}

fn group_equal_differences(differences: &[CallDifference]) -> Vec<Vec<&CallDifference>> {
    let mut all: Vec<Vec<&CallDifference>> = Vec::new();
    for call in differences {
        let same = |call_differences: &&mut Vec<&CallDifference>| {
            (call_differences[0].tool, &call_differences[0].recorded, &call_differences[0].edited)
                == (call.tool, &call.recorded, &call.edited)
        };
        match all.iter_mut().find(same) {
            Some(call_differences) => call_differences.push(call),
            None => all.push(vec![call]),
        }
    }
    all
}

/// Describes calls that all differ from the recorded calls by the same change: `weeks 20 to 72: set_prices {…} → {…}
/// (53 calls)`.
fn describe_call_differences(
    calls: &[&CallDifference],
    week: impl Fn(u32) -> u32,
    notation: DecisionNotation<'_>,
) -> String {
    let [first, .., last] = calls else {
        return calls.first().map_or(String::new(), |only| {
            let line = only.seq.map_or(String::new(), |line| notation.line(line));
            let again = only.next_recorded.map_or(String::new(), |(day, line)| {
                let (name, line) = (notation.name(only.tool), notation.line(line));
                let verb = match notation {
                    DecisionNotation::Calls => "the run calls",
                    DecisionNotation::Words(_) => "your run changes",
                };
                format!("; {verb} {name} again in week {}{line}", week(day))
            });
            format!("week {}: {}{line}{again}", week(only.day), describe_call_difference(only, notation))
        });
    };
    let (from, to) = (week(first.day), week(last.day));
    let weeks = if from == to { format!("week {from}") } else { format!("weeks {from} to {to}") };
    let count = pluralize(calls.len() as u32, "call");
    format!("{weeks}: {} ({count})", describe_call_difference(first, notation))
}

fn describe_call_difference(call: &CallDifference, notation: DecisionNotation<'_>) -> String {
    match (&call.recorded, &call.edited) {
        (Some(was), Some(is)) => notation.changed_call(call.tool, was, is),
        (Some(was), None) => format!("{} skipped", notation.call(call.tool, was)),
        (None, Some(is)) => format!("{} added", notation.call(call.tool, is)),
        (None, None) => notation.name(call.tool).to_owned(),
    }
}

/// Returns the label of the week whose final figures are shown. Marks the week if the record ends before the end of the
/// week.
pub fn milestone_label(comparison: &BranchComparison, day: u32, days_per_week: u32) -> String {
    let mark = if day > comparison.recorded_until { " not played" } else { "" };
    format!("{}{mark}", day.div_ceil(days_per_week))
}

/// Returns the headers and rows of the comparison. Each row has one figure at one milestone, with one column per
/// branch. Cells show the difference from the unchanged run.
pub fn comparison_table(
    comparison: &BranchComparison,
    days_per_week: u32,
) -> (Vec<String>, Vec<Vec<String>>) {
    let cell = |at: usize, figure, day| comparison_cell(comparison, &comparison.branches[at], figure, day);
    build_table(comparison, days_per_week, cell)
}

fn build_table(
    comparison: &BranchComparison,
    days_per_week: u32,
    cell: impl Fn(usize, BranchFigure, u32) -> String,
) -> (Vec<String>, Vec<Vec<String>>) {
    let numbers = || 0..comparison.branches.len();
    let headers =
        ["after week", "figure"].map(str::to_owned).into_iter().chain(numbers().map(|at| at.to_string()));
    let mut rows = Vec::new();
    for day in comparison.milestone_days(days_per_week) {
        for (at, figure) in comparison.figures.iter().enumerate() {
            let first = if at == 0 { milestone_label(comparison, day, days_per_week) } else { String::new() };
            let cells = numbers().map(|branch| cell(branch, *figure, day));
            rows.push([first, figure.name().to_owned()].into_iter().chain(cells).collect());
        }
    }
    (headers.collect(), rows)
}

/// Formats a figure of a branch and its difference from the unchanged run.
pub fn comparison_cell(
    comparison: &BranchComparison,
    branch: &BranchFigures,
    figure: BranchFigure,
    day: u32,
) -> String {
    let [value, more] = comparison_cell_lines(comparison, branch, figure, day);
    if more.is_empty() { value } else { format!("{value} {more}") }
}

/// Formats a cell of the comparison as two short lines: the figure, and the difference in brackets.
pub fn comparison_cell_lines(
    comparison: &BranchComparison,
    branch: &BranchFigures,
    figure: BranchFigure,
    day: u32,
) -> [String; 2] {
    let alone = |text: &str| [text.to_owned(), String::new()];
    let Some(value) = branch.value(figure, day) else {
        let last = branch.last_day().map_or(String::new(), |day| format!("(day {day})"));
        return ["ended".to_owned(), last];
    };
    if value.is_nan() {
        return alone("—");
    }
    let base = comparison.branches.first().filter(|_| !branch.edits.is_empty());
    let base = base.and_then(|base| base.value(figure, day)).filter(|base| !base.is_nan());
    let more =
        base.map_or(String::new(), |base| format!("({})", format_signed_change(figure.unit(), value - base)));
    [format_figure(figure.unit(), value), more]
}

/// Describes how many futures were simulated, and after which day their random draws differ from those of the run.
pub fn futures_heading(futures: &Futures) -> String {
    format!(
        "{} with new random draws after day {}; median, and in brackets the 10th to 90th percentile",
        pluralize(futures.count, "future"),
        futures.redrawn_after
    )
}

/// Describes how many futures of a branch end in bankruptcy, and how these futures are counted. Returns `None` if no
/// future does.
pub fn describe_bankruptcies(futures: &Futures, branch: usize) -> Option<String> {
    let ended = futures.bankruptcy_count(branch);
    (ended > 0).then(|| {
        format!(
            "{branch}: {ended} of {} end in bankruptcy; after a bankruptcy, cash is constant and there are no subscribers",
            pluralize(futures.count, "future")
        )
    })
}

/// Returns the headers and rows of the futures. Each row has one figure at one milestone, with one column per branch.
pub fn futures_table(
    comparison: &BranchComparison,
    futures: &Futures,
    days_per_week: u32,
) -> (Vec<String>, Vec<Vec<String>>) {
    build_table(comparison, days_per_week, |at, figure, day| futures_cell(futures, at, figure, day))
}

/// Formats the median, 10th and 90th percentile of a figure over the futures.
pub fn futures_cell(futures: &Futures, branch: usize, figure: BranchFigure, day: u32) -> String {
    let Some(band) = futures.interval(branch, figure, day) else { return "—".to_owned() };
    let value = |value| format_figure(figure.unit(), value);
    format!("{} ({} to {})", value(band.median), value(band.low), value(band.high))
}

/// Formats a cell of the futures as two short lines: the median, and the 10th and 90th percentile.
pub fn futures_cell_lines(futures: &Futures, branch: usize, figure: BranchFigure, day: u32) -> [String; 2] {
    let Some(band) = futures.interval(branch, figure, day) else { return ["—".to_owned(), String::new()] };
    let short = |value: f64| match figure.unit() {
        FigureUnit::Dollars => short_dollars(value),
        FigureUnit::Count => compact_number(value),
        unit => format_figure(unit, value),
    };
    [format_figure(figure.unit(), band.median), format!("{}–{}", short(band.low), short(band.high))]
}

/// Describes the mean difference between a branch and the unchanged run in a figure on the last day, with its interval.
/// Returns `None` if no future has a value.
pub fn difference_line(
    comparison: &BranchComparison,
    futures: &Futures,
    branch: usize,
    figure: BranchFigure,
) -> Option<String> {
    let difference = futures.difference(branch, figure, comparison.until)?;
    let signed = |value| format_signed_change(figure.unit(), value);
    let interval = difference.interval.map_or(String::new(), |Interval { low, high }| {
        format!(" (95 % interval {} to {})", signed(low), signed(high))
    });
    Some(format!(
        "{}: {} on average{interval}, more in {} of {}",
        figure.name(),
        signed(difference.mean),
        difference.first_greater,
        pluralize(difference.pair_count, "future")
    ))
}

/// Describes a run in the tree of related runs.
pub fn related_run_line(related_run: &RelatedRun, text: &str) -> String {
    let run = &related_run.run;
    let mark = if run.id == text { " (this run)" } else { "" };
    let left =
        related_run.branched_in_week.map_or(String::new(), |week| format!(" · branched in week {week}"));
    let change = match (&related_run.first_change, related_run.branched_in_week) {
        (Some(change), Some(_)) => format!(", first change {}", describe_first_change(change)),
        (None, Some(_)) => ", same decisions as its parent".to_owned(),
        _ => String::new(),
    };
    let end = run.ended.map_or(String::new(), |ended| format!(", {}", ended.id()));
    format!(
        "{}{}{mark}{left}{change} · day {} of {}, cash {}{end}",
        "  ".repeat(related_run.depth),
        run.id,
        run.day,
        run.days,
        novamind_base::formatting::dollars(run.cash)
    )
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use novamind_world::params::Params;

    #[test]
    fn milestone_label_marks_weeks_after_the_record() {
        let comparison = BranchComparison {
            from: 21,
            until: 49,
            recorded_until: 35,
            branches: Vec::new(),
            figures: Vec::new(),
        };
        let label = |day| milestone_label(&comparison, day, 7);
        assert_eq!([28, 35, 42, 49].map(label), ["4", "5", "6 not played", "7 not played"]);
        assert_eq!(
            heading(&comparison, 7),
            "re-simulation of weeks 4 to 7 (days 22 to 49), same random draws; weeks 6 to 7 are not played yet: no \
             further decisions, settings unchanged"
        );
        assert_eq!(branch_name(&[]), "your decisions unchanged");
    }

    #[test]
    fn describe_decisions_combines_equal_call_differences() {
        let call = |day, seq, was: Option<f64>, is: Option<f64>| CallDifference {
            day,
            tool: ToolId::SetPrices,
            seq,
            recorded: was.map(|price| json!({ "B": price })),
            edited: is.map(|price| json!({ "B": price })),
            next_recorded: (day == 7 && seq.is_none()).then_some((14, 20)),
        };
        let differences = [
            call(7, None, None, Some(9.5)),
            call(7, Some(12), Some(10.0), Some(9.5)),
            call(14, Some(20), Some(30.0), None),
            call(21, Some(31), Some(10.0), Some(9.5)),
        ];
        let texts: Vec<String> = group_equal_differences(&differences)
            .iter()
            .map(|calls| describe_call_differences(calls, |day| day / 7 + 1, DecisionNotation::Calls))
            .collect();
        assert_eq!(
            texts,
            [
                "week 2: set_prices {\"B\":9.5} added; the run calls set_prices again in week 3 (line 20)",
                "weeks 2 to 4: set_prices {\"B\":10.0} → {\"B\":9.5} (2 calls)",
                "week 3: set_prices {\"B\":30.0} skipped (line 20)",
            ]
        );
    }
    #[test]
    fn words_contain_no_json_and_no_line_numbers() {
        let names = EnterpriseNames::new(3, &Params::bundled().personas.email);
        let call = |recorded: Option<f64>, edited: Option<f64>| CallDifference {
            day: 7,
            tool: ToolId::SetPrices,
            seq: recorded.map(|_| 12),
            recorded: recorded.map(|price| json!({ "B": price })),
            edited: edited.map(|price| json!({ "B": price })),
            next_recorded: recorded.is_none().then_some((14, 20)),
        };
        let text = |call: CallDifference| {
            describe_call_differences(&[&call], |day| day / 7 + 1, DecisionNotation::Words(&names))
        };
        assert_eq!(text(call(Some(30.0), Some(27.0))), "week 2: price B 30 → 27");
        assert_eq!(text(call(Some(30.0), None)), "week 2: price B 30 skipped");
        assert_eq!(
            text(call(None, Some(27.0))),
            "week 2: price B 27 added; your run changes price again in week 3"
        );
    }

    #[test]
    fn note_names_the_weeks_that_were_not_played() {
        let note = |recorded_until| {
            let (branches, figures) = (Vec::new(), Vec::new());
            let comparison = BranchComparison { from: 0, until: 21, recorded_until, branches, figures };
            unplayed_weeks(&comparison, 7)
        };
        assert_eq!(note(0).as_deref(), Some("weeks 1 to 3 are not played yet"));
        assert_eq!(note(10).as_deref(), Some("weeks 2 to 3 are not played yet"));
        assert_eq!(note(14).as_deref(), Some("week 3 is not played yet"));
        assert_eq!(note(21), None);
    }
}
