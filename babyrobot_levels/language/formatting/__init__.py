"""Level files in their canonical form: each in one form, comments kept."""
