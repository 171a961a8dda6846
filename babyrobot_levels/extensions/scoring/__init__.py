"""Scores of agents against the exact optimum, and grades of what is handed in."""
