"""What levels are for model checkers, read by others: PRISM by Python, archives by umbi."""

from __future__ import annotations

import re
from collections import defaultdict
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import umbi

import babyrobot_levels as brl
from babyrobot_levels.convert.processes import process_of

LEVELS = [
    "final-maze",
    "frozen-lake",
    "four-corners",
    "night-watch",
    "shell-game",
    "russell-norvig-4x3",
]
"""With skids, thirds, several starts, hits that end the episode, a drawn exit, a switch, holes."""

Table = dict[tuple[int, str], tuple[dict[int, Fraction], Fraction]]
"""For each state and action: the chances of the next states, and the expected reward."""


def expected(level: brl.Level) -> Table:
    """Return the table of a level as floats that are fractions."""
    mdp, process = level.compile(), process_of(level)
    table: Table = {}
    for state in range(mdp.num_states):
        if mdp.is_terminal[state]:
            table[state, ""] = {state: Fraction(1)}, Fraction(0)
            continue
        for action in brl.Action:
            chances: dict[int, Fraction] = defaultdict(Fraction)
            paid = Fraction(0)
            for chance, target, reward, over in mdp.outcomes(state, action):
                is_hit = over and not mdp.is_terminal[target]
                chances[mdp.num_states if is_hit else target] += Fraction(chance)
                paid += Fraction(chance) * Fraction(reward)
            table[state, action.name.lower()] = chances, paid
    for state in range(mdp.num_states, process.size):
        starts = {start: Fraction(mdp.start[start]) for start in np.flatnonzero(mdp.start).tolist()}
        draws = process.starts and state == process.size - 1
        table[state, ""] = starts if draws else {state: Fraction(1)}, Fraction(0)
    return table


def assert_same(found: Table, level: brl.Level) -> None:
    wanted = expected(level)
    assert found.keys() == wanted.keys()
    for key, (chances, reward) in found.items():
        assert sum(chances.values()) == pytest.approx(1, abs=1e-15)
        assert chances.keys() == wanted[key][0].keys(), key
        for target, chance in chances.items():
            assert float(chance) == pytest.approx(float(wanted[key][0][target]), abs=1e-15)
        assert float(reward) == pytest.approx(float(wanted[key][1]), abs=1e-12), key


# -- PRISM -------------------------------------------------------------------------------------


class Module:
    """A module of PRISM, as Python reads it."""

    def __init__(self, text: str):
        self.text = text
        found = re.search(r"s : \[0\.\.(\d+)\] init (\d+);", text)
        assert found is not None
        self.size, self.initial = int(found[1]) + 1, int(found[2])
        commands = re.findall(r"^  \[(\w*)\] (.*) -> (.*);$", text, re.M)
        self.commands = [(a, self.where(guard), updates) for a, guard, updates in commands]

    def where(self, guard: str) -> list[int]:
        code = compile(
            re.sub(r"(?<![<>])=", "==", guard).replace("|", " or ").replace("&", " and "),
            "guard",
            "eval",
        )
        return [s for s in range(self.size) if eval(code, {"s": s, "false": False})]

    def labelled(self, name: str) -> list[int]:
        found = re.search(rf'^label "{name}" = (.*);$', self.text, re.M)
        assert found is not None
        return self.where(found[1])

    def rewards(self, name: str) -> dict[tuple[int, str], Fraction]:
        part = self.text.split(f'rewards "{name}"')[1].split("endrewards")[0]
        rows = re.findall(r"^  \[(\w*)\] (.*) : (.*);$", part, re.M)
        return {(s, a): Fraction(value) for a, guard, value in rows for s in self.where(guard)}

    def table(self) -> Table:
        rewards, table = self.rewards("reward"), {}
        for action, states, updates in self.commands:
            for s in states:
                chances = {}
                for update in [] if updates == "true" else updates.split(" + "):
                    chance, target = re.fullmatch(r"(?:(.+):)?\(s'=(.+)\)", update).groups()  # type: ignore[union-attr]
                    chances[eval(target, {"s": s})] = Fraction(chance or 1)
                assert (s, action) not in table
                table[s, action] = (
                    chances or {s: Fraction(1)},
                    rewards.get((s, action), Fraction(0)),
                )
        return table


@pytest.mark.parametrize("name", LEVELS)
def test_a_module_says_what_the_tables_say(name: str) -> None:
    level = brl.load(name)
    module, process = Module(brl.export(level, "prism").text), process_of(level)
    assert (module.size, module.initial) == (process.size, process.initial)
    table = module.table()
    assert_same(table, level)
    # Read as they are written, not only rounded.
    assert all(sum(chances.values()) == 1 for chances, _ in table.values())
    costs = {key: -reward for key, reward in module.rewards("reward").items()}
    assert module.rewards("cost") == costs
    for label, has in process.labels.items():
        assert module.labelled(label) == np.flatnonzero(has).tolist()


def test_numbers_of_a_module_are_the_fractions_that_floats_stand_for() -> None:
    text = brl.export("frozen-lake", "prism").text
    assert "[north] s=0 -> 2/3:(s'=s) + 1/3:(s'=s+1);" in text
    assert "0.3333" not in text


def test_probabilities_that_no_fraction_fits_add_up_to_one_all_the_same() -> None:
    skid = {"probability": 0.1234567890123, "to": "others"}
    puddle = {"small": {"skid": {"probability": 0.9876543210987, "to": "others"}}}
    level = brl.Level.from_fields(
        {
            "version": 1,
            "skid": skid,
            "puddle_types": puddle,
            "puddles": [{"at": [1, 1], "size": "small"}],
        }
    )
    table = Module(brl.export(level, "prism").text).table()
    assert_same(table, level)
    assert all(sum(chances.values()) == 1 for chances, _ in table.values())


def test_formulas_are_the_cell_and_the_configuration() -> None:
    level = brl.load("night-watch")
    text, mdp = brl.export(level, "prism").text, level.compile()
    formulas = dict(re.findall(r"formula (\w+) = s < 324 \? (.*) : -1;", text))
    for state in (0, 26, 27, 200, 323):
        names: dict[str, Any] = {"s": state, "mod": lambda a, b: a % b, "floor": int}
        x, y, configuration = (eval(formulas[n], names) for n in ("x", "y", "configuration"))
        assert ((x, y), configuration) == (mdp.cell(state), mdp.configuration(state))


def test_lines_of_a_description_stay_comments() -> None:
    level = brl.load("walls").replace(description="one\ntwo\u2028endmodule\x1b[31m")
    text = brl.export(level, "prism").text
    above = text[: text.index("\nmdp\n")]
    assert all(line.startswith("//") for line in above.split("\n"))
    assert "\x1b" not in text


# -- labels and losses -------------------------------------------------------------------------


def test_labels_tell_puddles_areas_and_what_is_held_or_on() -> None:
    wet = process_of(brl.load("final-maze")).labels
    assert np.flatnonzero(wet["puddle"]).tolist() == [2, 13, 18, 19, 31]
    assert np.flatnonzero(wet["large_puddle"]).tolist() == [13, 19]
    assert not process_of(brl.load("walls")).labels["puddle"].any()
    level = brl.load("first-key")
    held = process_of(level).labels["key_held"][: level.compile().num_states]
    rows = held.reshape(level.compile().shape)
    assert rows.all(axis=(1, 2)).tolist() == [bool(level.configuration(n).held) for n in (0, 1)]
    area = {"at": [1, 0], "size": [1, 2], "label": "Hot lava!"}
    labels = process_of(brl.Level.from_fields({"version": 1, "areas": [area]})).labels
    assert np.flatnonzero(labels["area_hot_lava"]).tolist() == [1, 4]


def test_an_exit_is_labelled_where_it_is_open_and_other_ends_are_not() -> None:
    labels = process_of(brl.load("frozen-lake")).labels
    assert np.flatnonzero(labels["exit"]).tolist() == [15]
    assert np.flatnonzero(labels["end"]).tolist() == [5, 7, 11, 12, 15]


@pytest.mark.parametrize("name", ["prism", "umb"])
def test_what_a_model_cannot_say_is_told(name: str) -> None:
    level = brl.load("four-corners").replace(discount=0.9, max_steps=30, theme="default")
    told = {lost.field: lost.message for lost in brl.export(level, name).warnings}
    assert "the first step draws one of 4" in told["start"]
    assert "Cdiscount=0.9" in told["discount"]
    assert '[F<=30 "exit"]' in told["max_steps"]
    assert told.keys() <= {"start", "discount", "max_steps", "tags", "expect"}


# -- archives ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", LEVELS)
def test_an_archive_says_what_the_tables_say(name: str, tmp_path: Path) -> None:
    level = brl.load(name)
    process, path = process_of(level), tmp_path / f"{name}.umb"
    brl.export(level, path=path)
    ats, file = umbi.ats.read(path), umbi.umb.read(path, strict=True)
    assert ats.initial_states == [process.initial]
    rewards = file.annotations["rewards"]
    assert rewards["cost"]["choices"] == [-each for each in rewards["reward"]["choices"]]
    table: Table = {}
    for choice in ats.choices:
        chances = {branch.target: Fraction(branch.prob) for branch in choice.branches}
        paid = Fraction(rewards["reward"]["choices"][choice.index])
        table[choice.state, ats.choice_action_to_name[choice.action]] = chances, paid
    assert_same(table, level)
    for label, has in process.labels.items():
        assert file.annotations["aps"][label]["states"] == has.tolist()


def test_an_archive_is_the_same_whenever_it_is_written(monkeypatch: pytest.MonkeyPatch) -> None:
    first = brl.export("final-maze", "umb")
    monkeypatch.setattr("time.time", lambda: 4e9)
    assert brl.export("final-maze", "umb").content == first.content
    assert first.text == ""


def test_without_umbi_one_sentence_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "umbi.umb.umb_to_tar", None)
    with pytest.raises(ImportError, match=r"needs umbi: install the extra `umb`: pip install"):
        brl.export("final-maze", "umb")
