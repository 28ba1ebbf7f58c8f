//! The values of a form: one block per argument, generated from the catalog, with drafts over the current
//! values.

use std::collections::BTreeMap;

use serde_json::{Map, Value};

use novamind_base::notation::{json_number, parse_number};
use novamind_session::identifiers::{Channel, Plan};
use novamind_tools::{Argument, ArgumentKind, Key, Kind, Range, Spec, ToolId};
use novamind_tui::text::number;
use novamind_tui::widgets::Field;
use novamind_worker::company::Company;

const CODE: &str = "code";

/// An editable value.
#[derive(Debug, Clone, PartialEq)]
pub struct Slot {
    /// Current value; `None` if nothing is set.
    pub current: Option<f64>,
    /// Typed draft; `None` while unchanged.
    pub draft: Option<Field>,
}

impl Slot {
    fn of(value: Option<&Value>) -> Slot {
        Slot { current: value.and_then(Value::as_f64), draft: None }
    }

    pub fn text(&self) -> String {
        match (&self.draft, self.current) {
            (Some(field), _) => field.text().to_owned(),
            (None, Some(value)) => plain(value),
            (None, None) => String::new(),
        }
    }

    /// Returns the number to send; `None` if empty.
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

    /// Returns whether it differs from the current value.
    pub fn is_changed(&self) -> bool {
        self.value().map_or(true, |value| value.unwrap_or(0.0) != self.current.unwrap_or(0.0))
    }
}

fn plain(value: f64) -> String {
    number(value).replace(',', "")
}

/// The cells of an argument.
#[derive(Debug, Clone)]
pub struct Block {
    pub argument: &'static Argument,
    /// Description, with the current parameters.
    pub doc: String,
    /// Names of the rows; the argument itself for a single number.
    pub rows: Vec<String>,
    /// Names of the columns; a single empty name for a number or a map.
    pub columns: Vec<String>,
    pub slots: Vec<Vec<Slot>>,
}

impl Block {
    fn of(argument: &'static Argument, current: Option<&Value>, company: &Company) -> Block {
        let keys = |key: Key, given: Option<&Value>| -> Vec<String> {
            match key {
                Key::Group => company.seen.known_groups.iter().map(|group| group.id().to_owned()).collect(),
                Key::Plan => Plan::ALL.iter().map(|plan| plan.id().to_owned()).collect(),
                Key::Channel => Channel::ALL.iter().map(|channel| channel.id().to_owned()).collect(),
                Key::Customer => {
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
            ArgumentKind::Map(..) => Slot::of(current.and_then(|map| map.get(row))),
            ArgumentKind::Matrix(..) => {
                Slot::of(current.and_then(|map| map.get(row)).and_then(|inner| inner.get(column)))
            }
            _ => Slot::of(current),
        };
        let slots = rows.iter().map(|row| columns.iter().map(|column| slot(row, column)).collect()).collect();
        let doc = company.numbers.fill(argument.doc);
        Block { argument, doc, rows, columns, slots }
    }

    pub fn range(&self) -> Range {
        match self.argument.kind {
            ArgumentKind::Number(range)
            | ArgumentKind::Integer(range)
            | ArgumentKind::Map(_, range)
            | ArgumentKind::Matrix(_, _, range) => range,
            ArgumentKind::Text | ArgumentKind::Structure(_) | ArgumentKind::Deals(_) => Range::AT_LEAST_ZERO,
        }
    }

    pub fn is_scalar(&self) -> bool {
        matches!(self.argument.kind, ArgumentKind::Number(_) | ArgumentKind::Integer(_))
    }

    pub fn is_text(&self) -> bool {
        matches!(self.argument.kind, ArgumentKind::Text | ArgumentKind::Structure(_) | ArgumentKind::Deals(_))
    }

    /// Returns whether it is a program or a statement with several lines.
    pub fn is_code(&self) -> bool {
        self.argument.kind == ArgumentKind::Text && self.argument.name == CODE
    }

    /// Returns the name of its content for key hints.
    pub fn edited(&self) -> &'static str {
        match self.argument.kind {
            _ if self.is_code() => "the code",
            ArgumentKind::Text => "the text",
            ArgumentKind::Structure(_) | ArgumentKind::Deals(_) => "the list (JSON)",
            _ => "the value",
        }
    }

    /// Returns whether rows can be added because customers are too many to list.
    pub fn is_open(&self) -> bool {
        matches!(self.argument.kind, ArgumentKind::Map(Key::Customer, _))
    }

    pub fn is_changed(&self) -> bool {
        match self.is_text() {
            true => !self.slots[0][0].text().trim().is_empty(),
            false => self.slots.iter().flatten().any(Slot::is_changed),
        }
    }

    /// Returns the sum of the new values that can be parsed.
    pub fn total(&self) -> f64 {
        self.slots.iter().flatten().filter_map(|slot| slot.value().ok().flatten()).sum()
    }

    /// Returns the sum of the current values.
    pub fn total_now(&self) -> f64 {
        self.slots.iter().flatten().filter_map(|slot| slot.current).sum()
    }

    /// Returns the path of a cell, as in rejections.
    pub fn path(&self, row: usize, column: usize) -> String {
        match self.argument.kind {
            ArgumentKind::Map(..) => format!("{}.{}", self.argument.name, self.rows[row]),
            ArgumentKind::Matrix(..) => {
                format!("{}.{}.{}", self.argument.name, self.rows[row], self.columns[column])
            }
            _ => self.argument.name.to_owned(),
        }
    }

    /// Returns the value of a text line, parsed as JSON for lists and objects.
    fn text_value(&self) -> Result<Option<Value>, CellPlace> {
        let text = self.slots[0][0].text();
        match self.argument.kind {
            _ if text.trim().is_empty() => Ok(None),
            ArgumentKind::Text => Ok(Some(text.into())),
            _ => serde_json::from_str(&text).map(Some).map_err(|_| CellPlace::default()),
        }
    }

    /// Returns the error text for invalid input.
    pub fn expected(&self) -> &'static str {
        if self.is_text() { "enter a list or object as JSON" } else { "enter a number" }
    }

    /// Returns the value to send.
    fn value(&self) -> Result<Option<Value>, CellPlace> {
        let number = |row: usize, column: usize| {
            self.slots[row][column].value().map_err(|()| CellPlace { block: 0, row, column })
        };
        if self.is_text() {
            return self.text_value();
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

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CellPlace {
    pub block: usize,
    pub row: usize,
    pub column: usize,
}

/// All blocks of a tool.
#[derive(Debug, Clone)]
pub struct Sheet {
    pub spec: &'static Spec,
    /// One block per argument. Tools with a separate screen or dialog have blocks for numbers only.
    pub blocks: Vec<Block>,
}

impl Sheet {
    /// Returns the sheet of a tool with the current values.
    pub fn of(spec: &'static Spec, company: &Company) -> Sheet {
        let nothing = Map::new();
        let current = company.settings.get(&spec.id).unwrap_or(&nothing);
        let block = |argument: &'static Argument| Block::of(argument, current.get(argument.name), company);
        let blocks = spec.arguments.iter().map(block);
        let elsewhere =
            |block: &Block| block.is_text() && (spec.kind == Kind::Time || spec.id == ToolId::Query);
        Sheet { spec, blocks: blocks.filter(|block| !elsewhere(block)).collect() }
    }

    /// Returns the sheet with updated values, and the drafts that still differ.
    pub fn renewed(&self, company: &Company) -> Sheet {
        let mut sheet = Sheet::of(self.spec, company);
        for (block, old) in sheet.blocks.iter_mut().zip(&self.blocks) {
            for (row, name) in old.rows.iter().enumerate() {
                if block.is_open() && !block.rows.contains(name) {
                    block.rows.push(name.clone());
                    block.slots.push(vec![Slot { current: None, draft: None }]);
                }
                for (column, key) in old.columns.iter().enumerate() {
                    let place = block
                        .rows
                        .iter()
                        .position(|own| own == name)
                        .zip(block.columns.iter().position(|own| own == key));
                    if let (Some((at, across)), Some(draft)) = (place, &old.slots[row][column].draft) {
                        block.slots[at][across].draft = Some(draft.clone());
                    }
                }
            }
        }
        sheet
    }

    /// Fills in arguments; other cells keep their values.
    pub fn fill(&mut self, arguments: &Value) {
        let places: Vec<CellPlace> = self.places().collect();
        for place in places {
            let path = self.blocks[place.block].path(place.row, place.column);
            let found = path.split('.').try_fold(arguments, |value, name| value.get(name));
            if let Some(number) = found.and_then(Value::as_f64)
                && let Some(slot) = self.slot_mut(place)
            {
                slot.draft = Some(Field::of(plain(number)));
            }
        }
    }

    /// Returns the drafts by path.
    pub fn typed(&self) -> BTreeMap<String, String> {
        let typed = |place: CellPlace| {
            let draft = self.slot(place)?.draft.as_ref()?;
            Some((self.blocks[place.block].path(place.row, place.column), draft.text().to_owned()))
        };
        self.places().filter_map(typed).collect()
    }

    /// Restores drafts, including rows that were added for customers.
    pub fn retype(&mut self, values: &BTreeMap<String, String>) {
        for block in 0..self.blocks.len() {
            if self.blocks[block].is_open() {
                let own = format!("{}.", self.blocks[block].argument.name);
                for customer in values.keys().filter_map(|path| path.strip_prefix(&own)) {
                    self.add_customer(block, customer);
                }
            }
        }
        let places: Vec<CellPlace> = self.places().collect();
        for place in places {
            let path = self.blocks[place.block].path(place.row, place.column);
            if let (Some(text), Some(slot)) = (values.get(&path), self.slot_mut(place)) {
                slot.draft = Some(Field::of(text.as_str()));
            }
        }
    }

    pub fn is_changed(&self) -> bool {
        self.blocks.iter().any(Block::is_changed)
    }

    /// Returns the arguments of the call: required ones, and changed ones.
    ///
    /// # Errors
    /// The first cell with invalid input.
    pub fn arguments(&self) -> Result<Value, CellPlace> {
        let mut arguments = Map::new();
        for (at, block) in self.blocks.iter().enumerate() {
            if block.argument.required || block.is_changed() {
                let value = block.value().map_err(|place| CellPlace { block: at, ..place })?;
                if let Some(value) = value {
                    arguments.insert(block.argument.name.to_owned(), value);
                }
            }
        }
        Ok(Value::Object(arguments))
    }

    /// Returns the cell that a rejection names.
    pub fn place_of(&self, path: &str) -> Option<CellPlace> {
        self.places().find(|place| self.blocks[place.block].path(place.row, place.column) == path)
    }

    /// Returns the first cell with this name in its path.
    pub fn place_for(&self, name: &str) -> Option<CellPlace> {
        let is_for = |place: &CellPlace| {
            self.blocks[place.block].path(place.row, place.column).split('.').any(|own| own == name)
        };
        self.places().find(is_for)
    }

    pub fn places(&self) -> impl Iterator<Item = CellPlace> + '_ {
        self.blocks.iter().enumerate().flat_map(|(block, own)| {
            (0..own.rows.len()).flat_map(move |row| {
                (0..own.columns.len()).map(move |column| CellPlace { block, row, column })
            })
        })
    }

    pub fn slot(&self, place: CellPlace) -> Option<&Slot> {
        self.blocks.get(place.block)?.slots.get(place.row)?.get(place.column)
    }

    pub fn slot_mut(&mut self, place: CellPlace) -> Option<&mut Slot> {
        self.blocks.get_mut(place.block)?.slots.get_mut(place.row)?.get_mut(place.column)
    }

    /// Adds a row for a customer; returns false if the text is not a customer number.
    pub fn add_customer(&mut self, block: usize, text: &str) -> bool {
        let Some(number) =
            text.trim().trim_start_matches('#').parse::<u32>().ok().filter(|number| *number > 0)
        else {
            return false;
        };
        let (block, name) = (&mut self.blocks[block], number.to_string());
        if !block.rows.contains(&name) {
            block.rows.push(name);
            block.slots.push(vec![Slot { current: None, draft: None }]);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::test_kit::company;
    use novamind_tools::find;

    fn sheet(tool: &str) -> Sheet {
        Sheet::of(find(tool).expect("a tool").spec(), &company())
    }

    fn fill(sheet: &mut Sheet, path: &str, text: &str) {
        let place = sheet.place_of(path).unwrap_or_else(|| panic!("no cell {path}"));
        sheet.slot_mut(place).expect("a slot").draft = Some(Field::of(text));
    }

    #[test]
    fn only_what_differs_is_sent() {
        let mut prices = sheet("set_prices");
        assert_eq!(prices.arguments(), Ok(json!({})));
        fill(&mut prices, "A", "12");
        fill(&mut prices, "C", "$1,055.50");
        assert_eq!(prices.arguments(), Ok(json!({"A": 12, "C": 1055.5})));
        fill(&mut prices, "B", "many");
        assert_eq!(prices.arguments(), Err(CellPlace { block: 1, row: 0, column: 0 }));
    }

    #[test]
    fn a_matrix_is_sent_whole_without_its_zeros() {
        let mut ads = sheet("set_targeted_ad_spend");
        assert_eq!(ads.arguments(), Ok(json!({"targeted_spend": {}})), "the argument is required");
        fill(&mut ads, "targeted_spend.linkedin.E1", "200");
        fill(&mut ads, "targeted_spend.search_ads.S3", "0");
        assert_eq!(ads.arguments(), Ok(json!({"targeted_spend": {"linkedin": {"E1": 200}}})));
        assert_eq!((ads.blocks[0].total(), ads.blocks[0].total_now()), (200.0, 0.0));
    }

    #[test]
    fn customers_are_added_by_number() {
        let mut ads = sheet("set_ads_strength");
        let block = ads.blocks.iter().position(Block::is_open).expect("customers");
        assert!(!ads.add_customer(block, "x") && !ads.add_customer(block, "0"));
        assert!(ads.add_customer(block, "#17") && ads.add_customer(block, "17"));
        fill(&mut ads, "by_customer.17", "0.5");
        assert_eq!(ads.arguments(), Ok(json!({"by_customer": {"17": 0.5}})));
        let renewed = ads.renewed(&company());
        assert_eq!(renewed.arguments(), ads.arguments());
    }

    #[test]
    fn lists_are_typed_as_json() {
        let mut deals = sheet("send_enterprise_deal");
        assert!(!deals.is_changed());
        assert_eq!(deals.arguments(), Ok(json!({})));
        fill(&mut deals, "deals", "[[7, [[\"B\", 31.5]]]]");
        assert_eq!(deals.arguments(), Ok(json!({"deals": [[7, [["B", 31.5]]]]})));
        let renewed = deals.renewed(&company());
        assert!(renewed.is_changed() && renewed.arguments() == deals.arguments());
        fill(&mut deals, "deals", "[[7, ");
        assert_eq!(deals.arguments(), Err(CellPlace::default()));
        assert!(deals.blocks[0].expected().contains("JSON"));
        // Tools with a separate screen have no cells.
        assert!(sheet("query").blocks.is_empty() && sheet("next_week").blocks.is_empty());
    }

    #[test]
    fn every_tool_has_a_sheet_whose_cells_are_found_by_their_paths() {
        for tool in novamind_tools::CATALOGUE {
            let sheet = Sheet::of(tool.spec(), &company());
            for place in sheet.places() {
                let path = sheet.blocks[place.block].path(place.row, place.column);
                assert_eq!(sheet.place_of(&path), Some(place), "{path}");
            }
        }
    }
}
