"""Certificates: equivalent MDPs are found equivalent, and else the first difference is found."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest

import babyrobot_levels as brl
from babyrobot_levels.analysis.compare import compare
from babyrobot_levels.analysis.environments import Certificate, ComparisonError
from babyrobot_levels.mdp.tables import Outcome

Table = dict[int, dict[int, list[Outcome]]]

LAKE, CLIFF = (4, 3, 2, 1), (1, 2, 3, 4)
"""For each action of Gymnasium's worlds, ours."""

LARGE_AND_DRY = {"map_name": "8x8", "is_slippery": False}

PEERS: list[tuple[str, str, dict[str, Any], tuple[int, ...], int]] = [
    ("frozen-lake", "FrozenLake-v1", {}, LAKE, 11),
    ("frozen-lake-8x8-dry", "FrozenLake-v1", LARGE_AND_DRY, LAKE, 53),
    ("cliff-walking-slippery", "CliffWalking-v1", {"is_slippery": True}, CLIFF, 37),
]


def tables(name: str) -> tuple[Table, list[float]]:
    """Return a level as Gymnasium would have it, without stay."""
    mdp = brl.load(name).compile()
    return mdp.to_toy_text(first_action=1), mdp.start.tolist()


# -- what is the same ----------------------------------------------------------------------


@pytest.mark.parametrize(("name", "peer", "kwargs", "actions", "states"), PEERS)
def test_the_gallery_is_equivalent_to_gymnasium(
    name: str, peer: str, kwargs: dict[str, Any], actions: tuple[int, ...], states: int
) -> None:
    level = brl.load(name)
    certificate = compare(name, f"gymnasium:{peer}", kwargs=kwargs)
    mdp = level.compile()
    reached = ~mdp.is_terminal
    if "cliff" in name:
        # Nobody ever stands on the cliff.
        reached[37:47] = False
    outcomes = int(np.count_nonzero(mdp.probability[reached][:, 1:]))
    assert certificate == Certificate(True, actions, states, outcomes, True, None, level.digest)
    with gymnasium.make(peer, **kwargs) as env:
        assert compare(level, env) == certificate
        assert compare(level, (env.unwrapped.P, env.unwrapped.initial_state_distrib)) == certificate  # type: ignore[attr-defined]


def test_other_actions_make_another_mdp() -> None:
    assert compare("frozen-lake", "gymnasium:FrozenLake-v1", actions=LAKE).equal
    turned = compare("frozen-lake", "gymnasium:FrozenLake-v1", actions=CLIFF)
    assert (turned.equal, turned.actions) == (False, CLIFF)


@pytest.mark.parametrize("actions", ["all", "moves"])
def test_our_own_environments_can_be_compared(actions: str) -> None:
    env = brl.load("puddles").make(actions=actions)
    certificate = compare("puddles", env)
    assert certificate.equal
    assert certificate.actions == ((0, 1, 2, 3, 4) if actions == "all" else (1, 2, 3, 4))


def test_levels_that_are_written_differently() -> None:
    drawn = brl.loads(
        "version: 1\nmap: |\n  +---+---+\n  | S |   |\n  +   +   +\n  |     E |\n  +---+---+\n"
    )
    told = {"version": 1, "size": [2, 2], "walls": [{"at": [1, 0], "side": "west"}]}
    certificate = compare(drawn, told)
    assert certificate.equal
    assert certificate.actions == (0, 1, 2, 3, 4)
    # The cell behind the exit is not reached.
    assert (certificate.states, certificate.outcomes) == (2, 10)
    assert certificate.digest == drawn.digest


# Glass; warps; several starts.
@pytest.mark.parametrize("name", ["glasshouse", "teleport-pads", "gridworld-4-1"])
def test_a_level_is_equivalent_to_its_table(name: str) -> None:
    level = brl.load(name)
    certificate = compare(level, (level.compile().to_toy_text(1), level.compile().start))
    assert (certificate.equal, certificate.everywhere) == (True, True)


def test_outcomes_may_be_listed_in_parts_and_in_any_order() -> None:
    table, start = tables("frozen-lake")
    for actions in table.values():
        for action, listed in actions.items():
            halves = [(p / 2, state, reward, end) for p, state, reward, end in listed]
            actions[action] = [*reversed(halves), (0.0, 7, 99.0, True), *halves]
    assert compare("frozen-lake", (table, start)).equal


def test_numbers_may_differ_by_their_rounding() -> None:
    def nudged(by: float, rewards: float = 0.0) -> tuple[Table, list[float]]:
        table, start = tables("frozen-lake")
        (p, *one), (q, *two), *rest = table[0][1]
        table[0][1] = [(p + by, *one), (q - by, *two), *rest]  # type: ignore[list-item]
        table[1][1] = [(p, state, r + rewards, end) for p, state, r, end in table[1][1]]
        return table, start

    assert compare("frozen-lake", nudged(1e-13, 1e-13)).equal
    assert not compare("frozen-lake", nudged(1e-9)).equal
    assert compare("frozen-lake", nudged(1e-9), tolerance=1e-8).equal
    assert not compare("frozen-lake", nudged(0, 1e-9), tolerance=1e-8).equal


# -- states that play no part --------------------------------------------------------------


def test_what_lies_behind_the_end_is_not_compared() -> None:
    table, start = tables("frozen-lake")
    table[15] = {action: [(1.0, 3, 5.0, False)] for action in range(4)}
    certificate = compare("frozen-lake", (table, start))
    assert (certificate.equal, certificate.everywhere) == (True, True)


def test_states_that_no_episode_comes_to_are_told_apart() -> None:
    table, start = tables("cliff-walking")
    table[40][0] = [(1.0, 28, -7.0, False)]
    certificate = compare("cliff-walking", (table, start))
    assert (certificate.equal, certificate.everywhere) == (True, False)
    # The cell behind the exit is there in one level, and blocked in the other.
    walled = {"version": 1, "size": [3, 1], "exit": [1, 0]}
    blocked = {**walled, "blocked": [{"at": [2, 0]}]}
    for pair in ((walled, blocked), (blocked, walled)):
        certificate = compare(*pair)
        assert (certificate.equal, certificate.everywhere, certificate.states) == (True, False, 1)


# -- what differs --------------------------------------------------------------------------


def reward(table: Table) -> None:
    table[6][2] = [(p, state, r - 0.5, end) for p, state, r, end in table[6][2]]


def probability(table: Table) -> None:
    table[6][2] = [
        (p, s, r, e) for p, (_, s, r, e) in zip((0.5, 0.25, 0.25), table[6][2], strict=True)
    ]


def terminal(table: Table) -> None:
    table[6][2] = [(p, state, r, False) for p, state, r, _ in table[6][2]]


def off_the_grid(table: Table) -> None:
    table[6][2] = [(1.0, 99, 0.0, False)]


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (reward, "[2, 2] with probability 0.333333, reward -0.5"),
        (probability, "[1, 1] with probability 0.5, reward 0, terminal;"),
        (terminal, "[1, 1] with probability 0.333333, reward 0;"),
        (off_the_grid, "state 99 with probability 1, reward 0"),
    ],
)
def test_a_changed_outcome_is_found(change: Callable[[Table], None], told: str) -> None:
    table, start = tables("frozen-lake")
    original = copy.deepcopy(table)
    change(table)
    # Of several differences, the first one is told.
    table[14][3] = table[13][0]
    assert table != original
    certificate = compare("frozen-lake", (table, start))
    assert certificate.equal is False
    assert certificate.actions == (1, 2, 3, 4)
    assert certificate.difference is not None
    first, ours, theirs = certificate.difference.splitlines()
    assert first == "at [2, 1], south (in the other: action 2):"
    assert ours.startswith("  this level: ")
    assert theirs.startswith("  the other: ")
    assert told in theirs
    assert told not in ours


def test_a_difference_is_told_with_all_the_digits_that_it_takes() -> None:
    table, start = tables("frozen-lake-dry")
    table[0][1] = [(1.0, 1, 1e-11, False)]
    difference = compare("frozen-lake-dry", (table, start)).difference
    assert difference is not None
    assert difference.endswith("probability 1, reward 1e-11")
    table[0][1] = [(1 - 1e-11, 1, 0.0, False)]
    difference = compare("frozen-lake-dry", (table, start)).difference
    assert difference is not None
    assert "probability 0.9999999999" in difference
    table[0][1] = []
    difference = compare("frozen-lake-dry", (table, start)).difference
    assert difference is not None
    assert difference.endswith("  the other:  no outcome")


BASE = {"version": 1, "size": [4, 3]}


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (
            {"walls": [{"at": [1, 1], "side": "east"}]},
            "at [1, 1], east (in the other: east):\n"
            "  this level: [2, 1] with probability 1, reward -1\n"
            "  the other:  [1, 1] with probability 1, reward -1",
        ),
        (
            {"exit": [3, 1]},
            "at [3, 0], south (in the other: south):\n"
            "  this level: [3, 1] with probability 1, reward -1\n"
            "  the other:  [3, 1] with probability 1, reward 0, terminal",
        ),
        (
            {"start": [[0, 0], [2, 1]]},
            "episodes start at [0, 0] with probability 1 in this level, 0.5 in the other",
        ),
        ({"size": [5, 3]}, "this level has 12 cells (4 by 3), the other has 15 states"),
    ],
    ids=["wall", "exit", "start", "size"],
)
def test_two_levels_that_differ(change: dict[str, Any], told: str) -> None:
    certificate = compare(BASE, BASE | change)
    assert (certificate.equal, certificate.difference) == (False, told)
    assert certificate.digest == brl.load(BASE).digest
    assert compare(BASE | change, BASE).equal is False


def test_too_many_actions() -> None:
    table, start = tables("frozen-lake")
    for actions in table.values():
        actions[4] = actions[5] = actions[0]
    certificate = compare("frozen-lake", (table, start))
    told = "this level has 4 moves and stay, the other has 6 actions"
    assert (certificate.difference, certificate.actions, certificate.states) == (told, None, 0)


# -- things and turning --------------------------------------------------------------------

ROOMS = {
    "version": 1,
    "size": [4, 2],
    "exit": [3, 0],
    "items": [{"name": "key", "at": [0, 1]}],
    "doors": [{"at": [1, 0], "side": "E", "needs": "key"}],
    "movers": [{"name": "guard", "path": [[1, 1], [2, 1]], "back": True}],
}


def test_a_level_with_things_is_equivalent_to_its_table_and_environment() -> None:
    level = brl.load(ROOMS)
    mdp = level.compile()
    certificate = compare(level, (mdp.to_toy_text(), mdp.start))
    assert certificate.equal
    # Also what a hit ends leads to states in which episodes go on.
    assert certificate.everywhere
    assert certificate.states == np.count_nonzero(~mdp.is_terminal)
    assert compare(level, level.make(actions="all")) == certificate
    assert compare(level, ROOMS) == certificate


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (
            {"items": [{"name": "key", "at": [0, 1], "reward": 2}]},
            "at [0, 0] while nothing is held, guard at [1, 1], south (in the other: south):\n"
            "  this level: [0, 1] while key is held, guard at [2, 1] with probability 1, "
            "reward -1\n"
            "  the other:  [0, 1] while key is held, guard at [2, 1] with probability 1, "
            "reward 2",
        ),
        (
            {"hit": {"ends": False}},
            "at [1, 0] while nothing is held, guard at [2, 1], south (in the other: south):\n"
            "  this level: [1, 1] while nothing is held, guard at [1, 1] with probability 1, "
            "reward -1, terminal\n"
            "  the other:  [1, 1] while nothing is held, guard at [1, 1] with probability 1, "
            "reward -1",
        ),
        (
            {"items": [{"name": "key", "one_of": [[0, 1], [1, 0]]}]},
            "this level has 4 configurations of 8 cells (4 by 2), the other has 48 states",
        ),
    ],
    ids=["reward", "hit", "places"],
)
def test_levels_whose_things_differ(change: dict[str, Any], told: str) -> None:
    certificate = compare(ROOMS, ROOMS | change)
    assert (certificate.equal, certificate.difference) == (False, told)


@pytest.mark.parametrize("world", ["maze", "glasshouse", ROOMS])
def test_a_robot_that_turns_is_compared_with_turning(world: Any) -> None:
    level = brl.load(world)
    mdp = level.compile().turning("E")
    certificate = compare(level, (mdp.to_toy_text(), mdp.start))
    assert (certificate.equal, certificate.everywhere) == (True, True)
    assert certificate.actions == (0, 1, 2)
    turned = level.compile().turning("N")
    difference = compare(level, (turned.to_toy_text(), turned.start)).difference
    assert difference is not None
    assert difference.startswith("episodes start at [0, 0] looking N")


# -- wrong calls ---------------------------------------------------------------------------

ROW = {0: [(1.0, 0, 0.0, False)]}


@pytest.mark.parametrize(
    ("other", "told"),
    [
        ("gymnasium:FrozenLake-v9", "version `v9` for environment `FrozenLake` doesn't exist"),
        ("gymnasium:Nonsense-v1", "`Nonsense` doesn't exist"),
        ("gymnasium:", "Malformed environment ID"),
        ("gymnasium:no_such_module:Any-v1", "no_such_module"),
        ("gymnasium:CartPole-v1", "CartPole-v1 has no table"),
        ({0: ROW}, "the starts are missing"),
        (({}, []), "the same actions"),
        (({0: ROW, 1: {}}, [1, 0]), "the same actions"),
        (({1: ROW}, [1]), "KeyError"),
        (({0: {0: [(1.0, 0, 0.0)]}}, [1]), "ValueError"),
        (({0: {0: [(1.0, 0, float("nan"), False)]}}, [1]), "finite"),
        (({0: ROW}, [1, 0]), "as many probabilities"),
        ((7, [1]), "TypeError"),
        ("random-maze", "another maze"),
    ],
)
def test_what_cannot_be_compared(other: Any, told: str) -> None:
    with pytest.raises(ComparisonError) as caught:
        compare("frozen-lake", other)
    assert told in str(caught.value)


def test_environments_that_cannot_be_made() -> None:
    with pytest.raises(ComparisonError, match="unexpected keyword argument 'depth'"):
        compare("frozen-lake", "gymnasium:FrozenLake-v1", kwargs={"depth": 3})
    with pytest.raises(ComparisonError, match="KeyError: '9x9'"):
        compare("frozen-lake", "gymnasium:FrozenLake-v1", kwargs={"map_name": "9x9"})
    with pytest.raises(ComparisonError, match="are for environments"):
        compare("frozen-lake", "frozen-lake", kwargs={})


@pytest.mark.parametrize("actions", [(1, 2, 3), (0, 1, 2, 3), (1, 1, 2, 3), (0, 1, 2, 3, 4), ()])
def test_actions_that_do_not_name_each_move_once(actions: tuple[int, ...]) -> None:
    with pytest.raises(ComparisonError, match="each of 1, 2, 3, 4 once"):
        compare("frozen-lake", "gymnasium:FrozenLake-v1", actions=actions)


def test_levels_that_are_none() -> None:
    with pytest.raises(brl.LevelNotFoundError):
        compare("frozen-lake", "frozen-lakes")
    with pytest.raises(brl.LevelError):
        compare("frozen-lake", {"version": 2})
    with pytest.raises(TypeError, match="a level is"):
        compare("frozen-lake", 7)
    with pytest.raises(ComparisonError, match="another maze"):
        compare("random-maze", "frozen-lake")
