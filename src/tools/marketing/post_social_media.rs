use serde::Serialize;
use serde_json::Value;

use super::super::arguments::{Arguments, integer, wrong_type};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Planned, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use novamind_world::command::{Command, Draft, ResolvedCommand};

/// The tool `post_social_media`.
pub struct PostSocialMedia;

static SPEC: Spec = Spec {
    id: ToolId::PostSocialMedia,
    code: "POST",
    module: Module::Marketing,
    kind: Kind::OneShot,
    summary: "Publish a post of the company, or reply to a post",
    arguments: &[
        Argument {
            name: "content",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            doc: "the text, 1 to {limits.post_max_chars} characters",
        },
        Argument {
            name: "reply_to_post_id",
            alias: None,
            kind: ArgumentKind::Integer(Range::between(1.0, f64::INFINITY)),
            required: false,
            unit: "post",
            doc: "number of the post to reply to, if any",
        },
    ],
    own_unknown: false,
    whole: None,
    when: When::NextDay,
    effect: "On the next day every known group reads it. A post that fits a group, is specific and true, and \
             addresses its current concerns is shared and brings leads from the day after, half as many every \
             {ceo_posts.multiplier_half_life_days:word} days; hype, false claims and insults cost leads. Strong reactions bring comments.",
    cost: "nothing; one post per decision day",
    writes: &["agent_social_media_posts"],
    refusals: &["too_long", "blank", "already_posted", "post_not_found"],
    returns: &[
        Output { name: "agent_post_id", kind: "integer", doc: "number of your post" },
        Output { name: "day", kind: "integer", doc: "day" },
        Output { name: "content", kind: "text", doc: "the text" },
        Output { name: "reply_to_post_id", kind: "integer or null", doc: "the post to which it replies" },
    ],
    example: r#"{"content": "Exports are twice as fast from today."}"#,
};

/// A post of the company.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PublishedPost {
    /// Number among the company's posts.
    pub agent_post_id: u32,
    /// Day.
    pub day: u32,
    /// Text.
    pub content: String,
    /// Post to which it replies.
    pub reply_to_post_id: Option<u32>,
}

fn content(view: &View<'_>, arguments: &Arguments) -> Result<String, Refusal> {
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
    if view.world().market.social.own.iter().any(|post| post.day == view.day()) {
        let message = format!(
            "you have already posted on day {}; you can post again on the next decision day",
            view.day()
        );
        return Err(Refusal::new("already_posted", message));
    }
    Ok(content.to_owned())
}

/// Parses the number of the post to which it replies.
fn answered(view: &View<'_>, given: &Value, field: &str) -> Result<u32, Refusal> {
    let number = integer(given).ok_or_else(|| wrong_type(field, "a whole number"))?;
    let post = u32::try_from(number).ok().filter(|post| view.world().market.social.has_post(*post));
    post.ok_or_else(|| {
        let message =
            format!("there is no post {number}; get_social_posts lists the posts with their numbers");
        Refusal::at(field, "post_not_found", message)
    })
}

impl Tool for PostSocialMedia {
    type Args = Draft;
    type Answer = PublishedPost;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, view: &View<'_>, arguments: &Arguments) -> Result<Draft, Refusal> {
        let content = content(view, arguments)?;
        let reply_to = arguments.read("reply_to_post_id", |value, name| answered(view, value, name))?;
        Ok(Draft { content, reply_to })
    }

    fn plan(&self, view: &View<'_>, draft: Draft) -> Result<Planned<PublishedPost>, Refusal> {
        let day = view.day();
        Ok(Planned::drawing(Command::Post(draft), move |resolved| match resolved {
            ResolvedCommand::Post(made) => Some(PublishedPost {
                agent_post_id: made.post,
                day,
                content: made.content.clone(),
                reply_to_post_id: made.reply_to,
            }),
            _ => None,
        }))
    }
}
