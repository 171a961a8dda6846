"""Every sentence of the reference about what happens in a level, tried in small levels.

`dynamics.txt` holds entries: the sentences, each behind `## ` and word for word as in the page;
then levels, each followed by what is so in it, behind `> `:

- `east at [1, 0]: 0.5 [2, 0] -1; 0.5 [0, 0] -2 ends`: the outcomes of an action, with their
  probability, cell and reward; `in [1, 0]` behind a cell is a configuration; of several robots,
  `east+stay` is an action, and `-1|0` what each gets;
- `start: 0.5 [0, 0]; 0.5 [0, 1]`: the probability of each start;
- `valid at [1, 0]: stay east`, `configurations: [0] [1]`, `state of [1, 0]: 1`;
- `error BR301`: it is no level, for that reason; `digest of {…}`: it is the same as that level.

Behind `= `, an entry names the tests of what no table shows.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pytest
from support.claims import plain
from support.places import DOCS, TESTS

import babyrobot_levels as brl
from babyrobot_levels.linter.rules import select
from babyrobot_levels.linter.runner import lint_source
from babyrobot_levels.text.source import SourceFile

PAGE = (DOCS / "level-format.md").read_text(encoding="utf-8")
FILE = TESTS / "docs" / "dynamics.txt"
FIRST, LAST = "Size, start and exit", "Themes"
"""The sections from the one up to the other are about dynamics, but for drawings."""

NO_LAWS = (
    *("| `name` |", "| `color` |", "| `label` |", "| `shape` |", "| `color`, `label` |"),
    *("| `fit` |", "| `width` |", "An area is a rectangle", "A skid is a probability, or"),
    *("For example:", "From `[1", "Terminal areas are ends", "Shaped rewards:"),
    *("With the key and without", "In this level the lever", "Two robots change places"),
    "From `[0, 0]`, the robot goes",
)
"""How looks, names and what only leads to an example begin; examples have tests of their own."""


def sentences() -> Iterator[str]:
    """Yield the sentences and the rows of tables of the sections about dynamics."""
    text = PAGE[PAGE.index(f"\n## {FIRST}\n") : PAGE.index(f"\n## {LAST}\n")]
    text = re.sub(r"^## Drawings\n.*?(?=^## )", "", text, flags=re.S | re.M)
    text = re.sub(r"^```.*?^```$", "", text, flags=re.S | re.M)
    # Tables behind a comment are outcomes, which are tested where they stand.
    text = re.sub(r"^<!-- .* -->\n(\|.*\n)*", "", text, flags=re.M)
    text = re.sub(r"^\|.*\n\|---.*\n", "\n", text, flags=re.M)
    for part in re.split(r"\n\n+|\n(?=[-|#]|\d+\. )", text):
        words = plain(re.sub(r"^(- |\d+\. |##.*)", "", part.strip()))
        if words.startswith("|"):
            yield words
        elif words:
            yield from re.split(r"(?<=[.:]) (?=[A-Z`])", words)


class Entry(NamedTuple):
    """Some sentences, levels with what is so in them, and the tests of the rest."""

    sentences: list[str]
    levels: list[tuple[str, list[str]]]
    tests: list[str]

    def __str__(self) -> str:
        return self.sentences[0][:50]


def entries() -> Iterator[Entry]:
    for part in FILE.read_text(encoding="utf-8").split("\n\n"):
        entry, text, is_open = Entry([], [], []), "", True
        for line in part.strip().splitlines():
            kind, _, rest = line.partition(" ")
            if kind == "##":
                entry.sentences.append(rest)
            elif kind == "=":
                entry.tests.append(rest)
            elif kind == ">" and is_open:
                entry.levels.append((f"version: 1\n{text}", [rest]))
                text, is_open = "", False
            elif kind == ">":
                entry.levels[-1][1].append(rest)
            else:
                text, is_open = f"{text}{line}\n", True
        yield entry


ENTRIES = [*entries()]


def test_every_sentence_has_its_levels_or_tests() -> None:
    known = [sentence for entry in ENTRIES for sentence in entry.sentences]
    assert len({*known}) == len(known)
    told = [each for each in sentences() if not each.startswith(NO_LAWS)]
    assert [each for each in told if each not in known] == []
    assert [each for each in known if each not in told] == []
    assert [str(entry) for entry in ENTRIES if not (entry.levels or entry.tests)] == []
    for name in {name for entry in ENTRIES for name in entry.tests}:
        path, _, function = name.partition("::")
        assert f"def {function}" in (TESTS.parent / path).read_text(encoding="utf-8"), name


@pytest.mark.parametrize("entry", [each for each in ENTRIES if each.levels], ids=str)
def test_it_is_so_in_these_levels(entry: Entry) -> None:
    for text, laws in entry.levels:
        for law in laws:
            assert found(text, law) == law, text


def found(text: str, law: str) -> str:
    """Return the law with what is so in the level, word for word if it holds."""
    kind, _, rest = law.partition(" ")
    if kind == "error":
        # Things that stand in each other's way are found where the level is compiled.
        source = SourceFile("level.yaml", text)
        codes = [each.code for each in lint_source(source, select(None)).diagnostics]
        return law if rest in codes else f"error {codes}"
    level = brl.loads(text)
    if kind == "digest":
        other = brl.loads(rest.replace("of {", "{version: 1, "))
        return law if level.digest == other.digest else "digest of another level"
    mdp = level.compile()
    names = [str(each) for each in mdp.configurations.tolist()]
    single = [str(action) for action in brl.Action][: 1 + level.moves]
    actions = ["+".join(each) for each in itertools.product(single, repeat=mdp.num_robots)]

    def shown(state: int) -> str:
        where = f" in {names[mdp.configuration(state)]}" if level.has_things else ""
        return f"{[*mdp.cell(state)]}{where}"

    head = law.partition(":")[0]
    if kind == "configurations:":
        return " ".join(["configurations:", *names])
    if kind == "start:":
        starts = np.flatnonzero(mdp.start).tolist()
        return alike(law, "start: " + "; ".join(f"{mdp.start[s]:.12g} {shown(s)}" for s in starts))
    place = re.search(r"\[(\d+), (\d+)\](?: in (\[.*\]))?$", head)
    assert place is not None, law
    number = names.index(place[3]) if place[3] else 0
    state = number * mdp.cells + int(place[2]) * mdp.width + int(place[1])
    if kind == "state":
        return f"{head}: {state}"
    if kind == "valid":
        allowed = itertools.compress(actions, mdp.action_mask[state])
        return " ".join([f"{head}:", *allowed])
    ends = {False: "", True: " ends"}
    action = actions.index(kind)
    rewards = [f"{outcome[2]:g}" for outcome in mdp.outcomes(state, action)]
    if mdp.shares is not None:
        rows = mdp.shares[state, action, : len(rewards)].tolist()
        assert [sum(row) for row in rows] == pytest.approx([*map(float, rewards)])
        rewards = ["|".join(f"{share:g}" for share in row) for row in rows]
    parts = [
        f"{p:.12g} {shown(after)} {reward}{ends[end]}"
        for (p, after, _, end), reward in zip(mdp.outcomes(state, action), rewards, strict=True)
    ]
    return alike(law, f"{head}: {'; '.join(parts)}")


def alike(law: str, shown: str) -> str:
    """Return the law if it lists the same parts, in whatever order and with more digits."""

    def parts(text: str) -> list[tuple[str, float]]:
        rows = [row.partition(" ") for row in text.partition(": ")[2].split("; ")]
        return sorted((rest, round(float(chance), 9)) for chance, _, rest in rows)

    return law if parts(law) == parts(shown) else shown


# -- what no table shows -------------------------------------------------------------------


def test_the_limit_truncates_and_solvers_do_not_see_it() -> None:
    level = brl.load({"version": 1, "size": [6, 1], "max_steps": 3})
    env = level.make()
    env.reset(seed=1)
    ends = [env.step(brl.Action.EAST)[2:4] for _ in range(3)]
    assert ends == [(False, False), (False, False), (False, True)]
    assert env.spec is not None
    assert (env.spec.reward_threshold, brl.solve(level).expected_return) == (-3, -4)


def test_the_discount_is_that_of_solvers_not_of_environments() -> None:
    level = brl.load({"version": 1, "size": [4, 1], "discount": 0.5})
    assert brl.solve(level).expected_return == brl.solve(level, discount=0.5).expected_return
    assert brl.evaluate(level, brl.solve(level)).expected_return == -1.5
    assert [*brl.value_iteration(level)][-1].values[0, 0] == -1.5
    env = level.make()
    env.reset(seed=1)
    assert [env.step(brl.Action.EAST)[1] for _ in range(3)] == [-1, -1, 0]


def test_mazes_are_trees_until_loops_open_their_dead_ends() -> None:
    def of(**maze: Any) -> brl.Metrics:
        return brl.metrics(
            {"version": 1, "size": [8, 8], "exit": "none", "maze": {"seed": 3, **maze}}
        )

    tree, half, all_ = of(), of(loops=0.5), of(loops=1)
    assert (tree.loops, tree.reachable, all_.dead_ends) == (0, 1.0, 0)
    assert tree.dead_ends > half.dead_ends > 0
    assert of(algorithm="wilson") != tree


def test_random_mazes_have_tables_and_digests_once_they_have_a_seed() -> None:
    level = brl.load({"version": 1, "size": [6, 6], "maze": {"seed": "random"}})
    env = level.make()
    seeds = {env.reset(seed=seed)[1]["maze_seed"] for seed in range(4)}
    assert len(seeds) == 4
    for use in (level.compile, lambda: level.digest):
        with pytest.raises(brl.LevelError, match="with_maze_seed"):
            use()
    assert level.with_maze_seed(7).digest
    assert level.with_maze_seed(7).compile().num_states == 36


def test_turns_are_stays_and_forward_is_the_move() -> None:
    fields = {"version": 1, "heading": "S", "skid": 0.5, "exit": "none", "rewards": {"stay": -7}}
    level = brl.load({**fields, "walls": [{"at": [0, 0], "side": "E", "pass": 0.5}]})
    mdp = level.compile().turning(level.heading)
    assert [turn.name for turn in brl.Turn] == ["LEFT", "RIGHT", "FORWARD"]
    assert mdp.start[2 * mdp.cells] == 1  # south is the third of the headings
    for heading, action in enumerate([*brl.Action][1:5]):
        for cell in range(mdp.cells):
            state = heading * mdp.cells + cell
            for turn, way in ((brl.Turn.LEFT, -1), (brl.Turn.RIGHT, 1)):
                there = (heading + way) % 4 * mdp.cells + cell
                assert mdp.outcomes(state, turn) == [(1.0, there, -7.0, False)]
            forward = [
                (chance, heading * mdp.cells + after, reward, end)
                for chance, after, reward, end in level.compile().outcomes(cell, action)
            ]
            assert mdp.outcomes(state, brl.Turn.FORWARD) == forward


def test_actions_have_their_numbers() -> None:
    assert [str(action) for action in brl.Action] == [
        *("stay", "north", "east", "south", "west"),
        *("north-east", "south-east", "south-west", "north-west"),
    ]
    assert [*map(int, brl.Action)] == [*range(9)]


def test_actions_that_are_not_valid_may_be_taken() -> None:
    env = brl.load({"version": 1}).make()
    before, info = env.reset(seed=1)
    assert not info["action_mask"][brl.Action.NORTH]
    after, reward, *_ = env.step(brl.Action.NORTH)
    assert (after.tolist(), reward) == (before.tolist(), -1)


@pytest.mark.slow
def test_ten_coins_make_1024_configurations_which_are_named() -> None:
    items = [{"name": f"coin-{number}", "at": [number, 1]} for number in range(10)]
    level = brl.load({"version": 1, "size": [10, 2], "items": items, "exit": "none"})
    assert level.compile().num_configurations == 1024
    assert level.things().names == tuple(each["name"] for each in items)
    assert level.configuration(1023).held == level.things().names
