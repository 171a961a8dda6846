"""A colour of the level's own theme that can hardly be told from its ground.

The contrast of start, exit, robot, walls and puddles against the ground must be at least 3 to 1,
as the Web Content Accessibility Guidelines (WCAG 2.2, 1.4.11) ask of what a picture is understood
by. Only pairs of which the theme itself gives a colour are looked at, and not the themes that come
with the package.

## Why it is bad

On a projector, in print, or for one reader in twelve, such a wall or puddle is not there.

## Example

```yaml
version: 1
theme:
  colors: {base: "#ffffff", walls: "#dddddd", start: "#b00000", exit: "#006000", puddle: "#0000c0",
           robot: "#555555"}
```

## Instead

```yaml
version: 1
theme:
  colors: {base: "#ffffff", walls: "#333333", start: "#b00000", exit: "#006000", puddle: "#0000c0",
           robot: "#555555"}
```
"""

from __future__ import annotations

from collections.abc import Iterator

from babyrobot_levels.language.looks import BUILTIN_THEMES
from babyrobot_levels.lint.case import Case
from babyrobot_levels.lint.rule import Finding, Needs
from babyrobot_levels.text.diagnostics import Severity

CODE, SEVERITY, NEEDS = "BR607", Severity.INFO, Needs.LEVEL

LEAST = 3.0

_SEEN = {
    "start": "the start's colour",
    "exit": "the exit's colour",
    "robot": "the robot's colour",
    "walls": "the walls' colour",
    "puddle": "the puddles' colour",
}


def check(case: Case) -> Iterator[Finding]:
    """Yield a finding for each colour that is too near to its ground."""
    if isinstance(case.level.theme, str) and case.level.theme in BUILTIN_THEMES:
        return
    from babyrobot_levels.render.colors import contrast

    colors = case.level.resolved_theme.colors
    given = colors.model_fields_set
    for name in _SEEN:
        if not given & {name, "base"}:
            continue
        ratio = contrast(getattr(colors, name), colors.base)
        if ratio < LEAST:
            spoken = name if name in given else "base"
            yield Finding(
                ("theme", "colors", spoken),
                f"{_SEEN[name]} {getattr(colors, name)} on the ground {colors.base} has a contrast "
                f"of {ratio:.1f} to 1, less than {LEAST:g} to 1",
                "take a lighter or a darker colour",
            )
