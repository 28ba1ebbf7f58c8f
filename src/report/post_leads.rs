//! Number of leads by group in the weeks before and after a post. Visible data does not show which leads the post
//! caused.

use super::formatting::format_whole;
use novamind_session::GroupWeek;
use novamind_session::identifiers::{ByGroup, Group};

/// Describes the number of leads in the weeks before and after a decision day. Returns no lines if no week has run
/// after this day.
pub fn lead_lines_around(day: u32, weeks: &[ByGroup<GroupWeek>], known: &[Group]) -> Vec<String> {
    let after = day as usize / 7;
    let Some(later) = weeks.get(after).filter(|_| day.is_multiple_of(7)) else { return Vec::new() };
    let before = after.checked_sub(1).and_then(|at| weeks.get(at));
    let count = |week: &ByGroup<GroupWeek>, group: Group| format_whole(f64::from(week[group].leads));
    let texts: Vec<String> = known
        .iter()
        .map(|group| {
            let earlier = before.map_or("–".to_owned(), |week| count(week, *group));
            format!("{group} {earlier} → {}", count(later, *group))
        })
        .collect();
    vec![
        format!("Leads in the week before → in the week after: {}", texts.join(", ")),
        "Other changes in these weeks also affect the counts.".to_owned(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::play_weeks;
    use novamind_database::number_at;

    #[test]
    fn lead_lines_count_leads_before_and_after_the_day() {
        let mut session = play_weeks(4);
        let known = session.company().observe().known_groups;
        let texts = lead_lines_around(14, session.company().group_weeks(), &known);
        let mut leads = |from: u32| {
            let sql = format!(
                "SELECT count(*) FROM customers WHERE group_id = 'S1' AND created_day > {from} AND created_day <= {from} + 7"
            );
            format_whole(number_at(&session.query(&sql).expect("a count").rows[0], 0))
        };
        let expected = format!("S1 {} → {}", leads(7), leads(14));
        assert!(texts[0].contains(&expected), "{texts:?} without {expected}");
        let first = lead_lines_around(0, session.company().group_weeks(), &known);
        assert!(first[0].contains("S1 – → "), "{first:?}");
        assert!(
            lead_lines_around(28, session.company().group_weeks(), &known).is_empty(),
            "no week has run since"
        );
    }
}
