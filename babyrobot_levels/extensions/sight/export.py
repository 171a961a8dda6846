"""A level and a sight as a file for solvers of POMDPs: `babyrobot export --to pomdp`."""

from collections.abc import Iterator, Sequence
from typing import Any

from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.envs.observations.base import Extent
from babyrobot_levels.extensions.formats.conversion import Conversion, Lost, fields_lost
from babyrobot_levels.extensions.formats.processes import ABOUT
from babyrobot_levels.extensions.sight.model import PartialModel, build_model
from babyrobot_levels.extensions.sight.sights import sight_of
from babyrobot_levels.extensions.sight.writers import WRITERS
from babyrobot_levels.language.fields import Role, fields_with
from babyrobot_levels.library.level import Level
from babyrobot_levels.mdp.gridworld import check_one_robot

_CARRIED = frozenset(
    {*fields_with(Role.GEOMETRY, Role.DYNAMICS, Role.REWARD), *ABOUT, "max_steps", "discount"}
)
"""The fields that are kept, or of which `_losses` has more to say."""

_PLACES = {"pomdp": "a POMDP file", "pomdp-prism": "a PRISM module", "pomdp-drn": "a DRN file"}
"""What a file of each format is."""


def export_sight(
    level: Level, to: str, sight: str | Sequence[str] = "view", **options: Any
) -> Conversion:
    """Return a level as a POMDP, whose agent has a sight and the action mask.

    Args:
        level: the level.
        to: the format: `"pomdp"`, `"pomdp-prism"` or `"pomdp-drn"`.
        sight: one of `NAMES`, or several observations.
        options: those of the observation, such as `view_radius`.

    Raises:
        LevelError: the maze has no seed yet (`seed: random`), or the level has several robots.
        ValueError: there is no such sight, or an option has a value that it cannot have.
        TypeError: there is no such option.
        TooLargeError: the level has too many states.
    """
    check_one_robot(level, "files of POMDPs")
    space = space_of(level, "all")
    chosen = sight_of(sight, Extent.of([level], turns=False), **options)
    model = build_model([space], chosen, [1.0], [level.discount])
    text = f"{_about(level, '#' if to == 'pomdp' else '//')}{WRITERS[to](model)}"
    return Conversion(text, tuple(_losses(level, model, to)))


def _about(level: Level, sign: str) -> str:
    """Return what the level is, and whose, as comments in ASCII."""
    lines = (line for name in ABOUT for line in (getattr(level, name) or "").splitlines())
    return "".join(f"{sign} {line.encode('ascii', 'replace').decode()}\n" for line in lines)


def _losses(level: Level, model: PartialModel, to: str) -> Iterator[Lost]:
    """Yield what a file does not say of a level."""
    place = _PLACES[to]
    yield from fields_lost(level, _CARRIED, place)
    drawn = len(model.initial()) if to == "pomdp" else int((model.start > 0).sum())
    if drawn > 1:
        more = ", and a discount counts it" if level.discount < 1 else ""
        yield Lost("start", f"the first step draws the start: add it to a limit of steps{more}")
    if level.discount < 1 and to != "pomdp":
        yield Lost("discount", f"{place} cannot hold it; give it to the solver")
    if level.max_steps is not None:
        yield Lost("max_steps", f"{place} cannot hold it; give the solver a horizon")
