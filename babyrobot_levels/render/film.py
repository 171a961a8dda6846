"""Pictures that let shine through what they are laid on: ink, and a share of the ground."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Film = tuple[NDArray[np.uint8], NDArray[np.uint8]]
    """The ink, and how much of the ground is seen, of 255; each `[height, width, channels]`."""


def film_of(painted: Callable[[str], NDArray[np.uint8]]) -> Film:
    """Return a film of what is painted on a ground: on black and on white, and what differs.

    Args:
        painted: returns the picture on the ground of a colour.
    """
    ink = painted("black")
    return ink, painted("white") - ink


def laid(film: Film, ground: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return what is seen where a film lies on a ground, as far as the ground reaches."""
    height, width = ground.shape[:2]
    ink, through = (part[:height, :width] for part in film)
    seen = (ground.astype(np.uint16) * through + 127) // 255
    return ink + seen.astype(np.uint8)
