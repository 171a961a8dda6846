"""Tiled: maps in JSON (`.tmj`), as its editor and its command line write them.

Starts, exits, puddles and blocked cells are tiles, known by their class; walls between cells are
polylines of a layer of objects. Whatever else a level says stands in the map's custom properties,
as it would stand in a level file.
"""
