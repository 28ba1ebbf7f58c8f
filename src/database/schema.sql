-- The tables of the observable company. Values are stored as codes. Ordinary views convert the codes to words, so that any
-- SQLite tool can open the file. Large tables that are read far more often than changed (daily_usage, ads_revenue, issues,
-- ledger, notifications) are packed by day, and the program serves their rows.
--
-- Values that depend on a single row are generated columns. Generated columns take no space, have a declared type, and can
-- be used in joins. The engine computes generated columns for every written row, so views compute expensive values and
-- values that need another table. In views, CAST gives a value its type: without a type, numbers and texts are never equal.

CREATE TABLE projection (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    seq INTEGER NOT NULL,
    line_hash TEXT NOT NULL,
    own_check TEXT NOT NULL
);

-- Words of customer profiles by group and axis.
CREATE TABLE words (
    axis TEXT NOT NULL,
    group_id TEXT NOT NULL,
    n INTEGER NOT NULL,
    word TEXT NOT NULL,
    PRIMARY KEY (axis, group_id, n)
) WITHOUT ROWID;

-- The column persona packs one byte per axis: industry, role, experience, work style, technical skill, size, decision, concern.
CREATE TABLE customer_rows (
    customer_id INTEGER PRIMARY KEY,
    group_id TEXT NOT NULL,
    created_day INTEGER NOT NULL,
    source INTEGER,
    persona INTEGER,
    usage_label INTEGER,
    budget_label INTEGER,
    seats INTEGER,
    email TEXT,
    contract_start_day INTEGER,
    acquisition_source TEXT AS (CASE source
        WHEN 0 THEN 'social_media' WHEN 1 THEN 'search_ads' WHEN 2 THEN 'linkedin' WHEN 3 THEN 'content_marketing'
        WHEN 4 THEN 'referral_program' WHEN 5 THEN 'network' WHEN 6 THEN 'organic'
    END)
);

CREATE VIEW customers AS
SELECT
    customer_id,
    CAST(CASE WHEN group_id LIKE 'E%' OR group_id LIKE 'D_E%' THEN 'large' ELSE 'small' END AS TEXT) AS customer_type,
    group_id,
    created_day,
    (SELECT word FROM words WHERE axis = 'industry' AND group_id = customers.group_id AND n = (persona & 255))
        AS persona_industry,
    (SELECT word FROM words WHERE axis = 'role' AND group_id = customers.group_id AND n = (persona >> 8 & 255))
        AS persona_role,
    (SELECT word FROM words WHERE axis = 'experience' AND group_id = customers.group_id AND n = (persona >> 16 & 255))
        AS persona_experience,
    (SELECT word FROM words WHERE axis = 'work_style' AND group_id = customers.group_id AND n = (persona >> 24 & 255))
        AS persona_work_style,
    (SELECT word FROM words WHERE axis = 'tech_savvy' AND group_id = customers.group_id AND n = (persona >> 32 & 255))
        AS persona_tech_savvy,
    (SELECT word FROM words WHERE axis = 'size' AND group_id = customers.group_id AND n = (persona >> 40 & 255))
        AS company_size_descriptor,
    CAST(CASE WHEN email IS NOT NULL THEN
        (SELECT word FROM words
            WHERE axis = 'work_style' AND group_id = customers.group_id AND n = (persona >> 24 & 255))
    END AS TEXT) AS company_culture,
    (SELECT word FROM words WHERE axis = 'decision' AND group_id = customers.group_id AND n = (persona >> 48 & 255))
        AS company_decision_style,
    (SELECT word FROM words WHERE axis = 'concern' AND group_id = customers.group_id AND n = (persona >> 56 & 255))
        AS company_primary_concern,
    CAST(CASE WHEN persona IS NULL THEN NULL WHEN email IS NULL THEN
        (SELECT word FROM words
            WHERE axis = 'experience' AND group_id = customers.group_id AND n = (persona >> 16 & 255))
        || ' ' ||
        (SELECT word FROM words WHERE axis = 'role' AND group_id = customers.group_id AND n = (persona >> 8 & 255))
        || ' in ' ||
        (SELECT word FROM words WHERE axis = 'industry' AND group_id = customers.group_id AND n = (persona & 255))
        || '; ' || (SELECT word FROM words WHERE axis = 'usage' AND group_id = customers.group_id AND n = usage_label)
        || ', ' || (SELECT word FROM words WHERE axis = 'budget' AND group_id = customers.group_id AND n = budget_label)
        || ', ' || (SELECT word FROM words WHERE axis = 'quality' AND group_id = customers.group_id AND n = 0)
    ELSE
        (SELECT word FROM words WHERE axis = 'size' AND group_id = customers.group_id AND n = (persona >> 40 & 255))
        || ' ' ||
        (SELECT word FROM words WHERE axis = 'industry' AND group_id = customers.group_id AND n = (persona & 255))
        || ' company with ' || seats
        || (SELECT CASE WHEN seats >= n THEN '+' ELSE '' END FROM words
            WHERE axis = 'plus' AND group_id = customers.group_id)
        || ' seats, '
        || (SELECT word FROM words
            WHERE axis = 'work_style' AND group_id = customers.group_id AND n = (persona >> 24 & 255))
        || '; ' || (SELECT word FROM words WHERE axis = 'quality' AND group_id = customers.group_id AND n = 0)
        || ', concerned with '
        || (SELECT word FROM words
            WHERE axis = 'concern' AND group_id = customers.group_id AND n = (persona >> 56 & 255))
    END AS TEXT) AS persona_description,
    email,
    contract_start_day,
    acquisition_source
FROM customer_rows customers;

-- A customer has at most one subscription, so the customer number is the key.
-- Values of state: 0 lead, 1 subscribed, 2 cancelled, 3 lost.
CREATE TABLE subscription_rows (
    customer_id INTEGER PRIMARY KEY,
    subscription_id INTEGER NOT NULL,
    plan TEXT NOT NULL,
    listed_price REAL NOT NULL,
    promotion REAL NOT NULL,
    start_day INTEGER NOT NULL,
    end_day INTEGER,
    state INTEGER NOT NULL,
    billing_day INTEGER NOT NULL,
    seats INTEGER NOT NULL,
    contract_end_day INTEGER,
    billed_once INTEGER NOT NULL,
    effective_price REAL AS (max(0.0, listed_price - promotion)),
    status TEXT AS (CASE state WHEN 0 THEN 'lead' WHEN 1 THEN 'subscribed' WHEN 2 THEN 'cancelled' ELSE 'lost' END)
);

CREATE VIEW subscriptions AS
SELECT
    subscription_id,
    customer_id,
    plan,
    listed_price,
    promotion,
    effective_price,
    start_day,
    end_day,
    status,
    billing_day AS billing_day_mod30,
    CAST(NULL AS TEXT) AS pending_plan,
    CAST(NULL AS REAL) AS pending_price,
    seats AS seat_count,
    CAST(1 AS INTEGER) AS contract_months,
    contract_end_day,
    billed_once AS first_billing_done
FROM subscription_rows;

-- Packed days of the ledger, packed issues by opening day, and the value of the issue clock after each day.
CREATE TABLE ledger_blocks (day INTEGER PRIMARY KEY, packed BLOB NOT NULL);
CREATE TABLE issue_blocks (day INTEGER PRIMARY KEY, packed BLOB NOT NULL);
CREATE TABLE issue_clock (day INTEGER PRIMARY KEY, aged INTEGER NOT NULL);

CREATE TABLE service_day (
    day INTEGER PRIMARY KEY,
    total_usage_units INTEGER NOT NULL,
    p95_ms REAL NOT NULL,
    error_rate REAL NOT NULL,
    downtime_minutes INTEGER NOT NULL,
    capacity_tier INTEGER NOT NULL,
    capacity_units INTEGER NOT NULL
);

CREATE TABLE config_history (
    day INTEGER PRIMARY KEY,
    price_A REAL NOT NULL,
    price_B REAL NOT NULL,
    price_C REAL NOT NULL,
    tier_A INTEGER NOT NULL,
    tier_B INTEGER NOT NULL,
    tier_C INTEGER NOT NULL,
    spend_advertising REAL NOT NULL DEFAULT 0,
    spend_operations REAL NOT NULL,
    spend_development REAL NOT NULL,
    capacity_tier INTEGER NOT NULL,
    ad_spend_social_media REAL NOT NULL DEFAULT 0,
    ad_spend_search_ads REAL NOT NULL DEFAULT 0,
    ad_spend_linkedin REAL NOT NULL DEFAULT 0,
    ad_spend_content_marketing REAL NOT NULL DEFAULT 0,
    ad_spend_referral_program REAL NOT NULL DEFAULT 0,
    quota_A INTEGER NOT NULL,
    quota_B INTEGER NOT NULL,
    quota_C INTEGER NOT NULL
);

CREATE TABLE config_overrides (
    id INTEGER PRIMARY KEY,
    day INTEGER NOT NULL,
    tool_name TEXT NOT NULL,
    setting_type TEXT NOT NULL,
    settings_json TEXT NOT NULL
);

CREATE TABLE social_media_posts (
    post_id INTEGER PRIMARY KEY,
    day INTEGER NOT NULL,
    content TEXT NOT NULL,
    reply_to_agent_post_id INTEGER
);

CREATE TABLE agent_social_media_posts (
    agent_post_id INTEGER PRIMARY KEY,
    day INTEGER NOT NULL,
    content TEXT NOT NULL,
    reply_to_post_id INTEGER,
    views INTEGER NOT NULL DEFAULT 0,
    comment_post_ids TEXT NOT NULL DEFAULT '[]'
);

CREATE TABLE predictions (
    submit_day INTEGER NOT NULL,
    horizon_days INTEGER NOT NULL,
    metric TEXT NOT NULL,
    predicted_value REAL NOT NULL,
    predicted_lower REAL,
    predicted_upper REAL,
    submitted_at REAL NOT NULL,
    PRIMARY KEY (submit_day, horizon_days, metric)
);

CREATE TABLE enterprise_turns (
    message_id INTEGER PRIMARY KEY,
    thread_id INTEGER NOT NULL,
    customer_id INTEGER NOT NULL,
    thread_type TEXT NOT NULL,
    turn_number INTEGER NOT NULL DEFAULT 0,
    sender TEXT NOT NULL,
    message_text TEXT NOT NULL DEFAULT '',
    offer_json TEXT NOT NULL DEFAULT '{}',
    day INTEGER NOT NULL,
    email TEXT NOT NULL DEFAULT '',
    seat_count INTEGER NOT NULL DEFAULT 1,
    closed INTEGER NOT NULL DEFAULT 0,
    close_reason TEXT NOT NULL DEFAULT ''
);
CREATE INDEX enterprise_turns_by_thread ON enterprise_turns (thread_id);
CREATE INDEX enterprise_turns_by_customer ON enterprise_turns (customer_id);

-- Packed days of notifications without the repeated losses. The number of a repeated loss is its position in the list.
CREATE TABLE notice_blocks (day INTEGER PRIMARY KEY, packed BLOB NOT NULL);
CREATE TABLE repeated_losses (
    number INTEGER PRIMARY KEY,
    customer_id INTEGER NOT NULL,
    message_day INTEGER NOT NULL,
    cause INTEGER NOT NULL
);

CREATE TABLE research_projects (
    project_id TEXT PRIMARY KEY,
    tier INTEGER NOT NULL,
    status TEXT DEFAULT 'in_progress',
    started_day INTEGER,
    expected_completion_day INTEGER,
    expected_quality_boost REAL DEFAULT 0,
    quality_boost_applied REAL DEFAULT 0
);

CREATE TABLE macroeconomic_conditions (
    day INTEGER PRIMARY KEY,
    pmi_value REAL NOT NULL,
    pmi_trend TEXT NOT NULL,
    pmi_change REAL NOT NULL DEFAULT 0,
    cycle_phase TEXT NOT NULL,
    description TEXT NOT NULL
);

CREATE TABLE ad_channel_leads (
    id INTEGER PRIMARY KEY,
    day INTEGER NOT NULL,
    channel_id TEXT NOT NULL,
    group_id TEXT NOT NULL,
    leads_generated INTEGER NOT NULL,
    spend REAL NOT NULL
);

CREATE TABLE group_info_levels (
    group_id TEXT PRIMARY KEY,
    info_level INTEGER NOT NULL DEFAULT 0,
    is_discoverable INTEGER NOT NULL DEFAULT 0,
    discovered_day INTEGER,
    last_research_day INTEGER
);

CREATE TABLE segment_discovery (
    id INTEGER PRIMARY KEY,
    day INTEGER NOT NULL,
    cost REAL NOT NULL,
    success INTEGER NOT NULL DEFAULT 0,
    discovered_group_id TEXT
);

-- Packed days of daily_usage and ads_revenue.
CREATE TABLE usage_blocks (day INTEGER PRIMARY KEY, packed BLOB NOT NULL);
CREATE TABLE ads_blocks (day INTEGER PRIMARY KEY, packed BLOB NOT NULL);

-- Statistics of a large company for the query planner: number of rows of a table, and number of rows per index value.
-- Queries of a small company are fast with any plan.
ANALYZE;
INSERT INTO sqlite_stat1 (tbl, idx, stat) VALUES
    ('words', 'words', '1500 150 6 1'),
    ('customer_rows', NULL, '500000'),
    ('subscription_rows', NULL, '500000'),
    ('service_day', NULL, '500'),
    ('config_history', NULL, '50'),
    ('config_overrides', NULL, '100'),
    ('social_media_posts', NULL, '1000'),
    ('agent_social_media_posts', NULL, '70'),
    ('predictions', 'sqlite_autoindex_predictions_1', '290 4 1 1'),
    ('enterprise_turns', 'enterprise_turns_by_thread', '5000 4'),
    ('enterprise_turns', 'enterprise_turns_by_customer', '5000 5'),
    ('research_projects', 'sqlite_autoindex_research_projects_1', '20 1'),
    ('macroeconomic_conditions', NULL, '16'),
    ('ad_channel_leads', NULL, '5000'),
    ('group_info_levels', 'sqlite_autoindex_group_info_levels_1', '26 1'),
    ('segment_discovery', NULL, '30');
