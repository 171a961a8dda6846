"""Levels as users hold them, and where they are found: the gallery, folders and packs."""
