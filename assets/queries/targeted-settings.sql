-- title: Targeted settings over time
-- what: Discounts, in-app ads and targeted budgets: all values after each call, newest first.
SELECT day, setting_type, tool_name, settings_json
FROM config_overrides
ORDER BY id DESC
LIMIT 1000
