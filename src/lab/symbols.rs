//! Symbols in arguments of policies: names that are resolved at the time of the call
//! (docs/interfaces/policies.md#symbols).

use serde_json::{Map, Value};

use novamind_world::identifiers::{Channel, Group};

/// The symbols that policies can use, with their values.
pub struct SymbolTable {
    known_groups: Vec<Group>,
}

impl SymbolTable {
    /// Creates the symbols for a company that has discovered the groups in `known`.
    pub fn new(known: impl IntoIterator<Item = Group>) -> SymbolTable {
        SymbolTable { known_groups: known.into_iter().collect() }
    }

    fn discovered_groups(&self) -> impl Iterator<Item = Group> + '_ {
        self.known_groups.iter().copied().filter(|group| !group.is_initially_known())
    }

    /// Returns the group IDs that a symbol represents, or `None` if the text is not a symbol.
    fn symbol_members(&self, text: &str) -> Option<Vec<String>> {
        let names =
            |groups: &mut dyn Iterator<Item = Group>| groups.map(|group| group.id().to_owned()).collect();
        Some(match text {
            "@first_discovered" => {
                self.discovered_groups().map(|group| group.id().to_owned()).min().into_iter().collect()
            }
            "@discovered_individuals" => {
                names(&mut self.discovered_groups().filter(|group| !group.is_enterprise()))
            }
            "@discovered_enterprises" => {
                names(&mut self.discovered_groups().filter(|group| group.is_enterprise()))
            }
            "@known" => names(&mut self.known_groups.iter().copied()),
            "@channels" => Channel::ALL.iter().map(|channel| channel.id().to_owned()).collect(),
            _ => return None,
        })
    }

    /// Expands arguments with symbols into the arguments of one or more calls. A symbol that is the value of
    /// an argument produces one call for each member. Returns no calls if a symbol has no members.
    pub fn resolve(&self, arguments: &Value) -> Vec<Value> {
        let Some(map) = arguments.as_object() else { return vec![arguments.clone()] };
        let mut calls = vec![Map::new()];
        for (name, value) in map {
            let values = match value.as_str().and_then(|text| self.symbol_members(text)) {
                Some(members) => members.into_iter().map(Value::String).collect(),
                None => self.expand_map(value).map_or_else(Vec::new, |value| vec![value]),
            };
            calls = calls
                .iter()
                .flat_map(|call| {
                    values.iter().map(move |value| {
                        let mut call = call.clone();
                        call.insert(name.clone(), value.clone());
                        call
                    })
                })
                .collect();
        }
        calls.into_iter().map(Value::Object).collect()
    }

    /// Expands the symbols among the keys of a map. Explicit keys take precedence. Returns `None` if a symbol
    /// has no members.
    fn expand_map(&self, value: &Value) -> Option<Value> {
        let Some(map) = value.as_object() else { return Some(value.clone()) };
        let mut spread = Map::new();
        for (key, inner) in map {
            let inner = self.expand_map(inner)?;
            match self.symbol_members(key) {
                Some(members) if members.is_empty() => return None,
                Some(members) => members.into_iter().for_each(|name| {
                    spread.insert(name, inner.clone());
                }),
                None => {}
            }
        }
        for (key, inner) in map.iter().filter(|(key, _)| self.symbol_members(key).is_none()) {
            spread.insert(key.clone(), self.expand_map(inner)?);
        }
        Some(Value::Object(spread))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn test_symbols(discovered: &[&str]) -> SymbolTable {
        let group = |id: &&str| Group::parse(id).expect("a group");
        SymbolTable::new(
            Group::all().filter(|group| group.is_initially_known()).chain(discovered.iter().map(group)),
        )
    }

    #[test]
    fn symbol_keys_expand_and_explicit_keys_take_precedence() {
        let given =
            json!({"targeted_spend": {"@channels": {"S1": 50, "@discovered_individuals": 9, "D_S02": 1}}});
        let calls = test_symbols(&["D_S02", "D_S07", "D_E01"]).resolve(&given);
        assert_eq!(calls.len(), 1);
        let linkedin = &calls[0]["targeted_spend"]["linkedin"];
        assert_eq!(linkedin, &json!({"D_S02": 1, "D_S07": 9, "S1": 50}));
        assert_eq!(calls[0]["targeted_spend"].as_object().map(Map::len), Some(5));
    }

    #[test]
    fn symbol_values_expand_to_one_call_per_member() {
        let given = json!({"group_id": "@first_discovered", "target_level": 2});
        assert_eq!(test_symbols(&[]).resolve(&given), Vec::<Value>::new());
        let calls = test_symbols(&["D_S02", "D_E09"]).resolve(&given);
        assert_eq!(calls, [json!({"group_id": "D_E09", "target_level": 2})]);
        let all = test_symbols(&["D_S02", "D_E09"]).resolve(&json!({"group_id": "@discovered_enterprises"}));
        assert_eq!(all, [json!({"group_id": "D_E09"})]);
        assert_eq!(
            test_symbols(&[]).resolve(&json!({"by_group": {"@discovered_individuals": 1}})),
            Vec::<Value>::new()
        );
        assert_eq!(test_symbols(&[]).resolve(&json!({"group_id": "@known"})).len(), 6);
        assert_eq!(test_symbols(&[]).resolve(&json!({"tier": 2})), [json!({"tier": 2})]);
    }
}
