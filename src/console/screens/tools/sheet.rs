//! The values of a form, with one block per argument. Each value has a current value and an optional draft.

use std::collections::BTreeMap;

use serde_json::{Map, Value};

use novamind_base::formatting::{json_number, parse_number};
use novamind_session::identifiers::{Channel, Plan};
use novamind_tools::{Argument, ArgumentKind, MapKey, ToolKind, NumberRange, ToolSpec, ToolId};
use novamind_tui::text::format_number;
use novamind_tui::widgets::TextField;
use novamind_worker::company::DisplayedCompany;

const CODE_ARGUMENT: &str = "code";

/// A value of a form that the user can edit.
#[derive(Debug, Clone, PartialEq)]
pub struct EditableCell {
    /// Current value, or `None` if no value is set.
    pub current: Option<f64>,
    /// Typed draft, or `None` while the cell is unchanged.
    pub draft: Option<TextField>,
}

impl EditableCell {
    fn from_current(value: Option<&Value>) -> EditableCell {
        EditableCell { current: value.and_then(Value::as_f64), draft: None }
    }

    pub fn text(&self) -> String {
        match (&self.draft, self.current) {
            (Some(field), _) => field.text().to_owned(),
            (None, Some(value)) => format_plain(value),
            (None, None) => String::new(),
        }
    }

    /// Returns the number to send, or `None` if the cell is empty.
    ///
    /// # Errors
    /// The text is not a number.
    pub fn value(&self) -> Result<Option<f64>, ()> {
        match &self.draft {
            None => Ok(self.current),
            Some(field) if field.text().trim().is_empty() => Ok(None),
            Some(field) => parse_number(field.text()).map(Some).ok_or(()),
        }
    }

    /// Returns whether the draft differs from the current value.
    pub fn is_changed(&self) -> bool {
        self.value().map_or(true, |value| value.unwrap_or(0.0) != self.current.unwrap_or(0.0))
    }
}

fn format_plain(value: f64) -> String {
    format_number(value).replace(',', "")
}

/// The cells of one argument.
#[derive(Debug, Clone)]
pub struct ArgumentBlock {
    pub argument: &'static Argument,
    /// Description of the argument, with the parameters of the scenario inserted.
    pub doc: String,
    /// Names of the rows. A single number has one row with the name of the argument.
    pub rows: Vec<String>,
    /// Names of the columns. A number or a map has one column with an empty name.
    pub columns: Vec<String>,
    pub cells: Vec<Vec<EditableCell>>,
    /// The deals whose prices the rows show, if the block shows the deals of a recorded call.
    deals: Option<DealPrices>,
}

/// A list of deals with the position of each price.
#[derive(Debug, Clone)]
struct DealPrices {
    list: Value,
    /// JSON pointer of the price in each row.
    pointers: Vec<String>,
}

impl ArgumentBlock {
    fn new(argument: &'static Argument, current: Option<&Value>, company: &DisplayedCompany) -> ArgumentBlock {
        let keys = |key: MapKey, given: Option<&Value>| -> Vec<String> {
            match key {
                MapKey::Group => company.observation.known_groups.iter().map(|group| group.id().to_owned()).collect(),
                MapKey::Plan => Plan::ALL.iter().map(|plan| plan.id().to_owned()).collect(),
                MapKey::Channel => Channel::ALL.iter().map(|channel| channel.id().to_owned()).collect(),
                MapKey::Customer => {
                    given.and_then(Value::as_object).map_or(Vec::new(), |map| map.keys().cloned().collect())
                }
            }
        };
        let (rows, columns) = match argument.kind {
            ArgumentKind::Number(_) | ArgumentKind::Integer(_) => {
                (vec![argument.name.to_owned()], vec![String::new()])
            }
            ArgumentKind::Map(key, _) => (keys(key, current), vec![String::new()]),
            ArgumentKind::Matrix(outer, inner, _) => (keys(outer, current), keys(inner, None)),
            ArgumentKind::Text | ArgumentKind::Structure(_) | ArgumentKind::Deals(_) => {
                (vec![argument.name.to_owned()], vec![String::new()])
            }
        };
        let slot = |row: &String, column: &String| match argument.kind {
            ArgumentKind::Map(..) => EditableCell::from_current(current.and_then(|map| map.get(row))),
            ArgumentKind::Matrix(..) => {
                EditableCell::from_current(current.and_then(|map| map.get(row)).and_then(|inner| inner.get(column)))
            }
            _ => EditableCell::from_current(current),
        };
        let slots = rows.iter().map(|row| columns.iter().map(|column| slot(row, column)).collect()).collect();
        let doc = company.numbers.substitute(argument.description);
        ArgumentBlock { argument, doc, rows, columns, cells: slots, deals: None }
    }

    pub fn range(&self) -> NumberRange {
        match self.argument.kind {
            ArgumentKind::Number(range)
            | ArgumentKind::Integer(range)
            | ArgumentKind::Map(_, range)
            | ArgumentKind::Matrix(_, _, range) => range,
            ArgumentKind::Text | ArgumentKind::Structure(_) | ArgumentKind::Deals(_) => NumberRange::AT_LEAST_ZERO,
        }
    }

    pub fn is_scalar(&self) -> bool {
        matches!(self.argument.kind, ArgumentKind::Number(_) | ArgumentKind::Integer(_))
    }

    pub fn is_text(&self) -> bool {
        !self.shows_deal_prices()
            && matches!(self.argument.kind, ArgumentKind::Text | ArgumentKind::Structure(_) | ArgumentKind::Deals(_))
    }

    /// Returns whether the rows are the prices of recorded deals.
    pub fn shows_deal_prices(&self) -> bool {
        self.deals.is_some()
    }

    /// Returns whether the argument is code, such as a script or a SQL statement.
    pub fn is_code(&self) -> bool {
        self.argument.kind == ArgumentKind::Text && self.argument.name == CODE_ARGUMENT
    }

    /// Returns the name of the content for key hints.
    pub fn kind_label(&self) -> &'static str {
        match self.argument.kind {
            _ if self.is_code() => "the code",
            ArgumentKind::Text => "the text",
            ArgumentKind::Structure(_) | ArgumentKind::Deals(_) if self.is_text() => "the list (JSON)",
            _ => "the value",
        }
    }

    /// Returns whether the user can add rows. Rows for customers can be added, because there are too many customers to
    /// list.
    pub fn accepts_new_rows(&self) -> bool {
        matches!(self.argument.kind, ArgumentKind::Map(MapKey::Customer, _))
    }

    pub fn is_changed(&self) -> bool {
        match self.is_text() {
            true => !self.cells[0][0].text().trim().is_empty(),
            false => self.cells.iter().flatten().any(EditableCell::is_changed),
        }
    }

    /// Returns the sum of the new values that can be parsed.
    pub fn total(&self) -> f64 {
        self.cells.iter().flatten().filter_map(|slot| slot.value().ok().flatten()).sum()
    }

    /// Returns the sum of the current values.
    pub fn current_total(&self) -> f64 {
        self.cells.iter().flatten().filter_map(|slot| slot.current).sum()
    }

    /// Returns the path of a cell in the notation of rejections.
    pub fn path(&self, row: usize, column: usize) -> String {
        match self.argument.kind {
            ArgumentKind::Map(..) => format!("{}.{}", self.argument.name, self.rows[row]),
            _ if self.shows_deal_prices() => format!("{}.{}", self.argument.name, self.rows[row]),
            ArgumentKind::Matrix(..) => {
                format!("{}.{}.{}", self.argument.name, self.rows[row], self.columns[column])
            }
            _ => self.argument.name.to_owned(),
        }
    }

    /// Returns the value of a text line, parsed as JSON for lists and objects.
    fn text_value(&self) -> Result<Option<Value>, CellPosition> {
        let text = self.cells[0][0].text();
        match self.argument.kind {
            _ if text.trim().is_empty() => Ok(None),
            ArgumentKind::Text => Ok(Some(text.into())),
            _ => serde_json::from_str(&text).map(Some).map_err(|_| CellPosition::default()),
        }
    }

    /// Returns the error message for invalid input.
    pub fn expected(&self) -> &'static str {
        if self.is_text() { "enter a list or object as JSON" } else { "enter a number" }
    }

    /// Fills in the value that a recorded call specifies. A map replaces all values of the block.
    fn fill_recorded(&mut self, value: &Value) {
        if let Some((rows, deals)) = deal_prices(value).filter(|_| matches!(self.argument.kind, ArgumentKind::Deals(_))) {
            self.doc = "offered price of each plan".to_owned();
            self.cells = rows.iter().map(|(_, price)| vec![EditableCell { current: Some(*price), draft: None }]).collect();
            self.rows = rows.into_iter().map(|(name, _)| name).collect();
            self.deals = Some(deals);
            return;
        }
        let text = match (self.is_text(), value) {
            (true, Value::String(text)) => Some(text.clone()),
            (true, value) => Some(value.to_string()),
            (false, _) => None,
        };
        if let Some(text) = text {
            self.cells[0][0].draft = Some(TextField::with_text(text));
            return;
        }
        for (row, name) in self.rows.iter().enumerate() {
            for (column, key) in self.columns.iter().enumerate() {
                let found = match self.argument.kind {
                    ArgumentKind::Map(..) => value.get(name),
                    ArgumentKind::Matrix(..) => value.get(name).and_then(|inner| inner.get(key)),
                    _ => Some(value),
                };
                let cell = &mut self.cells[row][column];
                let number = found.and_then(Value::as_f64).unwrap_or(0.0);
                cell.draft = (Some(number) != cell.current.or(Some(0.0))).then(|| TextField::with_text(format_plain(number)));
            }
        }
    }

    /// Returns the value of the argument to send.
    fn value(&self) -> Result<Option<Value>, CellPosition> {
        let number = |row: usize, column: usize| {
            self.cells[row][column].value().map_err(|()| CellPosition { block: 0, row, column })
        };
        if self.is_text() {
            return self.text_value();
        }
        if let Some(DealPrices { list, pointers }) = &self.deals {
            let mut list = list.clone();
            for (row, pointer) in pointers.iter().enumerate() {
                let price = number(row, 0)?.ok_or(CellPosition { block: 0, row, column: 0 })?;
                if let Some(place) = list.pointer_mut(pointer) {
                    *place = json_number(price);
                }
            }
            return Ok(Some(list));
        }
        if self.is_scalar() {
            return Ok(number(0, 0)?.map(json_number));
        }
        let mut whole = Map::new();
        for (row, name) in self.rows.iter().enumerate() {
            let mut inner = Map::new();
            for (column, key) in self.columns.iter().enumerate() {
                if let Some(value) = number(row, column)?.filter(|value| *value != 0.0) {
                    inner.insert(key.clone(), json_number(value));
                }
            }
            match self.argument.kind {
                ArgumentKind::Map(..) => {
                    if let Some(value) = inner.remove("") {
                        whole.insert(name.clone(), value);
                    }
                }
                _ if !inner.is_empty() => {
                    whole.insert(name.clone(), Value::Object(inner));
                }
                _ => {}
            }
        }
        Ok(Some(Value::Object(whole)))
    }
}

/// Returns the name and price of every offer in a list of deals. Returns `None` if the notation is unknown.
fn deal_prices(list: &Value) -> Option<(Vec<(String, f64)>, DealPrices)> {
    let (mut rows, mut pointers) = (Vec::new(), Vec::new());
    for (at, deal) in list.as_array()?.iter().enumerate() {
        let customer = deal.get("customer_id").or_else(|| deal.get(0))?.as_u64()?;
        let key = if deal.is_array() { "1" } else { "offerings" };
        for (number, offer) in deal.pointer(&format!("/{key}"))?.as_array()?.iter().enumerate() {
            let price_key = match offer.is_array() {
                true => "1",
                false if offer.get("price_per_seat").is_some() => "price_per_seat",
                false => "price",
            };
            let pointer = format!("/{at}/{key}/{number}/{price_key}");
            let plan = offer.get("plan").or_else(|| offer.get(0))?.as_str()?;
            rows.push((format!("#{customer} {plan}"), list.pointer(&pointer)?.as_f64()?));
            pointers.push(pointer);
        }
    }
    (!rows.is_empty()).then(|| (rows, DealPrices { list: list.clone(), pointers }))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CellPosition {
    pub block: usize,
    pub row: usize,
    pub column: usize,
}

/// All argument blocks of a tool.
#[derive(Debug, Clone)]
pub struct ToolSheet {
    pub spec: &'static ToolSpec,
    /// One block per argument. A tool with a separate screen or dialog has blocks only for numbers.
    pub blocks: Vec<ArgumentBlock>,
}

impl ToolSheet {
    /// Returns the sheet of a tool with the current values.
    pub fn new(spec: &'static ToolSpec, company: &DisplayedCompany) -> ToolSheet {
        let nothing = Map::new();
        ToolSheet::with_values(spec, company.settings.get(&spec.id).unwrap_or(&nothing), company)
    }

    /// Returns the sheet of a tool with other values in place of the current values.
    pub fn with_values(spec: &'static ToolSpec, current: &Map<String, Value>, company: &DisplayedCompany) -> ToolSheet {
        let block = |argument: &'static Argument| ArgumentBlock::new(argument, current.get(argument.name), company);
        let blocks = spec.arguments.iter().map(block);
        let elsewhere =
            |block: &ArgumentBlock| block.is_text() && (spec.kind == ToolKind::Time || spec.id == ToolId::Query);
        ToolSheet { spec, blocks: blocks.filter(|block| !elsewhere(block)).collect() }
    }

    /// Returns the sheet without the notes in descriptions that concern only the JSON of a call.
    pub fn without_json_notes(mut self) -> ToolSheet {
        for block in &mut self.blocks {
            let notes: Vec<&str> = block.doc.split("; ").filter(|note| !note.contains('{')).collect();
            block.doc = notes.join("; ");
        }
        self
    }

    /// Returns the sheet with updated current values and the drafts of all cells that still exist.
    pub fn with_current_values(&self, company: &DisplayedCompany) -> ToolSheet {
        let mut sheet = ToolSheet::new(self.spec, company);
        for (block, old) in sheet.blocks.iter_mut().zip(&self.blocks) {
            for (row, name) in old.rows.iter().enumerate() {
                if block.accepts_new_rows() && !block.rows.contains(name) {
                    block.rows.push(name.clone());
                    block.cells.push(vec![EditableCell { current: None, draft: None }]);
                }
                for (column, key) in old.columns.iter().enumerate() {
                    let place = block
                        .rows
                        .iter()
                        .position(|text| text == name)
                        .zip(block.columns.iter().position(|column_key| column_key == key));
                    if let (Some((at, across)), Some(draft)) = (place, &old.cells[row][column].draft) {
                        block.cells[at][across].draft = Some(draft.clone());
                    }
                }
            }
        }
        sheet
    }

    /// Fills in the values of arguments. Other cells keep their values.
    pub fn fill(&mut self, arguments: &Value) {
        let places: Vec<CellPosition> = self.positions().collect();
        for place in places {
            let path = self.blocks[place.block].path(place.row, place.column);
            let found = path.split('.').try_fold(arguments, |value, name| value.get(name));
            if let Some(number) = found.and_then(Value::as_f64)
                && let Some(slot) = self.cell_mut(place)
            {
                slot.draft = Some(TextField::with_text(format_plain(number)));
            }
        }
    }

    /// Fills in the arguments of a recorded call, including texts and rows for customers. Returns the names of the
    /// arguments that the call specifies.
    pub fn fill_recorded(&mut self, arguments: &Value) -> Vec<&'static str> {
        let mut given = Vec::new();
        for at in 0..self.blocks.len() {
            let argument = self.blocks[at].argument;
            let named = arguments.get(argument.name).or_else(|| arguments.get(argument.alias?));
            let whole = (self.spec.unnamed_argument == Some(argument.name)).then_some(arguments);
            let Some(value) = named.or(whole).filter(|value| !value.is_null()) else { continue };
            if self.blocks[at].accepts_new_rows() {
                for (customer, _) in value.as_object().into_iter().flatten() {
                    self.add_customer(at, customer);
                }
            }
            self.blocks[at].fill_recorded(value);
            given.push(argument.name);
        }
        given
    }

    /// Returns the typed drafts by the path of their cells.
    pub fn drafts(&self) -> BTreeMap<String, String> {
        let typed = |place: CellPosition| {
            let draft = self.cell(place)?.draft.as_ref()?;
            Some((self.blocks[place.block].path(place.row, place.column), draft.text().to_owned()))
        };
        self.positions().filter_map(typed).collect()
    }

    /// Restores drafts, including rows that were added for customers.
    pub fn restore_drafts(&mut self, values: &BTreeMap<String, String>) {
        for block in 0..self.blocks.len() {
            if self.blocks[block].accepts_new_rows() {
                let path_prefix = format!("{}.", self.blocks[block].argument.name);
                for customer in values.keys().filter_map(|path| path.strip_prefix(&path_prefix)) {
                    self.add_customer(block, customer);
                }
            }
        }
        let places: Vec<CellPosition> = self.positions().collect();
        for place in places {
            let path = self.blocks[place.block].path(place.row, place.column);
            if let (Some(text), Some(slot)) = (values.get(&path), self.cell_mut(place)) {
                slot.draft = Some(TextField::with_text(text.as_str()));
            }
        }
    }

    pub fn is_changed(&self) -> bool {
        self.blocks.iter().any(ArgumentBlock::is_changed)
    }

    /// Returns the arguments of the call: all required arguments and all changed arguments.
    ///
    /// # Errors
    /// A cell has invalid input. The error is the position of the first such cell.
    pub fn arguments(&self) -> Result<Value, CellPosition> {
        self.arguments_including(&[])
    }

    /// Returns the arguments of the call, including the unchanged values of the arguments with these names.
    ///
    /// # Errors
    /// A cell has invalid input. The error is the position of the first such cell.
    pub fn arguments_including(&self, names: &[&str]) -> Result<Value, CellPosition> {
        let mut arguments = Map::new();
        for (at, block) in self.blocks.iter().enumerate() {
            if block.argument.required || block.is_changed() || names.contains(&block.argument.name) {
                let value = block.value().map_err(|place| CellPosition { block: at, ..place })?;
                if let Some(value) = value {
                    arguments.insert(block.argument.name.to_owned(), value);
                }
            }
        }
        Ok(Value::Object(arguments))
    }

    /// Returns the position of the cell with a path, as named by a rejection.
    pub fn position_of_path(&self, path: &str) -> Option<CellPosition> {
        self.positions().find(|place| self.blocks[place.block].path(place.row, place.column) == path)
    }

    /// Returns the position of the first cell whose path contains a name.
    pub fn position_of_name(&self, name: &str) -> Option<CellPosition> {
        let is_for = |place: &CellPosition| {
            self.blocks[place.block].path(place.row, place.column).split('.').any(|text| text == name)
        };
        self.positions().find(is_for)
    }

    pub fn positions(&self) -> impl Iterator<Item = CellPosition> + '_ {
        self.blocks.iter().enumerate().flat_map(|(block, argument_block)| {
            (0..argument_block.rows.len()).flat_map(move |row| {
                (0..argument_block.columns.len()).map(move |column| CellPosition { block, row, column })
            })
        })
    }

    pub fn cell(&self, place: CellPosition) -> Option<&EditableCell> {
        self.blocks.get(place.block)?.cells.get(place.row)?.get(place.column)
    }

    pub fn cell_mut(&mut self, place: CellPosition) -> Option<&mut EditableCell> {
        self.blocks.get_mut(place.block)?.cells.get_mut(place.row)?.get_mut(place.column)
    }

    /// Adds a row for a customer. Returns false if the text is not a customer number.
    pub fn add_customer(&mut self, block: usize, text: &str) -> bool {
        let Some(number) =
            text.trim().trim_start_matches('#').parse::<u32>().ok().filter(|number| *number > 0)
        else {
            return false;
        };
        let (block, name) = (&mut self.blocks[block], number.to_string());
        if !block.rows.contains(&name) {
            block.rows.push(name);
            block.cells.push(vec![EditableCell { current: None, draft: None }]);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::test_kit::new_company;
    use novamind_tools::find;

    fn sheet(tool: &str) -> ToolSheet {
        ToolSheet::new(find(tool).expect("a tool").spec(), &new_company())
    }

    fn type_cell(sheet: &mut ToolSheet, path: &str, text: &str) {
        let place = sheet.position_of_path(path).unwrap_or_else(|| panic!("no cell {path}"));
        sheet.cell_mut(place).expect("a slot").draft = Some(TextField::with_text(text));
    }

    #[test]
    fn arguments_contain_only_changed_values() {
        let mut prices = sheet("set_prices");
        assert_eq!(prices.arguments(), Ok(json!({})));
        type_cell(&mut prices, "A", "12");
        type_cell(&mut prices, "C", "$1,055.50");
        assert_eq!(prices.arguments(), Ok(json!({"A": 12, "C": 1055.5})));
        type_cell(&mut prices, "B", "many");
        assert_eq!(prices.arguments(), Err(CellPosition { block: 1, row: 0, column: 0 }));
    }

    #[test]
    fn matrices_are_sent_in_full_without_zeros() {
        let mut ads = sheet("set_targeted_ad_spend");
        assert_eq!(ads.arguments(), Ok(json!({"targeted_spend": {}})), "the argument is required");
        type_cell(&mut ads, "targeted_spend.linkedin.E1", "200");
        type_cell(&mut ads, "targeted_spend.search_ads.S3", "0");
        assert_eq!(ads.arguments(), Ok(json!({"targeted_spend": {"linkedin": {"E1": 200}}})));
        assert_eq!((ads.blocks[0].total(), ads.blocks[0].current_total()), (200.0, 0.0));
    }

    #[test]
    fn customers_are_added_by_number() {
        let mut ads = sheet("set_ads_strength");
        let block = ads.blocks.iter().position(ArgumentBlock::accepts_new_rows).expect("customers");
        assert!(!ads.add_customer(block, "x") && !ads.add_customer(block, "0"));
        assert!(ads.add_customer(block, "#17") && ads.add_customer(block, "17"));
        type_cell(&mut ads, "by_customer.17", "0.5");
        assert_eq!(ads.arguments(), Ok(json!({"by_customer": {"17": 0.5}})));
        let renewed = ads.with_current_values(&new_company());
        assert_eq!(renewed.arguments(), ads.arguments());
    }

    #[test]
    fn lists_are_typed_as_json() {
        let mut deals = sheet("send_enterprise_deal");
        assert!(!deals.is_changed());
        assert_eq!(deals.arguments(), Ok(json!({})));
        type_cell(&mut deals, "deals", "[[7, [[\"B\", 31.5]]]]");
        assert_eq!(deals.arguments(), Ok(json!({"deals": [[7, [["B", 31.5]]]]})));
        let renewed = deals.with_current_values(&new_company());
        assert!(renewed.is_changed() && renewed.arguments() == deals.arguments());
        type_cell(&mut deals, "deals", "[[7, ");
        assert_eq!(deals.arguments(), Err(CellPosition::default()));
        assert!(deals.blocks[0].expected().contains("JSON"));
        // Tools with a separate screen have no cells for text arguments.
        assert!(sheet("query").blocks.is_empty() && sheet("next_week").blocks.is_empty());
    }

    #[test]
    fn recorded_calls_are_filled_in_completely() {
        for (tool, recorded) in [
            ("set_prices", json!({"A": 12, "B": 25})),
            ("set_targeted_ad_spend", json!({"targeted_spend": {"linkedin": {"S1": 40}}})),
            ("set_ads_strength", json!({"by_customer": {"17": 0.5}})),
            ("post_social_media", json!({"content": "a post"})),
            ("send_enterprise_deal", json!({"deals": [[7, [["B", 31.5], ["C", 60]]]]})),
            ("send_enterprise_deal", json!({"deals": [{"customer_id": 7, "offerings": [{"plan": "B", "price": 31.5}]}]})),
        ] {
            let mut sheet = sheet(tool);
            let given = sheet.fill_recorded(&recorded);
            assert_eq!(sheet.arguments_including(&given), Ok(recorded), "{tool}");
        }
        let mut deals = sheet("send_enterprise_deal");
        deals.fill_recorded(&json!({"deals": [[7, [["B", 31.5], ["C", 60]]]]}));
        assert_eq!(deals.blocks[0].rows, ["#7 B", "#7 C"]);
        type_cell(&mut deals, "deals.#7 C", "55");
        assert_eq!(deals.arguments(), Ok(json!({"deals": [[7, [["B", 31.5], ["C", 55]]]]})));
    }

    #[test]
    fn cells_of_every_tool_are_found_by_path() {
        for tool in novamind_tools::CATALOGUE {
            let sheet = ToolSheet::new(tool.spec(), &new_company());
            for place in sheet.positions() {
                let path = sheet.blocks[place.block].path(place.row, place.column);
                assert_eq!(sheet.position_of_path(&path), Some(place), "{path}");
            }
        }
    }
}
