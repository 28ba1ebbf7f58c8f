//! Customers that recorded calls name, with their numbers in a branch.

use serde_json::Value;

use novamind_tools::{Rejection, ToolId, remap_customers};
use novamind_world::customers::customer_numbers::CustomerNumbers;

/// A recorded call with the customer numbers of a branch.
pub(crate) struct RenumberedCall {
    /// Arguments with the numbers of the branch; `None` if no named customer exists there.
    pub args: Option<Value>,
    /// A rejection for each named customer that does not exist in the branch.
    pub missing_customers: Vec<Rejection>,
}

impl RenumberedCall {
    /// Translates the customer numbers of a recorded call to those of a branch with the same random draws.
    pub fn new(
        tool: ToolId,
        args: &Value,
        meant: &CustomerNumbers,
        here: &CustomerNumbers,
    ) -> RenumberedCall {
        let mut absent = Vec::new();
        let args = remap_customers(tool, args, &mut |customer| {
            // A number that does not exist in the run stays.
            let Some((group, n)) = meant.find(customer) else { return Some(customer) };
            let number = here.customer_number(group, n);
            if number.is_none() {
                let message = format!(
                    "customer {customer} of the run, number {n} of {group}, does not exist in this branch: it has fewer leads"
                );
                absent.push(Rejection::new("customer_not_found", message));
            }
            number
        });
        RenumberedCall { args, missing_customers: absent }
    }
}

/// Adds a note that the rejection uses the numbers of the branch.
pub(crate) fn with_branch_number_note(refusal: Rejection) -> Rejection {
    let message = format!("{} (customer numbers of the branch)", refusal.message);
    Rejection { message, ..refusal }
}
