"""Vector environments: many environments that step in one call."""
