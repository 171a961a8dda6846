"""Levels as games of ARC-AGI-3's engine."""
