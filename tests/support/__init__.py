"""What several test modules share: random worlds, and the rules of the language once more."""
