"""Generating single levels: candidates, keys and guards, a search for wanted metrics, templates."""
