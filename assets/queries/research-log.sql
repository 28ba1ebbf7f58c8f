-- title: R&D log
-- what: Projects in their order: when they were paid, when they are done, and the quality they add.
-- chart: bar project quality_expected
SELECT project_id AS project, tier, status, started_day, expected_completion_day AS done_on_day,
    expected_completion_day - started_day AS days, expected_quality_boost AS quality_expected,
    quality_boost_applied AS quality_added
FROM research_projects
ORDER BY started_day, project_id
