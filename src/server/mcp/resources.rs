//! Resources that a client can read without a tool call: goal, dashboard, manual, tables, notes.

use rmcp::ErrorData;
use rmcp::model::{ReadResourceResult, Resource, ResourceContents};

use crate::request::ApiRequest;
use crate::worker::SessionHandle;
use novamind_database::tables;
use novamind_tools::describe::format_manual;
use novamind_tools::{CATALOGUE, ParameterNumbers};

const GOAL: &str = "novamind://goal";
const DASHBOARD: &str = "novamind://dashboard";
const MANUAL: &str = "novamind://manual";
const TABLES: &str = "novamind://tables";
const NOTES: &str = "novamind://memo";

/// Returns the list of all resources.
pub fn list() -> Vec<Resource> {
    let one = |uri: &str, name: &str, title: &str| {
        Resource::new(uri, name).with_title(title).with_mime_type("text/plain")
    };
    vec![
        one(GOAL, "goal", "Goal, calendar and rules of the run"),
        one(DASHBOARD, "dashboard", "The dashboard of the last week"),
        one(MANUAL, "manual", "Every tool: arguments, effect, cost, rejections, result"),
        one(TABLES, "tables", "Every table that can be queried, and its columns"),
        one(NOTES, "memo", "The notes of the run"),
    ]
}

/// Returns the content of a resource.
///
/// # Errors
/// No resource has this URI.
pub async fn read(
    uri: &str,
    handle: &SessionHandle,
    (goal, numbers): (&str, &ParameterNumbers),
) -> Result<ReadResourceResult, ErrorData> {
    let text = match uri {
        GOAL => goal.to_owned(),
        DASHBOARD => resource_text(handle, ApiRequest::Dashboard, "/dashboard").await,
        NOTES => resource_text(handle, ApiRequest::Notes, "/data/text").await,
        MANUAL => {
            let texts: Vec<String> =
                CATALOGUE.iter().map(|tool| format_manual(tool.spec(), numbers)).collect();
            texts.join("\n")
        }
        TABLES => {
            let texts: Vec<String> =
                tables(numbers.interface()).iter().map(|table| table.describe()).collect();
            texts.join("\n")
        }
        _ => {
            let message = format!("there is no resource {uri}; resources/list lists all resources");
            return Err(ErrorData::resource_not_found(message, None));
        }
    };
    Ok(ReadResourceResult::new(vec![ResourceContents::text(text, uri)]))
}

async fn resource_text(handle: &SessionHandle, request: ApiRequest, pointer: &str) -> String {
    let answer = handle.send(request).await;
    let value = answer.body.pointer(pointer).or_else(|| answer.body.get("error"));
    value.and_then(|text| text.as_str()).unwrap_or_default().to_owned()
}
