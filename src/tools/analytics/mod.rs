//! Tools for public posts and for targeted budgets of operations and development.

mod get_social_posts;
mod set_targeted_dev_spend;
mod set_targeted_ops_spend;

pub(crate) use get_social_posts::RELEASE_2_FIELDS;
pub use get_social_posts::{GetSocialPosts, PostAuthor, PostLimit, SocialPost};
pub use set_targeted_dev_spend::SetTargetedDevSpend;
pub use set_targeted_ops_spend::{SetTargetedOpsSpend, with_release_2_text};
