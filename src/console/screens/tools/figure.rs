//! The figure that is selected on the Tools screen: a tool, or a value of its form with a query for the history of that
//! value.

use std::sync::LazyLock;

use super::form::ToolForm;
use crate::context::Figure;
use novamind_tools::{ArgumentKind, CATALOGUE, MapKey, ToolSpec, ToolId};

/// Names of all arguments, prefixed with their tools, for example `set_prices.A`.
static ARGUMENT_TERMS: LazyLock<Vec<String>> = LazyLock::new(|| {
    let of =
        |spec: &'static ToolSpec| spec.arguments.iter().map(move |argument| format!("{}.{}", spec.name(), argument.name));
    CATALOGUE.iter().flat_map(|tool| of(tool.spec())).collect()
});

fn argument_term(tool: ToolId, argument: &str) -> Option<&'static str> {
    ARGUMENT_TERMS
        .iter()
        .map(String::as_str)
        .find(|name| name.split_once('.').is_some_and(|(text, rest)| text == tool.name() && rest == argument))
}

pub(super) fn tool_figure(spec: &'static ToolSpec) -> Figure {
    Figure { title: spec.summary.to_owned(), term: spec.name(), sql: None, week_quantity: None }
}

pub(super) fn cell_figure(form: &ToolForm) -> Option<Figure> {
    let block = form.sheet.blocks.get(form.focus.block)?;
    form.sheet.cell(form.focus)?;
    let tool = form.spec.id;
    Some(Figure {
        title: format!("{tool} {}", block.path(form.focus.row, form.focus.column).replace('.', " ")),
        term: argument_term(tool, block.argument.name)?,
        sql: value_history(form),
        week_quantity: None,
    })
}

/// Returns the query for the history of the focused value, or for its effect.
fn value_history(form: &ToolForm) -> Option<String> {
    let block = form.sheet.blocks.get(form.focus.block)?;
    let name = block.argument.name;
    let column = match form.spec.id {
        ToolId::SetPrices => format!("price_{name}"),
        ToolId::SetModelTiers => format!("tier_{name}"),
        ToolId::SetUsageQuotas => format!("quota_{name}"),
        ToolId::SetDailySpend if matches!(name, "operations" | "development") => format!("spend_{name}"),
        ToolId::SetCapacityTier => "capacity_tier".to_owned(),
        _ => return override_history(form),
    };
    Some(format!("SELECT day, \"{column}\" FROM config_history ORDER BY day"))
}

fn override_history(form: &ToolForm) -> Option<String> {
    if let Some((channel, group)) = form.cell_names() {
        return Some(format!(
            "SELECT day, spend, leads_generated FROM ad_channel_leads\n\
             WHERE channel_id = '{channel}' AND group_id = '{group}' ORDER BY day"
        ));
    }
    let block = form.sheet.blocks.get(form.focus.block)?;
    let kept = matches!(block.argument.kind, ArgumentKind::Map(..) | ArgumentKind::Matrix(..));
    let customers = matches!(block.argument.kind, ArgumentKind::Map(MapKey::Customer, _));
    (kept && !customers).then(|| {
        format!("SELECT * FROM config_overrides WHERE tool_name = '{}' ORDER BY id", form.spec.name())
    })
}
