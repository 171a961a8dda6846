"""GIF files: frames that differ in patches from one picture, in at most 256 colours."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

if TYPE_CHECKING:
    from numpy.typing import NDArray

_COLORS, _EXACT = 256, 160
"""The colours of a film, and how many of these are taken as they are, the most frequent ones."""


@dataclass(frozen=True, slots=True)
class Patch:
    """A part of a frame that is not ground: its top-left corner, and uint8 `[height, width, 3]`."""

    left: int
    top: int
    pixels: NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Frame:
    """A frame: what lies on the ground, and how many milliseconds it is shown."""

    patches: tuple[Patch, ...]
    time: int


def encoded(ground: NDArray[np.uint8], frames: Sequence[Frame]) -> bytes:
    """Return frames as a GIF file that plays for ever, without dithering.

    Args:
        ground: what all frames have in common, uint8 `[height, width, 3]`.
        frames: at least one frame.
    """
    patches = {id(patch): patch for frame in frames for patch in frame.patches}
    packed = {key: _packed(patch.pixels) for key, patch in patches.items()}
    everything = [_packed(ground).ravel(), *(pixels.ravel() for pixels in packed.values())]
    colors, counts = np.unique(np.concatenate(everything), return_counts=True)
    palette = _palette(colors, counts)
    number = _nearest(colors, palette)

    def indexed(pixels: NDArray[np.int32]) -> NDArray[np.uint8]:
        return number[np.searchsorted(colors, pixels)]

    base = indexed(_packed(ground))
    parts = {key: indexed(pixels) for key, pixels in packed.items()}
    images = []
    for frame in frames:
        pixels = base.copy()
        for patch in frame.patches:
            part = parts[id(patch)]
            height, width = part.shape
            pixels[patch.top : patch.top + height, patch.left : patch.left + width] = part
        image = Image.fromarray(pixels)
        image.putpalette(_unpacked(palette).astype(np.uint8).tobytes())
        images.append(image)
    buffer = io.BytesIO()
    times = [frame.time for frame in frames]
    images[0].save(
        buffer,
        "GIF",
        save_all=True,
        append_images=images[1:],
        duration=times,
        loop=0,
        disposal=1,
        optimize=True,
    )
    return buffer.getvalue()


def _packed(pixels: NDArray[np.uint8]) -> NDArray[np.int32]:
    """Return pixels as one number each."""
    numbers = pixels.astype(np.int32)
    return numbers[..., 0] << 16 | numbers[..., 1] << 8 | numbers[..., 2]


def _unpacked(colors: NDArray[np.int32]) -> NDArray[np.int32]:
    return np.stack([colors >> 16, colors >> 8 & 255, colors & 255], axis=-1)


def _palette(colors: NDArray[np.int32], counts: NDArray[np.intp]) -> NDArray[np.int32]:
    """Return at most 256 colours: the most frequent ones, and what the others come to."""
    if colors.size <= _COLORS:
        return colors
    order = np.argsort(-counts, kind="stable")
    rest = np.sort(colors[order[_EXACT:]])
    image = Image.fromarray(_unpacked(rest).astype(np.uint8)[np.newaxis])
    reduced = image.quantize(_COLORS - _EXACT, Image.Quantize.MEDIANCUT)
    others = np.array(reduced.getpalette("RGB"), np.uint8).reshape(-1, 3)
    return np.concatenate([colors[order[:_EXACT]], _packed(others)])


def _nearest(colors: NDArray[np.int32], palette: NDArray[np.int32]) -> NDArray[np.uint8]:
    """Return the number of the nearest colour of the palette, for each colour."""
    wanted, there = _unpacked(colors), _unpacked(palette)
    distance = np.zeros((colors.size, palette.size), np.int32)
    for channel in range(3):
        distance += (wanted[:, channel, None] - there[:, channel]) ** 2
    nearest: NDArray[np.intp] = distance.argmin(axis=1)
    return nearest.astype(np.uint8)
