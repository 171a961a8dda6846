"""What gestures do to the fields of a level."""
