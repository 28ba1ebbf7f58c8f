//! R&D projects (`docs/mechanics/product/research.md`).

use super::Product;
use crate::events::{Facts, Notice, Project, ResearchChange};
use crate::params::{Development, Params, ResearchTier};
use crate::random::{Part, Streams};

/// Returns the duration of a project in whole days, at least 30. `z` is a standard normal draw.
pub fn project_duration(tier: &ResearchTier, z: f64, development: &Development) -> u32 {
    let drawn = (tier.mean_days + tier.std_days * z).trunc();
    drawn.max(f64::from(development.rd_min_duration_days)) as u32
}

/// Returns the quality gain of a project, at least 0.001. `z` is a standard normal draw.
pub fn project_boost(tier: &ResearchTier, z: f64, development: &Development) -> f64 {
    (tier.mean_quality_boost + tier.std_quality_boost * z).max(development.rd_min_quality_boost)
}

/// Returns the project that would be started on `day`. Duration and gain depend only on the seed, the tier and the
/// number of earlier starts in the tier.
pub fn draw_project(product: &Product, day: u32, tier: u8, params: &Params, streams: &Streams) -> Project {
    let earlier = product.research.iter().filter(|project| project.tier == tier).count() as u32;
    let mut stream = streams.open(Part::Research, [u64::from(tier), u64::from(earlier)]);
    let research_tier = params.research_tier(tier);
    let duration = project_duration(research_tier, stream.standard_normal(), &params.development);
    let boost = project_boost(research_tier, stream.standard_normal(), &params.development);
    Project {
        tier,
        number: earlier + 1,
        started_day: day,
        due_day: day + duration,
        boost,
        completed_day: None,
    }
}

/// Completes due projects. Adds the gain of each project to the product and to the shared quality bank.
pub fn complete_due_projects(day: u32, product: &mut Product, facts: &mut Facts) {
    for project in &mut product.research {
        if project.completed_day.is_none() && project.due_day <= day {
            project.completed_day = Some(day);
            product.shared_bonus += project.boost;
            product.shared_bank += project.boost;
            facts.research.push(ResearchChange::Completed(*project));
            facts.notices.push(Notice::ResearchComplete { tier: project.tier, number: project.number });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn duration_and_gain_follow_the_draw_above_minimum() {
        let params = Params::bundled();
        let (third, development) = (params.research_tier(3), &params.development);
        for (z, days, boost) in [(-3.0, 30, 0.001), (-0.7, 30, 0.0715), (0.5, 38, 0.1375), (2.0, 83, 0.22)] {
            assert_eq!(project_duration(third, z, development), days);
            assert!((project_boost(third, z, development) - boost).abs() < 1e-12);
        }
        assert_eq!(project_duration(params.research_tier(1), 2.0, development), 36);
        assert!((project_boost(params.research_tier(1), 2.0, development) - 0.08).abs() < 1e-12);
        assert_eq!(project_duration(params.research_tier(20), 0.5, development), 1027);
        assert!((project_boost(params.research_tier(20), 0.5, development) - 11.2).abs() < 1e-12);
    }

    #[test]
    fn project_takes_effect_on_its_due_day() {
        let params = Params::bundled();
        let mut product = Product::initial(&params);
        let mut facts = Facts::default();
        let project =
            Project { tier: 3, number: 1, started_day: 10, due_day: 48, boost: 0.1375, completed_day: None };
        product.research.push(project);
        complete_due_projects(47, &mut product, &mut facts);
        assert_eq!((product.shared_bonus, facts.notices.len()), (0.0, 0));
        complete_due_projects(48, &mut product, &mut facts);
        assert_eq!((product.shared_bonus, product.shared_bank), (0.1375, 0.1375));
        complete_due_projects(49, &mut product, &mut facts);
        assert_eq!(product.shared_bonus, 0.1375);
        assert_eq!(facts.notices, [Notice::ResearchComplete { tier: 3, number: 1 }]);
    }

    #[test]
    fn project_depends_only_on_seed_tier_and_number() {
        let params = Params::bundled();
        let start_at = |day| {
            let mut product = Product::initial(&params);
            let streams = Streams::new(5);
            let first = draw_project(&product, day, 4, &params, &streams);
            product.research.push(first);
            let second = draw_project(&product, day, 4, &params, &streams);
            (first.due_day - day, first.boost, second.due_day - day, second.boost, second.id())
        };
        assert_eq!(start_at(0), start_at(77));
        assert_eq!(start_at(0).4, "t4_2");
    }

    #[test]
    fn projects_match_the_moments_of_their_tier() {
        let params = Params::bundled();
        for (tier, thirty, days, gain) in [(1, 0.943327, 30.3192, 0.040194), (5, 0.424790, 59.3417, 0.220957)]
        {
            let product = Product::initial(&params);
            let drawn: Vec<Project> =
                (0..4000).map(|seed| draw_project(&product, 0, tier, &params, &Streams::new(seed))).collect();
            let mean = |value: fn(&Project) -> f64| drawn.iter().map(value).sum::<f64>() / 4000.0;
            assert!((mean(|p| f64::from(u8::from(p.due_day == 30))) - thirty).abs() < 0.025);
            assert!((mean(|p| f64::from(p.due_day)) / days - 1.0).abs() < 0.03);
            assert!((mean(|p| p.boost) / gain - 1.0).abs() < 0.03);
        }
    }
}
