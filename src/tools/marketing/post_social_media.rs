use serde::Serialize;
use serde_json::Value;

use super::super::arguments::{Arguments, json_i64, wrong_type_rejection};
use super::super::{
    Argument, ArgumentKind, EffectTiming, NumberRange, PlannedCall, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use novamind_world::command::{Command, PostDraft, ResolvedCommand};

/// The tool `post_social_media`, which publishes a post of the company.
pub struct PostSocialMedia;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::PostSocialMedia,
    code: "POST",
    module: ToolModule::Marketing,
    kind: ToolKind::OneShot,
    summary: "Publish a post of the company, or reply to a post",
    arguments: &[
        Argument {
            name: "content",
            alias: None,
            kind: ArgumentKind::Text,
            required: true,
            unit: "",
            description: "the text, 1 to {limits.post_max_chars} characters",
        },
        Argument {
            name: "reply_to_post_id",
            alias: None,
            kind: ArgumentKind::Integer(NumberRange::between(1.0, f64::INFINITY)),
            required: false,
            unit: "post",
            description: "number of the post to reply to, if any",
        },
    ],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::NextDay,
    effect: "On the next day every known group reads it. A post that fits a group, is specific and true, and \
             addresses its current concerns is shared and brings leads from the day after, half as many every \
             {ceo_posts.multiplier_half_life_days:word} days; hype, false claims and insults cost leads. Strong reactions bring comments.",
    cost: "nothing; one post per decision day",
    written_tables: &["agent_social_media_posts"],
    rejection_codes: &["too_long", "blank", "already_posted", "post_not_found"],
    result_fields: &[
        ResultField { name: "agent_post_id", kind: "integer", description: "number of your post" },
        ResultField { name: "day", kind: "integer", description: "day" },
        ResultField { name: "content", kind: "text", description: "the text" },
        ResultField {
            name: "reply_to_post_id",
            kind: "integer or null",
            description: "the post to which it replies",
        },
    ],
    example: r#"{"content": "Exports are twice as fast from today."}"#,
};

/// A post that the company published.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PublishedPost {
    /// Number of the post among the company's posts, from 1.
    pub agent_post_id: u32,
    /// Day on which the post was published.
    pub day: u32,
    /// Text of the post.
    pub content: String,
    /// Number of the public post to which this post replies; `None` if it is not a reply.
    pub reply_to_post_id: Option<u32>,
}

fn parse_content(view: &ToolContext<'_>, arguments: &Arguments) -> Result<String, Rejection> {
    let content = arguments.get("content").unwrap_or(&Value::Null);
    let content = content.as_str().ok_or_else(|| wrong_type_rejection("content", "a text"))?;
    let (length, most) = (content.chars().count(), view.params().limits.post_max_chars as usize);
    if length > most {
        let message = format!("the post has {length} characters, at most {most} are allowed; shorten it");
        return Err(Rejection::for_field("content", "too_long", message));
    }
    if content.trim().is_empty() {
        return Err(Rejection::for_field("content", "blank", "the post is empty; write something"));
    }
    if view.world().market.social.own.iter().any(|post| post.day == view.day()) {
        let message = format!(
            "you have already posted on day {}; you can post again on the next decision day",
            view.day()
        );
        return Err(Rejection::new("already_posted", message));
    }
    Ok(content.to_owned())
}

/// Parses the number of the post to which the new post replies.
fn parse_replied_post(view: &ToolContext<'_>, given: &Value, field: &str) -> Result<u32, Rejection> {
    let number = json_i64(given).ok_or_else(|| wrong_type_rejection(field, "a whole number"))?;
    let post = u32::try_from(number).ok().filter(|post| view.world().market.social.has_post(*post));
    post.ok_or_else(|| {
        let message =
            format!("there is no post {number}; get_social_posts lists the posts with their numbers");
        Rejection::for_field(field, "post_not_found", message)
    })
}

impl Tool for PostSocialMedia {
    type Args = PostDraft;
    type Answer = PublishedPost;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, view: &ToolContext<'_>, arguments: &Arguments) -> Result<PostDraft, Rejection> {
        let content = parse_content(view, arguments)?;
        let reply_to = arguments
            .parse_argument("reply_to_post_id", |value, name| parse_replied_post(view, value, name))?;
        Ok(PostDraft { content, reply_to })
    }

    fn plan(
        &self,
        view: &ToolContext<'_>,
        draft: PostDraft,
    ) -> Result<PlannedCall<PublishedPost>, Rejection> {
        let day = view.day();
        Ok(PlannedCall::with_draws(Command::Post(draft), move |resolved| match resolved {
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
