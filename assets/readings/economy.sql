-- The published index of the economy by the day of its measurement.
SELECT day, pmi_value, pmi_trend, pmi_change, cycle_phase, description
FROM macroeconomic_conditions
ORDER BY day
