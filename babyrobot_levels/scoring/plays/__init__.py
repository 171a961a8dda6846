"""Plays: episodes as files, verified without any generator."""
