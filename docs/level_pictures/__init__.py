"""The levels in the documentation, each beside its picture on the site."""
