"""What levels are for model checkers, read by others: PRISM by Python, archives by umbi."""

from __future__ import annotations

import re
from collections import defaultdict
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import umbi

import babyrobot_levels as brl
from babyrobot_levels.extensions.formats.processes import losses, process_of

LEVELS = [
    "final-maze",
    "frozen-lake",
    "four-corners",
    "night-watch",
    "shell-game",
    pytest.param("three-gems", marks=pytest.mark.sweep),
    "russell-norvig-4x3",
]
"""With skids, thirds, starts, hits that end the episode, drawn exits and items, a switch, holes."""

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
        for action in [*brl.Action][: mdp.num_actions]:
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


def fraction(text: str) -> Fraction:
    return Fraction(text.replace(".0", ""))


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
        return {(s, a): fraction(value) for a, guard, value in rows for s in self.where(guard)}

    def table(self) -> Table:
        rewards, table = self.rewards("reward"), {}
        for action, states, updates in self.commands:
            for s in states:
                chances = {}
                for update in [] if updates == "true" else updates.split(" + "):
                    chance, target = re.fullmatch(r"(?:(.+):)?\(s'=(.+)\)", update).groups()  # type: ignore[union-attr]
                    chances[eval(target, {"s": s})] = fraction(chance or "1")
                assert (s, action) not in table
                table[s, action] = (
                    chances or {s: Fraction(1)},
                    rewards.get((s, action), Fraction(0)),
                )
        return table


@pytest.mark.slow
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


ROUNDED = brl.Level.from_fields(
    {
        "version": 1,
        "size": [3, 2],
        "exit": [2, 0],
        "skid": {"probability": 0.4, "to": "sides"},
        "rewards": {"step": -0.4, "exit": 0.8},
    }
)
"""A level whose mean rewards, added up as floats, are not the floats nearest to their sums."""


def test_no_number_of_a_module_is_a_decimal() -> None:
    text = brl.export(ROUNDED, "prism").text
    assert "[stay] (s>=0 & s<=1) | (s>=3 & s<=5) : -2/5;" in text
    assert "[west] s=3 -> 1/5:(s'=s-3) + 4/5:(s'=s);" in text
    assert not re.search(r"\d\.\d", text)
    long = ROUNDED.replace(rewards={"step": -0.123456789012, "exit": 1e20})
    # What is no integer of PRISM is a float.
    assert ": -30864197253.0/250000000000.0;" in brl.export(long, "prism").text


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


def test_each_area_keeps_a_label_of_its_own() -> None:
    labels = ["A b", "a-B", "Ä", "水", "A b", "2"]
    given = [{"at": [x % 3, x // 3], "label": label} for x, label in enumerate(labels)]
    level = brl.Level.from_fields({"version": 1, "areas": given})
    found = process_of(level)
    areas = {name: has for name, has in found.labels.items() if name.startswith("area")}
    assert {name: np.flatnonzero(has).tolist() for name, has in areas.items()} == {
        "area_a_b": [0, 4],
        "area_a_b_2": [1],
        "area": [2],
        "area_2": [3],
        "area_2_2": [5],
    }
    told = [str(lost) for lost in losses(level, found, "a file")]
    assert told == [
        "areas.label: 'a-B' is the label area_a_b_2",
        "areas.label: 'Ä' is the label area",
        "areas.label: '水' is the label area_2",
        "areas.label: '2' is the label area_2_2",
    ]


def test_the_label_of_an_area_is_not_that_of_an_item() -> None:
    items, areas = [{"name": "area", "at": [1, 1]}], [{"at": [2, 1], "label": "held"}]
    level = brl.Level.from_fields({"version": 1, "items": items, "areas": areas})
    assert {"area_held", "area_held_2"} <= process_of(level).labels.keys()


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


@pytest.mark.slow
@pytest.mark.parametrize("name", LEVELS)
def test_an_archive_says_what_the_tables_say(name: str, tmp_path: Path) -> None:
    level = brl.load(name)
    process, path = process_of(level), tmp_path / f"{name}.umb"
    brl.export(level, path=path)
    # Its transition systems have other attributes in each version of umbi.
    assert umbi.ats.read(path).initial_states == [process.initial]
    file = umbi.umb.read(path, strict=True)
    rewards = file.annotations["rewards"]
    assert rewards["cost"]["choices"] == [-each for each in rewards["reward"]["choices"]]
    table: Table = {}
    for state, choices in enumerate(pairwise(file.state_to_choices)):
        for choice in range(*choices):
            branches = range(*file.choice_to_branches[choice : choice + 2])
            targets = [file.branch_to_target[each] for each in branches]
            chances = [Fraction(file.branch_to_probability[each]) for each in branches]
            action = file.choice_action_to_string[file.choice_to_choice_action[choice]]
            paid = Fraction(rewards["reward"]["choices"][choice])
            table[state, action] = dict(zip(targets, chances, strict=True)), paid
    assert_same(table, level)
    for label, has in process.labels.items():
        assert file.annotations["aps"][label]["states"] == has.tolist()


def test_sums_of_an_archive_are_the_floats_that_they_stand_for(tmp_path: Path) -> None:
    brl.export(ROUNDED, path=tmp_path / "level.umb")
    file = umbi.umb.read(tmp_path / "level.umb")
    assert set(file.annotations["rewards"]["reward"]["choices"]) == {-0.4, -0.16, 0.0, 0.32}
    assert set(file.branch_to_probability) == {0.2, 0.6, 0.8, 1.0}
    digits = ROUNDED.replace(rewards={"step": -1 / 3 - 1e-9, "exit": 1e300})
    brl.export(digits, path=tmp_path / "digits.umb")
    rewards = umbi.umb.read(tmp_path / "digits.umb").annotations["rewards"]["reward"]["choices"]
    assert max(rewards) == pytest.approx(6e299)


def test_an_archive_is_the_same_whenever_it_is_written(monkeypatch: pytest.MonkeyPatch) -> None:
    first = brl.export("final-maze", "umb")
    monkeypatch.setattr("time.time", lambda: 4e9)
    monkeypatch.setattr("umbi.version.__format_version__", 7)
    assert brl.export("final-maze", "umb").content == first.content
    assert first.text == ""


def test_without_umbi_one_sentence_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "umbi.umb.umb_to_tar", None)
    with pytest.raises(ImportError, match=r"needs umbi: install the extra `umb`: pip install"):
        brl.export("final-maze", "umb")


def test_a_level_that_pays_nothing_has_a_structure_of_rewards() -> None:
    text = brl.export({"version": 1, "size": [2, 1], "rewards": {"step": 0}}, "prism").content
    assert 'rewards "reward"\n  true : 0;\nendrewards' in text
