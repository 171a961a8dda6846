"""Worlds of other programs: reading them as levels, and writing levels in their formats."""
