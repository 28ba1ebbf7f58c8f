//! Companies that calls of a run name, in a branch where they have other numbers.

use serde_json::Value;

use novamind_tools::{Refusal, ToolId, readdressed};
use novamind_world::customers::numbers::CustomerNumbers;

/// A call as a branch can make it.
pub(crate) struct CallHere {
    /// Its arguments with the numbers of the branch; none where no company of the call has come.
    pub args: Option<Value>,
    /// Why it does not reach companies that it names.
    pub absent: Vec<Refusal>,
}

impl CallHere {
    /// A call whose numbers mean customers of one company, made in another under the same luck.
    pub fn of(tool: ToolId, args: &Value, meant: &CustomerNumbers, here: &CustomerNumbers) -> CallHere {
        let mut absent = Vec::new();
        let args = readdressed(tool, args, &mut |customer| {
            // A number that the run did not give means nobody else.
            let Some((group, n)) = meant.find(customer) else { return Some(customer) };
            let number = here.of(group, n);
            if number.is_none() {
                let message = format!(
                    "customer {customer} of the run, number {n} of {group}, has not come here: fewer leads came"
                );
                absent.push(Refusal::new("customer_not_found", message));
            }
            number
        });
        CallHere { args, absent }
    }
}

/// A refusal that names customers by the numbers of the branch.
pub(crate) fn in_other_numbers(refusal: Refusal) -> Refusal {
    let message = format!("{}; numbers are those of the branch", refusal.message);
    Refusal { message, ..refusal }
}
