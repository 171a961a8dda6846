"""Tiled: maps in JSON (`.tmj`), as its editor and its command line write them.

Starts, exits, puddles and blocked cells are tiles, identified by their class; walls between cells
are polylines of an object layer. All other fields are custom properties of the map, written as in a
level file.
"""
