"""Pictures as data: a level, its theme and a state become a flat list of shapes."""
