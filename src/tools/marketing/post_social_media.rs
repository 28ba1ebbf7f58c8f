use serde_json::{Value, json};

use super::super::arguments::{Arguments, integer, wrong_type};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use crate::world::command::{Command, Draft, ResolvedCommand};

/// Publishes a post of the company.
pub struct PostSocialMedia;

static SPEC: Spec = Spec {
    id: ToolId::PostSocialMedia,
    code: "POST",
    module: Module::Marketing,
    kind: Kind::OneShot,
    summary: "Publish a post as the company, or answer somebody's post",
    arguments: &[
        Argument {
            name: "content",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            doc: "the text, 1 to 280 characters",
        },
        Argument {
            name: "reply_to_post_id",
            alias: None,
            kind: ArgumentKind::Integer(Range::between(1.0, f64::INFINITY)),
            required: false,
            unit: "post",
            doc: "number of the post to answer; without it, the post stands alone",
        },
    ],
    own_unknown: false,
    whole: None,
    when: When::NextDay,
    effect: "On the next day every known group reads it. A post that fits a group, is specific and true, and \
             speaks to what is on its mind is shared and brings leads from the day after, half as many every \
             three days; hype, false claims and insults cost leads. Strong reactions bring comments.",
    cost: "nothing; one post per decision day",
    writes: &["agent_social_media_posts"],
    refusals: &["too_long", "blank", "already_posted", "post_not_found"],
    returns: &[
        Output { name: "agent_post_id", kind: "integer", doc: "number of your post" },
        Output { name: "day", kind: "integer", doc: "day" },
        Output { name: "content", kind: "text", doc: "the text" },
        Output { name: "reply_to_post_id", kind: "integer or null", doc: "the post it answers" },
    ],
    example: r#"{"content": "Exports are twice as fast from today."}"#,
};

/// The text, if it can be published today.
fn content<'a>(view: &View<'_>, arguments: &'a Arguments) -> Result<&'a str, Refusal> {
    let content = arguments.get("content").unwrap_or(&Value::Null);
    let content = content.as_str().ok_or_else(|| wrong_type("content", "a text"))?;
    let (length, most) = (content.chars().count(), view.params().limits.post_max_chars as usize);
    if length > most {
        let message = format!("the post has {length} characters, at most {most} are allowed; shorten it");
        return Err(Refusal::at("content", "too_long", message));
    }
    if content.trim().is_empty() {
        return Err(Refusal::at("content", "blank", "the post is empty; write something"));
    }
    Ok(content)
}

impl Tool for PostSocialMedia {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        let content = content(view, arguments)?.to_owned();
        let social = &view.world().market.social;
        if social.own.iter().any(|post| post.day == view.day()) {
            let message = format!(
                "you have already posted on day {}; you can post again on the next decision day",
                view.day()
            );
            return Err(Refusal::new("already_posted", message));
        }
        let reply_to = match arguments.get("reply_to_post_id") {
            None => None,
            Some(given) => {
                let number =
                    integer(given).ok_or_else(|| wrong_type("reply_to_post_id", "a whole number"))?;
                let post = u32::try_from(number).ok().filter(|post| social.has_post(*post));
                Some(post.ok_or_else(|| {
                    let message = format!(
                        "there is no post {number}; get_social_posts lists the posts with their numbers"
                    );
                    Refusal::at("reply_to_post_id", "post_not_found", message)
                })?)
            }
        };
        Ok(Command::Post(Draft { content, reply_to }))
    }

    fn answer(&self, view: &View<'_>, _: &Arguments, resolved: &ResolvedCommand) -> Value {
        let ResolvedCommand::Post(made) = resolved else { return Value::Null };
        json!({
            "agent_post_id": made.post,
            "day": view.day(),
            "content": made.content,
            "reply_to_post_id": made.reply_to,
        })
    }
}
