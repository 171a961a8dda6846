"""The names by which doors and exits need things."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import count
from typing import Any

from babyrobot_levels.editor.changes.draft import Draft
from babyrobot_levels.editor.changes.sides import Run
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.kinds import NAMED, NEEDED
from babyrobot_levels.language.things import DRAWN_NAMES, as_names
from babyrobot_levels.library.level import Level


def replace_names(draft: Draft, names: Mapping[str, str | None]) -> None:
    """Replace names in what doors and exits need, or remove those that become None.

    A door that is left without any name would always be open: it is removed, too.
    """
    _replace(draft.data, "exit_needs", names)
    for door in [*draft.data.get("doors", ())]:
        # Each of them, so no short cut.
        replaced = [_replace(door, field, names) for field in ("needs", "unless")]
        if any(replaced) and "needs" not in door and "unless" not in door:
            draft.data["doors"].remove(door)
            if draft.canvas is not None:
                draft.canvas.mark(Run.of_entry(door), d.OPEN)


def names_of(level: Level) -> list[str]:
    """Return the names of what doors and exits can need, kind by kind."""
    return [thing.name for kind in NEEDED for thing in kind.of(level)]


def unused_name(draft: Draft, base: str) -> str:
    """Return a name that nothing has yet: `key`, `key-2` and so on."""
    lists = [draft.data.get(kind.field, ()) for kind in NAMED]
    lists.append(draft.data.get("legend", {}).values())
    entries = [entry for entries in lists for entry in entries]
    used = {entry.get(field) for entry in entries for field in ("name", *DRAWN_NAMES)}
    names = (base if number == 1 else f"{base}-{number}" for number in count(1))
    return next(name for name in names if name not in used)


def _replace(entry: dict[str, Any], field: str, names: Mapping[str, str | None]) -> bool:
    """Replace names in a field, and tell whether there were any."""
    before = as_names(entry.get(field, ()))
    replaced = (names.get(name, name) for name in before)
    after = [name for name in replaced if name is not None]
    if [*before] == after:
        return False
    if after:
        entry[field] = after[0] if len(after) == 1 else after
    else:
        del entry[field]
    return True
