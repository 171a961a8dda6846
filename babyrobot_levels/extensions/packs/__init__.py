"""Packs: folders of levels as one file, which is built, installed and removed."""
