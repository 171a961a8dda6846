"""The page of corpora: public collections of levels, read whole.

    python benchmarks/corpora.py FOLDER

Without a folder it prints how to get the collections, which are then in FOLDER. It imports each
file, solves each level, and writes `docs/corpora.md`. What it tells are counts, and no times: they
are the same on every machine.
"""

import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median
from typing import NamedTuple

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats.many import Outcome, worker
from babyrobot_levels.extensions.formats.sources import single
from babyrobot_levels.parallel import executor_for
from babyrobot_levels.parallel.executor import results
from babyrobot_levels.text.errors import LevelError
from babyrobot_levels.text.words import listed

PAGE = Path(__file__).resolve().parents[1] / "docs" / "corpora.md"

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
    """

    repository: str
    commit: str
    license: str
    files: tuple[str, ...]
    what: str

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
)


class Facts(NamedTuple):
    """What is found of a level.

    Attributes:
        digest: its digest.
        ends: whether it has exits.
        steps: the expected number of steps to the exit; None if it is not surely reached.
        is_solved: whether it was solved: it is not too large.
    """

    digest: str
    ends: bool
    steps: float | None
    is_solved: bool


def facts_of(text: str) -> Facts | None:
    """Return the facts of a level file, None if it is not valid."""
    try:
        level = brl.loads(text)
        if level.width * level.height > MAX_CELLS:
            return Facts(level.digest, bool(level.exits), None, is_solved=False)
        solution = brl.solve(level, 0.999)
    except LevelError:
        return None
    steps = solution.expected_steps if solution.exit_probability > 1 - 1e-9 else None
    return Facts(level.digest, bool(level.exits), steps, is_solved=True)


class Read(NamedTuple):
    """A corpus that has been read."""

    corpus: Corpus
    outcomes: Sequence[Outcome]
    levels: Sequence[Facts | None]


def read(corpus: Corpus, folder: Path) -> Read:
    """Return what becomes of the files of a corpus."""
    paths = sorted({path for pattern in corpus.files for path in folder.glob(pattern)})
    if not paths:
        sys.exit(f"{folder} has none of the files of {corpus.repository}")
    outcomes = [*_each(worker(None, None, strict=False), [*map(single, paths)])]
    texts = [text for outcome in outcomes for _, text in outcome.texts]
    return Read(corpus, outcomes, [*_each(facts_of, texts)])


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

## What is refused

| collection | files | why |
|---|---|---|
{refused}

## What the levels are

- In micromouse mazes, the robot goes from the start to the nearest goal. Mazes without marks start
  in the bottom-left cell, and their goals are the cells in the middle.
- Levels of Boxoban have up to millions of states of robot and boxes: `python benchmarks/boxoban.py`
  solves them one by one.
- Of maps of MovingAI, the start is the first free cell, and the exit the last one that can be
  reached from there.
- Tiles of Tiled that have none of the classes of [Tiled maps](converting.md#tiled) are plain cells.
- Worlds of Karel, MettaGrid and Overcooked-AI have no exits, as their tasks are others.
- Licences, as the collections state them: {licenses}.
"""


def clones() -> str:
    """Return the commands that get the collections."""
    return "\n".join(
        f"git clone https://github.com/{each.repository}\n"
        f"git -C {each.name} checkout -q {each.commit}"
        for each in CORPORA
    )


def page(all_read: Sequence[Read]) -> str:
    """Return the page."""
    return _HEAD.format(
        clones=clones(),
        most=MAX_CELLS,
        rows="\n".join(map(_row, all_read)),
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
    PAGE.write_text(page(all_read), encoding="utf-8")


if __name__ == "__main__":
    main()
