"""Levels in words: their rules, their goal, and descriptions of their pictures."""
