"""Worlds from and to other formats: one module a format, `formats` lists and guesses them."""
