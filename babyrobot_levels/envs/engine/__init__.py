"""Stepping many environments at once: flat tables, and engines with the same results."""
