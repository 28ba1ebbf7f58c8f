//! Translation of the customer numbers in recorded calls to the numbers of a branch.

use serde_json::Value;

use novamind_tools::{Rejection, ToolId, remap_customers};
use novamind_world::customers::customer_numbers::CustomerNumbers;

/// A recorded call with translated customer numbers.
pub(crate) struct RenumberedCall {
    /// Arguments with the customer numbers of the branch; `None` if none of the call's customers exists in the branch.
    pub args: Option<Value>,
    /// A rejection for each customer of the call that does not exist in the branch.
    pub missing_customers: Vec<Rejection>,
}

impl RenumberedCall {
    /// Translates the customer numbers of a recorded call to the numbers of a branch with the same random draws.
    pub fn new(
        tool: ToolId,
        args: &Value,
        run_numbers: &CustomerNumbers,
        branch_numbers: &CustomerNumbers,
    ) -> RenumberedCall {
        let mut absent = Vec::new();
        let args = remap_customers(tool, args, &mut |customer| {
            // A customer number that does not exist in the run is kept.
            let Some((group, n)) = run_numbers.find(customer) else { return Some(customer) };
            let number = branch_numbers.customer_number(group, n);
            if number.is_none() {
                let message = format!(
                    "customer {customer} of the run, number {n} of {group}, does not exist in this branch, which has fewer leads"
                );
                absent.push(Rejection::new("customer_not_found", message));
            }
            number
        });
        RenumberedCall { args, missing_customers: absent }
    }
}

/// Adds a note that the customer numbers in the message are numbers of the branch.
pub(crate) fn add_branch_number_note(refusal: Rejection) -> Rejection {
    let message = format!("{} (customer numbers of the branch)", refusal.message);
    Rejection { message, ..refusal }
}
