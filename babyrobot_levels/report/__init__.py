"""Diagnostics as output: one format a file."""
