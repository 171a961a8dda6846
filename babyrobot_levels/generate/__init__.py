"""Generating levels: suites, batches of files, and the templates of `babyrobot new-level`."""
