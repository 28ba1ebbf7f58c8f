-- R&D projects, the newest first.
SELECT project_id, tier, status, started_day, expected_completion_day, expected_quality_boost
FROM research_projects
ORDER BY started_day DESC, project_id DESC
