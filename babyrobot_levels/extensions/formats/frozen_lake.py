"""Frozen Lake: the letters S, F, H and G, and the keywords of Gymnasium's FrozenLake-v1."""

import json
from typing import Any

from babyrobot_levels.extensions.formats.blocks import (
    ENDS,
    HOLE_COLOR,
    SPATIAL,
    UNLIKE,
    drawn,
    has_walls,
    lost_areas,
    marked,
    text_rows,
    translated,
)
from babyrobot_levels.extensions.formats.conversion import (
    Codec,
    Conversion,
    ConversionError,
    Lost,
    World,
    fields_lost,
    integer,
    letters_in,
    looks_like_data,
    number,
    probability,
    read_data,
    sequence,
    shown,
    truncated,
)
from babyrobot_levels.language import drawing as d
from babyrobot_levels.language.cells import as_skid, mean_of
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.ground import exit_rewards
from babyrobot_levels.text.source import SourceFile
from babyrobot_levels.text.words import did_you_mean

LETTERS = {"S": d.START, "F": d.PLAIN, "H": "H", "G": d.EXIT}
PLACE = "FrozenLake"
USUAL_RATE = 1 / 3
USUAL_REWARDS = (1, 0, 0)
"""The rewards of the goal, of a hole, and of any other step."""

KEYWORDS = frozenset({"desc", "map_name", "is_slippery", "success_rate", "reward_schedule"})
"""The keywords of FrozenLake-v1 that define the MDP."""

LIMIT = "max_episode_steps"
_OF_PLAY = frozenset({"id", "render_mode", "disable_env_checker"})
"""Further keywords of `gymnasium.make`: the time limit, and what concerns no level."""

MAPS = {
    "4x4": ["SFFF", "FHFH", "FFFH", "HFFG"],
    "8x8": [
        *("SFFFFFFF", "FFFFFFFF", "FFFHFFFF", "FFFFFHFF"),
        *("FFFHFFFF", "FHHFFFHF", "FHFFHFHF", "FFFHFFFG"),
    ],
}
"""The maps that Gymnasium has a name for."""

_KNOWN = "S start, F frozen, H hole, G goal"


def read_frozen_lake(source: SourceFile, *, slippery: bool | None = None) -> World:
    """Return the world of a map: lines of letters, a list of them, or FrozenLake's keywords.

    Args:
        source: the text.
        slippery: whether it is slippery, if the text has no `is_slippery`; by default, it is.
    """
    is_slippery = slippery is not False
    if not looks_like_data(source.text):
        rows = [row.strip() for row in text_rows(source)]
        return _world(source, rows, {"is_slippery": is_slippery})
    data = read_data(source)
    keywords: dict[str, Any] = {"is_slippery": is_slippery}
    if isinstance(data, dict):
        if not data.keys() & KEYWORDS:
            raise ConversionError("no keyword is one of FrozenLake", "add the map as `desc`")
        keywords |= data
        data = _desc(keywords)
    rows = [_row(row) for row in sequence(list(data) if isinstance(data, tuple) else data, "desc")]
    if not rows or not all(rows):
        raise ConversionError("desc must be a list of texts, one for each row of the lake")
    return _world(SourceFile(source.name, "\n".join(rows)), rows, keywords)


def world_of_environment(env: Any) -> World:
    """Return the world of an environment `FrozenLake-v1`."""
    given = {name: each for name, each in env.spec.kwargs.items() if name in KEYWORDS}
    given |= {"desc": env.unwrapped.desc.tolist(), LIMIT: env.spec.max_episode_steps}
    return read_frozen_lake(SourceFile(env.spec.id, repr(given)))


def _desc(keywords: dict[str, Any]) -> Any:
    """Remove the map from the keywords and return it: `desc`, else the one called `map_name`."""
    desc, name = keywords.pop("desc", None), keywords.pop("map_name", "4x4")
    if desc is not None:
        return desc
    if name is None:
        raise ConversionError(
            "without desc and map_name, Gymnasium generates a random lake",
            "add the desc of the environment: `env.unwrapped.desc.tolist()`",
        )
    if not isinstance(name, str) or name not in MAPS:
        raise ConversionError(f"map_name must be 4x4 or 8x8, not {shown(name)}")
    return MAPS[name]


def _row(row: Any) -> str:
    """Return a row as a text, an empty one if it is not a valid row."""
    parts = row if isinstance(row, list | tuple) else [row]
    if not all(isinstance(part, str | bytes) for part in parts):
        return ""
    # Environments hold their map as an array of bytes.
    return "".join(p.decode("latin-1") if isinstance(p, bytes) else p for p in parts)


def _world(source: SourceFile, rows: list[str], keywords: dict[str, Any]) -> World:
    cells = translated(source, rows, LETTERS, _KNOWN)
    for number_, row in enumerate(rows, 1):
        if len(row) != len(rows[0]):
            raise ConversionError(
                f"row {number_} of the map has {len(row)} letters, the first has {len(rows[0])}"
            )
    rate = probability(keywords.pop("success_rate", USUAL_RATE), "success_rate")
    schedule = keywords.pop("reward_schedule", USUAL_REWARDS)
    goal, hole, step = (number(each, "reward_schedule") for each in _three(schedule))
    slips = keywords.pop("is_slippery")
    if slips not in (True, False):
        raise ConversionError(f"is_slippery must be true or false, not {shown(slips)}")
    fields: dict[str, Any] = {"version": 1, **drawn(cells)}
    comments = {}
    if any("H" in row for row in rows):
        legend = {"color": HOLE_COLOR, "ends": True}
        fields["legend"] = {"H": legend if hole == step else {**legend, "reward": hole}}
        comments["legend"] = "Falling into a hole ends the episode."
    if slips and rate < 1:
        fields["skid"] = {"probability": 1 - rate, "to": "sides"}
        comments["skid"] = "Moves that slip go to one of the two sides."
    fields["rewards"] = {"step": step, "exit": goal}
    if (limit := keywords.pop(LIMIT, None)) not in (None, -1):
        fields["max_steps"] = integer(limit, LIMIT)
    lost = tuple(map(_unused, keywords))
    return World(fields, "A map of Gymnasium's FrozenLake-v1.", comments, lost)


def _unused(name: Any) -> Lost:
    """Return the loss of a keyword that is not read.

    Raises:
        ConversionError: it is one of FrozenLake's, misspelt, which Gymnasium refuses as well.
    """
    if name in _OF_PLAY:
        return Lost(name, "it does not change the MDP", (name,))
    if guess := did_you_mean(str(name), (*KEYWORDS, LIMIT, *_OF_PLAY)):
        raise ConversionError(
            f"FrozenLake has no keyword {shown(name)}{guess}", "correct or remove it"
        )
    message = "FrozenLake has no such keyword, and does not use it"
    return Lost(shown(name).strip("'"), message, (name,))


def _three(schedule: Any) -> list[Any]:
    if not isinstance(schedule, list | tuple) or len(schedule) != 3:
        raise ConversionError(
            f"reward_schedule must be three numbers (goal, hole, frozen), not {shown(schedule)}"
        )
    return list(schedule)


def write_frozen_lake(level: Level) -> Conversion:
    """Return a level as keywords of FrozenLake-v1, in JSON."""
    carried = SPATIAL | UNLIKE | {"skid", "max_steps"}
    lost = list(fields_lost(level, carried, PLACE))
    hole = _hole_reward(level)
    lost += lost_areas(level, None, hole=hole)
    if has_walls(level.grid()):
        lost.append(Lost("walls", f"{PLACE} has no walls between its cells; they are left out"))
    if level.blocked:
        lost.append(Lost("blocked", f"{PLACE} has no blocked cells; they become frozen"))
    letters = {d.START: "S", d.EXIT: "G", ENDS: "H", d.PLAIN: "F", d.BLOCKED: "F"}
    desc: list[Any] = ["".join(map(letters.__getitem__, row)) for row in marked(level)]
    if level.size[0] == 1:
        # Of texts of one letter, Gymnasium makes an array without columns.
        desc = [[row] for row in desc]
    skid = as_skid(level.skid) if level.skid is not None else None
    keywords: dict[str, Any] = {"is_slippery": bool(skid and skid.probability)}
    if skid is not None and skid.probability:
        if skid.to != "sides":
            lost.append(Lost("skid.to", "moves slip to the sides only"))
        if abs(1 - skid.probability - USUAL_RATE) > 1e-12:
            keywords["success_rate"] = round(1 - skid.probability, 12)
    goals = {*map(mean_of, exit_rewards(level, level.exits))}
    if len(goals) > 1:
        lost.append(Lost("rewards.exit", "all goals have one reward: the highest"))
    schedule = (float(max(goals, default=0.0)), hole, level.rewards.step)
    if schedule != USUAL_REWARDS:
        keywords["reward_schedule"] = [
            truncated(each) if each.is_integer() else each for each in schedule
        ]
    if level.max_steps is not None:
        keywords[LIMIT] = level.max_steps
    for name, reward in level.rewards:
        # It has no glass off which to bounce.
        if name not in ("exit", "step", "bounce") and reward is not None:
            lost.append(Lost(f"rewards.{name}", f"{PLACE} cannot hold it"))
    rows = ",\n    ".join(map(json.dumps, desc))
    more = "".join(f',\n  "{name}": {json.dumps(value)}' for name, value in keywords.items())
    return Conversion(f'{{\n  "desc": [\n    {rows}\n  ]{more}\n}}\n', tuple(lost))


def _hole_reward(level: Level) -> float:
    """Return the reward that all areas that end the episode share, else that of a step."""
    step = level.rewards.step
    rewards = {step if a.reward is None else mean_of(a.reward) for a in level.areas if a.ends}
    return rewards.pop() if len(rewards) == 1 else step


# -- what is a map ---------------------------------------------------------------------------


def _is_map(data: Any) -> bool:
    if isinstance(data, dict):
        return bool(data.keys() & KEYWORDS)
    return isinstance(data, list | tuple) and set() < letters_in(data) <= LETTERS.keys()


CODEC = Codec(
    read_frozen_lake,
    write_frozen_lake,
    draws=lambda _, letters: letters <= {*LETTERS, " ", "\t"},
    holds=_is_map,
)
