"""The page of transcripts: an episode in a level of `text-easy`, in each sight."""

from __future__ import annotations

import babyrobot_levels as brl
from babyrobot_levels.render.sights import SIGHTS

SUITE, SPLIT, NUMBER, SEED = "text-easy", "train", 192, 8
MOVES = (
    *("east", "south", "east", "south", "west", "west"),
    *("south", "west", "south", "east", "east", "south"),
)


def page() -> str:
    """Return the page."""
    level = brl.load_suite(SUITE).split(SPLIT)[NUMBER]
    parts = [_HEAD]
    for sight in SIGHTS:
        world = brl.TextWorld(level, sight=sight)
        told = [world.reset(seed=SEED), *(f"> {move}\n{world.move(move)}" for move in MOVES)]
        text = "\n\n".join(told)
        parts.append(f'\n## `sight="{sight}"`\n\n```text\n{text}\n```\n')
    return "".join(parts)


_HEAD = f"""\
# Transcripts of an episode

What a [language agent](agents.md) reads in each [sight](agents.md#what-is-seen). The level is
number {NUMBER} of the split `{SPLIT}` of `{SUITE}`, the seed {SEED}; behind `>` stands what the
agent does. Its fourth move is a mistake, and one move skids:

```python
import babyrobot_levels as brl

level = brl.load_suite("{SUITE}").split("{SPLIT}")[{NUMBER}]
world = brl.TextWorld(level, sight="map")
print(world.reset(seed={SEED}))
for move in "{" ".join(MOVES)}".split():
    print(">", move, world.move(move), sep="\\n")
round(world.regret, 6)  # 1.0: a step was lost in the fourth move
round(world.luck, 6)  # -1.0: the skid cost more than skids do on average
[round(move.advantage, 6) for move in world.moves][:5]  # [0.0, 0.0, 0.0, -1.0, 0.0]
```
"""
