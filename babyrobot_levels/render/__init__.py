"""Painters: each makes a picture of a level in its own medium."""
