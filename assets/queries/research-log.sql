-- title: R&D log
-- what: Projects in order: day of payment, day of completion, and added quality.
-- chart: bar project quality_expected
SELECT project_id AS project, tier, status, started_day, expected_completion_day AS done_on_day,
    expected_completion_day - started_day AS days, expected_quality_boost AS quality_expected,
    quality_boost_applied AS quality_added
FROM research_projects
ORDER BY started_day, project_id
