"""What the editor tells of a level beside its text and picture."""
