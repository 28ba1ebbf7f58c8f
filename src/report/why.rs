//! Text and figures for the causes of a change.

use super::chapters::change_in_words;
use super::words::{count, number, points, short_week_in_words, whole};
use novamind_base::notation::{grouped, percent};
use novamind_insight::{Detail, InputDetail, Why};
use novamind_record::figures::FigureUnit;

/// Name of the part that no cause explains.
pub const REST: &str = "residual";

/// A cause with its contribution, or the residual.
#[derive(Debug, Clone, PartialEq)]
pub struct CauseLine {
    /// Name of the cause.
    pub name: &'static str,
    /// Contribution to the change.
    pub amount: f64,
    /// Contribution with its sign, formatted.
    pub written: String,
    /// Inputs that differ, old → new.
    pub details: Vec<String>,
}

/// Returns all causes, largest first, and the residual.
pub fn lines(why: &Why) -> Vec<CauseLine> {
    let line = |name, amount, details| {
        let written = signed(why.quantity.unit(), amount);
        CauseLine { name, amount, written, details }
    };
    let part = |part: &novamind_insight::WhyPart| {
        line(part.cause.name(), part.amount, part.details.iter().map(in_words).collect())
    };
    why.parts.iter().map(part).chain([line(REST, why.rest, Vec::new())]).collect()
}

/// Writes the change and its causes: `cancellations +942 = price +938 · competitors +4 · residual 0`.
pub fn equation(why: &Why) -> String {
    let parts: Vec<String> =
        lines(why).iter().map(|line| format!("{} {}", line.name, line.written)).collect();
    format!("{} {} = {}", why.quantity.name(), signed(why.quantity.unit(), why.change()), parts.join(" · "))
}

/// Writes the figure in both weeks, and their lengths if they differ: `week 20: 195 → 1,137`.
pub fn heading(why: &Why) -> String {
    let value = |value| written(why.quantity.unit(), value);
    let [before, own] = why.days;
    let short = short_week_in_words(own, before).map_or(String::new(), |short| format!(" ({short})"));
    format!("{}, week {}: {} → {}{short}", why.quantity.name(), why.week, value(why.before), value(why.after))
}

/// Formats a value in a unit.
pub fn written(unit: FigureUnit, value: f64) -> String {
    match unit {
        FigureUnit::Dollars => novamind_base::notation::dollars(value + 0.0),
        FigureUnit::Count => whole(value),
        FigureUnit::Share => percent(value, 1),
        FigureUnit::FineShare => percent(value, 2),
        FigureUnit::Level => grouped(value, 3),
    }
}

/// Formats a change with its sign; shares in percentage points.
pub fn signed(unit: FigureUnit, change: f64) -> String {
    let size = change.abs();
    let text = match unit {
        FigureUnit::Dollars => format!("${}", grouped(size, 0)),
        FigureUnit::Count if size < 100.0 && (size - size.round()).abs() > 0.05 => grouped(size, 1),
        FigureUnit::Count => grouped(size, 0),
        FigureUnit::Share => points(size, 1),
        FigureUnit::FineShare => points(size, 2),
        FigureUnit::Level => grouped(size, 3),
    };
    let is_nothing = !text.contains(|digit: char| ('1'..='9').contains(&digit));
    match change {
        _ if is_nothing => "0".to_owned(),
        change if change > 0.0 => format!("+{text}"),
        _ => format!("-{text}"),
    }
}

fn in_words(detail: &Detail) -> String {
    match detail {
        Detail::Setting(change) => change_in_words(change),
        Detail::Happened(times, noun) => count(*times as u32, noun),
        Detail::Input(InputDetail { name, old, new, is_share }) => {
            let value = |value: f64| if *is_share { percent(value, 1) } else { number(value) };
            format!("{name}: {} → {}", value(*old), value(*new))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_insight::{Cause, WeekQuantity, WhyPart};
    use novamind_record::figures::WeekFigure;
    use novamind_tools::ToolId;

    fn why(figure: WeekFigure, before: f64, after: f64, amounts: &[(Cause, f64)]) -> Why {
        let part =
            |(cause, amount): &(Cause, f64)| WhyPart { cause: *cause, amount: *amount, details: Vec::new() };
        let parts: Vec<WhyPart> = amounts.iter().map(part).collect();
        let quantity = WeekQuantity::of_company(figure).expect("a figure of the company");
        let rest = after - before - parts.iter().map(|part| part.amount).sum::<f64>();
        Why { week: 20, quantity, days: [7, 7], before, after, parts, rest, simulations: 4 }
    }

    #[test]
    fn an_equation_names_every_cause_with_its_sign_and_the_rest() {
        let price = Cause::Calls(ToolId::SetPrices);
        let told = why(WeekFigure::Cancellations, 195.0, 1137.0, &[(price, 938.0), (Cause::Rivals, 3.5)]);
        let equation_told = equation(&told);
        assert_eq!(equation_told, "cancellations +942 = price +938 · rivals +3.5 · residual +0.5");
        assert_eq!(heading(&told), "cancellations, week 20: 195 → 1,137");
        let short = Why { days: [7, 3], ..told };
        assert_eq!(heading(&short), "cancellations, week 20: 195 → 1,137 (of 3 days, the week before of 7)");
        let told = why(WeekFigure::Conversion, 0.2, 0.19, &[(price, -0.01), (Cause::Service, 0.0)]);
        assert_eq!(equation(&told), "conversion -1.00 pt = price -1.00 pt · load and outages 0 · residual 0");
        let told = why(WeekFigure::CashChange, 100.0, -4_900.4, &[(Cause::Market, -5_000.0)]);
        assert_eq!(equation(&told), "cash change -$5,000 = market -$5,000 · residual 0");
    }

    #[test]
    fn details_say_what_was_and_what_is() {
        let input = |name, old, new, is_share| Detail::Input(InputDetail { name, old, new, is_share });
        let told = [
            (Detail::Happened(2, "move"), "2 moves"),
            (Detail::Happened(1, "call"), "1 call"),
            (input("peak overload", 0.0, 0.131, true), "peak overload: 0.0% → 13.1%"),
            (input("index", 49.0, 50.25, false), "index: 49 → 50.25"),
        ];
        for (detail, words) in told {
            assert_eq!(in_words(&detail), words);
        }
    }
}
