//! Identifiers that all crates share: groups, plans and channels.
//!
//! Identifiers contain no simulator behavior, so the console, policies and tools can use them without depending on the
//! simulator (`docs/architecture.md`).

use std::fmt;
use std::ops::{Index, IndexMut};

use serde::{Deserialize, Serialize};

/// One of the 26 customer groups, stored as its position in the fixed group order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Group(u8);

const GROUP_IDS: [&str; Group::COUNT] = [
    "S1", "S2", "S3", "E1", "E2", "E3", "D_S01", "D_S02", "D_S03", "D_S04", "D_S05", "D_S06", "D_S07",
    "D_S08", "D_S09", "D_S10", "D_E01", "D_E02", "D_E03", "D_E04", "D_E05", "D_E06", "D_E07", "D_E08",
    "D_E09", "D_E10",
];

impl Group {
    /// Number of customer groups.
    pub const COUNT: usize = 26;

    /// Returns all groups in their fixed order: S1 S2 S3 E1 E2 E3 D_S01..D_S10 D_E01..D_E10.
    pub fn all() -> impl DoubleEndedIterator<Item = Group> + ExactSizeIterator + Clone {
        (0..Self::COUNT as u8).map(Group)
    }

    /// Returns the group at a position of the fixed order, or `None` if the position is out of range.
    pub fn at(position: usize) -> Option<Group> {
        (position < Self::COUNT).then_some(Group(position as u8))
    }

    /// Returns the group with this identifier, which is case-sensitive.
    pub fn parse(id: &str) -> Option<Group> {
        GROUP_IDS.iter().position(|known| *known == id).and_then(Group::at)
    }

    /// Returns the identifier that tools and tables use for the group.
    pub fn id(self) -> &'static str {
        GROUP_IDS[self.index()]
    }

    /// Returns the position in the fixed group order, 0..26.
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// Returns whether the group consists of enterprises, which negotiate. Individuals do not negotiate.
    #[inline]
    pub fn is_enterprise(self) -> bool {
        matches!(self.0, 3..=5 | 16..=25)
    }

    /// Returns whether the group is one of the six groups that are known from day 0. Other groups have to be
    /// discovered.
    pub fn is_initially_known(self) -> bool {
        self.0 < 6
    }
}

impl fmt::Display for Group {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.id())
    }
}

/// One of the three plans on sale, in evaluation order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Plan {
    /// Plan A, the first plan in every comparison.
    A,
    /// Plan B, the second plan.
    B,
    /// Plan C, the third plan.
    C,
}

impl Plan {
    /// All plans in evaluation order.
    pub const ALL: [Plan; 3] = [Plan::A, Plan::B, Plan::C];

    /// Returns the plan with this letter, which is case-sensitive.
    pub fn parse(id: &str) -> Option<Plan> {
        Plan::ALL.into_iter().find(|plan| plan.id() == id)
    }

    /// Returns the letter of the plan, which is its identifier.
    pub fn id(self) -> &'static str {
        ["A", "B", "C"][self.index()]
    }

    /// Returns the position in evaluation order, 0..3.
    #[inline]
    pub fn index(self) -> usize {
        self as usize
    }

    /// Returns the plan at a position in the evaluation order.
    pub fn at(position: usize) -> Option<Plan> {
        Plan::ALL.get(position).copied()
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.id())
    }
}

/// One of the five advertising channels, in channel order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Channel {
    /// Paid feeds of consumer networks.
    SocialMedia,
    /// Paid results in web search.
    SearchAds,
    /// Ads on the business network.
    Linkedin,
    /// Articles and guides by the company.
    ContentMarketing,
    /// Rewards for customers who recommend the company.
    ReferralProgram,
}

impl Channel {
    /// All channels in channel order.
    pub const ALL: [Channel; 5] = [
        Channel::SocialMedia,
        Channel::SearchAds,
        Channel::Linkedin,
        Channel::ContentMarketing,
        Channel::ReferralProgram,
    ];

    /// Returns the channel with this identifier, which is case-sensitive.
    pub fn parse(id: &str) -> Option<Channel> {
        Channel::ALL.into_iter().find(|channel| channel.id() == id)
    }

    /// Returns the identifier that tools and tables use for the channel.
    pub fn id(self) -> &'static str {
        ["social_media", "search_ads", "linkedin", "content_marketing", "referral_program"][self.index()]
    }

    /// Returns the position in channel order, 0..5.
    #[inline]
    pub fn index(self) -> usize {
        self as usize
    }

    /// Returns the channel at a position of the channel order.
    pub fn at(position: usize) -> Option<Channel> {
        Channel::ALL.get(position).copied()
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.id())
    }
}

macro_rules! serde_by_id {
    ($($kind:ident: $what:literal),*) => {$(
        impl Serialize for $kind {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.id())
            }
        }
        impl<'de> Deserialize<'de> for $kind {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let id = String::deserialize(deserializer)?;
                $kind::parse(&id).ok_or_else(|| serde::de::Error::custom(format!("unknown {} {id}", $what)))
            }
        }
    )*};
}
serde_by_id!(Group: "group", Plan: "plan", Channel: "channel");

macro_rules! table_by {
    ($(#[$doc:meta])* $name:ident, $key:ident, $count:expr) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct $name<T>(pub [T; $count]);

        impl<T> $name<T> {
            /// Computes one value for each key.
            pub fn from_fn(mut value: impl FnMut($key) -> T) -> Self {
                $name(std::array::from_fn(|position| value($key::at(position).expect("position is in range"))))
            }

            /// Iterates over the values in key order.
            pub fn iter(&self) -> std::slice::Iter<'_, T> {
                self.0.iter()
            }

            /// Iterates over keys and values in key order.
            pub fn pairs(&self) -> impl Iterator<Item = ($key, &T)> {
                self.0.iter().enumerate().map(|(at, value)| ($key::at(at).expect("position is in range"), value))
            }
        }

        impl<T: Default> Default for $name<T> {
            fn default() -> Self {
                Self::from_fn(|_| T::default())
            }
        }

        impl<T> Index<$key> for $name<T> {
            type Output = T;
            #[inline]
            fn index(&self, key: $key) -> &T {
                &self.0[key.index()]
            }
        }

        impl<T> IndexMut<$key> for $name<T> {
            #[inline]
            fn index_mut(&mut self, key: $key) -> &mut T {
                &mut self.0[key.index()]
            }
        }
    };
}
table_by!(
    /// One value for each of the 26 groups.
    ByGroup, Group, Group::COUNT
);
table_by!(
    /// One value for each of the three plans.
    ByPlan, Plan, 3
);
table_by!(
    /// One value for each of the five advertising channels.
    ByChannel, Channel, 5
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn group_order_is_fixed() {
        let ids: Vec<_> = Group::all().map(Group::id).collect();
        assert_eq!(ids[..7], ["S1", "S2", "S3", "E1", "E2", "E3", "D_S01"]);
        assert_eq!(ids[25], "D_E10");
        assert!(Group::all().all(|group| Group::parse(group.id()) == Some(group)));
        assert_eq!(Group::parse("s1"), None);
    }

    #[test]
    fn identifier_determines_whether_a_group_is_an_enterprise() {
        for group in Group::all() {
            assert_eq!(group.is_enterprise(), group.id().trim_start_matches("D_").starts_with('E'));
            assert_eq!(group.is_initially_known(), !group.id().starts_with("D_"));
        }
    }

    #[test]
    fn plans_and_channels_round_trip() {
        assert!(Plan::ALL.into_iter().all(|plan| Plan::parse(plan.id()) == Some(plan)));
        assert!(Channel::ALL.into_iter().all(|channel| Channel::parse(channel.id()) == Some(channel)));
        assert_eq!(Channel::parse("content_marketing").map(Channel::index), Some(3));
    }
}
