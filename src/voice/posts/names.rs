//! Profile names of customers in the groups that are known from the start.

use novamind_world::events::PostAuthor;
use novamind_world::random::{Part, Streams};

const S1: [&str; 3] = ["Mina Okoye", "Theo Lindgren", "Pilar Santos"];
const S2: [&str; 3] = ["Dr. Anselm Richter", "Judith Marlowe", "Kenji Watanabe"];
const S3: [&str; 3] = ["Rasmus Holt", "Ines Carvalho", "Devika Rao"];
const E1: [&str; 2] = ["Harbor Freight Desk", "Millbrook Operations"];
const E2: [&str; 2] = ["Castell & Byrne", "Northlight Biosciences"];
const E3: [&str; 2] = ["Meridian Group", "Aurelia Holdings"];

/// Returns the profile name of a customer, or `None` for customers in discoverable groups.
pub fn profile_name(author: &PostAuthor, streams: &Streams) -> Option<&'static str> {
    let names: &[&'static str] = match author.group.id() {
        "S1" => &S1,
        "S2" => &S2,
        "S3" => &S3,
        "E1" => &E1,
        "E2" => &E2,
        "E3" => &E3,
        _ => return None,
    };
    let keys = [author.group.index() as u64, u64::from(author.n)];
    Some(names[streams.open(Part::PersonaTemplate, keys).index(names.len())])
}

#[cfg(test)]
mod tests {
    use super::super::customers::tests::author;
    use super::*;
    use novamind_world::identifiers::Group;

    #[test]
    fn profile_names_are_constant_for_each_customer() {
        let streams = Streams::new(1);
        for group in Group::all() {
            let name = profile_name(&author(group), &streams);
            assert_eq!(name.is_some(), group.is_initially_known(), "{group}");
            assert_eq!(name, profile_name(&author(group), &streams));
        }
    }
}
