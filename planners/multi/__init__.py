"""Multi-robot planning: composite, prioritized, conflict-based."""
