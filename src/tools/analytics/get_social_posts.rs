use std::borrow::Cow;

use serde::Serialize;

use super::super::arguments::{Arguments, json_i64, wrong_type_rejection};
use super::super::{
    Argument, ArgumentKind, EffectTiming, NumberRange, PlannedCall, PublicPost, Rejection, ResultField, Tool,
    ToolContext, ToolId, ToolKind, ToolModule, ToolSpec,
};
use novamind_world::identifiers::Group;
use novamind_world::params::Interface;

/// The tool `get_social_posts`, which returns the newest posts of other authors.
pub struct GetSocialPosts;

const ANY_INTEGER: ArgumentKind =
    ArgumentKind::Integer(NumberRange::between(f64::NEG_INFINITY, f64::INFINITY));

const TOTAL_FIELD: ResultField = ResultField {
    name: "total",
    kind: "integer",
    description: "number of returned posts; absent if there are none",
};

/// Fields of the result under release 2, which does not return the authors of posts.
pub(crate) static RELEASE_2_FIELDS: [ResultField; 2] = [
    ResultField {
        name: "posts",
        kind: "list of {post_id, day, reply_to_agent_post_id, content, replying_to_your_post}",
        description: "public posts; the last field is present only on comments on your posts",
    },
    TOTAL_FIELD,
];

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::GetSocialPosts,
    code: "FEED",
    module: ToolModule::Analytics,
    kind: ToolKind::Read,
    summary: "Read public posts of others, newest first",
    arguments: &[
        Argument {
            name: "days",
            alias: None,
            kind: ANY_INTEGER,
            required: false,
            unit: "days",
            description: "accepted but ignored: the newest posts of all time are returned",
        },
        Argument {
            name: "limit",
            alias: None,
            kind: ANY_INTEGER,
            required: false,
            unit: "posts",
            description: "maximum number, {limits.get_social_posts_default_limit} if left out; 0 for none, a negative number for all",
        },
    ],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &[],
    result_fields: &[
        ResultField {
            name: "posts",
            kind: "list of {post_id, day, content, reply_to_agent_post_id, source_group_id, group_id, customer_type, custom_name, persona_name, replying_to_your_post}",
            description: "group of the author; the press writes as S1; the last field is present only on comments on \
                  your posts",
        },
        TOTAL_FIELD,
    ],
    example: r#"{"limit": 1}"#,
};

/// The maximum number of posts that a call returns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PostLimit {
    /// The limit that the parameters define.
    Default,
    /// At most this number of posts.
    Newest(usize),
    /// All posts.
    All,
}

/// Posts of other authors, newest first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SocialPosts {
    /// Returned posts, newest first.
    pub posts: Vec<SocialPost>,
    /// Number of returned posts; absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub total: Option<usize>,
}

/// A post of an author other than the player.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SocialPost {
    /// Number of the post, which is unique in the run.
    pub post_id: u32,
    /// Day on which the post was published.
    pub day: u32,
    /// Text of the post.
    pub content: String,
    /// Number of the company's post on which this post comments; `None` for other posts.
    pub reply_to_agent_post_id: Option<u32>,
    /// Author of the post; absent under release 2.
    #[serde(flatten)]
    pub author: Option<PostAuthor>,
    /// Text of the company's post on which this post comments; absent for other posts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub replying_to_your_post: Option<String>,
}

/// The author of a post in the social feed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PostAuthor {
    /// Group whose reaction a comment on the company's post expresses.
    pub source_group_id: Option<Group>,
    /// Group of the author; the press appears as the first group.
    pub group_id: Option<Group>,
    /// `large` for enterprises, `small` for individuals.
    pub customer_type: &'static str,
    /// Always empty, as in the released simulator.
    pub custom_name: Option<String>,
    /// Name of the author's profile; `None` for authors without a name.
    pub persona_name: Option<Cow<'static, str>>,
}

impl Tool for GetSocialPosts {
    type Args = PostLimit;
    type Answer = SocialPosts;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, arguments: &Arguments) -> Result<PostLimit, Rejection> {
        let number = |name| {
            arguments.parse_argument(name, |value, name| {
                json_i64(value).ok_or_else(|| wrong_type_rejection(name, "a whole number"))
            })
        };
        number("days")?;
        Ok(match number("limit")? {
            None => PostLimit::Default,
            Some(limit) => usize::try_from(limit).map_or(PostLimit::All, PostLimit::Newest),
        })
    }

    fn plan(&self, view: &ToolContext<'_>, limit: PostLimit) -> Result<PlannedCall<SocialPosts>, Rejection> {
        let limit = match limit {
            PostLimit::Default => {
                usize::try_from(view.params().limits.get_social_posts_default_limit).unwrap_or(usize::MAX)
            }
            PostLimit::Newest(limit) => limit,
            PostLimit::All => usize::MAX,
        };
        let newest = view.posts().iter().rev().take(limit);
        let posts: Vec<SocialPost> = newest.map(|post| to_social_post(post, view)).collect();
        let total = (!posts.is_empty()).then_some(posts.len());
        Ok(PlannedCall::read_only(SocialPosts { posts, total }))
    }
}

fn to_social_post(post: &PublicPost, view: &ToolContext<'_>) -> SocialPost {
    let own_posts = &view.world().market.social.own;
    let answered = post.own_post.and_then(|number| own_posts.get(number as usize - 1));
    SocialPost {
        post_id: post.post,
        day: post.day,
        content: post.content.clone(),
        reply_to_agent_post_id: post.own_post,
        author: match view.params().fidelity.interface {
            Interface::Release1 => Some(author(post)),
            Interface::Release2 => None,
        },
        replying_to_your_post: answered.map(|answered_post| answered_post.content.clone()),
    }
}

fn author(post: &PublicPost) -> PostAuthor {
    // The press appears as an individual of the first group.
    let group = post.written_by.or_else(|| Group::at(0));
    let company = group.is_some_and(Group::is_enterprise);
    PostAuthor {
        source_group_id: post.source_group,
        group_id: group,
        customer_type: if company { "large" } else { "small" },
        custom_name: None,
        persona_name: post.profile.clone(),
    }
}
