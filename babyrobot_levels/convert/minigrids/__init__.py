"""Grids of MiniGrid: its environments and its text."""
