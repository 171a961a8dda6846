"""What stands where in a level, and which fields it has."""
