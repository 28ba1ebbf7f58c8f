//! Customers that recorded calls name, with their numbers in a branch.

use serde_json::Value;

use novamind_tools::{Refusal, ToolId, readdressed};
use novamind_world::customers::numbers::CustomerNumbers;

/// A recorded call with the customer numbers of a branch.
pub(crate) struct CallHere {
    /// Arguments with the numbers of the branch; `None` if no named customer exists there.
    pub args: Option<Value>,
    /// A rejection for each named customer that does not exist in the branch.
    pub absent: Vec<Refusal>,
}

impl CallHere {
    /// Translates the customer numbers of a recorded call to those of a branch with the same random draws.
    pub fn of(tool: ToolId, args: &Value, meant: &CustomerNumbers, here: &CustomerNumbers) -> CallHere {
        let mut absent = Vec::new();
        let args = readdressed(tool, args, &mut |customer| {
            // A number that does not exist in the run stays.
            let Some((group, n)) = meant.find(customer) else { return Some(customer) };
            let number = here.of(group, n);
            if number.is_none() {
                let message = format!(
                    "customer {customer} of the run, number {n} of {group}, does not exist in this branch: it has fewer leads"
                );
                absent.push(Refusal::new("customer_not_found", message));
            }
            number
        });
        CallHere { args, absent }
    }
}

/// Adds a note that the rejection uses the numbers of the branch.
pub(crate) fn in_other_numbers(refusal: Refusal) -> Refusal {
    let message = format!("{} (customer numbers of the branch)", refusal.message);
    Refusal { message, ..refusal }
}
