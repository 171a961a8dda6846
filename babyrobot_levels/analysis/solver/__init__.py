"""Exact answers about a level: the best policy, what a given policy is worth, and trial runs."""
