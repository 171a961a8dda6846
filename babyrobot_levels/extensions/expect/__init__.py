"""Facts about levels, written into their files."""
