"""Scores of agents against the exact optimum of each level."""
