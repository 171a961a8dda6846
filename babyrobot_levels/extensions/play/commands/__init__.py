"""The command `play`, and its game."""
