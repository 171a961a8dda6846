"""The page of corpora: public collections of levels, read whole.

    python benchmarks/corpora.py FOLDER

Without a folder it prints how to get the collections, which are then in FOLDER. It imports each
file, solves each level, and writes `docs/corpora.md`. What it tells are counts, and no times: they
are the same on every machine.
"""

import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from io import BytesIO
from math import isfinite
from pathlib import Path
from runpy import run_path
from statistics import median, quantiles
from types import ModuleType
from typing import NamedTuple

from PIL import Image

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats.formats import FORMATS
from babyrobot_levels.extensions.formats.many import Outcome, worker
from babyrobot_levels.extensions.formats.sources import Found, opened, single
from babyrobot_levels.linter.rules import all_rules
from babyrobot_levels.parallel import executor_for
from babyrobot_levels.parallel.executor import results
from babyrobot_levels.text.budget import COMMAND, OverBudgetError, within
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.words import listed

PAGE = Path(__file__).resolve().parents[1] / "docs" / "corpora.md"

PICTURES = PAGE.parent / "images" / "corpora"

MAX_SHOWN, TILE, GAP = 100, 200, 16
"""The most cells across of a level with a picture; its size, and the gap, in pixels."""

MAX_CELLS = 20_000
"""Levels with more cells are read, but not solved here."""


class Corpus(NamedTuple):
    """A public collection.

    Attributes:
        repository: its owner and its name.
        commit: the commit that is read.
        license: its licence, as it says.
        files: the patterns of its files.
        what: what they are.
        sample: so many worlds are read of each file; None for all.
        pictures: whether the page shows some: the licence allows it.
    """

    repository: str
    commit: str
    license: str
    files: tuple[str, ...]
    what: str
    sample: int | None = None
    pictures: bool = True

    @property
    def name(self) -> str:
        """The name without the owner."""
        return self.repository.rpartition("/")[2]


CORPORA = (
    Corpus(
        "micromouseonline/mazefiles",
        "a71f846897fdd2193e726a1276c6774c9ce9ac67",
        "none stated",
        ("classic/*.txt", "halfsize/*.txt", "training/*.txt"),
        "mazes of micromouse contests, as text",
        pictures=False,
    ),
    Corpus(
        "micromouseonline/micromouse_maze_tool",
        "12118e413f6be8341ea7f64c100e7625178cd6dc",
        "MIT",
        ("mazefiles/binary/*",),
        "mazes of micromouse contests, 256 bytes each",
    ),
    Corpus(
        "MovingAILab/hog2",
        "af9d42d06827e5bd96d093c17e4d98b5e4f99e79",
        "MIT",
        ("maps/bigMaps/*.map", "maps/local/*.map", "maps/coprobber/*/*.map", "maps/wc3maps_/*.map"),
        "maps of MovingAI",
    ),
    Corpus(
        "Metta-AI/metta",
        "a8d1ecee19252b26b9351de23a628b372b19dfb6",
        "MIT",
        ("**/*.map",),
        "maps of MettaGrid",
    ),
    Corpus(
        "mapeditor/tiled",
        "aa069419db754412a2b4d51d8ea03bb048499f0a",
        "BSD-2-Clause and GPL-2.0",
        ("**/*.tmx",),
        "examples and tests of Tiled",
    ),
    Corpus(
        "deepnight/ldtk",
        "d4425cdc6f3f3090207c183464df794e463078de",
        "MIT",
        ("app/extraFiles/samples/*.ldtk",),
        "samples of LDtk",
    ),
    Corpus(
        "TylerYep/stanfordkarel",
        "d6d1f5a239aabf1e999223a6ce408e522a03db46",
        "MIT",
        ("**/*.w",),
        "worlds of Karel",
    ),
    Corpus(
        "HumanCompatibleAI/overcooked_ai",
        "739950a079cdaed5a44fcc662efc40244c205d06",
        "MIT",
        ("**/*.layout",),
        "kitchens of Overcooked-AI",
    ),
    Corpus(
        "TheVGLC/TheVGLC",
        "0e86a8f31f20ecad4eaa5741ff061af88767f7fb",
        "MIT",
        ("The Legend of Zelda/Processed/tloz*.txt",),
        "dungeons of The Legend of Zelda",
    ),
    Corpus(
        "MattChanTK/gym-maze",
        "83176811b49b5538a6213520612f44fb1bc49114",
        "MIT",
        ("**/*.npy",),
        "mazes of gym-maze",
    ),
    Corpus(
        "google-deepmind/boxoban-levels",
        "78011d8c86ad423bfb2e1005012393b4c3c24409",
        "Apache-2.0",
        ("hard/000.txt",),
        "the first eight of Boxoban's hard maps of Sokoban",
        sample=8,
    ),
    Corpus(
        "facebookresearch/minihack",
        "09eaa7ee45c567850668d3743d7fe1853917d98f",
        "Apache-2.0",
        ("**/*.des",),
        "levels of MiniHack",
    ),
)


class Facts(NamedTuple):
    """What is found of a level.

    Attributes:
        digest: its digest.
        ends: whether it has exits, or targets.
        steps: the expected number of steps to the exit; None if it is not surely reached.
        is_solved: whether it was solved: it is not too large.
        difficulty: its difficulty, None if that is not finite, or takes longer than a command may.
        findings: the codes of what `lint` finds.
    """

    digest: str
    ends: bool
    steps: float | None
    is_solved: bool
    difficulty: float | None = None
    findings: frozenset[str] = frozenset()


def facts_of(text: str) -> Facts | None:
    """Return the facts of a level file, None if it is not valid."""
    try:
        level = brl.loads(text)
        if level.width * level.height > MAX_CELLS:
            return Facts(level.digest, level.has_goal, None, is_solved=False)
        solution = brl.solve(level, 0.999)
    except LevelError:
        return None
    steps = solution.expected_steps if solution.exit_probability > 1 - 1e-9 else None
    findings = frozenset(found.code for found in brl.lint(level))
    return Facts(level.digest, level.has_goal, steps, True, _difficulty(level), findings)


def _difficulty(level: brl.Level) -> float | None:
    """Return how difficult a level is, if that is known and finite."""
    try:
        with within(COMMAND):
            found = brl.metrics(level).difficulty
    except OverBudgetError:
        return None
    return found if found is not None and isfinite(found) else None


class Read(NamedTuple):
    """A corpus that has been read."""

    corpus: Corpus
    outcomes: Sequence[Outcome]
    levels: Sequence[Facts | None]
    picture: bytes | None


def read(corpus: Corpus, folder: Path) -> Read:
    """Return what becomes of the files of a corpus."""
    paths = sorted({path for pattern in corpus.files for path in folder.glob(pattern)})
    if not paths:
        sys.exit(f"{folder} has none of the files of {corpus.repository}")
    found = [_sampled(single(path), corpus.sample) for path in paths]
    outcomes = [*_each(worker(None, None, strict=False), found)]
    texts = [text for outcome in outcomes for _, text in outcome.texts]
    levels = [*_each(facts_of, texts)]
    return Read(corpus, outcomes, levels, sheet(texts) if corpus.pictures else None)


def _sampled(file: Found, count: int | None) -> Found:
    """Return a file of maps of Sokoban with the first of them."""
    if count is None:
        return file
    parts = FORMATS["sokoban"].parts(opened(file))[:count]
    return file._replace(data="\n\n".join(part.text for part in parts).encode())


def sheet(texts: Sequence[str]) -> bytes:
    """Return a picture of six of the levels that are not too large, all along the list."""
    shown = []
    for number in range(6):
        for text in texts[number * len(texts) // 6 :]:
            level = brl.loads(text)
            if max(level.size) <= MAX_SHOWN and text not in shown:
                shown.append(text)
                break
    page = Image.new("RGBA", (6 * (TILE + GAP) - GAP, TILE), (0, 0, 0, 0))
    for number, text in enumerate(shown):
        picture = Image.open(BytesIO(brl.loads(text).to_png()))
        picture.thumbnail((TILE, TILE))
        left = number * (TILE + GAP) + (TILE - picture.width) // 2
        page.paste(picture, (left, (TILE - picture.height) // 2))
    file = BytesIO()
    page.quantize(128).save(file, "PNG", optimize=True)
    return file.getvalue()


def _each(function, items) -> Iterator:  # type: ignore[no-untyped-def, type-arg]
    return results(executor_for("processes").map(function, items))


def _row(found: Read) -> str:
    outcomes, levels = found.outcomes, [facts for facts in found.levels if facts]
    files = sum(bool(outcome.texts) for outcome in outcomes)
    tried = [facts for facts in levels if facts.is_solved and facts.ends]
    steps = [facts.steps for facts in tried if facts.steps is not None]
    repeated = sum(count - 1 for count in Counter(each.digest for each in levels).values())
    cells = [
        f"[{found.corpus.name}](https://github.com/{found.corpus.repository})",
        found.corpus.what,
        f"{len(outcomes):,}",
        f"{files:,}",
        f"{len(levels):,}",
        f"{len(steps):,} of {len(tried):,}" if tried else "no exits",
        f"{median(steps):,.0f}, {max(steps):,.0f}" if steps else "",
        f"{len(tried) - len(steps):,}" if tried else "",
        f"{repeated:,}",
    ]
    return f"| {' | '.join(cells)} |"


def _difficulties(found: Read) -> str:
    values = [each.difficulty for each in found.levels if each and each.difficulty is not None]
    cells = [f"{cut:.2f}" for cut in quantiles(values, n=4, method="inclusive")]
    return f"| {found.corpus.name} | {len(values):,} | {' | '.join(cells)} | {max(values):.2f} |"


def _has_difficulties(found: Read) -> bool:
    return sum(each is not None and each.difficulty is not None for each in found.levels) > 3


def _findings(found: Read) -> Iterator[str]:
    names = {rule.code: rule.name for rule in all_rules()}
    levels = [facts for facts in found.levels if facts and facts.is_solved]
    counts = Counter(code for facts in levels for code in facts.findings)
    for code, count in counts.most_common():
        name = names[code]
        link = f"[{name}](rules/{name}.md)"
        yield f"| {found.corpus.name} | {count:,} of {len(levels):,} | {link} |"


def _refusals(found: Read) -> Iterator[str]:
    reasons: Counter[str] = Counter()
    for outcome in found.outcomes:
        reasons.update(reason.rpartition(": error: ")[2] for reason in outcome.refused)
        if outcome.is_unknown:
            reasons["in no known format"] += 1
    for reason, count in reasons.most_common():
        yield f"| {found.corpus.name} | {count} | {reason} |"


_HEAD = """\
# Corpora

Public collections of levels, each read whole by `babyrobot import`. None of their files is part of
this project: get them by

<!-- not run: it downloads the collections -->
```sh
{clones}
python benchmarks/corpora.py .
```

which writes this page.

## What is read

A *level* is what a file has become, and is valid. It is *solved* if it has an exit that an optimal
policy surely reaches, with a discount of 0.999; levels with more than {most:,} cells are not tried.
*Copies* are levels with the digest of another one in the collection.

| collection | what it has | files | read | levels | solved | steps: median, most | \
exits out of reach | copies |
|---|---|---|---|---|---|---|---|---|
{rows}

## How difficult they are

The quartiles of [difficulty](mazes.md#difficulty), of the levels in which it is finite.

| collection | levels | first quartile | median | third quartile | most |
|---|---|---|---|---|---|
{difficulties}

## What lint finds

In how many of the levels that are tried the [linter](linting.md) has a finding of each rule. The
goal of most micromouse mazes is four cells, of which the robot ends on the first that it enters.

| collection | levels | rule |
|---|---|---|
{findings}

## Pictures

Six levels of each collection whose licence allows it.

{pictures}

## What is refused

| collection | files | why |
|---|---|---|
{refused}

## As in the originals

| format | what is compared | where |
|---|---|---|
| FrozenLake | Gymnasium's tables: each state and action | in tests |
| MiniGrid | each action in each state, of grids without objects | in tests |
| PyPI babyrobot | the levels recorded for setups of the package | in tests |
| maze-dataset | moves and shortest paths, where the package is installed | in tests |
| Overcooked-AI | the steps of two players, by its rule for meetings | in tests |
| gym-maze | the moves out of each cell, by its own class | here: {moves:,}, all equal |
| gym-sokoban | its actions, in 27 levels | `benchmarks/sokoban.py`: 91,904, all equal |

## What the levels are

- In micromouse mazes, the robot goes from the start to the nearest goal. Mazes without marks start
  in the bottom-left cell, and their goals are the cells in the middle.
- Levels of Boxoban have up to millions of states of robot and boxes: those with more than fit are
  refused. Of 150 of three difficulties, 144 fit: [the figures](../benchmarks/README.md#boxes).
  Of the thousand of `unfiltered/test/000.txt`, `babyrobot import` writes 902.
- Of maps of MovingAI, the start is the first free cell, and the exit the last one that can be
  reached from there.
- Tiles of Tiled that have none of the classes of [Tiled maps](converting.md#tiled) are plain cells.
- Worlds of Karel, MettaGrid and Overcooked-AI have no exits, as their tasks are others. The
  players of Overcooked-AI are robots, and move as there. One kitchen has four, which have too many
  joint states for tables.
- Licences, as the collections state them: {licenses}.
"""


def _has_picture(found: Read) -> bool:
    return found.picture is not None


def _pictured(found: Read) -> str:
    name = found.corpus.name
    return f"**{name}**\n\n![Six levels of {name}](images/corpora/{name}.png)"


def clones() -> str:
    """Return the commands that get the collections."""
    return "\n".join(
        f"git clone https://github.com/{each.repository}\n"
        f"git -C {each.name} checkout -q {each.commit}"
        for each in CORPORA
    )


def moves_of_gym_maze(folder: Path) -> int:
    """Return how many moves its own class makes as the levels do.

    Raises:
        AssertionError: one of them ends elsewhere.
    """
    # Its module draws with pygame, which nobody needs here.
    sys.modules.setdefault("pygame", ModuleType("pygame"))
    maze_class = run_path(str(folder / "gym_maze/envs/maze_view_2d.py"))["Maze"]
    count = 0
    for path in sorted(folder.glob("**/*.npy")):
        maze, level = maze_class(maze_cells=maze_class.load_maze(str(path))), brl.import_(path)
        (width, height), next_state = level.size, level.compile().next_state
        for cell in range(width * height):
            y, x = divmod(cell, width)
            if (x, y) in level.exits:
                continue
            for action, side in enumerate("NESW", 1):
                right, down = maze.COMPASS[side]
                to = cell + right + down * width if maze.is_open((x, y), side) else cell
                assert next_state[cell, action, 0] == to, (path, x, y, side)
                count += 1
    return count


def page(all_read: Sequence[Read], moves: int) -> str:
    """Return the page."""
    return _HEAD.format(
        clones=clones(),
        most=MAX_CELLS,
        moves=moves,
        rows="\n".join(map(_row, all_read)),
        pictures="\n\n".join(map(_pictured, filter(_has_picture, all_read))),
        difficulties="\n".join(map(_difficulties, filter(_has_difficulties, all_read))),
        findings="\n".join(line for found in all_read for line in _findings(found)),
        refused="\n".join(line for found in all_read for line in _refusals(found)),
        licenses=listed([f"{each.name} {each.license}" for each in CORPORA]),
    )


def main() -> None:
    """Read the collections, and write the page."""
    if len(sys.argv) != 2:
        print(clones())
        return
    folder = Path(sys.argv[1])
    all_read = []
    for corpus in CORPORA:
        all_read.append(read(corpus, folder / corpus.name))
        print(_row(all_read[-1]), flush=True)
    PICTURES.mkdir(exist_ok=True)
    for found in all_read:
        if found.picture is not None:
            (PICTURES / f"{found.corpus.name}.png").write_bytes(found.picture)
    moves = moves_of_gym_maze(folder / "gym-maze")
    PAGE.write_text(page(all_read, moves), encoding="utf-8")


if __name__ == "__main__":
    main()
