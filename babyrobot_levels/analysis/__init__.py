"""What a level is like, in numbers: its shape, its ways, how hard it is."""
