"""Levels played in a terminal."""
