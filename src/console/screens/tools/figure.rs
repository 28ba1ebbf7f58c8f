//! The selected tool, or the selected value of its form with a query for its history.

use std::sync::LazyLock;

use super::form::Form;
use crate::context::Figure;
use novamind_tools::{ArgumentKind, CATALOGUE, Key, Spec, ToolId};

/// Names of all arguments with their tools: `set_prices.A`.
static ARGUMENTS: LazyLock<Vec<String>> = LazyLock::new(|| {
    let of =
        |spec: &'static Spec| spec.arguments.iter().map(move |own| format!("{}.{}", spec.name(), own.name));
    CATALOGUE.iter().flat_map(|tool| of(tool.spec())).collect()
});

fn term_of(tool: ToolId, argument: &str) -> Option<&'static str> {
    ARGUMENTS
        .iter()
        .map(String::as_str)
        .find(|name| name.split_once('.').is_some_and(|(own, rest)| own == tool.name() && rest == argument))
}

pub(super) fn of_tool(spec: &'static Spec) -> Figure {
    Figure { title: spec.summary.to_owned(), term: spec.name(), sql: None, why: None }
}

pub(super) fn of_cell(form: &Form) -> Option<Figure> {
    let block = form.sheet.blocks.get(form.at.block)?;
    form.sheet.slot(form.at)?;
    let tool = form.spec.id;
    Some(Figure {
        title: format!("{tool} {}", block.path(form.at.row, form.at.column).replace('.', " ")),
        term: term_of(tool, block.argument.name)?,
        sql: history(form),
        why: None,
    })
}

/// Returns the query for the value over time, or for its effect.
fn history(form: &Form) -> Option<String> {
    let block = form.sheet.blocks.get(form.at.block)?;
    let name = block.argument.name;
    let column = match form.spec.id {
        ToolId::SetPrices => format!("price_{name}"),
        ToolId::SetModelTiers => format!("tier_{name}"),
        ToolId::SetUsageQuotas => format!("quota_{name}"),
        ToolId::SetDailySpend if matches!(name, "operations" | "development") => format!("spend_{name}"),
        ToolId::SetCapacityTier => "capacity_tier".to_owned(),
        _ => return of_overrides(form),
    };
    Some(format!("SELECT day, \"{column}\" FROM config_history ORDER BY day"))
}

fn of_overrides(form: &Form) -> Option<String> {
    if let Some((channel, group)) = form.cell_names() {
        return Some(format!(
            "SELECT day, spend, leads_generated FROM ad_channel_leads\n\
             WHERE channel_id = '{channel}' AND group_id = '{group}' ORDER BY day"
        ));
    }
    let block = form.sheet.blocks.get(form.at.block)?;
    let kept = matches!(block.argument.kind, ArgumentKind::Map(..) | ArgumentKind::Matrix(..));
    let customers = matches!(block.argument.kind, ArgumentKind::Map(Key::Customer, _));
    (kept && !customers).then(|| {
        format!("SELECT * FROM config_overrides WHERE tool_name = '{}' ORDER BY id", form.spec.name())
    })
}
