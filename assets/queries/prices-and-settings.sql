-- title: Prices, tiers and quotas over time
-- what: Settings by day; a row is valid until the next one.
-- chart: line day price_A price_B price_C
SELECT day, price_A, price_B, price_C, tier_A, tier_B, tier_C, quota_A, quota_B, quota_C, capacity_tier,
    spend_operations, spend_development
FROM config_history
ORDER BY 1
