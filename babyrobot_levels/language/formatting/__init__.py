"""Level files in their canonical form: one way of writing each, comments kept."""
