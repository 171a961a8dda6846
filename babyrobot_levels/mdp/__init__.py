"""From a level's fields to walls and exact tables: mazes, grid, compiler, digest."""
