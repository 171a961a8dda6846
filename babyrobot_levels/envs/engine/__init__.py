"""Stepping many environments at once: flat tables, and two engines with the same results."""
