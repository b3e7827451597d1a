"""Scene of one environment: geometry queries, appearance overrides and surface attributes."""
