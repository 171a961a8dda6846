"""The seven other images of a level: mirrored and turned."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

CELLS = ("start", "exit", "exit_one_of", "at", "to", "one_of", "path")
RECTANGLES = ("areas", "blocked", "within")


def images(world: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the mirror images and turns of a level without maze and drawing, but not itself."""
    width, height = world.get("size", (3, 3))
    corner = {} if "exit_one_of" in world else {"exit": [width - 1, height - 1]}
    world = {"size": [width, height], "start": [0, 0], **corner, **world}
    for number in range(1, 8):
        # Every other step mirrors it at the diagonal: eight of them lead back.
        world = _image(world, *world["size"], is_transposed=number % 2 == 0)
        yield world


def _image(value: Any, width: int, height: int, *, is_transposed: bool) -> Any:
    """Return a level, or an entry of one, with columns and rows exchanged, or left and right."""
    sides = dict(zip("NESW", "WSEN" if is_transposed else "NWSE", strict=True))

    def cell(at: Any, columns: int = 1) -> list[int]:
        x, y = at
        return [y, x] if is_transposed else [width - x - columns, y]

    def cells(value: Any) -> Any:
        if not isinstance(value, list):
            return value
        return cell(value) if isinstance(value[0], int) else [cell(each) for each in value]

    def image(name: str, value: Any, entry: dict[str, Any]) -> Any:
        if name == "at" and "side" in entry:
            return cell(value, entry.get("length", 1) if entry["side"] in "NS" else 1)
        if name == "at" and isinstance(entry.get("size"), list):
            return cell(value, entry["size"][0])
        if name in CELLS:
            return cells(value)
        if name in ("side", "heading"):
            return sides[value]
        if name == "size" and is_transposed and isinstance(value, list):
            return value[::-1]
        if name == "wind":
            return winds(value)
        if isinstance(value, dict):
            return {each: image(each, of, value) for each, of in value.items()}
        if isinstance(value, list):
            return [image(name, each, entry) for each in value]
        return value

    def winds(value: Any) -> Any:
        names = {"north": "N", "east": "E", "south": "S", "west": "W"}
        letters = {letter: name for name, letter in names.items()}
        chances = {name: of for name, of in value.items() if name not in names}
        return chances | {
            letters[sides[names[side]]]: (
                pushes[::-1] if side in ("north", "south") and not is_transposed else pushes
            )
            for side, pushes in value.items()
            if side in names
        }

    return image("", value, {})
