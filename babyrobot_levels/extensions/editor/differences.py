"""What has changed in what the editor shows, so that a reply need not repeat all of it."""

import json
import secrets
from itertools import takewhile
from typing import Any

from babyrobot_levels.text.splice import common_ends


class LastShown:
    """The state of a session that was shown last.

    Each state that is shown has a `number`. Several pages may show a session: a reply has only
    the changes if the one who asks has the state that was shown last.

    Attributes:
        last: that state, of which there is at first the `number` alone.
    """

    def __init__(self) -> None:
        # A page may still have a state of a server that ended: its numbers are others.
        self.last: dict[str, Any] = {"number": secrets.randbits(48)}

    def reply(self, state: dict[str, Any], has: Any) -> dict[str, Any]:
        """Return the part of a reply that shows a state.

        Args:
            state: the state, from now on the last one.
            has: the number of the state that the one who asks has.

        Returns:
            `state`; or `from`, the number of the state that is changed, and `changes`, see
            `changes_of`.
        """
        before = self.last
        self.last = {**state, "number": before["number"] + 1}
        if has != before["number"]:
            return {"state": self.last}
        return {"from": before["number"], "changes": changes_of(before, self.last)}


def changes_of(old: Any, new: Any) -> Any:
    """Return what makes another value of plain data.

    It is one of these:

    - `[value]`: another value;
    - `[first, stop, part]`: in a list or a text, a part instead of that from `first` to before
      `stop`;
    - a mapping: the changes of some fields, or of some entries of a list by their numbers; of a
      field that is gone, `[]`.
    """
    if isinstance(old, dict) and isinstance(new, dict):
        gone: dict[str, Any] = {name: [] for name in old if name not in new}
        added = {name: [value] for name, value in new.items() if name not in old}
        both = {name: value for name, value in new.items() if name in old}
        changed = {
            name: changes_of(old[name], value)
            for name, value in both.items()
            if not _is_same(old[name], value)
        }
        return gone | added | changed
    if isinstance(old, list) and isinstance(new, list):
        others = [n for n, pair in enumerate(zip(old, new, strict=False)) if not _is_same(*pair)]
        if len(old) == len(new) and 2 * len(others) <= len(new):
            return {str(number): changes_of(old[number], new[number]) for number in others}
        first = others[0] if others else min(len(old), len(new))
        ends = zip(reversed(old[first:]), reversed(new[first:]), strict=False)
        same = sum(1 for _ in takewhile(lambda pair: _is_same(*pair), ends))
        return [first, len(old) - same, new[first : len(new) - same]]
    # Other characters are counted in another way in JavaScript.
    if isinstance(old, str) and isinstance(new, str) and old.isascii() and new.isascii():
        first, same = common_ends(old, new)
        return [first, len(old) - same, new[first : len(new) - same]]
    return [new]


def _is_same(old: Any, new: Any) -> bool:
    """Tell whether values are the same in JSON, in which 1 is not true."""
    if isinstance(new, dict | list):
        return bool(old == new) and json.dumps(old) == json.dumps(new)
    return type(old) is type(new) and bool(old == new)
