"""Packs: levels, suites and themes that travel together, as one file, and are installed whole."""
