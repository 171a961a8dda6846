"""Many robots in one environment."""
