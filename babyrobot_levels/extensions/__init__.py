"""What can be done with levels beyond the core: a folder each, which stands alone."""
