"""What cannot be formatted without a risk is left as it is."""

from __future__ import annotations


class KeptAsIs(Exception):
    """A text is written in a way that the formatter leaves alone; the message says which."""
