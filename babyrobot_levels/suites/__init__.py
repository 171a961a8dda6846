"""Suites: many levels as one, given by a file, listed or generated."""
