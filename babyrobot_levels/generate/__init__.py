"""Levels to order: drawn from a seed, held against conditions, written as files."""
