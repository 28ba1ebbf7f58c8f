use serde_json::{Map, Value, json};

use super::super::arguments::{Arguments, integer, wrong_type};
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, PublicPost, Range, Refusal, Spec, Tool, ToolId, View, When,
};
use crate::world::command::{Command, ResolvedCommand};
use crate::world::identifiers::Group;

/// Reads the newest posts of others.
pub struct GetSocialPosts;

const ANY: ArgumentKind = ArgumentKind::Integer(Range::between(f64::NEG_INFINITY, f64::INFINITY));

static SPEC: Spec = Spec {
    id: ToolId::GetSocialPosts,
    code: "FEED",
    module: Module::Analytics,
    kind: Kind::Read,
    summary: "Read what people write in public, newest first",
    arguments: &[
        Argument {
            name: "days",
            alias: None,
            kind: ANY,
            required: false,
            unit: "days",
            doc: "accepted but ignored: the newest posts of all time are returned",
        },
        Argument {
            name: "limit",
            alias: None,
            kind: ANY,
            required: false,
            unit: "posts",
            doc: "how many at most, 50 if left out; 0 for none, a negative number for all",
        },
    ],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &[],
    returns: &[
        Output {
            name: "posts",
            kind: "list of {post_id, day, content, reply_to_agent_post_id, source_group_id, group_id, customer_type, custom_name, persona_name, replying_to_your_post}",
            doc: "group of the author; the press writes as S1; the last field is present only on comments on \
                  your posts",
        },
        Output { name: "total", kind: "integer", doc: "posts returned; absent when there are none" },
    ],
    example: r#"{"limit": 1}"#,
};

/// A number that may be missing.
fn number(arguments: &Arguments, name: &'static str) -> Result<Option<i64>, Refusal> {
    let given = arguments.get(name);
    given.map(|value| integer(value).ok_or_else(|| wrong_type(name, "a whole number"))).transpose()
}

fn as_json(post: &PublicPost, view: &View<'_>) -> Value {
    // The market observer is an individual of the first group.
    let group = post.written_by.or_else(|| Group::at(0));
    let company = group.is_some_and(Group::is_enterprise);
    let own = &view.world().market.social.own;
    let answered = post.own_post.and_then(|number| own.get(number as usize - 1));
    let mut fields = json!({
        "post_id": post.post,
        "day": post.day,
        "content": post.content,
        "reply_to_agent_post_id": post.own_post,
        "source_group_id": post.source_group.map(Group::id),
        "group_id": group.map(Group::id),
        "customer_type": if company { "large" } else { "small" },
        "custom_name": null,
        "persona_name": post.profile,
    });
    if let Some(answered) = answered {
        fields["replying_to_your_post"] = answered.content.clone().into();
    }
    fields
}

impl Tool for GetSocialPosts {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, _: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        number(arguments, "days")?;
        number(arguments, "limit")?;
        Ok(Command::None)
    }

    fn answer(&self, view: &View<'_>, arguments: &Arguments, _: &ResolvedCommand) -> Value {
        let limit = number(arguments, "limit").ok().flatten();
        let limit = limit.unwrap_or_else(|| i64::from(view.params().limits.get_social_posts_default_limit));
        let limit = usize::try_from(limit).unwrap_or(usize::MAX);
        let newest = view.posts().iter().rev().take(limit);
        let posts: Vec<Value> = newest.map(|post| as_json(post, view)).collect();
        let total = posts.len();
        let mut data = Map::from_iter([("posts".to_owned(), Value::Array(posts))]);
        if total > 0 {
            data.insert("total".to_owned(), total.into());
        }
        Value::Object(data)
    }
}
