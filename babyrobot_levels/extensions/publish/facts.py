"""What a gallery tells of a level: the facts of its tile, its page and `gallery.json`."""

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from typing import Any

from babyrobot_levels.analysis.metrics import Metrics
from babyrobot_levels.analysis.metrics import metrics as metrics_of
from babyrobot_levels.analysis.solver.policies import space_of
from babyrobot_levels.language.kinds import KINDS, THINGS
from babyrobot_levels.language.metric_names import MAX_SOLVED, MISTAKES, NEEDS
from babyrobot_levels.language.things import SHAPES
from babyrobot_levels.library.level import Level

HARDNESS = ("success", *MISTAKES, *NEEDS)
"""The metrics that tell why a level is hard."""


@dataclass(frozen=True, slots=True)
class Files:
    """The files of a level in a gallery, relative to the gallery's folder.

    Attributes:
        page: its page.
        level: the level itself, as YAML.
        svg: its picture; with the answers, if the gallery is the teacher's.
        png: the same one.
        tile: a small picture for the wall, without panels.
        film: an episode as a GIF; None if no film is made.
        values: its picture with optimal values and actions; None without a solution, or answers.
        sets: the same for other sets of held things.
    """

    page: str
    level: str
    svg: str
    png: str
    tile: str
    film: str | None
    values: str | None = None
    sets: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Facts:
    """The facts of a level. What answers the level is None in a gallery without answers.

    Attributes:
        id: the folder of the level in the gallery, unique there: `[a-z0-9-]+`.
        name: the name by which it is loaded.
        title: its title, or its name.
        description: its description; may be empty.
        author: its author; may be empty.
        source: where it comes from; may be empty.
        tags: its tags.
        split: the split of the suite that it belongs to; may be empty.
        digest: the digest of its MDP.
        size: width and height in cells.
        states: the number of reachable states.
        max_steps: the time limit; None if there is none.
        discount: the discount factor.
        deterministic: whether each action has one outcome only.
        things: the fields of the kinds of things in it, such as `items`.
        features: what else is in it, of `areas`, `ends`, `glass`, `maze`, `puddles`, `warps` and
            `wind`.
        best_return: the optimal expected return; None if it is undefined.
        best_steps: the expected number of steps of the optimal policy; None if undefined.
        random_return: the expected return of a robot that moves at random; None if undefined.
        difficulty: as in `brl.metrics`; None if undefined.
        files: the files of the level.
        words: what is in it, in words by which it is searched: `guard`, `switches`, `lever`.
        license: the license of the level; may be empty.
        ending: how episodes of the optimal policy end that do not end at an exit; None if
            all do.
        maze_seed: the seed of the maze that is shown, if that of the level is random; else None.
        hardness: the metrics of `HARDNESS` as in `brl.metrics`, None where undefined; empty in a
            gallery without answers.
    """

    id: str
    name: str
    title: str
    description: str
    author: str
    source: str
    tags: tuple[str, ...]
    split: str
    digest: str
    size: tuple[int, int]
    states: int
    max_steps: int | None
    discount: float
    deterministic: bool
    things: tuple[str, ...]
    features: tuple[str, ...]
    best_return: float | None
    best_steps: float | None
    random_return: float | None
    difficulty: float | None
    files: Files
    words: tuple[str, ...] = ()
    license: str = ""
    ending: str | None = None
    maze_seed: int | None = None
    hardness: dict[str, Any] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return the facts as plain data, for `gallery.json`.

        Infinities are texts, `"inf"` and `"-inf"`.
        """
        return {name: _plain(value) for name, value in asdict(self).items()}


def _plain(value: Any) -> Any:
    if isinstance(value, float):
        # Nine digits are the same on every platform; the last ones are not.
        return float(f"{value:.9g}") if math.isfinite(value) else str(value)
    if isinstance(value, dict):
        return {name: _plain(each) for name, each in value.items()}
    return list(value) if isinstance(value, tuple) else value


def measured(level: Level) -> Metrics | None:
    """Return the metrics of a level; None if it is too large to be solved.

    Args:
        level: the level; a maze needs a seed.
    """
    found = metrics_of(level)
    return found if found.states <= MAX_SOLVED else None


def facts_of(
    level: Level,
    own: str,
    files: Files,
    *,
    split: str = "",
    metrics: Metrics | None = None,
    maze_seed: int | None = None,
) -> Facts:
    """Return the facts of a level.

    Args:
        level: the level; a maze needs a seed.
        own: the folder of the level in the gallery.
        files: its files.
        split: the split of the suite that it belongs to; may be empty.
        metrics: its metrics; None without answers.
        maze_seed: the seed that was chosen for the maze, if the level's is random.
    """
    mdp = level.compile()
    reached = ~space_of(level, "all").without_value
    chances = (mdp.probability[reached & ~mdp.is_terminal] > 0).sum(axis=2)
    return Facts(
        id=own,
        name=level.name or "",
        title=level.title or level.name or own,
        description=(level.description or "").strip(),
        author=level.author or "",
        source=level.source or "",
        license=level.license or "",
        tags=level.tags,
        split=split,
        digest=level.digest,
        size=level.size,
        states=(metrics or metrics_of(level)).states,
        max_steps=level.max_steps,
        discount=level.discount,
        deterministic=bool(chances.max(initial=0) <= 1),
        things=tuple(kind.field for kind in THINGS if kind.of(level)),
        features=tuple(_features(level)),
        best_return=None if metrics is None else metrics.best_return,
        best_steps=None if metrics is None else metrics.best_steps,
        random_return=None if metrics is None else metrics.random_return,
        difficulty=None if metrics is None else metrics.difficulty,
        files=files,
        words=tuple(dict.fromkeys(_words(level))),
        ending=None if metrics is None else metrics.ending,
        hardness={} if metrics is None else {name: getattr(metrics, name) for name in HARDNESS},
        maze_seed=maze_seed,
    )


def _features(level: Level) -> Iterator[str]:
    """Yield what is in a level beside things, in alphabetical order."""
    if level.areas:
        yield "areas"
    if any(area.ends for area in level.areas):
        yield "ends"
    if level.grid().glass:
        yield "glass"
    for name in ("maze", "puddles", "warps", "wind"):
        if getattr(level, name):
            yield name


def _words(level: Level) -> Iterator[str]:
    """Yield what is in a level, as it is called here and elsewhere, and what it looks like."""
    for kind in KINDS:
        entries = kind.of(level) if kind.is_listed else ()
        if entries:
            yield kind.plural
            # Not each item is a key, and not each mover a guard.
            yield from (name for name in kind.other_names if name not in (*SHAPES, "guard"))
        for entry in entries:
            told = (getattr(entry, name, None) for name in ("picture", "name", "label"))
            yield from filter(None, told)
