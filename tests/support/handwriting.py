"""The same data as many people would write it: any style that YAML has, with comments all over."""

from __future__ import annotations

import random
import re
from typing import Any

from babyrobot_levels.text.emitter import scalar

COMMENTS = ("# {}", "#{}", "#  {}  ", "#: {}", "## {}", '# {} "it\'s" [1, {{', "# {}: - x", "#\t{}")


class Scribe:
    """Writes data as YAML, each time in another style. `comments` are those that it wrote."""

    def __init__(self, rng: random.Random, chatty: float = 0.15):
        self.rng = rng
        self.chatty = chatty
        self.comments: list[str] = []

    def write(self, data: dict[str, Any]) -> str:
        """Return the data as a YAML text."""
        self.comments.clear()
        lines = ["---" + self.behind()] if self.once(8) else []
        if self.once(6):
            lines += [self.flow(data, " ") + self.behind()]
        else:
            lines += self.entries(data, "")
        lines += self.noise()
        if self.once(8):
            lines += ["...", *self.noise()]
        text = "\n".join(lines) + "\n" * self.rng.choice([0, 1, 1, 3])
        return text.replace("\n", "\r\n") if self.once(8) else text

    def once(self, times: int) -> bool:
        return self.rng.randrange(times) == times - 1

    # -- comments and blank lines ----------------------------------------------------------

    def comment(self) -> str:
        text = self.rng.choice(COMMENTS).format(f"c{len(self.comments)}")
        self.comments.append(text)
        return text

    def behind(self) -> str:
        """Return a comment to stand behind something, or a blank, or nothing."""
        if self.rng.random() > 1 - self.chatty:
            return self.rng.choice([" ", "   ", "\t"]) + self.comment()
        return " " if self.once(9) else ""

    def noise(self) -> list[str]:
        lines = []
        while self.rng.random() > 1 - self.chatty:
            blank = self.rng.choice(["", "", " ", "    "])
            lines.append(blank + (self.comment() if self.once(2) else ""))
        return lines

    # -- values ----------------------------------------------------------------------------

    def entries(self, value: dict[str, Any] | list[Any], indent: str) -> list[str]:
        """Return a container's entries in block style."""
        lines: list[str] = []
        pairs = value.items() if isinstance(value, dict) else [(None, v) for v in value]
        for key, inner in pairs:
            lines += self.noise()
            lead = indent + ("-" if key is None else self.key(key) + ":")
            lines += self.behind_lead(lead, inner, indent, in_list=key is None)
        return lines

    def behind_lead(self, lead: str, value: Any, indent: str, *, in_list: bool) -> list[str]:
        deeper = indent + " " * self.rng.choice([1, 2, 2, 4])
        if isinstance(value, dict | list) and value and not self.once(3):
            if in_list and self.once(2):
                # A container on the line of the dash.
                blanks = " " * self.rng.choice([1, 1, 3])
                inner = self.entries(value, indent + " " + blanks)
                while inner and not inner[0].strip().strip("#"):
                    inner.pop(0)
                if not inner[0].lstrip().startswith("#"):
                    return [lead + blanks + inner[0].lstrip(), *inner[1:]]
                return [lead, *inner]
            is_compact = isinstance(value, list) and not in_list and self.once(3)
            return [lead + self.behind(), *self.entries(value, indent if is_compact else deeper)]
        if isinstance(value, str) and self.once(3):
            block = self.block(value, deeper)
            if block:
                return [f"{lead} {block[0]}{self.behind()}", *block[1:]]
        if self.once(6):
            return [lead + self.behind(), *self.noise(), deeper + self.any(value, deeper)]
        return [f"{lead} {self.any(value, deeper)}{self.behind()}"]

    def any(self, value: Any, indent: str) -> str:
        """Return a value that begins in the middle of a line."""
        if isinstance(value, dict | list):
            return self.flow(value, indent)
        return self.scalar(value, indent)

    def flow(self, value: dict[str, Any] | list[Any], indent: str) -> str:
        """Return a container in brackets, on one line or several."""
        parts = []
        pairs = value.items() if isinstance(value, dict) else [(None, v) for v in value]
        for key, inner in pairs:
            if isinstance(inner, dict | list):
                text = self.flow(inner, indent)
            else:
                text = self.scalar(inner, indent, in_flow=True)
            parts.append(text if key is None else f"{self.key(key)}: {text}")
        opening, closing = "{}" if isinstance(value, dict) else "[]"
        text = opening + self.gap(indent)
        for number, part in enumerate(parts, 1):
            text += part + self.gap(indent)
            if number < len(parts) or self.once(6):
                text += "," + (self.gap(indent) or " ")
        return text + closing

    def gap(self, indent: str) -> str:
        """Return what may stand between brackets, commas and values."""
        if self.once(5):
            return (
                self.behind() + "\n" + "".join(f"{line}\n" for line in self.noise()) + indent + "  "
            )
        return " " * self.rng.choice([0, 0, 1])

    # -- scalars ---------------------------------------------------------------------------

    def key(self, key: str) -> str:
        return self.quoted(key, "") if self.once(8) else scalar(key, in_flow=True)

    def scalar(self, value: Any, indent: str, *, in_flow: bool = False) -> str:
        if value is None:
            return self.rng.choice(["null", "~", "Null"])
        if isinstance(value, bool):
            text = str(value)
            return self.rng.choice([text.lower(), text, text.upper()])
        if isinstance(value, int):
            sign = "+" if value >= 0 and self.once(4) else "-" if value < 0 else ""
            zeros = "0" * self.once(6)
            return f"{value:#x}" if value > 0 and self.once(8) else f"{sign}{zeros}{abs(value)}"
        if isinstance(value, float):
            return self.rng.choice([repr(value), f"{value:.17e}", f"{value!r}".replace("e", "E")])
        plain = scalar(value, in_flow=in_flow)
        if plain[0] == '"' or self.once(3):
            return self.quoted(value, indent)
        return self.folded(plain, indent + " ") if self.once(4) else plain

    def quoted(self, text: str, indent: str) -> str:
        if text.isprintable() and self.once(2):
            quoted = "'" + text.replace("'", "''") + "'"
        else:
            plain = scalar(text)
            quoted = plain if plain[0] == '"' else f'"{plain}"'
        return self.folded(quoted, indent + " ") if indent and self.once(4) else quoted

    def folded(self, text: str, indent: str) -> str:
        """Return a text with some of its blanks as line ends."""
        return re.sub(
            r"(?<=[a-z]) (?=[a-z])", lambda _: f"\n{indent}" if self.once(2) else " ", text
        )

    def block(self, text: str, indent: str) -> list[str]:
        """Return a text as a literal or folded block, empty where it cannot stand in one."""
        body = text.rstrip("\n")
        lines = body.split("\n")
        if not body or body[0] == " " or not all(line.isprintable() for line in lines):
            return []
        ends = len(text) - len(body)
        sign = "-" if ends == 0 else "" if ends == 1 else "+"
        if "\n" not in body and self.once(2):
            return [
                ">" + sign,
                *f"{indent}{self.folded(body, indent)}".split("\n"),
                *[""] * (ends - 1),
            ]
        if "\ufeff" in body:
            return []
        return ["|" + sign, *(indent + line if line else "" for line in lines), *[""] * (ends - 1)]
