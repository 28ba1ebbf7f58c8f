-- title: Targeted settings over time
-- what: Discounts, ads and targeted spend: the whole state of a family after each call, the newest first.
SELECT day, setting_type, tool_name, settings_json
FROM config_overrides
ORDER BY id DESC
LIMIT 1000
