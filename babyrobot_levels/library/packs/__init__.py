"""Packs: levels, suites and themes in one file, which are installed atomically."""
