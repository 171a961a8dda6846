"""What changed between two levels: in the game, and beside it."""
