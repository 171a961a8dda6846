"""Environments that play compiled levels: the only users of Gymnasium."""
